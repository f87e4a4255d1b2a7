//! A rover is a list of wheels, checked once; from it follow layout, inverse kinematics and the named layouts.

use nalgebra::{Matrix3, Vector2, Vector3};

use crate::error::{Error, finite, number, positive};
use crate::estimate::Factor;
use crate::geometry::Twist;
use crate::wheels::{Direction, Rows, SteeringRange, Wheel};

/// Largest number of wheels of one rover.
pub const MAX_WHEELS: usize = 64;

/// Sine of the angle up to which two headings count as parallel: rounding of a heading given in degrees.
const PARALLEL: f64 = 1e-9;

/// Fixed wheels with parallel axles. Together they allow turning about any point of one line, the mean of
/// their axles: on several axles the wheels ahead of it and behind it scrub by design.
#[derive(Clone, Debug)]
pub struct Bank {
    /// No side slip on the mean axle: this row times the twist is zero.
    pub row: Vector3<f64>,
    /// Indices of its wheels.
    pub wheels: Vec<usize>,
}

/// Whether a wheel's angle is part of the layout or of the motion.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Mount {
    /// Always in this direction: the rows are constant.
    Fixed(Rows),
    /// Steered; the direction is that of steering angle 0.
    Steered(SteeringRange, Direction),
}

/// A wheeled vehicle: its wheels, and what follows from them once and for all.
///
/// Immutable, without state: every method may be called from any number of threads.
#[derive(Clone, Debug)]
pub struct Rover {
    wheels: Vec<Wheel>,
    steered: Vec<usize>,
    pub(crate) mounts: Vec<Mount>,
    pub(crate) banks: Vec<Bank>,
    /// Mean of the pivots, about which the twist is estimated.
    pub(crate) centre: Vector2<f64>,
    /// Root mean square distance of the pivots from it.
    pub(crate) size: f64,
    /// Mean over the wheels of the squared pivot velocity, as a quadratic form of the twist.
    pub(crate) metric: Matrix3<f64>,
    /// Normal equations of the forward kinematics, where they do not depend on the steering angles.
    pub(crate) factor: Option<Factor>,
    /// Readings times this must be finite.
    pub(crate) reading_bound: f64,
    min_radius: f64,
    spin_radius: f64,
}

impl PartialEq for Rover {
    fn eq(&self, other: &Self) -> bool {
        self.wheels == other.wheels
    }
}

impl Rover {
    /// A rover of any layout. Fails if a wheel is not well formed or two share a name.
    pub fn new(wheels: Vec<Wheel>) -> Result<Self, Error> {
        if wheels.is_empty() || wheels.len() > MAX_WHEELS {
            let rule = format!("hold 1 to {MAX_WHEELS} wheels");
            return Err(Error::value("wheels", rule, wheels.len().to_string()));
        }
        for (i, wheel) in wheels.iter().enumerate() {
            wheel.check()?;
            if wheels[..i].iter().any(|other| other.name == wheel.name) {
                let rule = "have a name each";
                return Err(Error::value(
                    "wheels",
                    rule,
                    format!("{:?} twice", wheel.name),
                ));
            }
        }
        let steered = (0..wheels.len())
            .filter(|&i| wheels[i].steering.is_some())
            .collect();
        let banks = banks(&wheels);
        let mounts = mounts(&wheels, &banks);
        let pivots = || wheels.iter().map(|wheel| Vector2::new(wheel.x, wheel.y));
        let count = wheels.len() as f64;
        let centre = pivots().sum::<Vector2<f64>>() / count;
        let spread = pivots()
            .map(|pivot| (pivot - centre).norm_squared())
            .sum::<f64>()
            / count;
        // All pivots on one point: any length will do, so take that of the wheels.
        let size = if spread > 0.0 {
            spread.sqrt()
        } else {
            wheels[0].radius
        };
        let square = centre.norm_squared() + size * size;
        let metric = Matrix3::new(
            1.0, 0.0, -centre.y, //
            0.0, 1.0, centre.x, //
            -centre.y, centre.x, square,
        );
        if !square.is_finite() {
            let rule = "have pivots at a finite distance";
            return Err(Error::value("wheels", rule, number(square)));
        }
        let lengths = |wheel: &Wheel| wheel.radius + wheel.scrub.abs() + wheel.trail.abs();
        let reading_bound =
            wheels.iter().map(lengths).sum::<f64>() * (square + 1.0) / (size * size);
        let mut rover = Self {
            wheels,
            steered,
            mounts,
            banks,
            centre,
            size,
            metric,
            factor: None,
            reading_bound,
            min_radius: 0.0,
            spin_radius: f64::INFINITY,
        };
        rover.factor = rover.constant_factor();
        (rover.min_radius, rover.spin_radius) = rover.turning_limits();
        Ok(rover)
    }

    /// The six-wheel rover with four steered corners: the unsteered middle wheels at x = 0.
    ///
    /// `d1` half track of the corners, `d2` centre to rear axle, `d3` centre to front axle, `d4` half track
    /// of the middle wheels [m].
    pub fn six_wheel(
        [d1, d2, d3, d4]: [f64; 4],
        wheel_radius: f64,
        steering: SteeringRange,
    ) -> Result<Self, Error> {
        positive("d1", d1)?;
        positive("d2", d2)?;
        positive("d3", d3)?;
        if !(d4.is_finite() && d4 >= 0.0) {
            return Err(Error::value("d4", "be finite and not negative", number(d4)));
        }
        positive("wheel_radius", wheel_radius)?;
        steering.check()?;
        let corner = |name: &str, x, y| Wheel::new(name, x, y, wheel_radius).steered(steering);
        let middle = |name: &str, y| Wheel::new(name, 0.0, y, wheel_radius);
        Self::new(vec![
            corner("front_left", d3, d1),
            corner("front_right", d3, -d1),
            middle("middle_left", d4),
            middle("middle_right", -d4),
            corner("rear_left", -d2, d1),
            corner("rear_right", -d2, -d1),
        ])
    }

