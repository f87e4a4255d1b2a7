//! Logs of twists, and poses along them: `six_wheel.integrate` and `six_wheel.rollout`.

use pyo3::prelude::*;
use six_wheel_kinematics::batch;
use six_wheel_kinematics::table::{Durations, Table};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_planner::Present;

use crate::controller::limits::Limits;
use crate::convert::{
    AnyArray, Blocks, Broadcast, Output, Precision, Rows, compute, compute_rows, joined, joint, memory, number, raise,
    refuse, refuse_shape, shape_text,
};
use crate::rover::Rover;
use crate::workers::workers;

/// Logs of twists, with what goes with them.
pub struct Course<'py> {
    pub twists: Blocks<'py>,
    dt: Rows<'py>,
    starts: Option<Rows<'py>>,
    /// Steps of a log.
    pub count: usize,
}

impl<'py> Course<'py> {
    pub fn read(mut twists: Blocks<'py>, dt: &Bound<'py, PyAny>, start: Option<&Bound<'py, PyAny>>) -> PyResult<Self> {
        let Some((&count, logs)) = twists.leading().split_last() else {
            return Err(refuse(twists.argument(), "have shape (..., n, 3)", "shape (3,)"));
        };
        let mut starts = Rows::read_optional("start", start, 3)?;
        // One start for all logs is not repeated.
        if let Some(starts) = starts.as_mut().filter(|starts| !starts.is_single())
            && starts.leading != logs
        {
            let Some(common) = joint(logs, &starts.leading) else {
                let rule = format!("be one pose or have leading axes {}", shape_text(logs));
                return Err(refuse("start", &rule, format!("leading axes {}", shape_text(&starts.leading))));
            };
            starts.spread(&common)?;
            twists.spread(&joined(&common, count))?;
        }
        let mut dt = Rows::read_numbers("dt", dt)?;
        dt.fit(count)?;
        Ok(Self { twists, dt, starts, count })
    }

    /// Reads controls: at least one axis of rollouts before that of the steps.
    pub fn read_controls(
        controls: &Bound<'py, PyAny>,
        dt: &Bound<'py, PyAny>,
        start: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        let controls = Blocks::read("controls", controls, 3)?;
        if controls.leading().len() < 2 {
            return Err(refuse_shape("controls", "have shape (..., k, t, 3)", &controls.shape()));
        }
        Self::read(controls, dt, start)
    }

    /// Leading axes of the logs.
    pub fn logs(&self) -> &[usize] {
        let leading = self.twists.leading();
        &leading[..leading.len() - 1]
    }

    /// The output for the poses.
    fn poses(
        &self,
        py: Python<'py>,
        out: Option<&Bound<'py, PyAny>>,
        precision: Option<Precision>,
    ) -> PyResult<Output<'py>> {
        Output::of(py, "out", out, precision, &self.poses_shape())
    }

    /// Shape of the poses.
    pub fn poses_shape(&self) -> Vec<usize> {
        joined(&joined(self.logs(), self.count + 1), 3)
    }

    pub fn durations(&self) -> Durations<'_> {
        self.dt.steps().into()
    }

    /// One start for all logs, or one for each.
    pub fn starts(&self) -> &[[f64; 3]] {
        self.starts.as_ref().map_or(&[[0.0; 3]], Rows::triples)
    }

    /// The exception of a core error.
    pub fn raise(&self, mut error: Error) -> PyErr {
        if error.argument == "twists" || error.argument == "twist" {
            error.argument = self.twists.argument().to_owned().into();
        }
        let leading = if error.argument == "dt" { &[self.count][..] } else { self.twists.leading() };
        raise(error, leading)
    }
}

