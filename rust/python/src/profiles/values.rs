//! One number, or one for each axis.

use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::convert::{Scalars, memory, refuse, refuse_shape};

/// One number, or one per axis.
pub struct Values {
    pub numbers: Vec<f64>,
    pub is_vector: bool,
}

impl Values {
    pub fn read(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let scalars = Scalars::read(argument, value)?;
        match scalars.shape.as_slice() {
            [] | [_] if !scalars.flat().is_empty() => Ok(Self {
                numbers: memory::gathered(scalars.flat().iter().copied())?,
                is_vector: !scalars.shape.is_empty(),
            }),
            shape => {
                let rule = "be one number or have shape (axes,)";
                Err(refuse_shape(argument, rule, shape))
            }
        }
    }

    pub fn or(argument: &str, value: Option<&Bound<'_, PyAny>>, default: f64) -> PyResult<Self> {
        value.map_or_else(|| Ok(Self { numbers: vec![default], is_vector: false }), |value| Self::read(argument, value))
    }

    pub fn of_axis(&self, axis: usize) -> f64 {
        self.numbers[if self.is_vector { axis } else { 0 }]
    }

    pub fn to_python<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        // Plus zero: no minus zero.
        let numbers: Vec<f64> = self.numbers.iter().map(|number| number + 0.0).collect();
        if self.is_vector {
            Ok(PyTuple::new(py, numbers)?.into_any())
        } else {
            Ok(numbers[0].into_pyobject(py)?.into_any())
        }
    }
}

/// Number of axes of arguments that are one number or one per axis, and whether any is the latter.
pub fn axes(values: &[(&str, Values)]) -> PyResult<(usize, bool)> {
    let mut count: Option<usize> = None;
    for (argument, values) in values.iter().filter(|(_, values)| values.is_vector) {
        let (known, own) = (count.unwrap_or(values.numbers.len()), values.numbers.len());
        if known != own {
            let rule = format!("be one number or have shape ({known},)");
            return Err(refuse(argument, &rule, &format!("shape ({own},)")));
        }
        count = Some(own);
    }
    Ok((count.unwrap_or(1), count.is_some()))
}
