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

/// Every quantity by the name of its attribute.
const NAMES: [(&str, Quantity); 12] = [
    ("wheel_speeds", Quantity::Speed),
    ("steering", Quantity::Steering),
    ("steering_rates", Quantity::SteeringRate),
    ("slip", Quantity::Slip),
    ("side_slip", Quantity::SideSlip),
    ("x", Quantity::X),
    ("y", Quantity::Y),
    ("heading", Quantity::Heading),
    ("radius", Quantity::Radius),
    ("scrub", Quantity::Scrub),
    ("trail", Quantity::Trail),
    ("roller_angle", Quantity::RollerAngle),
];

/// A twist with its derivatives: rows ``vx, vy, omega``, one column per wheel or steered wheel.
///
/// Derivatives that were not asked for are None.
#[pyclass(frozen, module = "six_wheel", name = "TwistJacobian")]
#[derive(Default)]
pub struct Sensitivity {
    twist: Option<Py<PyAny>>,
    columns: Vec<(&'static str, Py<PyAny>)>,
}

impl Sensitivity {
    fn get(&self, py: Python<'_>, name: &str) -> Option<Py<PyAny>> {
        let found = self.columns.iter().find(|(column, _)| *column == name);
        found.map(|(_, array)| array.clone_ref(py))
    }
}

getters! { Sensitivity, self, py:
    /// ``[vx, vy, omega]`` in body axes, shape (..., 3) [m/s, m/s, rad/s].
    twist: Option<Py<PyAny>> = self.twist.as_ref().map(|twist| twist.clone_ref(py));
    /// By the reading of each wheel's speed [rad/s], shape (..., 3, wheels).
    wheel_speeds: Option<Py<PyAny>> = self.get(py, "wheel_speeds");
    /// By the reading of each steering angle [rad], shape (..., 3, steered wheels).
    steering: Option<Py<PyAny>> = self.get(py, "steering");
    /// By the rate of each steering angle [rad/s], shape (..., 3, steered wheels).
    steering_rates: Option<Py<PyAny>> = self.get(py, "steering_rates");
    /// By the speed at which each contact slips forwards [m/s], shape (..., 3, wheels).
    slip: Option<Py<PyAny>> = self.get(py, "slip");
    /// By the speed at which each contact slips to its left [m/s], shape (..., 3, wheels).
    side_slip: Option<Py<PyAny>> = self.get(py, "side_slip");
    /// By each pivot's place forward of the origin [m], shape (..., 3, wheels).
    x: Option<Py<PyAny>> = self.get(py, "x");
    /// By each pivot's place left of the origin [m], shape (..., 3, wheels).
    y: Option<Py<PyAny>> = self.get(py, "y");
    /// By each wheel's direction at steering angle 0 [rad], shape (..., 3, wheels): the offset of a steering angle.
    heading: Option<Py<PyAny>> = self.get(py, "heading");
    /// By each radius [m], shape (..., 3, wheels).
    radius: Option<Py<PyAny>> = self.get(py, "radius");
    /// By each contact's place left of its steering axis [m], shape (..., 3, wheels).
    scrub: Option<Py<PyAny>> = self.get(py, "scrub");
    /// By each contact's place behind its steering axis [m], shape (..., 3, wheels).
    trail: Option<Py<PyAny>> = self.get(py, "trail");
    /// By each roller angle [rad], shape (..., 3, wheels); 0 for a wheel without rollers.
    roller_angle: Option<Py<PyAny>> = self.get(py, "roller_angle");
}

pickled_by_fields! { Sensitivity, this, py:
    (
        twist: Option<Py<PyAny>> = &this.twist,
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
        Ok(Sensitivity { twist: Some(twists.finish_object()?), columns })
    }
}
