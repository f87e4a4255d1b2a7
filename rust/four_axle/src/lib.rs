//! Four axles on lockable pivots: four-wheel steering, dual differential drive and their hybrid.
//!
//! Each axle turns about a pivot at `(±h_x, ±h_y)` and carries a wheel at its outer end: a steered [`Wheel`]
//! whose scrub radius is the length of the axle. All equations follow from the wheel equation. A brake
//! locks the two pivots of a pair; a free pivot has no motor and turns by the wheels:
//! `steering_rate = (e . u - rim_speed) / scrub - omega`, which is the rolling row solved for the rate.
//!
//! The side-slip rows do not contain the steering rates, so they hold for free axles as well as for locked ones: all
//! four axle lines of a robot in motion pass through one point. With pivots on the centre line a pair is one rigid
//! axle, hence one line, and the lines of two pairs intersect at any two angles. With pivots beside it the two lines of
//! a locked pair intersect in one point, the centre of rotation, unless they are the same line.

#[macro_use]
extern crate six_wheel_numerics;

mod brakes;
mod flow;
mod handover;
mod pivot_transition;
mod plan;
mod state;

use nalgebra::{Matrix4, Matrix4x3, SMatrix, SVector, Vector3};

use six_wheel_kinematics::admissible::SLIP_TOLERANCE;
use six_wheel_kinematics::geometry::Direction;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::{Inputs, Rover};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::wheels::{Rows, Wheel};
use six_wheel_numerics::error::{Error, ErrorKind, finite, not_negative, number, numbers, positive};
use six_wheel_numerics::jacobi::Jacobi;

pub use brakes::{Brake, Brakes, Pair};
pub use flow::Track;
pub use plan::{Pace, Sequence, Steer};
pub use state::{Axles, Drives, Mobility, Motion, State, Step};

/// Default of the side slip per distance driven up to which axle lines count as concurrent: the resolution of pivot
/// encoders of 13 bits, 0.8 mrad.
pub const LOCK_TOLERANCE: f64 = 1e-3;

/// Singular values below this share of the largest are zero.
const RANK_TOLERANCE: f64 = 1e-9;

/// Components of a unit motion below which they count as rounding.
const VANISHED: f64 = 1e-14;

/// The vehicle: immutable, checked when it is constructed.
#[derive(Clone, Debug, PartialEq)]
pub struct FourAxle {
    /// Half the distance of the pivots along and across the body [m].
    pivots: [f64; 2],
    /// Distance from pivot to wheel [m].
    axle_length: f64,
    /// Radius of the wheels [m].
    wheel_radius: f64,
    /// Angles an axle can take [rad].
    steering: SteeringRange,
    /// Side slip per distance driven up to which axle lines count as concurrent.
    tolerance: f64,
    /// The vehicle with all pivots commanded.
    rover: Rover,
}

getters! {
    FourAxle:
    /// Half the distance of the pivots along and across the body [m].
    pivots: [f64; 2];
    /// Distance from pivot to wheel [m].
    axle_length: f64;
    /// Radius of the wheels [m].
    wheel_radius: f64;
    /// Angles an axle can take [rad].
    steering: SteeringRange;
    /// Side slip per distance driven up to which axle lines count as concurrent.
    tolerance: f64;
    /// The vehicle as a rover with four steered wheels: all pivots commanded.
    rover: &Rover;
}

impl FourAxle {
    /// Axles of `axle_length` on pivots at `(±pivots[0], ±pivots[1])` [m].
    ///
    /// Pivots on the centre line (`pivots[1] = 0`) carry one rigid axle per pair. `tolerance` is the side
    /// slip per distance driven up to which axle lines count as concurrent.
    pub fn new(
        pivots: [f64; 2],
        axle_length: f64,
        wheel_radius: f64,
        steering: SteeringRange,
        tolerance: f64,
    ) -> Result<Self, Error> {
        let [x, y] = pivots;
        positive("pivots[0]", x)?;
        not_negative("pivots[1]", y)?;
        positive("axle_length", axle_length)?;
        positive("wheel_radius", wheel_radius)?;
        if !(tolerance.is_finite() && (SLIP_TOLERANCE..1.0).contains(&tolerance)) {
            let rule = format!("be at least {SLIP_TOLERANCE:?} (rounding) and less than 1");
            return Err(Error::value("tolerance", rule, number(tolerance)));
        }
        let axle = |name: &str, x: f64, side: f64| Wheel {
            scrub: side * axle_length,
            ..Wheel::new(name, x, side * y, wheel_radius).steered(steering)
        };
        let rover = Rover::new(vec![
            axle("front_left", x, 1.0),
            axle("front_right", x, -1.0),
            axle("rear_left", -x, 1.0),
            axle("rear_right", -x, -1.0),
        ])?;
        Ok(Self { pivots, axle_length, wheel_radius, steering, tolerance, rover })
    }

