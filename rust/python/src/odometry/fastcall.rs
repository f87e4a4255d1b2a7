//! The quick way of `Odometry.update`: one sample in tuples, lists or arrays.

use pyo3::prelude::*;
use six_wheel_odometry::Sample;

use super::Odometry;
use crate::fastcall::{Answer, Arguments, Numbers, Object, float};

fast_methods! {
    Update<5>: Odometry, c"update", [c"steering", c"wheel_angles", c"stamp", c"yaw", c"yaw_rate"], 3, update;
}

#[inline(always)]
fn update<'py>(
    this: Borrowed<'_, 'py, Odometry>,
    [steering, wheels, stamp, yaw, yaw_rate]: Arguments<'_, 'py, 5>,
) -> Answer<'py> {
    let py = this.py();
    let this = this.get();
    let mut work = this.work.try_lock(py)?;
    let work = &mut *work;
    let (joints, count) = (this.joints(), this.wheels());
    let mut rooms = [Numbers::new(), Numbers::new()];
    let [room, other] = &mut rooms;
    let optional = |number: Option<Object<'_, 'py>>| match number {
        None => Some(None),
        Some(number) => float(number).map(Some),
    };
    // SAFETY: nothing is written to arrays, and no Python code runs before the sample has been taken in.
    let sample = unsafe {
        Sample {
            steering: match steering {
                Some(steering) => room.read(steering, joints)?,
                None if joints == 0 => &[],
                None => return None,
            },
            wheels: other.read(wheels?, count)?,
            stamp: float(stamp?)?,
            yaw: optional(yaw)?,
            yaw_rate: optional(yaw_rate)?,
        }
    };
    // A sample that is refused here is refused again by the general path, which gives the reason.
    work.core.update(sample).ok()?;
    let state = work.spares.state(&work.core, &this.rover, py);
    state.ok().map(Bound::into_any)
}
