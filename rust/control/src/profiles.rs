//! Profiles of one or several axes with three derivatives, and the transitions of a rover built on them.
//!
//! A profile is a sequence of pieces of constant jerk per axis: [`shapes`] in a given time, [`optimal`] in the least
//! time. Transitions give the motion of the wheels as a function of time: [`sampling`] by profiles of the body's twist
//! or of each module's angle and speed, [`icr`] by a path of the centre of rotation.

mod chord;
mod constraints;
pub mod icr;
mod limits;
pub mod optimal;
mod phase;
mod plan;
mod ruckig;
pub mod sampling;
pub mod shapes;
mod timing;

pub use constraints::IcrLimits;
pub use icr::IcrTransition;
pub use limits::{AxisState, Bounds, Synchronise};
pub use optimal::time_optimal;
pub use phase::{Action, Phase};
pub use sampling::{BodyTransition, ModuleLimits, ModuleTransition, Modules, Wheels};
pub use shapes::{Shape, linear, s_curve, trapezoid};

use six_wheel_numerics::error::{Error, number};

/// A value and its derivatives with respect to time, up to the jerk.
pub type Derivatives = [f64; 4];

/// A piece of constant jerk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Piece {
    /// Start [s].
    pub start: f64,
    /// Value and derivatives there.
    pub state: Derivatives,
}

/// The motion of one axis over time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    /// At least one, in the order of their starts, the first of which is 0.
    pub pieces: Vec<Piece>,
    /// Arrival time [s].
    pub duration: f64,
    /// Its state at that instant.
    pub end: Derivatives,
}

/// The motion of several axes over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    pub(crate) axes: Vec<Axis>,
    duration: f64,
}

/// A state after a time of constant jerk.
pub(crate) fn constant_jerk_state([value, velocity, acceleration, jerk]: Derivatives, time: f64) -> Derivatives {
    [
        value + time * (velocity + time * (acceleration / 2.0 + time * (jerk / 6.0))),
        velocity + time * (acceleration + time * (jerk / 2.0)),
        acceleration + time * jerk,
        jerk,
    ]
}

impl Axis {
    /// State at a time: at rest before the start and after the end.
    pub fn at(&self, time: f64) -> Derivatives {
        let first = self.pieces.first().map_or(self.end, |piece| piece.state);
        if time < 0.0 {
            return [first[0], 0.0, 0.0, 0.0];
        }
        if time > self.duration {
            return [self.end[0], 0.0, 0.0, 0.0];
        }
        if time == self.duration {
            return self.end;
        }
        let next = self.pieces.partition_point(|piece| piece.start <= time);
        match self.pieces.get(next.saturating_sub(1)) {
            Some(piece) => constant_jerk_state(piece.state, time - piece.start),
            None => self.end,
        }
    }

    /// Largest magnitudes of velocity, acceleration and jerk.
    fn peaks(&self) -> [f64; 3] {
        let mut peaks = [0.0_f64; 3];
        let mut note = |state: Derivatives| {
            for (peak, value) in peaks.iter_mut().zip(&state[1..]) {
                *peak = peak.max(value.abs());
            }
        };
        for (i, piece) in self.pieces.iter().enumerate() {
            let end = self.pieces.get(i + 1).map_or(self.duration, |next| next.start);
            let [_, _, acceleration, jerk] = piece.state;
            note(piece.state);
            note(constant_jerk_state(piece.state, end - piece.start));
            // The velocity is largest where the acceleration passes through zero.
            let turn = -acceleration / jerk;
            if turn > 0.0 && turn < end - piece.start {
                note(constant_jerk_state(piece.state, turn));
            }
        }
        peaks
    }

    /// Fails unless every number is finite.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let states = self.pieces.iter().map(|piece| piece.state);
        if states.chain([self.end]).flatten().all(f64::is_finite) {
            return Ok(());
        }
        let rule = "be long enough for finite derivatives";
        Err(Error::value("duration", rule, number(self.duration)))
    }
}

impl Profile {
    pub(crate) fn new(axes: Vec<Axis>) -> Self {
        let duration = axes.iter().fold(0.0, |longest, axis| axis.duration.max(longest));
        Self { axes, duration }
    }

    /// Several axes from `from` to `to` in proportion to this profile of one axis from 0 to 1.
    pub(crate) fn spread(&self, from: &[f64], to: &[f64]) -> Self {
        let axis = |(&from, &to): (&f64, &f64)| {
            let scale = |[value, first, second, third]: Derivatives| {
                [value, first, second, third].map(|part| part * (to - from))
            };
            let placed = |state: Derivatives| {
                let [value, first, second, third] = scale(state);
                [from + value, first, second, third]
            };
            let share = self.axes.first()?;
            let [_, first, second, third] = scale(share.end);
            let pieces = share.pieces.iter().map(|piece| Piece { start: piece.start, state: placed(piece.state) });
            Some(Axis { pieces: pieces.collect(), duration: share.duration, end: [to, first, second, third] })
        };
        Self::new(from.iter().zip(to).filter_map(axis).collect())
    }

    /// The axes of both, one after the other.
    #[must_use]
    pub fn concatenate_axes(mut self, other: Self) -> Self {
        self.axes.extend(other.axes);
        Self::new(self.axes)
    }

    /// Arrival time of the last axis [s].
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Arrival time of each axis [s].
    pub fn durations(&self) -> impl Iterator<Item = f64> {
        self.axes.iter().map(|axis| axis.duration)
    }

    /// Number of axes.
    pub fn width(&self) -> usize {
        self.axes.len()
    }

    /// State of an axis at a time [s]. Before the start it rests at the start value, after its arrival at the
    /// end value; at both instants it has the given derivatives.
    pub fn at(&self, axis: usize, time: f64) -> Derivatives {
        self.axes.get(axis).map_or([f64::NAN; 4], |axis| axis.at(time))
    }

    /// Largest magnitudes of velocity, acceleration and jerk of each axis.
    pub fn peaks(&self) -> impl Iterator<Item = [f64; 3]> {
        self.axes.iter().map(Axis::peaks)
    }
}