functions! {
    /// Poses along a log of twists, each held over its step.
    ///
    /// Exact for a twist that is constant over each step, whatever the length of the step. The sums carry
    /// their rounding errors along, and the yaw keeps its full turns.
    #[doc = section!(Parameters)]
    /// twists : array_like, shape (..., n, 3)
    ///     Rows ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s]. Leading axes are separate logs.
    /// dt : float or array_like, shape (n,)
    ///     Duration of the steps [s]; 0 where a recording has the same stamp twice: nothing moves.
    /// start : array_like, shape (3,) or (..., 3), default (0, 0, 0)
    ///     First pose ``[x, y, yaw]`` [m, m, rad], of all logs or of each.
    #[doc = parameters!(out "(..., n + 1, 3)", dtype, threads, level)]
    #[doc = returns!("ndarray, shape (..., n + 1, 3)")]
    ///     Rows ``[x, y, yaw]`` [m, m, rad], the first of which is `start`.
    #[doc = raises!("If a value is not finite or a duration is negative.")]
    ///
    /// Source: R. M. Murray, Z. Li, S. S. Sastry, A Mathematical Introduction to Robotic Manipulation, ch. 2.
    pub fn integrate[py: Python<'py>](twists, dt, start=None, *, out=None, dtype=None, threads: Option<i64> = None,
        level: Option<&str> = None, **)
    as "(twists, dt, start=(0.0, 0.0, 0.0), *, out=None, dtype=None, threads=None, level=None)"
    -> PyResult<AnyArray<'py>> {
        let twists = Blocks::read("twists", twists, 3)?;
        let course = Course::read(twists, dt, start)?;
        poses_along(py, &course, (out, dtype), (threads, level))
    }

    /// Poses of a sampling planner's rollouts: `integrate` for many short logs that start from one pose.
    #[doc = section!(Parameters: controls)]
    #[doc = parameters!(out "(..., k, t + 1, 3)", dtype)]
    /// rover : Rover, optional
    ///     Whose motions they are: controls are then wishes, as those of `Mppi`, and what the rover cannot do at once becomes
    ///     what it does instead. The steps take one time, `dt`.
    /// limits : Limits, optional
    ///     Limits of these motions.
    /// twist : array_like, shape (3,), optional
    ///     Twist of the rover at the start, in body axes [m/s, m/s, rad/s]; default at rest.
    /// steering : array_like, shape (steered wheels,), optional
    ///     Angles of its steering joints at the start [rad]; default straight ahead.
    /// delay : float, default 0.0
    ///     Delay before a control has an effect, in which the motion goes on [s].
    #[doc = parameters!(threads, level)]
    #[doc = returns!("ndarray, shape (..., k, t + 1, 3)")]
    ///     Rows ``[x, y, yaw]`` [m, m, rad], the first of every rollout its start.
    #[doc = raises!("If a value is not finite or a duration is negative.")]
    pub fn rollout[py: Python<'py>](controls, dt, start=None, *, out=None, dtype=None,
        rover: Option<Bound<'py, Rover>> = None, limits: Option<Limits> = None, twist=None, steering=None,
        delay: f64 = 0.0, threads: Option<i64> = None, level: Option<&str> = None, **)
    as "(controls, dt, start=(0.0, 0.0, 0.0), *, out=None, dtype=None, rover=None, limits=None, twist=None, steering=None, delay=0.0, threads=None, level=None)"
    -> PyResult<AnyArray<'py>> {
        let course = Course::read_controls(controls, dt, start)?;
        let Some(rover) = rover else {
            let given = [
                ("limits", limits.is_some()),
                ("twist", twist.is_some()),
                ("steering", steering.is_some()),
                ("delay", delay != 0.0),
            ];
            if let Some((name, _)) = given.iter().find(|(_, given)| *given) {
                return Err(refuse(name, "come with a rover", "none"));
            }
            return poses_along(py, &course, (out, dtype), (threads, level));
        };
        let dt = number("dt", dt)?;
        let twist = Rows::read_beside("twist", twist, 3, &[])?;
        let steering = Rows::read_beside("steering", steering, rover.get().joints(), &[])?;
        let mut buffer;
        let flat = match course.twists.table() {
            Table::Flat(values) => values,
            Table::Read(source) => {
                buffer = memory::filled(0.0, 3 * course.twists.count())?;
                source.read(0, &mut buffer);
                &buffer
            }
        };
        let mut poses = course.poses(py, out, Precision::read(py, dtype, out)?)?;
        let workers = workers(threads, level)?;
        let present = Present {
            twist: twist.as_ref().map_or([0.0; 3], |rows| rows.triples()[0]),
            steering: steering.as_ref().map(Rows::flat),
            delay,
        };
        let limits = limits.map_or_else(Default::default, |limits| limits.0);
        let (core, starts, count) = (&rover.get().core, course.starts(), course.count);
        let (controls, target) = (flat.as_chunks().0, poses.triples());
        compute_rows(py, controls.len(), &[], || {
            six_wheel_planner::rollout(core, limits, controls, count, dt, starts, present, target, workers)
        })?;
        poses.finish_any()
    }
}

/// Integrates and writes.
fn poses_along<'py>(
    py: Python<'py>,
    course: &Course<'py>,
    (out, dtype): (Option<&Bound<'py, PyAny>>, Option<&Bound<'py, PyAny>>),
    (threads, level): (Option<i64>, Option<&str>),
) -> PyResult<AnyArray<'py>> {
    let precision = Precision::read(py, dtype, out)?;
    let mut poses = course.poses(py, out, precision)?;
    let rows = course.twists.count();
    let workers = Workers { fresh: poses.is_unseen(), ..workers(threads, level)? };
    let (twists, steps, starts) = (course.twists.table(), course.durations(), course.starts());
    let (count, target) = (course.count, poses.triples());
    compute(py, rows, || batch::integrate(twists, count, steps, starts, target, workers))
        .map_err(|error| course.raise(error))?;
    poses.finish_any()
}
