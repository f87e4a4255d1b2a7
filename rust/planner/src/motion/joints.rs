//! Projection of a desired motion onto the steering ranges, and onto the motions that the joints can reach in a step.

use super::drive::{RolloutStart, State};
use super::model::{Model, Wheel};
use crate::numbers::BLOCK;
use crate::numbers::norms::{LOCKSTEP, Reg, area, inner, largest, metric_times, share, times, unit_scale, value};
use six_wheel_numerics::simd::float::Float;
use six_wheel_numerics::simd::lanes::Mask;
use six_wheel_numerics::simd::vector::Vector;

type Truth<S, R> = Mask<S, R, LOCKSTEP>;

#[inline_always]
impl<R: Float, const M: usize> Model<R, M> {
    /// A motion within the ranges: for two components the nearest one, else one on the line to the motion well inside.
    pub(crate) fn project_onto_ranges<S: Vector>(&self, simd: S, mut z: [Reg<S, R>; M]) -> [Reg<S, R>; M] {
        let zero = Reg::<S, R>::constant(simd, 0.0);
        for (ends, shares, per_length) in &self.gaps {
            // Areas from the first end to the motion, and from the motion to the second end: of one sign in the gap.
            let from = area(simd, &z, ends[0]);
            let to = zero - area(simd, &z, ends[1]);
            let within = zero.lt(from * to);
            let [near, far] = [Reg::splat(simd, per_length[0]), Reg::splat(simd, per_length[1])];
            let first = (from.abs() * near).lt(to.abs() * far);
            let part = first.select(share(simd, &z, shares[0]), share(simd, &z, shares[1]));
            for k in 0..2 {
                let end = first.select(Reg::splat(simd, ends[0][k]), Reg::splat(simd, ends[1][k]));
                z[k] = within.select(end * part, z[k]);
            }
        }
        let Some(projection) = &self.projection else { return z };
        let low = metric_times(simd, &self.metric, &z);
        let mut agrees = [zero; M];
        for (part, inside) in agrees.iter_mut().zip(projection.inside) {
            *part = Reg::splat(simd, inside);
        }
        let side = inner(&low, &agrees).sign_bit();
        for part in &mut agrees {
            *part = part.xor_sign(side);
        }
        let (mut outside, mut need) = (Mask::splat(simd, false), zero);
        for range in &projection.ranges {
            let Wheel { along, across } = &range.wheel;
            let (along, across) = (times(simd, along, &z), times(simd, across, &z).abs());
            let (sin, cos) = (Reg::splat(simd, range.sin), Reg::splat(simd, range.cos));
            outside = outside | (along.abs() * sin).lt(across * cos);
            let ahead = along.xor_sign(side) * Reg::splat(simd, range.sense);
            let short = (across * cos) - ahead * sin;
            need = need.max(short * Reg::splat(simd, range.per_margin));
        }
        let mut moved = z;
        for k in 0..M {
            moved[k] = agrees[k].mul_add(need, z[k]);
        }
        let square = value(simd, &self.metric, &moved).max(Reg::constant(simd, R::TINY));
        let share = inner(&low, &moved).max(zero) / square;
        for k in 0..M {
            z[k] = outside.select(moved[k] * share, z[k]);
        }
        z
    }

