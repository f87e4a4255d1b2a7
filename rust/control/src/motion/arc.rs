//! Directions of motion along a great circle of twist space, and the speeds of body and wheels in each.
//!
//! A twist is a speed times a direction: a twist of unit length, by the root mean square of the pivots'
//! velocities. Straight motion, spin and crab motion are points of that sphere. On the arc from one direction to
//! another, `cos(angle) from + sin(angle) across`, every steered wheel turns in one sense only, at
//!
//! ```text
//! d steering / d angle = cross / |u|²      cross = from_u × across_u, constant
//! ```
//!
//! with the velocity `u` of its pivot; and the square of every velocity is a constant plus a sinusoid of twice the
//! angle.

use nalgebra::{Matrix3, Vector2, Vector3};

use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::{Mount, Rover};
use six_wheel_kinematics::wheels::REST;

/// Rounding of a sum of squares.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The squared length of a velocity along an arc: `mean + cos cos(2 angle) + sin sin(2 angle)`.
///
/// The squared length of its derivative by the angle is `mean - cos cos(2 angle) - sin sin(2 angle)`.
#[derive(Clone, Copy, Debug, Default)]
pub struct SquaredSpeed {
    mean: f64,
    cos: f64,
    sin: f64,
}

impl SquaredSpeed {
    fn new(from: Vector2<f64>, across: Vector2<f64>) -> Self {
        let (a, b) = (from.norm_squared(), across.norm_squared());
        Self { mean: f64::midpoint(a, b), cos: (a - b) / 2.0, sin: from.dot(&across) }
    }
}

/// Upper bounds, on a piece of an arc, of a velocity's length and of the length of its derivative by the angle.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bound {
    /// Of the velocity, per speed along the direction.
    pub along: f64,
    /// Of the derivative, per speed along the direction and radian.
    pub across: f64,
}

impl Bound {
    /// Bounds of both velocities.
    fn max(self, other: Self) -> Self {
        Self { along: self.along.max(other.along), across: self.across.max(other.across) }
    }

    fn plus(self, other: Self, share: f64) -> Self {
        Self { along: self.along + share * other.along, across: self.across + share * other.across }
    }
}

/// A piece of an arc.
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// Cosine and sine of twice the angle at either end.
    ends: [[f64; 2]; 2],
    /// True if the piece is longer than a quarter turn: then the bounds are those of the whole circle.
    long: bool,
    /// Rounding of a squared length, as a share of its mean; 0 for a single direction.
    rounding: f64,
}

impl Piece {
    fn new(start: f64, end: f64) -> Self {
        let (low, high) = (start.min(end), start.max(end));
        let double = |angle: f64| {
            let (sin, cos) = (2.0 * angle).sin_cos();
            [cos, sin]
        };
        let first = double(low);
        Self {
            ends: [first, if high == low { first } else { double(high) }],
            long: high - low > std::f64::consts::FRAC_PI_2,
            rounding: if high == low { 0.0 } else { ROUNDING },
        }
    }

    /// Least and largest value of the sinusoid, and its largest slope by twice the angle.
    fn of(&self, squared: &SquaredSpeed) -> [f64; 3] {
        let SquaredSpeed { cos, sin, .. } = *squared;
        let value = |[c, s]: [f64; 2]| cos * c + sin * s;
        let slope = |[c, s]: [f64; 2]| sin * c - cos * s;
        let [v0, v1] = self.ends.map(value);
        let [t0, t1] = self.ends.map(slope);
        let height = || cos.hypot(sin);
        if self.long {
            let height = height();
            return [-height, height, height];
        }
        // Half a period has at most one extremum and one zero.
        let low = if t0 < 0.0 && t1 > 0.0 { -height() } else { v0.min(v1) };
        let high = if t0 > 0.0 && t1 < 0.0 { height() } else { v0.max(v1) };
        let steep = if v0 * v1 < 0.0 { height() } else { t0.abs().max(t1.abs()) };
        [low, high, steep]
    }

    fn bound(&self, squared: &SquaredSpeed) -> Bound {
        let [low, high, _] = self.of(squared);
        self.bound_of(squared, low, high)
    }

    fn bound_of(&self, squared: &SquaredSpeed, low: f64, high: f64) -> Bound {
        let rounding = self.rounding * squared.mean;
        Bound {
            along: (squared.mean + high + rounding).max(0.0).sqrt(),
            across: (squared.mean - low + rounding).max(0.0).sqrt(),
        }
    }
}

/// The velocity of one wheel along the arc.
#[derive(Clone, Copy, Debug, Default)]
struct WheelTerm {
    squared: SquaredSpeed,
    /// Of a steered wheel: the rate of its angle by the angle of the arc, times the square of its pivot's velocity.
    cross: f64,
    /// Velocities of its pivot at the two directions of the arc.
    from: Vector2<f64>,
    across: Vector2<f64>,
    /// Radius and scrub radius [m].
    radius: f64,
    scrub: f64,
    castor: bool,
}

/// Bounds over a piece of an arc.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bounds {
    /// Velocity of the body's origin.
    pub linear: Bound,
    /// Yaw rate.
    pub yaw: Bound,
    /// Rotation rate of the fastest wheel.
    pub wheels: Bound,
    /// Rotation rate of the fastest castor, whose acceleration is not limited.
    pub castors: f64,
    /// First and second derivative of the steering angles by the angle of the arc.
    pub steering: [f64; 2],
}

