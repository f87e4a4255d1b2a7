//! Rows that have been checked, block by block: first as if all were usual, then with everything there is to know.

use pulp::Simd;

use super::plan::{InverseConstants, WheelKind, block};
use crate::geometry::Twist;
use crate::kernels::choice::SteeringQuery;
use crate::kernels::cone::dot;
use crate::kernels::steered::{CLOSE, EITHER, NEARER, ONLY, Steer, Steered, absolute, load};
use crate::kernels::usual::usual;
use crate::rover_data::Inputs;
use crate::wheels::REST;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::stream::{Output, fetch_ahead};
use six_wheel_numerics::weave::{BLOCK, Column, unweave, weave};

/// Blocks after one that needed the whole formula, until the usual one is tried again.
const TRIES: usize = 8;

pub(crate) struct Solve<'a> {
    pub plan: &'a InverseConstants<'a>,
    pub twists: &'a [[f64; 3]],
    pub inputs: Inputs<'a>,
    pub steering: &'a mut [f64],
    pub speeds: &'a mut [f64],
    pub past: bool,
    /// One per steering angle, one per speed, and one per number of the inputs.
    pub columns: &'a mut [Column],
}

impl Kernel for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let plan = self.plan;
        let (joints, wheels) = (plan.joints, plan.parts.len());
        let Inputs { previous, previous_speeds, steering_rates } = self.inputs;
        let mut twists = [Column::ZERO; 3];
        let (steering, rest) = self.columns.split_at_mut(joints);
        let (speeds, rest) = rest.split_at_mut(wheels);
        let (before, rest) = rest.split_at_mut(previous.map_or(0, |_| joints));
        let (rolling, rates) = rest.split_at_mut(previous_speeds.map_or(0, |_| wheels));
        let output = |target, width| Output::new(simd, target, width * BLOCK, self.past);
        let mut all_steering = output(self.steering, joints);
        let mut all_speeds = output(self.speeds, wheels);
        let simple = plan.is_simple && (previous.is_none() && previous_speeds.is_none() || plan.is_inner);
        let mut votes = [Column::ZERO; 3];
        let mut usual = true;
        for (b, rows) in self.twists.chunks(BLOCK).enumerate() {
            let first = b * BLOCK;
            fetch_ahead(simd, rows.as_flattened(), 0, 1);
            unweave(simd, rows.as_flattened(), &mut twists);
            let steering_rows = all_steering.next(rows.len() * joints);
            let speed_rows = all_speeds.next(rows.len() * wheels);
            let mut doubts = Column::ZERO;
            let mut doubtful = false;
            // Where the last block needed the whole formula, this one most likely does; now and then it is tried.
            let tries = simple && (usual || b % TRIES == 0);
            usual = tries && solve_block(simd, plan, &twists, steering, speeds, &mut votes);
            if !usual {
                let of = |values, width| block(values, width, first, rows.len());
                unweave(simd, of(previous, joints), before);
                unweave(simd, of(previous_speeds, wheels), rolling);
                unweave(simd, of(steering_rates, joints), rates);
                let beside = [&*before, rolling, rates];
                doubtful = choose_block(simd, plan, &twists, beside, steering, speeds, &mut doubts);
            }
            weave(simd, steering, steering_rows);
            weave(simd, speeds, speed_rows);
            if doubtful {
                let doubtful = |(k, _): &(usize, _)| doubts.0[*k] != 0.0;
                for (k, twist) in rows.iter().enumerate().filter(doubtful) {
                    plan.rover.solve(
                        Twist::from(*twist),
                        self.inputs.row(plan.rover, first + k),
                        &mut steering_rows[k * joints..(k + 1) * joints],
                        &mut speed_rows[k * wheels..(k + 1) * wheels],
                    );
                }
            }
        }
    }
}

