//! Integration of the samples of a motion with all derivatives.
//!
//! A change d of one displacement in body axes changes the motion to `exp(B d) delta`, with `B =
//! adjoint(begin_from_step) left_jacobian(displacement)`, which later steps do not change: in axes of the beginning,
//! covariances and derivatives are sums over the steps. They are transformed to axes of the end once, after the last
//! step.

use nalgebra::{Matrix3, Matrix6, Matrix6x3, Quaternion, UnitQuaternion, Vector3, Vector6};
use six_wheel_numerics::threads::workers::{BETWEEN_CHECKS, IsInterrupted};

use pulp::Scalar;

use super::space::{Motion3, left_jacobian, right_jacobian};
use super::{ErrorFrame, PLANE, Preintegrated};
use crate::health::Health;
use crate::motion::Motion as StepMotion;
use crate::planar::Odometry;
use crate::settings::Readings;
use crate::settings::gyroscope::mean_rate;
use crate::settings::quantities::{Column, DIMENSIONS};
use crate::step::terms::gyroscope_deviation;
use six_wheel_kinematics::rover::Rover;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::Lanes;

/// A motion with its covariance and derivatives, in axes of its end.
#[derive(Clone, Debug)]
pub struct PreintegratedMotion {
    /// `begin_from_end`
    pub motion: Motion3,
    /// Its yaw with full turns, in the plane [rad].
    pub yaw: f64,
    /// Covariance of its tangent at the end.
    pub covariance: Matrix6<f64>,
    /// Derivatives of its tangent at the end.
    pub columns: Vec<(Column, Vector6<f64>)>,
}

impl PreintegratedMotion {
    /// The covariance in another frame.
    pub fn covariance_in(&self, frame: ErrorFrame) -> Matrix6<f64> {
        let change = match frame {
            ErrorFrame::End => return self.covariance,
            ErrorFrame::Begin => self.motion.adjoint(),
            ErrorFrame::Coordinates => {
                let rotation = Motion3 { translation: Vector3::zeros(), ..self.motion };
                rotation.adjoint()
            }
        };
        change * self.covariance * change.transpose()
    }

    /// The motion after a change of its tangent at the end, and its yaw [rad].
    pub fn corrected(&self, change: [f64; 6]) -> (Motion3, f64) {
        let moved = self.motion.compose(&Motion3::exp(&change.into()));
        (moved, self.yaw + change[5])
    }

    /// Derivative by one quantity; zero if the motion does not depend on it.
    #[inline]
    pub fn by(&self, quantity: Column) -> Vector6<f64> {
        let found = self.columns.iter().find(|(column, _)| *column == quantity);
        found.map_or_else(Vector6::zeros, |(_, by)| *by)
    }
}

/// Sums over the steps, in axes of the beginning.
struct Sums {
    /// Covariance by errors that no later step shares.
    settled: Matrix6<f64>,
    /// Errors of the motion by the readings that the next step shares.
    carried: Vec<Vector6<f64>>,
    /// Derivatives.
    columns: Vec<(Column, Vector6<f64>)>,
}

fn columns(rover: &Rover) -> Vec<(Column, Vector6<f64>)> {
    let zero = Vector6::zeros();
    let mut columns = Vec::new();
    for wheel in 0..rover.wheels().len() {
        let dimensions = DIMENSIONS.map(|quantity| (Column::Dimension(quantity, wheel), zero));
        columns.extend(dimensions);
        columns.push((Column::Slip(wheel), zero));
        columns.push((Column::SideSlip(wheel), zero));
    }
    columns.push((Column::Bias, zero));
    columns
}

fn rotation([x, y, z, w]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
}

/// The matrix that maps a displacement in the plane to a tangent in space.
fn embedding() -> Matrix6x3<f64> {
    let mut embedding = Matrix6x3::zeros();
    for (k, row) in PLANE.into_iter().enumerate() {
        embedding[(row, k)] = 1.0;
    }
    embedding
}

impl Preintegrated {
    /// Rotation of the body over the step that ends with sample `k`, by the attitudes; identity in the plane.
    fn relative_rotation(&self, k: usize) -> UnitQuaternion<f64> {
        if !self.options.in_space {
            return UnitQuaternion::identity();
        }
        let [before, after] = [k - 1, k].map(|row| rotation(self.samples.attitudes[row]));
        before.inverse() * after
    }

    /// Integrates the samples with covariance and all derivatives.
    pub fn replay(&self, is_interrupted: IsInterrupted) -> Result<PreintegratedMotion, Error> {
        let mut odometry = self.fresh.clone();
        odometry.work.constants.is_constant = false; // every step is fitted, and has derivatives
        let shared = odometry.work.fit.old.len();
        let tilts = if self.options.in_space { 2 } else { 0 };
        let mut sums = Sums {
            settled: Matrix6::zeros(),
            carried: vec![Vector6::zeros(); shared + tilts],
            columns: columns(self.rover()),
        };
        let (mut motion, mut yaw) = (Motion3::identity(), 0.0);
        if !self.is_empty() {
            odometry.refer_to(&self.sample(0));
        }
        for k in 1..self.len() {
            if k % BETWEEN_CHECKS == 0 && is_interrupted() {
                return Err(Error::interrupted());
            }
            let begins = if k == 1 { self.begins } else { 0.0 };
            let ends = if k == self.len() - 1 { self.ends } else { 1.0 };
            let step = sums.step(self, &mut odometry, k, ends - begins, &motion)?;
            yaw += step[5];
            motion = motion.compose(&Motion3::exp(&step));
        }
        for carried in &sums.carried {
            sums.settled += carried * carried.transpose();
        }
        let to_end = motion.inverse().adjoint();
        Ok(PreintegratedMotion {
            covariance: to_end * sums.settled * to_end.transpose(),
            columns: sums.columns.into_iter().map(|(column, by)| (column, to_end * by)).collect(),
            motion,
            yaw,
        })
    }
}

