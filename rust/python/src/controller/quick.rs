//! The quick way of `Controller.command` and `Controller.step`.

use pyo3::prelude::*;
use six_wheel_kinematics::geometry::Twist;

use super::Controller;
use super::output::ControllerOutput;
use crate::fastcall::{Answer, Arguments, Numbers, float, three, truth};

fast_methods! {
    Command<2>: Controller, c"command", [c"twist", c"stamp"], 2, command;
    Step<2>: Controller, c"step", [c"stamp", c"measured"], 2, step;
}

#[inline(always)]
fn command<'py>(this: Borrowed<'_, 'py, Controller>, [twist, stamp]: Arguments<'_, 'py, 2>) -> Answer<'py> {
    let (twist, stamp) = (three(twist?)?, float(stamp?)?);
    let mut core = this.get().core.try_lock(this.py())?;
    let taken = core.command(Twist::from(twist), stamp, None);
    // A failed call has changed nothing: the general way may say why.
    Some(truth(this.py(), taken.ok()?))
}

#[inline(always)]
fn step<'py>(this: Borrowed<'_, 'py, Controller>, [now, measured]: Arguments<'_, 'py, 2>) -> Answer<'py> {
    let (py, now) = (this.py(), float(now?)?);
    let controller = this.get();
    let mut room = Numbers::new();
    let measured = match measured {
        None => None,
        // SAFETY: nothing of Python runs until the step is done, and nothing writes to the array.
        Some(measured) => Some(unsafe { room.read(measured, controller.joints)? }),
    };
    let mut core = controller.core.try_lock(py)?;
    core.step(now, measured).ok()?;
    let output = ControllerOutput::of(&core, controller.rover.clone_ref(py));
    drop(core);
    Some(Bound::new(py, output).ok()?.into_any())
}
