//! Joints at their stops, and which wheels then hang.
//!
//! At a stop a joint leaves the problem and a wheel hangs: one that the joint would lower if it could turn on. On
//! a bogie that is the wheel ahead of its joint at the upper stop and the one behind at the lower. On a rocker, and
//! on a body with more than three wheels and no joints, several may: those hang without which no wheel has to
//! be pulled down. Loads for that act vertically; the weight acts in [`Chain::balance`] or where the caller
//! says, but for one hundredth of it in the centre of every wheel, which is what turns a bogie that carries
//! nothing.

use nalgebra::Vector3;

use super::newton::{Attempt, Hold, System, loose};
use super::settle::Settler;
use super::touch::Touches;
use crate::suspension::{MAX_FREE, MAX_STATE, PlanPose, State};

#[allow(unused_imports)] // for the documentation
use crate::suspension::Chain;

/// Share of the weight that acts in each wheel.
const WHEEL_WEIGHT: f64 = 0.01;

/// Gap of a hanging wheel below which it is in the ground [m].
const IN_THE_GROUND: f64 = -1e-9;

/// A joint this far past its stop is at it [rad].
pub(crate) const AT_STOP: f64 = 1e-12;

/// Which stop each joint is at: -1 the lower, 1 the upper, 0 none.
pub(crate) type Stops = [i8; MAX_FREE];

/// A way to stand with joints at stops or wheels in the air.
pub(crate) struct Standing<'a> {
    pub attempt: Attempt<'a>,
    pub hold: Hold,
    pub stops: Stops,
    /// Smallest load of a wheel that touches, of the weight.
    pub load: f64,
}

impl<'a> Settler<'a> {
    /// Which joints are past their stops.
    pub(crate) fn past(&self, state: &State) -> Stops {
        let mut stops = [0; MAX_FREE];
        for (k, joint) in self.chain.joints().iter().enumerate() {
            let angle = state[3 + k];
            stops[k] = if angle > joint.range.upper + AT_STOP {
                1
            } else if angle < joint.range.lower - AT_STOP {
                -1
            } else {
                0
            };
        }
        stops
    }

