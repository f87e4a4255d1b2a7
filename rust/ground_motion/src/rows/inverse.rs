//! [`inverse`] for many rows.

use super::columns::{Span, finite, within};
use super::least_squares::Equations;
use super::prepared::Prepared;
use super::run::{InLanes, Rows, through};
use super::settled_poses::{SettledPoses, Standing, on_plane};
use super::steering::{Local, aimed};
use super::suspension_rates::{Contacts, Known, MotionScratch, Row, SuspensionRates, Touch, answers};
use crate::contact::COLUMNS;
use crate::motion::{Command, PLAN, View, Wanted, inverse};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::direction;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::suspension::lanes::{LARGEST_TURN, Placing, Turned, all, from_turned};
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// Commands of the wheels, row after row: see [`Commanded`](super::super::Commanded).
#[derive(Debug)]
pub struct Commands<'a> {
    /// Angles of the steering joints [rad].
    pub steering: &'a mut [f64],
    /// Of the wheels [rad/s].
    pub speeds: &'a mut [f64],
    /// Of the body [m/s, rad/s].
    pub twists: &'a mut [[f64; 6]],
    /// Of the free angles [rad/s].
    pub joint_rates: &'a mut [f64],
    /// Scales of the wanted motions.
    pub scales: &'a mut [f64],
}

/// [`inverse`] for every row: of wanted speeds and yaw rates `[m/s, rad/s]` there is one per row, or one for all. Fails
/// at the first row at which a wheel would steer past its range.
#[allow(clippy::too_many_arguments)] // each is a thing of its own
pub fn inverse_rows(
    chain: &Chain,
    prepared: &Prepared,
    footings: &SettledPoses<'_>,
    command: &Command,
    wanted: &[[f64; 2]],
    steering: Option<&[f64]>,
    commands: Commands<'_>,
    workers: Workers,
) -> Result<(), Error> {
    let workers = workers.here();
    let share = workers.share(commands.scales.len());
    let (wheels, free, steered) = (chain.wheels().len(), chain.joints().len(), chain.steering().len());
    let mut angles = commands.steering.chunks_mut((share * steered).max(1));
    let mut rates = commands.joint_rates.chunks_mut((share * free).max(1));
    let jobs = commands
        .scales
        .chunks_mut(share)
        .zip(commands.speeds.chunks_mut(share * wheels))
        .zip(commands.twists.chunks_mut(share))
        .enumerate()
        .map(|(k, ((scales, speeds), twists))| InverseRange {
            chain,
            footings,
            command,
            wanted,
            steering,
            first: k * share,
            commands: Commands {
                steering: angles.next().unwrap_or_default(),
                speeds,
                twists,
                joint_rates: rates.next().unwrap_or_default(),
                scales,
            },
        });
    workers.each(jobs, |job| through(prepared, workers.level, job))
}

/// Rows that one thread takes.
struct InverseRange<'a> {
    chain: &'a Chain,
    footings: &'a SettledPoses<'a>,
    command: &'a Command,
    wanted: &'a [[f64; 2]],
    steering: Option<&'a [f64]>,
    /// The first of its rows among all.
    first: usize,
    commands: Commands<'a>,
}

