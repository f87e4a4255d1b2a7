//! [`traction`] for many rows.

use super::columns::{Span, Way, angle_of, finite, way, within};
use super::prepared::Prepared;
use super::run::{InLanes, Rows, through};
use super::two_link_chain::OneRow;
use crate::driving::{Drives, Driving, Turns};
use crate::traction::{Closure, DAMPING, FOUND, Rates, STEPS, traction};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::direction;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::suspension::lanes::{LARGEST_TURN, Placing, Turned, Vectors, all, from_turned};
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// [`traction`] for every row. Fails at the first one at which a wheel would steer past its range.
pub fn traction_rows(
    chain: &Chain,
    prepared: &Prepared,
    driving: &Driving<'_>,
    mut drives: Drives<'_>,
    workers: Workers,
) -> Result<(), Error> {
    let workers = workers.here();
    let steepest = driving.lift.slope();
    let rows = drives.vertical.len();
    if let (1, Some(instant)) = (rows, &prepared.instant) {
        let row = OneRow { instant, offset: prepared.offset, steepest, driving, drives: &mut drives };
        if workers.level.run(row) == Some(true) {
            return Ok(());
        }
    }
    let share = workers.share(rows);
    let (wheels, steered) = (chain.wheels().len(), chain.steering().len());
    let mut steering = drives.steering.chunks_mut((share * steered).max(1));
    let jobs = drives
        .vertical
        .chunks_mut(share)
        .zip(drives.speeds.chunks_mut(share * wheels))
        .zip(drives.contact_angles.chunks_mut(share * wheels))
        .zip(drives.lifted.chunks_mut(share * wheels))
        .enumerate()
        .map(|(k, (((vertical, speeds), contact_angles), lifted))| TractionRange {
            chain,
            prepared,
            driving,
            steepest,
            first: k * share,
            drives: Drives { steering: steering.next().unwrap_or_default(), speeds, contact_angles, lifted, vertical },
        });
    workers.each(jobs, |job| through(prepared, workers.level, job))
}

/// Rows that one thread takes.
struct TractionRange<'a> {
    chain: &'a Chain,
    prepared: &'a Prepared,
    driving: &'a Driving<'a>,
    /// Slope that is the steepest: see [`Lift`].
    steepest: f64,
    /// The first of its rows among all.
    first: usize,
    drives: Drives<'a>,
}

/// The number of a row, or that of all.
fn at(values: &[f64], row: usize) -> f64 {
    match values {
        [value] => *value,
        _ => values[row],
    }
}

impl Rows for TractionRange<'_> {
    type Scratch<S: Vector> = ();

    fn room<S: Vector>(_: S) {}

    fn count(&self) -> usize {
        self.drives.vertical.len()
    }

    #[inline(always)]
    fn some<S: Vector>(
        lanes: &mut InLanes<'_, Self>,
        simd: S,
        span: Span,
        placing: &mut Placing<'_, S>,
        (): &mut (),
    ) -> Mask<S> {
        lanes.some(simd, span, placing)
    }

    fn one(&mut self, row: usize) -> Result<(), Error> {
        let (all, driving) = (self.first + row, self.driving);
        let (wheels, free, steered) =
            (self.chain.wheels().len(), self.chain.joints().len(), self.chain.steering().len());
        let of = |width: usize| all * width..(all + 1) * width;
        let speed = at(driving.speed, all);
        let [roll_rate, pitch_rate, _] = driving.angular_velocity[all];
        let rates = Rates {
            speed,
            yaw_rate: match driving.turning {
                Turns::Curvature(curvature) => speed * at(curvature, all),
                Turns::YawRate(yaw_rate) => at(yaw_rate, all),
            },
            tilt_rates: [roll_rate, pitch_rate],
            joints: &driving.joints[of(free)],
            joint_rates: &driving.joint_rates[of(free)],
            steering: driving.steering.map_or(&[], |some| &some[of(steered)]),
        };
        let measured = driving.wheel_speeds.map(|some| &some[of(wheels)]);
        let closure = measured.map_or(Closure::Suspension, Closure::Wheels);
        let driven = traction(self.chain, self.prepared.offset, &rates, closure, driving.lift)
            .map_err(|error| error.at_row(all))?;
        let drives = &mut self.drives;
        drives.speeds[row * wheels..][..wheels].copy_from_slice(&driven.speeds[..wheels]);
        drives.steering[row * steered..][..steered].copy_from_slice(&driven.steering[..steered]);
        drives.contact_angles[row * wheels..][..wheels].copy_from_slice(&driven.contact_angles[..wheels]);
        drives.lifted[row * wheels..][..wheels].copy_from_slice(&driven.lifted[..wheels]);
        drives.vertical[row] = driven.vertical;
        Ok(())
    }
}

