//! Sensitivity of the twist to its readings and to the dimensions of the rover: analytic derivatives.
//!
//! The twist solves `Aᵀ W A t = Aᵀ W b`. With the residual `r = b - A t`, differentiating gives
//!
//! ```text
//! dt = (Aᵀ W A)⁻¹ [dAᵀ W r + Aᵀ W (db - dA t)]
//! ```
//!
//! for every quantity that changes the rows `A` or the readings `b`; the weights `W` are constant. One quantity of one
//! wheel changes that wheel's two rows only, except for unsteered wheels with nearly parallel axles: they share a
//! weighted mean of their side-slip rows, whose weights depend on their headings.

use nalgebra::{Matrix3, Vector3};

use super::{Measured, Reading};
use crate::geometry::Direction;
use crate::geometry::Twist;
use crate::rover_data::{Mount, RoverData};
use crate::wheels::{Pivot, Wheel};

/// A quantity of one wheel on which the twist depends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Reading of its speed [rad/s].
    Speed,
    /// Reading of its steering angle [rad]; 0 for a wheel that does not steer.
    Steering,
    /// Rate of its steering angle [rad/s].
    SteeringRate,
    /// Speed at which its contact slips forwards [m/s].
    Slip,
    /// Speed at which its contact slips to its left [m/s].
    SideSlip,
    /// Its pivot, forward [m].
    X,
    /// Its pivot, to the left [m].
    Y,
    /// Its direction at steering angle 0 [rad]: for a steered wheel the offset of its angle.
    Heading,
    /// Its radius [m].
    Radius,
    /// Its contact, to the left of the steering axis [m].
    Scrub,
    /// Its contact, behind the steering axis [m].
    Trail,
    /// The angle of its rollers [rad]; 0 for a wheel without.
    RollerAngle,
}

named_values! {
    Quantity as "quantities":
    "wheel_speeds" => Speed, "steering" => Steering, "steering_rates" => SteeringRate, "slip" => Slip,
    "side_slip" => SideSlip, "x" => X, "y" => Y, "heading" => Heading, "radius" => Radius, "scrub" => Scrub,
    "trail" => Trail, "roller_angle" => RollerAngle
}

/// RowDerivative of a wheel's rows and right-hand sides per unit of a quantity.
#[derive(Clone, Copy, Default)]
struct RowDerivative {
    rolling: Vector3<f64>,
    side_slip: Vector3<f64>,
    rolled: f64,
    slipped: f64,
}

impl RowDerivative {
    /// The change of a wheel that rolls in `direction`, before rollers combine its rows.
    fn of(wheel: &Wheel, Direction { sin, cos }: Direction, quantity: Quantity) -> Self {
        let lever = Vector3::new(0.0, 0.0, 1.0);
        let mut change = Self::default();
        match quantity {
            Quantity::X => {
                change.rolling = lever * sin;
                change.side_slip = lever * cos;
            }
            Quantity::Y => {
                change.rolling = lever * -cos;
                change.side_slip = lever * sin;
            }
            Quantity::Steering | Quantity::Heading => {
                let (along, across) = (wheel.x * cos + wheel.y * sin, wheel.y * cos - wheel.x * sin);
                change.rolling = Vector3::new(-sin, cos, along);
                change.side_slip = Vector3::new(-cos, -sin, across);
            }
            Quantity::Scrub => change.rolling = -lever,
            Quantity::Trail => change.side_slip = -lever,
            Quantity::Slip => change.rolled = 1.0,
            Quantity::SideSlip => change.slipped = 1.0,
            Quantity::Speed => change.rolled = wheel.radius,
            Quantity::SteeringRate => {
                change.rolled = wheel.scrub;
                change.slipped = wheel.trail;
            }
            Quantity::Radius | Quantity::RollerAngle => {}
        }
        change
    }
}

/// The twist of one instant with all that its derivatives need.
#[derive(Debug)]
pub struct LinearisedFit<'a> {
    /// The rover.
    pub rover: &'a RoverData,
    /// Rows of its wheels.
    pub readings: &'a [Reading],
    /// Readings of the instant.
    pub measured: Measured<'a>,
    /// Inverse of the normal equations about the centre of the pivots.
    pub solution: Matrix3<f64>,
    /// The twist that fits them.
    pub twist: Vector3<f64>,
    /// Weight of each wheel; None: all 1.
    pub weights: Option<&'a [f64]>,
}

