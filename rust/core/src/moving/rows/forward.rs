//! [`Contacts::forward`](super::super::Contacts::forward) for many rows.

use super::Prepared;
use super::columns::Span;
use super::follow::{Follow, Known, Row, Touch, row, swivel};
use super::footings::{Footings, Standing, on_plane};
use super::run::{InLanes, Rows, through};
use super::solve::{back, triangular};
use crate::batch::Workers;
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::polynomials::direction;
use crate::batch::machine::vector::Vector;
use crate::error::Error;
use crate::moving::contact::{COLUMNS, Contacts};
use crate::moving::motion::{PLAN, Readings, weights};
use crate::suspension::lanes::{LARGEST_TURN, Placing, Plan, Vectors, WheelAt, all, cross, dot};
use crate::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// What was measured, row after row: see [`Readings`].
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

/// How bodies move, row after row: see [`Moving`](super::super::Moving).
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
    footings: &Footings<'_>,
    readings: &ReadingRows<'_>,
    movings: Movings<'_>,
    workers: Workers,
) {
    let workers = workers.here();
    let share = workers.share(movings.twists.len());
    let (wheels, free) = (chain.wheels().len(), chain.joints().len());
    let mut joint_rates = movings.joint_rates.chunks_mut((share * free).max(1));
    let jobs = movings
        .twists
        .chunks_mut(share)
        .zip(movings.residuals.chunks_mut(share * wheels * 3))
        .enumerate()
        .map(|(k, (twists, residuals))| Job {
            chain,
            footings,
            readings,
            first: k * share,
            movings: Movings {
                twists,
                joint_rates: joint_rates.next().unwrap_or_default(),
                residuals,
            },
        });
    // A job does not fail.
    let _ = workers.each(jobs, |job| through(prepared, workers.level, job));
}

/// Rows that one thread takes.
struct Job<'a> {
    chain: &'a Chain,
    footings: &'a Footings<'a>,
    readings: &'a ReadingRows<'a>,
    /// The first of its rows among all.
    first: usize,
    movings: Movings<'a>,
}

impl Rows for Job<'_> {
    fn count(&self) -> usize {
        self.movings.twists.len()
    }

    #[inline(always)]
    fn some<S: Vector>(
        lanes: &mut InLanes<'_, Self>,
        simd: S,
        span: Span,
        placing: &mut Placing<'_, S>,
    ) -> Mask<S> {
        lanes.some(simd, span, placing)
    }

    fn one(&mut self, row: usize) -> Result<(), Error> {
        let (place, chain) = (self.first + row, self.chain);
        let (wheels, free, steered) = (
            chain.wheels().len(),
            chain.joints().len(),
            chain.steering().len(),
        );
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
            let contacts = Contacts::new(chain, footing, turned);
            contacts.map(|contacts| contacts.forward(&readings, &radii))
        });
        let (twist, rates, residual) = moving.map_or(
            (
                [f64::NAN; 6],
                [f64::NAN; MAX_FREE],
                [[f64::NAN; 3]; MAX_WHEELS],
            ),
            |moving| (moving.twist, moving.joint_rates, moving.residual),
        );
        self.movings.twists[row] = twist;
        self.movings.joint_rates[row * free..][..free].copy_from_slice(&rates[..free]);
        self.movings.residuals[row * 3 * wheels..][..3 * wheels]
            .copy_from_slice(residual[..wheels].as_flattened());
        Ok(())
    }
}

/// Products of the diagonal of a triangle above this share of the cube of its size are sure to come from columns that
/// do not depend on each other.
const INDEPENDENT: f64 = 1e-6;

/// What a wheel says: how its contact moves along the normal, along the rim and to the left, by the rates, and what of it
/// its steering adds.
#[derive(Clone, Copy)]
struct Contact<S: Vector> {
    normal: Row<S>,
    rolling: Row<S>,
    side: Row<S>,
    swivel: [Lanes<S>; 3],
}

