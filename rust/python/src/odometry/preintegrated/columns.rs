//! Names of the columns of pre-integrated motion.

use six_wheel_kinematics::estimate::sensitivity::Quantity;

/// Names of the dimensions, as of `TwistJacobian`.
pub fn dimension(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Radius => "radius",
        Quantity::X => "x",
        Quantity::Y => "y",
        Quantity::Heading => "heading",
        Quantity::Scrub => "scrub",
        Quantity::Trail => "trail",
        _ => "roller_angle",
    }
}

pub const SLIPS: [&str; 2] = ["slip", "side_slip"];
pub const BIAS: &str = "gyroscope_bias";
