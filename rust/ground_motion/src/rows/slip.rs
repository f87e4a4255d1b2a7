//! [`slip`] for many rows.

use super::settled_poses::SettledPoses;
use crate::contact::COLUMNS;
use crate::slip::slip;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::suspension::Chain;

/// Slip of the wheels, row after row: see [`Slip`](super::super::Slip).
#[derive(Debug)]
pub struct Slips<'a> {
    /// Of every wheel.
    pub ratios: &'a mut [f64],
    /// Of every wheel [rad].
    pub angles: &'a mut [f64],
}

/// [`slip`] for every row, at these twists and rates of the free angles. A row does not fail.
pub fn slip_rows(
    chain: &Chain,
    footings: &SettledPoses<'_>,
    speeds: &[f64],
    twists: &[[f64; 6]],
    joint_rates: &[f64],
    slips: Slips<'_>,
    workers: Workers,
) -> Result<(), Error> {
    let (wheels, free) = (chain.wheels().len(), chain.joints().len());
    let outputs = [(slips.ratios, wheels), (slips.angles, wheels)];
    workers.rows(twists.len(), outputs, |row, [ratios, angles]| {
        let mut rates = [0.0; COLUMNS];
        rates[..6].copy_from_slice(&twists[row]);
        rates[6..6 + free].copy_from_slice(&joint_rates[row * free..][..free]);
        let speeds = &speeds[row * wheels..][..wheels];
        let found = footings.with(chain, row, |footing| slip(chain, footing, &rates, speeds));
        for ((ratio, angle), slip) in ratios.iter_mut().zip(angles).zip(found) {
            (*ratio, *angle) = (slip.ratio, slip.angle);
        }
        Ok(())
    })
}
