//! Four axles on lockable pivots: four-wheel steering, dual differential drive and their hybrid.
//!
//! Each axle hangs on a pivot at `(±h_x, ±h_y)` and carries a wheel at its outer end: a steered [`Wheel`]
//! whose contact lies an axle's length beside its pivot. All else follows from the wheel equation. A brake
//! locks the two pivots of a pair; a free pivot has no motor, the wheels turn it:
//! `steering_rate = (e . u - rim_speed) / scrub - omega`, which is the rolling row solved for the rate.
//!
//! The side-slip rows know no steering rate, so they bind free axles as well as locked ones: a robot in
//! motion has all four axle lines through one point, always. With pivots on the centre line a pair is one
//! rigid axle, hence one line, and any two angles will do. With pivots beside it the two lines of a locked
//! pair meet in one point and hold the centre of rotation there, unless they are the same line.

#[macro_use]
extern crate six_wheel_numerics;

mod brakes;
mod flow;
mod glide;
mod handover;
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

/// Side slip per distance driven up to which axles count as concurrent, unless the caller knows better: what
/// pivot encoders of 13 bits, 0.8 mrad apart, leave open.
pub const LOCK_TOLERANCE: f64 = 1e-3;

/// Singular values below this share of the largest are zero.
const RANK_TOLERANCE: f64 = 1e-9;

/// Components of a unit motion that are rounding.
const VANISHED: f64 = 1e-14;

/// The vehicle: immutable, checked once.
#[derive(Clone, Debug, PartialEq)]
pub struct FourAxle {
    pivots: [f64; 2],
    axle_length: f64,
    wheel_radius: f64,
    steering: SteeringRange,
    tolerance: f64,
    rover: Rover,
}

impl FourAxle {
    /// Axles of `axle_length` on pivots at `(±pivots[0], ±pivots[1])` [m].
    ///
    /// Hinges on the centre line (`pivots[1] = 0`) carry one rigid axle per pair. `tolerance` is the side
    /// slip per distance driven up to which axles count as concurrent.
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

    /// Half the distance of the pivots along and across the body [m].
    pub fn pivots(&self) -> [f64; 2] {
        self.pivots
    }

    /// Hinge to wheel [m].
    pub fn axle_length(&self) -> f64 {
        self.axle_length
    }

    /// Hub to ground [m].
    pub fn wheel_radius(&self) -> f64 {
        self.wheel_radius
    }

    /// Angles an axle can take [rad].
    pub fn steering(&self) -> SteeringRange {
        self.steering
    }

    /// Side slip per distance driven up to which axles count as concurrent.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The same vehicle with all pivots locked where one commands them.
    pub fn rover(&self) -> &Rover {
        &self.rover
    }

    /// True if a pair is one axle, its wheels always in line.
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

    /// Axle angles under which the robot turns about a point [m], and nothing slips.
    ///
    /// A point at infinity along one axis is the straight line across it.
    pub fn concurrent_angles(&self, icr: [f64; 2]) -> Result<Axles, Error> {
        self.aim(turn_about(icr)?, &[0.0; 4]).map_err(|error| Error {
            argument: "icr".into(),
            value: numbers(&icr),
            ..error
        })
    }

    /// Angles at which all axles allow a twist, near the previous ones.
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

    /// A row for `(vx, vy, omega * size)`: every unit vector moves the pivots at 1 m/s (root mean square).
    fn scaled(&self, row: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(row.x, row.y, row.z / self.rover.size)
    }

    fn side_slip(&self, angles: &Axles) -> Matrix4x3<f64> {
        let rows = self.rows(angles);
        Matrix4x3::from_fn(|i, k| self.scaled(&rows[i].side_slip)[k])
    }

    /// A unit motion as a twist, turned forwards: of vx, omega, vy the first that is there is positive.
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
        Ok(self.judge(angles))
    }

    fn judge(&self, angles: &Axles) -> Mobility {
        let rows = self.rows(angles);
        let plain = Matrix4x3::from_fn(|i, k| rows[i].side_slip[k]);
        let found = Jacobi::new(&self.side_slip(angles));
        // Four wheels: a root mean square is half the length.
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
    /// While one pair is locked and its drives follow, the rows may leave the speed open at which axles
    /// on two pivots go along. Then the motion is the one that lasts, under which the axle lines go on to share a
    /// point.
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

    /// True if the drives that follow leave the speed open, and the motion has to be the one that lasts.
    fn must_last(&self, angles: &Axles, brakes: Brakes, speeds: &Drives) -> bool {
        brakes.front != brakes.rear && speeds.contains(&None) && self.judge(angles).degree() == 1
    }

    /// The wheel equation of all wheels, solved for body and free pivots.
    ///
    /// With `lasting`, the axle lines count as sharing a point, and the pivots turn so that they go on to:
    /// the time derivative of `n . u = 0` at every pivot, `n . du/dt = (e . u) steering_rate`, has a solution
    /// for the acceleration.
    fn velocities(&self, angles: &Axles, brakes: Brakes, speeds: &Drives, lasting: bool) -> Result<Motion, Error> {
        let wheels = self.rover.wheels();
        let rows = self.rows(angles);
        let (columns, count) = self.columns(brakes);
        let mut side_slip = self.side_slip(angles);
        // Unknowns as speeds: the twist scaled, pivot rates times the axle length. Unused rows and columns
        // stay empty.
        let mut matrix = SMatrix::<f64, 12, 7>::zeros();
        let mut wanted = SVector::<f64, 12>::zeros();
        if lasting {
            let (shared, left) = sharing(&side_slip);
            side_slip = shared;
            let motion = Vector3::from(self.judge(angles).least());
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
                wanted[4 + i] = wheels[i].radius * speed;
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
        let found = system.solve(&wanted, least);
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

    /// Speed of a pivot along its wheel's heading [m/s]: the rolling row without the axle's length.
    fn along(&self, i: usize, rows: &[Rows; 4], twist: &Vector3<f64>) -> f64 {
        rows[i].rolling.dot(twist) + self.rover.wheels()[i].scrub * twist.z
    }
}

/// Singular values of the side-slip rows of a pair, and the motions that belong to them.
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

/// The twist that turns about a point, of moderate size wherever the point is.
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
