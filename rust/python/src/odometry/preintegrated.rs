//! `six_wheel.Preintegrated`.

mod parts;

use numpy::{PyArray1, PyArray2, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use six_wheel_kinematics::estimate::Method;
use six_wheel_numerics::error::Error;
use six_wheel_odometry::preintegrated::{Column, ErrorFrame, PreintegratedMotion, PreintegrationOptions, Residual};
use six_wheel_odometry::{Preintegrated as Core, Recording, Settings};

use super::input::{column, settings, steering};
use super::values::{Gyroscope, Noise};
use crate::convert::{OrRaise, Rows, choice, compute, is_interrupted, number, raise, refuse};
use crate::rover::Rover;
use crate::state_lock::Shared;

/// Names of the dimensions of wheels, as of `TwistJacobian`, in the order of `DIMENSIONS`; of constant slip; of the bias.
const NAMES: [&str; 7] = ["radius", "x", "y", "heading", "scrub", "trail", "roller_angle"];
const SLIPS: [&str; 2] = ["slip", "side_slip"];
const BIAS: &str = "gyroscope_bias";

type Matrix<'py> = Bound<'py, PyArray2<f64>>;
/// A change by its name: its columns, and a number for each.
struct Change {
    name: String,
    columns: Vec<Column>,
    numbers: Vec<f64>,
}

/// Error, its derivatives by two poses, and those by what may change.
type Factor<'py> = (Bound<'py, PyArray1<f64>>, Matrix<'py>, Matrix<'py>, Bound<'py, PyDict>);

/// Wheel motion between two instants, as one factor of a graph.
///
/// The motion is that of `Odometry` over the same samples. What may change afterwards without integrating again (the
/// dimensions of the wheels, slip, the bias of a gyroscope) moves it to first order by the derivatives here.
///
/// Errors and derivatives are in the tangent space named `tangent`, the end's: ``delta exp(e)``, with e in axes of the
/// body at the end. In the plane poses and `delta` are ``[x, y, yaw]`` and tangents ``[x, y, yaw]`` [m, m, rad]; in
/// space they are homogeneous matrices (4, 4), tangents ``[x, y, z, about x, about y, about z]``, as in ROS messages.
#[doc = section!(Parameters)]
/// rover : Rover
///     Any vehicle.
/// noise : Noise, optional
///     Standard deviations of readings and slip, default ``Noise()``.
/// gyroscope : Gyroscope, optional
///     Of the `yaw_rate` that comes with the samples: its noise, and the bias that is taken off.
/// readings, increments, wheel_encoders, steering_encoders, method
///     As for `Odometry`.
/// in_space : bool
///     True if every sample has an attitude: SE(3) instead of the plane. Wheels then move the body in the plane they
///     stand on, which the attitude tilts; its turn about the body's own vertical axis is a gyroscope's, which wheels
///     and attitude share by their noise.
/// attitude_noise : float, default 0.01
///     Standard deviation of the tilt of an attitude [rad].
#[doc = raises!("If a parameter makes no sense.")]
///
/// Source: C. Forster, L. Carlone, F. Dellaert, D. Scaramuzza, On-Manifold Preintegration for Real-Time
/// Visual-Inertial Odometry, IEEE T-RO 33(1), 2017, for the idea; the wheel equation here is that of any rover.
#[pyclass(frozen, module = "six_wheel")]
pub struct Preintegrated {
    work: Shared<Work>,
    in_space: bool,
    rover: Py<Rover>,
    /// Options of the constructor that were given, by name.
    given: Py<PyDict>,
}

/// The state that one thread at a time works with.
struct Work {
    core: Core,
    /// Of the samples so far.
    replayed: Option<PreintegratedMotion>,
}

argument_kind! { Preintegrated: "a Preintegrated" }

getters! { Preintegrated, self, py:
    /// Name of the tangent space of `covariance`, `residual` and all derivatives.
    tangent: &'static str = "end";
    /// When the motion begins [s]; None before a sample.
    begin: PyResult<Option<f64>> = Ok(self.span(py)?.map(|[begin, _]| begin));
    /// When it ends [s]; None before a sample.
    end: PyResult<Option<f64>> = Ok(self.span(py)?.map(|[_, end]| end));
    /// From begin to end [s].
    duration: PyResult<f64> = Ok(self.span(py)?.map_or(0.0, |[begin, end]| end - begin));
    /// The rover.
    rover: Py<Rover> = self.rover.clone_ref(py);
    /// Standard deviations of readings and slip.
    noise: PyResult<Noise> = Ok(self.work.lock(py)?.core.options().settings.noise.into());
    /// Error model of the gyroscope; None without one.
    gyroscope: PyResult<Option<Gyroscope>> = Ok(self.work.lock(py)?.core.options().gyroscope.map(Gyroscope));
    /// The motion ``begin_from_end``: ``[x, y, yaw]``, the yaw with its full turns, or in space a matrix (4, 4).
    delta: PyResult<Bound<'py, PyAny>> = {
        let mut work = self.work.lock(py)?;
        if let Some(pose) = work.core.pose() {
            return Ok(PyArray1::from_slice(py, &<[f64; 3]>::from(pose)).into_any());
        }
        let replayed = work.replayed(py)?;
        let (motion, yaw) = (replayed.motion, replayed.yaw);
        Ok(self.written(py, &motion, yaw))
    };
    /// Covariance of the motion in the tangent space `tangent`, shape (3, 3) or (6, 6).
    covariance: PyResult<Matrix<'py>> = self.covariance_in(py, "end");
    /// Derivatives of the motion by the dimensions of the wheels, dict of name to array (3 or 6, wheels): `radius`,
    /// `x`, `y`, `heading`, `scrub`, `trail`, `roller_angle`.
    by_dimension: PyResult<Bound<'py, PyDict>> = self.tables(py, NAMES.into_iter());
    /// Derivatives by constant slip, dict of name to array (3 or 6, wheels): `slip`, the share of the way a wheel rolled
    /// by which its contact slipped forwards; `side_slip`, how far it slipped to its left, as a share of the way its pivot
    /// went.
    by_slip: PyResult<Bound<'py, PyDict>> = self.tables(py, SLIPS.into_iter());
    /// Derivative by the bias of the gyroscope [rad/s], shape (3,) or (6,); zero without one.
    by_gyroscope_bias: PyResult<Bound<'py, PyArray1<f64>>> = {
        let mut work = self.work.lock(py)?;
        let by = work.replayed(py)?.by(Column::Bias);
        let kept: Vec<f64> = self.rows().iter().map(|&row| by[row]).collect();
        Ok(kept.to_pyarray(py))
    };
}

