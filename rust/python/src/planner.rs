//! `six_wheel.Mppi`, a sampling planner's whole cycle.

pub mod costmap;
mod inputs;
mod plan;
mod rollout;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyTuple, PyType};
use six_wheel_planner::{CycleInput, Mppi as Core, Options, Precision, State, Weights};

use crate::arguments::other_kind;
use crate::controller::limits::Limits;
use crate::convert::{Array, OrRaise, Out, Output, Results, Rows, compute_rows, number, one_row, refuse};
use crate::rover::Rover;
use crate::state_lock::{Shared, Turn};
use crate::workers::workers;
use costmap::Costmap;
use inputs::{Seen, check_frame, points, pose_or_place, precision, read_weights, size, whole};
pub use plan::MppiPlan;
use plan::triples;

/// Points of a footprint at most.
const FOOTPRINT: usize = 64;

/// A sampling planner's whole cycle, a model predictive path integral, in one call.
///
/// Every cycle samples wishes around the last plan, drives them within the rover's limits, and averages them by what
/// their ways cost. The motion executed at every step has one centre of rotation at which all steered wheels point:
/// nothing slides, and no joint turns faster than it may. To a motion that no continuous turn of the joints leads to (to
/// turn on the spot, say) the rover stops, turns its wheels and goes on. A few samples are no noise: the plan itself, to
/// stop, to turn on the spot either way, ahead and back.
///
/// The noise comes from a counter: all results depend on the arguments and the seed alone, bit for bit, not on threads
/// or kernels. Nothing is allocated for rollouts after the first cycle.
#[doc = section!(Parameters)]
/// rover : Rover
///     The rover; without steered wheels that have trail.
/// limits : Limits, optional
///     What its motion may not exceed. All but the jerks count here, which are a controller's matter; steering angles
///     may speed up by no more than `steering_acceleration` where they turn on the spot.
/// horizon : int, default 56
///     Steps of a rollout.
/// dt : float, default 0.05
///     Their duration, and the time from cycle to cycle [s].
/// samples : int, default 2000
///     Rollouts of a cycle.
/// seed : int, default 0
///     Of the noise, 0 to 2^64 - 1.
/// sampling_std : array_like, shape (3,), optional
///     Standard deviation of the wishes [m/s, m/s, rad/s]; default half of what the limits allow.
/// correlation : float, default 0.5
///     Time in which the noise of a rollout forgets itself, to 1/e [s].
/// temperature : float, default 1.0
///     Cost by which a rollout counts 1/e as much.
/// cost_weights : dict, optional
///     Weights of the costs, over the defaults: ``map`` 1 (cost of the map, per second), ``collision`` 1000 (a rollout
///     that comes to a lethal place), ``goal`` 1 and ``terminal`` 10 (distance to the goal, per second and at the
///     end), ``goal_yaw`` 10 (one less the cosine of the angle to the goal's yaw at the end, over 1 + distance / 1 m), ``path`` 5 (distance from it, per second), ``progress`` 10 (way made along it), ``heading`` 1 (square of the
///     sine between heading and path, per second), ``effort`` 0 (mean square
///     speed of the wheels' pivots, per second), ``scrub`` 1 (square of the speed at which fixed wheels slide, per
///     second).
/// smoothing : bool
///     True to smooth the new plan by a quadratic over five steps (Savitzky-Golay).
/// delay : float, default 0.0
///     Dead time of the rover [s]: what is wished that far ahead is on its way already, and stays.
/// dtype : {'float64', 'float32'}
///     Number type in which rollouts are computed.
/// footprint : array_like, shape (n, 2), optional
///     Points of the body where the map is read, of which the worst counts [m]; default its origin.
#[doc = raises!("If an option makes no sense.")]
///
/// Source: G. Williams et al., Information-theoretic model predictive control, IEEE T-RO 34(6), 2018; E. Trevisan & J.
/// Alonso-Mora, Biased-MPPI, IEEE RA-L 9(6), 2024.
#[pyclass(frozen, module = "six_wheel")]
pub struct Mppi {
    core: Shared<Core>,
    rover: Py<Rover>,
    limits: Limits,
    options: Options,
}

