//! `RockerBogie.frames` and `RockerBogie.jacobians`, and how joint angles are read.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::suspension::{self as core, FRAMES, RockerBogie as Core, WHEELS};

use super::rocker_bogie::RockerBogie;
use crate::convert::{Output, Rows, compute_rows, memory, together};
use crate::workers::workers;

/// The angle of the left rocker and those of the bogies.
pub fn rocker_and_bogies([rho, left, right]: [f64; 3]) -> (f64, [f64; 2]) {
    (rho, [left, right])
}

/// One row of all joints per sample; steering angles default to 0.
fn with_steering(joints: &Rows<'_>, steering: Option<&Rows<'_>>, steered: usize) -> PyResult<Vec<f64>> {
    let straight = vec![0.0; steered];
    let mut rows = memory::room(memory::count(&[joints.count(), 3 + steered])?)?;
    for (k, angles) in joints.triples().iter().enumerate() {
        rows.extend(angles);
        rows.extend(steering.map_or(&straight[..], |angles| &angles.flat()[k * steered..][..steered]));
    }
    Ok(rows)
}

/// A kernel of the core that fills an array from rows of joint angles.
type Kernel = fn(&Core, &[f64], &mut [f64], Workers) -> Result<(), Error>;

impl RockerBogie {
    /// One array per name, each with the leading axes of the angles and these last ones.
    fn by_name<'py>(
        &self,
        py: Python<'py>,
        angles: (&Bound<'py, PyAny>, Option<&Bound<'py, PyAny>>),
        names: &[&str],
        last: [usize; 2],
        level: Kernel,
        workers: Workers,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (joints, steering) = angles;
        let mut joints = Rows::read("joints", joints, 3)?;
        let mut steering = Rows::read_optional("steering", steering, self.steered().len())?;
        let leading = together([&mut joints, &mut steering])?;
        let rows = with_steering(&joints, steering.as_ref(), self.steered().len())?;
        let shape: Vec<usize> = [names.len()].into_iter().chain(leading.iter().copied()).chain(last).collect();
        let mut block = Output::fresh(py, &shape)?;
        let target = block.flat();
        compute_rows(py, joints.count(), &leading, || level(&self.0, &rows, target, workers))?;
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
    #[doc = section!(Parameters: rocker_joints, steering, threads)]
    #[doc = returns!("dict of str to ndarray, shape (..., 4, 4)")]
    ///     Name to the transform that takes coordinates of the frame to those of R.
    #[doc = raises!("If an angle is not finite or a shape does not fit.")]
    ///
    /// Source: M. Tarokh, G. McDermott, S. Hayati, J. Hung, Kinematic modeling of a high mobility Mars rover,
    /// ICRA 1999.
    fn frames[&self, py: Python<'py>](joints, steering=None, *, threads: Option<i64> = None)
    -> PyResult<Bound<'py, PyDict>> {
        let workers = workers(threads, None)?;
        let names = self.0.links().map(|link| link.frame);
        self.by_name(py, (joints, steering), &names, [4, 4], core::frames, workers)
    }

    /// Derivatives of the wheel centres by the joint angles.
    #[doc = section!(Parameters: rocker_joints, steering, threads)]
    #[doc = returns!("dict of str to ndarray, shape (..., 3, joints)")]
    ///     A1 to A6 to the derivative of the wheel's centre in R [m/rad] by each of `joint_names`. Steering turns a
    ///     wheel about its centre: these columns are 0.
    #[doc = raises!("If an angle is not finite or a shape does not fit.")]
    fn jacobians[&self, py: Python<'py>](joints, steering=None, *, threads: Option<i64> = None)
    -> PyResult<Bound<'py, PyDict>> {
        let workers = workers(threads, None)?;
        let names = self.0.links().map(|link| link.frame);
        let wheels = &names[FRAMES - WHEELS.len()..];
        let last = [3, self.0.joint_count()];
        self.by_name(py, (joints, steering), wheels, last, core::jacobians, workers)
    }
}
