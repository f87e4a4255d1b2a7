//! Suspicions of numbers that are implausible in metres and radians, each with the likely unit.
//!
//! They become warnings: the call computes its result regardless.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::rover_data::RoverData;
use crate::steering::SteeringRange;
use crate::table::Table;
use crate::wheels::Wheel;
use six_wheel_numerics::error::short;

/// Quantities that have a plausible range: from minus to plus [`Self::largest`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Hub to ground [m].
    Radius,
    /// Origin to a wheel [m].
    Distance,
    /// Angle of a steering joint [rad].
    SteeringAngle,
    /// Angle of a module that counts its turns [rad].
    ModuleAngle,
    /// Heading of a wheel, or angle of its rollers [rad].
    Direction,
    /// Roll, pitch or tilt of a body, or angle of a suspension joint [rad].
    Inclination,
    /// Standard deviation of a steering angle [rad].
    AngleError,
    /// Rate of a steering joint or of the body, or its standard deviation [rad/s].
    Rate,
}

impl Quantity {
    /// Largest plausible magnitude, in metres, radians and seconds; the one table for files and constructors.
    pub const fn largest(self) -> f64 {
        match self {
            Self::Radius => 2.0, // the largest tyres of trucks
            Self::Distance => 50.0,
            Self::SteeringAngle => PI,
            Self::ModuleAngle => 10.0 * PI, // beyond what cables allow
            Self::Direction => 2.0 * TAU,   // places around a circle and a quarter turn come to less
            Self::Inclination => FRAC_PI_2,
            Self::AngleError => 0.5,
            Self::Rate => 8.0 * PI,
        }
    }

    /// True if a value is larger than any plausible one in its unit. Infinity is "without a limit".
    fn excludes(self, value: f64) -> bool {
        value.is_finite() && value.abs() > self.largest()
    }
}

/// Radius from which on millimetres are likelier than centimetres, as a number in the wrong unit.
const MILLIMETRES: f64 = 20.0;

/// Suspicion about the unit of a number, with its likely explanation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitSuspicion {
    /// Name of the argument.
    pub argument: &'static str,
    /// The implausible value in words.
    pub finding: String,
    /// The likely explanation.
    pub explanation: String,
}

/// Settings that have a plausible range, by the names that `Limits`, `Noise` and `FeasibilityLimits` have for them.
pub const SETTINGS: [(&str, Quantity); 9] = [
    ("steering_limit", Quantity::SteeringAngle),
    ("steering_rate", Quantity::Rate),
    ("yaw_rate", Quantity::Rate),
    ("steering", Quantity::AngleError),
    ("roll", Quantity::Inclination),
    ("pitch", Quantity::Inclination),
    ("tilt", Quantity::Inclination),
    ("rocker", Quantity::Inclination),
    ("bogie", Quantity::Inclination),
];

/// Suspicions of settings, by their names.
pub fn settings<'a>(given: impl IntoIterator<Item = (&'a str, f64)>) -> Vec<UnitSuspicion> {
    let known = |(name, value)| {
        let found = SETTINGS.iter().find(|(setting, _)| *setting == name);
        found.map(|&(setting, quantity)| (setting, quantity, value))
    };
    arguments(given.into_iter().filter_map(known))
}

/// Suspicions of the angles of one wheel, which may be of any rover.
pub fn wheel(wheel: &Wheel) -> Vec<UnitSuspicion> {
    wheel.steering().into_iter().flat_map(steering).chain(direction(wheel)).collect()
}

/// Suspicion of the range of a steering joint.
pub fn steering(range: SteeringRange) -> Vec<UnitSuspicion> {
    arguments([("steering_limit", Quantity::SteeringAngle, widest(range))])
}

