//! Rollouts: from what is wished at every step to where a rover gets within its limits.
//!
//! The executed motion has one centre of rotation at all times, and all steered wheels point at it: nothing slides. A
//! wish is approached as far as acceleration allows; what the rover cannot do becomes the nearest it can. Where the
//! joints cannot follow, the motion's direction goes towards the wish as far as the slowest joint does. Where no
//! continuous turn of the joints leads there (to spin on the spot, say), the rover stops, turns its wheels, and goes on.

use pulp::Simd;

use super::BLOCK;
use super::facts::{Facts, Form, Gap, Joint};
use super::registers::{Real, Reg, Truth};

/// Speed of the pivots below which a motion is none [m/s].
pub(crate) const REST: f64 = 1e-6;
/// Registers that are driven in turn, to hide latency.
const GROUP: usize = 2;
/// Largest half turn of a step the polynomials are for [rad].
const SMALL: f64 = 0.25;

/// What a block leaves behind for its costs: `[step][quantity][rollout]`.
pub(crate) const TRACK: usize = 4; // x, y, cosine and sine

struct Wheel<R, const M: usize> {
    along: [R; M],
    across: [R; M],
}

impl<R: Real, const M: usize> Wheel<R, M> {
    fn of(joint: &Joint) -> Self {
        Self {
            along: row(&joint.along),
            across: row(&joint.across),
        }
    }
}

/// What is within a range, and how far the motion inside is from its ends.
struct Range<R, const M: usize> {
    wheel: Wheel<R, M>,
    sin: R,
    cos: R,
    sense: R,
    per_margin: R,
}

/// A gap as its ends, their shares and one over their lengths: see [`Gap`].
type Ends<R> = ([[R; 2]; 2], [[R; 2]; 2], [R; 2]);

/// The way out of what is impossible where no wheel is fixed.
struct Toward<R, const M: usize> {
    inside: [R; M],
    ranges: Vec<Range<R, M>>,
}

/// A rover for rollouts of one kind of number.
pub(crate) struct Model<R, const M: usize> {
    joints: Vec<Wheel<R, M>>,
    facts: Vec<Joint>,
    /// One over the tangent of a joint's largest turn in a step; nothing where joints turn at once.
    per_turn: Option<R>,
    gaps: Vec<Ends<R>>,
    toward: Option<Toward<R, M>>,
    metric: [R; 6],
    lengths: [R; M],
    scaling: Vec<[R; 6]>,
    lateral: Option<R>,
    speeding: Vec<[R; 6]>,
    /// Where slowing down is limited otherwise.
    slowing: Option<Vec<[R; 6]>>,
    slips: Vec<[R; 6]>,
    sideways: R,
    rate: f64,
    acceleration: f64,
    dt: f64,
}

fn form<R: Real>(form: &[f64], factor: f64) -> [R; 6] {
    let mut coefficients = [R::default(); 6];
    for (to, from) in coefficients.iter_mut().zip(form) {
        *to = R::of(from * factor);
    }
    coefficients
}

fn row<R: Real, const M: usize>(from: &[f64]) -> [R; M] {
    let mut row = [R::default(); M];
    for (to, from) in row.iter_mut().zip(from) {
        *to = R::of(*from);
    }
    row
}