    /// The arguments of [`Self::six_wheel`] that make this very rover, if any do.
    pub fn as_six_wheel(&self) -> Option<([f64; 4], f64, SteeringRange)> {
        let [front, _, middle, _, rear, _] = self.wheels.as_slice() else {
            return None;
        };
        let dimensions = [front.y, -rear.x, front.x, middle.y];
        let range = front.steering?;
        let rebuilt = Self::six_wheel(dimensions, front.radius, range).ok()?;
        (rebuilt == *self).then_some((dimensions, front.radius, range))
    }

    /// The wheels, in the order of every array.
    pub fn wheels(&self) -> &[Wheel] {
        &self.wheels
    }

    /// Indices of the steered wheels, in the order of the steering arrays.
    pub fn steered(&self) -> &[usize] {
        &self.steered
    }

    /// The lines on which the fixed wheels allow the centre of rotation.
    pub fn banks(&self) -> &[Bank] {
        &self.banks
    }

    /// Every turning radius of at least this size is possible [m]; 0 if all are, infinite if none is.
    ///
    /// The centre of rotation lies on the line of the fixed wheels, or abreast of the body's origin if
    /// there are none; the radius counts from the foot of the origin on that line.
    pub fn min_radius(&self) -> f64 {
        self.min_radius
    }

    /// Every turning radius of at most this size is possible [m]; 0 if the rover cannot spin at all.
    pub fn spin_radius(&self) -> f64 {
        self.spin_radius
    }

    /// The wheel equation solved for the wheels: steering angles [rad] and wheel speeds [rad/s].
    ///
    /// `previous` angles say what a wheel at rest holds and which of its equivalent angles is nearer
    /// (default 0); `steering_rates` [rad/s] matter to wheels with scrub or trail (default 0). Nothing is
    /// written unless [`Self::check`] passes.
    pub fn inverse(
        &self,
        twist: Twist,
        previous: Option<&[f64]>,
        steering_rates: Option<&[f64]>,
        steering: &mut [f64],
        speeds: &mut [f64],
    ) -> Result<(), Error> {
        self.check_inputs(previous, steering_rates)?;
        self.check(twist, steering_rates)?;
        self.solve(twist, previous, steering_rates, steering, speeds);
        Ok(())
    }

    /// Fails unless the optional inputs of [`Self::inverse`] are finite.
    pub(crate) fn check_inputs(
        &self,
        previous: Option<&[f64]>,
        steering_rates: Option<&[f64]>,
    ) -> Result<(), Error> {
        finite("previous", previous.unwrap_or_default())?;
        finite("steering_rates", steering_rates.unwrap_or_default())
    }

    /// [`Self::inverse`] of a twist that has been checked.
    pub(crate) fn solve(
        &self,
        twist: Twist,
        previous: Option<&[f64]>,
        steering_rates: Option<&[f64]>,
        steering: &mut [f64],
        speeds: &mut [f64],
    ) {
        let vector = Vector3::from(twist);
        let mut joint = 0;
        for ((wheel, mount), speed) in self.wheels.iter().zip(&self.mounts).zip(speeds) {
            let rim_speed = match *mount {
                Mount::Fixed(rows) => rows.rolling.dot(&vector),
                Mount::Steered(range, heading) => {
                    let at = |values: Option<&[f64]>| values.map_or(0.0, |values| values[joint]);
                    let command =
                        wheel.steer(range, heading, twist, at(steering_rates), at(previous));
                    steering[joint] = command.angle;
                    joint += 1;
                    command.rim_speed
                }
            };
            *speed = rim_speed / wheel.radius;
        }
    }
}

/// Groups the fixed wheels by the direction of their axles and averages each group's side-slip row.
fn banks(wheels: &[Wheel]) -> Vec<Bank> {
    let mut banks: Vec<Bank> = Vec::new();
    let fixed = wheels
        .iter()
        .enumerate()
        .filter(|(_, wheel)| wheel.steering.is_none());
    for (i, wheel) in fixed {
        let row = wheel.rows(Direction::from(wheel.heading)).side_slip;
        let parallel =
            |bank: &&mut Bank| (bank.row.x * row.y - bank.row.y * row.x).abs() <= PARALLEL;
        match banks.iter_mut().find(parallel) {
            Some(bank) => {
                // The normal may point the other way: the wheel then rolls the bank's way backwards.
                let same_way = (bank.row.x * row.x + bank.row.y * row.y).signum();
                let count = bank.wheels.len() as f64;
                bank.row.z += (same_way * row.z - bank.row.z) / (count + 1.0);
                bank.wheels.push(i);
            }
            None => banks.push(Bank {
                row,
                wheels: vec![i],
            }),
        }
    }
    banks
}

/// What each wheel contributes: constant rows, with the bank's line for its own, or a steering range.
fn mounts(wheels: &[Wheel], banks: &[Bank]) -> Vec<Mount> {
    let mount = |(i, wheel): (usize, &Wheel)| {
        let direction = Direction::from(wheel.heading);
        if let Some(range) = wheel.steering {
            return Mount::Steered(range, direction);
        }
        let mut rows = wheel.rows(direction);
        for bank in banks.iter().filter(|bank| bank.wheels.contains(&i)) {
            rows.side_slip = bank.row;
        }
        Mount::Fixed(rows)
    };
    wheels.iter().enumerate().map(mount).collect()
}
