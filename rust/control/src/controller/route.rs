//! Routes: kinds of motion by which a controller approaches a goal.

/// Kind of the present motion towards a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Route {
    /// There is no goal, or its speed is 0: stop, and keep the direction.
    Stay,
    /// The direction is that of the goal: change the speed, forwards (`sign` 1) or backwards (-1) along it.
    Along { sign: f64 },
    /// The direction is near that of the goal and stays, since only a stop could change it: change the speed along it.
    Near { sign: f64 },
    /// Turn to the angle `end` of the arc [rad], then as `Along`. `exact` if the goal's direction is there, else the
    /// point of the arc that is nearest to it.
    Turn { end: f64, sign: f64, exact: bool },
    /// The present turn has to end first.
    Wait,
    /// No continuous turn of the wheels leads to the goal: stop first, for these reasons (bits).
    Blocked(u32),
    /// At rest: every joint turns to its angle on its own.
    Align,
}

impl Route {
    /// True if the route is to be found anew once the body is at rest.
    pub(super) fn needs_rest(self) -> bool {
        matches!(self, Self::Turn { .. } | Self::Wait | Self::Blocked(_) | Self::Near { .. } | Self::Align)
    }
}
