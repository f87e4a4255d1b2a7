//! `Suspension.inverse` and `Suspension.forward`.

use pyo3::prelude::*;
use six_wheel_ground_motion::{BodyMotions, Command, Commands, ReadingRows, View, forward_rows, inverse_rows};
use six_wheel_numerics::error::LARGEST;

use super::results::{Columns, GroundCommand, GroundMotion};
use super::settled_pose_input::Stands;
use crate::convert::{Broadcast, OrRaise, Out, Rows, choice, compute_rows, joined, number, refuse, together};
use crate::suspension::Suspension;
use crate::workers::workers;

fn view(name: &str) -> PyResult<View> {
    choice("view", name, |name| format!("{name:?}"), &[("body", View::Body), ("plan", View::Plan)])
}

methods! { Suspension:
    /// Wheels for a wanted motion on the ground a rover stands on.
    ///
    /// Every wheel stays on the ground and rolls; steered wheels point where their touching points go, what
    /// unsteered ones are left with sideways is slip. The point abreast of which the unsteered wheels stand
    /// at rest moves straight ahead, as in `RockerBogie.steer`. On level ground, for a rover that stands level,
    /// this is the rover seen from above.
    ///
    /// Twist and joint rates are those of the stand's own contacts. Steering moves a contact; it is taken to move on
    /// the plane its wheel stands on. So the answer is exact where the ground is plane, and elsewhere for a stand
    /// settled at the steering angles that come out: settle once more with them.
    #[doc = section!(Parameters)]
    /// stand : SettledPose
    ///     Result of `settle`, shape (...). Rows that did not settle give NaN.
    /// command : array_like, shape (..., 2) or (..., 3)
    ///     Forward speed [m/s] and yaw rate [rad/s], or a twist ``(vx, vy, omega)`` whose vy is 0, or that of the result.
    /// view : {'body', 'plan'}
    ///     Frame of the motion: the body's, along its x and about its z axis, or seen from above, along the heading.
    /// steering : array_like, shape (..., steered wheels), optional
    ///     Angles to keep [rad], instead of those that roll.
    /// max_wheel_speed : float, optional
    ///     All speeds are scaled down together so that no wheel exceeds it [rad/s].
    /// out : tuple of ndarray, optional
    ///     Arrays for steering, wheel speeds, twist, joint rates and scale, in this order, of the shapes of the result;
    ///     what is left out, or None, is fresh. Nothing is written by a call that fails.
    #[doc = parameters!(threads, level)]
    #[doc = returns!("GroundCommand")]
    ///     `steering` [rad] and `wheel_speeds` [rad/s], into which it unpacks, with `twist`, `joint_rates` and `scale`.
    #[doc = raises!(
        InfeasibleMotionError: "If a wheel would steer past its limit, or, beside its steering axis, rolls at no angle.",
        ValueError: "If a number is not finite or a shape does not fit."
    )]
    ///
    /// Source: M. Tarokh, G. McDermott, Kinematics modeling and analyses of articulated rovers, IEEE T-RO 21(4), 2005.
    fn inverse[&self, py: Python<'py>](stand, command, *, view: &str = "body", steering=None, max_wheel_speed=None,
        out=None, threads: Option<i64> = None, level: Option<&str> = None) -> PyResult<GroundCommand> {
        let chain = &self.chain;
        let mut stands = Stands::read(chain, stand)?;
        let (wheels, joints, steered) = (chain.wheels().len(), chain.joints().len(), chain.steering().len());
        let rule = "have shape (..., 2), speed and yaw rate, or (..., 3), a twist";
        let mut commands = Rows::read_either("command", command, [2, 3], rule)?.finite()?;
        let mut kept = Rows::read_optional("steering", steering, steered)?;
        let leading = together([&mut stands, &mut commands, &mut kept])?;
        let count: usize = leading.iter().product();
        if let Some(kept) = &kept {
            stands.check_finite(kept)?;
        }
        let mut how = Command { view: self::view(view)?, offset: self.motion.offset, wheel_speed: f64::INFINITY };
        if let Some(limit) = max_wheel_speed {
            how.wheel_speed = number("max_wheel_speed", limit)?;
            if how.wheel_speed.is_nan() || how.wheel_speed <= 0.0 {
                return Err(refuse("max_wheel_speed", "be positive", how.wheel_speed));
            }
        }
        let workers = workers(threads, level)?;
        let out = Out::read(out, ["steering", "wheel_speeds", "twist", "joint_rates", "scale"])?;
        let single = leading.is_empty() && !out.is_given();
        let [a, b, c, d] = [steered, wheels, 6, joints].map(|width| joined(&leading, width));
        let mut results = out.results(py, [a, b, c, d, leading.clone()], None, true)?;
        let footings = stands.footings();
        let [angles, speeds, twists, rates, scales] = results.flat();
        let asked = Commands { steering: angles, speeds, twists: twists.as_chunks_mut().0, joint_rates: rates, scales };
        let are_twists = commands.width() == 3;
        let of_twists = if are_twists { how.of_twists(commands.triples()).or_raise(&leading)? } else { Vec::new() };
        let wanted = if are_twists { &of_twists } else { commands.pairs() };
        let kept = kept.as_ref().map(Rows::flat);
        compute_rows(py, count, &leading, || {
            inverse_rows(chain, &self.motion, &footings, &how, wanted, kept, asked, workers)
        })?;
        let [steering, speeds, twist, rates, scale] = results.finish_arrays()?;
        let scale = if single { scale.call_method0(py, "item")? } else { scale };
        Ok(GroundCommand(Columns::Batch([steering, speeds, twist, rates, scale])))
    }

    /// The motion that the wheels tell, on the ground a rover stands on.
    ///
    /// The suspension follows the ground: whatever the motion in plan, vertical speed, tilt and joint rates are those
    /// that keep the wheels on it. The motion in plan is the weighted least-squares solution of what every
    /// touching point says: no velocity along the rim beyond the wheel's turning, none sideways. What was
    /// measured is taken as it is, and adds its own equations.
    #[doc = section!(Parameters)]
    /// stand : SettledPose
    ///     Result of `settle`, at the steering angles of the moment, shape (...). Rows that did not settle give NaN.
    /// steering : array_like, shape (..., steered wheels) or None
    ///     Steering angles [rad], where they are not those of the stand; contacts are then moved on the planes the
    ///     wheels stand on.
    /// wheel_speeds : array_like, shape (..., wheels)
    ///     Speed of every wheel against the link that carries it [rad/s], NaN where there is none.
    /// joint_rates : array_like, shape (..., joints), optional
    ///     Measured rates of the free angles [rad/s], NaN where there is none.
    /// angular_velocity : array_like, shape (..., 3), optional
    ///     Of the body about its own axes, from an IMU [rad/s], NaN where there is none.
    #[doc = parameters!(steering_rates)]
    /// weights : array_like, shape (wheels,) or (wheels, 2), optional
    ///     Weight of every wheel, for instance its load, or of its rolling and its side slip apart; default 1.
    /// out : ndarray or tuple of ndarray, optional
    ///     Arrays for the twist, or twist, joint rates and residuals, in this order, of the shapes of the result; what
    ///     is left out, or None, is fresh. Nothing is written by a call that fails.
    #[doc = parameters!(threads, level)]
    #[doc = returns!("GroundMotion": "`twist` [m/s, rad/s], `joint_rates` [rad/s], `residuals` [m/s].")]
    #[doc = raises!("If a number is not finite, a weight negative or a shape does not fit.")]
    ///
    /// Source: N. Seegmiller, A. Kelly, Enhanced 3D kinematic modeling of wheeled mobile robots, RSS 2014.
    fn forward[&self, py: Python<'py>](stand, steering: native Option<&Bound<'py, PyAny>>, wheel_speeds, joint_rates=None,
        angular_velocity=None, *, steering_rates=None, weights=None, out=None, threads: Option<i64> = None,
        level: Option<&str> = None) -> PyResult<GroundMotion> {
        let chain = &self.chain;
        let mut stands = Stands::read(chain, stand)?;
        let (wheels, joints, steered) = (chain.wheels().len(), chain.joints().len(), chain.steering().len());
        let mut speeds = Rows::read("wheel_speeds", wheel_speeds, wheels)?;
        let mut steering = Rows::read_optional("steering", steering, steered)?;
        let mut measured = Rows::read_optional("joint_rates", joint_rates, joints)?;
        let mut turning = Rows::read_optional("angular_velocity", angular_velocity, 3)?;
        let mut steering_rates = Rows::read_optional("steering_rates", steering_rates, steered)?;
        let leading = together([
            &mut stands,
            &mut speeds,
            &mut steering,
            &mut measured,
            &mut turning,
            &mut steering_rates,
        ])?;
        for rows in [&steering, &steering_rates].into_iter().flatten() {
            stands.check_finite(rows)?;
        }
        for rows in [Some(&speeds), measured.as_ref(), turning.as_ref()].into_iter().flatten() {
            if let Some(rate) = rows.flat().iter().find(|rate| rate.abs() >= LARGEST) {
                let rule = if rate.is_infinite() { "be finite".into() } else { format!("be smaller than {LARGEST:e}") };
                let rule = format!("{rule}, or NaN where not measured");
                return Err(refuse(rows.argument(), rule, format!("{rate:?}")));
            }
        }
        let weights = weights.map(|weights| self.read_weights(weights)).transpose()?;
        let count = speeds.count();
        let workers = workers(threads, level)?;
        let shapes = [joined(&leading, 6), joined(&leading, joints), joined(&joined(&leading, wheels), 3)];
        let out = Out::read_or_first(out, ["twist", "joint_rates", "residuals"])?;
        let mut results = out.results(py, shapes, None, false)?;
        let footings = stands.footings();
        let readings = ReadingRows {
            steering: steering.as_ref().map(Rows::flat),
            speeds: speeds.flat(),
            steering_rates: steering_rates.as_ref().map(Rows::flat),
            joint_rates: measured.as_ref().map(Rows::flat),
            angular_velocity: turning.as_ref().map(Rows::flat),
            weights: weights.as_deref(),
        };
        let [twists, rates, residuals] = results.flat();
        let motions = BodyMotions { twists: twists.as_chunks_mut().0, joint_rates: rates, residuals };
        compute_rows(py, count, &leading, || {
            forward_rows(chain, &self.motion, &footings, &readings, motions, workers)
        })?;
        Ok(GroundMotion(Columns::Batch(results.finish_arrays()?)))
    }
}

impl Suspension {
    /// One weight per wheel, or one for its rolling and one for its side slip.
    fn read_weights(&self, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
        let wheels = self.chain.wheels().len();
        let rows = match Rows::read("weights", value, wheels) {
            Ok(rows) if rows.leading.is_empty() => rows,
            _ => {
                let rows = Rows::read("weights", value, 2)?;
                if rows.leading != [wheels] {
                    return Err(rows.refuse_shape(format!("({wheels},) or ({wheels}, 2)")));
                }
                rows
            }
        };
        let weights = rows.flat().to_vec();
        match weights.iter().find(|weight| !(weight.is_finite() && **weight >= 0.0)) {
            None => Ok(weights),
            Some(weight) => Err(refuse("weights", "be finite and not negative", weight)),
        }
    }
}
