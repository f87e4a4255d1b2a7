//! `six_wheel.Rover`: layouts, inverse and forward kinematics, the admissible set.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::str::FromStr;

use numpy::PyArrayMethods;
use numpy::ndarray::IxDyn;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyMapping, PyString, PyTuple};
use six_wheel_core::batch::{self, Log, SteeringInputs};
use six_wheel_core::{Fit as CoreFit, Keep, Method, Rover as Core, SteeringRange, Twist, presets};

use crate::convert::{Array, Output, Rows, compute, number, raise, refuse};
use crate::fit::Fit;
use crate::wheel::{Wheel, hash_wheel, reduce, steering_limit, steering_range};

/// A wheeled vehicle: wheels, and everything that follows from where they are.
///
/// Immutable, hashable, comparable, picklable, and safe on any number of threads: nothing is remembered
/// between calls. Twists are ``[vx, vy, omega]`` in body axes (x forward, y left) [m/s, m/s, rad/s].
///
/// Parameters
/// ----------
/// wheels : sequence of Wheel
///     1 to 64 wheels with different names; arrays of wheel speeds follow their order, arrays of steering
///     angles that of the steered ones.
/// traction_joints, steering_joints : mapping of str to str, optional
///     Joint name to wheel name, one joint for every wheel and for every steered wheel, in the order
///     in which `commands` gives them. Default ``<wheel>_wheel_joint`` and ``<wheel>_steering_joint``.
///
/// Raises
/// ------
/// ValueError
///     If there is no wheel or too many, two share a name, or the joints do not match the wheels.
///
/// Source: R. Siegwart, I. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed., ch. 3.
#[pyclass(frozen, module = "six_wheel")]
pub struct Rover {
    core: Core,
    wheels: Py<PyTuple>,
    traction: Joints,
    steering: Joints,
}

/// Joint names, each with the index of its wheel, in the order of the commands.
type Joints = Vec<(String, usize)>;

const TRACTION: &str = "wheel_joint";
const STEERING: &str = "steering_joint";

/// The joints of these wheels under their default names.
fn default_joints(core: &Core, wheels: &[usize], suffix: &str) -> Joints {
    wheels
        .iter()
        .map(|&i| (format!("{}_{suffix}", core.wheels()[i].name), i))
        .collect()
}

/// Reads a mapping of joint names to wheel names, which must name each of these wheels once.
fn read_joints(
    core: &Core,
    wheels: &[usize],
    argument: &str,
    given: Option<&Bound<'_, PyMapping>>,
    suffix: &str,
) -> PyResult<Joints> {
    let Some(given) = given else {
        return Ok(default_joints(core, wheels, suffix));
    };
    let mut joints = Joints::new();
    for item in given.items()?.iter() {
        let (joint, wheel) = item.extract::<(String, String)>()?;
        let found = wheels
            .iter()
            .copied()
            .find(|&i| core.wheels()[i].name == wheel);
        let Some(index) = found else {
            let names: Vec<_> = wheels
                .iter()
                .map(|&i| core.wheels()[i].name.as_str())
                .collect();
            let rule = format!("map joints to the wheels {}", names.join(", "));
            return Err(refuse(argument, &rule, &format!("{wheel:?} for {joint:?}")));
        };
        if joints.iter().any(|(_, other)| *other == index) {
            return Err(refuse(
                argument,
                "name every wheel once",
                &format!("{wheel:?} twice"),
            ));
        }
        joints.push((joint, index));
    }
    if let Some(&missing) = wheels
        .iter()
        .find(|i| joints.iter().all(|(_, other)| other != *i))
    {
        let got = format!("no joint for {:?}", core.wheels()[missing].name);
        return Err(refuse(argument, "name every wheel once", &got));
    }
    Ok(joints)
}