    /// True if each pair is one rigid axle.
    pub fn is_rigid(&self) -> bool {
        self.pivots[1] == 0.0
    }

    /// Fails unless the angles are finite, in range, and those of a rigid axle equal.
    pub fn check_angles(&self, angles: &Axles) -> Result<(), Error> {
        finite("steering", angles)?;
        let slack = SLIP_TOLERANCE;
        let range = self.steering.lower - slack..=self.steering.upper + slack;
        if !angles.iter().all(|angle| range.contains(angle)) {
            let rule = format!("lie within {} rad", self.steering);
            return Err(Error::value("steering", rule, numbers(angles)));
        }
        let [front_left, front_right, rear_left, rear_right] = *angles;
        let apart = (front_left - front_right).abs().max((rear_left - rear_right).abs());
        if self.is_rigid() && apart > slack {
            let rule = "be equal left and right on a rigid axle (pivots on the centre line)";
            return Err(Error::value("steering", rule, numbers(angles)));
        }
        Ok(())
    }

    /// Axle angles at which the robot turns about a point [m] without slip [rad].
    ///
    /// A point at infinity along one axis means straight motion along the other axis.
    pub fn concurrent_angles(&self, icr: [f64; 2]) -> Result<Axles, Error> {
        self.aim(turn_about(icr)?, &[0.0; 4]).map_err(|error| Error {
            argument: "icr".into(),
            value: numbers(&icr),
            ..error
        })
    }

    /// Angles at which all axles allow a twist, those nearest to the previous ones [rad].
    fn aim(&self, twist: Twist, previous: &Axles) -> Result<Axles, Error> {
        let (mut angles, mut speeds) = ([0.0; 4], [0.0; 4]);
        let inputs = Inputs { previous: Some(previous), ..Inputs::default() };
        self.rover.inverse(twist, inputs, &mut angles, &mut speeds)?;
        Ok(angles)
    }

    fn rows(&self, angles: &Axles) -> [Rows; 4] {
        let wheels = self.rover.wheels();
        std::array::from_fn(|i| wheels[i].rows(Direction::from(angles[i])))
    }

    /// A row for the scaled twist `(vx, vy, omega * size)`, whose length is the root mean square speed of the pivots
    /// [m/s].
    fn scaled(&self, row: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(row.x, row.y, row.z / self.rover.size)
    }

    fn side_slip(&self, angles: &Axles) -> Matrix4x3<f64> {
        let rows = self.rows(angles);
        Matrix4x3::from_fn(|i, k| self.scaled(&rows[i].side_slip)[k])
    }

    /// A scaled twist as a twist, with the sign for which the first non-zero one of vx, omega, vy is positive.
    fn unit(&self, scaled: Vector3<f64>) -> Twist {
        let snapped = scaled.map(|value| if value.abs() <= VANISHED { 0.0 } else { value });
        let lead = [snapped.x, snapped.z, snapped.y].into_iter().find(|value| *value != 0.0);
        let sign = lead.map_or(1.0, f64::signum);
        Twist::from([sign * snapped.x + 0.0, sign * snapped.y + 0.0, sign * snapped.z / self.rover.size + 0.0])
    }

    /// Root mean square speed of the pivots [m/s].
    fn pivot_speed(&self, twist: Twist) -> f64 {
        Vector3::new(twist.vx, twist.vy, twist.omega * self.rover.size).norm()
    }