/// Solves a block. Whether that was all: every wheel moves, and goes the one way there is.
#[inline(always)]
fn solve_block<S: Simd>(
    simd: S,
    plan: &InverseConstants<'_>,
    twists: &[Column; 3],
    steering: &mut [Column],
    speeds: &mut [Column],
    votes: &mut [Column; 3],
) -> bool {
    let zero = Lanes::splat(simd, 0.0);
    let mut sure = zero.at_most(zero);
    let mut margins = Column::ZERO;
    let margins = S::as_mut_simd_f64s(&mut margins.0).0;
    for k in 0..BLOCK / S::F64_LANES {
        let twist = load(simd, twists, k);
        sure = sure & usual(simd, twist);
        let [vx, vy, omega] = absolute(twist);
        let summed = vx + vy + omega * Lanes::splat(simd, plan.cone.arm);
        (summed * Lanes::splat(simd, 2.0 * REST)).store(margins, k);
    }
    let mut joint = 0;
    if plan.asks {
        *votes = [Column::ZERO; 3];
    }
    for ((part, per_radius), speeds) in plan.parts.iter().zip(&mut *speeds) {
        let per_radius = Lanes::splat(simd, *per_radius);
        match part {
            WheelKind::Fixed(row) => roll(simd, row, per_radius, twists, speeds),
            WheelKind::Castor(castor) => sure = sure & follow(simd, castor, per_radius, twists, speeds),
            WheelKind::Steered(steered) => {
                let angles = S::as_mut_simd_f64s(&mut steering[joint].0).0;
                joint += 1;
                let Some(reach) = &steered.reach else {
                    continue;
                };
                let steer =
                    Steer { twists, margins, per_radius, angles, speeds: S::as_mut_simd_f64s(&mut speeds.0).0, votes };
                sure = sure
                    & match (steered.heading, reach.ways) {
                        (None, ONLY) => steer.run::<false, ONLY>(simd, steered, reach),
                        (None, EITHER) => steer.run::<false, EITHER>(simd, steered, reach),
                        (None, _) => steer.run::<false, NEARER>(simd, steered, reach),
                        (Some(_), ONLY) => steer.run::<true, ONLY>(simd, steered, reach),
                        (Some(_), EITHER) => steer.run::<true, EITHER>(simd, steered, reach),
                        (Some(_), _) => steer.run::<true, NEARER>(simd, steered, reach),
                    };
            }
        }
    }
    if plan.asks {
        sure = sure & agree(simd, plan, votes, steering, speeds);
    }
    !(!sure).any()
}

/// Undecided wheels that would go different ways go the one that is shorter for all of them. Returns the
/// lanes in which that is sure.
#[inline(always)]
fn agree<S: Simd>(
    simd: S,
    plan: &InverseConstants<'_>,
    votes: &[Column; 3],
    steering: &mut [Column],
    speeds: &mut [Column],
) -> Mask<S> {
    let zero = Lanes::splat(simd, 0.0);
    let mut sure = zero.at_most(zero);
    for k in 0..BLOCK / S::F64_LANES {
        let [ahead, back, lead] = load(simd, votes, k);
        let differ = zero.below(ahead * back);
        if !differ.any() {
            continue;
        }
        let backwards = zero.below(lead);
        sure = sure & !(differ & lead.abs().below(Lanes::splat(simd, CLOSE)));
        let mut angles = steering.iter_mut();
        for ((part, _), speeds) in plan.parts.iter().zip(&mut *speeds) {
            if let WheelKind::Steered(steered) = part
                && let Some(angles) = angles.next()
                && steered.reach.is_some_and(|reach| reach.ways == EITHER)
            {
                let command = [angles.load(simd, k), speeds.load(simd, k)];
                let [angle, speed] = steered.apply_common_direction(simd, command, differ, backwards);
                angles.store(k, angle);
                speeds.store(k, speed);
            }
        }
    }
    sure
}

/// A wheel that is not steered.
#[inline(always)]
fn roll<S: Simd>(simd: S, row: &[f64; 3], per_radius: Lanes<S>, twists: &[Column; 3], speeds: &mut Column) {
    for k in 0..BLOCK / S::F64_LANES {
        let rim_speed = dot(simd, row, load(simd, twists, k));
        speeds.store(k, rim_speed * per_radius);
    }
}

