//! Directions of motion along a great circle of twist space, and the speeds of body and wheels in each.
//!
//! A twist is a speed times a direction: a twist of unit length, by the root mean square of the pivots'
//! velocities. Straight, spin and crab are points of that sphere like any other. On the way from one direction to
//! another, along `cos(angle) from + sin(angle) across`, every steered wheel turns one way only, at
//!
//! ```text
//! d steering / d angle = cross / |u|²      cross = from_u × across_u, constant
//! ```
//!
//! with the velocity `u` of its pivot; and the square of every velocity is a wave of twice the angle.

use nalgebra::{Matrix3, Vector2, Vector3};

use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::{Mount, Rover};
use six_wheel_kinematics::wheels::REST;

/// Rounding of a sum of squares.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The squared length of a velocity along an arc: `mean + cos cos(2 angle) + sin sin(2 angle)`.
///
/// That of its derivative is the same with the wave turned over.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wave {
    mean: f64,
    cos: f64,
    sin: f64,
}

impl Wave {
    fn new(from: Vector2<f64>, across: Vector2<f64>) -> Self {
        let (a, b) = (from.norm_squared(), across.norm_squared());
        Self { mean: f64::midpoint(a, b), cos: (a - b) / 2.0, sin: from.dot(&across) }
    }
}

/// A velocity's length along a piece of an arc, at most, and that of its derivative.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bound {
    /// Per unit of speed.
    pub along: f64,
    /// Per unit of speed and radian.
    pub across: f64,
}

impl Bound {
    /// Both at most as large.
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
    /// More than a quarter turn: then the bounds are those of the whole circle.
    long: bool,
    /// Rounding of the difference of a wave and its mean: on a turn, zero is only nearly zero.
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

    /// Least and largest value of the wave without its mean, and its steepest slope.
    fn of(&self, wave: &Wave) -> [f64; 3] {
        let Wave { cos, sin, .. } = *wave;
        let value = |[c, s]: [f64; 2]| cos * c + sin * s;
        let slope = |[c, s]: [f64; 2]| sin * c - cos * s;
        let [v0, v1] = self.ends.map(value);
        let [t0, t1] = self.ends.map(slope);
        let height = || cos.hypot(sin);
        if self.long {
            let height = height();
            return [-height, height, height];
        }
        // Half a wave has one turning point, and one zero, at most.
        let low = if t0 < 0.0 && t1 > 0.0 { -height() } else { v0.min(v1) };
        let high = if t0 > 0.0 && t1 < 0.0 { height() } else { v0.max(v1) };
        let steep = if v0 * v1 < 0.0 { height() } else { t0.abs().max(t1.abs()) };
        [low, high, steep]
    }

    fn bound(&self, wave: &Wave) -> Bound {
        let [low, high, _] = self.of(wave);
        self.bound_of(wave, low, high)
    }

    fn bound_of(&self, wave: &Wave, low: f64, high: f64) -> Bound {
        let rounding = self.rounding * wave.mean;
        Bound {
            along: (wave.mean + high + rounding).max(0.0).sqrt(),
            across: (wave.mean - low + rounding).max(0.0).sqrt(),
        }
    }
}

/// The velocity of one wheel along the arc.
#[derive(Clone, Copy, Debug, Default)]
struct Spoke {
    wave: Wave,
    /// Of a steered wheel: the rate of its angle times the square of its pivot's velocity.
    cross: f64,
    from: Vector2<f64>,
    across: Vector2<f64>,
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
    /// The fastest castor's, whose changes are its own affair.
    pub castors: f64,
    /// First and second derivative of the steering angles by the angle of the arc.
    pub steering: [f64; 2],
}

/// A great circle of directions.
#[derive(Clone, Debug)]
pub struct Arc {
    from: Vector3<f64>,
    across: Vector3<f64>,
    linear: Wave,
    yaw: Wave,
    spokes: Vec<Spoke>,
}