    /// Mobility of the robot with all axles at these angles.
    pub fn mobility(&self, angles: &Axles) -> Result<Mobility, Error> {
        self.check_angles(angles)?;
        Ok(self.mobility_unchecked(angles))
    }

    fn mobility_unchecked(&self, angles: &Axles) -> Mobility {
        let rows = self.rows(angles);
        let plain = Matrix4x3::from_fn(|i, k| rows[i].side_slip[k]);
        let found = Jacobi::new(&self.side_slip(angles));
        // Root mean square over four wheels: half the length.
        let slips = found.values / 2.0;
        let rank = slips.iter().filter(|slip| **slip > self.tolerance).count();
        Mobility {
            rank,
            singular_values: Jacobi::new(&plain).values.into(),
            motions: std::array::from_fn(|k| self.unit(found.turn.column(k).into_owned())),
            slip: slips.z,
            margin: self.tolerance - slips.z,
        }
    }

    /// Velocities of body and free pivots at these wheel speeds, by least squares over both rows of every wheel.
    ///
    /// While one pair is locked and its drives follow, the rows may leave the speed of the body undetermined. Then
    /// the motion is the one under which the axle lines continue to share a point.
    pub fn forward(&self, angles: &Axles, brakes: Brakes, speeds: &Drives) -> Result<Motion, Error> {
        self.check_angles(angles)?;
        self.check_speeds(speeds)?;
        let lasting = self.must_last(angles, brakes, speeds);
        self.velocities(angles, brakes, speeds, lasting)
    }

    fn check_speeds(&self, speeds: &Drives) -> Result<(), Error> {
        let given = speeds.map(|speed| speed.unwrap_or(0.0));
        finite("wheel_speeds", &given)?;
        let largest = given.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        if (4.0 * largest * self.rover.reading_bound).is_finite() {
            return Ok(());
        }
        let rule = "be small enough for a finite twist";
        Err(Error::value("wheel_speeds", rule, numbers(&given)))
    }

    /// Column of each axle's pivot rate among the unknowns, after the twist, and the number of unknowns.
    fn columns(&self, brakes: Brakes) -> ([Option<usize>; 4], usize) {
        let mut columns = [None; 4];
        let mut count = 3;
        for pair in [Pair::Front, Pair::Rear] {
            if brakes.of(pair) == Brake::Free {
                let [left, right] = pair.axles();
                let step = usize::from(!self.is_rigid());
                columns[left] = Some(count);
                columns[right] = Some(count + step);
                count += 1 + step;
            }
        }
        (columns, count)
    }

    /// True if the drives that follow leave the speed undetermined: then the axle lines have to continue to share a
    /// point.
    fn must_last(&self, angles: &Axles, brakes: Brakes, speeds: &Drives) -> bool {
        brakes.front != brakes.rear && speeds.contains(&None) && self.mobility_unchecked(angles).degree() == 1
    }

