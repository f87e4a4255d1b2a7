//! [`Contacts::forward`](super::super::Contacts::forward) for many rows.

use super::columns::Span;
use super::least_squares::Normal;
use super::prepared::Prepared;
use super::run::{InLanes, Rows, through};
use super::settled_poses::{SettledPoses, Standing, on_plane};
use super::suspension_rates::{Contact, Contacts, Known, MotionScratch, Row, SuspensionRates, Touch, answers, swivel};
use crate::contact;
use crate::contact::COLUMNS;
use crate::motion::{PLAN, Readings, weights};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::direction;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::suspension::lanes::{LARGEST_TURN, Placing, all, cross, dot, from_turned};
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// Measurements, row after row: see [`Readings`].
#[derive(Clone, Copy, Debug)]
pub struct ReadingRows<'a> {
    /// Steering angles, where they are not those of the footing [rad].
    pub steering: Option<&'a [f64]>,
    /// Speeds of the wheels [rad/s].
    pub speeds: &'a [f64],
    /// Rates of the steering angles [rad/s].
    pub steering_rates: Option<&'a [f64]>,
    /// Rates of the free angles [rad/s].
    pub joint_rates: Option<&'a [f64]>,
    /// Of the body about its axes [rad/s].
    pub angular_velocity: Option<&'a [f64]>,
    /// Of every wheel, the same in all rows.
    pub weights: Option<&'a [f64]>,
}

/// Motions of bodies, row after row: see [`Moving`](super::super::Moving).
#[derive(Debug)]
pub struct Movings<'a> {
    /// Of the body [m/s, rad/s].
    pub twists: &'a mut [[f64; 6]],
    /// Of the free angles [rad/s].
    pub joint_rates: &'a mut [f64],
    /// Of every wheel [m/s].
    pub residuals: &'a mut [f64],
}

/// [`Contacts::forward`] for every row.
pub fn forward_rows(
    chain: &Chain,
    prepared: &Prepared,
    footings: &SettledPoses<'_>,
    readings: &ReadingRows<'_>,
    movings: Movings<'_>,
    workers: Workers,
) {
    let workers = workers.here();
    let share = workers.share(movings.twists.len());
    let (wheels, free) = (chain.wheels().len(), chain.joints().len());
    let mut joint_rates = movings.joint_rates.chunks_mut((share * free).max(1));
    let jobs = movings.twists.chunks_mut(share).zip(movings.residuals.chunks_mut(share * wheels * 3)).enumerate().map(
        |(k, (twists, residuals))| ForwardRange {
            chain,
            footings,
            readings,
            first: k * share,
            movings: Movings { twists, joint_rates: joint_rates.next().unwrap_or_default(), residuals },
        },
    );
    // A job does not fail.
    let _ = workers.each(jobs, |job| through(prepared, workers.level, job));
}

/// Rows that one thread takes.
struct ForwardRange<'a> {
    chain: &'a Chain,
    footings: &'a SettledPoses<'a>,
    readings: &'a ReadingRows<'a>,
    /// The first of its rows among all.
    first: usize,
    movings: Movings<'a>,
}

