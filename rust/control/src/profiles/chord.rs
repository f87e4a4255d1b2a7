//! The straight line between two twists, and the motion of the wheels along it.
//!
//! A twist is a point in homogeneous coordinates of the centre of rotation, `ICR = (-vy, vx) / omega`, times a speed.
//! Between two twists the centre moves along a straight line, which may contain infinity (driving straight) and the
//! body's origin (turning on the spot). The velocity `u` of every pivot also moves along a straight line: with `w = u'
//! / u` as complex numbers, the derivatives by the share of the chord of the wheel's angle and of the logarithm of its
//! speed are the imaginary and real part of `w`, and `w' = -w^2`.

use std::borrow::Cow;

use nalgebra::{Complex, Vector3};

use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::{Inputs, Mount, Rover};
use six_wheel_kinematics::steering::ANGLE_TOLERANCE;
use six_wheel_kinematics::wheels::{Pivot, REST};
use six_wheel_numerics::error::radians;

/// Speed of a pivot, as a share of its change along the chord, at which its wheel cannot follow the direction.
const TOO_CLOSE: f64 = 1e-6;

/// Sine of an angle below which vectors count as parallel.
const PARALLEL: f64 = 8.0 * f64::EPSILON;

/// A steered wheel along a chord.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Joint {
    /// Steering angle at the start [rad].
    pub angle: f64,
    /// Velocity of the pivot at the start, and its change over the chord [m/s].
    origin: Complex<f64>,
    change: Complex<f64>,
    /// True if the direction of that velocity changes.
    turns: bool,
}

impl Joint {
    fn velocity(&self, s: f64) -> Complex<f64> {
        self.origin + self.change * s
    }

    /// Angle the wheel has turned since the start of the chord [rad]: below half a turn, as the velocity moves on a
    /// straight line.
    pub fn swept(&self, s: f64) -> f64 {
        if self.turns { (self.velocity(s) * self.origin.conj()).arg() } else { 0.0 }
    }

    /// Share of the chord at which the wheel has turned by this angle [rad]: the inverse of [`Self::swept`].
    pub fn place_of(&self, swept: f64) -> f64 {
        // There the velocity is parallel to that at the start rotated by the angle.
        let product = self.change * self.origin.conj();
        let (sin, cos) = swept.sin_cos();
        self.origin.norm_sqr() * sin / (product.im * cos - product.re * sin)
    }

    /// First three derivatives of the steering angle by the share of the chord [rad].
    pub fn angle_derivatives(&self, s: f64) -> [f64; 3] {
        if !self.turns {
            return [0.0; 3];
        }
        let w = self.change / self.velocity(s);
        let square = w * w;
        [w.im, -square.im, 2.0 * (square * w).im]
    }

    /// Speed of the pivot [m/s], positive along the wheel's direction at the start, and its first two derivatives by
    /// the share of the chord.
    pub fn speed(&self, s: f64) -> [f64; 3] {
        let velocity = self.velocity(s);
        let speed = velocity.norm();
        if !self.turns || speed == 0.0 {
            return [speed, self.change.norm(), 0.0];
        }
        let slope = (velocity.conj() * self.change).re / speed;
        let bend = (self.change.norm_sqr() - slope * slope) / speed;
        [speed, slope, bend]
    }

    /// Share of the chord at which the pivot speed is least.
    pub fn slowest(&self) -> f64 {
        -(self.origin.conj() * self.change).re / self.change.norm_sqr()
    }

    /// Share of the chord at which the pivot has this speed [m/s], before or after its least speed.
    pub fn at_speed(&self, speed: f64, after: bool) -> f64 {
        let nearest = (self.origin.conj() * self.change).im / self.change.norm();
        let root = (speed * speed - nearest * nearest).max(0.0).sqrt() / self.change.norm();
        self.slowest() + if after { root } else { -root }
    }
}

/// All wheels between two twists.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Chord {
    pub start: Vector3<f64>,
    pub end: Vector3<f64>,
    pub joints: Vec<Joint>,
}