impl Arc {
    /// Through a direction, to nowhere in particular.
    pub fn new(rover: &Rover, from: Vector3<f64>) -> Self {
        let mut arc = Self {
            from,
            across: Vector3::zeros(),
            linear: Wave::default(),
            yaw: Wave::default(),
            spokes: vec![Spoke::default(); rover.wheels().len()],
        };
        arc.set(rover, from, Vector3::zeros());
        arc
    }

    /// Makes it another arc: from one direction, towards one at a right angle to it.
    pub fn set(&mut self, rover: &Rover, from: Vector3<f64>, across: Vector3<f64>) {
        let twists = [from, across].map(Twist::from);
        let wave = |part: fn(Twist) -> Vector2<f64>| Wave::new(part(twists[0]), part(twists[1]));
        self.from = from;
        self.across = across;
        self.linear = wave(Twist::linear);
        self.yaw = wave(|twist| Vector2::new(twist.omega, 0.0));
        let wheels = rover.wheels().iter().zip(&rover.mounts);
        for (spoke, (wheel, mount)) in self.spokes.iter_mut().zip(wheels) {
            let velocity = |twist: Twist| match mount {
                Mount::Fixed(rows) => Vector2::new(rows.rolling.dot(&Vector3::from(twist)), 0.0),
                _ => twist.at(wheel.x, wheel.y),
            };
            let [a, b] = twists.map(velocity);
            let wave = Wave::new(a, b);
            let cross = a.perp(&b);
            let steered = matches!(mount, Mount::Steered(..)) && cross.abs() > REST * wave.mean;
            *spoke = Spoke {
                wave,
                cross: if steered { cross } else { 0.0 },
                from: a,
                across: b,
                radius: wheel.radius,
                scrub: if matches!(mount, Mount::Fixed(_)) {
                    0.0 // in its rows already
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

    /// The derivative of the direction by the angle: of unit length, at a right angle to it.
    pub fn ahead(&self, angle: f64) -> Vector3<f64> {
        let (sin, cos) = angle.sin_cos();
        self.across * cos - self.from * sin
    }

    /// The angle from here to the part of a direction in the plane of the arc, and what is out of the plane.
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
            let spoke = &self.spokes[i];
            let at = |(sin, cos): (f64, f64)| spoke.from * cos + spoke.across * sin;
            let (a, b) = (at(first), at(last));
            if spoke.cross == 0.0 { 0.0 } else { a.perp(&b).atan2(a.dot(&b)) }
        })
    }

    /// Rates of the steering angles by the angle of the arc.
    pub fn steering_rates(&self, rover: &Rover, angle: f64) -> impl Iterator<Item = f64> {
        let (sin, cos) = angle.sin_cos();
        rover.steered().iter().map(move |&i| {
            let spoke = &self.spokes[i];
            if spoke.cross == 0.0 { 0.0 } else { spoke.cross / (spoke.from * cos + spoke.across * sin).norm_squared() }
        })
    }

    /// Bounds between two angles.
    pub fn bounds(&self, start: f64, end: f64) -> Bounds {
        let piece = Piece::new(start, end);
        let yaw = piece.bound(&self.yaw);
        let mut bounds = Bounds { linear: piece.bound(&self.linear), yaw, ..Bounds::default() };
        for spoke in &self.spokes {
            let [low, high, steep] = piece.of(&spoke.wave);
            let rim = piece.bound_of(&spoke.wave, low, high);
            let rim = rim.plus(yaw, spoke.scrub);
            let turning = Bound { along: rim.along / spoke.radius, across: rim.across / spoke.radius };
            if spoke.castor {
                bounds.castors = bounds.castors.max(turning.along);
            } else {
                bounds.wheels = bounds.wheels.max(turning);
            }
            if spoke.cross != 0.0 && start != end {
                let least = (spoke.wave.mean + low).max(f64::MIN_POSITIVE);
                let first = spoke.cross.abs() / least;
                let [one, two] = &mut bounds.steering;
                *one = one.max(first);
                *two = two.max(first * 2.0 * steep / least);
            }
        }
        bounds
    }
}
