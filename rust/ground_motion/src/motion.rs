//! Wheels to body and body to wheels on the ground.

use nalgebra::Rotation3;

use super::contact::{COLUMNS, Contacts, Footing, Row};
use super::rest_offset;
use super::steer::steer;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::least_squares::{back, shortest, triangular};
pub(crate) use six_wheel_numerics::simd::vec3::inner_product as dot;
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// Columns of the motion in plan: `vx, vy, wz`.
pub(crate) const PLAN: [usize; 3] = [0, 1, 5];

/// Rates that the ground decides: `vz, wx, wy` and the free angles.
pub(crate) const FOLLOWING: [usize; 3 + MAX_FREE] = [2, 3, 4, 6, 7, 8];

/// Measurements of wheels, joints and body.
#[derive(Clone, Copy, Debug, Default)]
pub struct Readings<'a> {
    /// Speed of every wheel against its link [rad/s]; NaN where it was not measured.
    pub speeds: &'a [f64],
    /// Rates of the steering angles [rad/s].
    pub steering_rates: Option<&'a [f64]>,
    /// Rates of the free angles [rad/s]; NaN where one was not measured.
    pub joint_rates: Option<&'a [f64]>,
    /// Of the body about its axes [rad/s]; NaN where it was not measured.
    pub angular_velocity: Option<&'a [f64]>,
    /// Weight of every wheel, or of every wheel's rolling and side slip.
    pub weights: Option<&'a [f64]>,
}

impl Readings<'_> {
    /// Rates that are no unknowns; NaN for those that are.
    pub(crate) fn known(&self, contacts: &Contacts) -> Row {
        let mut known = [f64::NAN; COLUMNS];
        for (k, rate) in self.angular_velocity.into_iter().flatten().enumerate() {
            known[3 + k] = *rate;
        }
        for (k, rate) in self.joint_rates.into_iter().flatten().enumerate() {
            known[6 + k] = *rate;
        }
        for (k, stopped) in contacts.stopped.into_iter().enumerate() {
            if stopped || k >= contacts.joints {
                known[6 + k] = 0.0;
            }
        }
        known
    }
}

/// Motion of the body.
#[derive(Clone, Copy, Debug)]
pub struct Moving {
    /// Of the body's origin, in its axes [m/s, rad/s].
    pub twist: [f64; 6],
    /// Of the free angles [rad/s].
    pub joint_rates: [f64; MAX_FREE],
    /// Velocity of every touching point along the normal, along the tangent and to the left [m/s]; NaN in the air.
    pub residual: [[f64; 3]; MAX_WHEELS],
}

/// Frame of a commanded speed and yaw rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// Of the body along its x axis and about its z axis.
    Body,
    /// Seen from above, along the heading.
    Plan,
}

/// A wanted motion.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// Forward speed [m/s].
    pub speed: f64,
    /// Counter-clockwise [rad/s].
    pub yaw_rate: f64,
}

/// Settings by which wanted motions become commands.
#[derive(Clone, Copy, Debug)]
pub struct Command {
    /// Frame of speeds and yaw rates.
    pub view: View,
    /// Distance behind the origin of the point that moves straight ahead [m]: [`rest_offset`].
    pub offset: f64,
    /// Largest speed of a wheel [rad/s]: all are slowed down together to keep it.
    pub wheel_speed: f64,
}

impl Command {
    /// In the body's axes, without a limit.
    pub fn new(chain: &Chain) -> Self {
        Self { view: View::Body, offset: rest_offset(chain), wheel_speed: f64::INFINITY }
    }
}

/// Commands of the wheels, and the motion of the rover that follows from them.
#[derive(Clone, Copy, Debug)]
pub struct Commanded {
    /// Angles of the steering joints [rad].
    pub steering: [f64; MAX_WHEELS],
    /// Speed of every wheel against its link [rad/s].
    pub speeds: [f64; MAX_WHEELS],
    /// Of the body's origin, in its axes [m/s, rad/s].
    pub twist: [f64; 6],
    /// Of the free angles [rad/s].
    pub joint_rates: [f64; MAX_FREE],
    /// Scale of the wanted motion, 1 unless a wheel would have been too fast.
    pub scale: f64,
}

/// Rates as a function of those in plan: `offset + spread . plan`.
pub(crate) struct SuspensionRates {
    pub spread: [[f64; 3]; COLUMNS],
    pub offset: Row,
}

impl SuspensionRates {
    /// Derivatives of a velocity along `direction` by the motion in plan.
    pub fn plan(&self, direction: &Row) -> [f64; 3] {
        std::array::from_fn(|k| (0..COLUMNS).map(|c| direction[c] * self.spread[c][k]).sum())
    }
}

impl Contacts {
    pub(crate) fn touching(&self) -> impl Iterator<Item = (usize, &super::contact::Contact)> {
        let wheels = self.wheels[..self.count].iter().enumerate();
        wheels.filter(|(_, contact)| contact.touching)
    }

