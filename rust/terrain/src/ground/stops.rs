//! Joints at their stops, and the wheels that are then in the air (hanging).
//!
//! The angle of a joint at its stop is given, so that one wheel has no contact: one that the joint would lower if it
//! could turn further. On a bogie that is the wheel ahead of its joint at the upper stop and the one behind at the
//! lower. On a rocker, and on a body with more than three wheels and no joints, it may be one of several: the choice is
//! one without negative loads. Loads are vertical; the weight acts in [`Chain::balance`] or the given centre of mass,
//! except for one hundredth in the centre of every wheel, which gives a moment about the axis of a bogie without
//! contacts.

use nalgebra::Vector3;

use super::active_set::ActiveSet;
use super::linear_system::LinearSystem;
use super::newton::{NewtonResult, OnePose};
use super::settler::Settler;
use super::stand::rim_point;
use crate::suspension::{MAX_FREE, MAX_STATE, MAX_WHEELS, Placed, State};

#[allow(unused_imports)] // for the documentation
use crate::suspension::Chain;

/// Share of the weight that acts in each wheel.
const WHEEL_WEIGHT: f64 = 0.01;

/// A hanging wheel with a gap below this is in the ground [m].
const IN_THE_GROUND: f64 = -1e-9;

/// Loads and moments down to this count as not negative, as shares of the weight [1, m].
const ROUNDING: f64 = 1e-9;

/// A joint that exceeds its range by up to this is inside it [rad].
pub(crate) const AT_STOP: f64 = 1e-12;

/// Stop of each joint: -1 the lower, 1 the upper, 0 none.
pub(crate) type Stops = [i8; MAX_FREE];

/// The wheels that are tried as hanging.
#[derive(Clone, Copy, PartialEq, Eq)]
enum LiftedWheels {
    /// Wheels that a joint at its stop would lower.
    Lowered,
    /// All wheels, where there are several of those.
    Any,
}

/// A solution with joints at stops or wheels in the air.
pub(crate) struct StopCandidate {
    pub attempt: NewtonResult,
    pub hold: ActiveSet,
    pub stops: Stops,
    /// Smallest load of a touching wheel, as a share of the weight; negative: a force downwards.
    pub load: f64,
    /// Smallest moment of a stop on its joint over the weight [m]; negative: it would pull the joint against the stop.
    pub moment: f64,
    /// True if other wheels may hang at these stops, so that loads decide.
    pub open: bool,
}

impl StopCandidate {
    /// True if no moment is negative.
    fn holds(&self) -> bool {
        self.moment >= -ROUNDING
    }

    /// True if no moment and no load is negative.
    fn stands(&self) -> bool {
        self.holds() && self.load >= -ROUNDING
    }

    /// Minus the cosine of the tilt of the body, which increases with the tilt.
    fn tilt(&self) -> f64 {
        -(self.attempt.state[1].cos() * self.attempt.state[2].cos())
    }

    fn is_better_than(&self, other: Option<&Self>) -> bool {
        let worth = |standing: &Self| (standing.stands(), standing.holds());
        other.is_none_or(|other| worth(self) > worth(other) || worth(self) == worth(other) && self.load > other.load)
    }
}