impl Sums {
    /// Adds a fraction `share` of one step, which begins where `motion` ends. Returns its tangent.
    fn step(
        &mut self,
        of: &Preintegrated,
        odometry: &mut Odometry,
        k: usize,
        share: f64,
        motion: &Motion3,
    ) -> Result<Vector6<f64>, Error> {
        let sample = of.sample(k);
        let dt = sample.stamp - odometry.reference.stamp;
        odometry.difference(&sample, dt);
        let relative = of.relative_rotation(k);
        let turned = relative.scaled_axis();
        let by_rates = sample.yaw_rate.map(|rate| mean_rate(odometry.reference.yaw_rate, rate) * dt);
        let from_attitude = of.options.in_space && by_rates.is_none();
        let gyro_turn = if from_attitude { Some(turned.z) } else { by_rates };
        let Odometry { rover, settings, reference, angles, turned: rotations, work, .. } = &mut *odometry;
        let measured = StepMotion {
            steering: [&reference.angles, angles],
            turned: rotations,
            from_rates: settings.readings == Readings::Speeds,
            dt,
            gyro_turn,
            bias_variance: 0.0,
        };
        work.advance(rover, settings, measured, f64::INFINITY, None, &mut [])?;
        let mut step = Vector6::zeros();
        for (row, part) in PLANE.into_iter().zip(work.displacement) {
            step[row] = part;
        }
        (step[3], step[4]) = (turned.x, turned.y);
        step *= share;
        let by_step = motion.adjoint() * left_jacobian(&step) * share;
        self.add_plane_errors(odometry, dt, share, &(by_step * embedding()));
        if of.options.in_space {
            let by_turn = if from_attitude { odometry.work.gain.into() } else { Vector3::zeros() };
            self.add_tilt_errors(of, &turned, &relative, &by_turn, &by_step);
        }
        odometry.commit_sample(&sample, Health::GOOD, gyro_turn);
        Ok(step)
    }

    /// Adds errors and derivatives of the displacement in the plane; `by_plane` is the derivative of the motion by it.
    fn add_plane_errors(&mut self, odometry: &Odometry, dt: f64, share: f64, by_plane: &Matrix6x3<f64>) {
        let Odometry { rover, settings, work, .. } = odometry;
        let gain = Vector3::from(work.gain);
        // Errors of the wheels after the fusion with a gyroscope: (I - K H) e.
        let by_wheels = by_plane * (Matrix3::identity() - gain * Vector3::z().transpose());
        // The variance of a fraction of a step is that fraction of the whole variance.
        self.settled += by_plane * work.noise.own.matrix() * by_plane.transpose() / share.max(f64::MIN_POSITIVE);
        let mut add = |carried: &mut Vector6<f64>, old: Vector6<f64>, new: Vector6<f64>| {
            let whole = *carried + old;
            self.settled += whole * whole.transpose();
            *carried = new;
        };
        let gyroscope = work.fit.old.len() - 1;
        let columns = work.fit.old[..gyroscope].iter().zip(&work.fit.new);
        for ((old, new), carried) in columns.zip(&mut self.carried) {
            add(carried, by_wheels * Vector3::from(*old), by_wheels * Vector3::from(*new));
        }
        let reading = by_plane * gain * gyroscope_deviation(settings, Lanes::splat(Scalar, dt)).sum();
        add(&mut self.carried[gyroscope], reading, reading);
        let linearised = work.fit.linearised(rover, settings.method);
        for (column, sum) in &mut self.columns {
            *sum += match column {
                Column::Bias => by_plane * gain * -dt,
                _ => by_wheels * column.displacement_derivative(&linearised),
            };
        }
    }

    /// Adds errors of the tilt of the attitudes at both ends of a step; `by_step` is the derivative of the motion by
    /// the step.
    fn add_tilt_errors(
        &mut self,
        of: &Preintegrated,
        turned: &Vector3<f64>,
        relative: &UnitQuaternion<f64>,
        by_turn: &Vector3<f64>,
        by_step: &Matrix6<f64>,
    ) {
        let about = Vector6::new(0.0, 0.0, 0.0, turned.x, turned.y, turned.z);
        let of_turn: Matrix3<f64> = right_jacobian(&about).fixed_view::<3, 3>(3, 3).into_owned();
        let inverse = of_turn.try_inverse().unwrap_or_else(Matrix3::identity);
        let first = self.carried.len() - 2;
        for (axis, carried) in self.carried[first..].iter_mut().enumerate() {
            let mut error = Vector3::zeros();
            error[axis] = of.options.attitude_noise;
            let [old, new] = [-(inverse * (relative.inverse() * error)), inverse * error].map(|d| {
                let (ahead, left, turn) = (by_turn.x * d.z, by_turn.y * d.z, by_turn.z * d.z);
                by_step * Vector6::new(ahead, left, 0.0, d.x, d.y, turn)
            });
            let whole = *carried + old;
            self.settled += whole * whole.transpose();
            *carried = new;
        }
    }
}