impl InLanes<'_, Job<'_>> {
    /// Some rows, and the lanes that are for the plain way.
    #[inline(always)]
    fn some<S: Vector>(&mut self, simd: S, span: Span, placing: &mut Placing<'_, S>) -> Mask<S> {
        let (plan, chain) = (self.plan, self.job.chain);
        let given = Span {
            first: self.job.first + span.first,
            ..span
        };
        let zero = all(simd, 0.0);
        let mut doubt = zero.below(zero);
        let standing = Standing::new(simd, chain, self.job.footings, given, &mut doubt);
        let contacts = self.contacts(simd, given, &standing, placing, &mut doubt);
        let contacts = &contacts[..plan.wheels().min(MAX_WHEELS)];
        let known = self.known(simd, given, &standing);
        let mut normals = [([zero; COLUMNS], zero); MAX_WHEELS];
        for (normal, contact) in normals.iter_mut().zip(contacts) {
            *normal = (contact.normal, contact.swivel[0]);
        }
        let follow = Follow::new::<4>(simd, &standing, &known, &normals[..contacts.len()]);
        let exactly = follow.exactly(simd, &known, contacts.len());
        let everywhere = !(!exactly).any();
        let speeds = given.read::<S, MAX_WHEELS>(simd, self.job.readings.speeds, contacts.len());
        let nan = all(simd, f64::NAN);
        let mut rows = [[zero; 4]; 3 * MAX_WHEELS + 1];
        let mut told = [[([zero; 3], zero); 3]; MAX_WHEELS];
        // What the wheels do along the normals comes last: then rows of nothing, in lanes where it is nothing, are as none.
        let lifts = if everywhere { 0 } else { contacts.len() };
        let mut filled = 0;
        for (wheel, contact) in contacts.iter().enumerate() {
            let [roll, side] = weights(self.job.readings.weights, contacts.len(), wheel);
            let speed = speeds[wheel];
            let measured = speed.at_most(speed);
            let speed = measured.select(speed, zero);
            let (root, radius) = (all(simd, roll.sqrt()), plan.radius(wheel));
            let touching = standing.touching[wheel];
            let says = [
                (&contact.normal, contact.swivel[0], all(simd, 1.0)),
                (
                    &contact.rolling,
                    contact.swivel[2] - speed,
                    all(simd, radius),
                ),
                (&contact.side, contact.swivel[1], all(simd, 1.0)),
            ];
            let aside = all(simd, side.sqrt());
            let roots = [
                measured.select(all(simd, roll.max(side).sqrt()), aside),
                measured.select(root, zero),
                aside,
            ];
            for (i, (direction, beside, unit)) in says.into_iter().enumerate() {
                let mut left = beside;
                for (part, rate) in direction.iter().zip(&follow.offset) {
                    left = part.mul_add(*rate, left);
                }
                let left = left * unit;
                let mut columns = follow.plan(direction);
                for column in &mut columns {
                    *column = *column * unit;
                }
                told[wheel][i] = (columns, left);
                let mut root = roots[i] * touching;
                let place = if i > 0 {
                    filled += 1;
                    filled - 1
                } else if everywhere {
                    continue;
                } else {
                    root = exactly.select(zero, root);
                    2 * contacts.len() + wheel
                };
                rows[place] = [
                    columns[0] * root,
                    columns[1] * root,
                    columns[2] * root,
                    -(left * root),
                ];
            }
        }
        let mut last = filled + lifts;
        if let Known::Somewhere(here, _) = known[PLAN[2]] {
            // Nothing is missing of what is known.
            rows[last][2] = here;
            last += 1;
        }
        let rows = &mut rows[..last];
        triangular(simd, rows, 3, 4);
        doubt = doubt | (dependent(simd, rows) & !standing.nowhere);
        let solution: [[Lanes<S>; 1]; 3] = back(simd, rows, 3);
        let motion = [
            standing.nowhere.select(nan, solution[0][0]),
            standing.nowhere.select(nan, solution[1][0]),
            standing.nowhere.select(nan, solution[2][0]),
        ];
        let rates = follow.rates(motion);
        let mut residuals = [nan; 3 * MAX_WHEELS];
        for (wheel, told) in told.iter().enumerate().take(contacts.len()) {
            let touches = zero.below(standing.touching[wheel]);
            for (i, (columns, left)) in told.iter().enumerate() {
                let mut residual = *left;
                for (column, rate) in columns.iter().zip(motion) {
                    residual = column.mul_add(rate, residual);
                }
                if i == 1 {
                    let speed = speeds[wheel];
                    residual = speed.at_most(speed).select(residual, nan);
                }
                residuals[3 * wheel + i] = touches.select(residual, nan);
            }
        }
        self.write(span, &standing, &rates, &residuals);
        doubt
    }