impl Rows for InverseRange<'_> {
    type Scratch<S: Vector> = MotionScratch<S>;

    #[inline(always)]
    fn room<S: Vector>(simd: S) -> MotionScratch<S> {
        MotionScratch::new(simd)
    }

    fn count(&self) -> usize {
        self.commands.scales.len()
    }

    #[inline(always)]
    fn some<S: Vector>(
        lanes: &mut InLanes<'_, Self>,
        simd: S,
        span: Span,
        placing: &mut Placing<'_, S>,
        room: &mut MotionScratch<S>,
    ) -> Mask<S> {
        lanes.some(simd, span, placing, room)
    }

    fn one(&mut self, row: usize) -> Result<(), Error> {
        let (place, chain) = (self.first + row, self.chain);
        let (wheels, free, steered) = (chain.wheels().len(), chain.joints().len(), chain.steering().len());
        let [speed, yaw_rate] = match self.wanted {
            [all] => *all,
            _ => self.wanted[place],
        };
        let wanted = Wanted { speed, yaw_rate };
        let kept = self.steering.map(|angles| &angles[place * steered..][..steered]);
        let found = self.footings.with(chain, place, |footing| inverse(chain, footing, self.command, wanted, kept));
        let found = found.map_err(|error| error.at_row(place))?;
        let commands = &mut self.commands;
        commands.steering[row * steered..][..steered].copy_from_slice(&found.steering[..steered]);
        commands.speeds[row * wheels..][..wheels].copy_from_slice(&found.speeds[..wheels]);
        commands.twists[row] = found.twist;
        commands.joint_rates[row * free..][..free].copy_from_slice(&found.joint_rates[..free]);
        commands.scales[row] = found.scale;
        Ok(())
    }
}

/// Angles of steering joints [rad], their rotations from the present ones, and the lanes in which they differ.
struct Steered<S: Vector> {
    angles: [Lanes<S>; MAX_WHEELS],
    turned: [Turned<S>; MAX_WHEELS],
    moved: Mask<S>,
}

impl InLanes<'_, InverseRange<'_>> {
    /// Some rows, and the lanes that are for the plain way.
    #[inline(always)]
    fn some<S: Vector>(
        &mut self,
        simd: S,
        span: Span,
        placing: &mut Placing<'_, S>,
        room: &mut MotionScratch<S>,
    ) -> Mask<S> {
        let (plan, chain) = (self.plan, self.job.chain);
        let given = Span { first: self.job.first + span.first, ..span };
        let (zero, one, nan) = (all(simd, 0.0), all(simd, 1.0), all(simd, f64::NAN));
        let mut never = zero.below(zero);
        let footings = self.job.footings;
        let MotionScratch { eights, equations, contacts, standing } = room;
        standing.read(simd, chain, footings, given, eights, &mut never);
        let standing = &*standing;
        placing.place(simd, &standing.joints);
        let wheels = plan.wheels().min(MAX_WHEELS);
        let mut stands = [None; MAX_WHEELS];
        for (wheel, stands) in stands.iter_mut().enumerate().take(wheels) {
            if let Some(joint) = plan.steering(wheel).filter(|_| standing.steers) {
                let turned = direction(simd, standing.steering[joint % MAX_WHEELS]);
                placing.steer(simd, wheel, turned);
                *stands = Some(turned);
            }
            let (centre, radius) = (placing.centres[wheel], all(simd, plan.radius(wheel)));
            let touch = Touch::new(placing, wheel, centre, radius, *stands, standing.at[wheel]);
            let [normal, ..] = contacts[wheel].rows.each_mut();
            answers(placing, wheel, touch.point, [standing.normals[wheel]], std::array::from_mut(normal));
        }
        let (rates, sure) = self.rates(simd, given, standing, contacts, equations);
        never = never | (!sure & !standing.nowhere);
        let mut total = zero;
        for rate in rates {
            total = total + rate;
        }
        // Where the ground does not say how the suspension follows it nothing is known.
        let known = total.at_most(total) & !standing.nowhere;
        let joints = [rates[6], rates[7], rates[8]];
        let body = [[rates[0], rates[1], rates[2]], [rates[3], rates[4], rates[5]]];
        let mut doubt = zero.below(zero);
        placing.moves(body, &joints);
        let placing = &*placing;
        let mut locals = [Local::none(simd); MAX_WHEELS];
        for (wheel, local) in locals.iter_mut().enumerate().take(wheels) {
            let limb = placing.limb(wheel);
            let steered = stands[wheel].unwrap_or((zero, one));
            let [velocity, turn] = placing.carried(wheel, placing.centres[wheel]);
            *local = Local {
                normal: from_turned(steered, limb.own(standing.normals[wheel])),
                velocity: from_turned(steered, limb.own(velocity)),
                turn: from_turned(steered, limb.own(turn)),
                offset: plan.offset(wheel),
                radius: plan.radius(wheel),
            };
        }
        let steered = self.steered(simd, given, standing, &locals[..wheels], &mut doubt);
        let mut speeds = [zero; MAX_WHEELS];
        let mut fastest = zero;
        for (wheel, local) in locals.iter().enumerate().take(wheels) {
            let joint = plan.steering(wheel);
            let to = match joint {
                Some(joint) => steered.turned[joint % MAX_WHEELS],
                None => (zero, one),
            };
            let (sin, cos) = standing.at[wheel];
            let [forward, up] = local.upright((zero, one));
            // The far side of the rim.
            doubt = doubt | (up * cos).below(forward * sin);
            let [forward, up] = local.upright(to);
            let plane = on_plane(forward, up);
            let at = (steered.moved.select(plane.0, sin), steered.moved.select(plane.1, cos));
            speeds[wheel] = local.rolling(simd, to, at);
            fastest = fastest.max(speeds[wheel].abs());
        }
        let limit = all(simd, self.job.command.wheel_speed);
        let scale = limit.below(fastest).select(limit.quotient(fastest), one);
        let mut checked = scale;
        for speed in &speeds[..wheels] {
            checked = checked + *speed;
        }
        doubt = never | (doubt | !finite(simd, checked)) & known;
        self.write(span, &steered.angles, &speeds, &rates, known.select(scale, nan));
        doubt
    }