    /// Stands with as many joints at stops and wheels in the air as it takes, near a state.
    pub(crate) fn stand(
        &self,
        pose: PlanPose,
        steering: &[f64],
        near: &State,
        first: Stops,
    ) -> Option<Standing<'a>> {
        let mut tried = Vec::with_capacity(27); // three to the power of three
        let mut waiting = vec![first];
        let mut fallback: Option<Standing<'a>> = None;
        let mut rest = self.all_stops().into_iter();
        while let Some(stops) = waiting.pop().or_else(|| rest.next()) {
            if tried.contains(&stops) {
                continue;
            }
            tried.push(stops);
            let best = self.best_of(pose, steering, near, stops, &mut waiting);
            if let Some(best) = best {
                if best.load >= -1e-9 {
                    return Some(best);
                }
                if fallback.as_ref().is_none_or(|other| other.load < best.load) {
                    fallback = Some(best);
                }
            }
        }
        fallback
    }

    /// The way with these stops whose least load is largest. Stops that its candidates go past are put on the
    /// list of those to try.
    fn best_of(
        &self,
        pose: PlanPose,
        steering: &[f64],
        near: &State,
        stops: Stops,
        waiting: &mut Vec<Stops>,
    ) -> Option<Standing<'a>> {
        let wheels = self.chain.wheels().len();
        let held = stops.iter().filter(|&&stop| stop != 0).count();
        let in_air = (wheels + held).checked_sub(self.chain.state_count())?;
        let mut hold = Hold::NONE;
        for (k, joint) in self.chain.joints().iter().enumerate() {
            hold.joints[k] = match stops[k] {
                1 => Some(joint.range.upper),
                -1 => Some(joint.range.lower),
                _ => None,
            };
        }
        let lowered = self.lowered(pose, steering, near, &stops);
        let mut best: Option<Standing<'a>> = None;
        for hanging in 0..1_u32 << wheels {
            let fits = hanging.count_ones() as usize == in_air && hanging & !lowered == 0;
            if !fits {
                continue;
            }
            hold.hanging = hanging;
            let Some(attempt) = self.attempt(pose, steering, near, &hold) else {
                continue;
            };
            let past = self.past(&attempt.state);
            if past.iter().any(|&stop| stop != 0) {
                let both = std::array::from_fn(|k| if past[k] != 0 { past[k] } else { stops[k] });
                waiting.push(both);
                continue;
            }
            let gap = |wheel: usize| attempt.touches.wheels[wheel].gap;
            if (0..wheels).any(|wheel| !hold.touches(wheel) && gap(wheel) < IN_THE_GROUND) {
                continue;
            }
            let load = self.least_load(&attempt, &hold);
            if best.as_ref().is_none_or(|best| load > best.load) {
                best = Some(Standing {
                    attempt,
                    hold,
                    stops,
                    load,
                });
            }
        }
        best
    }

    /// Gaps closed from a state nearby, or from a fresh guess.
    fn attempt(
        &self,
        pose: PlanPose,
        steering: &[f64],
        near: &State,
        hold: &Hold,
    ) -> Option<Attempt<'a>> {
        let attempt = self.close(pose, steering, *near, hold)?;
        if attempt.closed {
            return Some(attempt);
        }
        let guess = self.guess(pose, steering, [0.0; MAX_STATE], hold)?;
        let attempt = self.close(pose, steering, guess, hold)?;
        attempt.closed.then_some(attempt)
    }

    /// Bits of the wheels that may hang at these stops: all if there are none, otherwise those that one of the
    /// joints would lower if it could turn on.
    fn lowered(&self, pose: PlanPose, steering: &[f64], near: &State, stops: &Stops) -> u32 {
        let wheels = self.chain.wheels().len();
        let all = (1 << wheels) - 1;
        let Some(placed) = self.chain.place(pose, near, steering) else {
            return all;
        };
        if stops.iter().all(|&stop| stop == 0) {
            return all;
        }
        let mut lowered = 0;
        for wheel in 0..wheels {
            let slopes = placed.point_slopes(wheel, placed.wheel(wheel).centre);
            let falls = |k: usize| slopes[6 + k].z * f64::from(stops[k]) < 0.0;
            if (0..MAX_FREE).any(falls) {
                lowered |= 1 << wheel;
            }
        }
        lowered
    }

    /// The smallest load of a wheel that touches, of the weight; minus infinity where statics does not say.
    fn least_load(&self, attempt: &Attempt<'a>, hold: &Hold) -> f64 {
        let Some(loads) = self.loads(&attempt.touches, hold) else {
            return f64::NEG_INFINITY;
        };
        loads.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Vertical loads of the wheels that touch, in their order, of the weight.
    fn loads(&self, touches: &Touches<'_>, hold: &Hold) -> Option<Vec<f64>> {
        let (count, wheels) = (self.chain.state_count(), self.chain.wheels().len());
        let placed = &touches.placed;
        let touching: Vec<usize> = (0..wheels).filter(|&wheel| hold.touches(wheel)).collect();
        // The work of the loads on every way to move is that of the weight.
        let lifts: Vec<_> = touching
            .iter()
            .map(|&wheel| placed.point_slopes(wheel, touches.wheels[wheel].point))
            .collect();
        let body = placed.origin + placed.rotation * self.balance;
        let weight = self.weight(placed.body_slopes(body), touches);
        let mut system = System::<1>::empty();
        for k in loose(count, hold) {
            let mut row = [0.0; MAX_STATE];
            for (target, lift) in row.iter_mut().zip(&lifts) {
                *target = lift[3 + k].z;
            }
            system.push(row, [weight[k]]);
        }
        let loads = system.solve()?;
        Some(loads[..touching.len()].iter().map(|load| load[0]).collect())
    }

    /// How far the weight rises with every number of the state.
    fn weight(&self, body: [Vector3<f64>; 3], touches: &Touches<'_>) -> [f64; MAX_STATE] {
        let wheels = self.chain.wheels().len();
        let share = 1.0 - WHEEL_WEIGHT * wheels as f64;
        let mut weight = [0.0; MAX_STATE];
        for (target, slope) in weight.iter_mut().zip(body) {
            *target = share * slope.z;
        }
        for (wheel, touch) in touches.wheels.iter().enumerate().take(wheels) {
            let slopes = touches.placed.point_slopes(wheel, touch.frame.centre);
            for (target, slope) in weight.iter_mut().zip(&slopes[3..]) {
                *target += WHEEL_WEIGHT * slope.z;
            }
        }
        weight
    }

    /// Every combination of stops there is, those with few first.
    fn all_stops(&self) -> Vec<Stops> {
        let joints = self.chain.joints();
        let mut all: Vec<Stops> = (0..27)
            .map(|k| [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1])
            .filter(|stops| {
                stops
                    .iter()
                    .enumerate()
                    .all(|(k, &stop)| match joints.get(k) {
                        None => stop == 0,
                        Some(joint) => match stop {
                            1 => joint.range.upper.is_finite(),
                            -1 => joint.range.lower.is_finite(),
                            _ => true,
                        },
                    })
            })
            .collect();
        all.sort_by_key(|stops| stops.iter().filter(|&&stop| stop != 0).count());
        all
    }
}
