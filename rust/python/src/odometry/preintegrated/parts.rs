//! Columns and poses of pre-integrated motion, by their names and shapes.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use six_wheel_odometry::preintegrated::space::Motion3;
use six_wheel_odometry::preintegrated::{Column, DIMENSIONS, PLANE, PreintegratedMotion};

use super::{BIAS, Core, Matrix, NAMES, Named, Preintegrated, SLIPS};
use crate::convert::{OrRaise, Rows, Scalars, compute, is_interrupted, numbers, raise, refuse};

impl Preintegrated {
    pub(super) fn with(&self, core: Core, py: Python<'_>) -> Self {
        Self { core, rover: self.rover.clone_ref(py), given: self.given.clone_ref(py), replayed: None }
    }

    pub(super) fn in_space(&self) -> bool {
        self.core.options().in_space
    }

    /// Rows of a tangent that count.
    pub(super) fn rows(&self) -> &'static [usize] {
        if self.in_space() { &[0, 1, 2, 3, 4, 5] } else { &PLANE }
    }

    pub(super) fn replayed(&mut self, py: Python<'_>) -> PyResult<&PreintegratedMotion> {
        if self.replayed.is_none() {
            let core = &self.core;
            let replayed = compute(py, core.len(), || core.replay(is_interrupted)).map_err(|e| raise(e, &[]))?;
            self.replayed = Some(replayed);
        }
        self.replayed.as_ref().ok_or_else(|| refuse("samples", "be there", "none"))
    }

    /// Columns by the names of `by_dimension`, `by_slip` and the bias.
    pub(super) fn columns(&self, name: &str) -> Option<Vec<Column>> {
        let wheels = self.core.rover().wheels().len();
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

    pub(super) fn table<'py>(&mut self, py: Python<'py>, columns: &[Column]) -> PyResult<Matrix<'py>> {
        let rows = self.rows();
        let replayed = self.replayed(py)?;
        let by: Vec<_> = columns.iter().map(|&column| replayed.by(column)).collect();
        let table: Vec<Vec<f64>> = rows.iter().map(|&row| by.iter().map(|one| one[row]).collect()).collect();
        Ok(PyArray2::from_vec2(py, &table)?)
    }

    pub(super) fn tables<'py>(
        &mut self,
        py: Python<'py>,
        names: impl Iterator<Item = &'static str>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let tables = PyDict::new(py);
        for name in names {
            let columns = self.columns(name).unwrap_or_default();
            tables.set_item(name, self.table(py, &columns)?)?;
        }
        Ok(tables)
    }

    pub(super) fn square<'py>(&self, py: Python<'py>, matrix: impl Fn(usize, usize) -> f64) -> PyResult<Matrix<'py>> {
        let rows = self.rows();
        let table: Vec<Vec<f64>> = rows.iter().map(|&i| rows.iter().map(|&k| matrix(i, k)).collect()).collect();
        Ok(PyArray2::from_vec2(py, &table)?)
    }

    pub(super) fn pose_of(&self, argument: &'static str, value: &Bound<'_, PyAny>) -> PyResult<Motion3> {
        if !self.in_space() {
            let pose = numbers(argument, value)?;
            if pose.iter().any(|part| !part.is_finite()) {
                return Err(refuse(argument, "be finite", &format!("{pose:?}")));
            }
            return Ok(Motion3::planar(pose));
        }
        let rows = Rows::read(argument, value, 4)?;
        rows.check_leading(argument, &[4])?;
        let matrix = std::array::from_fn(|row| rows.flat().as_chunks::<4>().0[row]);
        Motion3::from_matrix(argument, &matrix).or_raise(&[])
    }

    pub(super) fn written<'py>(&self, py: Python<'py>, motion: &Motion3, yaw: f64) -> Bound<'py, PyAny> {
        if self.in_space() {
            let rows = motion.matrix().map(Vec::from);
            return PyArray1::from_slice(py, rows.concat().as_slice())
                .reshape([4, 4])
                .map_or_else(|_| py.None().into_bound(py), Bound::into_any);
        }
        let (x, y) = (motion.translation.x, motion.translation.y);
        PyArray1::from_slice(py, &[x, y, yaw]).into_any()
    }

    /// Changes by name, as a change of the motion in its tangent.
    pub(super) fn change(&mut self, py: Python<'_>, changes: &Bound<'_, PyDict>) -> PyResult<([f64; 6], Named)> {
        let (mut sum, mut wanted) = ([0.0; 6], Vec::new());
        for (name, values) in changes {
            let name: String = name.extract()?;
            let Some(columns) = self.columns(&name) else {
                let all = [&NAMES[..], &SLIPS, &[BIAS]].concat().join(", ");
                let rule = format!("name some of {all}");
                return Err(refuse("changes", &rule, &format!("'{name}'")));
            };
            let values = Scalars::read("changes", &values)?;
            let given = values.flat();
            if given.len() != 1 && given.len() != columns.len() {
                let rule = format!("have 1 or {} numbers for {name}", columns.len());
                return Err(refuse("changes", &rule, &given.len().to_string()));
            }
            values.check_finite("changes")?;
            let replayed = self.replayed(py)?;
            for (k, &column) in columns.iter().enumerate() {
                let by = replayed.by(column);
                let value = given[k.min(given.len() - 1)];
                for (sum, part) in sum.iter_mut().zip(by.iter()) {
                    *sum += part * value;
                }
            }
            wanted.push((name, columns));
        }
        Ok((sum, wanted))
    }
}