    /// Twist and joint rates of the wanted motion.
    #[inline(always)]
    fn rates<S: Vector>(
        &self,
        simd: S,
        given: Span,
        standing: &Standing<S>,
        contacts: &Contacts<S>,
        equations: &mut Equations<S>,
    ) -> (Row<S>, Mask<S>) {
        let zero = all(simd, 0.0);
        let (speed, yaw_rate) = match self.job.wanted {
            [[speed, yaw_rate]] => (all(simd, *speed), all(simd, *yaw_rate)),
            wanted => {
                let [speed, yaw_rate] = given.read::<S, 2>(simd, wanted.as_flattened(), 2);
                (speed, yaw_rate)
            }
        };
        let plan = [speed, yaw_rate * all(simd, self.job.command.offset), yaw_rate];
        let mut known = [Known::Nowhere; COLUMNS];
        for k in 0..MAX_FREE {
            if k >= self.plan.joints() {
                known[6 + k] = Known::Everywhere(zero);
            } else if standing.any_stopped {
                known[6 + k] = Known::Somewhere(standing.stopped[k], zero);
            }
        }
        match self.job.command.view {
            View::Body => {
                for (column, rate) in PLAN.into_iter().zip(plan) {
                    known[column] = Known::Everywhere(rate);
                }
                let follow =
                    SuspensionRates::new::<1>(simd, self.plan, self.square, standing, &known, contacts, equations);
                (follow.offset, follow.sure)
            }
            View::Plan => {
                let follow =
                    SuspensionRates::new::<3>(simd, self.plan, self.square, standing, &known, contacts, equations);
                let (plan, sure) = seen_from_above(simd, standing, &follow, plan, equations);
                (follow.rates(plan), follow.sure & sure)
            }
        }
    }

    /// Angles of the steering joints, those that are given or those at which wheels roll.
    #[inline(always)]
    fn steered<S: Vector>(
        &self,
        simd: S,
        given: Span,
        standing: &Standing<S>,
        locals: &[Local<S>],
        doubt: &mut Mask<S>,
    ) -> Steered<S> {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let mut steered =
            Steered { angles: [zero; MAX_WHEELS], turned: [(zero, one); MAX_WHEELS], moved: zero.below(zero) };
        let joints = self.job.chain.steering();
        let count = joints.len().min(MAX_WHEELS);
        if let Some(angles) = self.job.steering {
            steered.angles = given.read::<S, MAX_WHEELS>(simd, angles, joints.len());
            for k in 0..count {
                let far = all(simd, LARGEST_TURN).below(steered.angles[k].abs());
                *doubt = *doubt | far;
                let turn = steered.angles[k] - standing.steering[k];
                steered.turned[k] = direction(simd, turn);
            }
        } else {
            let steering = |wheel: usize| self.plan.steering(wheel);
            let found = aimed(simd, steering, locals, &standing.touching, doubt);
            for (k, aim) in found.iter().enumerate().take(count) {
                let Some(aim) = aim else { continue };
                let asked = standing.steering[k] + aim.angle;
                let within = within(simd, joints[k], asked, doubt);
                let (sin, cos) = aim.turned;
                if aim.beside {
                    *doubt = *doubt | !(asked - within.angle).abs().at_most(zero);
                }
                steered.angles[k] = within.angle;
                steered.turned[k] = (sin.flip(within.turned), cos.flip(within.turned));
            }
        }
        for k in 0..count {
            let stays = (steered.angles[k] - standing.steering[k]).abs().at_most(zero);
            steered.moved = steered.moved | !stays;
        }
        steered
    }