    /// The suspension follows the ground whatever the motion in plan: rates that are not known (NaN) are those that
    /// keep the wheels on it, in least squares where there are fewer of them than wheels.
    pub(crate) fn follow(&self, known: &Row, swivels: &[f64; MAX_WHEELS]) -> SuspensionRates {
        let mut unknown = [0; FOLLOWING.len()];
        let mut count = 0;
        let mut follow = SuspensionRates {
            spread: [[0.0; 3]; COLUMNS],
            offset: known.map(|rate| if rate.is_nan() { 0.0 } else { rate }),
        };
        for column in FOLLOWING {
            if known[column].is_nan() {
                unknown[count] = column;
                count += 1;
            }
        }
        for (k, column) in PLAN.into_iter().enumerate() {
            if known[column].is_nan() {
                follow.spread[column][k] = 1.0;
            }
        }
        // Unknown columns, then what stands on the right-hand side: one motion in plan each, and what is known.
        const RIGHT: usize = 4;
        let mut rows = [[0.0; FOLLOWING.len() + RIGHT]; MAX_WHEELS];
        let mut filled = 0;
        for (wheel, contact) in self.touching() {
            let row = &mut rows[filled];
            filled += 1;
            for (cell, column) in row.iter_mut().zip(&unknown[..count]) {
                *cell = contact.normal[*column];
            }
            for (k, column) in PLAN.into_iter().enumerate() {
                row[count + k] = -contact.normal[column] * follow.spread[column][k];
            }
            row[count + 3] = -dot(&contact.normal, &follow.offset) - contact.swivel[0] * swivels[wheel];
        }
        triangular(&mut rows, filled, count.min(filled));
        let solution: [[f64; RIGHT]; FOLLOWING.len()] =
            if filled < count { [[f64::NAN; RIGHT]; FOLLOWING.len()] } else { back(&rows, count) };
        for (column, [x, y, turn, rest]) in unknown[..count].iter().zip(solution) {
            follow.spread[*column] = [x, y, turn];
            follow.offset[*column] = rest;
        }
        follow
    }

    /// Twist and joint rates from the wheels: the motion in plan by weighted least squares over the contacts.
    pub fn forward(&self, readings: &Readings<'_>, radii: &[f64; MAX_WHEELS]) -> Moving {
        let known = readings.known(self);
        let mut swivels = [0.0; MAX_WHEELS];
        if let Some(rates) = readings.steering_rates {
            for (swivel, contact) in swivels.iter_mut().zip(&self.wheels[..self.count]) {
                *swivel = contact.steering.map_or(0.0, |joint| rates[joint]);
            }
        }
        let follow = self.follow(&known, &swivels);
        let mut rows = [[0.0; 4]; 3 * MAX_WHEELS];
        let mut filled = 0;
        for (wheel, contact) in self.touching() {
            let [mut roll, side] = weights(readings.weights, self.count, wheel);
            if readings.speeds[wheel].is_nan() {
                roll = 0.0;
            }
            let left = self.slip(wheel, contact, &follow.offset, readings, &swivels, radii);
            let directions = [contact.normal, contact.rolling, contact.side];
            let shares = [roll.max(side), roll, side];
            for (i, (direction, share)) in directions.into_iter().zip(shares).enumerate() {
                if left[i].is_nan() && share == 0.0 {
                    continue; // not measured
                }
                let scale = share.sqrt();
                let unit = if i == 1 { radii[wheel] } else { 1.0 };
                let columns = follow.plan(&direction);
                for (cell, column) in rows[filled][..3].iter_mut().zip(columns) {
                    *cell = scale * unit * column;
                }
                rows[filled][3] = -scale * left[i];
                filled += 1;
            }
        }
        triangular(&mut rows, filled, 3.min(filled));
        // In the air nothing says how it moves.
        let plan = match filled {
            0 => [f64::NAN; 3],
            _ => shortest([rows[0], rows[1], rows[2]]),
        };
        let mut rates = follow.offset;
        for (rate, spread) in rates.iter_mut().zip(&follow.spread) {
            for (share, plan) in spread.iter().zip(plan) {
                *rate += share * plan;
            }
        }
        let mut residual = [[f64::NAN; 3]; MAX_WHEELS];
        for (wheel, contact) in self.touching() {
            residual[wheel] = self.slip(wheel, contact, &rates, readings, &swivels, radii);
        }
        let (twist, joint_rates) = split(&rates);
        Moving { twist, joint_rates, residual }
    }

    /// Velocity of a touching point at these rates, along the normal, along the tangent and to the left [m/s].
    pub(crate) fn slip(
        &self,
        wheel: usize,
        contact: &super::contact::Contact,
        rates: &Row,
        readings: &Readings<'_>,
        swivels: &[f64; MAX_WHEELS],
        radii: &[f64; MAX_WHEELS],
    ) -> [f64; 3] {
        let [lift, aside, rolled] = contact.swivel;
        let rolled = dot(&contact.rolling, rates) + rolled * swivels[wheel];
        [
            dot(&contact.normal, rates) + lift * swivels[wheel],
            radii[wheel] * (rolled - readings.speeds[wheel]),
            dot(&contact.side, rates) + aside * swivels[wheel],
        ]
    }