    /// What the wheels say of the rates, at the steering angles that are given.
    #[inline(always)]
    fn contacts<S: Vector>(
        &self,
        simd: S,
        given: Span,
        standing: &Standing<S>,
        placing: &mut Placing<'_, S>,
        doubt: &mut Mask<S>,
    ) -> [Contact<S>; MAX_WHEELS] {
        let (plan, zero) = (self.plan, all(simd, 0.0));
        let steered = self.job.chain.steering().len().min(MAX_WHEELS);
        let mut angles = standing.steering;
        let mut turned = zero.below(zero);
        if let Some(steering) = self.job.readings.steering {
            angles = given.read::<S, MAX_WHEELS>(simd, steering, steered);
            for (angle, stands) in angles.iter().zip(standing.steering).take(steered) {
                turned = turned | !(*angle - stands).abs().at_most(zero);
                *doubt = *doubt | all(simd, LARGEST_TURN).below(angle.abs());
            }
        }
        let any_turned = turned.any();
        let rates = self.job.readings.steering_rates;
        let rates = rates.map(|rates| given.read::<S, MAX_WHEELS>(simd, rates, steered));
        placing.place(simd, &standing.joints);
        let placing = &*placing;
        let blank = Contact {
            normal: [zero; COLUMNS],
            rolling: [zero; COLUMNS],
            side: [zero; COLUMNS],
            swivel: [zero; 3],
        };
        let mut contacts = [blank; MAX_WHEELS];
        for (wheel, contact) in contacts.iter_mut().enumerate().take(plan.wheels()) {
            let joint = plan.steering(wheel);
            let tread = at_angle(simd, plan, placing, wheel, &angles);
            let normal = standing.normals[wheel];
            let mut at = standing.at[wheel];
            if any_turned {
                let stands = at_angle(simd, plan, placing, wheel, &standing.steering);
                let (forward, up) = (dot(stands.forward, normal), dot(stands.up, normal));
                // The far side of the rim.
                *doubt = *doubt | (turned & (up * at.1).below(forward * at.0));
                let (forward, up) = (dot(tread.forward, normal), dot(tread.up, normal));
                let plane = on_plane(simd, forward, up);
                at = (turned.select(plane.0, at.0), turned.select(plane.1, at.1));
            }
            let radius = plan.radius(wheel);
            let touch = Touch::new(simd, &tread, radius, at);
            let left = cross(normal, touch.tangent);
            contact.normal = row(simd, placing, wheel, touch.point, normal);
            contact.side = row(simd, placing, wheel, touch.point, left);
            contact.rolling = rolling(simd, placing, wheel, &tread, touch.tangent, radius);
            if let (Some(joint), Some(rates)) = (joint, &rates) {
                let directions = [normal, left];
                contact.swivel = swivel(simd, placing, wheel, &tread, radius, &touch, directions);
                for part in &mut contact.swivel {
                    *part = *part * rates[joint % MAX_WHEELS];
                }
            }
        }
        contacts
    }

    /// Rates that are no unknowns.
    #[inline(always)]
    fn known<S: Vector>(
        &self,
        simd: S,
        given: Span,
        standing: &Standing<S>,
    ) -> [Known<S>; COLUMNS] {
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

/// A wheel where its joint is turned like this.
#[inline(always)]
fn at_angle<S: Vector>(
    simd: S,
    plan: &Plan,
    placing: &Placing<'_, S>,
    wheel: usize,
    angles: &[Lanes<S>; MAX_WHEELS],
) -> WheelAt<S> {
    match plan.steering(wheel) {
        Some(joint) => {
            let turned = direction(simd, angles[joint % MAX_WHEELS]);
            placing.steered(simd, wheel, turned)
        }
        None => placing.wheels[wheel],
    }
}

/// The rate of an encoder that does not slip.
#[inline(always)]
fn rolling<S: Vector>(
    simd: S,
    placing: &Placing<'_, S>,
    wheel: usize,
    tread: &WheelAt<S>,
    tangent: Vectors<S>,
    radius: f64,
) -> Row<S> {
    let mut rolling = row(simd, placing, wheel, tread.centre, tangent);
    let inverse = all(simd, 1.0 / radius);
    for part in &mut rolling {
        *part = *part * inverse;
    }
    for k in 0..3 {
        rolling[3 + k] = rolling[3 + k] - tread.axle[k];
    }
    for axis in placing.axes(wheel) {
        let place = 6 + axis.joint % MAX_FREE;
        rolling[place] = rolling[place] - dot(axis.axis, tread.axle);
    }
    rolling
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

/// Where the columns of a triangle may depend on each other.
#[inline(always)]
fn dependent<S: Vector>(simd: S, rows: &[[Lanes<S>; 4]]) -> Mask<S> {
    let zero = all(simd, 0.0);
    let Some([a, b, c]) = rows.first_chunk::<3>() else {
        return zero.at_most(zero);
    };
    let largest = [a[0], a[1], a[2], b[1], b[2], c[2]];
    let mut size = zero;
    for value in largest {
        size = size.max(value.abs());
    }
    let product = (a[0] * b[1] * c[2]).abs();
    let bound = all(simd, INDEPENDENT) * size * size * size;
    !bound.below(product)
}
