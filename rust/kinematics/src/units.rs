//! Numbers that cannot be a rover's in metres and radians: questions, each with the unit that is likely.
//!
//! They are no errors: what is asked about is computed all the same.

use std::f64::consts::{PI, TAU};

use crate::rover_data::RoverData;
use crate::steering::SteeringRange;
use crate::table::Table;
use crate::wheels::Wheel;
use six_wheel_numerics::error::short;

/// Hub to ground of what drives [m]: the largest tyres of trucks have 2 m.
const LARGEST_RADIUS: f64 = 2.0;
/// Origin to a wheel of what drives [m].
const LARGEST_DISTANCE: f64 = 50.0;
/// A radius [m] that would be none in centimetres either.
const MILLIMETRES: f64 = 20.0;
/// Of a module that counts its turns [rad]: beyond what cables allow.
const LARGEST_RANGE: f64 = 10.0 * PI;
/// Of a heading or of rollers [rad]: places around a circle and a quarter turn come to less.
const LARGEST_DIRECTION: f64 = 2.0 * TAU;

/// What is odd about a number, and what it may have been meant as.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Question {
    /// The argument.
    pub about: &'static str,
    /// What is odd.
    pub says: String,
    /// What is likely.
    pub likely: String,
}

/// Everything that is odd about the dimensions of a rover.
#[inline]
pub fn dimensions(rover: &RoverData) -> Vec<Question> {
    let wheels = rover.wheels();
    let one_each = [lengths(wheels), exchanged(wheels), range(rover)];
    let turned = wheels.iter().find_map(direction);
    one_each.into_iter().flatten().chain(turned).collect()
}

fn lengths(wheels: &[Wheel]) -> Option<Question> {
    let radius = largest(wheels.iter().map(|wheel| wheel.radius));
    let reach = largest(wheels.iter().map(|wheel| wheel.x.abs().max(wheel.y.abs())));
    if radius <= LARGEST_RADIUS && reach <= LARGEST_DISTANCE {
        return None;
    }
    let (unit, metres) = if radius >= MILLIMETRES { ("millimetres", 1e-3) } else { ("centimetres", 1e-2) };
    Some(Question {
        about: "wheel_radius",
        says: format!("a wheel has a radius of {} m, and is {} m from the origin", digits(radius), digits(reach)),
        likely: format!(
            "lengths are in metres; in {unit} they would be {} m and {} m",
            digits(radius * metres),
            digits(reach * metres)
        ),
    })
}

/// A wheel that reaches beyond the farthest other one: of two lengths, the first is likely the second.
fn exchanged(wheels: &[Wheel]) -> Option<Question> {
    let radius = largest(wheels.iter().map(|wheel| wheel.radius));
    let apart = wheels.iter().enumerate().flat_map(|(k, one)| {
        let others = wheels[..k].iter();
        others.map(move |other| (one.x - other.x).hypot(one.y - other.y))
    });
    let apart = largest(apart);
    (apart > 0.0 && radius > apart).then(|| Question {
        about: "wheel_radius",
        says: format!(
            "a wheel has a radius of {} m, and no two wheels are more than {} m apart",
            digits(radius),
            digits(apart)
        ),
        likely: "two lengths may have changed places".into(),
    })
}

/// A wheel or rollers in a direction that is many turns round.
fn direction(wheel: &Wheel) -> Option<Question> {
    let angles = [("heading", wheel.heading), ("roller_angle", wheel.roller_angle.unwrap_or_default())];
    let far = |&(_, angle): &(&str, f64)| angle.abs() > LARGEST_DIRECTION;
    let (about, angle) = angles.into_iter().find(far)?;
    Some(Question {
        about,
        says: format!("{about} of wheel {:?} is {} rad, {} turns", wheel.name, digits(angle), digits(angle / TAU)),
        likely: in_degrees(angle),
    })
}

fn range(rover: &RoverData) -> Option<Question> {
    let wheels = rover.wheels();
    let ranges = wheels.iter().filter_map(Wheel::steering);
    let widest = largest(ranges.map(widest));
    let are_modules = rover.steered().len() == wheels.len();
    let limit = if are_modules { LARGEST_RANGE } else { TAU };
    (widest > limit).then(|| Question {
        about: "steering_limit",
        says: format!("steering_limit of {} rad is {} turns", digits(widest), digits(widest / TAU)),
        likely: in_degrees(widest),
    })
}

