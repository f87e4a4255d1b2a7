//! Demands of rollouts on the wheels: poses and the largest demands, in one pass over the controls.

use std::f64::consts::PI;

use six_wheel_kinematics::batch::poses::{Buffers, PoseLogs};
use six_wheel_kinematics::geometry::{Steps, Twist};
use six_wheel_kinematics::inverse::constants::{InverseConstants, WheelKind};
use six_wheel_kinematics::kernels::safe_range::is_in_safe_range;
use six_wheel_kinematics::kernels::steered::wheel::SteeredConstants;
use six_wheel_kinematics::pose_logs::integrate::IntegrateLogs;
use six_wheel_kinematics::pose_logs::logs::{Logs, StepVisitor, side_by_side};
use six_wheel_kinematics::pose_logs::tile::{LANES, PerStep, STEPS, WIDTH};
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::rover_data::{Bank, Inputs, MAX_WHEELS};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::table::{Durations, Table};
use six_wheel_numerics::error::{Error, bounded};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::polynomials::angle;
use six_wheel_numerics::simd::vec3::row_times;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::threads::workers::Workers;

/// Sizes of controls up to which the kernel's squares and speeds are finite.
const LARGEST_TOTAL: f64 = 1e100;

/// Difference between the excesses over a wheel's range, rolling forwards and backwards, below which the scalar code
/// decides [rad].
const AMBIGUOUS: f64 = 1e-8;

/// Largest demands of every rollout: one number per rollout each.
#[derive(Debug)]
pub struct Costs<'a> {
    /// Largest wheel speed, either way round [rad/s].
    pub wheel_speed: &'a mut [f64],
    /// Largest steering angle, to either side [rad].
    pub steering_angle: &'a mut [f64],
    /// Largest steering rate, from each step's angles to the next [rad/s].
    pub steering_rate: &'a mut [f64],
    /// Largest speed at which a wheel slides sideways [m/s].
    pub scrub: &'a mut [f64],
}

impl Costs<'_> {
    /// Splits into parts of `share` rollouts each.
    fn pieces(&mut self, share: usize) -> impl Iterator<Item = Costs<'_>> {
        let first = self.wheel_speed.chunks_mut(share);
        let pairs = first.zip(self.steering_angle.chunks_mut(share));
        let rest = self.steering_rate.chunks_mut(share);
        pairs.zip(rest.zip(self.scrub.chunks_mut(share))).map(
            |((wheel_speed, steering_angle), (steering_rate, scrub))| Costs {
                wheel_speed,
                steering_angle,
                steering_rate,
                scrub,
            },
        )
    }

    fn set(&mut self, k: usize, [speed, angle, rate, scrub]: [f64; 4]) {
        self.wheel_speed[k] = speed;
        self.steering_angle[k] = angle;
        self.steering_rate[k] = rate;
        self.scrub[k] = scrub;
    }
}