/// Desired velocities of the body, and rates of the body and the free angles.
struct Wanted<S: Vector> {
    body: [Vectors<S>; 2],
    rates: [Lanes<S>; MAX_FREE],
}

impl<S: Vector> Wanted<S> {
    /// The velocity of a point of the body as commanded [m/s].
    #[inline(always)]
    fn in_plan(&self, point: Vectors<S>) -> [Lanes<S>; 2] {
        let [[speed, sideways, _], [_, _, turn]] = self.body;
        [speed - turn * point[1], turn.mul_add(point[0], sideways)]
    }
}

/// The velocity of a wheel's centre along and across its link, but for the body's vertical speed: see `traction`.
#[derive(Clone, Copy)]
struct Centre<S: Vector> {
    along: Lanes<S>,
    across: Lanes<S>,
    vertical: [Lanes<S>; 2],
    turn: Lanes<S>,
    radius: f64,
}

impl<S: Vector> Centre<S> {
    #[inline(always)]
    fn at(&self, vertical: Lanes<S>) -> [Lanes<S>; 2] {
        [self.vertical[0].mul_add(vertical, self.along), self.vertical[1].mul_add(vertical, self.across)]
    }
}

impl InLanes<'_, TractionRange<'_>> {
    /// Some rows, and the lanes that are for the plain way.
    #[inline(always)]
    fn some<S: Vector>(&mut self, simd: S, some: Span, placing: &mut Placing<'_, S>) -> Mask<S> {
        let (plan, driving) = (self.plan, self.job.driving);
        let given = Span { first: self.job.first + some.first, ..some };
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let (wheels, free) = (plan.wheels().min(MAX_WHEELS), plan.joints());
        let joints = given.read::<S, MAX_FREE>(simd, driving.joints, free);
        let mut doubt = zero.below(zero);
        for angle in &joints[..free.min(MAX_FREE)] {
            doubt = doubt | all(simd, LARGEST_TURN).below(angle.abs());
        }
        let wanted = self.wanted(simd, given);
        placing.place(simd, &joints);
        let (angles, turned) = self.steered(simd, given, placing, &wanted, &mut doubt);
        placing.moves(wanted.body, &wanted.rates);
        let none = Centre { along: zero, across: zero, vertical: [zero; 2], turn: zero, radius: 1.0 };
        let mut centres = [none; MAX_WHEELS];
        for (wheel, centre) in centres.iter_mut().enumerate().take(wheels) {
            let mut to = (zero, one);
            if let Some(joint) = plan.steering(wheel) {
                to = turned[joint % MAX_WHEELS];
                placing.steer(simd, wheel, to);
            }
            let limb = placing.limb(wheel);
            let [velocity, turn] = placing.carried(wheel, placing.centres[wheel]);
            let [along, _, across] = from_turned(to, limb.own(velocity));
            let [_, turn, _] = from_turned(to, limb.own(turn));
            let [ahead, _, up] = from_turned(to, limb.own([zero, zero, one]));
            *centre = Centre { along, across, vertical: [ahead, up], turn, radius: plan.radius(wheel) };
        }
        let placing = &*placing;
        let centres = &centres[..wheels];
        let mut vertical = along_the_links(simd, centres);
        if let Some(measured) = driving.wheel_speeds {
            let measured = given.read::<S, MAX_WHEELS>(simd, measured, wheels);
            vertical = from_wheels(simd, centres, &measured, vertical, &mut doubt);
        }
        let mut checked = vertical;
        let (mut speeds, mut contacts) = ([zero; MAX_WHEELS], [zero; MAX_WHEELS]);
        let mut lifted = zero;
        let steepest = all(simd, self.job.steepest * self.job.steepest);
        let slowest = all(simd, driving.lift.speed);
        for (wheel, centre) in centres.iter().enumerate() {
            let velocity = centre.at(vertical);
            let to: Way<S> = way(velocity, (zero, one), &mut doubt);
            let rolled = to.length.flip(to.sign) * all(simd, 1.0 / centre.radius);
            speeds[wheel] = rolled - centre.turn;
            contacts[wheel] = angle_of(simd, to.turned);
            checked = checked + speeds[wheel];
            let [x, y] = wanted.in_plan(placing.centres[wheel]);
            // Squares: a root takes as long as the rest of it.
            let slope = steepest * x.mul_add(x, y * y);
            let across = velocity[1];
            let lifts = slowest.below(across.abs()) & slope.below(across * across);
            lifted = lifted + lifts.select(all(simd, f64::from(1_u32 << wheel)), zero);
        }
        // What is not finite is not sure to be what the plain way says.
        doubt = doubt | !finite(simd, checked);
        self.write(some, &angles, &speeds, &contacts, lifted, vertical);
        doubt
    }

