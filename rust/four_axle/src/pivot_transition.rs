//! Turns of a free pair by its wheels in motion.
//!
//! With the axles of the locked pair in line, the centre of rotation can move along that line. The wheels of the free
//! pair turn at constant speeds; the drives of the locked pair follow, since constant speeds of its wheels would fix
//! the centre.

use nalgebra::Vector3;

use super::flow::gauss;
use super::{Axles, Brake, Brakes, Drives, FourAxle, Pair, RANK_TOLERANCE, pair_motions};
use six_wheel_kinematics::admissible::SLIP_TOLERANCE;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_numerics::error::number;

/// Least pivot rate and least speed at every point of a turn in motion, as shares of the desired ones.
const LEAST_SHARE: f64 = 0.1;

/// Relative accuracy of durations, and largest number of panels of their quadrature.
const DURATION_ACCURACY: f64 = 1e-14;
const PANELS: usize = 4096;

/// Constant wheel speeds that turn the free pair from one angle to another in motion, the duration [s], and the twist
/// at the end.
pub(super) struct PivotTransition {
    pub speeds: Drives,
    pub duration: f64,
    pub twist: Twist,
}

impl FourAxle {
    /// Constant wheel speeds of one pair that turn it to its goal in motion, while the drives of the other pair follow.
    pub(super) fn pivot_transition(
        &self,
        start: Axles,
        twist: Twist,
        pair: Pair,
        goal: &Axles,
        rate: f64,
    ) -> Result<PivotTransition, String> {
        let path = Path::new(self, start, twist, pair, goal)?;
        let speed = self.pivot_speed(twist);
        let mut last = String::new();
        // The rate is smallest at one of the ends.
        for end in [0.0, 1.0] {
            let speeds = path.wheel_speeds(end, speed, rate);
            match path.duration(&speeds, speed, rate) {
                Ok((duration, twist)) => {
                    return Ok(PivotTransition { speeds, duration, twist });
                }
                Err(refusal) => last = refusal,
            }
        }
        Err(last)
    }

    /// Component of a twist along a direction in twist space, as a root mean square speed of the pivots [m/s].
    fn scaled_dot(&self, direction: &Vector3<f64>, twist: Twist) -> f64 {
        let size = self.rover().size;
        let length = self.pivot_speed(Twist::from(*direction));
        (direction.x * twist.vx + direction.y * twist.vy + direction.z * twist.omega * size * size) / length
    }
}

/// Path of the centre of rotation along the line of the locked axles: twists on a straight line between two, by a share
/// from 0 to 1.
struct Path<'a> {
    car: &'a FourAxle,
    pair: Pair,
    brakes: Brakes,
    start: Axles,
    from: Vector3<f64>,
    to: Vector3<f64>,
}

impl<'a> Path<'a> {
    fn new(car: &'a FourAxle, start: Axles, twist: Twist, pair: Pair, goal: &Axles) -> Result<Self, String> {
        let other = pair.other().name();
        let mut end = start;
        for i in pair.axles() {
            end[i] = goal[i];
        }
        let normals = car.side_slip(&start);
        let held = pair_motions(&normals, pair.other());
        if held.values.y > SLIP_TOLERANCE {
            return Err(format!(
                "the {other} axles are not in line: locked they hold the centre of rotation where their \
                 lines meet"
            ));
        }
        let mobility = car.mobility_unchecked(&end);
        if mobility.degree() != 1 || mobility.slip > SLIP_TOLERANCE {
            return Err(format!(
                "the {} axles would have no point in common with the {other} ones as they are",
                pair.name()
            ));
        }
        let from = Vector3::from(twist) / car.pivot_speed(twist);
        let to = Vector3::from(mobility.least());
        let path = |to| Self { car, pair, brakes: Brakes::LOCKED.with(pair, Brake::Free), start, from, to };
        [path(to), path(-to)]
            .into_iter()
            .find(|path| path.leads_to(&end))
            .ok_or_else(|| format!("the {} axles would have to turn past a quarter turn, or stop", pair.name()))
    }

    fn twist(&self, at: f64) -> Vector3<f64> {
        self.from * (1.0 - at) + self.to * at
    }

