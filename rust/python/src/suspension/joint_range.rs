//! Ranges of joints, as arguments have them.

use pyo3::prelude::*;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::units;
use six_wheel_terrain::suspension::JointRange;

use crate::convert::{OrRaise, number};
use crate::unit_warnings::warn_units;
use crate::wheel::steering_range;

/// Stops of a joint: one angle for both sides, a pair, or none.
pub fn joint_range(argument: &'static str, limit: Option<&Bound<'_, PyAny>>) -> PyResult<JointRange> {
    let Some(limit) = limit else { return Ok(JointRange::default()) };
    let range = match limit.extract::<[Bound<'_, PyAny>; 2]>() {
        Ok([lower, upper]) => JointRange {
            lower: number(&format!("{argument}[0]"), &lower)?,
            upper: number(&format!("{argument}[1]"), &upper)?,
        },
        Err(_) => {
            let limit = number(argument, limit)?;
            JointRange { lower: -limit, upper: limit }
        }
    };
    range.check(argument).or_raise(&[])?;
    Ok(range)
}

/// Range of a suspension's steered wheels, which is asked about where it is likely in degrees.
pub fn steering(py: Python<'_>, limit: Option<&Bound<'_, PyAny>>) -> PyResult<SteeringRange> {
    let range = steering_range(limit)?.unwrap_or_default();
    warn_units(py, units::steering(range))?;
    Ok(range)
}
