//! The data of a rover: a list of wheels, checked once, and what follows from them without any kernel.

use nalgebra::{Matrix3, Vector2, Vector3};

use crate::geometry::Direction;
use crate::steering::{MEASURED_SLACK, SteeringRange};
use crate::wheels::{Pivot, Rows, Wheel};
use six_wheel_numerics::error::{Error, finite, numbers};

/// Largest number of wheels of one rover.
pub const MAX_WHEELS: usize = 64;

/// Sine of the angle up to which two headings count as parallel: rounding of a heading given in degrees.
const PARALLEL: f64 = 1e-9;

/// Least size of a rover in its metric, as a share of the distance of its pivots from the origin: below 1e-8, rounding
/// of squared distances exceeds the squared size.
const CLOSE: f64 = 1e-6;

/// Sine of the angle between two axles, 10 degrees, from which on fixed wheels have weight 0 in each other's side-slip
/// rows: more than any misalignment, less than any intended angle.
const ASIDE: f64 = 0.173_648_177_666_930_33;

/// A bank: the fixed wheels with parallel axles. They allow rotation about any point of one line, the mean of their
/// axles: on several axles the wheels ahead of it and behind it slide sideways by design.
#[derive(Clone, Debug)]
pub struct Bank {
    /// No side slip on the mean axle: this row times the twist is zero.
    pub row: Vector3<f64>,
    /// Indices of its wheels.
    pub wheels: Vec<usize>,
}

/// The angle of a wheel as part of the layout or of the motion.
#[derive(Clone, Copy, Debug)]
pub enum Mount {
    /// Always in this direction: the rows are constant.
    Fixed(Rows),
    /// Steered; the direction is that of steering angle 0.
    Steered(SteeringRange, Direction),
    /// Free to swivel.
    Castor(Direction),
}

/// The data of a wheeled vehicle: its wheels, checked, and what follows from them alone. Every kernel takes it.
///
/// Immutable, without state: every method may be called from any number of threads.
#[derive(Clone, Debug)]
pub struct RoverData {
    wheels: Vec<Wheel>,
    steered: Vec<usize>,
    /// Constants of every wheel, by its kind.
    pub mounts: Vec<Mount>,
    /// Groups of fixed wheels with parallel axles: the lines on which they allow the centre of rotation.
    pub banks: Vec<Bank>,
    /// Mean of the pivots [m], about which the twist is estimated.
    pub centre: Vector2<f64>,
    /// Root mean square distance of the pivots from it [m]: the size of the rover.
    pub size: f64,
    /// Mean over the wheels of the squared pivot velocity [m²/s²], as a quadratic form of the twist; positive definite.
    pub metric: Matrix3<f64>,
    /// Solution of the normal equations of the forward kinematics, where it does not depend on the steering angles.
    pub solution: Option<Matrix3<f64>>,
    /// Bound of the twist per reading: readings times this must be finite.
    pub reading_bound: f64,
}

impl RoverData {
    /// Fails if a wheel is not well formed or two share a name. `solution` is None; [`crate::rover::Rover::new`] sets
    /// it.
    pub fn new(wheels: Vec<Wheel>) -> Result<Self, Error> {
        if wheels.is_empty() || wheels.len() > MAX_WHEELS {
            return Err(Error::value("wheels", format!("hold 1 to {MAX_WHEELS} wheels"), wheels.len()));
        }
        for (i, wheel) in wheels.iter().enumerate() {
            wheel.check()?;
            if wheels[..i].iter().any(|other| other.name == wheel.name) {
                return Err(Error::value("wheels", "have a name each", format!("{:?} twice", wheel.name)));
            }
        }
        let steered = (0..wheels.len()).filter(|&i| wheels[i].steering().is_some()).collect();
        let banks = banks(&wheels);
        let mounts = mounts(&wheels, &banks);
        let pivots = || wheels.iter().map(|wheel| Vector2::new(wheel.x, wheel.y));
        let count = wheels.len() as f64;
        let centre = pivots().sum::<Vector2<f64>>() / count;
        let spread = pivots().map(|pivot| (pivot - centre).norm_squared()).sum::<f64>() / count;
        // If all pivots coincide, any length serves as the size: the radius of a wheel.
        let size = if spread > 0.0 { spread.sqrt() } else { wheels[0].radius };
        // So that the metric is positive definite for pivots that are close together and far from the origin.
        let turned = size.max(CLOSE * centre.norm());
        let square = centre.norm_squared() + turned * turned;
        let metric = Matrix3::new(
            1.0, 0.0, -centre.y, //
            0.0, 1.0, centre.x, //
            -centre.y, centre.x, square,
        );
        let lengths = |wheel: &Wheel| wheel.radius + wheel.scrub.abs() + wheel.trail.abs();
        let reading_bound = wheels.iter().map(lengths).sum::<f64>() * (square + 1.0) / (size * size);
        Ok(Self { wheels, steered, mounts, banks, centre, size, metric, solution: None, reading_bound })
    }

