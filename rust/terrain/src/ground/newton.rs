//! Newton's method with a line search, for one pose: those that rounds of [`super::batch`] leave, and active sets.
//!
//! Every evaluation searches the whole lower halves of the rims; the upper halves are searched when the gaps are
//! closed. Gaps, their slopes and the step are those of the rounds ([`RimScan`], [`solve`]).

use pulp::Scalar;

use super::active_set::{ActiveSet, CLOSED_GAP};
use super::batch::initial_state;
use super::pivots::{PivotOrder, Rows, SMALLEST_PIVOT, solve};
use super::poses::PoseOnGrid;
use super::rims::circles::WheelCircle;
use super::rims::contact::{Minimum, RimContact, RimSegment, find_contacts};
use super::scan::{RimScan, Site, StateLanes, WheelGap};
use super::settler::{Settler, Status};
use super::stand::Contact;
use crate::suspension::lanes::all;
use crate::suspension::{Chain, MAX_STATE, MAX_WHEELS, Placed, PlanPose, State};
use crate::terrain::Terrain;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::{Kernel, Level, run_scalar};
use six_wheel_numerics::simd::vector::Vector;

/// Largest change of any angle in one step [rad].
const LARGEST_TURN: f64 = 0.3;

/// Largest angle of a settled pose [rad].
pub(crate) const LARGEST_ANGLE: f64 = 1.35;

/// A gap below this that no step reduces counts as closed [m]: rounding.
const ROUNDING: f64 = 1e-10;

/// Steps of one attempt.
const STEPS: usize = 40;

/// Steps without a smaller gap after which another start is tried.
const STALLS: usize = 5;

/// The state of a chain with closed gaps, or the best state of an attempt.
#[derive(Clone, Debug)]
pub(crate) struct NewtonResult {
    pub state: State,
    pub rims: [RimContact; MAX_WHEELS],
    pub closed: bool,
}

impl NewtonResult {
    /// The reason of a failure: off the map, over unknown ground, or not converged.
    pub fn reason(&self, chain: &Chain) -> Status {
        let rims = &self.rims[..chain.wheels().len()];
        if rims.iter().any(|rim| rim.outside) {
            Status::OffMap
        } else if rims.iter().any(|rim| rim.unknown) {
            Status::UnknownCells
        } else {
            Status::NotConverged
        }
    }

    /// Least gap of a wheel [m]; NaN over unknown ground.
    pub fn gap(&self, wheel: usize) -> f64 {
        self.rims[wheel].least.map_or(f64::NAN, |least| least.gap)
    }

    /// Contact of a wheel.
    pub fn contact(&self, ground: &Terrain, wheel: usize) -> Contact {
        let RimContact { least, next, .. } = self.rims[wheel];
        least.map_or(Contact::NONE, |least| Contact {
            next: next.map_or(f64::NAN, |next| next.sin.atan2(next.cos)),
            ..Contact::new(ground, least.gap, least.at, least.slope)
        })
    }
}

/// A chain at a state of one pose.
#[derive(Clone, Debug)]
pub(crate) struct Evaluation {
    pub state: State,
    /// Largest gap of the wheels that touch [m]; infinite where one has no known ground.
    pub worst: f64,
    /// Newton's step, no longer than [`LARGEST_TURN`]; None where the gaps do not determine it.
    pub step: Option<State>,
    /// Least gap of every wheel [m], its derivatives by the state, and height of the point of the rim [m].
    pub gaps: [f64; MAX_WHEELS],
    pub slopes: [State; MAX_WHEELS],
    pub heights: [f64; MAX_WHEELS],
    pub rims: [RimContact; MAX_WHEELS],
}

/// One pose with its steering, on ground whose heights above a datum are multiplied by a factor.
#[derive(Clone, Copy)]
pub(crate) struct OnePose<'a> {
    chain: &'a Chain,
    ground: &'a Terrain,
    level: Level,
    /// Relative to node (0, 0) of the map.
    pose: PlanPose,
    on_grid: PoseOnGrid,
    steering: &'a [f64],
    /// The factor, and the datum [m].
    over: [f64; 2],
}

impl<'a> OnePose<'a> {
    pub fn new(settler: &Settler<'a>, pose: PlanPose, steering: &'a [f64]) -> Self {
        let Settler { chain, ground, level, .. } = *settler;
        let on_grid = PoseOnGrid::new(ground, pose);
        let pose = pose.relative_to(ground.placement().origin());
        Self { chain, ground, level, pose, on_grid, steering, over: [1.0, 0.0] }
    }

    /// The same on ground whose heights above a datum [m] are multiplied by a factor.
    pub fn over(self, [share, datum]: [f64; 2]) -> Self {
        Self { over: [share, datum], ..self }
    }

