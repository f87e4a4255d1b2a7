//! Maps of SE(2), register by register: from twists to poses and back, one pose after another.

use crate::geometry::{Pose, Steps, Twist};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::polynomials::{LARGEST_ANGLE, sin_cos};
use six_wheel_numerics::simd::vector::Vector;

/// Sizes whose products neither overflow nor lose digits, 0 among them. Beyond them, the plain core.
const SIZES: [f64; 2] = [1e-100, 1e100];

/// Lanes at most.
const MOST: usize = 8;

/// A map of one or two rows of three numbers, and a duration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Map {
    /// [`Twist::exp`].
    Exp,
    /// [`Pose::log`].
    Log,
    /// [`Pose::compose`] of a pose with the second one.
    Compose,
    /// The twist from a pose to the second one.
    Between,
}

impl Map {
    /// One row by the plain core.
    #[inline]
    pub fn of(self, first: [f64; 3], second: [f64; 3], dt: f64) -> [f64; 3] {
        match self {
            Self::Exp => Twist::from(first).exp(dt).into(),
            Self::Log => Pose::from(first).log(dt).into(),
            Self::Compose => Pose::from(first).compose(second.into()).into(),
            Self::Between => Pose::from(first).between(second.into()).log(dt).into(),
        }
    }
}

/// A map of rows; maps of one row have no second ones.
pub(crate) struct Mapped<'a> {
    pub map: Map,
    pub first: &'a [[f64; 3]],
    pub second: &'a [[f64; 3]],
    pub steps: Steps<'a>,
    pub targets: &'a mut [[f64; 3]],
}

/// A register of rows, and where they are of a usual size.
type Row<S> = ([Lanes<S>; 3], Mask<S>);

impl Kernel for Mapped<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let (one, zero) = (Lanes::splat(simd, 1.0), Lanes::splat(simd, 0.0));
        let size = S::F64_LANES;
        for (k, targets) in self.targets.chunks_mut(size).enumerate() {
            let rows = k * size..k * size + targets.len();
            let second = self.second.get(rows.clone()).unwrap_or_default();
            let dt = match self.steps {
                Steps::Constant(dt) => Lanes::splat(simd, dt),
                Steps::Each(dts) => {
                    let dts = &dts[rows.clone()];
                    match S::as_simd_f64s(dts).0 {
                        registers @ [_, ..] => Lanes::load(simd, registers, 0),
                        [] => {
                            let mut padded = [1.0; MOST];
                            padded[..dts.len()].copy_from_slice(dts);
                            Lanes::load(simd, S::as_simd_f64s(&padded).0, 0)
                        }
                    }
                }
            };
            let (a, b) = (read(simd, &self.first[rows.clone()]), read(simd, second));
            let (mapped, usual) = match self.map {
                Map::Exp => exp(simd, a, dt),
                Map::Log => log(simd, a, dt),
                Map::Compose => compose(simd, a, b),
                Map::Between => {
                    let (seen, usual) = between(simd, a, b);
                    let (twist, short) = log(simd, seen, dt);
                    (twist, usual & short)
                }
            };
            if targets.len() == size {
                Lanes::braid(mapped, targets.as_flattened_mut());
            } else {
                let mut placed = [0.0; 3 * MOST];
                Lanes::braid(mapped, &mut placed);
                let numbers = targets.as_flattened_mut();
                numbers.copy_from_slice(&placed[..numbers.len()]);
            }
            let usual = usual & moderate(dt);
            if (!usual).any() {
                let mut marks = [0.0; MOST];
                usual.select(zero, one).store(S::as_mut_simd_f64s(&mut marks).0, 0);
                for (j, target) in targets.iter_mut().enumerate() {
                    if marks[j] != 0.0 {
                        let k = rows.start + j;
                        let second = self.second.get(k).copied().unwrap_or_default();
                        *target = self.map.of(self.first[k], second, self.steps.get(k));
                    }
                }
            }
        }
    }
}

/// A register of rows; zeros where there are none.
#[inline(always)]
fn read<S: Vector>(simd: S, rows: &[[f64; 3]]) -> [Lanes<S>; 3] {
    let numbers = rows.as_flattened();
    if rows.len() == S::F64_LANES {
        return Lanes::unbraid(simd, numbers);
    }
    let mut padded = [0.0; 3 * MOST];
    padded[..numbers.len()].copy_from_slice(numbers);
    Lanes::unbraid(simd, &padded)
}

/// True if a number is 0 or of a usual size.
#[inline(always)]
fn moderate<S: Vector>(number: Lanes<S>) -> Mask<S> {
    let simd = number.simd();
    let [least, most] = SIZES.map(|size| Lanes::splat(simd, size));
    let size = number.abs();
    let zero = size.at_most(Lanes::splat(simd, 0.0));
    size.at_most(most) & (zero | least.at_most(size))
}