    #[inline(always)]
    fn write<S: Vector>(
        &mut self,
        span: Span,
        angles: &[Lanes<S>; MAX_WHEELS],
        speeds: &[Lanes<S>; MAX_WHEELS],
        rates: &Row<S>,
        scale: Lanes<S>,
    ) {
        let chain = self.job.chain;
        let simd = scale.simd();
        let zero = all(simd, 0.0);
        // NaN where nothing is known.
        let nothing = !scale.at_most(scale);
        let (mut steers, mut turns) = (*angles, *speeds);
        for k in 0..MAX_WHEELS {
            steers[k] = nothing.select(scale, angles[k]);
            turns[k] = speeds[k] * scale;
        }
        let (mut twist, mut joints) = ([zero; 6], [zero; MAX_FREE]);
        for (k, value) in twist.iter_mut().enumerate() {
            *value = rates[k] * scale;
        }
        for (k, value) in joints.iter_mut().enumerate() {
            *value = rates[6 + k] * scale;
        }
        let commands = &mut self.job.commands;
        span.write(simd, &steers, chain.steering().len(), commands.steering);
        span.write(simd, &turns, chain.wheels().len(), commands.speeds);
        span.write(simd, &twist, 6, commands.twists.as_flattened_mut());
        span.write(simd, &joints, chain.joints().len(), commands.joint_rates);
        span.write(simd, &[scale], 1, commands.scales);
    }
}

/// The motion in plan of the body that is this motion from above: see [`View::Plan`].
#[inline(always)]
fn seen_from_above<S: Vector>(
    simd: S,
    standing: &Standing<S>,
    follow: &SuspensionRates<S>,
    wanted: [Lanes<S>; 3],
    equations: &mut Equations<S>,
) -> ([Lanes<S>; 3], Mask<S>) {
    let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
    let ((sr, cr), (sp, cp)) = (standing.roll, standing.pitch);
    let level = [[cp, sp * sr, sp * cr], [zero, cr, -sr]];
    let inverse = one.quotient(cp);
    let turning = [sr * inverse, cr * inverse];
    // Of vx, vy, vz, wy and wz, by the motion in plan.
    let mut spread = [[zero; 3]; COLUMNS];
    for (k, column) in PLAN.into_iter().enumerate() {
        spread[column][k] = one;
    }
    for (column, told) in follow.unknown.iter().zip(&follow.spread).take(follow.count) {
        spread[*column] = *told;
    }
    let mut system = [[zero; 3]; 3];
    for k in 0..3 {
        for (cells, row) in system.iter_mut().zip(&level) {
            for c in 0..3 {
                cells[k] = row[c].mul_add(spread[c][k], cells[k]);
            }
        }
        system[2][k] = turning[0].mul_add(spread[4][k], turning[1] * spread[5][k]);
    }
    equations.clear();
    for (cells, value) in system.iter().zip(wanted) {
        let row = equations.add(0b111);
        row[..3].copy_from_slice(cells);
        row[3] = value;
    }
    let (solution, sure) = equations.solve::<1>(simd, 3);
    ([solution[0][0], solution[1][0], solution[2][0]], sure)
}