impl Rover {
    /// A rover of the core with its joints.
    pub fn build(
        py: Python<'_>,
        core: Core,
        traction: Option<&Bound<'_, PyMapping>>,
        steering: Option<&Bound<'_, PyMapping>>,
    ) -> PyResult<Self> {
        let all: Vec<usize> = (0..core.wheels().len()).collect();
        let traction = read_joints(&core, &all, "traction_joints", traction, TRACTION)?;
        let steering = read_joints(&core, core.steered(), "steering_joints", steering, STEERING)?;
        let wheels: Vec<Wheel> = core.wheels().iter().cloned().map(Wheel).collect();
        let wheels = PyTuple::new(py, wheels)?.unbind();
        Ok(Self {
            core,
            wheels,
            traction,
            steering,
        })
    }

    fn joint_dict<'py>(&self, py: Python<'py>, joints: &Joints) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (joint, wheel) in joints {
            dict.set_item(joint, &self.core.wheels()[*wheel].name)?;
        }
        Ok(dict)
    }

    /// The joint arguments that are not the default ones.
    fn joint_keywords<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all: Vec<usize> = (0..self.core.wheels().len()).collect();
        let keywords = PyDict::new(py);
        if self.traction != default_joints(&self.core, &all, TRACTION) {
            keywords.set_item("traction_joints", self.joint_dict(py, &self.traction)?)?;
        }
        if self.steering != default_joints(&self.core, self.core.steered(), STEERING) {
            keywords.set_item("steering_joints", self.joint_dict(py, &self.steering)?)?;
        }
        Ok(keywords)
    }

    /// Shape of a result with these leading axes.
    fn shape(leading: &[usize], width: usize) -> Vec<usize> {
        leading.iter().copied().chain([width]).collect()
    }

    fn joints(&self) -> usize {
        self.core.steered().len()
    }

    fn count(&self) -> usize {
        self.core.wheels().len()
    }

    /// Reads steering angles, speeds and steering rates of equal leading axes.
    fn read_log<'py>(
        &self,
        steering: &Bound<'py, PyAny>,
        speeds: &Bound<'py, PyAny>,
        steering_rates: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Readings<'py>> {
        let speeds = Rows::read("speeds", speeds, self.count())?;
        let given = (!steering.is_none()).then_some(steering);
        let steering = Rows::read_beside("steering", given, self.joints(), &speeds.leading)?;
        if steering.is_none() && self.joints() > 0 {
            return Err(refuse(
                "steering",
                "hold the angles of the steered wheels",
                "None",
            ));
        }
        let rates = Rows::read_beside(
            "steering_rates",
            steering_rates,
            self.joints(),
            &speeds.leading,
        )?;
        Ok(Readings {
            steering,
            speeds,
            rates,
        })
    }

    fn wheel_name<'py>(&self, py: Python<'py>, residual: &[f64]) -> Bound<'py, PyAny> {
        let worst = residual
            .iter()
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(b.1));
        let name = worst.map_or("", |(i, _)| self.core.wheels()[i].name.as_str());
        PyString::new(py, name).into_any()
    }
}

/// What a log holds, as read from Python.
struct Readings<'py> {
    steering: Option<Rows<'py>>,
    speeds: Rows<'py>,
    rates: Option<Rows<'py>>,
}

impl Readings<'_> {
    fn log(&self) -> Log<'_> {
        Log {
            steering: self.steering.as_ref().map_or(&[], Rows::flat),
            speeds: self.speeds.flat(),
            steering_rates: self.rates.as_ref().map(Rows::flat),
        }
    }
}

#[pymethods]
impl Rover {
    #[new]
    #[pyo3(signature = (wheels, *, traction_joints=None, steering_joints=None))]
    fn new(
        py: Python<'_>,
        wheels: Vec<Wheel>,
        traction_joints: Option<&Bound<'_, PyMapping>>,
        steering_joints: Option<&Bound<'_, PyMapping>>,
    ) -> PyResult<Self> {
        let core = Core::new(wheels.into_iter().map(|wheel| wheel.0).collect());
        let core = core.map_err(|error| raise(error, &[]))?;
        Self::build(py, core, traction_joints, steering_joints)
    }