impl Settler<'_> {
    /// Stops that the joints exceed.
    pub(crate) fn past(&self, state: &State) -> Stops {
        let mut stops = [0; MAX_FREE];
        for (k, joint) in self.chain.joints().iter().enumerate() {
            let angle = state[3 + k];
            stops[k] = i8::from(angle > joint.range.upper + AT_STOP) - i8::from(angle < joint.range.lower - AT_STOP);
        }
        stops
    }

    /// The solution near a state with the fewest joints at stops, and so the fewest wheels in the air; among several of
    /// these the one with the least tilt.
    pub(crate) fn stand(&self, pose: &OnePose<'_>, near: &State, first: Stops) -> Option<StopCandidate> {
        let mut found: Option<StopCandidate> = None;
        // Other wheels in the air are tried only if loads are negative in all solutions with the lowered ones.
        for whose in [LiftedWheels::Lowered, LiftedWheels::Any] {
            let is_open = |found: &Option<StopCandidate>| found.as_ref().is_none_or(|found| found.open);
            if !is_open(&found) {
                break;
            }
            let mut tried = Vec::with_capacity(27); // three to the power of three
            let mut waiting = if whose == LiftedWheels::Lowered { subsets(first) } else { self.all_stops() };
            for number in 0..=MAX_FREE {
                // A joint may exceed its range only because another one does: first subsets of these, then other stops.
                for elsewhere in [false, true] {
                    if elsewhere && number > 0 && is_open(&found) {
                        waiting.extend(self.all_stops());
                    }
                    let mut standing: Option<StopCandidate> = None;
                    while let Some(stops) = waiting.iter().rposition(|stops| held(stops) == number) {
                        let stops = waiting.remove(stops);
                        if tried.contains(&stops) {
                            continue;
                        }
                        tried.push(stops);
                        let Some(best) = self.best_of(pose, near, stops, whose, &mut waiting) else { continue };
                        if best.stands() {
                            if standing.as_ref().is_none_or(|standing| best.tilt() < standing.tilt()) {
                                standing = Some(best);
                            }
                        } else if best.holds() && best.is_better_than(found.as_ref()) {
                            found = Some(best);
                        }
                    }
                    if standing.is_some() {
                        return standing;
                    }
                }
            }
        }
        found
    }

    /// The best solution with these stops: without negative moments and loads if there is one, with the largest least
    /// load. Stops that its candidates exceed are added to those that are to be tried.
    fn best_of(
        &self,
        pose: &OnePose<'_>,
        near: &State,
        stops: Stops,
        whose: LiftedWheels,
        waiting: &mut Vec<Stops>,
    ) -> Option<StopCandidate> {
        let wheels = self.chain.wheels().len();
        let in_air = (wheels + held(&stops)).checked_sub(self.chain.state_count())?;
        let mut hold = ActiveSet::NONE;
        for (k, joint) in self.chain.joints().iter().enumerate() {
            hold.joints[k] = match stops[k] {
                1 => Some(joint.range.upper),
                -1 => Some(joint.range.lower),
                _ => None,
            };
        }
        let lowered = self.lowered(pose, near, &stops);
        let open = lowered.count_ones() as usize > in_air;
        let mut best: Option<StopCandidate> = None;
        for hanging in 0..1_u32 << wheels {
            let may = hanging & !lowered == 0 || whose == LiftedWheels::Any && open;
            let fits = hanging.count_ones() as usize == in_air && may;
            if !fits {
                continue;
            }
            hold.hanging = hanging;
            let Some(attempt) = self.attempt(pose, near, &hold) else {
                continue;
            };
            let past = self.past(&attempt.state);
            if past.iter().any(|&stop| stop != 0) {
                let both = std::array::from_fn(|k| if past[k] != 0 { past[k] } else { stops[k] });
                waiting.push(both);
                continue;
            }
            if (0..wheels).any(|wheel| !hold.touches(wheel) && attempt.gap(wheel) < IN_THE_GROUND) {
                continue;
            }
            let [load, moment] = self.least_loads(pose, &attempt, &hold, &stops);
            let standing = StopCandidate { attempt, hold, stops, load, moment, open };
            if standing.is_better_than(best.as_ref()) {
                best = Some(standing);
            }
        }
        best
    }

    /// Closes the gaps from a state nearby, or from a new initial state.
    fn attempt(&self, pose: &OnePose<'_>, near: &State, hold: &ActiveSet) -> Option<NewtonResult> {
        let attempt = pose.close(*near, hold)?;
        if attempt.closed {
            return Some(attempt);
        }
        let attempt = pose.close(pose.initial_state([0.0; MAX_STATE], hold), hold)?;
        attempt.closed.then_some(attempt)
    }

    /// Bits of the wheels that may hang at these stops: all without stops, otherwise those that one of the joints would
    /// lower if it could turn further.
    fn lowered(&self, pose: &OnePose<'_>, near: &State, stops: &Stops) -> u32 {
        let wheels = self.chain.wheels().len();
        let all = (1 << wheels) - 1;
        let Some(placed) = pose.place(near) else {
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

    /// The smallest load of a touching wheel, as a share of the weight, and the smallest moment of a stop over the
    /// weight [m]; minus infinity where the equations do not determine them.
    fn least_loads(&self, pose: &OnePose<'_>, attempt: &NewtonResult, hold: &ActiveSet, stops: &Stops) -> [f64; 2] {
        let (count, wheels) = (self.chain.state_count(), self.chain.wheels().len());
        let Some(placed) = &pose.place(&attempt.state) else {
            return [f64::NEG_INFINITY; 2];
        };
        // Virtual work: for every number of the state, the work of the loads is that of the weight.
        let body = placed.origin + placed.rotation * self.balance;
        let weight = self.weight(placed, placed.body_slopes(body));
        let mut lifts = [[0.0; MAX_STATE]; MAX_WHEELS];
        let mut touching = 0;
        for wheel in (0..wheels).filter(|&wheel| hold.touches(wheel)) {
            let at = attempt.contact(self.ground, wheel).at;
            let slopes = placed.point_slopes(wheel, rim_point(self.chain, placed, wheel, at));
            lifts[touching] = std::array::from_fn(|k| slopes[3 + k].z);
            touching += 1;
        }
        let mut system = LinearSystem::<1>::empty();
        for k in hold.free_columns(count) {
            let mut row = [0.0; MAX_STATE];
            for (target, lift) in row.iter_mut().zip(&lifts[..touching]) {
                *target = lift[k];
            }
            system.push(row, [weight[k]]);
        }
        let Some(loads) = system.solve() else {
            return [f64::NEG_INFINITY; 2];
        };
        let loads = || loads[..touching].iter().map(|load| load[0]);
        let moment = |(joint, &stop): (usize, &i8)| {
            let k = 3 + joint;
            let pushed: f64 = loads().zip(&lifts).map(|(load, lift)| load * lift[k]).sum();
            f64::from(stop) * (pushed - weight[k])
        };
        let held = stops.iter().enumerate().filter(|(_, stop)| **stop != 0);
        [loads().fold(f64::INFINITY, f64::min), held.map(moment).fold(f64::INFINITY, f64::min)]
    }

    /// Derivatives of the height of the weight by every number of the state.
    fn weight(&self, placed: &Placed<'_>, body: [Vector3<f64>; 3]) -> [f64; MAX_STATE] {
        let wheels = self.chain.wheels().len();
        let share = 1.0 - WHEEL_WEIGHT * wheels as f64;
        let mut weight = [0.0; MAX_STATE];
        for (target, slope) in weight.iter_mut().zip(body) {
            *target = share * slope.z;
        }
        for wheel in 0..wheels {
            let slopes = placed.point_slopes(wheel, placed.wheel(wheel).centre);
            for (target, slope) in weight.iter_mut().zip(&slopes[3..]) {
                *target += WHEEL_WEIGHT * slope.z;
            }
        }
        weight
    }

    /// Every combination of stops.
    fn all_stops(&self) -> Vec<Stops> {
        let joints = self.chain.joints();
        (0..27)
            .map(|k| [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1])
            .filter(|stops| {
                stops.iter().enumerate().all(|(k, &stop)| match joints.get(k) {
                    None => stop == 0,
                    Some(joint) => match stop {
                        1 => joint.range.upper.is_finite(),
                        -1 => joint.range.lower.is_finite(),
                        _ => true,
                    },
                })
            })
            .collect()
    }
}

/// All subsets of these stops; the empty one only if there are none.
fn subsets(stops: Stops) -> Vec<Stops> {
    (0..1_u32 << MAX_FREE)
        .map(|kept| std::array::from_fn(|k| if kept >> k & 1 == 1 { stops[k] } else { 0 }))
        .filter(|part| held(part) > 0 || held(&stops) == 0)
        .collect()
}

/// Number of joints at a stop.
fn held(stops: &Stops) -> usize {
    stops.iter().filter(|&&stop| stop != 0).count()
}
