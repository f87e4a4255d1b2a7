//! Settling of one pose that rounds of [`super::batch`] leave: restarts, stops, and the status of a failure.

use super::active_set::ActiveSet;
use super::newton::{NewtonResult, OnePose};
use super::pivots::PivotOrder;
use super::rims::contact::RimSegment;
use super::settler::{Settler, Status};
use super::stand::Stand;
use super::stops::{StopCandidate, Stops};
use crate::suspension::{MAX_FREE, MAX_STATE, PlanPose, State};

impl Settler<'_> {
    /// Settles a pose of finite numbers, from a state near which its gaps may be closed.
    pub(crate) fn settle_near(&self, pose: PlanPose, steering: &[f64], near: Option<State>) -> Stand {
        let pose = &OnePose::new(self, pose, steering);
        if self.chain.wheels().len() > self.chain.state_count() {
            // More wheels than numbers of the state: the wheels in the air are found like those of joints at stops.
            let start = pose.initial_state([0.0; MAX_STATE], &ActiveSet::NONE);
            return self.standing(pose, &start, [0; MAX_FREE]);
        }
        let near = near.and_then(|near| pose.close(near, &ActiveSet::NONE));
        let attempt = match near.filter(|attempt| attempt.closed) {
            Some(attempt) => Ok(attempt),
            None => self.free(pose),
        };
        match attempt {
            Ok(attempt) => {
                let past = self.past(&attempt.state);
                if past == [0; MAX_FREE] {
                    return self.settled(&attempt, past, 0);
                }
                self.standing(pose, &attempt.state, past)
            }
            Err(reason) => self.with_stops(pose, reason),
        }
    }

    /// Settles a pose without a solution for free joints, with joints at stops if there are any; otherwise its failure.
    fn with_stops(&self, pose: &OnePose<'_>, reason: Status) -> Stand {
        let ranges = || self.chain.joints().iter().map(|joint| joint.range);
        let ends = ranges().any(|range| range.lower.is_finite() || range.upper.is_finite());
        if !ends || !matches!(reason, Status::NotConverged | Status::TipsOver) {
            return Stand::nothing(reason);
        }
        let start = pose.initial_state([0.0; MAX_STATE], &ActiveSet::NONE);
        self.stand(pose, &start, [0; MAX_FREE]).map_or(Stand::nothing(reason), |candidate| self.at_stop(&candidate))
    }

    /// Settles a pose with joints at these stops or others, or with wheels in the air, near a state.
    fn standing(&self, pose: &OnePose<'_>, near: &State, stops: Stops) -> Stand {
        match self.stand(pose, near, stops) {
            Some(candidate) => self.at_stop(&candidate),
            None => {
                let order = &PivotOrder::new(self.chain, &ActiveSet::NONE);
                let here = pose.evaluate(*near, order, RimSegment::Whole);
                Stand::nothing(here.map_or(Status::NotConverged, |here| here.result(false).reason(self.chain)))
            }
        }
    }

    fn at_stop(&self, candidate: &StopCandidate) -> Stand {
        self.settled(&candidate.attempt, candidate.stops, candidate.hold.hanging)
    }

    /// Closes the gaps with no joint at a stop, from several initial states.
    fn free(&self, pose: &OnePose<'_>) -> Result<NewtonResult, Status> {
        let mut reason = Status::NotConverged;
        for number in 0..STARTS {
            let mut start = pose.initial_state(start_angles(number), &ActiveSet::NONE);
            if number > 0 {
                // Away from the result of the first attempt.
                start[0] += 0.1;
                let free = start.iter_mut().zip(start_angles(number)).take(self.chain.state_count());
                for (value, bend) in free.skip(1) {
                    *value = 0.5 * *value + bend;
                }
            }
            let Some(attempt) = pose.close(start, &ActiveSet::NONE) else {
                continue;
            };
            if attempt.closed {
                return Ok(attempt);
            }
            reason = attempt.reason(self.chain);
            if reason != Status::NotConverged && number >= 2 {
                break; // a part of the ground is unknown, further starts would find the same
            }
        }
        if reason == Status::NotConverged {
            return self.settle_by_continuation(pose);
        }
        Err(reason)
    }

    fn settled(&self, attempt: &NewtonResult, stops: Stops, hanging: u32) -> Stand {
        let reason = attempt.reason(self.chain);
        if reason != Status::NotConverged {
            return Stand::nothing(reason);
        }
        let status = if stops == [0; MAX_FREE] { Status::Settled } else { Status::AtStop };
        let mut stand = Stand { stops, hanging: hanging as u8, state: attempt.state, ..Stand::nothing(status) };
        for (wheel, contact) in stand.wheels.iter_mut().enumerate().take(self.chain.wheels().len()) {
            *contact = attempt.contact(self.ground, wheel);
        }
        stand
    }
}

/// Number of initial states.
const STARTS: usize = 14;

/// Angles of an initial state: 0, then deterministic angles of increasing size.
fn start_angles(number: usize) -> State {
    let mut state = [0.0; MAX_STATE];
    if number == 0 {
        return state;
    }
    let size = 0.06 * number as f64;
    for (k, angle) in state.iter_mut().enumerate().skip(1) {
        // Multiples of the golden ratio, modulo 1, are evenly distributed.
        let spread = (0.618_033_988_749_894_9 * (7 * number + k) as f64).fract();
        *angle = size.min(0.4) * (2.0 * spread - 1.0);
    }
    state
}
