//! The parts of a transition.

use super::Profile;
use super::chord::Chord;
use super::timing::TimeParametrization;
use six_wheel_kinematics::geometry::Twist;

/// The kind of motion in a phase of a transition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Drive along the path of the centre of rotation.
    Drive,
    /// Come to rest, steering angles held.
    Stop,
    /// Turn wheels whose pivots rest.
    Align,
}

impl Action {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Drive => "drive",
            Self::Stop => "stop",
            Self::Align => "align",
        }
    }
}

/// A part of a transition.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// The kind of motion.
    pub action: Action,
    /// The reason for the phase, in words.
    pub reason: String,
    /// Begin [s].
    pub start: f64,
    /// Duration [s].
    pub duration: f64,
    pub(super) motion: Motion,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Motion {
    Along(Chord, TimeParametrization),
    Turning(Twist, Profile),
}
