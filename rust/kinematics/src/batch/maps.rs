//! Maps between twists and poses, row by row.

use crate::geometry::Steps;
use crate::se2::angles::MAX_LANES;
pub use crate::se2::maps::Map;
use six_wheel_numerics::error::{Error, LARGEST, bounded};
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::sizes::sum_of_sizes;
use six_wheel_numerics::threads::workers::Workers;

/// A map of every row of `first`, or of every pair of rows of `first` and `second`, with the duration of its step [s].
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
    workers.for_each(targets.chunks_mut(share).enumerate(), |(k, targets)| {
        let rows = k * share..k * share + targets.len();
        let second = second.get(rows.clone()).unwrap_or_default();
        let (first, steps) = (&first[rows.clone()], steps.of(rows));
        level.run_any(MapRange { map, first, second, steps, targets });
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
    let sum = sum_of_sizes(workers.here().level, poses.as_flattened());
    if sum.is_nan() || sum >= LARGEST {
        for (k, pose) in poses.iter().enumerate() {
            bounded("poses", pose).map_err(|error| error.at_row(k))?;
        }
    }
    let (from, to) = (&poses[..twists.len()], &poses[1..]);
    map(Map::Between, from, to, steps, twists, workers)
}

/// Rows of one thread; maps of one row have no second ones.
struct MapRange<'a> {
    map: Map,
    first: &'a [[f64; 3]],
    second: &'a [[f64; 3]],
    steps: Steps<'a>,
    targets: &'a mut [[f64; 3]],
}

impl Kernel for MapRange<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let size = S::F64_LANES;
        for (k, targets) in self.targets.chunks_mut(size).enumerate() {
            let rows = k * size..k * size + targets.len();
            let second = self.second.get(rows.clone()).unwrap_or_default();
            let (first, second) = (load(simd, &self.first[rows.clone()]), load(simd, second));
            let dt = match self.steps {
                Steps::Constant(dt) => Lanes::splat(simd, dt),
                Steps::Each(dts) => load_durations(simd, &dts[rows]),
            };
            let mapped = self.map.lanes(simd, first, second, dt);
            if targets.len() == size {
                Lanes::interleave3(mapped, targets.as_flattened_mut());
            } else {
                let mut numbers = [0.0; 3 * MAX_LANES];
                Lanes::interleave3(mapped, &mut numbers);
                let targets = targets.as_flattened_mut();
                targets.copy_from_slice(&numbers[..targets.len()]);
            }
        }
    }
}

/// A register of rows; zeros where there are none.
#[inline(always)]
fn load<S: Vector>(simd: S, rows: &[[f64; 3]]) -> [Lanes<S>; 3] {
    let numbers = rows.as_flattened();
    if rows.len() == S::F64_LANES {
        return Lanes::deinterleave3(simd, numbers);
    }
    let mut padded = [0.0; 3 * MAX_LANES];
    padded[..numbers.len()].copy_from_slice(numbers);
    Lanes::deinterleave3(simd, &padded)
}

/// A register of durations; 1 s where there are none.
#[inline(always)]
fn load_durations<S: Vector>(simd: S, dts: &[f64]) -> Lanes<S> {
    if let registers @ [_, ..] = S::as_simd_f64s(dts).0 {
        return Lanes::load(simd, registers, 0);
    }
    let mut padded = [1.0; MAX_LANES];
    padded[..dts.len()].copy_from_slice(dts);
    Lanes::load(simd, S::as_simd_f64s(&padded).0, 0)
}
