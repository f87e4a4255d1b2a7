//! The projection by faces against one that tries every face anew, by the definition.

use nalgebra::{Cholesky, Matrix3, Vector3};

use super::Keep;
use super::faces::VANISHED;
use super::faces::components;
use crate::batch;
use crate::geometry::Twist;
use crate::rover::Rover;
use crate::steering::SteeringRange;
use crate::wheels::{Pivot, Wheel};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::jacobi::Jacobi;

/// A linear condition: the row times the twist is the value.
type Condition = (Vector3<f64>, f64);

const KEEPS: [Keep; 4] = [Keep::Curvature, Keep::Speed, Keep::YawRate, Keep::Nearest];

/// The point nearest to a twist where all conditions hold, if they agree.
fn closest(rover: &Rover, wanted: Twist, conditions: &[Condition]) -> Option<Twist> {
    // With metric = L Lᵀ and t = t0 + L⁻ᵀ y, the distance is |y|.
    let to_twist = Cholesky::new(rover.metric)?.l().transpose().try_inverse()?;
    let mut normal = Matrix3::zeros();
    let scale = |(row, value): &Condition| {
        let row = to_twist.transpose() * row;
        let length = row.norm();
        (row / length, value / length)
    };
    let scaled: Vec<Condition> = conditions.iter().map(scale).collect();
    for (row, _) in &scaled {
        normal += row * row.transpose();
    }
    let inverse = Jacobi::new(&normal).inverse(1e-12);
    let start = to_twist.try_inverse()? * Vector3::from(wanted);
    let mut point = start;
    // The second round removes the rounding of the first, which is of the size of the wanted twist.
    for _ in 0..2 {
        let mut gradient = Vector3::zeros();
        for (row, value) in &scaled {
            gradient += row * (value - row.dot(&point));
        }
        point += inverse * gradient;
    }
    let size = start.amax();
    let agree = scaled.iter().all(|(row, value)| (row.dot(&point) - value).abs() <= 1e-9 * size);
    let lengths = Vector3::new(1.0, 1.0, rover.size);
    let found = (to_twist * point).zip_map(
        &lengths,
        |part, length| {
            if part.abs() * length <= VANISHED * size { 0.0 } else { part }
        },
    );
    agree.then(|| found.into())
}

fn distance(rover: &Rover, a: Twist, b: Twist) -> f64 {
    let change = Vector3::from(a) - Vector3::from(b);
    change.dot(&(rover.metric * change)).sqrt()
}

/// The nearest admissible twist under linear conditions: no limit, every one and every pair of them.
fn nearest(rover: &Rover, wanted: Twist, keep: Keep) -> Option<Twist> {
    let target = Vector3::from(wanted);
    let unit = |k: usize| Matrix3::<f64>::identity().column(k).into_owned();
    let kept = components(keep).iter().map(|&k| (unit(k), target[k]));
    let banks = rover.banks.iter().map(|bank| (bank.row, 0.0));
    let mut conditions: Vec<Condition> = banks.chain(kept.clone()).collect();
    let limits = rover.limit_rows();
    let mut best: Option<(f64, Twist)> = None;
    let mut attempt = |conditions: &[Condition]| {
        let Some(found) = closest(rover, wanted, conditions) else {
            return;
        };
        let distance = distance(rover, found, wanted);
        let better = best.is_none_or(|(least, _)| distance < least);
        if better && rover.check(found, None).is_ok() {
            best = Some((distance, found));
        }
    };
    attempt(&conditions);
    for (k, &first) in limits.iter().enumerate() {
        conditions.push((first, 0.0));
        attempt(&conditions);
        for &second in &limits[k + 1..] {
            conditions.push((second, 0.0));
            attempt(&conditions);
            conditions.pop();
        }
        conditions.pop();
    }
    if kept.into_iter().all(|(_, value)| value == 0.0) {
        attempt(&[0, 1, 2].map(|k| (unit(k), 0.0)));
    }
    best.map(|(_, twist)| twist)
}

/// Scales a twist so that neither its forward speed nor its yaw rate exceeds the wanted one.
fn shrink(found: Twist, wanted: Twist) -> Twist {
    let share = |found: f64, wanted: f64| if found.abs() <= wanted.abs() { 1.0 } else { wanted.abs() / found.abs() };
    let scale = share(found.vx, wanted.vx).min(share(found.omega, wanted.omega));
    Twist::from(Vector3::from(found) * scale)
}

fn project(rover: &Rover, wanted: Twist, keep: Keep) -> Option<Twist> {
    if rover.check(wanted, None).is_ok() {
        return Some(wanted);
    }
    match (keep, nearest(rover, wanted, keep)) {
        (Keep::Curvature, None) => nearest(rover, wanted, Keep::Nearest).map(|found| shrink(found, wanted)),
        (_, found) => found,
    }
}

/// Numbers between 0 and 1, the same every time.
pub(crate) struct Numbers(pub u64);

impl Numbers {
    #[inline]
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    #[inline]
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    pub fn chance(&mut self, share: f64) -> bool {
        self.next() < share
    }

