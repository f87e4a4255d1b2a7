//! The next thing to do on the way to a goal.

/// The next thing to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Route {
    /// Nothing is asked for: stop, and keep the direction.
    Stay,
    /// The direction is there: take up speed, forwards or backwards along it.
    Along { sign: f64 },
    /// The same in a direction that is nearly there, which only a stop could mend.
    Near { sign: f64 },
    /// Turn to an angle of the arc, then as above. It is exact if the direction asked for is there, and not merely the
    /// point of the arc next to it.
    Turn { end: f64, sign: f64, exact: bool },
    /// Another turn has to end first.
    Wait,
    /// No turn leads there: stop first, for these reasons.
    Blocked(u32),
    /// At rest: each joint for itself.
    Align,
}

impl Route {
    /// Something is to be done once the body stands.
    pub(super) fn needs_rest(self) -> bool {
        matches!(self, Self::Turn { .. } | Self::Wait | Self::Blocked(_) | Self::Near { .. } | Self::Align)
    }
}