    /// The six-wheel rover with four steered corners and unsteered middle wheels.
    ///
    /// Wheels: front_left, front_right, middle_left, middle_right, rear_left, rear_right; origin between the
    /// middle wheels.
    ///
    /// Parameters
    /// ----------
    /// d1 : float
    ///     Half track of the corner wheels [m].
    /// d2, d3 : float
    ///     Middle axle to rear axle, and to front axle [m].
    /// d4 : float
    ///     Half track of the middle wheels [m]; may be 0.
    /// wheel_radius : float
    ///     Hub to ground [m].
    /// steering_limit : float or (float, float), optional
    ///     Largest steering angle to either side, or smallest and largest [rad]; default a quarter turn.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a dimension or the limit is not finite and positive.
    ///
    /// Source: the corner-steering geometry of NASA's Mars rovers as used by the JPL Open Source Rover.
    #[staticmethod]
    #[pyo3(signature = (d1, d2, d3, d4, wheel_radius, steering_limit=None))]
    fn six_wheel(
        py: Python<'_>,
        d1: &Bound<'_, PyAny>,
        d2: &Bound<'_, PyAny>,
        d3: &Bound<'_, PyAny>,
        d4: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        steering_limit: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let dimensions = [
            number("d1", d1)?,
            number("d2", d2)?,
            number("d3", d3)?,
            number("d4", d4)?,
        ];
        let radius = number("wheel_radius", wheel_radius)?;
        let range = steering_range(steering_limit)?.unwrap_or_default();
        let core = Core::six_wheel(dimensions, radius, range);
        Self::build(py, core.map_err(|error| raise(error, &[]))?, None, None)
    }

    /// A published rover by name; `Rover.presets` lists them.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     One of `Rover.presets()`.
    /// steering_limit : float or (float, float), optional
    ///     In place of the published limit [rad]; where none is published, a quarter turn to either side.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If there is no such preset.
    #[staticmethod]
    #[pyo3(signature = (name, *, steering_limit=None))]
    fn preset(
        py: Python<'_>,
        name: &str,
        steering_limit: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let core = presets::preset(name, steering_range(steering_limit)?);
        Self::build(py, core.map_err(|error| raise(error, &[]))?, None, None)
    }

    /// Names of the published rovers, each with the source of its dimensions.
    ///
    /// Returns
    /// -------
    /// dict of str to str
    ///     Name to source; iterates over the names.
    #[staticmethod]
    fn presets(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let sources = PyDict::new(py);
        for preset in presets::PRESETS {
            sources.set_item(preset.name, preset.source)?;
        }
        Ok(sources)
    }