impl<R: Real, const M: usize> Model<R, M> {
    pub fn new(facts: &Facts, dt: f64) -> Self {
        let limits = &facts.limits;
        let forms =
            |forms: &[Form], factor: f64| forms.iter().map(|one| form(one, factor)).collect();
        let speeding: Vec<[R; 6]> = forms(&facts.speeding, 1.0 / (dt * dt));
        let turn = limits.steering_rate * dt;
        let per_turn = (turn.is_finite() && !facts.joints.is_empty()).then(|| {
            R::of(if turn < std::f64::consts::FRAC_PI_2 {
                1.0 / turn.tan()
            } else {
                0.0
            })
        });
        let pair = |ends: [[f64; 2]; 2]| ends.map(|end| end.map(R::of));
        let gap = |gap: &Gap| (pair(gap.ends), pair(gap.shares), gap.per_length.map(R::of));
        let toward = facts.inside.as_ref().map(|inside| Toward {
            inside: row(inside),
            ranges: facts
                .joints
                .iter()
                .map(|joint| {
                    let (sin, cos) = joint.half.sin_cos();
                    let along = super::facts::dot(&joint.along, inside);
                    let margin =
                        along.abs() * sin - super::facts::dot(&joint.across, inside).abs() * cos;
                    Range {
                        wheel: Wheel::of(joint),
                        sin: R::of(sin),
                        cos: R::of(cos),
                        sense: R::of(along.signum()),
                        per_margin: R::of(1.0 / margin),
                    }
                })
                .collect(),
        });
        let same = facts.speeding == facts.slowing;
        Self {
            joints: facts.joints.iter().map(Wheel::of).collect(),
            facts: facts.joints.clone(),
            per_turn,
            gaps: facts.gaps.iter().map(gap).collect(),
            toward,
            metric: form(&facts.metric, 1.0),
            lengths: row(&facts.lengths),
            scaling: forms(&facts.scaling, 1.0),
            lateral: limits
                .lateral_acceleration
                .is_finite()
                .then(|| R::of(1.0 / limits.lateral_acceleration)),
            speeding,
            slowing: (!same).then(|| forms(&facts.slowing, 1.0 / (dt * dt))),
            slips: forms(&facts.slips, 1.0),
            sideways: R::of(facts.sideways),
            rate: limits.steering_rate,
            acceleration: limits.steering_acceleration,
            dt,
        }
    }

    /// How long the joints take from one setting to another [s].
    fn time(&self, from: [R; M], start: Option<&[f64]>, to: [R; M]) -> f64 {
        let setting = |joint: &Wheel<R, M>, motion: [R; M]| {
            let part = |row: &[R; M]| {
                row.iter()
                    .zip(motion)
                    .map(|(a, b)| a.wide() * b.wide())
                    .sum::<f64>()
            };
            let (along, across) = (part(&joint.along), part(&joint.across));
            (across / along).atan()
        };
        let mut worst: f64 = 0.0;
        for (k, joint) in self.joints.iter().enumerate() {
            let now = match start {
                Some(angles) => angles[k] - self.facts[k].middle,
                None => setting(joint, from),
            };
            let turn = (setting(joint, to) - now).abs();
            // A pivot that rests turns nowhere.
            worst = if turn > worst { turn } else { worst };
        }
        turning_time(worst, self.rate, self.acceleration)
    }
}

/// Time of a turn from rest to rest [s].
fn turning_time(turn: f64, rate: f64, acceleration: f64) -> f64 {
    if acceleration.is_infinite() {
        return turn / rate;
    }
    if turn * acceleration >= rate * rate {
        turn / rate + rate / acceleration
    } else {
        2.0 * (turn / acceleration).sqrt()
    }
}

/// Where all rollouts of a cycle begin.
#[derive(Clone, Debug, Default)]
pub(crate) struct Begin {
    /// The motion, and what the joints are set for.
    pub motion: [f64; 3],
    pub setting: [f64; 3],
    /// Whether the joints are set for no motion, and where they are then [rad].
    pub loose: bool,
    pub angles: Vec<f64>,
    /// Heading of the components' axes [rad].
    pub heading: f64,
    /// How often a step's turn is halved for the polynomials, and whether few terms do.
    pub halvings: u32,
    pub few: bool,
    /// What a yaw rate is to be multiplied by for the smallest of these turns [s].
    pub smallest: f64,
    /// Weights of effort [1/(m²/s²) 1/s] and of sliding, over a step.
    pub effort: f64,
    pub scrub: f64,
}

impl Begin {
    /// Chooses the polynomials for turns up to this yaw rate [rad/s].
    pub fn turns(&mut self, fastest: f64, dt: f64) {
        let half = fastest * dt / 2.0;
        self.halvings = if half > SMALL {
            (half / SMALL).log2().ceil().min(60.0) as u32
        } else {
            0
        };
        self.few = half <= SMALL / 8.0;
        self.smallest = 0.5 * dt / f64::from(self.halvings).exp2();
    }
}

impl<S: Simd, R: Real, const M: usize> Clone for State<S, R, M> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Simd, R: Real, const M: usize> Copy for State<S, R, M> {}

struct State<S: Simd, R: Real, const M: usize> {
    motion: [Reg<S, R>; M],
    setting: [Reg<S, R>; M],
    /// Time the joints still need [s]; negative where they are set for no motion yet.
    busy: Reg<S, R>,
    place: [Reg<S, R>; 2],
    heading: [Reg<S, R>; 2],
    cost: Reg<S, R>,
}