    #[inline(always)]
    fn wanted<S: Vector>(&self, simd: S, given: Span) -> Wanted<S> {
        let driving = self.job.driving;
        let speed = given.one(simd, driving.speed);
        let yaw_rate = match driving.turning {
            Turns::Curvature(curvature) => speed * given.one(simd, curvature),
            Turns::YawRate(yaw_rate) => given.one(simd, yaw_rate),
        };
        let measured = driving.angular_velocity.as_flattened();
        let [roll_rate, pitch_rate, _] = given.read::<S, 3>(simd, measured, 3);
        let sideways = yaw_rate * all(simd, self.job.prepared.offset);
        Wanted {
            body: [[speed, sideways, all(simd, 0.0)], [roll_rate, pitch_rate, yaw_rate]],
            rates: given.read::<S, MAX_FREE>(simd, driving.joint_rates, self.plan.joints()),
        }
    }

    /// Angles of the steering joints, and their directions: where the centres of their wheels go together.
    #[inline(always)]
    fn steered<S: Vector>(
        &self,
        simd: S,
        given: Span,
        placing: &Placing<'_, S>,
        wanted: &Wanted<S>,
        doubt: &mut Mask<S>,
    ) -> ([Lanes<S>; MAX_WHEELS], [Turned<S>; MAX_WHEELS]) {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let mut ways = [[zero; 2]; MAX_WHEELS];
        for wheel in 0..self.plan.wheels().min(MAX_WHEELS) {
            let Some(joint) = self.plan.steering(wheel) else {
                continue;
            };
            let [x, y] = wanted.in_plan(placing.centres[wheel]);
            let [ahead, aside, _] = placing.limb(wheel).own([x, y, zero]);
            let way = &mut ways[joint % MAX_WHEELS];
            *way = [way[0] + ahead, way[1] + aside];
        }
        let (mut angles, mut turned) = ([zero; MAX_WHEELS], [(zero, one); MAX_WHEELS]);
        let ranges = self.job.chain.steering();
        for (joint, range) in ranges.iter().enumerate().take(MAX_WHEELS) {
            if !self.plan.is_centred(joint) {
                // Where they go then depends on where they are steered to.
                *doubt = zero.at_most(zero);
            }
            let mut to = way(ways[joint], (zero, one), doubt);
            let mut angle = angle_of(simd, to.turned);
            if to.rests.any() {
                self.rest(simd, given, joint, &mut to, &mut angle, doubt);
            }
            let within = within(simd, *range, angle, doubt);
            angles[joint] = within.angle;
            turned[joint] = (to.turned.0.flip(within.turned), to.turned.1.flip(within.turned));
        }
        (angles, turned)
    }