impl Rows for ForwardRange<'_> {
    type Scratch<S: Vector> = MotionScratch<S>;

    #[inline(always)]
    fn room<S: Vector>(simd: S) -> MotionScratch<S> {
        MotionScratch::new(simd)
    }

    fn count(&self) -> usize {
        self.movings.twists.len()
    }

    #[inline(always)]
    fn some<S: Vector>(
        lanes: &mut InLanes<'_, Self>,
        simd: S,
        span: Span,
        placing: &mut Placing<'_, S>,
        room: &mut MotionScratch<S>,
    ) -> Mask<S> {
        match lanes.measures() {
            true => lanes.some::<S, 4>(simd, span, placing, room),
            false => lanes.some::<S, 3>(simd, span, placing, room),
        }
    }

    fn one(&mut self, row: usize) -> Result<(), Error> {
        let (place, chain) = (self.first + row, self.chain);
        let (wheels, free, steered) = (chain.wheels().len(), chain.joints().len(), chain.steering().len());
        let mut radii = [0.0; MAX_WHEELS];
        for (radius, wheel) in radii.iter_mut().zip(chain.wheels()) {
            *radius = wheel.radius;
        }
        let of = |width: usize| place * width..(place + 1) * width;
        let some = self.readings;
        let readings = Readings {
            speeds: &some.speeds[of(wheels)],
            steering_rates: some.steering_rates.map(|rates| &rates[of(steered)]),
            joint_rates: some.joint_rates.map(|rates| &rates[of(free)]),
            angular_velocity: some.angular_velocity.map(|rates| &rates[of(3)]),
            weights: some.weights,
        };
        let given = some.steering.map(|angles| &angles[of(steered)]);
        let moving = self.footings.with(chain, place, |footing| {
            let turned = given.filter(|angles| *angles != footing.steering);
            let contacts = contact::Contacts::new(chain, footing, turned);
            contacts.map(|contacts| contacts.forward(&readings, &radii))
        });
        let (twist, rates, residual) = moving
            .map_or(([f64::NAN; 6], [f64::NAN; MAX_FREE], [[f64::NAN; 3]; MAX_WHEELS]), |moving| {
                (moving.twist, moving.joint_rates, moving.residual)
            });
        self.movings.twists[row] = twist;
        self.movings.joint_rates[row * free..][..free].copy_from_slice(&rates[..free]);
        self.movings.residuals[row * 3 * wheels..][..3 * wheels].copy_from_slice(residual[..wheels].as_flattened());
        Ok(())
    }
}

impl InLanes<'_, ForwardRange<'_>> {
    /// Some rows, and the lanes that are for the plain way. Of right-hand sides there are 4, but 3 where nothing
    /// is measured beside the wheels.
    #[inline(always)]
    fn some<S: Vector, const RIGHT: usize>(
        &mut self,
        simd: S,
        span: Span,
        placing: &mut Placing<'_, S>,
        room: &mut MotionScratch<S>,
    ) -> Mask<S> {
        let (plan, chain) = (self.plan, self.job.chain);
        let given = Span { first: self.job.first + span.first, ..span };
        let (zero, nan) = (all(simd, 0.0), all(simd, f64::NAN));
        let mut doubt = zero.below(zero);
        let footings = self.job.footings;
        let MotionScratch { eights, equations, contacts, standing } = room;
        standing.read(simd, chain, footings, given, eights, &mut doubt);
        let standing = &*standing;
        placing.place(simd, &standing.joints);
        let (placing, wheels) = (&*placing, plan.wheels().min(MAX_WHEELS));
        self.contacts(simd, given, standing, placing, contacts, &mut doubt);
        let known = self.known(simd, given, standing);
        let follow = SuspensionRates::new::<RIGHT>(simd, plan, self.square, standing, &known, contacts, equations);
        let speeds = given.read::<S, MAX_WHEELS>(simd, self.job.readings.speeds, wheels);
        let mut fit = Normal::new(simd);
        let mut says = [[([zero; 3], zero); 2]; MAX_WHEELS];
        for (wheel, says) in says.iter_mut().enumerate().take(wheels) {
            let [roll, side] = weights(self.job.readings.weights, wheels, wheel);
            let speed = speeds[wheel];
            let measured = speed.at_most(speed);
            let rolled = all(simd, plan.radius(wheel)) * measured.select(speed, zero);
            let Contact { rows, swivel } = &contacts[wheel];
            says[0] = follow.told::<RIGHT>(plan, wheel, &rows[1], swivel[1] - rolled);
            says[1] = follow.told::<RIGHT>(plan, wheel, &rows[2], swivel[2]);
            let touching = standing.touching[wheel];
            let counts = measured.select(all(simd, roll), zero) * touching;
            fit.add(says[0].0, says[0].1, counts);
            fit.add(says[1].0, says[1].1, all(simd, side) * touching);
        }
        // What the wheels do along the normals comes last: in lanes where it is nothing it is as if there were none.
        let exactly = follow.exactly(simd, &known, wheels);
        if (!exactly).any() {
            for (wheel, Contact { rows, swivel }) in contacts.iter().enumerate().take(wheels) {
                let [roll, side] = weights(self.job.readings.weights, wheels, wheel);
                let measured = speeds[wheel].at_most(speeds[wheel]);
                let share = measured.select(all(simd, roll.max(side)), all(simd, side));
                let counts = exactly.select(zero, share * standing.touching[wheel]);
                let (columns, left) = follow.told::<RIGHT>(plan, wheel, &rows[0], swivel[0]);
                fit.add(columns, left, counts);
            }
        }
        if let Known::Somewhere(here, _) = known[PLAN[2]] {
            fit.know_last(here);
        }
        let (mut motion, sure) = fit.solve(simd);
        doubt = doubt | (!(sure & follow.sure) & !standing.nowhere);
        for rate in &mut motion {
            *rate = standing.nowhere.select(nan, *rate);
        }
        let rates = follow.rates(motion);
        let mut residuals = [nan; 3 * MAX_WHEELS];
        for (wheel, says) in says.iter().enumerate().take(wheels) {
            let touches = zero.below(standing.touching[wheel]);
            let Contact { rows, swivel } = &contacts[wheel];
            let mut lift = swivel[0];
            for (part, rate) in rows[0].iter().zip(rates) {
                lift = part.mul_add(rate, lift);
            }
            let [rolled, aside] = [dot(says[0].0, motion), dot(says[1].0, motion)];
            let (rolled, aside) = (rolled + says[0].1, aside + says[1].1);
            let rolled = speeds[wheel].at_most(speeds[wheel]).select(rolled, nan);
            for (i, residual) in [lift, rolled, aside].into_iter().enumerate() {
                residuals[3 * wheel + i] = touches.select(residual, nan);
            }
        }
        self.write(span, standing, &rates, &residuals);
        doubt
    }

