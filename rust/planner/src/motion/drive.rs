//! Rollouts: from the controls of every step to the motion and the poses of a rover within its limits.
//!
//! The executed motion has one centre of rotation at all times, and the axles of all steered wheels pass through it:
//! nothing slides. A control is replaced by the nearest possible motion, and approached within the limits of
//! acceleration. Where the joints cannot follow, the motion's direction changes towards the control as far as the
//! slowest joint turns in a step. Where no continuous turn of the joints leads to the control (to a spin, say), the
//! rover stops, turns its wheels, and goes on.

use super::model::Model;
use crate::numbers::BLOCK;
use crate::numbers::norms::{Reg, largest, splat, unit_scale, value};
use six_wheel_numerics::simd::float::Float;
use six_wheel_numerics::simd::polynomials::{horner, taylor};
use six_wheel_numerics::simd::vector::Vector;

/// Speed of the pivots below which the rover counts as at rest [m/s].
pub(crate) const REST: f64 = 1e-6;

/// Largest half turn of a step for which the series are exact to rounding [rad].
const SMALL: f64 = 0.25;

/// Quantities in a block's track, from which its costs are computed: `[step][quantity][rollout]`.
pub(crate) const TRACK: usize = 4; // x, y, cosine and sine

/// Initial state of all rollouts of a cycle.
#[derive(Clone, Debug, Default)]
pub(crate) struct RolloutStart {
    /// The motion, and the motion for which the joints are aligned, in components.
    pub motion: [f64; 3],
    pub setpoint: [f64; 3],
    /// True if the joints are aligned for no motion, and their angles then [rad].
    pub steering_is_free: bool,
    pub angles: Vec<f64>,
    /// Heading of the components' axes [rad].
    pub heading: f64,
    /// True if the headings of the steps are needed.
    pub headings: bool,
    /// Number of halvings of a step's turn for the series, and true if the short ones are exact.
    pub angle_halvings: u32,
    pub use_short_series: bool,
    /// Factor from a yaw rate to the smallest of these turns [s].
    pub smallest: f64,
    /// Weights of effort [1/(m²/s²) 1/s] and of sliding, over a step.
    pub effort: f64,
    pub scrub: f64,
}

impl RolloutStart {
    /// Chooses the series for turns up to this yaw rate [rad/s].
    pub fn choose_series(&mut self, fastest: f64, dt: f64) {
        let half = fastest * dt / 2.0;
        self.angle_halvings = if half > SMALL { (half / SMALL).log2().ceil().min(60.0) as u32 } else { 0 };
        self.use_short_series = half <= SMALL / 8.0;
        self.smallest = 0.5 * dt / f64::from(self.angle_halvings).exp2();
    }
}

/// State of as many rollouts as there are lanes.
#[derive(Clone, Copy)]
pub(crate) struct State<S: Vector, R: Float, const M: usize> {
    /// The motion, and the motion for which the joints are aligned, in components.
    pub motion: [Reg<S, R>; M],
    pub setpoint: [Reg<S, R>; M],
    /// Remaining time of an alignment at rest [s]; negative where the joints are aligned for no motion.
    pub busy: Reg<S, R>,
    /// Position relative to the start [m].
    pub position: [Reg<S, R>; 2],
    /// Cosine and sine of the heading of the components' axes.
    pub heading: [Reg<S, R>; 2],
    pub cost: Reg<S, R>,
}

impl<R: Float, const M: usize> Model<R, M> {
    /// Number of rollouts that are simulated at once.
    pub fn lane_count<S: Vector>() -> usize {
        Reg::<S, R>::lanes()
    }

    /// Simulates [`Self::lane_count`] rollouts from `at` on by their controls `[step][component][rollout]`, and adds
    /// the costs of effort and sliding to `costs`. With `record`, the motions are written there too.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // the rollouts, the controls, the results
    pub fn drive<S: Vector>(
        &self,
        simd: S,
        initial: &RolloutStart,
        at: usize,
        controls: &[R],
        track: &mut [R],
        costs: &mut [R],
        mut record: Option<&mut [R]>,
    ) {
        let steps = controls.len() / (M * BLOCK);
        let number = |value: f64| Reg::<S, R>::constant(simd, value);
        let (sin, cos) = initial.heading.sin_cos();
        let mut state = State {
            motion: splat(simd, &initial.motion),
            setpoint: splat(simd, &initial.setpoint),
            busy: number(if initial.steering_is_free { -1.0 } else { 0.0 }),
            position: [number(0.0); 2],
            heading: [number(cos), number(sin)],
            cost: number(0.0),
        };
        for t in 0..steps {
            let mut control = [number(0.0); M];
            for (k, control) in control.iter_mut().enumerate() {
                *control = Reg::from_slice(simd, &controls[(t * M + k) * BLOCK + at..]);
            }
            self.step(simd, initial, &mut state, control);
            self.integrate_pose(simd, initial, &mut state);
            let ([x, y], [c, s]) = (state.position, state.heading);
            let kept = if initial.headings { TRACK } else { 2 };
            for (k, value) in [x, y, c, s].into_iter().enumerate().take(kept) {
                value.copy_to_slice(&mut track[(t * TRACK + k) * BLOCK + at..]);
            }
            if let Some(record) = record.as_deref_mut() {
                for (k, value) in state.motion.into_iter().enumerate() {
                    value.copy_to_slice(&mut record[(t * M + k) * BLOCK + at..]);
                }
            }
        }
        state.cost.copy_to_slice(&mut costs[at..]);
    }

