//! Rollouts: from what is wished at every step to where a rover gets within its limits.
//!
//! The executed motion has one centre of rotation at all times, and all steered wheels point at it: nothing slides. A
//! wish is approached as far as acceleration allows; what the rover cannot do becomes the nearest it can. Where the
//! joints cannot follow, the motion's direction goes towards the wish as far as the slowest joint does. Where no
//! continuous turn of the joints leads there (to spin on the spot, say), the rover stops, turns its wheels, and goes on.

use super::model::Model;
use crate::numbers::BLOCK;
use crate::numbers::norms::{Reg, down_to_one, largest, splat, value};
use six_wheel_numerics::simd::float::Float;
use six_wheel_numerics::simd::polynomials::{horner, taylor};
use six_wheel_numerics::simd::vector::Vector;

/// Speed of the pivots below which a motion is none [m/s].
pub(crate) const REST: f64 = 1e-6;

/// Largest half turn of a step the polynomials are for [rad].
const SMALL: f64 = 0.25;

/// Quantities in a block's track, from which its costs are computed: `[step][quantity][rollout]`.
pub(crate) const TRACK: usize = 4; // x, y, cosine and sine

/// Initial state of all rollouts of a cycle.
#[derive(Clone, Debug, Default)]
pub(crate) struct Begin {
    /// The motion, and what the joints are set for.
    pub motion: [f64; 3],
    pub setting: [f64; 3],
    /// True if the joints are set for no motion, and their angles then [rad].
    pub loose: bool,
    pub angles: Vec<f64>,
    /// Heading of the components' axes [rad].
    pub heading: f64,
    /// True if the headings of the steps are needed.
    pub headings: bool,
    /// Number of halvings of a step's turn for the polynomials, and true if few terms are enough.
    pub halvings: u32,
    pub few: bool,
    /// Factor from a yaw rate to the smallest of these turns [s].
    pub smallest: f64,
    /// Weights of effort [1/(m²/s²) 1/s] and of sliding, over a step.
    pub effort: f64,
    pub scrub: f64,
}

impl Begin {
    /// Chooses the polynomials for turns up to this yaw rate [rad/s].
    pub fn turns(&mut self, fastest: f64, dt: f64) {
        let half = fastest * dt / 2.0;
        self.halvings = if half > SMALL { (half / SMALL).log2().ceil().min(60.0) as u32 } else { 0 };
        self.few = half <= SMALL / 8.0;
        self.smallest = 0.5 * dt / f64::from(self.halvings).exp2();
    }
}

impl<S: Vector, R: Float, const M: usize> Clone for State<S, R, M> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Vector, R: Float, const M: usize> Copy for State<S, R, M> {}

pub(crate) struct State<S: Vector, R: Float, const M: usize> {
    pub motion: [Reg<S, R>; M],
    pub setting: [Reg<S, R>; M],
    /// Time the joints still need [s]; negative where they are set for no motion yet.
    pub busy: Reg<S, R>,
    pub place: [Reg<S, R>; 2],
    pub heading: [Reg<S, R>; 2],
    pub cost: Reg<S, R>,
}

impl<R: Float, const M: usize> Model<R, M> {
    /// Rollouts that are driven at once.
    pub fn abreast<S: Vector>() -> usize {
        Reg::<S, R>::lanes()
    }