    /// Writes the contacts' velocities by the rates, at the given steering angles.
    #[inline(always)]
    fn contacts<S: Vector>(
        &self,
        simd: S,
        given: Span,
        standing: &Standing<S>,
        placing: &Placing<'_, S>,
        contacts: &mut Contacts<S>,
        doubt: &mut Mask<S>,
    ) {
        let (plan, zero) = (self.plan, all(simd, 0.0));
        let steered = self.job.chain.steering().len().min(MAX_WHEELS);
        let (mut angles, mut steers) = (standing.steering, standing.steers);
        let mut turned = zero.below(zero);
        if let Some(steering) = self.job.readings.steering {
            angles = given.read::<S, MAX_WHEELS>(simd, steering, steered);
            steers = true;
            for (angle, stands) in angles.iter().zip(standing.steering).take(steered) {
                turned = turned | !(*angle - stands).abs().at_most(zero);
                *doubt = *doubt | all(simd, LARGEST_TURN).below(angle.abs());
            }
        }
        let any_turned = turned.any();
        let rates = self.job.readings.steering_rates;
        let rates = rates.map(|rates| given.read::<S, MAX_WHEELS>(simd, rates, steered));
        let straight = (zero, all(simd, 1.0));
        let (mut to, mut from) = ([None; MAX_WHEELS], [None; MAX_WHEELS]);
        for k in 0..steered {
            if steers {
                to[k] = Some(direction(simd, angles[k]));
            }
            if standing.steers && any_turned {
                from[k] = Some(direction(simd, standing.steering[k]));
            }
        }
        for (wheel, contact) in contacts.iter_mut().enumerate().take(plan.wheels()) {
            let joint = plan.steering(wheel).map(|joint| joint % MAX_WHEELS);
            let (mut stands, mut turns) = (None, None);
            if let Some(joint) = joint {
                (stands, turns) = (from[joint], to[joint]);
            }
            let normal = standing.normals[wheel];
            let mut at = standing.at[wheel];
            if any_turned {
                let own = placing.limb(wheel).own(normal);
                let [ahead, _, up] = from_turned(stands.unwrap_or(straight), own);
                // The far side of the rim.
                *doubt = *doubt | (turned & (up * at.1).below(ahead * at.0));
                let [ahead, ..] = from_turned(turns.unwrap_or(straight), own);
                let plane = on_plane(ahead, up);
                at = (turned.select(plane.0, at.0), turned.select(plane.1, at.1));
            }
            let mut centre = placing.centres[wheel];
            if let Some(turned) = turns {
                centre = placing.steered(simd, wheel, turned);
            }
            let radius = all(simd, plan.radius(wheel));
            let touch = Touch::new(placing, wheel, centre, radius, turns, at);
            let directions = [normal, touch.tangent, cross(normal, touch.tangent)];
            answers(placing, wheel, touch.point, directions, &mut contact.rows);
            if let (Some(joint), Some(rates)) = (joint, &rates) {
                contact.swivel = swivel(simd, placing, wheel, touch.point, directions);
                for part in &mut contact.swivel {
                    *part = *part * rates[joint];
                }
            }
        }
    }