    /// What every wheel has to do for the body to move with a twist: angles and speeds.
    ///
    /// Exact at every turning radius: straight, on the spot, with the centre of rotation between the wheels
    /// or under one of them. Of the equivalent angles of a wheel, half a turn apart, the one nearest to
    /// `previous` is taken; a wheel whose pivot rests holds `previous`.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, shape (..., 3)
    ///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s]. Three floats in a tuple or list are fastest.
    /// previous : array_like, shape (..., steered wheels), optional
    ///     Present steering angles [rad], default 0. One outside the range counts as its nearest end.
    /// steering_rates : array_like, shape (..., steered wheels), optional
    ///     Rates of the steering angles [rad/s], default 0; they matter to wheels with scrub or trail.
    /// out : (ndarray, ndarray), optional
    ///     Where to write the results; `previous` may be the first of them.
    ///
    /// Returns
    /// -------
    /// steering : ndarray, shape (..., steered wheels)
    ///     Steering angles [rad].
    /// speeds : ndarray, shape (..., wheels)
    ///     Wheel speeds [rad/s].
    ///
    /// Raises
    /// ------
    /// InfeasibleMotionError
    ///     If a wheel would slide sideways or steer past its range; the first bad row is named and nothing
    ///     is written. `project` finds a twist the rover can make.
    /// ValueError
    ///     If a value is not finite or a shape does not fit.
    ///
    /// Source: R. Siegwart, I. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed., ch. 3.
    #[pyo3(signature = (twist, *, previous=None, steering_rates=None, out=None))]
    pub fn inverse<'py>(
        &self,
        py: Python<'py>,
        twist: &Bound<'py, PyAny>,
        previous: Option<&Bound<'py, PyAny>>,
        steering_rates: Option<&Bound<'py, PyAny>>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Array<'py>, Array<'py>)> {
        let twists = Rows::read("twist", twist, 3)?;
        let leading = twists.leading.as_slice();
        let mut previous = Rows::read_beside("previous", previous, self.joints(), leading)?;
        let rates = Rows::read_beside("steering_rates", steering_rates, self.joints(), leading)?;
        let [out_steering, out_speeds] = pair(out)?;
        if let (Some(previous), Some(out)) = (&mut previous, &out_steering) {
            previous.release_if(out);
        }
        let inputs = [Some(&twists), previous.as_ref(), rates.as_ref()];
        let output = |argument, out: &Option<Bound<'py, PyAny>>, width| {
            Output::new(
                py,
                argument,
                out.as_ref(),
                &Self::shape(leading, width),
                &inputs,
            )
        };
        let mut steering = output("out[0]", &out_steering, self.joints())?;
        if let (Some(first), Some(second)) = (&out_steering, &out_speeds) {
            crate::convert::disjoint("out[0]", first, second, "out[1]")?;
        }
        let mut speeds = output("out[1]", &out_speeds, self.count())?;
        let rows = twists.triples();
        let inputs = SteeringInputs {
            previous: previous.as_ref().map(Rows::flat),
            steering_rates: rates.as_ref().map(Rows::flat),
        };
        let (angles, rotations) = (steering.flat(), speeds.flat());
        compute(py, rows.len(), || {
            batch::inverse(&self.core, rows, inputs, angles, rotations)
        })
        .map_err(|error| raise(error, leading))?;
        Ok((steering.finish()?, speeds.finish()?))
    }

    /// The twist that angles and speeds of all wheels report, by least squares.
    ///
    /// Parameters
    /// ----------
    /// steering : array_like, shape (..., steered wheels)
    ///     Steering angles [rad]; None for a rover that does not steer.
    /// speeds : array_like, shape (..., wheels)
    ///     Wheel speeds [rad/s].
    /// steering_rates : array_like, shape (..., steered wheels), optional
    ///     Rates of the steering angles [rad/s], default 0; they matter to wheels with scrub or trail.
    /// out : ndarray, shape (..., 3), optional
    ///     Where to write the result.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (..., 3)
    ///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
    ///
    /// Raises
    /// ------
    /// UnderdeterminedError
    ///     If the wheels do not determine the twist.
    /// ValueError
    ///     If a value is not finite or a shape does not fit.
    #[pyo3(signature = (steering, speeds, *, steering_rates=None, out=None))]
    fn forward<'py>(
        &self,
        py: Python<'py>,
        steering: &Bound<'py, PyAny>,
        speeds: &Bound<'py, PyAny>,
        steering_rates: Option<&Bound<'py, PyAny>>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Array<'py>> {
        let readings = self.read_log(steering, speeds, steering_rates)?;
        let leading = readings.speeds.leading.as_slice();
        let inputs = [
            Some(&readings.speeds),
            readings.steering.as_ref(),
            readings.rates.as_ref(),
        ];
        let mut twists = Output::new(py, "out", out, &Self::shape(leading, 3), &inputs)?;
        let (log, target) = (readings.log(), twists.triples());
        compute(py, target.len(), || batch::forward(&self.core, log, target))
            .map_err(|error| raise(error, leading))?;
        twists.finish()
    }

    /// The twist with residual and weight of every wheel: the slip, and the cheapest fault detector.
    ///
    /// Parameters
    /// ----------
    /// steering : array_like, shape (..., steered wheels)
    ///     Steering angles [rad]; None for a rover that does not steer.
    /// speeds : array_like, shape (..., wheels)
    ///     Wheel speeds [rad/s].
    /// method : {'least_squares', 'middle_wheels', 'robust'}
    ///     All wheels alike; the unsteered wheels alone; or re-weighted so that a wheel that disagrees with
    ///     the others loses its say (Geman-McClure weights, graduated).
    /// steering_rates : array_like, shape (..., steered wheels), optional
    ///     Rates of the steering angles [rad/s], default 0; they matter to wheels with scrub or trail.
    ///
    /// Returns
    /// -------
    /// Fit
    ///     `twist`, `residual` [m/s], `rank`, `sigma_min`, `weights`, `worst_wheel`.
    ///
    /// Raises
    /// ------
    /// UnderdeterminedError
    ///     If the wheels that count do not determine the twist.
    /// ValueError
    ///     If a value is not finite, a shape does not fit or the method is unknown.
    #[pyo3(signature = (steering, speeds, *, method="least_squares", steering_rates=None))]
    fn fit<'py>(
        &self,
        py: Python<'py>,
        steering: &Bound<'py, PyAny>,
        speeds: &Bound<'py, PyAny>,
        method: &str,
        steering_rates: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Fit> {
        let method = Method::from_str(method).map_err(|error| raise(error, &[]))?;
        let readings = self.read_log(steering, speeds, steering_rates)?;
        let leading = readings.speeds.leading.as_slice();
        let output = |width| Output::new(py, "out", None, &Self::shape(leading, width), &[]);
        let (mut twist, mut residual) = (output(3)?, output(self.count())?);
        let mut weights = output(self.count())?;
        let none = CoreFit {
            twist: Twist::ZERO,
            rank: 0,
            sigma_min: 0.0,
        };
        let mut fits = vec![none; readings.speeds.count()];
        let (log, slips, says) = (readings.log(), residual.flat(), weights.flat());
        compute(py, fits.len(), || {
            batch::fit(&self.core, log, method, &mut fits, slips, says)
        })
        .map_err(|error| raise(error, leading))?;
        for (fit, target) in fits.iter().zip(twist.triples()) {
            *target = fit.twist.into();
        }
        let worst: Vec<_> = slips
            .chunks(self.count())
            .map(|residual| self.wheel_name(py, residual))
            .collect();
        let ranks = fits.iter().map(|fit| fit.rank as i64);
        let sigmas = fits.iter().map(|fit| fit.sigma_min);
        Ok(Fit {
            rank: scalar_or_array(py, ranks.collect(), leading)?,
            sigma_min: scalar_or_array(py, sigmas.collect(), leading)?,
            worst_wheel: nested(py, worst, leading)?.unbind(),
            twist: twist.finish()?.into_any().unbind(),
            residual: residual.finish()?.into_any().unbind(),
            weights: weights.finish()?.into_any().unbind(),
        })
    }

    /// Whether the rover can make a twist: no side slip, every wheel inside its steering range.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, shape (..., 3)
    ///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
    ///
    /// Returns
    /// -------
    /// bool or ndarray of bool, shape (...)
    ///     Side slip up to 1e-9 of the fastest wheel's speed counts as rounding.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a value is not finite.
    fn admissible<'py>(&self, py: Python<'py>, twist: &Bound<'py, PyAny>) -> PyResult<Py<PyAny>> {
        let twists = Rows::read("twist", twist, 3)?;
        let rows = twists.triples();
        let answers = compute(py, rows.len(), || batch::admissible(&self.core, rows))
            .map_err(|error| raise(error, &twists.leading))?;
        scalar_or_array(py, answers, &twists.leading)
    }

    /// The nearest twist the rover can make; one it can make already is returned unchanged.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, shape (..., 3)
    ///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
    /// keep : {'curvature', 'speed', 'yaw_rate', 'nearest'}
    ///     What is preserved. ``'curvature'``: `vx` and `omega`, and with them the turning radius; if that turn
    ///     is too tight, the nearest possible twist, scaled so that neither grows (a spin the rover cannot
    ///     make becomes rest). ``'speed'``: `vx`. ``'yaw_rate'``: `omega`. ``'nearest'``: as much as possible,
    ///     by the root mean square change of the wheel pivots' velocities.
    /// out : ndarray, shape (..., 3), optional
    ///     Where to write the result.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (..., 3)
    ///     An admissible twist.
    ///
    /// Raises
    /// ------
    /// InfeasibleMotionError
    ///     If no admissible twist keeps what was asked for.
    /// ValueError
    ///     If a value is not finite.
    #[pyo3(signature = (twist, keep="curvature", *, out=None))]
    fn project<'py>(
        &self,
        py: Python<'py>,
        twist: &Bound<'py, PyAny>,
        keep: &str,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Array<'py>> {
        let keep = Keep::from_str(keep).map_err(|error| raise(error, &[]))?;
        let twists = Rows::read("twist", twist, 3)?;
        let mut projected = Output::new(py, "out", out, &twists.shape(), &[Some(&twists)])?;
        let (rows, target) = (twists.triples(), projected.triples());
        compute(py, rows.len(), || {
            batch::project(&self.core, rows, keep, target)
        })
        .map_err(|error| raise(error, &twists.leading))?;
        projected.finish()
    }

    /// Instantaneous centre of rotation of a twist: the point of the body that stands still.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, shape (..., 3)
    ///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
    ///
    /// Returns
    /// -------
    /// ndarray, shape (..., 2)
    ///     ``[x, y]`` in body axes [m]. Straight ahead it is at infinity, ``[0, inf]`` forwards and
    ///     ``[0, -inf]`` backwards; at rest there is none, ``[nan, nan]``.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a value is not finite.
    fn icr<'py>(&self, py: Python<'py>, twist: &Bound<'py, PyAny>) -> PyResult<Array<'py>> {
        let twists = Rows::read("twist", twist, 3)?;
        twists.check_finite("twist")?;
        let mut centres = Output::new(py, "out", None, &Self::shape(&twists.leading, 2), &[])?;
        for (twist, centre) in twists
            .triples()
            .iter()
            .zip(centres.flat().as_chunks_mut().0)
        {
            *centre = Twist::from(*twist).icr();
        }
        centres.finish()
    }

    /// Joint commands by joint name: what a motor driver takes.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, shape (..., 3)
    ///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
    /// previous : array_like, shape (..., steered wheels), optional
    ///     Present steering angles [rad], in the order of `steered_names`.
    ///
    /// Returns
    /// -------
    /// dict of str to float or ndarray
    ///     Steering joints [rad], then traction joints [rad/s], each in the order of `steering_joints` and
    ///     `traction_joints`: for a rover from a parameter file, the order of the file.
    ///
    /// Raises
    /// ------
    /// InfeasibleMotionError, ValueError
    ///     As `inverse`.
    #[pyo3(signature = (twist, *, previous=None))]
    fn commands<'py>(
        &self,
        py: Python<'py>,
        twist: &Bound<'py, PyAny>,
        previous: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (steering, speeds) = self.inverse(py, twist, previous, None, None)?;
        let commands = PyDict::new(py);
        let steered = self.core.steered();
        let place = |wheel: usize| steered.iter().position(|&i| i == wheel).unwrap_or_default();
        let angles = self
            .steering
            .iter()
            .map(|(joint, wheel)| (joint, &steering, place(*wheel)));
        let rotations = self
            .traction
            .iter()
            .map(|(joint, wheel)| (joint, &speeds, *wheel));
        for (joint, array, column) in angles.chain(rotations) {
            let values = array.get_item((pyo3::types::PyEllipsis::get(py), column))?;
            let single = values.getattr("ndim")?.extract::<usize>()? == 0;
            let values = if single {
                values.call_method0("item")?
            } else {
                values
            };
            commands.set_item(joint, values)?;
        }
        Ok(commands)
    }

    /// The wheels, in the order of every array.
    #[getter]
    fn wheels(&self, py: Python<'_>) -> Py<PyTuple> {
        self.wheels.clone_ref(py)
    }

    /// Names of the wheels, in the order of every array.
    #[getter]
    fn wheel_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(
            py,
            self.core.wheels().iter().map(|wheel| wheel.name.as_str()),
        )
    }

    /// Names of the steered wheels, in the order of steering arrays.
    #[getter]
    fn steered_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let names = self
            .core
            .steered()
            .iter()
            .map(|&i| self.core.wheels()[i].name.as_str());
        PyTuple::new(py, names.collect::<Vec<_>>())
    }

    /// Joint name to wheel name of the wheel drives, in the order of `commands`.
    #[getter]
    fn traction_joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.joint_dict(py, &self.traction)
    }

    /// Joint name to wheel name of the steering, in the order of `commands`.
    #[getter]
    fn steering_joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.joint_dict(py, &self.steering)
    }

    /// Smallest radius from which on every turn is possible [m]: 0 if all are, infinite if none is.
    ///
    /// It counts along the axle line of the unsteered wheels, or abreast of the origin if there are none.
    #[getter]
    fn min_radius(&self) -> f64 {
        self.core.min_radius()
    }

    /// Largest radius up to which every turn is possible [m]: 0 if the rover cannot turn on the spot.
    ///
    /// Between it and `min_radius` some turns are impossible.
    #[getter]
    fn spin_radius(&self) -> f64 {
        self.core.spin_radius()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let keywords = self.joint_keywords(py)?;
        if keywords.is_empty()
            && let Some(([d1, d2, d3, d4], radius, range)) = self.core.as_six_wheel()
        {
            let mut text = format!(
                "Rover.six_wheel(d1={d1:?}, d2={d2:?}, d3={d3:?}, d4={d4:?}, wheel_radius={radius:?}"
            );
            if range != SteeringRange::default() {
                text += &format!(", steering_limit={}", steering_limit(range));
            }
            return Ok(text + ")");
        }
        let wheels = PyList::new(py, self.wheels.bind(py))?.repr()?;
        let mut text = format!("Rover({wheels}");
        for (keyword, value) in keywords.iter() {
            text += &format!(", {keyword}={}", value.repr()?);
        }
        Ok(text + ")")
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| {
            let other = other.get();
            (&self.core, &self.traction, &self.steering)
                == (&other.core, &other.traction, &other.steering)
        })
    }

    fn __hash__(&self) -> u64 {
        let mut state = DefaultHasher::new();
        for wheel in self.core.wheels() {
            hash_wheel(wheel, &mut state);
        }
        (&self.traction, &self.steering).hash(&mut state);
        state.finish()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, rover) = (slf.py(), slf.get());
        let arguments = (rover.wheels.bind(py),).into_pyobject(py)?;
        reduce(slf.as_any(), &arguments, &rover.joint_keywords(py)?)
    }
}

