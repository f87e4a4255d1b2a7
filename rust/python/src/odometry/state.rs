//! `six_wheel.OdometryState`.

use std::ops::Deref;

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyString;
use six_wheel_kinematics::estimate::{Method, worst_wheel};
use six_wheel_odometry::Odometry;

use crate::convert::refuse;
use crate::fastcall::Renewed;
use crate::rover::Rover;

/// Pose and twist of the rover after a sample, with their covariances.
///
/// Python cannot change it; what nobody holds any more is written anew by `Odometry` (`Spares`).
#[pyclass(frozen, module = "six_wheel")]
pub struct OdometryState(Renewed<Known>);

/// The estimate after a sample.
pub struct Known {
    stamp: Option<f64>,
    pose: [f64; 3],
    twist: [f64; 3],
    velocity: [f64; 3],
    /// Upper halves, row by row.
    covariance: [f64; 6],
    twist_covariance: [f64; 6],
    residual: PerWheel,
    /// None where all count alike.
    weights: Option<Box<[f64]>>,
    health: u32,
    rover: Py<Rover>,
}

/// Wheels whose numbers are kept in the object itself.
const FEW: usize = 8;

/// One number per wheel.
enum PerWheel {
    Few([f64; FEW], usize),
    Many(Box<[f64]>),
}

impl From<&[f64]> for PerWheel {
    fn from(numbers: &[f64]) -> Self {
        let mut few = [0.0; FEW];
        match few.get_mut(..numbers.len()) {
            Some(places) => {
                places.copy_from_slice(numbers);
                Self::Few(few, numbers.len())
            }
            None => Self::Many(numbers.into()),
        }
    }
}

impl PerWheel {
    /// As many other numbers.
    #[inline]
    fn renew(&mut self, numbers: &[f64]) {
        let places = match self {
            Self::Few(few, count) => &mut few[..*count],
            Self::Many(many) => many,
        };
        for (place, number) in places.iter_mut().zip(numbers) {
            *place = *number;
        }
    }
}

impl Deref for PerWheel {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        match self {
            Self::Few(numbers, count) => &numbers[..*count],
            Self::Many(numbers) => numbers,
        }
    }
}

impl Deref for OdometryState {
    type Target = Known;

    fn deref(&self) -> &Known {
        &self.0
    }
}

impl OdometryState {
    pub fn of(odometry: &Odometry, rover: Py<Rover>) -> Self {
        let mut known = Known {
            stamp: None,
            pose: [0.0; 3],
            twist: [0.0; 3],
            velocity: [0.0; 3],
            covariance: [0.0; 6],
            twist_covariance: [0.0; 6],
            residual: odometry.residual().into(),
            weights: None,
            health: 0,
            rover,
        };
        known.renew(odometry);
        Self(Renewed::new(known))
    }
}

impl Known {
    /// Takes over the numbers of another sample of the same rover.
    #[inline]
    fn renew(&mut self, odometry: &Odometry) {
        let alike = odometry.settings().method == Method::LeastSquares;
        self.stamp = odometry.stamp();
        self.pose = odometry.pose().into();
        self.twist = odometry.twist().into();
        self.velocity = odometry.velocity().into();
        [self.covariance, self.twist_covariance] = odometry.upper_halves();
        self.residual.renew(odometry.residual());
        self.weights = (!alike).then(|| odometry.weights().into());
        self.health = odometry.health().0;
    }
}

/// The last states that were handed out. Those that nobody else holds are handed out again with new numbers: that
/// takes a third of the time of a new object. A loop holds one while it asks for the next, so there are two.
#[derive(Default)]
pub struct Spares {
    states: [Option<Py<OdometryState>>; 2],
    next: usize,
}

impl Spares {
    /// The state after the last sample.
    #[inline]
    pub fn state<'py>(
        &mut self,
        odometry: &Odometry,
        rover: &Py<Rover>,
        py: Python<'py>,
    ) -> PyResult<Bound<'py, OdometryState>> {
        for state in self.states.iter_mut().flatten() {
            if let Some(free) = Renewed::of(state, py, |state| &state.0) {
                free.renew(odometry);
                return Ok(state.bind(py).clone());
            }
        }
        let state = Bound::new(py, OdometryState::of(odometry, rover.clone_ref(py)))?;
        self.states[self.next] = Some(state.clone().unbind());
        self.next = (self.next + 1) % self.states.len();
        Ok(state)
    }
}

/// A symmetric matrix from its upper half.
fn whole([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> [[f64; 3]; 3] {
    [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
}

/// A covariance of x, y and yaw in ROS order: x, y, z, roll, pitch, yaw.
fn spatial<'py>(py: Python<'py>, planar: &[[f64; 3]; 3], unmeasured: f64) -> PyResult<Bound<'py, PyArray2<f64>>> {
    const PLACES: [usize; 3] = [0, 1, 5];
    if unmeasured.is_nan() || unmeasured < 0.0 {
        return Err(refuse("unmeasured", "be a variance, 0 or more", unmeasured));
    }
    let mut matrix = [[0.0; 6]; 6];
    for (i, row) in planar.iter().enumerate() {
        for (k, value) in row.iter().enumerate() {
            matrix[PLACES[i]][PLACES[k]] = *value;
        }
    }
    for (i, row) in matrix.iter_mut().enumerate() {
        if !PLACES.contains(&i) {
            row[i] = unmeasured;
        }
    }
    self::matrix(py, matrix.as_flattened(), 6)
}

/// Numbers as a matrix of this width.
pub fn matrix<'py>(py: Python<'py>, numbers: &[f64], width: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
    PyArray1::from_slice(py, numbers).reshape([numbers.len() / width, width])
}