/// True if the longer one of two parts of a path is: what the shorter one loses is nothing beside it.
#[inline(always)]
fn moderate_way<S: Vector>([x, y]: [Lanes<S>; 2]) -> Mask<S> {
    moderate(x.abs().max(y.abs()))
}

/// `(x, y)` turned by an angle, by the plain core's operations.
#[inline(always)]
fn turned<S: Vector>([sin, cos]: [Lanes<S>; 2], [x, y]: [Lanes<S>; 2]) -> [Lanes<S>; 2] {
    [cos * x - sin * y, sin * x + cos * y]
}

#[inline(always)]
fn exp<S: Vector>(simd: S, [vx, vy, omega]: [Lanes<S>; 3], dt: Lanes<S>) -> Row<S> {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let yaw = omega * dt;
    let half = yaw * Lanes::splat(simd, 0.5);
    let (sin, cos) = sin_cos(simd, half);
    let straight = half.abs().at_most(zero);
    let sinc = straight.select(one, sin.quotient(straight.select(one, half)));
    let [x, y] = turned([sin, cos], [vx, vy]);
    let length = sinc * dt;
    let near = half.abs().at_most(Lanes::splat(simd, LARGEST_ANGLE));
    let usual = near & moderate_way([vx, vy]);
    ([x * length, y * length, yaw], usual)
}

/// Logarithm of motions from whose yaw no whole turns have to be taken out.
#[inline(always)]
fn log<S: Vector>(simd: S, [x, y, yaw]: [Lanes<S>; 3], dt: Lanes<S>) -> Row<S> {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let half = yaw * Lanes::splat(simd, 0.5);
    let (sin, cos) = sin_cos(simd, half);
    let straight = half.abs().at_most(zero);
    let (arc, chord) = (straight.select(one, half), straight.select(one, sin));
    let speed = arc.quotient(chord * dt);
    let [vx, vy] = turned([-sin, cos], [x, y]);
    let short = yaw.abs().at_most(Lanes::splat(simd, std::f64::consts::PI));
    let usual = short & moderate(yaw) & moderate_way([x, y]);
    ([vx * speed, vy * speed, yaw.quotient(dt)], usual)
}

#[inline(always)]
fn compose<S: Vector>(simd: S, [x, y, yaw]: [Lanes<S>; 3], [ahead, left, turn]: [Lanes<S>; 3]) -> Row<S> {
    let (sin, cos) = sin_cos(simd, yaw);
    let [dx, dy] = turned([sin, cos], [ahead, left]);
    let near = yaw.abs().at_most(Lanes::splat(simd, LARGEST_ANGLE));
    let usual = near & moderate_way([ahead, left]);
    ([x + dx, y + dy, yaw + turn], usual)
}

/// The second pose seen from the first.
#[inline(always)]
fn between<S: Vector>(simd: S, first: [Lanes<S>; 3], second: [Lanes<S>; 3]) -> Row<S> {
    let [x, y, yaw] = first;
    let (sin, cos) = sin_cos(simd, yaw);
    let [ahead, left] = turned([-sin, cos], [second[0] - x, second[1] - y]);
    let near = yaw.abs().at_most(Lanes::splat(simd, LARGEST_ANGLE));
    ([ahead, left, second[2] - yaw], near)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::admissible::tests::Numbers;
    use crate::batch;
    use six_wheel_numerics::error::Error;
    use six_wheel_numerics::simd::level::Level;
    use six_wheel_numerics::threads::workers::Workers;

    const CORNERS: [f64; 12] = [0.0, -0.0, 5e-324, -1e-310, 1e-150, 1e-9, FRAC_PI_2, PI, -PI, 7.0, 1e12, -1e200];

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
    fn registers_map_as_the_plain_core_does() -> Result<(), Error> {
        let mut numbers = Numbers(9);
        for round in 0..400 {
            let map = [Map::Exp, Map::Log, Map::Compose, Map::Between][round % 4];
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
            for level in Level::available() {
                let mut found = vec![[f64::NAN; 3]; count];
                let workers = Workers { level, ..Workers::PLAIN };
                batch::map(map, &first, &second, steps, &mut found, workers)?;
                for (k, found) in found.into_iter().enumerate() {
                    let dt = steps.get(k);
                    let plain = map.of(first[k], second[k], dt);
                    let sizes = size(map, first[k], second[k], dt);
                    for (part, (a, b)) in found.into_iter().zip(plain).enumerate() {
                        let near = 4.0 * f64::EPSILON * sizes[part].max(b.abs());
                        let same = a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
                        assert!(
                            same || (a - b).abs() <= near,
                            "{map:?} {level:?} {:?} {:?} {dt}: {a:e} {b:e}",
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