    /// The wheel equation of all wheels, solved for body and free pivots.
    ///
    /// With `lasting`, the axle lines count as sharing a point, and the pivots turn so that they continue to:
    /// the time derivative of `n . u = 0` at every pivot, `n . du/dt = (e . u) steering_rate`, has a solution
    /// for the acceleration.
    fn velocities(&self, angles: &Axles, brakes: Brakes, speeds: &Drives, lasting: bool) -> Result<Motion, Error> {
        let wheels = self.rover.wheels();
        let rows = self.rows(angles);
        let (columns, count) = self.columns(brakes);
        let mut side_slip = self.side_slip(angles);
        // Unknowns as speeds [m/s]: the scaled twist, and pivot rates times the axle length. Unused rows and columns
        // are 0.
        let mut matrix = SMatrix::<f64, 12, 7>::zeros();
        let mut right = SVector::<f64, 12>::zeros();
        if lasting {
            let (shared, left) = sharing(&side_slip);
            side_slip = shared;
            let motion = Vector3::from(self.mobility_unchecked(angles).least());
            for (i, column) in columns.iter().enumerate() {
                if let Some(column) = *column {
                    let mut view = matrix.fixed_view_mut::<4, 1>(8, column);
                    view += left.column(i) * self.along(i, &rows, &motion);
                }
            }
        }
        matrix.fixed_view_mut::<4, 3>(0, 0).copy_from(&side_slip);
        for i in 0..4 {
            if let Some(speed) = speeds[i] {
                let rolling = self.scaled(&rows[i].rolling).transpose();
                matrix.fixed_view_mut::<1, 3>(4 + i, 0).copy_from(&rolling);
                right[4 + i] = wheels[i].radius * speed;
                if let Some(column) = columns[i] {
                    matrix[(4 + i, column)] = -wheels[i].scrub / self.axle_length;
                }
            }
        }
        let system = Jacobi::new(&matrix);
        let least = RANK_TOLERANCE * system.values[0];
        let rank = system.rank(least);
        if rank < count {
            return Err(undetermined(speeds, rank, count));
        }
        let found = system.solve(&right, least);
        let twist = Vector3::new(found[0], found[1], found[2] / self.rover.size);
        let pivot_rates = columns.map(|column| column.map_or(0.0, |c| found[c] / self.axle_length));
        let mut motion = Motion { twist: Twist::from(twist), pivot_rates, speeds: [0.0; 4], residual: [0.0; 4], rank };
        for i in 0..4 {
            let rolled = rows[i].rolling.dot(&twist) - wheels[i].scrub * pivot_rates[i];
            let rim_speed = speeds[i].map_or(rolled, |speed| wheels[i].radius * speed);
            motion.speeds[i] = rim_speed / wheels[i].radius;
            motion.residual[i] = (rolled - rim_speed).hypot(rows[i].side_slip.dot(&twist));
        }
        Ok(motion)
    }

    /// Speed of a pivot along its wheel's heading [m/s]: the rolling row without the scrub radius.
    fn along(&self, i: usize, rows: &[Rows; 4], twist: &Vector3<f64>) -> f64 {
        rows[i].rolling.dot(twist) + self.rover.wheels()[i].scrub * twist.z
    }
}

/// Singular values and right singular vectors of the side-slip rows of a pair.
fn pair_motions(side_slip: &Matrix4x3<f64>, pair: Pair) -> Jacobi<2, 3> {
    Jacobi::new(&SMatrix::from_rows(&pair.axles().map(|axle| side_slip.row(axle).into_owned())))
}

/// The nearest side-slip rows of axle lines that share a point, and the twists orthogonal to them.
fn sharing(side_slip: &Matrix4x3<f64>) -> (Matrix4x3<f64>, Matrix4<f64>) {
    let found = Jacobi::new(side_slip);
    let mut left = Matrix4::identity();
    for k in 0..2 {
        let unit = found.columns.column(k) / found.values[k];
        left -= unit * unit.transpose();
    }
    let last = found.columns.column(2) * found.turn.column(2).transpose();
    (side_slip - last, left)
}

/// A twist that turns about a point, scaled so that it neither overflows nor underflows.
fn turn_about(icr: [f64; 2]) -> Result<Twist, Error> {
    let refused = |rule: &str| Err(Error::value("icr", rule, numbers(&icr)));
    let [x, y] = icr;
    if x.is_nan() || y.is_nan() {
        return refused("be a point, at infinity or not");
    }
    match (x.is_infinite(), y.is_infinite()) {
        (true, true) => refused("name one direction (rover.inverse takes a twist without turning in any direction)"),
        (true, false) => Ok(Twist::from([0.0, -x.signum(), 0.0])),
        (false, true) => Ok(Twist::from([y.signum(), 0.0, 0.0])),
        (false, false) => {
            let size = x.abs().max(y.abs()).max(1.0);
            Ok(Twist::from([y / size, -x / size, 1.0 / size]))
        }
    }
}

fn undetermined(speeds: &Drives, rank: usize, count: usize) -> Error {
    let rule = format!("determine the motion of body and free pivots ({rank} of {count} unknowns known)");
    let value = numbers(&speeds.map(|speed| speed.unwrap_or(f64::NAN)));
    Error::value("wheel_speeds", rule, value).of_kind(ErrorKind::Underdetermined)
}
