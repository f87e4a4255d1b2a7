//! `six_wheel.FourAxle`: axles on lockable pivots. Its states and results are plain values of Python.

mod driving;
mod values;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use six_wheel_four_axle::{self as core, Brakes};
use six_wheel_kinematics::steering::SteeringRange;

use crate::classes::hash_of_numbers;
use crate::convert::{AnyArray, Output, Rows};
use crate::rover::Rover;
use crate::wheel::{steering_limit, steering_range};
use crate::workers::{fill_rows, workers};
use values::{array, axles, brake, drives, raised, value, vector};

/// Four axles on lockable pivots: four-wheel steering, dual differential drive, and their hybrid.
///
/// Each axle turns about a pivot and carries a driven wheel at its outer end. Two brakes lock the pivots of the
/// front and of the rear pair; a free axle is turned by its wheel: ``(e . u - r q) / scrub - omega`` is
/// its rate. Pivots on the centre line carry one rigid axle per pair: two differential drives in tandem.
/// Axles come in the order front left, front right, rear left, rear right; their angles are the headings of
/// the wheels in the body.
#[doc = section!(Parameters)]
/// pivots : (float, float)
///     Half the distance of the pivots along and across the body [m]; across it may be 0.
/// axle_length : float
///     Pivot to wheel [m].
#[doc = parameters!(wheel_radius, steering_limit)]
/// tolerance : float
///     Side slip per metre driven up to which axle lines count as meeting in one point. The default is what
///     pivot encoders of 13 bits leave open.
#[doc = raises!("If a dimension is not finite and positive or the tolerance not below 1.")]
///
/// Source: R. Siegwart, I. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed., ch. 3.
#[pyclass(frozen, module = "six_wheel")]
pub struct FourAxle {
    core: core::FourAxle,
    rover: Py<Rover>,
}

impl FourAxle {
    fn build(py: Python<'_>, core: core::FourAxle) -> PyResult<Self> {
        let rover = Py::new(py, Rover::named(py, Ok(core.rover().clone()))?)?;
        Ok(Self { core, rover })
    }

    fn keywords<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (pivots, axle_length, wheel_radius) = (self.pivots(py), self.axle_length(py), self.wheel_radius(py));
        let (steering_limit, tolerance) = (self.steering_range(py), self.tolerance(py));
        Ok(dict!(py, pivots, axle_length, wheel_radius, steering_limit, tolerance))
    }
}

getters! { FourAxle, self, py:
    /// The same vehicle as a `Rover` with four steered wheels, for all that needs no brakes.
    rover: Py<Rover> = self.rover.clone_ref(py);
    /// Half the distance of the pivots along and across the body [m].
    pivots: (f64, f64) = self.core.pivots().into();
    /// Pivot to wheel [m].
    axle_length: f64 = self.core.axle_length();
    /// Hub to ground [m].
    wheel_radius: f64 = self.core.wheel_radius();
    /// Side slip per metre driven up to which axle lines count as meeting in one point.
    tolerance: f64 = self.core.tolerance();
    /// Smallest and largest axle angle [rad].
    steering_range: (f64, f64) = {
        let range = self.core.steering();
        (range.lower, range.upper)
    };
}

equal_by!(FourAxle: core);
replaceable!(FourAxle);
pickled_by_keywords!(FourAxle: keywords);

