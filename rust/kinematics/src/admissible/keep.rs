//! The parts of a twist that a projection preserves.

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

named_values! {
    Keep as "keep": "curvature" => Curvature, "speed" => Speed, "yaw_rate" => YawRate, "nearest" => Nearest
}