    /// The pose in the plane, relative to node (0, 0) of the map.
    pub fn plan_pose(&self) -> PlanPose {
        self.pose
    }

    /// The chain, relative to node (0, 0) of the map. None where a differential has no solution.
    pub fn place(&self, state: &State) -> Option<Placed<'a>> {
        self.chain.place(self.pose, state, self.steering)
    }

    /// Gaps and step at a state. None where a differential has no solution.
    pub fn evaluate(&self, state: State, order: &PivotOrder, segment: RimSegment) -> Option<Evaluation> {
        self.level.run_any(Evaluate { pose: self, state, order, segment })
    }

    /// A state to start from: see [`initial_state`].
    pub fn initial_state(&self, state: State, hold: &ActiveSet) -> State {
        let order = &PivotOrder::new(self.chain, hold);
        run_scalar(start, (self, hold.held(state), order))
    }

    #[inline(always)]
    fn lanes(&self, state: &State) -> StateLanes<Scalar> {
        let PoseOnGrid { origin: [x, y], heading } = self.on_grid;
        let (zero, unit) = (all(Scalar, 0.0), all(Scalar, 1.0));
        let mut lanes = StateLanes {
            origin: [all(Scalar, x), all(Scalar, y)],
            yaw: (all(Scalar, heading.sin), all(Scalar, heading.cos)),
            state: [zero; MAX_STATE],
            steering: None,
            contacts: [[zero, unit]; MAX_WHEELS],
        };
        for (number, value) in lanes.state.iter_mut().zip(state) {
            *number = all(Scalar, *value);
        }
        if !self.steering.is_empty() {
            let mut steering = [(zero, unit); MAX_WHEELS];
            for (turned, angle) in steering.iter_mut().zip(self.steering) {
                let (sin, cos) = angle.sin_cos();
                *turned = (all(Scalar, sin), all(Scalar, cos));
            }
            lanes.steering = Some(steering);
        }
        lanes
    }

    /// Closes the gaps from an initial state. None where a differential has no solution.
    pub fn close(&self, start: State, hold: &ActiveSet) -> Option<NewtonResult> {
        let order = &PivotOrder::new(self.chain, hold);
        let (mut segment, mut stalls) = (RimSegment::Lower, 0);
        let mut here = self.evaluate(hold.held(start), order, segment)?;
        for _ in 0..STEPS {
            if here.is_closed() && segment == RimSegment::Lower {
                // A search of the whole rim excludes other contacts.
                segment = RimSegment::Whole;
                here = self.evaluate(here.state, order, segment)?;
            }
            if here.is_closed() {
                return Some(here.result(true));
            }
            let Some(step) = here.step else { break };
            let Some(trial) = self.line_search(&here, &step, order, segment)? else { break };
            if trial.worst >= here.worst {
                if here.worst < ROUNDING {
                    // The remaining gap is rounding.
                    let whole = self.evaluate(here.state, order, RimSegment::Whole)?;
                    let closed = whole.worst < ROUNDING;
                    return Some(whole.result(closed));
                }
                stalls += 1;
                if stalls > STALLS {
                    break;
                }
            }
            here = trial;
        }
        Some(here.result(false))
    }

    /// The best of a step and its halves, up to the first that reduces the gaps sufficiently. The outer Option is None
    /// where a differential has no solution, the inner one where every trial exceeds [`LARGEST_ANGLE`].
    fn line_search(
        &self,
        here: &Evaluation,
        step: &State,
        order: &PivotOrder,
        segment: RimSegment,
    ) -> Option<Option<Evaluation>> {
        let (mut found, mut share): (Option<Evaluation>, f64) = (None, 1.0);
        while share > 0.01 {
            let state: State = std::array::from_fn(|k| here.state[k] + share * step[k]);
            if state[1..].iter().all(|angle| angle.abs() < LARGEST_ANGLE) {
                let trial = self.evaluate(state, order, segment)?;
                let is_enough = trial.worst < here.worst * (1.0 - 0.3 * share) || trial.worst <= tolerance(&here.state);
                if found.as_ref().is_none_or(|found| trial.worst < found.worst) {
                    found = Some(trial);
                }
                if is_enough {
                    break;
                }
            }
            share *= 0.5;
        }
        Some(found)
    }
}

/// Gap up to which it counts as closed [m].
fn tolerance(state: &State) -> f64 {
    state[0].abs().mul_add(CLOSED_GAP[1], CLOSED_GAP[0])
}

impl Evaluation {
    fn is_closed(&self) -> bool {
        self.worst <= tolerance(&self.state)
    }

