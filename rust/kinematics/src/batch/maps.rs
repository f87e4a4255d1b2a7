//! Maps between twists and poses, row by row.

use crate::kernels::maps::{Map, Mapped};
use crate::geometry::Steps;
use six_wheel_numerics::error::{Error, finite};
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::sizes::sum_of_sizes;
use six_wheel_numerics::threads::workers::Workers;

/// A map of every row: of one row of numbers, or of two where it takes two, and how long it lasts [s].
#[inline]
pub fn map(
    map: Map,
    first: &[[f64; 3]],
    second: &[[f64; 3]],
    steps: Steps<'_>,
    targets: &mut [[f64; 3]],
    workers: Workers,
) -> Result<(), Error> {
    let Workers { level, .. } = workers.here();
    let share = workers.share(targets.len());
    workers.each(targets.chunks_mut(share).enumerate(), |(k, targets)| {
        let rows = k * share..k * share + targets.len();
        let second = second.get(rows.clone()).unwrap_or_default();
        let (first, steps) = (&first[rows.clone()], steps.of(rows));
        let mapped = Mapped { map, first, second, steps, targets: &mut *targets };
        if level == Level::Scalar || level.run(mapped).is_none() {
            for (k, target) in targets.iter_mut().enumerate() {
                let second = second.get(k).copied().unwrap_or_default();
                *target = map.of(first[k], second, steps.get(k));
            }
        }
        Ok(())
    })
}

/// The twists that, each held over its step, pass through the poses, one more than steps: the inverse of `integrate`.
pub fn differentiate(
    poses: &[[f64; 3]],
    steps: Steps<'_>,
    twists: &mut [[f64; 3]],
    workers: Workers,
) -> Result<(), Error> {
    debug_assert_eq!(poses.len(), twists.len() + 1);
    steps.check_positive(twists.len())?;
    if !sum_of_sizes(workers.here().level, poses.as_flattened()).is_finite() {
        for (k, pose) in poses.iter().enumerate() {
            finite("poses", pose).map_err(|error| error.at_row(k))?;
        }
    }
    let (from, to) = (&poses[..twists.len()], &poses[1..]);
    map(Map::Between, from, to, steps, twists, workers)
}
