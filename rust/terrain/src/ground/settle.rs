//! Settling of a chain on the ground, and the status of a failure.

use super::newton::{ActiveSet, NewtonResult};
use super::settler::{Settled, Settler, Status};
use super::stops::Stops;
use super::touch::WheelContacts;
use crate::suspension::{MAX_FREE, MAX_STATE, PlanPose, State};
use six_wheel_numerics::error::{Error, finite};

impl<'a> Settler<'a> {
    /// Settles the chain at a pose with these steering angles (none of them if all are 0). Fails where a number is not
    /// finite.
    pub fn settle(&self, pose: PlanPose, steering: &[f64]) -> Result<Settled<'a>, Error> {
        finite("poses", &[pose.x, pose.y, pose.yaw])?;
        finite("steering", steering)?;
        Ok(self.settle_finite(pose, steering))
    }

    /// The same for numbers known to be finite.
    #[inline]
    pub fn settle_finite(&self, pose: PlanPose, steering: &[f64]) -> Settled<'a> {
        self.settle_near(pose, steering, None)
    }

    /// The same, from a state that may be the answer.
    pub(crate) fn settle_near(&self, pose: PlanPose, steering: &[f64], near: Option<State>) -> Settled<'a> {
        // From here on, coordinates are distances from node (0, 0) of the map.
        let pose = pose.relative_to(self.ground.origin());
        if self.chain.wheels().len() > self.chain.state_count() {
            // More wheels than can touch: which ones do is a question like that of stops.
            let start = self.initial_state(pose, steering, [0.0; MAX_STATE], &ActiveSet::NONE);
            return self.standing(pose, steering, &start.unwrap_or_default(), [0; MAX_FREE]);
        }
        let near = near.and_then(|near| self.close(pose, steering, near, &ActiveSet::NONE));
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
        let start = self.initial_state(pose, steering, [0.0; MAX_STATE], &ActiveSet::NONE);
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
    fn free(&self, pose: PlanPose, steering: &[f64]) -> Result<NewtonResult<'a>, Status> {
        let mut reason = Status::NotConverged;
        for number in 0..STARTS {
            let start = self.initial_state(pose, steering, bent(number), &ActiveSet::NONE);
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
            let Some(attempt) = self.close(pose, steering, start, &ActiveSet::NONE) else {
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

    /// Status of a chain that does not stand near a state.
    fn reason(&self, pose: PlanPose, steering: &[f64], near: &State) -> Status {
        let part = crate::ground::rims::contact::RimSegment::Whole;
        self.touches(pose, near, steering, part).map_or(Status::NotConverged, |touches| reason_of(&touches))
    }

    fn settled(&self, attempt: NewtonResult<'a>, stops: Stops, hanging: u32) -> Settled<'a> {
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
fn reason_of(touches: &WheelContacts<'_>) -> Status {
    match touches.blind() {
        [_, true] => Status::OffMap,
        [true, false] => Status::UnknownCells,
        [false, false] => Status::NotConverged,
    }
}