impl Preintegrated {
    /// Begin and end [s], once there is a sample.
    fn span(&self, py: Python<'_>) -> PyResult<Option<[f64; 2]>> {
        Ok(self.work.lock(py)?.core.span())
    }
}

/// Changes as one of the motion in its tangent.
fn in_tangent(changes: &[Change], motion: &PreintegratedMotion) -> [f64; 6] {
    let mut sum = [0.0; 6];
    for change in changes {
        for (&column, number) in change.columns.iter().zip(&change.numbers) {
            for (sum, part) in sum.iter_mut().zip(motion.by(column).iter()) {
                *sum += part * number;
            }
        }
    }
    sum
}

methods! { Preintegrated:
    #[new]
    fn new[](rover: Bound<'py, Rover>, noise: Option<Bound<'py, Noise>> = None, *,
        gyroscope: Option<Bound<'py, Gyroscope>> = None, readings: &str = "angles", increments: bool = false,
        wheel_encoders=None, steering_encoders=None, method: &str = "least_squares", in_space: bool = false,
        attitude_noise: Option<f64> = None, **)
    as "(rover, noise=None, *, gyroscope=None, readings='angles', increments=False, wheel_encoders=None, steering_encoders=None, method='least_squares', in_space=False, attitude_noise=0.01)"
    -> PyResult<Self> {
        let py = rover.py();
        let given = dict!(py, noise = &noise, gyroscope = &gyroscope, readings, increments, wheel_encoders, steering_encoders,
            method, in_space, attitude_noise);
        let core = &rover.get().core;
        let [wheels, steered] = rover.get().wheels_and_steered();
        let options = PreintegrationOptions {
            settings: Settings {
                method: method.parse::<Method>().or_raise(&[])?,
                ..settings(noise, (readings, increments), [wheel_encoders, steering_encoders], [&wheels, &steered])?
            },
            gyroscope: gyroscope.map(|known| known.get().0),
            in_space,
            attitude_noise: attitude_noise.unwrap_or(0.01),
        };
        let core = Core::new(core.clone(), options).or_raise(&[])?;
        let work = Shared::new(Work { core, replayed: None });
        Ok(Self { work, in_space, rover: rover.clone().unbind(), given: given.unbind() })
    }

    /// Takes in one sample, or all rows of a log. The first one is where the motion begins.
    #[doc = section!(Parameters)]
    /// steering : array_like, shape (steered wheels,) or (n, steered wheels), or WheelLog
    ///     As for `Odometry.update`; None for a rover that does not steer. A log stands for this and the next two.
    /// wheel_angles : array_like, shape (wheels,) or (n, wheels)
    ///     As for `Odometry.update`.
    /// stamp : float or array_like, shape (n,)
    ///     When they were read [s].
    /// yaw_rate : float or array_like, shape (n,), optional
    ///     Of a gyroscope [rad/s]; NaN where there was none.
    /// attitude : array_like, shape (4,) or (n, 4), optional
    ///     Quaternion x, y, z, w of the body in any fixed frame; needed in space.
    #[doc = raises!(
        UnderdeterminedError: "If the wheels do not determine the motion.",
        ValueError: "If a value is not finite, a stamp not later than the last one or a shape wrong; nothing was taken in."
    )]
    fn add[&self, py: Python<'py>](steering, wheel_angles=None, stamp=None, *, yaw_rate=None, attitude=None)
    -> PyResult<()> {
        let (Some(wheel_angles), Some(stamp)) = (wheel_angles, stamp) else {
            if wheel_angles.is_some() || stamp.is_some() || !steering.hasattr("wheel_angles")? {
                return Err(refuse("steering", "come together with wheel_angles and stamp, or be a log", "one without the others"));
            }
            let parts = ["steering", "wheel_angles", "stamps"].map(|part| steering.getattr(part));
            let [steering, wheels, stamps] = parts;
            return self.add(py, &steering?, Some(&wheels?), Some(&stamps?), yaw_rate, attitude);
        };
        let (count, joints) = (self.rover.get().count(), self.rover.get().joints());
        let wheels = Rows::read("wheel_angles", wheel_angles, count)?;
        let leading = wheels.leading.as_slice();
        if leading.len() > 1 {
            return Err(refuse("wheel_angles", format!("have shape ({count},) or (n, {count})"), "more axes"));
        }
        let steering = self::steering(steering, joints, leading)?;
        let stamps = column("stamp", stamp, leading)?;
        let rates = yaw_rate.map(|rate| column("yaw_rate", rate, leading)).transpose()?;
        let attitudes = Rows::read_beside("attitude", attitude, 4, leading)?;
        let attitudes = attitudes.as_ref().map(|rows| rows.flat().as_chunks::<4>().0);
        let log = Recording {
            steering: steering.as_ref().map_or(&[], Rows::flat),
            wheels: wheels.flat(),
            stamps: stamps.flat(),
            yaws: None,
            yaw_rates: rates.as_ref().map(Rows::flat),
        };
        let mut work = self.work.lock(py)?;
        work.replayed = None;
        let core = &mut work.core;
        compute(py, wheels.count(), || core.add_log(log, attitudes, is_interrupted)).map_err(|error| {
            let row = error.row.filter(|_| !leading.is_empty());
            raise(Error { row, ..error }, leading)
        })
    }

    /// Difference between the motion of two poses and this one: ``log(delta⁻¹ pose_i⁻¹ pose_j)``.
    #[doc = section!(Parameters)]
    /// pose_i, pose_j : array_like, shape (3,) or (4, 4)
    ///     Poses of the body at the beginning and at the end of the motion.
    #[doc = returns!("error : ndarray, shape (3,) or (6,)")]
    ///     Zero where they agree; weigh it by the inverse of `covariance`.
    /// by_i, by_j : ndarray, shape (3, 3) or (6, 6)
    ///     Its derivatives by both poses, as they move by ``pose exp(e)``.
    fn residual[&self, py: Python<'py>](pose_i, pose_j)
    -> PyResult<(Bound<'py, PyArray1<f64>>, Matrix<'py>, Matrix<'py>)> {
        let (error, by_i, by_j, _) = self.factor(py, pose_i, pose_j, &PyDict::new(py))?;
        Ok((error, by_i, by_j))
    }

    /// `residual` of the motion after changes, with its derivatives by these as well: for an optimiser that looks for
    /// dimensions, slip or a bias along with poses.
    #[doc = section!(Parameters)]
    /// pose_i, pose_j : array_like, shape (3,) or (4, 4)
    ///     As in `residual`.
    /// changes : dict of str to array_like
    ///     As in `corrected`, from the dimensions, slip and bias that the motion was integrated with: arrays of shape
    ///     (wheels,), or one number for all.
    #[doc = returns!("error, by_i, by_j : ndarray")]
    ///     As in `residual`.
    /// by_changes : dict of str to ndarray
    ///     Derivatives by every change, arrays (3 or 6, wheels).
    fn factor[&self, py: Python<'py>](pose_i, pose_j, changes: &Bound<'py, PyDict>)
    -> PyResult<Factor<'py>> {
        let poses = [self.pose_of("pose_i", pose_i)?, self.pose_of("pose_j", pose_j)?];
        let (changes, rows) = (self.changes(changes)?, self.rows());
        let mut work = self.work.lock(py)?;
        let replayed = work.replayed(py)?;
        let change = in_tangent(&changes, replayed);
        let residual = Residual::of(&replayed.motion, &change.into(), [&poses[0], &poses[1]]);
        let error: Vec<f64> = rows.iter().map(|&row| residual.error[row]).collect();
        let by_changes = PyDict::new(py);
        for Change { name, columns, .. } in changes {
            let by: Vec<_> = columns.iter().map(|&column| residual.by_motion * replayed.by(column)).collect();
            let table: Vec<Vec<f64>> = rows.iter().map(|&row| by.iter().map(|one| one[row]).collect()).collect();
            by_changes.set_item(name, PyArray2::from_vec2(py, &table)?)?;
        }
        let by_first = self.square(py, |i, k| residual.by_first[(i, k)])?;
        let by_second = self.square(py, |i, k| residual.by_second[(i, k)])?;
        Ok((error.to_pyarray(py), by_first, by_second, by_changes))
    }

    /// This motion and the one that begins where it ends, as one. The reading between both errs in both: the
    /// covariance is that of all samples in one place.
    #[doc = section!(Parameters)]
    /// other : Preintegrated
    ///     Of the same rover, its first sample the last one here.
    fn merge[&self, py: Python<'py>](other: Bound<'py, Self>) -> PyResult<Self> {
        // A copy: two objects that are merged into each other by two threads would wait for each other.
        let theirs = other.get().work.lock(py)?.core.clone();
        let ours = &self.work.lock(py)?.core;
        let merged = compute(py, theirs.len(), || ours.merge(&theirs));
        Ok(self.with(merged.or_raise(&[])?, py))
    }
}