    /// Axle angles at a share of the path [rad]: the headings follow the velocities of their pivots.
    fn angles(&self, at: f64) -> Axles {
        let rows = self.car.rows(&self.start);
        let twist = self.twist(at);
        let mut angles = self.start;
        for i in self.pair.axles() {
            let along = |twist| self.car.along(i, &rows, twist);
            let forwards = along(&self.from).signum();
            let across = rows[i].side_slip.dot(&twist);
            angles[i] += (forwards * across).atan2(forwards * along(&twist));
        }
        angles
    }

    fn leads_to(&self, end: &Axles) -> bool {
        let rows = self.car.rows(&self.start);
        let reached = self.angles(1.0);
        // The wheels of the locked pair must not change their sense of rotation, and no pivot may come to rest.
        let rolls_on = (0..4).all(|i| {
            let along = |twist| self.car.along(i, &rows, twist);
            let turning = self.pair.axles().contains(&i);
            along(&self.from).abs() > RANK_TOLERANCE && (turning || along(&self.from) * along(&self.to) > 0.0)
        });
        rolls_on && self.pair.axles().iter().all(|&i| (reached[i] - end[i]).abs() <= SLIP_TOLERANCE)
    }

    /// Angles, and their derivatives with respect to the share of the path: `n . du = (e . u) dangle`.
    fn slopes(&self, at: f64) -> (Axles, Axles) {
        let angles = self.angles(at);
        let rows = self.car.rows(&angles);
        let twist = self.twist(at);
        let mut slopes = [0.0; 4];
        for i in self.pair.axles() {
            slopes[i] = rows[i].side_slip.dot(&(self.to - self.from)) / self.car.along(i, &rows, &twist);
        }
        (angles, slopes)
    }

    /// Wheel speeds of the free pair [rad/s] for this pivot speed [m/s] and this rate of the faster axle [rad/s].
    fn wheel_speeds(&self, at: f64, speed: f64, rate: f64) -> Drives {
        let (angles, slopes) = self.slopes(at);
        let rows = self.car.rows(&angles);
        let wheels = self.car.rover().wheels();
        let twist = self.twist(at);
        let twist = twist * (speed / self.car.pivot_speed(Twist::from(twist)));
        let steepest = steepest(&slopes);
        let mut speeds = [None; 4];
        for i in self.pair.axles() {
            let turning = rate * slopes[i] / slopes[steepest].abs();
            let rim_speed = rows[i].rolling.dot(&twist) - wheels[i].scrub * turning;
            speeds[i] = Some(rim_speed / wheels[i].radius);
        }
        speeds
    }

    /// Duration of the turn with these wheel speeds [s], and the twist at its end.
    ///
    /// The rates are functions of the share alone, so the duration is an integral over the share.
    fn duration(&self, speeds: &Drives, speed: f64, rate: f64) -> Result<(f64, Twist), String> {
        let mut duration = f64::INFINITY;
        let mut panels = 8;
        while panels <= PANELS {
            let rule = gauss();
            let mut sum = 0.0;
            for panel in 0..panels {
                for (node, weight) in rule.nodes.iter().zip(&rule.weights) {
                    let at = (panel as f64 + node) / panels as f64;
                    let (pace, _) = self.progress(at, speeds, speed, rate)?;
                    sum += weight / pace;
                }
            }
            let next = sum / panels as f64;
            if (next - duration).abs() <= DURATION_ACCURACY * next {
                break;
            }
            duration = next;
            panels *= 2;
        }
        let (_, twist) = self.progress(1.0, speeds, speed, rate)?;
        Ok((duration, twist))
    }

    /// Share of the path per second [1/s], and the twist, at these wheel speeds.
    fn progress(&self, at: f64, speeds: &Drives, speed: f64, rate: f64) -> Result<(f64, Twist), String> {
        let (angles, slopes) = self.slopes(at);
        let motion = self.car.velocities(&angles, self.brakes, speeds, true).map_err(|error| error.to_string())?;
        let steepest = steepest(&slopes);
        let pace = motion.pivot_rates[steepest] / slopes[steepest];
        let along = self.car.scaled_dot(&self.twist(at), motion.twist);
        if pace * slopes[steepest].abs() >= LEAST_SHARE * rate && along >= LEAST_SHARE * speed {
            return Ok((pace, motion.twist));
        }
        Err(format!(
            "no constant speeds of the {} wheels turn their axles all the way at {} rad/s and {} m/s",
            self.pair.name(),
            number(rate),
            number(speed)
        ))
    }
}

fn steepest(slopes: &Axles) -> usize {
    (0..4).fold(0, |best, i| if slopes[i].abs() > slopes[best].abs() { i } else { best })
}