getters! { OdometryState, self, py:
    /// The rover.
    rover: Py<Rover> = self.rover.clone_ref(py);
    /// When the sample was taken [s]; None before the first one.
    stamp: Option<f64> = self.stamp;
    /// ``[x, y, yaw]`` in the world, the yaw with its full turns, shape (3,) [m, m, rad].
    pose: Bound<'py, PyArray1<f64>> = PyArray1::from_slice(py, &self.pose);
    /// The yaw, with its full turns [rad].
    yaw: f64 = self.pose[2];
    /// Mean ``[vx, vy, omega]`` over the last step in body axes, shape (3,) [m/s, m/s, rad/s].
    twist: Bound<'py, PyArray1<f64>> = PyArray1::from_slice(py, &self.twist);
    /// The twist through a first-order filter of time constant `smoothing`, shape (3,) [m/s, m/s, rad/s].
    velocity: Bound<'py, PyArray1<f64>> = PyArray1::from_slice(py, &self.velocity);
    /// Covariance of the pose in world axes, shape (3, 3) [m², m rad, rad²].
    covariance: PyResult<Bound<'py, PyArray2<f64>>> = matrix(py, whole(self.covariance).as_flattened(), 3);
    /// Covariance of the twist in body axes, shape (3, 3); infinite variances where nothing is known of the twist: before
    /// the first step, and after a command or a pose from outside.
    twist_covariance: PyResult<Bound<'py, PyArray2<f64>>> = matrix(py, whole(self.twist_covariance).as_flattened(), 3);
    /// Speed at which each wheel's contact slid over the last step, shape (wheels,) [m/s].
    residuals: Bound<'py, PyArray1<f64>> = PyArray1::from_slice(py, &self.residual);
    /// Flags of the sample, an `OdometryHealth`.
    health: PyResult<Bound<'py, PyAny>> = py.import("six_wheel.kinematics.odometry")?.getattr("OdometryHealth")?.call1((self.health,));
    /// Say of each wheel over the last step, shape (wheels,), 0 to 1.
    weights: Bound<'py, PyArray1<f64>> = {
        match &self.weights {
            Some(weights) => PyArray1::from_slice(py, weights),
            None => PyArray1::from_vec(py, vec![1.0; self.residual.len()]),
        }
    };
    /// Name of the wheel that disagrees most; None if none does.
    worst_wheel: Option<Bound<'py, PyString>> = {
        let worst = worst_wheel(&self.residual)?;
        Some(PyString::new(py, &self.rover.get().core.wheels()[worst].name))
    };
}

methods! { OdometryState:
    /// `covariance` in the order of ROS messages: x, y, z, roll, pitch, yaw, shape (6, 6).
    #[doc = section!(Parameters)]
    /// unmeasured : float, default 1e6
    ///     Variance of z [m²], roll and pitch [rad²], of which wheels on a plane say nothing.
    #[doc = raises!("If `unmeasured` is no number, or a negative one.")]
    fn covariance_6x6[&self, py: Python<'py>](unmeasured: f64 = 1e6) -> PyResult<Bound<'py, PyArray2<f64>>> {
        spatial(py, &whole(self.covariance), unmeasured)
    }

    /// `twist_covariance` in the order of ROS messages, shape (6, 6).
    #[doc = section!(Parameters)]
    /// unmeasured : float, default 1e6
    ///     Variance of the rates along z [m²/s²], about x and about y [rad²/s²], and of all that nothing is known of.
    #[doc = raises!("If `unmeasured` is no number, or a negative one.")]
    fn twist_covariance_6x6[&self, py: Python<'py>](unmeasured: f64 = 1e6) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let known = self.twist_covariance.map(|value| if value.is_finite() { value } else { unmeasured });
        spatial(py, &whole(known), unmeasured)
    }
}

pickled_by_fields! { OdometryState, this, py:
    (
        stamp: Option<f64> = this.stamp,
        poses: [[f64; 3]; 3] = [this.pose, this.twist, this.velocity],
        covariances: [[f64; 6]; 2] = [this.covariance, this.twist_covariance],
        residual: Vec<f64> = this.residual.to_vec(),
        weights: Option<Vec<f64>> = this.weights.as_deref().map(<[f64]>::to_vec),
        health: u32 = this.health,
        rover: Py<Rover> = &this.rover,
    )
    {
        let ([pose, twist, velocity], [covariance, twist_covariance]) = (poses, covariances);
        let (residual, weights) = (residual.as_slice().into(), weights.map(Vec::into_boxed_slice));
        let known = Known {
            stamp, pose, twist, velocity, covariance, twist_covariance, residual, weights, health, rover
        };
        Self(Renewed::new(known))
    }
}

#[pymethods]
impl OdometryState {
    fn __repr__(&self) -> String {
        let [xx, _, _, yy, _, zz] = self.covariance;
        let deviations = [xx, yy, zz].map(f64::sqrt);
        let [x, y, yaw] = self.pose;
        format!(
            "OdometryState(x={x:.4} ± {} m, y={y:.4} ± {} m, yaw={yaw:.4} ± {} rad)",
            Short(deviations[0]),
            Short(deviations[1]),
            Short(deviations[2])
        )
    }
}

/// A number to two digits.
pub struct Short(pub f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0 == 0.0 || !self.0.is_finite() {
            return write!(f, "{}", self.0);
        }
        let digits = (1.0 - self.0.abs().log10().floor()).max(0.0) as usize;
        write!(f, "{:.*}", digits, self.0)
    }
}
