//! The quick way of `Suspension.traction`: one instant of a control loop.

use pyo3::prelude::*;
use six_wheel_core::moving::{Drives, Driving, Lift, Turns, traction_rows};
use six_wheel_core::suspension::MAX_WHEELS;

use super::traction::{One, Traction};
use crate::batch::any_workers;
use crate::fast::{self, Method, Numbers, Object, Quick, float, three};
use crate::suspension::Suspension;

/// Puts the quick way before the method of the class.
pub fn install(py: Python<'_>) -> PyResult<()> {
    fast::install::<6, OneInstant>(py)
}

struct OneInstant;

impl Quick<6> for OneInstant {
    type Class = Suspension;

    fn method() -> &'static Method<6> {
        static METHOD: Method<6> = Method::new(
            c"traction",
            [
                c"speed",
                c"curvature",
                c"angular_velocity",
                c"joints",
                c"joint_rates",
                c"yaw_rate",
            ],
            5,
        );
        &METHOD
    }

    #[inline(always)]
    fn call<'py>(
        this: Borrowed<'_, 'py, Suspension>,
        [speed, curvature, turning, joints, rates, yaw_rate]: [Option<Object<'_, 'py>>; 6],
    ) -> Option<Bound<'py, PyAny>> {
        let (py, suspension) = (this.py(), this.get());
        let chain = &suspension.chain;
        let (wheels, free, steered) = (
            chain.wheels().len(),
            chain.joints().len(),
            chain.steering().len(),
        );
        let (curved, turn) = match (curvature, yaw_rate) {
            (Some(curvature), None) => (true, float(curvature)?),
            (None, Some(yaw_rate)) => (false, float(yaw_rate)?),
            _ => return None,
        };
        let (speed, turning) = (float(speed?)?, three(turning?)?);
        let mut rooms = [Numbers::new(), Numbers::new()];
        let [room, other] = &mut rooms;
        // SAFETY: nothing is written before everything has been read.
        let (joints, rates) = unsafe { (room.read(joints?, free)?, other.read(rates?, free)?) };
        let numbers = [speed, turn];
        let mut numbers = numbers.iter().chain(&turning).chain(joints).chain(rates);
        if !numbers.all(|number| number.is_finite()) {
            return None;
        }
        let mut one = One {
            wheels,
            steered,
            speeds: [0.0; MAX_WHEELS],
            steering: [0.0; MAX_WHEELS],
            contact_angles: [0.0; MAX_WHEELS],
            lifted: [false; MAX_WHEELS],
            vertical: 0.0,
        };
        let driving = Driving {
            speed: &[speed],
            turning: if curved {
                Turns::Curvature(&[turn])
            } else {
                Turns::YawRate(&[turn])
            },
            angular_velocity: &[turning],
            joints,
            joint_rates: rates,
            steering: None,
            wheel_speeds: None,
            lift: Lift::default(),
        };
        let drives = Drives {
            steering: &mut one.steering[..steered],
            speeds: &mut one.speeds[..wheels],
            contact_angles: &mut one.contact_angles[..wheels],
            lifted: &mut one.lifted[..wheels],
            vertical: std::slice::from_mut(&mut one.vertical),
        };
        let workers = any_workers(None, None).ok()?;
        traction_rows(chain, &suspension.motion, &driving, drives, workers).ok()?;
        let traction = Bound::new(py, Traction::one(one)).ok()?;
        Some(traction.into_any())
    }
}
