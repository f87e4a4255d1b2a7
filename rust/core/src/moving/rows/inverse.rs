//! [`inverse`] for many rows.

use super::footings::Footings;
use crate::batch::Workers;
use crate::error::Error;
use crate::moving::motion::{Command, Wanted, inverse};
use crate::suspension::Chain;

/// What the wheels have to do, row after row: see [`Commanded`](super::super::Commanded).
#[derive(Debug)]
pub struct Commands<'a> {
    /// Angles of the steering joints [rad].
    pub steering: &'a mut [f64],
    /// Of the wheels [rad/s].
    pub speeds: &'a mut [f64],
    /// Of the body [m/s, rad/s].
    pub twists: &'a mut [[f64; 6]],
    /// Of the free angles [rad/s].
    pub joint_rates: &'a mut [f64],
    /// What is left of the wanted motions.
    pub scales: &'a mut [f64],
}

/// [`inverse`] for every row: of wanted speeds and yaw rates `[m/s, rad/s]` there is one per row, or one for all. Fails
/// at the first row at which a wheel would steer past its range.
#[allow(clippy::too_many_arguments)] // each is a thing of its own
pub fn inverse_rows(
    chain: &Chain,
    footings: &Footings<'_>,
    command: &Command,
    wanted: &[[f64; 2]],
    steering: Option<&[f64]>,
    commands: Commands<'_>,
    workers: Workers,
) -> Result<(), Error> {
    let (wheels, free, steered) = (
        chain.wheels().len(),
        chain.joints().len(),
        chain.steering().len(),
    );
    let count = commands.scales.len();
    let outputs = [
        (commands.steering, steered),
        (commands.speeds, wheels),
        (commands.twists.as_flattened_mut(), 6),
        (commands.joint_rates, free),
        (commands.scales, 1),
    ];
    workers.rows(
        count,
        outputs,
        |row, [angles, speeds, twist, rates, scale]| {
            let [speed, yaw_rate] = match wanted {
                [all] => *all,
                _ => wanted[row],
            };
            let wanted = Wanted { speed, yaw_rate };
            let kept = steering.map(|angles| &angles[row * steered..][..steered]);
            let found = footings.with(chain, row, |footing| {
                inverse(chain, footing, command, wanted, kept)
            });
            let found = found.map_err(|error| error.at_row(row))?;
            angles.copy_from_slice(&found.steering[..steered]);
            speeds.copy_from_slice(&found.speeds[..wheels]);
            twist.copy_from_slice(&found.twist);
            rates.copy_from_slice(&found.joint_rates[..free]);
            scale[0] = found.scale;
            Ok(())
        },
    )
}