/// Poses of rollouts of `count` steps each, as [`six_wheel_kinematics::batch::integrate`], and the largest demand of
/// each on the wheels.
///
/// The controls need not be possible: the angle of a steered wheel is clipped to its range, and the scrub is the speed
/// at which it then slides. Every step's angles are chosen nearest to those of the step before, the first nearest to
/// `previous`; without it the first angles cost no steering rate. The rate of a change of angle is over the duration of
/// the later step.
#[allow(clippy::too_many_arguments)] // the controls, the present, the results
pub fn rollout_cost<'a>(
    rover: &'a Rover,
    controls: impl Into<Table<'a>>,
    count: usize,
    steps: impl Into<Durations<'a>>,
    starts: &'a [[f64; 3]],
    previous: Option<&[f64]>,
    poses: &mut [[f64; 3]],
    mut costs: Costs<'_>,
    workers: Workers,
) -> Result<(), Error> {
    let Workers { level, fresh, .. } = workers.here();
    bounded("previous", previous.unwrap_or_default())?;
    let mut pose_logs = PoseLogs::new(controls.into(), count, steps.into(), starts)?;
    let logs = poses.len() / (count + 1);
    let plan = pose_logs
        .is_side_by_side()
        .then_some(&rover.inverse_constants)
        .filter(|plan| rover.cone.is_safe() && plan.wheels.iter().all(|(part, _)| is_folded(part)));
    pose_logs.rover = Some(rover);
    pose_logs.largest = if plan.is_some() { LARGEST_TOTAL } else { -1.0 };
    let share = workers.share_of_logs(logs, count);
    if !fresh {
        workers.for_each_long((0..logs).step_by(share), |first, interruption| {
            pose_logs.check(level, first..logs.min(first + share), interruption)
        })?;
    }
    let targets = poses.chunks_mut(share * (count + 1));
    let targets = targets.zip(costs.pieces(share)).enumerate();
    workers.for_each_long(targets, |(k, (poses, mut costs)), interruption| {
        let buffers = &mut Buffers::default();
        let block = pose_logs.block();
        let blocks = poses.chunks_mut(block * (count + 1));
        for (b, (poses, mut costs)) in blocks.zip(costs.pieces(block)).enumerate() {
            let first = k * share + b * block;
            let logs = first..first + poses.len() / (count + 1);
            if fresh {
                pose_logs.check(level, logs.clone(), interruption)?;
            }
            if let Some(plan) = plan {
                level.run_any(RolloutCostKernel {
                    plan,
                    rover,
                    logs: pose_logs.logs(logs, buffers),
                    previous,
                    poses,
                    costs,
                });
                continue;
            }
            for (j, poses) in poses.chunks_exact_mut(count + 1).enumerate() {
                pose_logs.integrate(level, first + j, true, poses, buffers, interruption)?;
                let one = first + j..first + j + 1;
                let logs = pose_logs.logs(one, buffers);
                costs.set(j, worst(rover, logs.twists, logs.steps, previous));
            }
        }
        Ok(())
    })
}

/// True unless a wheel has scrub, trail or more than a quarter turn of range to either side.
fn is_folded(part: &WheelKind) -> bool {
    let quarter = SteeringRange::default();
    match part {
        WheelKind::Fixed(_) => true,
        WheelKind::Castor(_) => false,
        WheelKind::Steered(wheel) => {
            let SteeringRange { lower, upper } = wheel.range;
            let is_centred = wheel.scrub == 0.0 && wheel.trail == 0.0;
            is_centred && lower >= quarter.lower && lower < 0.0 && upper > 0.0 && upper <= quarter.upper
        }
    }
}

/// Largest speed, angle, rate and scrub of one rollout, by scalar code.
fn worst(rover: &Rover, controls: &[[f64; 3]], steps: Steps<'_>, previous: Option<&[f64]>) -> [f64; 4] {
    let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
    let mut held = [0.0; MAX_WHEELS];
    held[..joints].copy_from_slice(previous.unwrap_or(&[0.0; MAX_WHEELS][..joints]));
    let (mut angles, mut speeds) = (held, [0.0; MAX_WHEELS]);
    let mut counts = previous.is_some();
    let mut worst = [0.0_f64; 4];
    for (k, control) in controls.iter().enumerate() {
        let twist = Twist::from(*control);
        let (angles, speeds) = (&mut angles[..joints], &mut speeds[..wheels]);
        let inputs = Inputs { previous: Some(&held[..joints]), ..Inputs::default() };
        rover.solve(twist, inputs, angles, speeds);
        rover.slow_down(twist, angles, speeds);
        let largest = |values: &[f64]| values.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let turns = angles.iter().zip(&held).map(|(new, old)| (new - old).abs());
        let turn = turns.fold(0.0, f64::max);
        let step = [
            largest(speeds),
            largest(angles),
            if counts { turn / steps.get(k) } else { 0.0 },
            rover.scrub(twist, angles),
        ];
        for (worst, step) in worst.iter_mut().zip(step) {
            *worst = worst.max(step);
        }
        held[..joints].copy_from_slice(angles);
        counts = true;
    }
    worst
}

