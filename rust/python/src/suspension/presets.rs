//! Published suspensions by name: `Suspension.preset` and `RockerBogie.preset`.

use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyFloat, PyTuple};
use six_wheel_terrain::suspension::{PRESETS, RockerBogie as Core};

use super::base::Suspension;
use super::rocker_bogie::RockerBogie;
use crate::convert::refuse;
use crate::fastcall::keywords::Given;

/// The published suspension that is no rocker-bogie, with the source of its dimensions.
const ZOE: &str = "zoe";
const ZOE_SOURCE: &str = "nealseegmiller/wmrde, src/demo/zoemodel.cpp (84e1e9f), with its front axle fixed in roll";

methods! { Suspension:
    /// A published suspension by name; `Suspension.presets` lists them. A rocker-bogie is a `RockerBogie`.
    ///
    /// Zoe has four wheels on two passively steered axles, of which the rear one rolls; no limits are published.
    #[doc = section!(Parameters)]
    /// name : str
    ///     One of `Suspension.presets()`.
    #[doc = raises!("If there is no such preset.")]
    #[staticmethod]
    fn preset[py: Python<'py>](name: &str, **)
    as "(name)" -> PyResult<Py<Self>> {
        if name == ZOE {
            let sizes = [1.91, 1.64, 0.119, 0.325].map(|size| Given(Some(PyFloat::new(py, size).into_any())));
            let [base, track, drop, radius] = sizes;
            let made = Self::pivoting_axles(py, &PyTuple::empty(py), base, track, drop, radius, None, None, None)?;
            return Py::new(py, made);
        }
        if PRESETS.iter().any(|preset| preset.name == name) {
            let made = RockerBogie::named(py, Core::preset(name))?.into_bound(py);
            return Ok(made.into_super().unbind());
        }
        let names = PRESETS.map(|preset| preset.name).join(", ");
        Err(refuse("name", format!("be one of {names}, {ZOE}"), format!("{name:?}")))
    }

    /// Names of the published suspensions, each with the source of its dimensions.
    #[doc = returns!("dict of str to str": "Name to source; iterates over the names.")]
    #[staticmethod]
    fn presets[py: Python<'py>]() -> PyResult<Bound<'py, PyDict>> {
        let all = PRESETS.iter().map(|preset| (preset.name, preset.source));
        all.chain([(ZOE, ZOE_SOURCE)]).into_py_dict(py)
    }
}

methods! { RockerBogie:
    /// A published rocker-bogie by name; `RockerBogie.presets` lists them.
    ///
    /// Frame R lies on the ground under the middle of the middle wheels, with all joints at 0; that of Rocky 7, as in the
    /// papers, between the bogie joints, 0.085 m above the ground. Rocky 7 steers its two front wheels within 60 degrees; the
    /// others steer four corners, and have no published limit.
    #[doc = section!(Parameters)]
    /// name : str
    ///     One of `RockerBogie.presets()`.
    #[doc = raises!("If there is no such preset.")]
    #[staticmethod]
    fn preset[py: Python<'py>](name: &str, **)
    as "(name)" -> PyResult<Py<Self>> {
        Self::named(py, Core::preset(name))
    }

    /// Names of the published rocker-bogies, each with the source of its dimensions.
    #[doc = returns!("dict of str to str": "Name to source; iterates over the names.")]
    #[staticmethod]
    fn presets[py: Python<'py>]() -> PyResult<Bound<'py, PyDict>> {
        PRESETS.iter().map(|preset| (preset.name, preset.source)).into_py_dict(py)
    }
}
