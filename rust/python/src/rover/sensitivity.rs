//! `six_wheel.TwistJacobian`, the derivatives of an estimated twist, and `Rover.sensitivity`.

use pyo3::prelude::*;
use pyo3::types::PyString;
use six_wheel_kinematics::batch;
use six_wheel_kinematics::estimate::sensitivity::Quantity;

use super::Rover;
use crate::convert::{Output, compute_rows, items, joined, refuse};
use crate::workers::workers;

/// Names that are read at most.
const MOST_NAMES: usize = 1000;

/// Attributes with derivatives of the twist, each with its quantity, and all of them by name.
macro_rules! derivatives {
    ($($(#[$doc:meta])* $name:ident = $quantity:ident;)*) => {
        /// Every quantity by the name of its attribute.
        const NAMES: &[(&str, Quantity)] = &[$((stringify!($name), Quantity::$quantity)),*];

        getters! { Sensitivity, self, py:
            $($(#[$doc])* $name: Option<Py<PyAny>> = self.get(py, stringify!($name));)*
        }
    };
}

/// A twist with its derivatives: rows ``vx, vy, omega``, one column per wheel or steered wheel.
///
/// Derivatives that were not asked for are None.
#[pyclass(frozen, module = "six_wheel", name = "TwistJacobian")]
pub struct Sensitivity {
    /// ``[vx, vy, omega]`` in body axes, shape (..., 3) [m/s, m/s, rad/s].
    #[pyo3(get)]
    twist: Py<PyAny>,
    columns: Vec<(&'static str, Py<PyAny>)>,
}

impl Sensitivity {
    fn get(&self, py: Python<'_>, name: &str) -> Option<Py<PyAny>> {
        let found = self.columns.iter().find(|(column, _)| *column == name);
        found.map(|(_, array)| array.clone_ref(py))
    }
}

derivatives! {
    /// By the reading of each wheel's speed [rad/s], shape (..., 3, wheels).
    wheel_speeds = Speed;
    /// By the reading of each steering angle [rad], shape (..., 3, steered wheels).
    steering = Steering;
    /// By the rate of each steering angle [rad/s], shape (..., 3, steered wheels).
    steering_rates = SteeringRate;
    /// By the speed at which each contact slips forwards [m/s], shape (..., 3, wheels).
    slip = Slip;
    /// By the speed at which each contact slips to its left [m/s], shape (..., 3, wheels).
    side_slip = SideSlip;
    /// By each pivot's place forward of the origin [m], shape (..., 3, wheels).
    x = X;
    /// By each pivot's place left of the origin [m], shape (..., 3, wheels).
    y = Y;
    /// By each wheel's direction at steering angle 0 [rad], shape (..., 3, wheels): the offset of a steering angle.
    heading = Heading;
    /// By each radius [m], shape (..., 3, wheels).
    radius = Radius;
    /// By each contact's place left of its steering axis [m], shape (..., 3, wheels).
    scrub = Scrub;
    /// By each contact's place behind its steering axis [m], shape (..., 3, wheels).
    trail = Trail;
    /// By each roller angle [rad], shape (..., 3, wheels); 0 for a wheel without rollers.
    roller_angle = RollerAngle;
}

pickled_by_fields! { Sensitivity, this, py:
    (
        twist: Py<PyAny> = &this.twist,
        names: Vec<String> = this.columns.iter().map(|(name, _)| *name).collect::<Vec<_>>(),
        arrays: Vec<Py<PyAny>> = this.columns.iter().map(|(_, array)| array).collect::<Vec<_>>(),
    )
    {
        let names = wanted(Some(&names.into_pyobject(py)?))?;
        Self { twist, columns: names.into_iter().map(|(name, _)| name).zip(arrays).collect() }
    }
}

#[pymethods]
impl Sensitivity {
    fn __repr__(&self) -> String {
        let names: Vec<&str> = self.columns.iter().map(|(name, _)| *name).collect();
        crate::classes::cut(format!("TwistJacobian(of the twist by {})", names.join(", ")))
    }
}

/// The quantities of these names.
fn wanted(quantities: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<(&'static str, Quantity)>> {
    let Some(quantities) = quantities else { return Ok(NAMES.to_vec()) };
    if quantities.is_instance_of::<PyString>() {
        return Err(refuse("quantities", "be a sequence of names", "one name"));
    }
    let names = items("quantities", quantities, MOST_NAMES)?;
    let names: Vec<String> = names.iter().map(|item| item.extract()).collect::<PyResult<_>>()?;
    let known = |name: &String| {
        let found = NAMES.iter().find(|(known, _)| known == name).copied();
        found.ok_or_else(|| {
            let all: Vec<&str> = NAMES.iter().map(|(name, _)| *name).collect();
            refuse("quantities", format!("name some of {}", all.join(", ")), format!("'{name}'"))
        })
    };
    names.iter().map(known).collect()
}

methods! { Rover:
    /// Derivatives of the twist of `forward` by its readings and by the dimensions of the rover.
    ///
    /// Analytic derivatives of the least-squares solution. Unsteered wheels with parallel axles share the mean of
    /// their side-slip rows: by `heading`, a wheel moves that mean by its part.
    #[doc = section!(Parameters: wheel_readings, steering_rates)]
    /// quantities : sequence of str, optional
    ///     Names of the attributes to compute, default all of them.
    #[doc = parameters!(threads)]
    #[doc = returns!("TwistJacobian")]
    ///     `twist` (..., 3) and one array (..., 3, wheels or steered wheels) per quantity.
    #[doc = raises!(
        UnderdeterminedError: "If the wheels do not determine the twist.",
        ValueError: "If a value is not finite, a shape does not fit or a quantity is unknown."
    )]
    fn sensitivity[&self, py: Python<'py>](steering, wheel_speeds, *, steering_rates=None, quantities=None,
        threads: Option<i64> = None) -> PyResult<Sensitivity> {
        let workers = workers(threads, None)?;
        let wanted = wanted(quantities)?;
        let readings = self.read_log(steering, wheel_speeds, steering_rates)?.flat()?;
        let leading = readings.speeds.leading.as_slice();
        let mut twists = Output::fresh(py, &joined(leading, 3))?;
        let mut columns = Vec::with_capacity(wanted.len());
        for (_, quantity) in &wanted {
            let width = match quantity {
                Quantity::Steering | Quantity::SteeringRate => self.joints(),
                _ => self.count(),
            };
            let shape = joined(&joined(leading, 3), width);
            columns.push(Output::fresh(py, &shape)?);
        }
        let mut targets: Vec<_> =
            wanted.iter().zip(&mut columns).map(|((_, quantity), column)| (*quantity, column.flat())).collect();
        let (log, rows) = (readings.log(), twists.triples());
        compute_rows(py, rows.len(), leading, || batch::sensitivity(&self.core, log, rows, &mut targets, workers))?;
        let columns = wanted
            .iter()
            .zip(columns)
            .map(|((name, _), column)| Ok((*name, column.finish_object()?)))
            .collect::<PyResult<_>>()?;
        Ok(Sensitivity { twist: twists.finish_object()?, columns })
    }
}