    /// The wheels, in the order of every array.
    #[inline]
    pub fn wheels(&self) -> &[Wheel] {
        &self.wheels
    }

    /// Indices of the steered wheels, in the order of the steering arrays.
    #[inline]
    pub fn steered(&self) -> &[usize] {
        &self.steered
    }

    /// Fails unless there is a finite angle [rad] for every steered wheel, near its range at least
    /// ([`SteeringRange::is_near`]).
    pub fn check_measured(&self, argument: &'static str, angles: &[f64]) -> Result<(), Error> {
        if angles.len() != self.steered.len() {
            let rule = format!("have {} angles, one per steered wheel", self.steered.len());
            return Err(Error::value(argument, rule, angles.len()));
        }
        finite(argument, angles)?;
        for (angle, &i) in angles.iter().zip(&self.steered) {
            let range = self.wheels[i].steering().unwrap_or_default();
            if !range.is_near(*angle) {
                let name = &self.wheels[i].name;
                let rule =
                    format!("be inside the steering range, {range}, of wheel {name:?} (to {MEASURED_SLACK} rad)");
                return Err(Error::value(argument, rule, numbers(angles)));
            }
        }
        Ok(())
    }

    /// Brings angles of the steered wheels into their ranges.
    pub fn clip_steering(&self, angles: &mut [f64]) {
        for (angle, &i) in angles.iter_mut().zip(&self.steered) {
            *angle = self.wheels[i].steering().unwrap_or_default().clip(*angle);
        }
    }
}

/// Optional inputs of the inverse beside the twist, one value per steered wheel or per wheel.
#[derive(Clone, Copy, Debug)]
pub struct OptionalInputs<T> {
    /// Present steering angles [rad]: held by wheels at rest, and nearest to these of equivalent angles. Default 0.
    pub previous: Option<T>,
    /// Present wheel speeds [rad/s]: their signs decide direction ties. Default 0.
    pub previous_speeds: Option<T>,
    /// Rates of the steering angles [rad/s]; they matter to wheels with scrub or trail. Default 0.
    pub steering_rates: Option<T>,
}

/// Inputs of one row, or of many, row after row.
pub type Inputs<'a> = OptionalInputs<&'a [f64]>;

impl<T> Default for OptionalInputs<T> {
    fn default() -> Self {
        Self { previous: None, previous_speeds: None, steering_rates: None }
    }
}

impl Inputs<'_> {
    /// Fails unless every value is finite.
    #[inline]
    pub fn check(&self) -> Result<(), Error> {
        finite("previous", self.previous.unwrap_or_default())?;
        finite("previous_wheel_speeds", self.previous_speeds.unwrap_or_default())?;
        finite("steering_rates", self.steering_rates.unwrap_or_default())
    }
}

/// Groups the fixed wheels by the direction of their axles and averages each group's side-slip row.
fn banks(wheels: &[Wheel]) -> Vec<Bank> {
    let mut banks: Vec<Bank> = Vec::new();
    let fixed =
        wheels.iter().enumerate().filter(|(_, wheel)| wheel.pivot == Pivot::Fixed && wheel.roller_angle.is_none());
    for (i, wheel) in fixed {
        let row = wheel.rows(Direction::from(wheel.heading)).side_slip;
        let parallel = |bank: &&mut Bank| (bank.row.x * row.y - bank.row.y * row.x).abs() <= PARALLEL;
        match banks.iter_mut().find(parallel) {
            Some(bank) => {
                // The row of a wheel with the opposite heading has the opposite sign.
                let same_way = (bank.row.x * row.x + bank.row.y * row.y).signum();
                let count = bank.wheels.len() as f64;
                bank.row.z += (same_way * row.z - bank.row.z) / (count + 1.0);
                bank.wheels.push(i);
            }
            None => banks.push(Bank { row, wheels: vec![i] }),
        }
    }
    banks
}

/// Weight of one fixed wheel in the side-slip row of another: `+-(1 - (sin d / ASIDE)^2)^2`, 0 if
/// `abs(sin d) >= ASIDE`.
///
/// `d` is the angle between the axles; the weight is negative if the wheels roll opposite ways. It falls smoothly, so
/// that the estimate is a continuous function of the headings.
fn side_slip_share(row: &Vector3<f64>, other: &Vector3<f64>) -> f64 {
    let sine = (row.x * other.y - row.y * other.x) / ASIDE;
    let falling = (1.0 - sine * sine).max(0.0);
    (falling * falling).copysign(row.x * other.x + row.y * other.y)
}