/// A chord that all wheels can follow, or the reason why they cannot.
pub(crate) enum ChordFeasibility {
    /// The chord; wheels whose present angles differ from those at its start have to be aligned first.
    Open(Chord),
    /// The reason, in words.
    Closed(Cow<'static, str>),
}

/// True if a pivot rests, up to rounding.
fn rests(twist: Twist, x: f64, y: f64) -> bool {
    let u = twist.at(x, y);
    let summed = twist.vx.abs() + twist.vy.abs() + twist.omega.abs() * (x.abs() + y.abs());
    u.amax() <= REST * summed
}

impl Chord {
    /// The chord from one twist to another with wheels that stand at these angles; both twists must be possible.
    pub fn between(rover: &Rover, start: Twist, end: Twist, angles: &[f64]) -> ChordFeasibility {
        let [aligned, _] = solved(rover, end, Some(angles));
        let mut joints = Vec::with_capacity(angles.len());
        for (j, &i) in rover.steered().iter().enumerate() {
            let wheel = &rover.wheels()[i];
            let Mount::Steered(range, _) = rover.mounts[i] else {
                continue;
            };
            let velocity = |twist: Twist| {
                let u = twist.at(wheel.x, wheel.y);
                let still = rests(twist, wheel.x, wheel.y);
                if still { Complex::default() } else { Complex::new(u.x, u.y) }
            };
            let (origin, target) = (velocity(start), velocity(end));
            let change = target - origin;
            let across = (change * origin.conj()).im;
            // On a line through 0 the direction is constant; the wheel may roll backwards.
            let turns = across.abs() > PARALLEL * origin.norm() * change.norm();
            let joint = Joint {
                angle: if origin == Complex::default() { aligned[j] } else { angles[j] },
                origin,
                change,
                turns,
            };
            let least = joint.velocity(joint.slowest().clamp(0.0, 1.0)).norm();
            if turns && least < TOO_CLOSE * change.norm() {
                let name = &wheel.name;
                let why = format!("the centre of rotation would pass over the pivot of {name:?}");
                return ChordFeasibility::Closed(why.into());
            }
            let last = joint.angle + joint.swept(1.0);
            if last < range.lower - ANGLE_TOLERANCE || last > range.upper + ANGLE_TOLERANCE {
                let why = format!("{:?} would have to steer to {}, outside {range}", wheel.name, radians(last));
                return ChordFeasibility::Closed(why.into());
            }
            joints.push(joint);
        }
        ChordFeasibility::Open(Self { start: start.into(), end: end.into(), joints })
    }

    /// Change of the twist over the chord.
    pub fn change(&self) -> Vector3<f64> {
        self.end - self.start
    }

    /// The twist, exact at both ends.
    pub fn twist(&self, s: f64) -> Twist {
        (self.start * (1.0 - s) + self.end * s).into()
    }

    /// A monotonic function of the share: the share itself plus the turns of all wheels.
    pub fn measure(&self, s: f64) -> f64 {
        s + self.joints.iter().map(|joint| joint.swept(s).abs()).sum::<f64>()
    }

    /// Shares of the chord between which the measure grows by equal amounts.
    pub fn nodes(&self, cells: usize) -> Vec<f64> {
        let whole = self.measure(1.0);
        let mut nodes = Vec::with_capacity(cells + 1);
        let mut low = 0.0;
        for k in 0..=cells {
            let wanted = whole * k as f64 / cells as f64;
            if k == 0 || k == cells {
                nodes.push(k as f64 / cells as f64);
                continue;
            }
            let [a, b] = bisect([low, 1.0], 50, |s| self.measure(s) < wanted);
            low = a;
            nodes.push(f64::midpoint(a, b));
        }
        nodes.dedup();
        nodes
    }
}

/// Steering angles and wheel speeds of a twist that need not be possible, with the angles nearest to the previous ones.
pub(crate) fn solved(rover: &Rover, twist: Twist, previous: Option<&[f64]>) -> [Vec<f64>; 2] {
    let (mut angles, mut speeds) = (vec![0.0; rover.steered().len()], vec![0.0; rover.wheels().len()]);
    rover.solve(twist, Inputs { previous, ..Inputs::default() }, &mut angles, &mut speeds);
    [angles, speeds]
}

/// Halves an interval at whose first end something holds and at whose last it does not, and returns the ends that are left.
pub(crate) fn bisect([mut first, mut last]: [f64; 2], halvings: usize, holds: impl Fn(f64) -> bool) -> [f64; 2] {
    for _ in 0..halvings {
        let middle = f64::midpoint(first, last);
        *if holds(middle) { &mut first } else { &mut last } = middle;
    }
    [first, last]
}

/// True if a motor turns the wheel.
pub(crate) fn is_driven(rover: &Rover, i: usize) -> bool {
    let wheel = &rover.wheels()[i];
    wheel.driven && wheel.pivot != Pivot::Castor
}