#[inline(always)]
fn times<S: Simd, R: Real, const M: usize>(simd: S, row: &[R; M], z: &[Reg<S, R>; M]) -> Reg<S, R> {
    let mut sum = z[0] * Reg::splat(simd, row[0]);
    for k in 1..M {
        sum = z[k].mul_add(Reg::splat(simd, row[k]), sum);
    }
    sum
}

// Loops instead of closures: those are compiled for themselves first, without the level's instructions.

/// The same motion in every lane.
#[inline(always)]
fn splat<S: Simd, R: Real, const M: usize>(simd: S, motion: &[f64; 3]) -> [Reg<S, R>; M] {
    let mut parts = [Reg::all(simd, 0.0); M];
    for (part, value) in parts.iter_mut().zip(motion) {
        *part = Reg::all(simd, *value);
    }
    parts
}

/// Area between an end of a gap and a motion.
#[inline(always)]
fn cross<S: Simd, R: Real, const M: usize>(simd: S, z: &[Reg<S, R>; M], end: [R; 2]) -> Reg<S, R> {
    z[1] * Reg::splat(simd, end[0]) - z[0] * Reg::splat(simd, end[1])
}

/// Share of an end in the motion nearest to it.
#[inline(always)]
fn share<S: Simd, R: Real, const M: usize>(simd: S, z: &[Reg<S, R>; M], row: [R; 2]) -> Reg<S, R> {
    z[1].mul_add(Reg::splat(simd, row[1]), z[0] * Reg::splat(simd, row[0]))
}

/// The value of a form.
#[inline(always)]
fn value<S: Simd, R: Real, const M: usize>(
    simd: S,
    form: &[R; 6],
    z: &[Reg<S, R>; M],
) -> Reg<S, R> {
    let mut k = 0;
    let mut sum = Reg::all(simd, 0.0);
    for i in 0..M {
        let mut part = z[i] * Reg::splat(simd, form[k]);
        k += 1;
        for other in z.iter().skip(i + 1) {
            part = other.mul_add(Reg::splat(simd, form[k]), part);
            k += 1;
        }
        sum = z[i].mul_add(part, sum);
    }
    sum
}

/// The largest of some forms.
#[inline(always)]
fn largest<S: Simd, R: Real, const M: usize>(
    simd: S,
    forms: &[[R; 6]],
    z: &[Reg<S, R>; M],
) -> Reg<S, R> {
    let mut worst = Reg::all(simd, 0.0);
    for form in forms {
        worst = worst.max(value(simd, form, z));
    }
    worst
}

/// The metric's product with a motion: its product with another one is half the mixed form.
#[inline(always)]
fn lowered<S: Simd, R: Real, const M: usize>(
    simd: S,
    form: &[R; 6],
    z: &[Reg<S, R>; M],
) -> [Reg<S, R>; M] {
    let mut low = [Reg::all(simd, 0.0); M];
    let half = Reg::all(simd, 0.5);
    let mut k = 0;
    for i in 0..M {
        for j in i..M {
            let part = Reg::splat(simd, form[k]);
            k += 1;
            if i == j {
                low[i] = z[i].mul_add(part, low[i]);
            } else {
                let part = part * half;
                low[i] = z[j].mul_add(part, low[i]);
                low[j] = z[i].mul_add(part, low[j]);
            }
        }
    }
    low
}

#[inline(always)]
fn inner<S: Simd, R: Real, const M: usize>(a: &[Reg<S, R>; M], b: &[Reg<S, R>; M]) -> Reg<S, R> {
    let mut sum = a[0] * b[0];
    for k in 1..M {
        sum = a[k].mul_add(b[k], sum);
    }
    sum
}

