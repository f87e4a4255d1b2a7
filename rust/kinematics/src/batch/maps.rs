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

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use nalgebra::{Rotation2, Vector2};

    use super::*;
    use crate::admissible::tests::Numbers;
    use crate::geometry::wrap_angle;
    use six_wheel_numerics::simd::level::Level;

    const CORNERS: [f64; 12] = [0.0, -0.0, 5e-324, -1e-310, 1e-150, 1e-9, FRAC_PI_2, PI, -PI, 7.0, 1e12, -1e200];

    /// The map by the functions of the standard library.
    fn expected(map: Map, first: [f64; 3], second: [f64; 3], dt: f64) -> [f64; 3] {
        let sinc = |x: f64| if x == 0.0 { 1.0 } else { x.sin() / x };
        let [x, y, yaw] = first;
        let chord = Vector2::new(x, y);
        let log = |chord: Vector2<f64>, yaw: f64| {
            let yaw = wrap_angle(yaw);
            let linear = Rotation2::new(-yaw / 2.0) * chord / (sinc(yaw / 2.0) * dt);
            [linear.x, linear.y, yaw / dt]
        };
        match map {
            Map::Exp => {
                let half = yaw * dt / 2.0;
                let chord = Rotation2::new(half) * chord * (sinc(half) * dt);
                [chord.x, chord.y, yaw * dt]
            }
            Map::Log => log(chord, yaw),
            Map::Compose => {
                let shift = Rotation2::new(yaw) * Vector2::new(second[0], second[1]);
                [x + shift.x, y + shift.y, yaw + second[2]]
            }
            Map::Between => log(Rotation2::new(-yaw) * Vector2::new(second[0] - x, second[1] - y), second[2] - yaw),
        }
    }

    /// The size of the terms of a result: where they cancel, their rounding stays.
    fn size(map: Map, first: [f64; 3], second: [f64; 3], dt: f64) -> [f64; 3] {
        let way = |row: [f64; 3]| row[0].abs() + row[1].abs();
        match map {
            Map::Exp => [way(first) * dt, way(first) * dt, 0.0],
            Map::Log => [2.0 * way(first) / dt, 2.0 * way(first) / dt, 0.0],
            Map::Compose => [way(first) + way(second); 3],
            Map::Between => [2.0 * (way(first) + way(second)) / dt; 3],
        }
    }

    #[test]
    fn every_level_maps_rows_as_the_standard_library_does() -> Result<(), Error> {
        let mut numbers = Numbers(9);
        for round in 0..400 {
            let kind = [Map::Exp, Map::Log, Map::Compose, Map::Between][round % 4];
            let count = [1, 2, 7, 8, 9, 64, 131][round % 7];
            let mut rows = || -> Vec<[f64; 3]> {
                (0..count)
                    .map(|k| {
                        let mut number = || match numbers.between(0.0, 6.0) as usize {
                            0 => CORNERS[(numbers.between(0.0, 12.0) as usize).min(11)],
                            _ => numbers.between(-4.0, 4.0),
                        };
                        if k % 3 == 0 { [number(), number(), number()] } else { [0.5, number(), 0.1 * number()] }
                    })
                    .collect()
            };
            let (first, second) = (rows(), rows());
            let dts: Vec<_> = (0..count).map(|_| numbers.between(0.001, 2.0)).collect();
            let steps = if round % 3 == 0 { Steps::Constant(0.1) } else { Steps::Each(&dts) };
            let one = |k: usize| kind.of(first[k], second[k], steps.get(k));
            for level in Level::available() {
                let mut found = vec![[f64::NAN; 3]; count];
                map(kind, &first, &second, steps, &mut found, Workers { level, ..Workers::PLAIN })?;
                for (k, found) in found.into_iter().enumerate() {
                    let dt = steps.get(k);
                    let bits = |row: [f64; 3]| row.map(|number| if number.is_nan() { 0 } else { number.to_bits() });
                    assert_eq!(bits(found), bits(one(k)), "{kind:?} {level:?}");
                    let sizes = size(kind, first[k], second[k], dt);
                    let expected = expected(kind, first[k], second[k], dt);
                    for (part, (a, b)) in found.into_iter().zip(expected).enumerate() {
                        let near = 4.0 * f64::EPSILON * sizes[part].max(b.abs());
                        let same = a == b || (a.is_nan() && b.is_nan());
                        assert!(
                            same || (a - b).abs() <= near,
                            "{kind:?} {level:?} {:?} {:?} {dt}: {a:e} {b:e}",
                            first[k],
                            second[k]
                        );
                    }
                }
            }
        }
        Ok(())
    }
}
