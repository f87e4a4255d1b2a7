//! Gain of a pose from outside, in the plane and in space.

use nalgebra::SMatrix;

use six_wheel_numerics::jacobi::Jacobi;

/// Gain of a measurement `H e` of a pose's error e, some of whose components may be unknown.
#[derive(Clone, Copy, Debug)]
pub struct PoseGain<const N: usize> {
    /// `K = P Hᵀ (H P Hᵀ + R)⁻¹`
    pub gain: SMatrix<f64, N, N>,
    /// H, zero in the rows of unknown components.
    pub by_error: SMatrix<f64, N, N>,
    /// R, zero for unknown components.
    pub noise: SMatrix<f64, N, N>,
}

impl<const N: usize> PoseGain<N> {
    /// For a pose with covariance P and a measurement H with covariance R, infinite for unknown components.
    pub fn new(covariance: &SMatrix<f64, N, N>, by_error: &SMatrix<f64, N, N>, measured: &SMatrix<f64, N, N>) -> Self {
        let mut known = SMatrix::zeros();
        let mut noise = *measured;
        for k in 0..N {
            if measured[(k, k)].is_finite() {
                known[(k, k)] = 1.0;
            } else {
                noise.row_mut(k).fill(0.0);
                noise.column_mut(k).fill(0.0);
            }
        }
        let by_error = known * by_error;
        let cross = covariance * by_error.transpose();
        let innovation = by_error * cross + noise + (SMatrix::identity() - known);
        let gain = if noise.iter().all(|part| *part == 0.0) {
            // An exact measurement: measured components become exact, the others are corrected by their correlation.
            innovation.cholesky().map_or(known, |innovation| cross * innovation.inverse())
        } else {
            cross * Jacobi::new(&innovation).inverse(f64::EPSILON * innovation.amax())
        };
        Self { gain, by_error, noise }
    }
}