getters! { Mppi, self, py:
    /// The costs of the last cycle's rollouts, shape (samples,).
    costs: PyResult<Bound<'py, PyArray1<f64>>> = Ok(PyArray1::from_slice(py, self.core.lock(py)?.costs()));
    /// The rover.
    rover: Py<Rover> = self.rover.clone_ref(py);
    /// Limits of the rover's motion.
    limits: Limits = self.limits.clone();
    /// Steps of a rollout.
    horizon: usize = self.options.horizon;
    /// Duration of a step [s].
    dt: f64 = self.options.dt;
    /// Rollouts of a cycle.
    samples: usize = self.options.samples;
    /// Of the noise.
    seed: u64 = self.options.seed;
    /// Standard deviation of the wishes, shape (3,) [m/s, m/s, rad/s].
    sampling_std: PyResult<Bound<'py, PyArray1<f64>>> = Ok(PyArray1::from_slice(py, &self.core.lock(py)?.noise()));
    /// All it remembers: ``controls`` (horizon, 3), what is wished at every step [m/s, m/s, rad/s]; ``cycle``, cycles so
    /// far; ``steering``, where the joints are meant to be [rad]; ``progress``, how far along its path it is [m].
    state: PyResult<Bound<'py, PyDict>> = {
        let state = self.core.lock(py)?.state().clone();
        let (controls, steering) = (triples(py, &state.controls)?, PyArray1::from_vec(py, state.steering));
        Ok(dict!(py, controls, cycle = state.cycle, steering, progress = state.progress))
    };
    /// The wishes of the last cycle's rollouts, ``[vx, vy, omega]``, shape (samples, horizon, 3) [m/s, m/s, rad/s].
    wishes: PyResult<Array<'py>> = {
        let steps = self.options.horizon;
        let mut output = Output::fresh(py, &[self.options.samples, steps, 3])?;
        let mut core = self.core.lock(py)?;
        let mut wishes = Vec::new();
        for (k, rows) in output.triples().chunks_exact_mut(steps).enumerate() {
            core.controls(k, &mut wishes);
            rows.copy_from_slice(&wishes);
        }
        output.finish()
    };
    /// Weights of the cost terms, by name.
    cost_weights: PyResult<Bound<'py, PyDict>> =
        Weights::NAMES.into_iter().zip(self.options.weights.values()).into_py_dict(py);
}

impl Mppi {
    /// Arguments of the constructor behind the rover.
    fn keywords<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Options { horizon, dt, samples, seed, noise, correlation, temperature, smoothing, delay, .. } =
            self.options;
        let dtype = if self.options.precision == Precision::Single { "float32" } else { "float64" };
        Ok(dict!(
            py,
            limits = self.limits.clone(),
            horizon,
            dt,
            samples,
            seed,
            sampling_std = noise,
            correlation,
            temperature,
            cost_weights = self.cost_weights(py)?,
            smoothing,
            delay,
            dtype,
            footprint = self.options.footprint.clone()
        ))
    }
}

