//! Derivatives of the motion of [`Contacts::forward`] by its readings, in which it is linear.

use nalgebra::{Matrix3, Vector3};

use super::contact::{Contact, Contacts};
use super::motion::{Readings, SuspensionJacobian};
use crate::rates::contact_rows::COLUMNS;
use crate::rates::fit::weights;
use crate::rates::point_rows::Row;
use six_wheel_numerics::jacobi::Jacobi;
use six_wheel_numerics::least_squares::DEPENDENT;
use six_wheel_terrain::suspension::MAX_WHEELS;

/// Derivatives of the twist `vx, vy, vz, wx, wy, wz` [m/s, rad/s] by one reading.
pub type TwistDerivative = [f64; 6];

/// Derivatives of the fitted twist by all readings of one motion.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// By the speed of every wheel [rad/s].
    pub by_speed: [TwistDerivative; MAX_WHEELS],
    /// By the sideways velocity of every wheel's touching point, positive to the left [m/s].
    pub by_side: [TwistDerivative; MAX_WHEELS],
    /// By the rate of every steering joint [rad/s].
    pub by_steering_rate: [TwistDerivative; MAX_WHEELS],
    /// By the body's rates about x and y [rad/s]; 0 where they were not measured.
    pub by_tilting: [TwistDerivative; 2],
    /// By the rate of every free angle [rad/s]; 0 where it was not measured.
    pub by_joint_rate: [TwistDerivative; COLUMNS - 6],
}

/// Three rows of a contact in the fit of the planar motion.
#[derive(Clone, Copy)]
struct Rows<'a> {
    contact: &'a Contact,
    /// Derivatives by the planar rates, those of the suspension eliminated.
    plan: [Vector3<f64>; 3],
    /// Weight of each row.
    shares: [f64; 3],
}

/// The parts of the fit that all derivatives share.
struct Fit<'a> {
    suspension: SuspensionJacobian,
    /// Inverse of the normal matrix of the planar rates.
    inverse: Matrix3<f64>,
    rows: [Option<Rows<'a>>; MAX_WHEELS],
}

impl Contacts {
    /// The derivatives of [`Self::forward`] at these readings.
    pub fn response(&self, readings: &Readings<'_>, radii: &[f64; MAX_WHEELS]) -> Response {
        let known = readings.known(self);
        let fit = self.fit(readings, &known);
        let mut response = Response {
            by_speed: [[0.0; 6]; MAX_WHEELS],
            by_side: [[0.0; 6]; MAX_WHEELS],
            by_steering_rate: [[0.0; 6]; MAX_WHEELS],
            by_tilting: [[0.0; 6]; 2],
            by_joint_rate: [[0.0; 6]; COLUMNS - 6],
        };
        let none = [0.0; COLUMNS];
        for (wheel, rows) in fit.rows.iter().enumerate() {
            let Some(rows) = rows else { continue };
            let right = |row: usize, by: f64| rows.plan[row] * (rows.shares[row] * by);
            response.by_speed[wheel] = fit.twist(&none, right(1, radii[wheel]));
            response.by_side[wheel] = fit.twist(&none, right(2, 1.0));
        }
        let still = known.map(|rate| if rate.is_nan() { rate } else { 0.0 });
        // Rates of the suspension for one measured rate of 1, the others 0.
        let unit = |column: usize| {
            let mut rates = still;
            rates[column] = 1.0;
            self.suspension(&rates, &[0.0; MAX_WHEELS]).offset
        };
        for (axis, derivative) in response.by_tilting.iter_mut().enumerate() {
            if !known[3 + axis].is_nan() {
                *derivative = fit.driven_twist(&unit(3 + axis), None);
            }
        }
        let joints = response.by_joint_rate[..self.joints].iter_mut();
        for (joint, derivative) in joints.enumerate() {
            if !known[6 + joint].is_nan() && !self.stopped[joint] {
                *derivative = fit.driven_twist(&unit(6 + joint), None);
            }
        }
        for (joint, derivative) in response.by_steering_rate.iter_mut().enumerate() {
            let mut swivels = [0.0; MAX_WHEELS];
            for (wheel, contact) in self.touching() {
                swivels[wheel] = f64::from(contact.steering == Some(joint));
            }
            if swivels.contains(&1.0) {
                *derivative = fit.driven_twist(&self.suspension(&still, &swivels).offset, Some(joint));
            }
        }
        response
    }

    fn fit(&self, readings: &Readings<'_>, known: &Row) -> Fit<'_> {
        let suspension = self.suspension(known, &[0.0; MAX_WHEELS]);
        let mut rows = [None; MAX_WHEELS];
        let mut normal = Matrix3::zeros();
        for (wheel, contact) in self.touching() {
            let [mut roll, side] = weights(readings.weights, self.count, wheel);
            if readings.speeds[wheel].is_nan() {
                roll = 0.0;
            }
            let shares = [roll.max(side), roll, side];
            let plan = contact.rows.map(|row| suspension.planar_row(&row));
            for (row, share) in plan.iter().zip(shares) {
                normal += row * row.transpose() * share;
            }
            rows[wheel] = Some(Rows { contact, plan, shares });
        }
        let values = Jacobi::new(&normal);
        let bound = DEPENDENT * DEPENDENT * values.values[0];
        Fit { suspension, inverse: values.inverse(bound), rows }
    }
}

impl SuspensionJacobian {
    /// Derivatives of a velocity by the planar motion.
    fn planar_row(&self, direction: &Row) -> Vector3<f64> {
        Vector3::from_fn(|k, _| (0..COLUMNS).map(|c| direction[c] * self.spread[c][k]).sum())
    }
}

impl Fit<'_> {
    /// The twist of the rates `beside` that are not planar, with the planar rates that solve the normal equations with
    /// this right-hand side.
    fn twist(&self, beside: &Row, right: Vector3<f64>) -> TwistDerivative {
        let plan = self.inverse * right;
        std::array::from_fn(|c| beside[c] + Vector3::from(self.suspension.spread[c]).dot(&plan))
    }

    /// The twist of the rates `beside` that are not planar, where these rates and a unit rate of the steering joint
    /// `swivelled` move the contacts.
    fn driven_twist(&self, beside: &Row, swivelled: Option<usize>) -> TwistDerivative {
        let mut right = Vector3::zeros();
        for rows in self.rows.iter().flatten() {
            let swivels = swivelled.is_some() && rows.contact.steering == swivelled;
            for i in 0..3 {
                let swivel = if swivels { rows.contact.swivel[i] } else { 0.0 };
                let parts = rows.contact.rows[i].iter().zip(beside).map(|(part, rate)| part * rate);
                let moved = parts.sum::<f64>() + swivel;
                right -= rows.plan[i] * (rows.shares[i] * moved);
            }
        }
        self.twist(beside, right)
    }
}
