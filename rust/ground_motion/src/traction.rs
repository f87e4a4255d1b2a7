//! Wheel speeds over rough ground without a map of it.
//!
//! The rates of body and suspension say how every wheel's centre moves, up to the vertical speed of the body, which
//! no rate shows. A wheel on the ground moves along the tangent of its rim there, so the direction of that velocity
//! is its contact angle and the length its rolling speed.
//!
//! (O. Toupet, J. Biesiadecki, A. Rankin, A. Steffy, G. Meirion-Griffith, D. Levine, M. Schadegg, M. Maimone,
//! Terrain-adaptive wheel speed control on the Curiosity Mars rover, JFR 37(5), 2020; here with the turning of the
//! link that carries the wheel, which its encoder does not see.)

use nalgebra::Vector3;

use super::contact::{COLUMNS, Row, carried, in_body};
use super::steer::steer_in_plan;
use six_wheel_numerics::error::Error;
use six_wheel_terrain::suspension::{Chain, MAX_WHEELS};

/// Commanded and measured rates.
#[derive(Clone, Copy, Debug)]
pub struct Rates<'a> {
    /// Commanded forward speed of the body [m/s].
    pub speed: f64,
    /// Commanded yaw rate of the body [rad/s].
    pub yaw_rate: f64,
    /// Rates about the body's x and y axes [rad/s].
    pub tilt_rates: [f64; 2],
    /// Free angles [rad].
    pub joints: &'a [f64],
    /// Their rates [rad/s].
    pub joint_rates: &'a [f64],
    /// Present steering angles [rad]: a wheel that rests holds its own.
    pub steering: &'a [f64],
}

/// Source of the vertical speed of the body.
#[derive(Clone, Copy, Debug)]
pub enum Closure<'a> {
    /// The median over the wheels of the one at which a wheel moves along its link: least in the sum of what they
    /// move across, and unmoved by two wheels on rocks.
    Suspension,
    /// Least squares against the measured speeds of the wheels [rad/s].
    Wheels(&'a [f64]),
}

/// From when on a wheel is taken to be off the ground: it moves across its link as no slope would push it.
#[derive(Clone, Copy, Debug)]
pub struct Lift {
    /// Steepest slope that wheels climb, against the link, at the commanded speed [rad].
    pub angle: f64,
    /// Slowest such motion that counts [m/s].
    pub speed: f64,
}

/// Tangent of the default.
const STEEPEST: f64 = 1.557_407_724_654_902_3;

impl Lift {
    /// The steepest slope as a ratio.
    pub(crate) fn slope(self) -> f64 {
        match self.angle {
            1.0 => STEEPEST,
            angle => angle.tan(),
        }
    }
}

impl Default for Lift {
    /// Slopes of 1 rad, from 1 cm/s on.
    fn default() -> Self {
        Self { angle: 1.0, speed: 0.01 }
    }
}

/// Commands of the wheels.
#[derive(Clone, Copy, Debug)]
pub struct Driven {
    /// Angles of the steering joints [rad].
    pub steering: [f64; MAX_WHEELS],
    /// Speed of every wheel against its link [rad/s].
    pub speeds: [f64; MAX_WHEELS],
    /// Contact angle of every wheel with the ground [rad].
    pub contact_angles: [f64; MAX_WHEELS],
    /// True for a wheel that the joints lift or drop as no ground would.
    pub lifted: [bool; MAX_WHEELS],
    /// Vertical speed of the body's origin, in its axes [m/s].
    pub vertical: f64,
}

/// The velocity of a wheel's centre along and across its link, but for the body's vertical speed.
#[derive(Clone, Copy)]
struct Centre {
    along: f64,
    across: f64,
    /// Both velocities per vertical speed of the body [1].
    vertical: [f64; 2],
    /// Rate of the link about the axle [rad/s].
    turn: f64,
    radius: f64,
}

impl Centre {
    fn at(&self, vertical: f64) -> [f64; 2] {
        [self.along + self.vertical[0] * vertical, self.across + self.vertical[1] * vertical]
    }
}