    /// Any wheels: fixed and steered, in ranges of any width, symmetric or not, some with scrub or trail.
    pub fn rover(&mut self) -> Result<Rover, Error> {
        let count = 2 + (self.next() * 5.0) as usize;
        let symmetric = self.chance(0.5);
        let limit = self.between(0.1, 1.7);
        let mut wheels = Vec::new();
        for i in 0..count {
            let (x, y) = (self.between(-1.0, 1.0), self.between(-1.0, 1.0));
            let mut wheel = Wheel::new(format!("w{i}"), x, y, self.between(0.05, 0.2));
            if symmetric && i % 2 == 1 {
                let other: &Wheel = &wheels[i - 1];
                (wheel.x, wheel.y) = (other.x, -other.y);
            }
            if self.chance(0.7) {
                let range = if self.chance(0.6) {
                    SteeringRange::symmetric(limit)?
                } else {
                    let lower = self.between(-1.5, 0.5);
                    SteeringRange { lower, upper: lower + self.between(0.1, 2.5) }
                };
                wheel = wheel.steered(range);
                if self.chance(0.2) {
                    wheel.heading = self.between(-3.0, 3.0);
                }
                if self.chance(0.1) {
                    wheel.scrub = self.between(-0.1, 0.1);
                }
                if self.chance(0.05) {
                    wheel.trail = self.between(-0.1, 0.1);
                }
            } else if self.chance(0.1) {
                wheel.heading = self.between(-1.0, 1.0);
            } else if self.chance(0.2) {
                wheel.trail = self.between(-0.1, 0.1);
                wheel.pivot = Pivot::Castor;
            }
            wheels.push(wheel);
        }
        Rover::new(wheels)
    }

    /// Of any size, sometimes with zeros.
    pub fn twist(&mut self) -> Twist {
        let size = 10_f64.powf(self.between(-3.0, 3.0));
        let mut part = || {
            if self.chance(0.1) { 0.0 } else { self.between(-size, size) }
        };
        let (vx, vy, omega) = (part(), part(), part());
        Twist { vx, vy, omega }
    }
}

#[test]
fn the_faces_of_any_layout_lead_to_the_nearest_twist() -> Result<(), Error> {
    let mut numbers = Numbers(7);
    for _ in 0..400 {
        let rover = numbers.rover()?;
        for k in 0..40 {
            let wanted = numbers.twist();
            let keep = KEEPS[k % 4];
            let expected = project(&rover, wanted, keep);
            let found = rover.project(wanted, keep).ok();
            let size = distance(&rover, wanted, Twist::default());
            let (Some(expected), Some(found)) = (expected, found) else {
                assert_eq!(expected.is_some(), found.is_some(), "{rover:?} {wanted:?} {keep:?}");
                continue;
            };
            assert!(rover.cone.is_possible(found), "{wanted:?} {keep:?}: {found:?} not {expected:?} {rover:?}");
            // To rounding, of one face; of two that are equally near, either will do.
            let further = distance(&rover, found, wanted) - distance(&rover, expected, wanted);
            let apart = distance(&rover, found, expected);
            assert!(
                apart <= 1e-9 * size || further.abs() <= 1e-12 * size,
                "{wanted:?} {keep:?}: {found:?} is not {expected:?}; {further} {apart} {size} {rover:?}"
            );
        }
    }
    Ok(())
}

#[test]
fn every_level_projects_and_judges_alike() -> Result<(), Error> {
    let mut numbers = Numbers(70);
    for _ in 0..300 {
        let rover = numbers.rover()?;
        let mut twists: Vec<[f64; 3]> = (0..131).map(|_| numbers.twist().into()).collect();
        for (k, keep) in KEEPS.into_iter().enumerate() {
            let Ok(found) = (twists.iter())
                .map(|twist| rover.project((*twist).into(), keep).map(<[f64; 3]>::from))
                .collect::<Result<Vec<_>, Error>>()
            else {
                continue;
            };
            let workers = batch::Workers { level: batch::Level::best(), fresh: k % 2 == 0, ..batch::Workers::PLAIN };
            for level in batch::Level::available() {
                let mut projected = vec![[0.0; 3]; twists.len()];
                batch::project(&rover, &twists, keep, &mut projected, batch::Workers { level, ..workers })?;
                assert_eq!(projected, found, "{keep:?} {level:?} {rover:?}");
            }
            for (twist, found) in twists.iter().zip(&found) {
                let one = batch::project_one(&rover, (*twist).into(), keep)?;
                assert_eq!(<[f64; 3]>::from(one), *found, "{keep:?} {rover:?}");
            }
            // The result is possible, at an end of a range or not, and the next are close to it.
            let shift = |part: &mut f64| *part *= 1.0 + 1e-9 * numbers.between(-2.0, 2.0);
            found.iter().flatten().zip(twists.iter_mut().flatten()).for_each(|(from, to)| *to = *from);
            if k > 1 {
                twists.iter_mut().flatten().for_each(shift);
            }
            let mut answers = vec![false; twists.len()];
            batch::admissible(&rover, &twists, &mut answers, workers)?;
            for (twist, answer) in twists.iter().zip(answers) {
                let twist = Twist::from(*twist);
                assert_eq!(answer, rover.check(twist, None).is_ok(), "{twist:?} {rover:?}");
                assert_eq!(answer, batch::admissible_one(&rover, twist)?);
            }
        }
    }
    Ok(())
}

#[test]
fn wheels_that_are_nearly_parallel_have_no_plane_in_common() -> Result<(), Error> {
    let (a, mut b) = (Wheel::new("a", 0.0, 0.2, 0.1), Wheel::new("b", 0.0, -0.2, 0.1));
    b.heading = 5e-7;
    let rover = Rover::new(vec![a, b])?;
    let found = rover.project((Vector3::new(1.0, 0.3, 0.5)).into(), Keep::Nearest)?;
    assert!(rover.check(found, None).is_ok(), "{found:?}");
    Ok(())
}