/// Suspicions of arguments of a constructor: name, quantity and value of each.
fn arguments(given: impl IntoIterator<Item = (&'static str, Quantity, f64)>) -> Vec<UnitSuspicion> {
    let odd = given.into_iter().filter(|&(_, quantity, value)| quantity.excludes(value));
    odd.map(|(argument, quantity, value)| too_large(argument, quantity, value)).collect()
}

/// A value in radians, or radians per second, that is likely one in degrees.
fn too_large(argument: &'static str, quantity: Quantity, value: f64) -> UnitSuspicion {
    let (shown, turns) = (digits(value), digits(value / TAU));
    let (finding, explanation) = match quantity {
        Quantity::Rate => (
            format!("{argument} of {shown} rad/s is {turns} turns per second"),
            format!("{shown} degrees per second are {} rad/s", short(value.to_radians())),
        ),
        _ => (format!("{argument} of {shown} rad is {turns} turns"), in_degrees(value)),
    };
    UnitSuspicion { argument, finding, explanation }
}

/// Suspicions of the dimensions of a rover.
#[inline]
pub fn dimensions(rover: &RoverData) -> Vec<UnitSuspicion> {
    let wheels = rover.wheels();
    let one_each = [lengths(wheels), exchanged(wheels), range(rover)];
    let turned = wheels.iter().find_map(direction);
    one_each.into_iter().flatten().chain(turned).collect()
}

fn lengths(wheels: &[Wheel]) -> Option<UnitSuspicion> {
    let radius = largest(wheels.iter().map(|wheel| wheel.radius));
    let reach = largest(wheels.iter().map(|wheel| wheel.x.abs().max(wheel.y.abs())));
    if !Quantity::Radius.excludes(radius) && !Quantity::Distance.excludes(reach) {
        return None;
    }
    let (unit, metres) = if radius >= MILLIMETRES { ("millimetres", 1e-3) } else { ("centimetres", 1e-2) };
    Some(UnitSuspicion {
        argument: "wheel_radius",
        finding: format!("a wheel has a radius of {} m, and is {} m from the origin", digits(radius), digits(reach)),
        explanation: format!(
            "lengths are in metres; in {unit} they would be {} m and {} m",
            digits(radius * metres),
            digits(reach * metres)
        ),
    })
}

/// A wheel radius larger than the distance of any two wheels: the two lengths are likely exchanged.
fn exchanged(wheels: &[Wheel]) -> Option<UnitSuspicion> {
    let radius = largest(wheels.iter().map(|wheel| wheel.radius));
    let apart = wheels.iter().enumerate().flat_map(|(k, one)| {
        let others = wheels[..k].iter();
        others.map(move |other| (one.x - other.x).hypot(one.y - other.y))
    });
    let apart = largest(apart);
    (apart > 0.0 && radius > apart).then(|| UnitSuspicion {
        argument: "wheel_radius",
        finding: format!(
            "a wheel has a radius of {} m, and no two wheels are more than {} m apart",
            digits(radius),
            digits(apart)
        ),
        explanation: "two lengths may have changed places".into(),
    })
}

/// Suspicion of a heading or roller angle of many turns.
fn direction(wheel: &Wheel) -> Option<UnitSuspicion> {
    let angles = [("heading", wheel.heading), ("roller_angle", wheel.roller_angle.unwrap_or_default())];
    let far = |&(_, angle): &(&str, f64)| Quantity::Direction.excludes(angle);
    let (argument, angle) = angles.into_iter().find(far)?;
    Some(UnitSuspicion {
        argument,
        finding: format!(
            "{argument} of wheel {:?} is {} rad, {} turns",
            wheel.name,
            digits(angle),
            digits(angle / TAU)
        ),
        explanation: in_degrees(angle),
    })
}

fn range(rover: &RoverData) -> Option<UnitSuspicion> {
    let wheels = rover.wheels();
    let ranges = wheels.iter().filter_map(Wheel::steering);
    let widest = largest(ranges.map(widest).filter(|angle| angle.is_finite()));
    let are_modules = rover.steered().len() == wheels.len();
    let quantity = if are_modules { Quantity::ModuleAngle } else { Quantity::SteeringAngle };
    arguments([("steering_limit", quantity, widest)]).pop()
}

/// Largest angle that is not suspicious by [`angles`], whichever wheel's it is [rad].
pub(crate) fn plain_angle(rover: &RoverData) -> f64 {
    let wheels = rover.wheels().iter();
    let ranges = wheels.filter_map(Wheel::steering).map(widest);
    ranges.fold(f64::INFINITY, f64::min) + PI
}

/// Suspicion of the first steering angle [rad] more than half a turn beyond its joint's range, among [`ROWS`] rows at
/// equal distances: all rows of a log have the same unit.
pub fn angles(rover: &RoverData, table: Table<'_>, count: usize) -> Option<UnitSuspicion> {
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

/// Rows of a log that are examined at most.
const ROWS: usize = 64;

fn beyond(wheel: &Wheel, angle: f64) -> Option<UnitSuspicion> {
    let beyond = angle.abs() - widest(wheel.steering()?);
    (angle.is_finite() && beyond > PI).then(|| UnitSuspicion {
        argument: "steering",
        finding: format!(
            "an angle of wheel {:?} is {} rad, {} turns beyond its range",
            wheel.name,
            digits(angle),
            digits(beyond / TAU)
        ),
        explanation: in_degrees(angle),
    })
}

/// The larger of a range's ends [rad].
fn widest(range: SteeringRange) -> f64 {
    range.lower.abs().max(range.upper.abs())
}

fn in_degrees(angle: f64) -> String {
    let (shown, meant) = (digits(angle), short(angle.to_radians()));
    let are = if shown == "1" { "degree is" } else { "degrees are" };
    format!("{shown} {are} {meant} radians")
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// A number rounded to four digits, without trailing zeros.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    format!("{rounded}")
}
