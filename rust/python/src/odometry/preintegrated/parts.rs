//! Columns and poses of pre-integrated motion, by their names and shapes, and how it pickles.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};
use six_wheel_numerics::error::bounded;
use six_wheel_odometry::preintegrated::space::Motion3;
use six_wheel_odometry::preintegrated::{Column, DIMENSIONS, PLANE, PreintegratedMotion, Samples};

use super::{BIAS, Change, Core, Matrix, NAMES, Preintegrated, SLIPS, Work};
use crate::convert::{OrRaise, Rows, compute, is_interrupted, numbers, raise, refuse};
use crate::rover::Rover;
use crate::state_lock::Shared;

impl Preintegrated {
    pub(super) fn with(&self, core: Core, py: Python<'_>) -> Self {
        let work = Shared::new(Work { core, replayed: None });
        Self { work, in_space: self.in_space, rover: self.rover.clone_ref(py), given: self.given.clone_ref(py) }
    }

    /// Rows of a tangent that count.
    pub(super) fn rows(&self) -> &'static [usize] {
        if self.in_space { &[0, 1, 2, 3, 4, 5] } else { &PLANE }
    }

    /// Columns by the names of `by_dimension`, `by_slip` and the bias.
    pub(super) fn columns(&self, name: &str) -> Option<Vec<Column>> {
        let wheels = self.rover.get().count();
        let each = |column: &dyn Fn(usize) -> Column| Some((0..wheels).map(column).collect());
        match name {
            "slip" => each(&Column::Slip),
            "side_slip" => each(&Column::SideSlip),
            BIAS => Some(vec![Column::Bias]),
            _ => {
                let place = NAMES.iter().position(|known| *known == name)?;
                each(&|wheel| Column::Dimension(DIMENSIONS[place], wheel))
            }
        }
    }

    pub(super) fn tables<'py>(
        &self,
        py: Python<'py>,
        names: impl Iterator<Item = &'static str>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let tables = PyDict::new(py);
        let mut work = self.work.lock(py)?;
        let replayed = work.replayed(py)?;
        for name in names {
            let by = self
                .columns(name)
                .unwrap_or_default()
                .into_iter()
                .map(|column| replayed.by(column))
                .collect::<Vec<_>>();
            let row = |&row: &usize| by.iter().map(|one| one[row]).collect();
            let table: Vec<Vec<f64>> = self.rows().iter().map(row).collect();
            tables.set_item(name, PyArray2::from_vec2(py, &table)?)?;
        }
        Ok(tables)
    }

    pub(super) fn square<'py>(&self, py: Python<'py>, matrix: impl Fn(usize, usize) -> f64) -> PyResult<Matrix<'py>> {
        let rows = self.rows();
        let table: Vec<Vec<f64>> = rows.iter().map(|&i| rows.iter().map(|&k| matrix(i, k)).collect()).collect();
        Ok(PyArray2::from_vec2(py, &table)?)
    }

    pub(super) fn pose_of(&self, argument: &'static str, value: &Bound<'_, PyAny>) -> PyResult<Motion3> {
        if !self.in_space {
            let pose = numbers(argument, value)?;
            bounded(argument, &pose).or_raise(&[])?;
            return Ok(Motion3::planar(pose));
        }
        let rows = Rows::read(argument, value, 4)?.over(&[4])?;
        let matrix = std::array::from_fn(|row| rows.flat().as_chunks::<4>().0[row]);
        Motion3::from_matrix(argument, &matrix).or_raise(&[])
    }

    pub(super) fn written<'py>(&self, py: Python<'py>, motion: &Motion3, yaw: f64) -> Bound<'py, PyAny> {
        if self.in_space {
            let rows = motion.matrix().map(Vec::from);
            return PyArray1::from_slice(py, rows.concat().as_slice())
                .reshape([4, 4])
                .map_or_else(|_| py.None().into_bound(py), Bound::into_any);
        }
        let (x, y) = (motion.translation.x, motion.translation.y);
        PyArray1::from_slice(py, &[x, y, yaw]).into_any()
    }

    /// Changes by name: their columns, and a number for each of these.
    pub(super) fn changes(&self, changes: &Bound<'_, PyDict>) -> PyResult<Vec<Change>> {
        let change = |(name, values): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            let name: String = name.extract()?;
            let Some(columns) = self.columns(&name) else {
                let all = [&NAMES[..], &SLIPS, &[BIAS]].concat().join(", ");
                return Err(refuse("changes", format!("name some of {all}"), format!("'{name}'")));
            };
            let values = Rows::read_numbers("changes", &values)?;
            let given = values.flat();
            if given.len() != 1 && given.len() != columns.len() {
                return Err(refuse("changes", format!("have 1 or {} numbers for {name}", columns.len()), given.len()));
            }
            let values = values.finite()?;
            let numbers = (0..columns.len()).map(|k| values.flat()[k.min(values.flat().len() - 1)]).collect();
            Ok(Change { name, columns, numbers })
        };
        changes.iter().map(change).collect()
    }
}

/// Stamps, readings of steering joints and of wheels, yaw rates, attitudes.
type RestoredSamples = (Vec<f64>, Vec<f64>, Vec<f64>, Vec<f64>, Vec<[f64; 4]>);

#[pymethods]
impl Preintegrated {
    /// The motion of these samples, as `__reduce__` lists them.
    #[classmethod]
    fn _restore(
        class: &Bound<'_, PyType>,
        rover: Py<Rover>,
        given: Bound<'_, PyDict>,
        samples: RestoredSamples,
        shares: [f64; 2],
    ) -> PyResult<Self> {
        let empty = class.call((rover,), Some(&given))?.cast_into::<Self>()?;
        let (stamps, steering, wheels, rates, attitudes) = samples;
        let samples = Samples { stamps, steering, wheels, rates, attitudes };
        let (py, empty) = (class.py(), empty.get());
        let core = empty.work.lock(py)?.core.with_samples(samples, shares).or_raise(&[])?;
        Ok(empty.with(core, py))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, this) = (slf.py(), slf.get());
        let core = this.work.lock(py)?.core.clone();
        let (samples, shares) = core.samples();
        let Samples { stamps, steering, wheels, rates, attitudes } = samples.clone();
        let samples: RestoredSamples = (stamps, steering, wheels, rates, attitudes);
        let fields = (&this.rover, &this.given, samples, shares).into_pyobject(py)?;
        crate::classes::restored_by(slf.as_any(), &fields.iter().collect::<Vec<_>>())
    }
}

impl Work {
    pub(super) fn replayed(&mut self, py: Python<'_>) -> PyResult<&PreintegratedMotion> {
        if self.replayed.is_none() {
            let core = &self.core;
            let replayed = compute(py, core.len(), || core.replay(is_interrupted)).map_err(|e| raise(e, &[]))?;
            self.replayed = Some(replayed);
        }
        self.replayed.as_ref().ok_or_else(|| refuse("samples", "be there", "none"))
    }
}