/// The two arrays of `out=`, if given.
fn pair<'py>(out: Option<&Bound<'py, PyAny>>) -> PyResult<[Option<Bound<'py, PyAny>>; 2]> {
    let Some(out) = out else {
        return Ok([None, None]);
    };
    let tuple = out.cast::<PyTuple>().ok().filter(|tuple| tuple.len() == 2);
    let Some(tuple) = tuple else {
        let got = out.get_type().name()?.to_string();
        return Err(refuse(
            "out",
            "be a pair of arrays (steering, speeds)",
            &got,
        ));
    };
    Ok([Some(tuple.get_item(0)?), Some(tuple.get_item(1)?)])
}

/// One value as a Python scalar, many as an array of this shape.
fn scalar_or_array<T: numpy::Element>(
    py: Python<'_>,
    values: Vec<T>,
    shape: &[usize],
) -> PyResult<Py<PyAny>> {
    let array = numpy::PyArray1::from_vec(py, values).reshape(IxDyn(shape))?;
    let result = if shape.is_empty() {
        array.call_method0("item")?
    } else {
        array.into_any()
    };
    Ok(result.unbind())
}

/// Items in nested lists of this shape; the only item itself if the shape is empty.
fn nested<'py>(
    py: Python<'py>,
    items: Vec<Bound<'py, PyAny>>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    let Some((_, inner)) = shape.split_first() else {
        return items
            .into_iter()
            .next()
            .ok_or_else(|| refuse("fit", "have a row", "none"));
    };
    let size = inner.iter().product::<usize>().max(1);
    let groups: Vec<_> = items
        .chunks(size)
        .map(|group| nested(py, group.to_vec(), inner))
        .collect::<PyResult<_>>()?;
    Ok(PyList::new(py, groups)?.into_any())
}