/// Derivative of [`side_slip_share`] along a change of the other row.
fn side_slip_share_derivative(row: &Vector3<f64>, other: &Vector3<f64>, change: &Vector3<f64>) -> f64 {
    let sine = (row.x * other.y - row.y * other.x) / ASIDE;
    let sine_change = (row.x * change.y - row.y * change.x) / ASIDE;
    let falling = (1.0 - sine * sine).max(0.0);
    (-4.0 * falling * sine * sine_change) * (row.x * other.x + row.y * other.y).signum()
}

impl RoverData {
    /// The wheel's own side-slip row, before it is shared; None for wheels that share none: steered, castors, with
    /// rollers.
    fn unshared_side_slip_row(&self, k: usize) -> Option<Vector3<f64>> {
        let wheel = &self.wheels[k];
        match self.mounts[k] {
            Mount::Fixed(Rows { rolling, .. }) if wheel.roller_angle.is_none() => {
                let (cos, sin) = (rolling.x, rolling.y);
                Some(wheel.bare_rows(Direction { sin, cos }).side_slip)
            }
            _ => None,
        }
    }

    /// Changes of the side-slip rows of fixed wheels by a change of the own row of wheel `i`: as a term of their means,
    /// and by the weights of the two wheels in each other's rows.
    pub(crate) fn changes_with(&self, i: usize, change: Vector3<f64>) -> impl Iterator<Item = (usize, Vector3<f64>)> {
        let rows = move || (0..self.wheels.len()).filter_map(|k| Some((k, self.unshared_side_slip_row(k)?)));
        rows().filter_map(move |(k, own)| {
            let (mut sum, mut total) = (Vector3::zeros(), 0.0);
            let (mut sum_change, mut total_change) = (Vector3::zeros(), 0.0);
            for (j, row) in rows() {
                let part = side_slip_share(&own, &row);
                sum += row * part;
                total += part.abs();
                if j == i {
                    sum_change += change * part;
                }
                if (j == i) != (k == i) {
                    let part_change = if j == i {
                        side_slip_share_derivative(&own, &row, &change)
                    } else {
                        side_slip_share_derivative(&row, &own, &change)
                    };
                    sum_change += row * part_change;
                    total_change += part_change * part.signum();
                }
            }
            let row_change = (sum_change - sum * (total_change / total)) / total;
            // A shared row may have the opposite sign of the wheel's own row.
            let Mount::Fixed(Rows { side_slip, .. }) = self.mounts[k] else {
                return None;
            };
            let same_way = (side_slip.x * own.x + side_slip.y * own.y).signum();
            (row_change != Vector3::zeros()).then_some((k, row_change * same_way))
        })
    }
}

/// The side-slip row of a fixed wheel: the mean of the rows of all wheels, by their weights [`side_slip_share`].
fn shared_row(wheels: &[Wheel], banks: &[Bank], i: usize, own: Vector3<f64>) -> Vector3<f64> {
    let Some(bank) = banks.iter().find(|bank| bank.wheels.contains(&i)) else {
        return own; // with rollers
    };
    let apart = |other: &&Bank| side_slip_share(&other.row, &own) != 0.0;
    if banks.iter().filter(apart).count() == 1 {
        return bank.row;
    }
    let (mut sum, mut total) = (Vector3::zeros(), 0.0);
    for &k in banks.iter().flat_map(|bank| &bank.wheels) {
        let row = wheels[k].rows(Direction::from(wheels[k].heading)).side_slip;
        let share = side_slip_share(&own, &row);
        sum += row * share;
        total += share.abs();
    }
    sum / total
}

/// The mount of every wheel: constant rows with the shared side-slip row, or a steering range.
fn mounts(wheels: &[Wheel], banks: &[Bank]) -> Vec<Mount> {
    let mount = |(i, wheel): (usize, &Wheel)| {
        let direction = Direction::from(wheel.heading);
        let own = wheel.rows(direction);
        match wheel.pivot {
            Pivot::Steered(range) => Mount::Steered(range, direction),
            Pivot::Castor => Mount::Castor(direction),
            Pivot::Fixed => Mount::Fixed(Rows { side_slip: shared_row(wheels, banks, i, own.side_slip), ..own }),
        }
    };
    wheels.iter().enumerate().map(mount).collect()
}