/// Wheels for commanded speed and yaw rate, from the rates of body and joints alone. Fails if a wheel would steer
/// past its range.
pub fn traction(
    chain: &Chain,
    offset: f64,
    rates: &Rates<'_>,
    closure: Closure<'_>,
    lift: Lift,
) -> Result<Driven, Error> {
    let mut driven = Driven {
        steering: [f64::NAN; MAX_WHEELS],
        speeds: [f64::NAN; MAX_WHEELS],
        contact_angles: [f64::NAN; MAX_WHEELS],
        lifted: [false; MAX_WHEELS],
        vertical: f64::NAN,
    };
    let (count, joints) = (chain.wheels().len(), chain.steering().len());
    let sideways = rates.yaw_rate * offset;
    let Some(mut placed) = in_body(chain, rates.joints, &[]) else {
        return Ok(driven);
    };
    let mut known: Row = [0.0; COLUMNS];
    known[..6].copy_from_slice(&[rates.speed, sideways, 0.0, rates.tilt_rates[0], rates.tilt_rates[1], rates.yaw_rate]);
    for (rate, joint) in known[6..].iter_mut().zip(rates.joint_rates) {
        *rate = *joint;
    }
    driven.steering = [0.0; MAX_WHEELS];
    for (angle, present) in driven.steering.iter_mut().zip(rates.steering) {
        *angle = *present;
    }
    steer_in_plan(chain, &placed, &known, &mut driven.steering)?;
    if placed.steer(rates.joints, &driven.steering[..joints]).is_none() {
        return Ok(driven);
    }
    let centres: [Centre; MAX_WHEELS] = std::array::from_fn(|wheel| {
        let wheel = wheel.min(count - 1);
        let frame = placed.wheel(wheel);
        let (velocity, turn) = carried(&placed, wheel, &known);
        Centre {
            along: velocity.dot(&frame.forward),
            across: velocity.dot(&frame.up),
            vertical: [frame.forward.z, frame.up.z],
            turn: turn.dot(&frame.axle),
            radius: chain.wheels()[wheel].radius,
        }
    });
    let centres = &centres[..count];
    driven.vertical = match closure {
        Closure::Suspension => along_the_links(centres),
        Closure::Wheels(measured) => from_wheels(centres, measured),
    };
    let steepest = lift.slope();
    for (wheel, centre) in centres.iter().enumerate() {
        let [along, across] = centre.at(driven.vertical);
        let way = if along < 0.0 { -1.0 } else { 1.0 };
        let speed = along.hypot(across);
        driven.speeds[wheel] = way * speed / centre.radius - centre.turn;
        driven.contact_angles[wheel] = (way * across).atan2(way * along);
        let slope = steepest * in_plan(placed.wheel(wheel).centre, rates, sideways).norm();
        driven.lifted[wheel] = across.abs() > lift.speed.max(slope);
    }
    Ok(driven)
}

/// The velocity of a point of the body as commanded [m/s].
fn in_plan(point: Vector3<f64>, rates: &Rates<'_>, sideways: f64) -> Vector3<f64> {
    let turn = rates.yaw_rate;
    Vector3::new(rates.speed - turn * point.y, sideways + turn * point.x, 0.0)
}

/// [`Closure::Suspension`].
fn along_the_links(centres: &[Centre]) -> f64 {
    let mut speeds = [f64::NAN; MAX_WHEELS];
    for (speed, centre) in speeds.iter_mut().zip(centres) {
        *speed = 0.0 - centre.across / centre.vertical[1];
    }
    let speeds = &mut speeds[..centres.len()];
    if speeds.iter().any(|speed| speed.is_nan()) {
        return f64::NAN;
    }
    speeds.sort_unstable_by(f64::total_cmp);
    let middle = speeds.len() / 2;
    if speeds.len() % 2 == 1 { speeds[middle] } else { 0.5 * (speeds[middle - 1] + speeds[middle]) }
}

/// Steps of Gauss and Newton.
pub(crate) const STEPS: usize = 20;

/// Step below which the vertical speed is found [m/s].
pub(crate) const FOUND: f64 = 1e-15;

/// Added to the sum of squared derivatives: on level ground the rolling speeds do not depend on the vertical one.
pub(crate) const DAMPING: f64 = 1e-3;

/// [`Closure::Wheels`], by damped Gauss-Newton steps from [`along_the_links`].
fn from_wheels(centres: &[Centre], measured: &[f64]) -> f64 {
    let mut vertical = along_the_links(centres);
    for _ in 0..STEPS {
        let (mut slope, mut square) = (0.0, DAMPING);
        for (centre, measured) in centres.iter().zip(measured) {
            let [along, across] = centre.at(vertical);
            let speed = along.hypot(across);
            if speed == 0.0 {
                continue;
            }
            let [ahead, up] = centre.vertical;
            let derivative = (along * ahead + across * up) / speed;
            let missing = (centre.radius * (measured + centre.turn)).abs() - speed;
            slope += derivative * missing;
            square += derivative * derivative;
        }
        let step = slope / square;
        vertical += step;
        if step.abs() < FOUND {
            break;
        }
    }
    vertical
}
