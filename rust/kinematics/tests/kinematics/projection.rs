//! The projection by faces against one that tries every face anew, by the definition.

use nalgebra::{Cholesky, Matrix3, Vector3};
use six_wheel_kinematics::admissible::Keep;
use six_wheel_kinematics::batch;
use six_wheel_kinematics::geometry::{Direction, Twist};
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::wheels::Wheel;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::jacobi::Jacobi;

use crate::random::Numbers;

/// Share of a twist's size below which a component of it is rounding.
const VANISHED: f64 = 1e-14;

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

/// Components that are kept: indices into the twist.
fn components(keep: Keep) -> &'static [usize] {
    match keep {
        Keep::Curvature => &[0, 2],
        Keep::Speed => &[0],
        Keep::YawRate => &[2],
        Keep::Nearest => &[],
    }
}

/// Rows that are 0 where a steered wheel rolls at an end of its range, of those that limit the twist.
fn limit_rows(rover: &Rover) -> Vec<Vector3<f64>> {
    let ends = |wheel: &Wheel| {
        let range = wheel.steering().filter(|range| !range.is_full() || wheel.trail != 0.0)?;
        let row = |angle: f64| wheel.rows(Direction::from(wheel.heading + angle)).side_slip;
        Some([row(range.lower), row(range.upper)])
    };
    rover.wheels().iter().filter_map(ends).flatten().collect()
}

/// The nearest admissible twist under linear conditions: no limit, every one and every pair of them.
fn nearest(rover: &Rover, wanted: Twist, keep: Keep) -> Option<Twist> {
    let target = Vector3::from(wanted);
    let unit = |k: usize| Matrix3::<f64>::identity().column(k).into_owned();
    let kept = components(keep).iter().map(|&k| (unit(k), target[k]));
    let banks = rover.banks.iter().map(|bank| (bank.row, 0.0));
    let mut conditions: Vec<Condition> = banks.chain(kept.clone()).collect();
    let limits = limit_rows(rover);
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
            assert!(rover.admissible(found)?, "{wanted:?} {keep:?}: {found:?} not {expected:?} {rover:?}");
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
                let one = rover.project((*twist).into(), keep)?;
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
                assert_eq!(answer, rover.admissible(twist)?);
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