/// Up to which angle [`angles`] asks nothing, whichever wheel's it is [rad].
pub(crate) fn plain_angle(rover: &RoverData) -> f64 {
    let wheels = rover.wheels().iter();
    let ranges = wheels.filter_map(Wheel::steering).map(widest);
    ranges.fold(f64::INFINITY, f64::min) + PI
}

/// The first of some steering angles [rad] that lies more than half a turn beyond its joint's range. Rows are looked at
/// here and there: a log is in one unit.
pub fn angles(rover: &RoverData, table: Table<'_>, count: usize) -> Option<Question> {
    let (joints, buffer) = (rover.steered().len(), &mut Vec::new());
    if joints == 0 {
        return None;
    }
    let rows = (0..count).step_by(count.div_ceil(ROWS).max(1));
    rows.into_iter().find_map(|k| {
        let row = table.rows(k..k + 1, joints, buffer);
        let named = rover.steered().iter().zip(row);
        named.into_iter().find_map(|(&wheel, &angle)| beyond(&rover.wheels()[wheel], angle))
    })
}

/// Rows of a log that are looked at.
const ROWS: usize = 64;

fn beyond(wheel: &Wheel, angle: f64) -> Option<Question> {
    let beyond = angle.abs() - widest(wheel.steering()?);
    (angle.is_finite() && beyond > PI).then(|| Question {
        about: "steering",
        says: format!(
            "an angle of wheel {:?} is {} rad, {} turns beyond its range",
            wheel.name,
            digits(angle),
            digits(beyond / TAU)
        ),
        likely: in_degrees(angle),
    })
}

/// The larger of a range's ends [rad].
fn widest(range: SteeringRange) -> f64 {
    range.lower.abs().max(range.upper.abs())
}

fn in_degrees(angle: f64) -> String {
    let meant = short(angle.to_radians());
    format!("{} degrees are {meant} radians", digits(angle))
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// Four digits, and no more places than there are.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    format!("{rounded}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layouts::SkidCentres;
    use crate::presets;
    use crate::rover::Rover;

    #[test]
    fn published_rovers_raise_no_question() -> Result<(), six_wheel_numerics::error::Error> {
        for preset in presets::PRESETS {
            let rover = presets::preset(preset.name, None)?;
            assert_eq!(dimensions(&rover), []);
        }
        Ok(())
    }

    #[test]
    fn degrees_and_centimetres_and_exchanged_lengths_do() -> Result<(), six_wheel_numerics::error::Error> {
        let about = |rover: &Rover| dimensions(rover).first().map(|question| question.about);
        let limit = SteeringRange::symmetric(40.0)?;
        assert_eq!(about(&Rover::six_wheel([0.4, 0.5, 0.5, 0.45], 0.15, limit)?), Some("steering_limit"));
        for (track, radius) in [(50.0, 10.0), (500.0, 100.0), (0.1, 0.5)] {
            let rover = Rover::differential(track, [radius; 2], 1, 0.0, SkidCentres::default())?;
            assert_eq!(about(&rover), Some("wheel_radius"));
        }
        let ring = [[0.2, 0.0], [-0.1, 0.17], [-0.1, -0.17]];
        for (third, asked) in [(5.76, None), (330.0, Some("heading"))] {
            let rover = Rover::omni(&ring, &[0.0, 3.67, third], None, 0.05, None)?;
            assert_eq!(about(&rover), asked);
        }
        let rover = Rover::mecanum(0.3, 0.3, 0.1, 45.0)?;
        assert_eq!(about(&rover), Some("roller_angle"));
        Ok(())
    }

    #[test]
    fn angles_are_asked_about_half_a_turn_beyond_their_range() -> Result<(), six_wheel_numerics::error::Error> {
        let limit = SteeringRange::symmetric(1.0)?;
        let rover = Rover::six_wheel([0.4, 0.5, 0.5, 0.45], 0.15, limit)?;
        for (angle, asked) in [(1.0 + PI, false), (1.0 + PI + 1e-9, true), (f64::NAN, false)] {
            let row = [0.0, -angle, 0.0, 0.0];
            assert_eq!(angles(&rover, Table::Flat(&row), 1).is_some(), asked);
            assert_eq!(rover.are_plain(&row), !asked && !angle.is_nan());
        }
        let mut log = vec![0.0; 4000];
        assert_eq!(angles(&rover, Table::Flat(&log), 1000), None);
        log.fill(40.0);
        assert!(angles(&rover, Table::Flat(&log), 1000).is_some());
        Ok(())
    }
}
