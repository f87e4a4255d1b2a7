//! `replace` of every immutable value: the same with other arguments of its constructor.

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::controller::limits::Limits;
use crate::costmap::Costmap;
use crate::four_axle::FourAxle;
use crate::odometry::gyroscope::Gyroscope;
use crate::odometry::values::{Encoder, Noise};
use crate::profiles::{BodyTransition, IcrTransition, ModuleTransition, Profile};
use crate::suspension::Suspension;
use crate::terrain::Terrain;
use crate::wheel::Wheel;

/// The value with some arguments of the call that makes it given anew: by that call, which `__reduce__` has.
pub fn replaced<'py>(value: &Bound<'py, PyAny>, changes: Option<&Bound<'py, PyDict>>) -> PyResult<Bound<'py, PyAny>> {
    let module = value.py().import("six_wheel.kinematics.rover_edit")?;
    module.call_method(intern!(value.py(), "replace"), (value,), changes)
}

/// Gives classes `replace`, and `__replace__` for `copy.replace`.
macro_rules! replaceable {
    ($($class:ident)*) => {$(
        #[pymethods]
        impl $class {
            /// The same with some arguments of its constructor given anew.
            ///
            /// Parameters
            /// ----------
            /// **changes
            ///     Arguments of the constructor; None leaves one out, so that it has its default. What was not
            ///     given stays so, and what is not named stays as it is.
            ///
            /// Raises
            /// ------
            /// TypeError
            ///     If the constructor has no such argument; the message lists those it has.
            /// ValueError
            ///     If the constructor refuses the arguments.
            #[pyo3(signature = (**changes))]
            fn replace<'py>(
                slf: &Bound<'py, Self>,
                changes: Option<&Bound<'py, PyDict>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                replaced(slf.as_any(), changes)
            }

            /// `replace`, for `copy.replace`.
            #[pyo3(signature = (**changes))]
            fn __replace__<'py>(
                slf: &Bound<'py, Self>,
                changes: Option<&Bound<'py, PyDict>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                replaced(slf.as_any(), changes)
            }
        }
    )*};
}

replaceable! {
    BodyTransition Costmap Encoder FourAxle Gyroscope IcrTransition Limits ModuleTransition Noise Profile Suspension Terrain Wheel
}
