//! The parts of a twist that a projection preserves.

use std::str::FromStr;

use six_wheel_numerics::error::Error;

/// Part of a twist that a projection preserves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// Forward speed and yaw rate, hence the turning radius; past the limits neither grows.
    Curvature,
    /// Forward speed.
    Speed,
    /// Yaw rate.
    YawRate,
    /// As much as possible: least root mean square change of the pivots' velocities.
    Nearest,
}

impl FromStr for Keep {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        match name {
            "curvature" => Ok(Self::Curvature),
            "speed" => Ok(Self::Speed),
            "yaw_rate" => Ok(Self::YawRate),
            "nearest" => Ok(Self::Nearest),
            _ => {
                let rule = "be 'curvature', 'speed', 'yaw_rate' or 'nearest'";
                Err(Error::value("keep", rule, format!("{name:?}")))
            }
        }
    }
}