methods! { FourAxle:
    #[new]
    fn new[py: Python<'py>](pivots: [f64; 2], axle_length: f64, wheel_radius: f64, *, steering_limit=None,
        tolerance: Option<f64> = None, **)
    as "(pivots, axle_length, wheel_radius, *, steering_limit=None, tolerance=0.001)" -> PyResult<Self> {
        let core = core::FourAxle::new(
            pivots,
            axle_length,
            wheel_radius,
            steering_range(steering_limit)?.unwrap_or_default(),
            tolerance.unwrap_or(core::LOCK_TOLERANCE),
        );
        Self::build(py, core.map_err(raised)?)
    }

    /// Axle angles and wheel speeds for a twist with all pivots locked: `rover.inverse`.
    #[doc = section!(Parameters: twist "(..., 3)")]
    /// previous : array_like, shape (..., 4), optional
    ///     Present axle angles [rad].
    /// out : (ndarray, ndarray), shapes (..., 4) and (..., 4), optional
    ///     Arrays for steering and wheel speeds.
    #[doc = parameters!(dtype, threads)]
    #[doc = returns!("steering, wheel_speeds : ndarray, shape (..., 4)": "Axle angles [rad] and wheel speeds [rad/s].")]
    #[doc = raises!(InfeasibleMotionError, ValueError)]
    ///     As `Rover.inverse`.
    fn inverse[&self, py: Python<'py>](twist, *, previous=None, out=None, dtype=None, threads: Option<i64> = None)
    -> PyResult<(AnyArray<'py>, AnyArray<'py>)> {
        self.rover.get().inverse(py, twist, &PyTuple::empty(py), previous, None, None, None, out, dtype, threads, None)
    }

    /// Motion of the body and the free pivots at these wheel speeds, by least squares over both rows of every wheel.
    ///
    /// With one pair free and the drives of the other following, the rows may leave open how fast
    /// axles on two pivots go along; the motion is then the one that lasts, under which the axle lines go on to share a
    /// point.
    #[doc = section!(Parameters)]
    /// steering : array_like, shape (4,)
    ///     Axle angles [rad].
    /// wheel_speeds : sequence of float or None, length 4
    ///     Wheel speeds [rad/s]; None where the drive follows.
    /// front_brake, rear_brake : {'locked', 'free'}
    ///     Brakes of the two pairs.
    #[doc = returns!("FourAxleMotion": "``.twist``, ``.pivot_rates``, ``.wheel_speeds``, ``.residuals``, ``.rank``.")]
    #[doc = raises!(
        UnderdeterminedError: "If the wheels do not determine body and free pivots.",
        ValueError: "If a value is not finite, an angle out of range, or the angles of a rigid axle differ."
    )]
    fn forward[&self, py: Python<'py>](steering, wheel_speeds, *, front_brake: &str = "locked",
        rear_brake: &str = "locked")
    -> PyResult<Bound<'py, PyAny>> {
        let set = Brakes { front: brake("front_brake", front_brake)?, rear: brake("rear_brake", rear_brake)? };
        let motion = self.core.forward(&axles("steering", steering)?, set, &drives("wheel_speeds", wheel_speeds)?);
        let motion = motion.map_err(raised)?;
        let twist: [f64; 3] = motion.twist.into();
        value(py, "FourAxleMotion")?.call1((
            vector(py, twist.to_vec()),
            vector(py, motion.pivot_rates.to_vec()),
            vector(py, motion.speeds.to_vec()),
            vector(py, motion.residual.to_vec()),
            motion.rank,
        ))
    }

    /// Axle angles under which the robot turns about a point, and nothing slips.
    #[doc = section!(Parameters)]
    /// icr : array_like, shape (..., 2)
    ///     The point in body axes [m]; (0, 0) to spin in place, (0, inf) for straight ahead, (inf, 0) for a
    ///     crab sideways. Other crabs have a direction, not a point: `inverse`.
    #[doc = parameters!(out "(..., 4)", dtype, threads)]
    #[doc = returns!("ndarray, shape (..., 4)": "Axle angles [rad], as near to 0 as half turns bring them.")]
    #[doc = raises!(
        InfeasibleMotionError: "If an axle would leave its range.",
        ValueError: "If a coordinate is NaN, or both are infinite."
    )]
    fn concurrent_angles[&self, py: Python<'py>](icr, *, out=None, dtype=None, threads: Option<i64> = None)
    -> PyResult<AnyArray<'py>> {
        let workers = workers(threads, None)?;
        let points = Rows::read("icr", icr, 2)?;
        let shape: Vec<usize> = points.leading.iter().copied().chain([4]).collect();
        let mut angles = Output::asked(py, (out, dtype), &shape)?;
        if out.is_some() {
            angles = angles.beside()?; // an axle may leave its range at the last row
        }
        let (places, targets) = (points.pairs(), [(angles.flat(), 4)]);
        fill_rows(py, workers, places.len(), &points.leading, targets, |row, [target]| {
            let found = self.core.concurrent_angles(places[row]);
            target.copy_from_slice(&found.map_err(|error| error.at_row(row))?);
            Ok(())
        })?;
        angles.finish_any()
    }
}

#[pymethods]
impl FourAxle {
    /// Mobility of the robot with its axles locked at these angles, from the rank of the side-slip rows.
    #[doc = section!(Parameters)]
    /// steering : array_like, shape (4,)
    ///     Axle angles [rad].
    #[doc = returns!("FourAxleMobility")]
    ///     ``.rank``, ``.degree_of_mobility``, ``.singular_values``, ``.motion``, ``.slip``, ``.margin``.
    #[doc = raises!("If an angle is not finite or out of range, or the angles of a rigid axle differ.")]
    fn mobility<'py>(&self, py: Python<'py>, steering: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let mobility = self.core.mobility(&axles("steering", steering)?).map_err(raised)?;
        let free: Vec<[f64; 3]> = mobility.free().iter().map(|twist| (*twist).into()).collect();
        value(py, "FourAxleMobility")?.call1((
            mobility.rank,
            mobility.degree(),
            vector(py, mobility.singular_values.to_vec()),
            array(py, &free)?,
            mobility.slip,
            mobility.margin,
        ))
    }

    fn __repr__(&self) -> String {
        let core = &self.core;
        let mut text = format!(
            "FourAxle({:?}, {:?}, {:?}",
            <(f64, f64)>::from(core.pivots()),
            core.axle_length(),
            core.wheel_radius()
        );
        if core.steering() != SteeringRange::default() {
            text += &format!(", steering_limit={}", steering_limit(core.steering()));
        }
        if core.tolerance() != core::LOCK_TOLERANCE {
            text += &format!(", tolerance={:?}", core.tolerance());
        }
        text + ")"
    }

    fn __hash__(&self) -> u64 {
        let (core, [x, y]) = (&self.core, self.core.pivots());
        hash_of_numbers([x, y, core.axle_length(), core.wheel_radius(), core.tolerance()])
    }
}