methods! { Mppi:
    #[new]
    fn new[](rover: Bound<'py, Rover>, limits: Option<Limits> = None, *, horizon=None, dt: Option<f64> = None,
        samples=None, seed=None, sampling_std=None, correlation: f64 = 0.5, temperature: f64 = 1.0,
        cost_weights: Option<&Bound<'py, PyDict>> = None, smoothing: bool = true, delay: f64 = 0.0, dtype=None,
        footprint=None, **)
    as "(rover, limits=None, *, horizon=56, dt=0.05, samples=2000, seed=0, sampling_std=None, correlation=0.5, temperature=1.0, cost_weights=None, smoothing=True, delay=0.0, dtype='float64', footprint=None)"
    -> PyResult<Self> {
        let usual = Options::default();
        let count = |argument: &str, value: Option<&Bound<'_, PyAny>>, usual: u64| {
            value.map_or(Ok(usual), |value| whole(argument, value))
        };
        let sampling_std = Rows::read_beside("sampling_std", sampling_std, 3, &[])?.map(Rows::finite).transpose()?;
        let footprint = match footprint {
            Some(points) => Rows::read("footprint", points, 2)?.table()?.flat().as_chunks().0.to_vec(),
            None => usual.footprint.clone(),
        };
        if footprint.len() > FOOTPRINT {
            return Err(refuse("footprint", format!("hold {FOOTPRINT} points at most"), footprint.len()));
        }
        let options = Options {
            horizon: size(count("horizon", horizon, usual.horizon as u64)?),
            dt: dt.unwrap_or(usual.dt),
            samples: size(count("samples", samples, usual.samples as u64)?),
            seed: count("seed", seed, usual.seed)?,
            noise: sampling_std.map(|rows| rows.triples()[0]),
            correlation,
            temperature,
            weights: cost_weights.map_or(Ok(Weights::default()), read_weights)?,
            smoothing,
            delay,
            precision: dtype.map_or(Ok(Precision::Double), precision)?,
            footprint,
        };
        let limits = limits.unwrap_or(Limits(Default::default()));
        let core = Core::new(&rover.get().core, limits.0, options.clone()).or_raise(&[])?;
        Ok(Self { core: Shared::new(core), rover: rover.unbind(), limits, options })
    }

    /// One cycle: the plan from here on.
    #[doc = section!(Parameters)]
    /// state : array_like, shape (3,), or an object with ``pose``
    ///     Its pose, ``[x, y, yaw]`` [m, m, rad], such as an `OdometryState`, whose ``twist``, ``steering`` and
    ///     ``frame`` count as well, if it has them.
    /// twist : array_like, shape (3,), optional
    ///     Its motion ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s]; default that of `state`, or at rest.
    /// steering : array_like, shape (steered wheels,), optional
    ///     Angles of its steering joints [rad]; default those of `state`, or where the last plan brought them.
    /// path : array_like, shape (n, 2) or (n, 3), optional
    ///     Corners of a path to follow [m].
    /// costmap : Costmap, optional
    ///     Cost of every place. The rover has to be on it.
    /// goal : array_like, shape (2,) or (3,), optional
    ///     Place to go to, ``[x, y]`` [m], or pose to have there, ``[x, y, yaw]`` [m, m, rad], of which the yaw counts the
    ///     more the nearer the rover is (weight ``goal_yaw``); default the end of the path. One of `path`, `goal` and `extra_cost` has to be given.
    /// extra_cost : callable, optional
    ///     Called once, with the poses (samples, horizon + 1, 3) and the motions (samples, horizon, 3) of all rollouts;
    ///     returns a cost for each, shape (samples,), which may be infinite.
    /// frame : str, optional
    ///     Name of the frame `state`, `path` and `goal` are in; default that of `state`. A costmap of another one is
    ///     refused.
    /// out : tuple of ndarray, optional
    ///     Arrays for the plan's `steering`, shape (horizon, steered wheels), and `wheel_speeds`, shape (horizon, wheels).
    #[doc = parameters!(threads, level)]
    #[doc = returns!("MppiPlan": "The motion to command now, and the plan it begins.")]
    #[doc = raises!(ValueError)]
    ///     If a value is not finite, a shape does not fit, there is nowhere to go, the rover is not on the map, or no
    ///     rollout is left possible. The planner stays as it was, and nothing is written.
    fn step[&self, py: Python<'py>](state, *more, twist=None, steering=None, path=None,
        costmap: Option<Bound<'py, Costmap>> = None, goal=None, extra_cost=None, frame: Option<&str> = None, out=None,
        threads: Option<i64> = None, level: Option<&str> = None)
    as "($self, state, *, twist=None, steering=None, path=None, costmap=None, goal=None, extra_cost=None, frame=None, out=None, threads=None, level=None)"
    -> PyResult<MppiPlan> {
        if !more.is_empty() {
            return Err(one_row("Mppi.step((x, y, yaw))", "state", 1 + more.len()));
        }
        if let Some(function) = extra_cost.filter(|function| !function.is_callable()) {
            return Err(other_kind("extra_cost", "a function", function, ""));
        }
        let seen = Seen::of(state)?;
        let pose = Rows::read("state.pose", &seen.pose, 3)?.over(&[])?;
        let twist = Rows::read_beside("state.twist", twist.or(seen.twist.as_ref()), 3, &[])?;
        let joints = self.rover.get().joints();
        let steering = Rows::read_beside("state.steering", steering.or(seen.steering.as_ref()), joints, &[])?;
        let path = path.map(|path| points("path", path)).transpose()?;
        let (goal, goal_yaw) = goal.map_or(Ok((None, None)), |goal| pose_or_place("goal", goal))?;
        let map = costmap.as_ref().map(|map| &map.get().core);
        check_frame(costmap.as_ref(), frame.or(seen.frame.as_deref()))?;
        let mut outputs = self.outputs(py, out)?;
        let workers = workers(threads, level)?;
        let situation = CycleInput {
            pose: pose.triples()[0],
            twist: twist.as_ref().map_or([0.0; 3], |rows| rows.triples()[0]),
            steering: steering.as_ref().map(Rows::flat),
            costmap: map,
            path: path.as_deref(),
            goal,
            goal_yaw,
            record: extra_cost.is_some(),
        };
        let rollouts = self.options.samples * self.options.horizon;
        let mut core = self.core.lock(py)?;
        let planner = &mut *core;
        compute_rows(py, rollouts, &[], || planner.start_cycle(situation, workers))?;
        let mut extra = None;
        if let Some(function) = extra_cost {
            let (costs, locked) = self.extra_costs(py, core, function)?;
            (extra, core) = (Some(costs), locked);
        }
        let (costs, planner) = (extra.as_ref().map(Rows::flat), &mut *core);
        let finish = || planner.finish_cycle(costs, workers).cloned();
        let outcome = compute_rows(py, rollouts, &[self.options.samples], finish)?;
        let [steering, speeds] = outputs.flat();
        steering.copy_from_slice(&outcome.steering);
        speeds.copy_from_slice(&outcome.speeds);
        let blocked = map.is_some_and(|map| core.is_blocked(map));
        MppiPlan::of(py, &outcome, blocked, core.state(), outputs.finish_arrays()?)
    }
}