/// A castor, and where it is sure how it rolls.
#[inline(always)]
fn follow<S: Simd>(
    simd: S,
    castor: &Steered,
    per_radius: Lanes<S>,
    twists: &[Column; 3],
    speeds: &mut Column,
) -> Mask<S> {
    let zero = Lanes::splat(simd, 0.0);
    let mut all = zero.at_most(zero);
    for k in 0..BLOCK / S::F64_LANES {
        let (rim_speed, sure) = castor.follow(simd, load(simd, twists, k));
        speeds.store(k, rim_speed * per_radius);
        all = all & sure;
    }
    all
}

/// Solves a block with everything there is to know about the wheels: present angles, speeds and rates, as far as they are
/// given. Marks the rows that are for the plain core; whether there are any.
#[inline(always)]
fn choose_block<S: Simd>(
    simd: S,
    plan: &InverseConstants<'_>,
    twists: &[Column; 3],
    [before, rolling, rates]: [&[Column]; 3],
    steering: &mut [Column],
    speeds: &mut [Column],
    doubts: &mut Column,
) -> bool {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let none = zero.below(zero);
    let mut doubtful = none;
    for k in 0..BLOCK / S::F64_LANES {
        let twist = load(simd, twists, k);
        let mut sure = usual(simd, twist);
        // Numbers of undecided wheels for either way, the total by which the way backwards is shorter, and the sum of
        // their present speeds.
        let [mut ahead, mut back, mut lead, mut rolled] = [zero; 4];
        let mut common = None;
        // Once more if the undecided ones have to agree.
        for round in 0..2 {
            let mut joint = 0;
            for (i, ((part, per_radius), speeds)) in plan.parts.iter().zip(speeds.iter_mut()).enumerate() {
                let per_radius = Lanes::splat(simd, *per_radius);
                let rim_speed = match part {
                    WheelKind::Fixed(row) => dot(simd, row, twist),
                    WheelKind::Castor(castor) => {
                        let (rim_speed, safe) = castor.follow(simd, twist);
                        sure = sure & safe;
                        rim_speed
                    }
                    WheelKind::Steered(steered) => {
                        let of =
                            |columns: &[Column], at: usize| columns.get(at).map_or(zero, |column| column.load(simd, k));
                        let asked = SteeringQuery { twist, before: of(before, joint), rate: of(rates, joint) };
                        let chosen = steered.choose(simd, asked, common);
                        if round == 0 {
                            let counted = |mask: Mask<S>, number| mask.select(number, zero);
                            let votes = chosen.undecided;
                            sure = sure & chosen.sure;
                            ahead = ahead + counted(votes & !chosen.backwards, one);
                            back = back + counted(votes & chosen.backwards, one);
                            lead = lead + counted(votes, chosen.lead);
                            rolled = rolled + counted(votes, of(rolling, i));
                        }
                        steering[joint].store(k, chosen.angle);
                        joint += 1;
                        chosen.rim_speed
                    }
                };
                speeds.store(k, rim_speed * per_radius);
            }
            if round == 0 {
                let rolls = zero.below(rolled.abs());
                let differ = zero.below(ahead * back);
                if !(rolls | differ).any() {
                    break;
                }
                // If they agree on their own, they keep that way.
                let agreed = zero.below(back);
                let shorter = zero.below(lead);
                common = Some((rolls & rolled.below(zero)) | (!rolls & ((differ & shorter) | (!differ & agreed))));
                let close = Lanes::splat(simd, 1e-9);
                let tie = lead.abs().below(close); // also where it cancels: the plain core's sum may not
                sure = sure & !(!rolls & differ & tie);
            }
        }
        doubts.store(k, sure.select(zero, one));
        doubtful = doubtful | !sure;
    }
    doubtful.any()
}
