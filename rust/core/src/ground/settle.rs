//! Where a chain settles on the ground, and why not.

use nalgebra::Vector3;

use super::newton::{Attempt, Hold};
use super::stops::Stops;
use super::touch::Touches;
use crate::batch::Level;
use crate::error::{Error, finite};
use crate::suspension::{Chain, MAX_FREE, MAX_STATE, PlanPose, State};
use crate::terrain::Terrain;

/// What came of settling a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// Every wheel touches that can.
    Settled,
    /// A joint is at its stop, and a wheel hangs in the air for it.
    AtStop,
    /// A rim leaves the map.
    OffMap,
    /// A rim lies over ground that is not known.
    UnknownCells,
    /// No state was found that closes the gaps.
    NotConverged,
    /// While the ground grows from flat to what it is the rover, or a bogie, tips over.
    TipsOver,
}

impl Status {
    /// Every status that is told, in the order of its codes.
    pub const ALL: [Self; 5] = [Self::Settled, Self::AtStop, Self::OffMap, Self::UnknownCells, Self::NotConverged];

    /// The name Python knows it by.
    pub fn name(self) -> &'static str {
        match self {
            Self::Settled => "settled",
            Self::AtStop => "at_stop",
            Self::OffMap => "off_map",
            Self::UnknownCells => "unknown_cells",
            Self::NotConverged | Self::TipsOver => "not_converged",
        }
    }

    /// As it is told: what tips over has not converged.
    pub fn told(self) -> Self {
        match self {
            Self::TipsOver => Self::NotConverged,
            other => other,
        }
    }

    /// Why nothing stands; nothing where something does.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Settled | Self::AtStop => "",
            Self::OffMap => "the rim of a wheel leaves the map",
            Self::UnknownCells => "the rim of a wheel lies over ground that is not known",
            Self::NotConverged => "no state was found that closes the gaps",
            Self::TipsOver => "as the ground grows from flat to what it is, the rover or a bogie tips over",
        }
    }

    /// Whether the state is one that the rover stands in.
    pub fn stands(self) -> bool {
        matches!(self, Self::Settled | Self::AtStop)
    }
}

/// Puts a chain on the ground.
#[derive(Clone, Copy, Debug)]
pub struct Settler<'a> {
    /// The ground.
    pub ground: &'a Terrain,
    /// What stands on it.
    pub chain: &'a Chain,
    /// Where the weight acts, in the body [m]: it decides which wheel hangs where several might.
    pub balance: Vector3<f64>,
    /// With which instructions wheels are looked at together.
    pub level: Level,
}

/// A pose with what came of it.
#[derive(Clone, Debug)]
pub struct Settled<'a> {
    /// What came of it.
    pub status: Status,
    /// Where the chain stands; where it does not, NaN.
    pub state: State,
    /// Its wheels there; None where it does not stand.
    pub touches: Option<Touches<'a>>,
    /// Which joints are at their stops: -1 the lower, 1 the upper.
    pub stops: [i8; MAX_FREE],
    /// Bits of the wheels in the air.
    pub hanging: u32,
}

impl<'a> Settler<'a> {
    /// A chain with its weight where [`Chain::balance`] says.
    pub fn new(ground: &'a Terrain, chain: &'a Chain) -> Self {
        Self { ground, chain, balance: chain.balance(), level: Level::best() }
    }