    /// Twist and joint rates of a wanted motion.
    fn rigid(&self, attitude: [f64; 3], command: &Command, wanted: Wanted) -> Row {
        let mut known = [f64::NAN; COLUMNS];
        for (k, stopped) in self.stopped.into_iter().enumerate() {
            if stopped || k >= self.joints {
                known[6 + k] = 0.0;
            }
        }
        let follow = self.follow(&known, &[0.0; MAX_WHEELS]);
        let sideways = wanted.yaw_rate * command.offset;
        let plan = match command.view {
            View::Body => [wanted.speed, sideways, wanted.yaw_rate],
            View::Plan => {
                let [roll, pitch, _] = attitude;
                let level = Rotation3::from_euler_angles(roll, pitch, 0.0);
                // The yaw rate is what turns about the vertical beyond pitching, whose axis is level.
                let turning = [roll.sin() / pitch.cos(), roll.cos() / pitch.cos()];
                let rows = [level.matrix().row(0), level.matrix().row(1)];
                let mut system = [[0.0; 4]; 3];
                for k in 0..3 {
                    let column = |c: usize| follow.spread[c][k];
                    for (cells, row) in system.iter_mut().zip(rows) {
                        cells[k] = (0..3).map(|c| row[c] * column(c)).sum();
                    }
                    system[2][k] = turning[0] * column(4) + turning[1] * column(5);
                }
                for (cells, value) in system.iter_mut().zip([wanted.speed, sideways, wanted.yaw_rate]) {
                    cells[3] = value;
                }
                triangular(&mut system, 3, 3);
                back::<3, 4, 3, 1>(&system, 3).map(|[value]| value)
            }
        };
        std::array::from_fn(|c| (0..3).map(|k| follow.spread[c][k] * plan[k]).sum())
    }
}

/// Wheels for a wanted motion on this ground, for steering angles that are given or, by default, those at which
/// the touching points roll where they go.
///
/// The motion is that of the footing's own contacts. Steering moves a contact; it is taken to move on the plane
/// that the wheel stands on, so the command is exact where the ground is plane or the footing was settled at
/// the very angles that come out. Fails if a wheel would steer past its range.
pub fn inverse(
    chain: &Chain,
    footing: &Footing<'_>,
    command: &Command,
    wanted: Wanted,
    steering: Option<&[f64]>,
) -> Result<Commanded, Error> {
    let nothing = Commanded {
        steering: [f64::NAN; MAX_WHEELS],
        speeds: [f64::NAN; MAX_WHEELS],
        twist: [f64::NAN; 6],
        joint_rates: [f64::NAN; MAX_FREE],
        scale: f64::NAN,
    };
    let Some(contacts) = Contacts::new(chain, footing, None) else {
        return Ok(nothing);
    };
    let rates = contacts.rigid(footing.attitude, command, wanted);
    if rates.iter().any(|rate| rate.is_nan()) {
        return Ok(nothing);
    }
    let mut angles = [0.0; MAX_WHEELS];
    let joints = footing.steering.len();
    match steering {
        Some(given) => angles[..joints].copy_from_slice(given),
        None => steer(chain, footing, &rates, &mut angles)?,
    }
    // At its own angles a footing has its own contacts, wherever on the rims they are.
    let moved = (angles[..joints] != *footing.steering).then_some(&angles[..joints]);
    let moved = moved.map_or(Some(contacts), |angles| Contacts::new(chain, footing, Some(angles)));
    let Some(contacts) = moved else {
        return Ok(nothing);
    };
    let mut speeds = [0.0; MAX_WHEELS];
    let mut fastest: f64 = 0.0;
    for (speed, contact) in speeds.iter_mut().zip(&contacts.wheels[..contacts.count]) {
        *speed = dot(&contact.rolling, &rates);
        fastest = fastest.max(speed.abs());
    }
    let scale = if fastest > command.wheel_speed { command.wheel_speed / fastest } else { 1.0 };
    let (twist, joint_rates) = split(&rates);
    Ok(Commanded {
        steering: angles,
        speeds: speeds.map(|speed| scale * speed),
        twist: twist.map(|rate| scale * rate),
        joint_rates: joint_rates.map(|rate| scale * rate),
        scale,
    })
}

pub(crate) fn weights(weights: Option<&[f64]>, count: usize, wheel: usize) -> [f64; 2] {
    match weights {
        None => [1.0; 2],
        Some(each) if each.len() == count => [each[wheel]; 2],
        Some(both) => [both[2 * wheel], both[2 * wheel + 1]],
    }
}

fn split(rates: &Row) -> ([f64; 6], [f64; MAX_FREE]) {
    (std::array::from_fn(|k| rates[k]), std::array::from_fn(|k| rates[6 + k]))
}