struct RolloutCostKernel<'a> {
    plan: &'a InverseConstants,
    rover: &'a Rover,
    logs: Logs<'a>,
    previous: Option<&'a [f64]>,
    poses: &'a mut [[f64; 3]],
    costs: Costs<'a>,
}

impl Kernel for RolloutCostKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(mut self, simd: S) {
        let zero = Lanes::splat(simd, 0.0);
        let count = self.logs.count;
        let rollouts = self.poses.len() / (count + 1);
        let place = IntegrateLogs { logs: self.logs, poses: self.poses, non_temporal: false };
        place.run(simd);
        for first in (0..rollouts).step_by(S::F64_LANES) {
            let mut demands = WheelDemands {
                plan: self.plan,
                banks: &self.rover.banks,
                held: [simd.splat_f64s(0.0); MAX_WHEELS],
                counts: self.previous.is_some(),
                worst: [zero; 4],
                is_certain: Mask::splat(simd, true),
            };
            for (held, previous) in demands.held.iter_mut().zip(self.previous.unwrap_or_default()) {
                *held = simd.splat_f64s(*previous);
            }
            let lanes = S::F64_LANES.min(rollouts - first);
            side_by_side(simd, self.logs, first, &mut demands);
            let mut found = [[0.0; LANES]; 5];
            let one = Lanes::splat(simd, 1.0);
            let is_certain = demands.is_certain.select(one, zero);
            demands.worst[0] = demands.worst[0].sqrt();
            for (found, lanes) in found.iter_mut().zip(demands.worst.into_iter().chain([is_certain])) {
                lanes.store(S::as_mut_simd_f64s(found).0, 0);
            }
            let [speed, angle, rate, scrub, is_certain] = found;
            for lane in 0..lanes {
                let mut costs = [speed[lane], angle[lane], rate[lane], scrub[lane]];
                if is_certain[lane] == 0.0 {
                    let from = (first + lane) * count;
                    let controls = &self.logs.twists[from..from + count];
                    costs = worst(self.rover, controls, self.logs.steps, self.previous);
                }
                self.costs.set(first + lane, costs);
            }
        }
    }
}

/// Demands on the wheels of as many rollouts as there are lanes.
struct WheelDemands<'p, S: Vector> {
    plan: &'p InverseConstants,
    /// Side-slip rows of the unsteered wheels.
    banks: &'p [Bank],
    /// Angles of the steered wheels after the step before [rad].
    held: [S::f64s; MAX_WHEELS],
    /// True if the change to the next angles counts.
    counts: bool,
    /// Largest square of the speed, angle, rate and scrub.
    worst: [Lanes<S>; 4],
    /// Lanes in which the kernel's result is valid; the scalar code computes the others.
    is_certain: Mask<S>,
}

impl<S: Vector> StepVisitor<S> for WheelDemands<'_, S> {
    #[inline(always)]
    fn tile(&mut self, simd: S, twists: &[S::f64s; WIDTH], dts: &PerStep<S>) {
        let mut per_dts = *dts;
        let infinite = Lanes::splat(simd, f64::INFINITY);
        for (t, per_dt) in per_dts.iter_mut().enumerate() {
            *per_dt = Lanes::splat(simd, 1.0) / (*per_dt);
            // Angles that stay have no rate, also over durations below 6e-309 s, whose inverse is infinite.
            let is_regular = is_in_safe_range(simd, twist(simd, twists, t)) & per_dt.abs().lt(infinite);
            self.is_certain = self.is_certain & is_regular;
        }
        for bank in self.banks {
            let row = bank.row.into();
            for t in 0..STEPS {
                let slip = row_times(simd, &row, twist(simd, twists, t)).abs();
                self.worst[3] = self.worst[3].max(slip);
            }
        }
        let mut joint = 0;
        for (part, per_radius) in &self.plan.wheels {
            let per_radius = Lanes::splat(simd, *per_radius);
            match part {
                WheelKind::Fixed(row) => {
                    for t in 0..STEPS {
                        let speed = row_times(simd, row, twist(simd, twists, t)) * per_radius;
                        self.worst[0] = self.worst[0].max(speed * speed);
                    }
                }
                // Unreachable: this kernel is for rovers whose wheels are all folded.
                WheelKind::Castor(_) => {}
                WheelKind::Steered(steered) => {
                    let asked = (joint, per_radius * per_radius);
                    if steered.range.lower == -steered.range.upper {
                        self.steer::<true>(simd, steered, asked, twists, &per_dts);
                    } else {
                        self.steer::<false>(simd, steered, asked, twists, &per_dts);
                    }
                    joint += 1;
                }
            }
        }
        self.counts = true;
    }
}