    /// Wheels that rest keep the angle that they have.
    #[inline(always)]
    fn rest<S: Vector>(
        &self,
        simd: S,
        given: Span,
        joint: usize,
        to: &mut Way<S>,
        angle: &mut Lanes<S>,
        doubt: &mut Mask<S>,
    ) {
        let mut present = all(simd, 0.0);
        if let Some(steering) = self.job.driving.steering {
            let steered = self.job.chain.steering().len();
            let angles = given.read::<S, MAX_WHEELS>(simd, steering, steered);
            present = angles[joint % MAX_WHEELS];
        }
        *doubt = *doubt | (to.rests & all(simd, LARGEST_TURN).below(present.abs()));
        let (sin, cos) = direction(simd, present);
        to.turned = (to.rests.select(sin, to.turned.0), to.rests.select(cos, to.turned.1));
        *angle = to.rests.select(present, *angle);
    }

    #[inline(always)]
    fn write<S: Vector>(
        &mut self,
        some: Span,
        angles: &[Lanes<S>; MAX_WHEELS],
        speeds: &[Lanes<S>; MAX_WHEELS],
        contacts: &[Lanes<S>; MAX_WHEELS],
        lifted: Lanes<S>,
        vertical: Lanes<S>,
    ) {
        let (wheels, steered) = (self.plan.wheels(), self.job.chain.steering().len());
        let (simd, drives) = (vertical.simd(), &mut self.job.drives);
        some.write(simd, angles, steered, drives.steering);
        some.write(simd, speeds, wheels, drives.speeds);
        some.write(simd, contacts, wheels, drives.contact_angles);
        some.write(simd, &[vertical], 1, drives.vertical);
        some.flags(lifted, wheels, drives.lifted);
    }
}

/// [`Closure::Suspension`].
#[inline(always)]
fn along_the_links<S: Vector>(simd: S, centres: &[Centre<S>]) -> Lanes<S> {
    let zero = all(simd, 0.0);
    let mut speeds = [zero; MAX_WHEELS];
    let mut sum = zero;
    for (speed, centre) in speeds.iter_mut().zip(centres) {
        *speed = zero - centre.across.quotient(centre.vertical[1]);
        sum = sum + *speed;
    }
    let count = centres.len().min(MAX_WHEELS);
    // The smallest to the front, so far as it takes.
    for k in 0..=count / 2 {
        for i in k + 1..count {
            let (a, b) = (speeds[k], speeds[i]);
            speeds[k] = a.min(b);
            speeds[i] = a.max(b);
        }
    }
    let middle = count / 2;
    let median = match count % 2 {
        1 => speeds[middle],
        _ => all(simd, 0.5) * (speeds[(middle + MAX_WHEELS - 1) % MAX_WHEELS] + speeds[middle]),
    };
    // NaN where one of them is.
    sum.at_most(sum).select(median, sum)
}

/// [`Closure::Wheels`]; lanes that have found theirs wait for the others.
#[inline(always)]
fn from_wheels<S: Vector>(
    simd: S,
    centres: &[Centre<S>],
    measured: &[Lanes<S>; MAX_WHEELS],
    start: Lanes<S>,
    doubt: &mut Mask<S>,
) -> Lanes<S> {
    let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
    let mut vertical = start;
    let mut open = zero.below(one);
    for _ in 0..STEPS {
        let (mut slope, mut square) = (zero, all(simd, DAMPING));
        for (centre, measured) in centres.iter().zip(measured) {
            let [along, across] = centre.at(vertical);
            let speed = along.mul_add(along, across * across).sqrt();
            let [ahead, up] = centre.vertical;
            let moves = zero.below(speed);
            let inverse = one.quotient(moves.select(speed, one));
            let derivative = along.mul_add(ahead, across * up) * inverse;
            let rolled = (all(simd, centre.radius) * (*measured + centre.turn)).abs();
            let missing = moves.select(rolled - speed, zero);
            slope = derivative.mul_add(missing, slope);
            square = moves.select(derivative, zero).mul_add(derivative, square);
        }
        let step = slope.quotient(square);
        vertical = open.select(vertical + step, vertical);
        open = open & all(simd, FOUND).at_most(step.abs());
        if !open.any() {
            break;
        }
    }
    // Where there is none to be found the last one depends on every rounding.
    *doubt = *doubt | open;
    vertical
}