    /// Drives the rollouts from `at` on, as many as go abreast, by their wishes `[step][component][rollout]`, and adds to
    /// their costs what the motion itself costs. With `record`, the motions are written there too.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // where they are, the wishes, the results
    pub fn drive<S: Vector>(
        &self,
        simd: S,
        begin: &Begin,
        at: usize,
        wishes: &[R],
        track: &mut [R],
        costs: &mut [R],
        mut record: Option<&mut [R]>,
    ) {
        let steps = wishes.len() / (M * BLOCK);
        let number = |value: f64| Reg::<S, R>::constant(simd, value);
        let (sin, cos) = begin.heading.sin_cos();
        let mut state = State {
            motion: splat(simd, &begin.motion),
            setting: splat(simd, &begin.setting),
            busy: number(if begin.loose { -1.0 } else { 0.0 }),
            place: [number(0.0); 2],
            heading: [number(cos), number(sin)],
            cost: number(0.0),
        };
        for t in 0..steps {
            let mut wish = [number(0.0); M];
            for (k, wish) in wish.iter_mut().enumerate() {
                *wish = Reg::from_slice(simd, &wishes[(t * M + k) * BLOCK + at..]);
            }
            self.step(simd, begin, &mut state, wish);
            self.move_on(simd, begin, &mut state);
            let ([x, y], [c, s]) = (state.place, state.heading);
            let kept = if begin.headings { TRACK } else { 2 };
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
    fn step<S: Vector>(&self, simd: S, begin: &Begin, state: &mut State<S, R, M>, wish: [Reg<S, R>; M]) {
        let number = |value: f64| Reg::<S, R>::constant(simd, value);
        let zero = number(0.0);
        let before = state.motion;
        let mut wanted = wish;
        if !self.speeding.is_empty() || self.slowing.is_some() {
            let mut change = wish;
            for k in 0..M {
                change[k] = wish[k] - before[k];
            }
            let mut worst = largest(simd, &self.speeding, &change);
            if let Some(slowing) = &self.slowing {
                let [slow, now] = [value(simd, &self.metric, &wish), value(simd, &self.metric, &before)];
                worst = slow.below(now).select(largest(simd, slowing, &change), worst);
            }
            let share = down_to_one(simd, worst);
            for k in 0..M {
                wanted[k] = change[k].mul_add(share, before[k]);
            }
        }
        wanted = self.possible(simd, wanted);
        let mut size = zero;
        for (part, length) in wanted.iter().zip(self.lengths) {
            size = part.abs().mul_add(Reg::splat(simd, length), size);
        }
        let rests = size.below(number(REST));
        let mut motion = wanted;
        for part in &mut motion {
            *part = rests.select(zero, *part);
        }
        if let Some(per_turn) = self.per_turn {
            motion = self.steered(simd, begin, state, per_turn, wanted, motion, rests);
        }
        let mut over = largest(simd, &self.scaling, &motion);
        if let Some(lateral) = self.lateral {
            let yaw = motion[M - 1];
            let side = if M == 2 { yaw * Reg::splat(simd, self.sideways) } else { motion[1] };
            let square = motion[0].mul_add(motion[0], side * side);
            over = over.max((square * (yaw * yaw)).sqrt() * Reg::splat(simd, lateral));
        }
        let share = down_to_one(simd, over);
        for k in 0..M {
            state.motion[k] = motion[k] * share;
        }
        if begin.effort != 0.0 {
            let effort = value(simd, &self.metric, &state.motion);
            state.cost = effort.mul_add(number(begin.effort), state.cost);
        }
        if begin.scrub != 0.0 && !self.slips.is_empty() {
            let slip = largest(simd, &self.slips, &state.motion);
            state.cost = slip.mul_add(number(begin.scrub), state.cost);
        }
    }

    /// The way of a step, exact for a constant motion.
    #[inline(always)]
    fn move_on<S: Vector>(&self, simd: S, begin: &Begin, state: &mut State<S, R, M>) {
        let number = |value: f64| Reg::<S, R>::constant(simd, value);
        let one = number(1.0);
        let yaw = state.motion[M - 1];
        let half = yaw * number(begin.smallest);
        let (sin, mut cos, sinc) = half_turn(simd, half, begin.few);
        let (mut sin, mut sinc) = (sin, sinc);
        for _ in 0..begin.halvings {
            // Of twice the angle: the cosine first, while the sine is that of the single one.
            sinc = sinc * cos;
            let double = (sin * sin).mul_add(number(-2.0), one);
            sin = sin * cos * number(2.0);
            cos = double;
        }
        let [c, s] = state.heading;
        let (mc, ms) = (c * cos - s * sin, s.mul_add(cos, c * sin));
        let chord = sinc * number(self.dt);
        let along = state.motion[0] * chord;
        let side = if M == 2 { yaw * Reg::splat(simd, self.sideways) } else { state.motion[1] } * chord;
        let [x, y] = state.place;
        state.place = [along.mul_add(mc, x) - side * ms, along.mul_add(ms, y) + side * mc];
        state.heading = [mc * cos - ms * sin, ms.mul_add(cos, mc * sin)];
    }
}

/// Sine, cosine and sine over angle of a small angle.
#[inline(always)]
fn half_turn<S: Vector, R: Float>(simd: S, half: Reg<S, R>, few: bool) -> (Reg<S, R>, Reg<S, R>, Reg<S, R>) {
    const SINC: [f64; 7] = taylor(1);
    const COS: [f64; 8] = taylor(0);
    const FEW_SINC: [f64; 4] = taylor(1);
    const FEW_COS: [f64; 5] = taylor(0);
    let square = half * half;
    let (sinc, cos) = if few {
        (horner(simd, FEW_SINC, square), horner(simd, FEW_COS, square))
    } else {
        (horner(simd, SINC, square), horner(simd, COS, square))
    };
    (half * sinc, cos, sinc)
}
