//! `RockerBogie.frames` and `RockerBogie.jacobians`, and how joint angles are read.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::suspension::{self as core, FRAMES, RockerBogie as Core, WHEELS};

use super::rocker_bogie::RockerBogie;
use crate::convert::{Named, Output, Rows, Scalars, compute, given, memory, named, raise, refuse_shape, together};
use crate::workers::any_workers;

/// Angles of the suspension, one row of (rho, beta_1, beta_2) per sample.
pub struct Joints<'py> {
    pub rho: Scalars<'py>,
    pub beta: Rows<'py>,
}

impl<'py> Joints<'py> {
    /// Reads `rho` and `beta`.
    pub fn read(rho: &Bound<'py, PyAny>, beta: &Bound<'py, PyAny>) -> PyResult<Self> {
        let beta = Rows::read("beta", beta, 2)?;
        let rho = Scalars::read("rho", rho)?;
        Ok(Self { rho, beta })
    }

    /// Both, to be brought to the same leading axes.
    pub fn both(&mut self) -> [Named<'_>; 2] {
        [named("beta", &mut self.beta), named("rho", &mut self.rho)]
    }

    /// Reads the angles of one sample.
    pub fn read_one(rho: &Bound<'py, PyAny>, beta: &Bound<'py, PyAny>) -> PyResult<(f64, [f64; 2])> {
        let mut joints = Self::read(rho, beta)?;
        together(joints.both())?;
        if !joints.beta.is_single() {
            return Err(refuse_shape("beta", "be one row of shape (2,)", &joints.beta.shape()));
        }
        Ok(joints.row(0))
    }

    /// Both angles of a sample.
    pub fn row(&self, k: usize) -> (f64, [f64; 2]) {
        (self.rho.at(k), self.beta.pairs()[k])
    }

    /// One row of all joints per sample; steering angles default to 0.
    pub fn with_steering(&self, psi: Option<&Rows<'_>>, steered: usize) -> PyResult<Vec<f64>> {
        let straight = vec![0.0; steered];
        let mut rows = memory::room(memory::count(&[self.beta.count(), 3 + steered])?)?;
        for k in 0..self.beta.count() {
            let (rho, beta) = self.row(k);
            rows.extend([rho, beta[0], beta[1]]);
            rows.extend(psi.map_or(&straight[..], |psi| &psi.flat()[k * steered..][..steered]));
        }
        Ok(rows)
    }

    /// The exception of a core error, indexed as the argument at fault is.
    pub fn raise(&self, error: Error) -> PyErr {
        let one = error.argument == "rho" && self.rho.shape.is_empty();
        raise(error, if one { &[] } else { &self.beta.leading })
    }
}

/// A kernel of the core that fills an array from rows of joint angles.
type Kernel = fn(&Core, &[f64], &mut [f64], Workers) -> Result<(), Error>;

impl RockerBogie {
    /// One array per name, each with the leading axes of the angles and these last ones.
    fn by_name<'py>(
        &self,
        py: Python<'py>,
        angles: (&Bound<'py, PyAny>, &Bound<'py, PyAny>, Option<&Bound<'py, PyAny>>),
        names: &[&str],
        last: [usize; 2],
        level: Kernel,
        workers: Workers,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (rho, beta, psi) = angles;
        let mut joints = Joints::read(rho, beta)?;
        let mut psi = Rows::read_optional("psi", psi, self.steered().len())?;
        let all = joints.both().into_iter().chain(given("psi", &mut psi));
        let leading = together(all)?;
        let rows = joints.with_steering(psi.as_ref(), self.steered().len())?;
        let shape: Vec<usize> = [names.len()].into_iter().chain(leading.iter().copied()).chain(last).collect();
        let mut block = Output::fresh(py, &shape)?;
        let target = block.flat();
        compute(py, joints.beta.count(), || level(&self.0, &rows, target, workers))
            .map_err(|error| joints.raise(error))?;
        let block = block.finish()?;
        let arrays = PyDict::new(py);
        for (i, name) in names.iter().enumerate() {
            arrays.set_item(name, block.get_item(i)?)?;
        }
        Ok(arrays)
    }
}

methods! { RockerBogie:
    /// Homogeneous transforms of all frames of the chain.
    ///
    /// D is the differential, B1 and B2 the bogies, S1 to S6 the mounts of the wheels and A1 to A6 their
    /// axles, with the origin in the wheel's centre, x where the wheel rolls and y along its axle. Odd is left,
    /// even right; 1 and 2 are in front, 3 and 4 in the middle, 5 and 6 behind.
    ///
    /// Parameters
    /// ----------
    /// rho : float or array_like, shape (...)
    ///     Angle of the left rocker [rad]; the right one has ``-rho``.
    /// beta : array_like, shape (..., 2)
    ///     Angles of the left and the right bogie against their rockers [rad].
    /// psi : array_like, shape (..., steered wheels), optional
    ///     Steering angles [rad], default 0.
    /// threads : int, optional
    ///     Threads at most; default that of `set_default_threads`.
    ///
    /// Returns
    /// -------
    /// dict of str to ndarray, shape (..., 4, 4)
    ///     Name to the transform that takes coordinates of the frame to those of R.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an angle is not finite or a shape does not fit.
    ///
    /// Source: M. Tarokh, G. McDermott, S. Hayati, J. Hung, Kinematic modeling of a high mobility Mars rover,
    /// ICRA 1999.
    fn frames[&self, py: Python<'py>](rho, beta, psi=None, *, threads: Option<i64> = None)
    -> PyResult<Bound<'py, PyDict>> {
        let workers = any_workers(threads, None)?;
        let names = self.0.links().map(|link| link.frame);
        self.by_name(py, (rho, beta, psi), &names, [4, 4], core::frames, workers)
    }

    /// Derivatives of the wheel centres by the joint angles.
    ///
    /// Parameters
    /// ----------
    /// rho : float or array_like, shape (...)
    ///     Angle of the left rocker [rad]; the right one has ``-rho``.
    /// beta : array_like, shape (..., 2)
    ///     Angles of the left and the right bogie against their rockers [rad].
    /// psi : array_like, shape (..., steered wheels), optional
    ///     Steering angles [rad], default 0.
    /// threads : int, optional
    ///     Threads at most; default that of `set_default_threads`.
    ///
    /// Returns
    /// -------
    /// dict of str to ndarray, shape (..., 3, joints)
    ///     A1 to A6 to the derivative of the wheel's centre in R [m/rad] by each of `joint_names`. Steering turns a
    ///     wheel about its centre: these columns are 0.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an angle is not finite or a shape does not fit.
    fn jacobians[&self, py: Python<'py>](rho, beta, psi=None, *, threads: Option<i64> = None)
    -> PyResult<Bound<'py, PyDict>> {
        let workers = any_workers(threads, None)?;
        let names = self.0.links().map(|link| link.frame);
        let wheels = &names[FRAMES - WHEELS.len()..];
        let last = [3, self.0.joint_count()];
        self.by_name(py, (rho, beta, psi), wheels, last, core::jacobians, workers)
    }
}