    /// Rates that are no unknowns.
    #[inline(always)]
    fn known<S: Vector>(&self, simd: S, given: Span, standing: &Standing<S>) -> [Known<S>; COLUMNS] {
        let zero = all(simd, 0.0);
        let mut known = [Known::Nowhere; COLUMNS];
        let free = self.plan.joints().min(MAX_FREE);
        if let Some(turning) = self.job.readings.angular_velocity {
            let turning = given.read::<S, 3>(simd, turning, 3);
            for k in 0..3 {
                known[3 + k] = measured(simd, turning[k]);
            }
        }
        if let Some(rates) = self.job.readings.joint_rates {
            let rates = given.read::<S, MAX_FREE>(simd, rates, free);
            for k in 0..free {
                known[6 + k] = measured(simd, rates[k]);
            }
        }
        for k in free..MAX_FREE {
            known[6 + k] = Known::Everywhere(zero);
        }
        if standing.any_stopped {
            for k in 0..free {
                let stopped = zero.below(standing.stopped[k]);
                known[6 + k] = match known[6 + k] {
                    Known::Nowhere => Known::Somewhere(standing.stopped[k], zero),
                    Known::Everywhere(rate) => Known::Everywhere(stopped.select(zero, rate)),
                    Known::Somewhere(here, rate) => {
                        Known::Somewhere(here.max(standing.stopped[k]), stopped.select(zero, rate))
                    }
                };
            }
        }
        known
    }

    /// True if joints, body or steering rates are measured as well as the wheels.
    fn measures(&self) -> bool {
        let readings = self.job.readings;
        let beside = [readings.joint_rates, readings.angular_velocity, readings.steering_rates];
        beside.iter().any(Option::is_some)
    }

    #[inline(always)]
    fn write<S: Vector>(
        &mut self,
        span: Span,
        standing: &Standing<S>,
        rates: &Row<S>,
        residuals: &[Lanes<S>; 3 * MAX_WHEELS],
    ) {
        let (wheels, free) = (self.plan.wheels(), self.plan.joints());
        let simd = rates[0].simd();
        let nan = all(simd, f64::NAN);
        let (mut twist, mut joints) = ([nan; 6], [nan; MAX_FREE]);
        for (k, value) in twist.iter_mut().enumerate() {
            *value = standing.nowhere.select(nan, rates[k]);
        }
        for (k, value) in joints.iter_mut().enumerate() {
            *value = standing.nowhere.select(nan, rates[6 + k]);
        }
        let movings = &mut self.job.movings;
        span.write(simd, &twist, 6, movings.twists.as_flattened_mut());
        span.write(simd, &joints, free, movings.joint_rates);
        span.write(simd, residuals, 3 * wheels, movings.residuals);
    }
}

/// A rate that is NaN where it was not measured.
#[inline(always)]
fn measured<S: Vector>(simd: S, rate: Lanes<S>) -> Known<S> {
    let zero = all(simd, 0.0);
    let here = rate.at_most(rate);
    if !here.any() {
        Known::Nowhere
    } else {
        // Even if it is everywhere: a row is not to be solved in another order for what its neighbours know.
        let one = all(simd, 1.0);
        Known::Somewhere(here.select(one, zero), here.select(rate, zero))
    }
}