impl<R: Real, const M: usize> Model<R, M> {
    /// Drives a block of rollouts by their wishes `[step][component][rollout]`, and adds to their costs what the motion
    /// itself costs. With `record`, the motions are written there too.
    #[inline(always)]
    pub fn drive<S: Simd>(
        &self,
        simd: S,
        begin: &Begin,
        wishes: &[R],
        track: &mut [R],
        costs: &mut [R],
        mut record: Option<&mut [R]>,
    ) {
        let lanes = R::lanes::<S>();
        let group = (GROUP * lanes).min(BLOCK);
        let steps = wishes.len() / (M * BLOCK);
        let number = |value: f64| Reg::<S, R>::all(simd, value);
        let (sin, cos) = begin.heading.sin_cos();
        for first in (0..BLOCK).step_by(group) {
            let mut states = [State {
                motion: splat(simd, &begin.motion),
                setting: splat(simd, &begin.setting),
                busy: number(if begin.loose { -1.0 } else { 0.0 }),
                place: [number(0.0); 2],
                heading: [number(cos), number(sin)],
                cost: number(0.0),
            }; GROUP];
            for t in 0..steps {
                for (m, state) in states.iter_mut().enumerate() {
                    let at = first + m * lanes;
                    let mut wish = [number(0.0); M];
                    for (k, wish) in wish.iter_mut().enumerate() {
                        *wish = Reg::load(simd, &wishes[(t * M + k) * BLOCK + at..]);
                    }
                    self.step(simd, begin, state, wish);
                    self.move_on(simd, begin, state);
                    let [x, y] = state.place;
                    let [c, s] = state.heading;
                    for (k, value) in [x, y, c, s].into_iter().enumerate() {
                        value.store(&mut track[(t * TRACK + k) * BLOCK + at..]);
                    }
                    if let Some(record) = record.as_deref_mut() {
                        for (k, value) in state.motion.into_iter().enumerate() {
                            value.store(&mut record[(t * M + k) * BLOCK + at..]);
                        }
                    }
                }
            }
            for (m, state) in states.iter().enumerate() {
                state.cost.store(&mut costs[first + m * lanes..]);
            }
        }
    }