    /// The motion of a step.
    #[inline(always)]
    fn step<S: Vector>(&self, simd: S, initial: &RolloutStart, state: &mut State<S, R, M>, control: [Reg<S, R>; M]) {
        let number = |value: f64| Reg::<S, R>::constant(simd, value);
        let zero = number(0.0);
        let desired = self.limit_acceleration(simd, state.motion, control);
        let desired = self.project_onto_ranges(simd, desired);
        let mut size = zero;
        for (part, length) in desired.iter().zip(self.lengths) {
            size = part.abs().mul_add(Reg::splat(simd, length), size);
        }
        let rests = size.lt(number(REST));
        let mut motion = desired;
        for part in &mut motion {
            *part = rests.select(zero, *part);
        }
        if let Some(per_turn) = self.per_turn {
            motion = self.limit_steering(simd, initial, state, per_turn, desired, motion, rests);
        }
        let mut over = largest(simd, &self.scaling, &motion);
        if let Some(lateral) = self.lateral {
            let yaw = motion[M - 1];
            let side = self.sideways(simd, &motion);
            let square = motion[0].mul_add(motion[0], side * side);
            over = over.max((square * (yaw * yaw)).sqrt() * Reg::splat(simd, lateral));
        }
        let share = unit_scale(simd, over);
        for k in 0..M {
            state.motion[k] = motion[k] * share;
        }
        if initial.effort != 0.0 {
            let effort = value(simd, &self.metric, &state.motion);
            state.cost = effort.mul_add(number(initial.effort), state.cost);
        }
        if initial.scrub != 0.0 && !self.slips.is_empty() {
            let slip = largest(simd, &self.slips, &state.motion);
            state.cost = slip.mul_add(number(initial.scrub), state.cost);
        }
    }

    /// The motion nearest to a control, on the line from the motion before, that the limits of acceleration allow.
    #[inline(always)]
    fn limit_acceleration<S: Vector>(
        &self,
        simd: S,
        before: [Reg<S, R>; M],
        control: [Reg<S, R>; M],
    ) -> [Reg<S, R>; M] {
        if self.speeding.is_empty() && self.slowing.is_none() {
            return control;
        }
        let mut change = control;
        for k in 0..M {
            change[k] = control[k] - before[k];
        }
        let mut worst = largest(simd, &self.speeding, &change);
        if let Some(slowing) = &self.slowing {
            let [after, now] = [value(simd, &self.metric, &control), value(simd, &self.metric, &before)];
            worst = after.lt(now).select(largest(simd, slowing, &change), worst);
        }
        let share = unit_scale(simd, worst);
        let mut desired = control;
        for k in 0..M {
            desired[k] = change[k].mul_add(share, before[k]);
        }
        desired
    }

    /// Sideways velocity of the origin [m/s].
    #[inline(always)]
    fn sideways<S: Vector>(&self, simd: S, motion: &[Reg<S, R>; M]) -> Reg<S, R> {
        if M == 2 { motion[1] * Reg::splat(simd, self.sideways) } else { motion[1] }
    }

    /// The pose at the end of a step, exact for a constant motion.
    #[inline(always)]
    fn integrate_pose<S: Vector>(&self, simd: S, initial: &RolloutStart, state: &mut State<S, R, M>) {
        let half = state.motion[M - 1] * initial.smallest;
        let (mut sin, mut cos, mut sinc) = half_turn(simd, half, initial.use_short_series);
        for _ in 0..initial.angle_halvings {
            // Double-angle formulas; the cosine last, since it uses the sine of the single angle.
            sinc = sinc * cos;
            let double = (sin * sin).mul_add(Reg::constant(simd, -2.0), Reg::constant(simd, 1.0));
            sin = sin * cos * 2.0;
            cos = double;
        }
        let [c, s] = state.heading;
        let (mc, ms) = (c * cos - s * sin, s.mul_add(cos, c * sin));
        let chord = sinc * self.dt;
        let ahead = state.motion[0] * chord;
        let side = self.sideways(simd, &state.motion) * chord;
        let [x, y] = state.position;
        state.position = [ahead.mul_add(mc, x) - side * ms, ahead.mul_add(ms, y) + side * mc];
        state.heading = [mc * cos - ms * sin, ms.mul_add(cos, mc * sin)];
    }
}

/// Sine, cosine and sine over angle of a small angle.
#[inline(always)]
fn half_turn<S: Vector, R: Float>(
    simd: S,
    half: Reg<S, R>,
    use_short_series: bool,
) -> (Reg<S, R>, Reg<S, R>, Reg<S, R>) {
    const SINC: [f64; 7] = taylor(1);
    const COS: [f64; 8] = taylor(0);
    const FEW_SINC: [f64; 4] = taylor(1);
    const FEW_COS: [f64; 5] = taylor(0);
    let square = half * half;
    let (sinc, cos) = if use_short_series {
        (horner(simd, FEW_SINC, square), horner(simd, FEW_COS, square))
    } else {
        (horner(simd, SINC, square), horner(simd, COS, square))
    };
    (half * sinc, cos, sinc)
}