    /// Where the chain settles at a pose with these steering angles (none of them if all are 0). Fails where a
    /// number is not finite.
    pub fn settle(&self, pose: PlanPose, steering: &[f64]) -> Result<Settled<'a>, Error> {
        finite("poses", &[pose.x, pose.y, pose.yaw])?;
        finite("steering", steering)?;
        Ok(self.settle_finite(pose, steering))
    }

    /// The same for numbers known to be finite.
    pub fn settle_finite(&self, pose: PlanPose, steering: &[f64]) -> Settled<'a> {
        self.settle_near(pose, steering, None)
    }

    /// The same, from a state that may be the answer.
    pub(super) fn settle_near(&self, pose: PlanPose, steering: &[f64], near: Option<State>) -> Settled<'a> {
        if self.chain.wheels().len() > self.chain.state_count() {
            // More wheels than can touch: which ones do is a question like that of stops.
            let start = self.guess(pose, steering, [0.0; MAX_STATE], &Hold::NONE);
            return self.standing(pose, steering, &start.unwrap_or_default(), [0; MAX_FREE]);
        }
        let near = near.and_then(|near| self.close(pose, steering, near, &Hold::NONE));
        let attempt = match near.filter(|attempt| attempt.closed) {
            Some(attempt) => Ok(attempt),
            None => self.free(pose, steering),
        };
        match attempt {
            Ok(attempt) => {
                let past = self.past(&attempt.state);
                if past == [0; MAX_FREE] {
                    return self.settled(attempt, [0; MAX_FREE], 0);
                }
                self.standing(pose, steering, &attempt.state, past)
            }
            Err(reason) => self.stopped(pose, steering, reason),
        }
    }

    /// Nothing stands with free joints: with stops something may.
    fn stopped(&self, pose: PlanPose, steering: &[f64], reason: Status) -> Settled<'a> {
        let ranges = || self.chain.joints().iter().map(|joint| joint.range);
        let ends = ranges().any(|range| range.lower.is_finite() || range.upper.is_finite());
        let lost = matches!(reason, Status::NotConverged | Status::TipsOver);
        let start = self.guess(pose, steering, [0.0; MAX_STATE], &Hold::NONE);
        let standing =
            start.filter(|_| ends && lost).and_then(|start| self.stand(pose, steering, &start, [0; MAX_FREE]));
        standing.map_or_else(
            || self.failed(reason),
            |standing| self.settled(standing.attempt, standing.stops, standing.hold.hanging),
        )
    }

    fn standing(&self, pose: PlanPose, steering: &[f64], near: &State, stops: Stops) -> Settled<'a> {
        match self.stand(pose, steering, near, stops) {
            Some(standing) => self.settled(standing.attempt, standing.stops, standing.hold.hanging),
            None => self.failed(self.reason(pose, steering, near)),
        }
    }

    /// Gaps closed with no joint at a stop, from several starts.
    fn free(&self, pose: PlanPose, steering: &[f64]) -> Result<Attempt<'a>, Status> {
        let mut reason = Status::NotConverged;
        for number in 0..STARTS {
            let start = self.guess(pose, steering, bent(number), &Hold::NONE);
            let Some(mut start) = start else { continue };
            if number > 0 {
                // Elsewhere than where the first attempt went.
                let bend = bent(number);
                start[0] += 0.1;
                let free = start.iter_mut().zip(bend).take(self.chain.state_count());
                for (value, bend) in free.skip(1) {
                    *value = 0.5 * *value + bend;
                }
            }
            let Some(attempt) = self.close(pose, steering, start, &Hold::NONE) else {
                continue;
            };
            if attempt.closed {
                return Ok(attempt);
            }
            reason = reason_of(&attempt.touches);
            if reason != Status::NotConverged && number >= 2 {
                break; // half blind: nothing to be found by looking longer
            }
        }
        if reason == Status::NotConverged {
            return self.grown(pose, steering);
        }
        Err(reason)
    }

    /// Why a chain does not stand near a state.
    fn reason(&self, pose: PlanPose, steering: &[f64], near: &State) -> Status {
        let part = super::rim::Part::Whole;
        self.touches(pose, near, steering, part, None).map_or(Status::NotConverged, |touches| reason_of(&touches))
    }

    fn settled(&self, attempt: Attempt<'a>, stops: Stops, hanging: u32) -> Settled<'a> {
        let reason = reason_of(&attempt.touches);
        if reason != Status::NotConverged {
            return self.failed(reason);
        }
        let status = if stops == [0; MAX_FREE] { Status::Settled } else { Status::AtStop };
        Settled { status, state: attempt.state, touches: Some(attempt.touches), stops, hanging }
    }

    fn failed(&self, status: Status) -> Settled<'a> {
        Settled { status, state: [f64::NAN; MAX_STATE], touches: None, stops: [0; MAX_FREE], hanging: 0 }
    }
}

/// Attempts from different starts.
const STARTS: usize = 14;

/// Angles of a start: level, then bent more and more, always the same.
fn bent(number: usize) -> State {
    let mut state = [0.0; MAX_STATE];
    if number == 0 {
        return state;
    }
    let size = 0.06 * number as f64;
    for (k, angle) in state.iter_mut().enumerate().skip(1) {
        // The golden ratio's multiples, spread over -1 to 1.
        let spread = (0.618_033_988_749_894_9 * (7 * number + k) as f64).fract();
        *angle = size.min(0.4) * (2.0 * spread - 1.0);
    }
    state
}

/// Off the map, over unknown ground, or neither.
fn reason_of(touches: &Touches<'_>) -> Status {
    match touches.blind() {
        [_, true] => Status::OffMap,
        [true, false] => Status::UnknownCells,
        [false, false] => Status::NotConverged,
    }
}