impl LinearisedFit<'_> {
    /// The twist.
    #[inline]
    pub fn twist(&self) -> Twist {
        self.twist.into()
    }

    /// Index of a wheel among the steered wheels.
    #[inline]
    pub fn joint(&self, wheel: usize) -> Option<usize> {
        self.rover.steered().iter().position(|&k| k == wheel)
    }

    /// Derivative of the twist with respect to a quantity of one wheel.
    #[inline]
    pub fn derivative(&self, wheel: usize, quantity: Quantity) -> Vector3<f64> {
        self.solve(self.gradient(wheel, quantity))
    }

    /// Maps a gradient of the normal equations to a twist.
    fn solve(&self, gradient: Vector3<f64>) -> Vector3<f64> {
        let centred = self.solution * self.rover.row_about_centre(&gradient);
        self.rover.twist_at_origin(&centred)
    }

    fn weight(&self, wheel: usize) -> f64 {
        self.weights.map_or(1.0, |weights| weights[wheel])
    }

    /// `dAᵀ W r + Aᵀ W (db - dA t)` for a quantity of one wheel.
    pub fn gradient(&self, i: usize, quantity: Quantity) -> Vector3<f64> {
        let (wheel, reading) = (&self.rover.wheels()[i], &self.readings[i]);
        if wheel.pivot == Pivot::Castor {
            return Vector3::zeros();
        }
        let read = self.measured.speeds[i].is_finite();
        let rate = || match (self.measured.steering_rates, self.joint(i)) {
            (Some(rates), Some(joint)) => rates[joint],
            _ => 0.0,
        };
        match (quantity, wheel.steering()) {
            (Quantity::Steering, None) => return Vector3::zeros(),
            // Both rows rotate and AᵀA is constant: the sum below reduces to `dAᵀ b`, the rolling row's change is the
            // side-slip row.
            (Quantity::Steering, Some(_)) if wheel.is_centred() && read => {
                return reading.side_slip * (reading.rolled * self.weight(i));
            }
            _ => {}
        }
        let direction = match self.rover.mounts[i] {
            Mount::Steered(..) => Direction { sin: -reading.side_slip.x, cos: reading.side_slip.y },
            Mount::Fixed(_) | Mount::Castor(_) => Direction::from(wheel.heading),
        };
        let mut change = RowDerivative::of(wheel, direction, quantity);
        match quantity {
            Quantity::Radius if read => change.rolled = self.measured.speeds[i],
            Quantity::Scrub => change.rolled = rate(),
            Quantity::Trail => change.slipped = rate(),
            _ => {}
        }
        if let Some(angle) = wheel.roller_angle {
            let (sin, cos) = angle.sin_cos();
            if quantity == Quantity::RollerAngle {
                change.rolling = wheel.bare_rows(direction).side_slip / -(sin * sin);
            } else {
                change.rolling += change.side_slip * (cos / sin);
                change.rolled += change.slipped * (cos / sin);
            }
            change.side_slip = Vector3::zeros();
            change.slipped = 0.0;
        }
        if !read {
            change.rolling = Vector3::zeros();
            change.rolled = 0.0;
        }
        let rolling = respond(&self.twist, &reading.rolling, reading.rolled, &change.rolling, change.rolled);
        rolling * self.weight(i) + self.side_slip_gradient(i, &change, quantity)
    }

    /// The part of the side-slip rows. Unsteered wheels with nearly parallel axles have a share in each other's.
    fn side_slip_gradient(&self, i: usize, change: &RowDerivative, quantity: Quantity) -> Vector3<f64> {
        let respond = |k: usize, by: &Vector3<f64>, slipped: f64| {
            let reading = &self.readings[k];
            let response = respond(&self.twist, &reading.side_slip, reading.slipped, by, slipped);
            response * self.weight(k)
        };
        let wheel = &self.rover.wheels()[i];
        let is_shared = matches!(self.rover.mounts[i], Mount::Fixed(_)) && wheel.roller_angle.is_none();
        if quantity == Quantity::SideSlip || !is_shared {
            return respond(i, &change.side_slip, change.slipped);
        }
        self.rover.changes_with(i, change.side_slip).map(|(k, by)| respond(k, &by, 0.0)).sum()
    }
}

/// Derivative of one row of the normal equations: `da r + a (db - da t)`.
fn respond(
    twist: &Vector3<f64>,
    row: &Vector3<f64>,
    reading: f64,
    row_change: &Vector3<f64>,
    reading_change: f64,
) -> Vector3<f64> {
    let residual = reading - row.dot(twist);
    row_change * residual + row * (reading_change - row_change.dot(twist))
}