/// Twists at a step.
#[inline(always)]
fn twist<S: Vector>(simd: S, twists: &[S::f64s; WIDTH], t: usize) -> [Lanes<S>; 3] {
    [Lanes::load(simd, twists, 3 * t), Lanes::load(simd, twists, 3 * t + 1), Lanes::load(simd, twists, 3 * t + 2)]
}

impl<S: Vector> WheelDemands<'_, S> {
    /// One steered wheel, whose range is a quarter turn to either side at most.
    #[inline(always)]
    fn steer<const SYMMETRIC: bool>(
        &mut self,
        simd: S,
        steered: &SteeredConstants,
        (joint, per_square): (usize, Lanes<S>),
        twists: &[S::f64s; WIDTH],
        per_dts: &PerStep<S>,
    ) {
        let number = |value| Lanes::splat(simd, value);
        let (zero, ambiguous) = (number(0.0), number(AMBIGUOUS));
        let (low, high) = (steered.range.lower, steered.range.upper);
        let (lower, upper) = (number(low), number(high));
        let middle = number((low + high) / 2.0);
        let [lower_end, upper_end] = steered.ends;
        let wheel = steered.broadcast(simd);
        // Either end of the range, shifted by half a turn.
        let (back_to_lower, back_to_upper) = (number(low + PI), number(high - PI));
        let mut held = Lanes::load(simd, &self.held, joint);
        let [mut squares, mut angles, mut rates, mut slips] = self.worst;
        let [mut along, mut across] = [Lanes::<S, f64, STEPS>::constant(simd, 0.0); 2];
        let [mut xs, mut ys] = [[zero; STEPS]; 2];
        for t in 0..STEPS {
            [xs[t], ys[t]] = wheel.velocity(twist(simd, twists, t));
            along.set_register(t, xs[t].abs());
            across.set_register(t, ys[t].abs());
        }
        let steep = angle(simd, along, across);
        for t in 0..STEPS {
            let (x, y) = (xs[t], ys[t]);
            let rests = wheel.is_at_rest(twist(simd, twists, t));
            let desired = steep.register(t).xor_sign(y.sign_bit()).xor_sign(x.sign_bit());
            let mut angle = desired.max(lower).min(upper);
            let over = (desired - angle).abs();
            // Excess over either end, rolling backwards.
            let (below, above) = (back_to_lower - desired, desired - back_to_upper);
            let backwards = below.min(above);
            let clear = ambiguous.lt((backwards - over).abs());
            self.is_certain = self.is_certain & (rests | clear);
            if !SYMMETRIC {
                let end = below.lt(above).select(lower, upper);
                angle = backwards.lt(over).select(end, angle);
            }
            let at_upper = middle.lt(angle);
            let sin = at_upper.select(number(upper_end.sin), number(lower_end.sin));
            let cos = at_upper.select(number(upper_end.cos), number(lower_end.cos));
            let misses = zero.lt(over) & !rests;
            let slip = misses.select((cos * y - sin * x).abs(), zero);
            slips = slips.max(slip);
            let rolls = cos * x + sin * y;
            let square = misses.select(rolls * rolls, x.mul_add(x, y * y)) * per_square;
            squares = squares.max(rests.select(zero, square));
            angle = rests.select(held.max(lower).min(upper), angle);
            angles = angles.max(angle.abs());
            if self.counts || t > 0 {
                rates = rates.max((angle - held).abs() * per_dts[t]);
            }
            held = angle;
        }
        held.store(&mut self.held, joint);
        self.worst = [squares, angles, rates, slips];
    }
}