copied! { Preintegrated, |this, py| {
    let core = this.work.lock(py)?.core.clone();
    Ok(this.with(core, py))
} }

#[pymethods]
impl Preintegrated {
    /// Covariance of the motion in a tangent space by name.
    #[doc = section!(Parameters)]
    /// tangent : {'end', 'begin', 'coordinates'}
    ///     ``delta exp(e)``, in axes of the body at the end; ``exp(e) delta``, at the beginning; or ``delta + e``, the
    ///     coordinates of the end seen from the beginning, as `OdometryState.covariance`.
    fn covariance_in<'py>(&self, py: Python<'py>, tangent: &str) -> PyResult<Matrix<'py>> {
        let all = [("end", ErrorFrame::End), ("begin", ErrorFrame::Begin), ("coordinates", ErrorFrame::Coordinates)];
        let chosen = choice("tangent", tangent, |name| format!("'{name}'"), &all)?;
        let mut work = self.work.lock(py)?;
        if let Some(covariance) = work.core.covariance().filter(|_| tangent == "coordinates") {
            return Ok(PyArray2::from_vec2(py, &covariance.map(Vec::from))?);
        }
        let covariance = work.replayed(py)?.covariance_in(chosen);
        self.square(py, |i, k| covariance[(i, k)])
    }

    /// The motion after changes, to first order: no sample is looked at again.
    #[doc = section!(Parameters)]
    /// changes : dict of str to array_like
    ///     By names of `by_dimension` and `by_slip`, arrays of shape (wheels,), or one number for all; and
    ///     ``"gyroscope_bias"`` [rad/s].
    fn corrected<'py>(&self, py: Python<'py>, changes: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyAny>> {
        let changes = self.changes(changes)?;
        let mut work = self.work.lock(py)?;
        let replayed = work.replayed(py)?;
        let (motion, yaw) = replayed.corrected(in_tangent(&changes, replayed));
        Ok(self.written(py, &motion, yaw))
    }

    /// The motions before and after an instant, which `merge` joins again.
    #[doc = section!(Parameters)]
    /// stamp : float
    ///     From `begin` to `end` [s]. Within a step the rover is on its arc.
    fn split(&self, py: Python<'_>, stamp: &Bound<'_, PyAny>) -> PyResult<(Self, Self)> {
        let stamp = number("stamp", stamp)?;
        let core = &self.work.lock(py)?.core;
        let parts = compute(py, core.len(), || core.split(stamp));
        let [first, second] = parts.or_raise(&[])?;
        Ok((self.with(first, py), self.with(second, py)))
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(self.work.lock(py)?.core.len())
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let delta = self.delta(py)?;
        let shown: Vec<f64> = delta.call_method0("ravel")?.extract()?;
        let (samples, duration) = (self.__len__(py)?, self.duration(py)?);
        let place = match shown.as_slice() {
            [x, y, yaw] => format!("x={x:.4} m, y={y:.4} m, yaw={yaw:.4} rad"),
            all => format!("x={:.4} m, y={:.4} m, z={:.4} m", all[3], all[7], all[11]),
        };
        Ok(format!("Preintegrated({samples} samples, {duration} s, {place})"))
    }
}