#[pymethods]
impl Mppi {
    /// Back to where it was when it was made.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.core.lock(py)?.reset();
        Ok(())
    }

    /// Go on from what `state` was.
    #[doc = section!(Parameters)]
    /// state : dict
    ///     As `state` gives it.
    #[doc = raises!("If it is not of a planner like this one.")]
    fn restore(&self, py: Python<'_>, state: &Bound<'_, PyDict>) -> PyResult<()> {
        let item = |name: &str| {
            let found = state.get_item(name)?;
            found.ok_or_else(|| refuse("state", format!("have {name:?}"), "none"))
        };
        let controls = Rows::read("controls", &item("controls")?, 3)?.table()?;
        let steering = Rows::read("steering", &item("steering")?, self.rover.get().joints())?.over(&[])?;
        let cycle = whole("cycle", &item("cycle")?)?;
        let state = State {
            controls: controls.triples().to_vec(),
            cycle: u32::try_from(cycle).map_err(|_| refuse("cycle", "be 0 to 2^32 - 1", cycle))?,
            steering: steering.flat().to_vec(),
            progress: number("progress", &item("progress")?)?,
        };
        self.core.lock(py)?.set_state(state).or_raise(&[])
    }

    /// The planner of these arguments and this state, as `__reduce__` lists them.
    #[classmethod]
    fn _restore<'py>(
        class: &Bound<'py, PyType>,
        rover: Py<Rover>,
        keywords: &Bound<'py, PyDict>,
        state: &Bound<'py, PyDict>,
    ) -> PyResult<Bound<'py, Self>> {
        let made = class.call((rover,), Some(keywords))?.cast_into::<Self>()?;
        made.get().restore(class.py(), state)?;
        Ok(made)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, this) = (slf.py(), slf.get());
        let fields = (&this.rover, this.keywords(py)?, this.state(py)?).into_pyobject(py)?;
        crate::classes::restored_by(slf.as_any(), &fields.iter().collect::<Vec<_>>())
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let rover = self.rover.bind(py).repr()?;
        let Options { horizon, dt, samples, seed, precision, .. } = &self.options;
        let dtype = if *precision == Precision::Single { ", dtype='float32'" } else { "" };
        let limits = self.limits.text();
        let all =
            format!("Mppi(horizon={horizon}, dt={dt:?}, samples={samples}, seed={seed}{dtype}, {limits}, {rover})");
        Ok(crate::classes::cut(all))
    }
}

impl Mppi {
    /// Costs of the rollouts by a function of Python, which may look at the planner: the lock is released meanwhile.
    fn extra_costs<'a, 'py>(
        &'a self,
        py: Python<'py>,
        mut core: Turn<'a, Core>,
        function: &Bound<'py, PyAny>,
    ) -> PyResult<(Rows<'py>, Turn<'a, Core>)>
    where
        'py: 'a,
    {
        let cycles = core.cycles_started();
        let [poses, twists] = self.recorded(py, &mut core)?;
        drop(core);
        let costs = Rows::read("extra_cost", &function.call1((poses, twists))?, self.options.samples)?;
        let core = self.core.lock(py)?;
        if core.cycles_started() != cycles {
            return Err(refuse("extra_cost", "not step the planner it judges for", "another cycle"));
        }
        Ok((costs.over(&[])?, core))
    }

    /// The outputs for steering angles and wheel speeds.
    fn outputs<'py>(&self, py: Python<'py>, out: Option<&Bound<'py, PyAny>>) -> PyResult<Results<'py, 2>> {
        let rover = self.rover.get();
        let (labels, rule) =
            (["out.steering", "out.wheel_speeds"], "be a tuple of two arrays, steering and wheel_speeds");
        Out::read_all(out, labels, rule)?.results(py, [vec![rover.joints()], vec![rover.count()]], None, false)
    }

    /// Poses and motions of all rollouts.
    fn recorded<'py>(&self, py: Python<'py>, core: &mut Core) -> PyResult<[Array<'py>; 2]> {
        let Options { horizon, samples, .. } = self.options;
        let mut poses = Output::fresh(py, &[samples, horizon + 1, 3])?;
        let mut twists = Output::fresh(py, &[samples, horizon, 3])?;
        let (mut way, mut motions) = (Vec::new(), Vec::new());
        let rows = poses.triples().chunks_exact_mut(horizon + 1);
        for (k, (poses, twists)) in rows.zip(twists.triples().chunks_exact_mut(horizon)).enumerate() {
            core.recorded(k, &mut way, &mut motions);
            poses.copy_from_slice(&way);
            twists.copy_from_slice(&motions);
        }
        Ok([poses.finish()?, twists.finish()?])
    }
}
