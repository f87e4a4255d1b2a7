//! Quantities that the motion of a step answers to, and the derivative of its displacement by each.

use nalgebra::Vector3;

use six_wheel_kinematics::estimate::sensitivity::{LinearisedFit, Quantity};

/// Something the motion answers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// A dimension of a wheel.
    Dimension(Quantity, usize),
    /// Share of the way a wheel rolled by which its contact slipped forwards.
    Slip(usize),
    /// The way a wheel slipped to its left, as a share of the way its pivot went.
    SideSlip(usize),
    /// Share by which a wheel turned more than was read.
    Turned(usize),
    /// Share by which a wheel is steered farther than was read.
    Steered(usize),
    /// The bias of the gyroscope [rad/s].
    Bias,
}

impl Column {
    /// Derivative of the displacement of a step by the wheels.
    pub(crate) fn displacement_derivative(self, linearised: &LinearisedFit<'_>) -> Vector3<f64> {
        match self {
            Self::Dimension(quantity, wheel) => linearised.derivative(wheel, quantity),
            Self::Slip(wheel) => linearised.derivative(wheel, Quantity::Slip) * linearised.readings[wheel].rolled,
            Self::SideSlip(wheel) => {
                let pivot = &linearised.rover.wheels()[wheel];
                let way = linearised.twist().at(pivot.x, pivot.y).norm();
                linearised.derivative(wheel, Quantity::SideSlip) * way
            }
            Self::Turned(wheel) => match linearised.measured.speeds[wheel] {
                turned if turned.is_nan() => Vector3::zeros(),
                turned => linearised.derivative(wheel, Quantity::Speed) * turned,
            },
            Self::Steered(wheel) => {
                let Some(joint) = linearised.joint(wheel) else {
                    return Vector3::zeros();
                };
                let angle = linearised.measured.steering[joint];
                let rates = linearised.measured.steering_rates;
                let rate = rates.map_or(0.0, |rates| rates[joint]);
                linearised.derivative(wheel, Quantity::Steering) * angle
                    + linearised.derivative(wheel, Quantity::SteeringRate) * rate
            }
            Self::Bias => Vector3::zeros(),
        }
    }
}

/// Dimensions of a wheel the motion answers to.
pub const DIMENSIONS: [Quantity; 7] = [
    Quantity::Radius,
    Quantity::X,
    Quantity::Y,
    Quantity::Heading,
    Quantity::Scrub,
    Quantity::Trail,
    Quantity::RollerAngle,
];
