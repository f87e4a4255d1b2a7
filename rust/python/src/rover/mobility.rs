//! `six_wheel.Mobility` and `Rover.mobility`.

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use six_wheel_kinematics::mobility::Mobility as Core;

use super::Rover;
use crate::convert::{OrRaise, Rows};

/// Mobility of a rover at given steering angles, from the rank of its constraints.
///
/// Source: G. Campion, G. Bastin, B. d'Andrea-Novel, IEEE Transactions on Robotics and Automation 12(1), 1996.
#[pyclass(frozen, module = "six_wheel")]
pub struct Mobility(pub Core);

getters! { Mobility, self, py:
    /// Dimension of the motions that no wheel resists; 0 if the rover is locked.
    degree_of_mobility: usize = self.0.degree_of_mobility;
    /// Number of steering directions that can be chosen independently.
    degree_of_steerability: usize = self.0.degree_of_steerability;
    /// Degree of mobility and degree of steerability together.
    degree_of_manoeuvrability: usize = self.0.degree_of_manoeuvrability();
    /// Rank of the no-side-slip rows.
    rank: usize = self.0.rank;
    /// The smallest singular value that is not zero: how far a locked rover is from moving, or a mobile
    /// one from losing a constraint; 0 without constraints.
    margin: f64 = self.0.margin();
    /// Singular values of the no-side-slip rows, largest first, shape (3,).
    singular_values: Bound<'py, PyArray1<f64>> = PyArray1::from_slice(py, &self.0.singular_values);
    /// The free motions, unit twists ``[vx, vy, omega]``, shape (degree_of_mobility, 3).
    motion: PyResult<Bound<'py, PyArray2<f64>>> = {
        let rows: Vec<f64> = self.0.motions.iter().flat_map(|twist| <[f64; 3]>::from(*twist)).collect();
        use numpy::PyArrayMethods;
        PyArray1::from_vec(py, rows).reshape([self.0.motions.len(), 3])
    };
}

pickled_by_fields! { Mobility, this, py:
    (
        degree_of_mobility: usize = this.0.degree_of_mobility,
        degree_of_steerability: usize = this.0.degree_of_steerability,
        rank: usize = this.0.rank,
        singular_values: [f64; 3] = this.0.singular_values,
        motions: Vec<[f64; 3]> = this.0.motions.iter().map(|twist| <[f64; 3]>::from(*twist)).collect::<Vec<_>>(),
    )
    Self(Core {
        degree_of_mobility,
        degree_of_steerability,
        rank,
        singular_values,
        motions: motions.into_iter().map(Into::into).collect(),
    })
}

#[pymethods]
impl Mobility {
    fn __repr__(&self) -> String {
        format!(
            "Mobility(degree_of_mobility={}, degree_of_steerability={}, rank={}, margin={:?})",
            self.0.degree_of_mobility,
            self.0.degree_of_steerability,
            self.0.rank,
            self.0.margin()
        )
    }
}

methods! { Rover:
    /// Mobility of the rover at given steering angles, from the rank of its constraints.
    ///
    /// Unsteered wheels on several axles count with their mean axle; wheels with rollers and castors constrain
    /// nothing. Angles that are concurrent to 1e-6 m of side slip per metre count as concurrent.
    #[doc = section!(Parameters)]
    /// steering : array_like, shape (steered wheels,), optional
    ///     Steering angles [rad]; default angles that agree on a turn.
    #[doc = returns!("Mobility")]
    ///     `degree_of_mobility`, `degree_of_steerability`, `degree_of_manoeuvrability`, `rank`,
    ///     `singular_values`, `motion`, `margin`.
    #[doc = raises!("If an angle is not finite or the shape does not fit.")]
    ///
    /// Source: G. Campion, G. Bastin, B. d'Andrea-Novel, IEEE Transactions on Robotics and Automation 12(1), 1996.
    fn mobility[&self](steering=None) -> PyResult<Mobility> {
        let steering = Rows::read_beside("steering", steering, self.joints(), &[])?;
        let mobility = self.core.mobility(steering.as_ref().map(Rows::flat));
        mobility.map(Mobility).or_raise(&[])
    }
}