    /// The motion of a step.
    #[inline(always)]
    fn step<S: Simd>(
        &self,
        simd: S,
        begin: &Begin,
        state: &mut State<S, R, M>,
        wish: [Reg<S, R>; M],
    ) {
        let number = |value: f64| Reg::<S, R>::all(simd, value);
        let (zero, one) = (number(0.0), number(1.0));
        let before = state.motion;
        let mut wanted = wish;
        if !self.speeding.is_empty() || self.slowing.is_some() {
            let mut change = wish;
            for k in 0..M {
                change[k] = wish[k] - before[k];
            }
            let mut worst = largest(simd, &self.speeding, &change);
            if let Some(slowing) = &self.slowing {
                let [slow, now] = [
                    value(simd, &self.metric, &wish),
                    value(simd, &self.metric, &before),
                ];
                worst = slow
                    .below(now)
                    .select(largest(simd, slowing, &change), worst);
            }
            let share = one.over(worst.max(one).sqrt());
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
            let side = if M == 2 {
                yaw * Reg::splat(simd, self.sideways)
            } else {
                motion[1]
            };
            let square = motion[0].mul_add(motion[0], side * side);
            over = over.max((square * (yaw * yaw)).sqrt() * Reg::splat(simd, lateral));
        }
        let share = one.over(over.max(one).sqrt());
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

    /// The nearest motion within the ranges.
    #[inline(always)]
    fn possible<S: Simd>(&self, simd: S, mut z: [Reg<S, R>; M]) -> [Reg<S, R>; M] {
        let zero = Reg::<S, R>::all(simd, 0.0);
        for (ends, shares, per_length) in &self.gaps {
            // Counted from the first end on, and up to the second one.
            let from = cross(simd, &z, ends[0]);
            let to = zero - cross(simd, &z, ends[1]);
            let within = zero.below(from * to);
            let [near, far] = [
                Reg::splat(simd, per_length[0]),
                Reg::splat(simd, per_length[1]),
            ];
            let first = (from.abs() * near).below(to.abs() * far);
            let part = first.select(share(simd, &z, shares[0]), share(simd, &z, shares[1]));
            for k in 0..2 {
                let end = first.select(Reg::splat(simd, ends[0][k]), Reg::splat(simd, ends[1][k]));
                z[k] = within.select(end * part, z[k]);
            }
        }
        let Some(toward) = &self.toward else { return z };
        let low = lowered(simd, &self.metric, &z);
        let mut agrees = [zero; M];
        for (part, inside) in agrees.iter_mut().zip(toward.inside) {
            *part = Reg::splat(simd, inside);
        }
        let side = inner(&low, &agrees).sign();
        for part in &mut agrees {
            *part = part.flip(side);
        }
        let (mut outside, mut need) = (zero.below(zero), zero);
        for range in &toward.ranges {
            let Wheel { along, across } = &range.wheel;
            let (along, across) = (times(simd, along, &z), times(simd, across, &z).abs());
            let (sin, cos) = (Reg::splat(simd, range.sin), Reg::splat(simd, range.cos));
            outside = outside | (along.abs() * sin).below(across * cos);
            let ahead = along.flip(side) * Reg::splat(simd, range.sense);
            let short = (across * cos) - ahead * sin;
            need = need.max(short * Reg::splat(simd, range.per_margin));
        }
        let mut moved = z;
        for k in 0..M {
            moved[k] = agrees[k].mul_add(need, z[k]);
        }
        let square = value(simd, &self.metric, &moved).max(Reg::all(simd, R::TINY));
        let share = inner(&low, &moved).max(zero).over(square);
        for k in 0..M {
            z[k] = outside.select(moved[k] * share, z[k]);
        }
        z
    }

    /// What the joints let it be.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // the state of a step, in registers
    fn steered<S: Simd>(
        &self,
        simd: S,
        begin: &Begin,
        state: &mut State<S, R, M>,
        per_turn: R,
        wanted: [Reg<S, R>; M],
        mut motion: [Reg<S, R>; M],
        rests: Truth<S, R>,
    ) -> [Reg<S, R>; M] {
        let number = |value: f64| Reg::<S, R>::all(simd, value);
        let zero = number(0.0);
        let (per_turn, tiny) = (Reg::splat(simd, per_turn), number(R::TINY));
        let before = state.setting;
        // Shares of the setting before, per share of the wanted one.
        // As a fraction: one division for all joints.
        let (mut need, mut part) = (zero, number(1.0));
        let (mut least, mut most) = (number(1.0), number(-1.0));
        let mut side = zero;
        for joint in &self.joints {
            let (ax, ay) = (
                times(simd, &joint.along, &before),
                times(simd, &joint.across, &before),
            );
            let (bx, by) = (
                times(simd, &joint.along, &wanted),
                times(simd, &joint.across, &wanted),
            );
            let ahead = ax * bx;
            (least, most) = (least.min(ahead), most.max(ahead));
            side = ahead.sign();
            let along = ay.mul_add(by, ahead).flip(side);
            let across = (ax * by - ay * bx).abs();
            let square = ay.mul_add(ay, ax * ax).max(tiny);
            let more = across.mul_add(per_turn, zero - along);
            let worse = (need * square).below(more * part);
            (need, part) = (worse.select(more, need), worse.select(square, part));
        }
        let kept = need.over(part);
        let same = zero.below(least) | most.below(zero) | rests;
        let mut turned = wanted;
        for k in 0..M {
            turned[k] = before[k].flip(side).mul_add(kept, wanted[k]);
        }
        let low = lowered(simd, &self.metric, &turned);
        let share = inner(&low, &wanted)
            .max(zero)
            .over(inner(&low, &turned).max(tiny));
        let late = zero.below(kept) & !rests;
        for k in 0..M {
            motion[k] = late.select(turned[k] * share, motion[k]);
            state.setting[k] = rests.select(before[k], turned[k]);
        }
        let busy = zero.below(state.busy);
        let loose = state.busy.below(zero);
        let apart = !same | busy | loose;
        if apart.any() {
            return self.swing(
                simd,
                begin,
                state,
                before,
                wanted,
                motion,
                [rests, same, busy, loose],
            );
        }
        motion
    }

    /// Stops, turns the joints on the spot, and goes on.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // as above
    fn swing<S: Simd>(
        &self,
        simd: S,
        begin: &Begin,
        state: &mut State<S, R, M>,
        before: [Reg<S, R>; M],
        wanted: [Reg<S, R>; M],
        mut motion: [Reg<S, R>; M],
        [rests, same, busy, loose]: [Truth<S, R>; 4],
    ) -> [Reg<S, R>; M] {
        let number = |value: f64| Reg::<S, R>::all(simd, value);
        let (zero, one) = (number(0.0), number(1.0));
        let mut speed = zero;
        for part in state.motion {
            speed = speed.max(part.abs());
        }
        let moves = zero.below(speed);
        let begins = (loose | (!same & !moves)) & !busy & !rests;
        let brakes = !same & moves & !busy & !loose;
        let forms = self.slowing.as_ref().unwrap_or(&self.speeding);
        let worst = largest(simd, forms, &state.motion);
        let left = if forms.is_empty() {
            zero
        } else {
            one - one.over(worst.max(one).sqrt())
        };
        // Turning times, joint by joint.
        let lanes = R::lanes::<S>();
        let mut times = [R::default(); BLOCK];
        if begins.any() {
            let mut columns = [[[R::default(); BLOCK]; M]; 2];
            let mut which = [R::default(); BLOCK];
            // Those that are set for no motion yet are where the angles say.
            begins
                .select(loose.select(number(-1.0), one), zero)
                .store(&mut which);
            for k in 0..M {
                before[k].store(&mut columns[0][k]);
                wanted[k].store(&mut columns[1][k]);
            }
            for lane in 0..lanes {
                let kind = which[lane].wide();
                if kind != 0.0 {
                    let at = |j: usize| std::array::from_fn(|k| columns[j][k][lane]);
                    let angles = (kind < 0.0).then_some(&begin.angles[..]);
                    times[lane] = R::of(self.time(at(0), angles, at(1)));
                }
            }
        }
        let dt = number(self.dt);
        let turns = Reg::load(simd, &times);
        let rest = busy.select(state.busy, turns);
        let waits = busy | begins;
        let next = (rest - dt).max(zero);
        state.busy = waits.select(next, state.busy);
        let stays = waits | loose;
        let held = busy | brakes | (loose & !begins);
        let last = state.motion;
        for k in 0..M {
            let turned = begins.select(wanted[k], state.setting[k]);
            state.setting[k] = held.select(before[k], turned);
            let braked = brakes.select(last[k] * left, motion[k]);
            motion[k] = stays.select(zero, braked);
        }
        motion
    }

    /// The way of a step, exact for a constant motion.
    #[inline(always)]
    fn move_on<S: Simd>(&self, simd: S, begin: &Begin, state: &mut State<S, R, M>) {
        let number = |value: f64| Reg::<S, R>::all(simd, value);
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
        let side = if M == 2 {
            yaw * Reg::splat(simd, self.sideways)
        } else {
            state.motion[1]
        } * chord;
        let [x, y] = state.place;
        state.place = [
            along.mul_add(mc, x) - side * ms,
            along.mul_add(ms, y) + side * mc,
        ];
        state.heading = [mc * cos - ms * sin, ms.mul_add(cos, mc * sin)];
    }
}

/// A polynomial, by Horner's rule.
#[inline(always)]
fn series<S: Simd, R: Real, const N: usize>(
    simd: S,
    x: Reg<S, R>,
    coefficients: [f64; N],
) -> Reg<S, R> {
    let mut sum = Reg::all(simd, coefficients[N - 1]);
    for k in (0..N - 1).rev() {
        sum = sum.mul_add(x, Reg::all(simd, coefficients[k]));
    }
    sum
}

/// Sine, cosine and sine over angle of a small angle.
#[inline(always)]
fn half_turn<S: Simd, R: Real>(
    simd: S,
    half: Reg<S, R>,
    few: bool,
) -> (Reg<S, R>, Reg<S, R>, Reg<S, R>) {
    let square = half * half;
    const SINC: [f64; 7] = [
        1.0,
        -1.0 / 6.0,
        1.0 / 120.0,
        -1.0 / 5040.0,
        1.0 / 362_880.0,
        -1.0 / 39_916_800.0,
        1.0 / 6_227_020_800.0,
    ];
    const COS: [f64; 8] = [
        1.0,
        -0.5,
        1.0 / 24.0,
        -1.0 / 720.0,
        1.0 / 40_320.0,
        -1.0 / 3_628_800.0,
        1.0 / 479_001_600.0,
        -1.0 / 87_178_291_200.0,
    ];
    let (sinc, cos) = if few {
        let [s0, s1, s2, s3, ..] = SINC;
        let [c0, c1, c2, c3, c4, ..] = COS;
        (
            series(simd, square, [s0, s1, s2, s3]),
            series(simd, square, [c0, c1, c2, c3, c4]),
        )
    } else {
        (series(simd, square, SINC), series(simd, square, COS))
    };
    (half * sinc, cos, sinc)
}