    pub fn result(&self, closed: bool) -> NewtonResult {
        NewtonResult { state: self.state, rims: self.rims, closed }
    }
}

/// See [`OnePose::initial_state`].
#[inline(always)]
fn start((pose, state, order): (&OnePose<'_>, State, &PivotOrder)) -> State {
    let OnePose { chain, ground, .. } = *pose;
    let mut here = pose.lanes(&state);
    initial_state(Scalar, &Site { chain, ground, order }, &mut here);
    numbers(&here.state)
}

/// See [`OnePose::evaluate`].
struct Evaluate<'a> {
    pose: &'a OnePose<'a>,
    state: State,
    order: &'a PivotOrder,
    segment: RimSegment,
}

impl Kernel for Evaluate<'_> {
    type Output = Option<Evaluation>;

    #[inline(always)]
    fn run<W: Vector>(self, wide: W) -> Option<Evaluation> {
        let OnePose { chain, ground, over: [share, datum], .. } = *self.pose;
        let site = &Site { chain, ground, order: self.order };
        let here = self.pose.lanes(&self.state);
        let (poses, per_metre) = (here.poses(Scalar, chain), site.per_metre(Scalar));
        if !poses.links.reaches.any() {
            return None;
        }
        let real = here.circles(Scalar, site, &poses, per_metre);
        let mut circles = real;
        if share != 1.0 {
            // The gap over ground scaled by s is s times that of a circle at 1 / s times the height.
            circles = circles.map(|WheelCircle { centre: [x, y, z], forward, up }| WheelCircle {
                centre: [x, y, datum + (z - datum) / share],
                forward: [forward[0], forward[1], forward[2] / share],
                up: [up[0], up[1], up[2] / share],
            });
        }
        let found = find_contacts(wide, ground, &circles, chain.wheels().len(), self.segment);
        let mut scan = RimScan::empty(Scalar, poses.links.reaches);
        for (wheel, rim) in found.iter().enumerate().take(chain.wheels().len().min(MAX_WHEELS)) {
            scan.add(Scalar, site, &poses, wheel, &poses.wheel(Scalar, wheel), per_metre, wheel_gap(rim, share));
        }
        let height = |wheel: usize| {
            let WheelCircle { centre, forward, up } = real[wheel];
            let lowest = |least: Minimum| centre[2] + (forward[2] * least.at.sin - up[2] * least.at.cos);
            found[wheel].least.map_or(f64::NAN, lowest)
        };
        let mut evaluation = Evaluation {
            state: self.state,
            worst: if scan.touches.any() { scan.worst.last(Scalar) } else { f64::INFINITY },
            step: None,
            gaps: scan.found.map(|wheel| wheel.gap.last(Scalar)),
            slopes: scan.rows.map(|(slopes, _)| numbers(&slopes)),
            heights: std::array::from_fn(height),
            rims: std::array::from_fn(|wheel| found[wheel]),
        };
        if evaluation.worst.is_finite() && self.order.is_square {
            evaluation.step = newton_step(self.order, &mut scan.rows);
        }
        Some(evaluation)
    }
}

/// Newton's step, no longer than [`LARGEST_TURN`]. None if the system is singular.
#[inline(always)]
fn newton_step(order: &PivotOrder, rows: &mut Rows<Scalar>) -> Option<State> {
    let (step, smallest) = solve(Scalar, order, rows);
    let mut step = numbers(&step);
    if !(smallest.last(Scalar) >= SMALLEST_PIVOT && step.iter().all(|number| number.is_finite())) {
        return None;
    }
    let turn = step[1..].iter().fold(0.0, |most: f64, turn| most.max(turn.abs()));
    if turn > LARGEST_TURN {
        step = step.map(|value| value * (LARGEST_TURN / turn));
    }
    Some(step)
}

/// The gap of a wheel over ground of a share of its heights; NaN where there is none.
#[inline(always)]
fn wheel_gap(rim: &RimContact, share: f64) -> WheelGap<Scalar> {
    let (mut gap, mut at, mut slope) = (f64::NAN, [0.0, 1.0], [0.0; 2]);
    if let Some(least) = rim.least {
        (gap, at) = (least.gap * share, [least.at.sin, least.at.cos]);
        slope = [least.slope[0] * share, least.slope[1] * share];
    }
    let one = |value: f64| all(Scalar, value);
    WheelGap { gap: one(gap), at: at.map(one), slope: slope.map(one), clear: one(0.0) }
}

#[inline(always)]
fn numbers(lanes: &[Lanes<Scalar>; MAX_STATE]) -> State {
    lanes.map(|lane| lane.last(Scalar))
}