    /// The motion that the joints can reach in a step, by their largest turn; `per_turn` is one over its tangent.
    #[allow(clippy::too_many_arguments)] // the state of a step, in registers
    pub(crate) fn limit_steering<S: Vector>(
        &self,
        simd: S,
        initial: &RolloutStart,
        state: &mut State<S, R, M>,
        per_turn: R,
        desired: [Reg<S, R>; M],
        mut motion: [Reg<S, R>; M],
        rests: Truth<S, R>,
    ) -> [Reg<S, R>; M] {
        let number = |value: f64| Reg::<S, R>::constant(simd, value);
        let zero = number(0.0);
        let one = number(1.0);
        let (per_turn, tiny) = (Reg::splat(simd, per_turn), number(R::TINY));
        let before = state.setpoint;
        // Ratio of the old to the desired setpoint in the new one, as a fraction: one division for all joints.
        let (mut need, mut part) = (zero, one);
        let (mut least, mut most) = (one, number(-1.0));
        let mut side = zero;
        for joint in &self.turning {
            let (ax, ay) = (times(simd, &joint.along, &before), times(simd, &joint.across, &before));
            let (bx, by) = (times(simd, &joint.along, &desired), times(simd, &joint.across, &desired));
            let ahead = ax * bx;
            (least, most) = (least.min(ahead), most.max(ahead));
            side = ahead.sign_bit();
            let along = ay.mul_add(by, ahead).xor_sign(side);
            let across = (ax * by - ay * bx).abs();
            let square = ay.mul_add(ay, ax * ax).max(tiny);
            let more = across.mul_add(per_turn, zero - along);
            let worse = (need * square).lt(more * part);
            (need, part) = (worse.select(more, need), worse.select(square, part));
        }
        let kept = need / part;
        let same = zero.lt(least) | most.lt(zero) | rests;
        let mut turned = desired;
        for k in 0..M {
            turned[k] = before[k].xor_sign(side).mul_add(kept, desired[k]);
        }
        let low = metric_times(simd, &self.metric, &turned);
        let share = inner(&low, &desired).max(zero) / inner(&low, &turned).max(tiny);
        let late = zero.lt(kept) & !rests;
        for k in 0..M {
            motion[k] = late.select(turned[k] * share, motion[k]);
            state.setpoint[k] = rests.select(before[k], turned[k]);
        }
        let busy = zero.lt(state.busy);
        let is_free = state.busy.lt(zero);
        let apart = !same | busy | is_free;
        if apart.any() {
            let why = [rests, same, busy, is_free];
            motion = self.steer_in_place(simd, initial, state, before, desired, motion, why);
        }
        motion
    }

    /// The motion of a step of a rover that stops, turns its joints at rest, and goes on.
    #[allow(clippy::too_many_arguments)] // as above
    fn steer_in_place<S: Vector>(
        &self,
        simd: S,
        initial: &RolloutStart,
        state: &mut State<S, R, M>,
        before: [Reg<S, R>; M],
        desired: [Reg<S, R>; M],
        mut motion: [Reg<S, R>; M],
        [rests, same, busy, is_free]: [Truth<S, R>; 4],
    ) -> [Reg<S, R>; M] {
        let number = |value: f64| Reg::<S, R>::constant(simd, value);
        let (zero, one) = (number(0.0), number(1.0));
        let mut speed = zero;
        for part in state.motion {
            speed = speed.max(part.abs());
        }
        let moves = zero.lt(speed);
        let begins = (is_free | (!same & !moves)) & !busy & !rests;
        let brakes = !same & moves & !busy & !is_free;
        let forms = self.slowing.as_ref().unwrap_or(&self.speeding);
        let worst = largest(simd, forms, &state.motion);
        let left = if forms.is_empty() { zero } else { one - unit_scale(simd, worst) };
        // Time of the alignment, lane by lane.
        let lanes = Reg::<S, R>::lanes();
        let mut times = [R::default(); BLOCK];
        if begins.any() {
            let mut columns = [[[R::default(); BLOCK]; M]; 2];
            let mut which = [R::default(); BLOCK];
            // Joints that are aligned for no motion start at the measured angles.
            begins.select(is_free.select(number(-1.0), one), zero).copy_to_slice(&mut which);
            for k in 0..M {
                before[k].copy_to_slice(&mut columns[0][k]);
                desired[k].copy_to_slice(&mut columns[1][k]);
            }
            for lane in 0..lanes {
                let kind = which[lane].to_f64();
                if kind != 0.0 {
                    let at = |j: usize| std::array::from_fn(|k| columns[j][k][lane]);
                    let angles = (kind < 0.0).then_some(&initial.angles[..]);
                    times[lane] = R::from_f64(self.steering_time(at(0), angles, at(1)));
                }
            }
        }
        let turns = Reg::from_slice(simd, &times);
        let rest = busy.select(state.busy, turns);
        let waits = busy | begins;
        state.busy = waits.select((rest - self.dt).max(zero), state.busy);
        let stays = waits | is_free;
        let held = busy | brakes | (is_free & !begins);
        let last = state.motion;
        for k in 0..M {
            let turned = begins.select(desired[k], state.setpoint[k]);
            state.setpoint[k] = held.select(before[k], turned);
            let braked = brakes.select(last[k] * left, motion[k]);
            motion[k] = stays.select(zero, braked);
        }
        motion
    }
}
