//! The next thing to do on the way to a goal.

/// The next thing to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Route {
    /// Nothing is asked for: stop, and keep the direction.
    Stay,
    /// The direction is there: take up speed, forwards or backwards along it.
    Along { sign: f64 },
    /// Turn to an angle of the arc, then as above.
    Turn { end: f64, sign: f64 },
    /// Another turn has to end first.
    Wait,
    /// No turn leads there: stop first. Why.
    Blocked(u32),
    /// At rest: each joint for itself.
    Align,
}
