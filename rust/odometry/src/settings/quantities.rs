//! Quantities on which the motion of a step depends, and the derivative of its displacement by each.

use nalgebra::Vector3;

use six_wheel_kinematics::estimate::sensitivity::{LinearisedFit, Quantity};

/// A quantity on which the motion depends, and by which it has a column of derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// A dimension of a wheel.
    Dimension(Quantity, usize),
    /// Forward slip of a wheel's contact, as a share of the distance that the wheel rolled.
    Slip(usize),
    /// Slip of a wheel's contact to its left, as a share of the distance that its pivot moved.
    SideSlip(usize),
    /// Relative error of the readings of a wheel's rotation: true less read, over read.
    Turned(usize),
    /// Relative error of the readings of a wheel's steering angle: true less read, over read.
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
                let distance = linearised.twist().at(pivot.x, pivot.y).norm();
                linearised.derivative(wheel, Quantity::SideSlip) * distance
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

/// Dimensions of a wheel on which the motion depends.
pub const DIMENSIONS: [Quantity; 7] = [
    Quantity::Radius,
    Quantity::X,
    Quantity::Y,
    Quantity::Heading,
    Quantity::Scrub,
    Quantity::Trail,
    Quantity::RollerAngle,
];