/// A great circle of directions.
#[derive(Clone, Debug)]
pub struct Arc {
    from: Vector3<f64>,
    across: Vector3<f64>,
    linear: SquaredSpeed,
    yaw: SquaredSpeed,
    wheels: Vec<WheelTerm>,
}

impl Arc {
    /// An arc that is a single direction.
    pub fn new(rover: &Rover, from: Vector3<f64>) -> Self {
        let mut arc = Self {
            from,
            across: Vector3::zeros(),
            linear: SquaredSpeed::default(),
            yaw: SquaredSpeed::default(),
            wheels: vec![WheelTerm::default(); rover.wheels().len()],
        };
        arc.set(rover, from, Vector3::zeros());
        arc
    }

    /// Replaces the arc by that from one direction towards an orthogonal one.
    pub fn set(&mut self, rover: &Rover, from: Vector3<f64>, across: Vector3<f64>) {
        let twists = [from, across].map(Twist::from);
        let squared = |part: fn(Twist) -> Vector2<f64>| SquaredSpeed::new(part(twists[0]), part(twists[1]));
        self.from = from;
        self.across = across;
        self.linear = squared(Twist::linear);
        self.yaw = squared(|twist| Vector2::new(twist.omega, 0.0));
        let wheels = rover.wheels().iter().zip(&rover.mounts);
        for (term, (wheel, mount)) in self.wheels.iter_mut().zip(wheels) {
            let velocity = |twist: Twist| match mount {
                Mount::Fixed(rows) => Vector2::new(rows.rolling.dot(&Vector3::from(twist)), 0.0),
                _ => twist.at(wheel.x, wheel.y),
            };
            let [a, b] = twists.map(velocity);
            let squared = SquaredSpeed::new(a, b);
            let cross = a.perp(&b);
            let steered = matches!(mount, Mount::Steered(..)) && cross.abs() > REST * squared.mean;
            *term = WheelTerm {
                squared,
                cross: if steered { cross } else { 0.0 },
                from: a,
                across: b,
                radius: wheel.radius,
                scrub: if matches!(mount, Mount::Fixed(_)) {
                    0.0 // its rolling row contains the scrub radius
                } else {
                    wheel.scrub.abs()
                },
                castor: matches!(mount, Mount::Castor(_)),
            };
        }
    }

    /// The direction at an angle.
    pub fn at(&self, angle: f64) -> Vector3<f64> {
        let (sin, cos) = angle.sin_cos();
        self.from * cos + self.across * sin
    }

    /// The derivative of the direction by the angle: a unit twist orthogonal to it.
    pub fn ahead(&self, angle: f64) -> Vector3<f64> {
        let (sin, cos) = angle.sin_cos();
        self.across * cos - self.from * sin
    }

    /// The angle from the direction at `angle` to the projection of a direction onto the plane of the arc [rad], and
    /// the length of its part orthogonal to the plane.
    pub fn angle_to(&self, metric: &Matrix3<f64>, angle: f64, to: Vector3<f64>) -> (f64, f64) {
        let (sin, cos) = angle.sin_cos();
        let here = self.from * cos + self.across * sin;
        let ahead = self.across * cos - self.from * sin;
        let image = metric * to;
        let (x, y) = (here.dot(&image), ahead.dot(&image));
        let off = to - here * x - ahead * y;
        (y.atan2(x), off.dot(&(metric * off)).max(0.0).sqrt())
    }

    /// Turns of the steered wheels between two angles less than half a turn apart [rad], in the order of
    /// its joints.
    pub fn turns(&self, rover: &Rover, start: f64, end: f64) -> impl Iterator<Item = f64> {
        let [first, last] = [start, end].map(f64::sin_cos);
        rover.steered().iter().map(move |&i| {
            let wheel = &self.wheels[i];
            let at = |(sin, cos): (f64, f64)| wheel.from * cos + wheel.across * sin;
            let (a, b) = (at(first), at(last));
            if wheel.cross == 0.0 { 0.0 } else { a.perp(&b).atan2(a.dot(&b)) }
        })
    }

    /// Rates of the steering angles by the angle of the arc.
    pub fn steering_rates(&self, rover: &Rover, angle: f64) -> impl Iterator<Item = f64> {
        let (sin, cos) = angle.sin_cos();
        rover.steered().iter().map(move |&i| {
            let wheel = &self.wheels[i];
            if wheel.cross == 0.0 { 0.0 } else { wheel.cross / (wheel.from * cos + wheel.across * sin).norm_squared() }
        })
    }

    /// Bounds between two angles.
    pub fn bounds(&self, start: f64, end: f64) -> Bounds {
        let piece = Piece::new(start, end);
        let yaw = piece.bound(&self.yaw);
        let mut bounds = Bounds { linear: piece.bound(&self.linear), yaw, ..Bounds::default() };
        for wheel in &self.wheels {
            let [low, high, steep] = piece.of(&wheel.squared);
            let rim = piece.bound_of(&wheel.squared, low, high);
            let rim = rim.plus(yaw, wheel.scrub);
            let turning = Bound { along: rim.along / wheel.radius, across: rim.across / wheel.radius };
            if wheel.castor {
                bounds.castors = bounds.castors.max(turning.along);
            } else {
                bounds.wheels = bounds.wheels.max(turning);
            }
            if wheel.cross != 0.0 && start != end {
                let least = (wheel.squared.mean + low).max(f64::MIN_POSITIVE);
                let first = wheel.cross.abs() / least;
                let [one, two] = &mut bounds.steering;
                *one = one.max(first);
                *two = two.max(first * 2.0 * steep / least);
            }
        }
        bounds
    }
}
