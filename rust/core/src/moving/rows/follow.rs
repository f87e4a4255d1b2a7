//! Contacts in lanes, and the suspension that follows the ground: see [`Contacts`](super::super::Contacts).

use super::footings::{Eights, Standing, rim};
use super::solve::{Equations, RIGHTS, UNKNOWNS};
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::vector::Vector;
use crate::moving::contact::COLUMNS;
use crate::moving::motion::{FOLLOWING, PLAN};
use crate::suspension::lanes::{Placing, Plan, Turned, Vectors, WheelAt, all, cross, dot, less};
use crate::suspension::{MAX_FREE, MAX_WHEELS};

/// Derivatives of a velocity by the rates, in lanes.
pub(super) type Row<S> = [Lanes<S>; COLUMNS];

/// Room for rows that stand, and what the ground says of them.
pub(super) struct Room<S: Vector> {
    pub eights: Eights,
    pub equations: Equations<S>,
    pub contacts: Contacts<S>,
}

impl<S: Vector> Room<S> {
    /// Nothing is in it yet.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Self {
            eights: Eights::new(),
            equations: Equations::new(simd),
            contacts: [Contact {
                rows: [[all(simd, 0.0); COLUMNS]; 3],
                swivel: [all(simd, 0.0); 3],
            }; MAX_WHEELS],
        }
    }
}

/// Where a wheel is touched.
#[derive(Clone, Copy)]
pub(super) struct Touch<S: Vector> {
    pub tangent: Vectors<S>,
    pub point: Vectors<S>,
}

impl<S: Vector> Touch<S> {
    /// At a contact angle.
    #[inline(always)]
    pub fn new(simd: S, tread: &WheelAt<S>, radius: f64, at: Turned<S>) -> Self {
        let [tangent, outwards] = rim(at, tread.forward, tread.up);
        let radius = all(simd, radius);
        let mut point = tread.centre;
        for k in 0..3 {
            point[k] = outwards[k].mul_add(radius, point[k]);
        }
        Self { tangent, point }
    }
}

/// What a wheel says of how its touching point moves along the normal, along the rim and to the left [m/s].
#[derive(Clone, Copy)]
pub(super) struct Contact<S: Vector> {
    /// By the rates. Along the rim that is what its centre does, less its turning with its carrier.
    pub rows: [Row<S>; 3],
    /// What its own steering adds.
    pub swivel: [Lanes<S>; 3],
}

/// Contacts of all wheels.
pub(super) type Contacts<S> = [Contact<S>; MAX_WHEELS];

/// How the velocities of a point of a wheel's carrier along some directions answer to the rates.
#[inline(always)]
pub(super) fn answers<S: Vector, const N: usize>(
    placing: &Placing<'_, S>,
    wheel: usize,
    point: Vectors<S>,
    directions: [Vectors<S>; N],
    rows: &mut [Row<S>; N],
) {
    for (row, direction) in rows.iter_mut().zip(directions) {
        row[..3].copy_from_slice(&direction);
        row[3..6].copy_from_slice(&cross(point, direction));
    }
    let mut told = 0_u32;
    for axis in placing.axes(wheel) {
        let moved = cross(axis.axis, less(point, axis.origin));
        let (joint, again) = (axis.joint % MAX_FREE, told >> axis.joint & 1 == 1);
        told |= 1 << axis.joint;
        for (row, direction) in rows.iter_mut().zip(directions) {
            let along = dot(moved, direction);
            row[6 + joint] = if again { row[6 + joint] + along } else { along };
        }
    }
}

/// What the rate of a wheel's own steering adds along some directions.
#[inline(always)]
pub(super) fn swivel<S: Vector>(
    placing: &Placing<'_, S>,
    wheel: usize,
    up: Vectors<S>,
    point: Vectors<S>,
    directions: [Vectors<S>; 3],
) -> [Lanes<S>; 3] {
    let moved = cross(up, less(point, placing.pivot(wheel)));
    let [normal, ahead, left] = directions;
    [dot(moved, normal), dot(moved, ahead), dot(moved, left)]
}

/// What some lanes know of a rate.
#[derive(Clone, Copy)]
pub(super) enum Known<S: Vector> {
    /// In no lane.
    Nowhere,
    /// In every lane.
    Everywhere(Lanes<S>),
    /// 1 where it is known, and 0 or its value.
    Somewhere(Lanes<S>, Lanes<S>),
}

impl<S: Vector> Known<S> {
    fn value(&self, zero: Lanes<S>) -> Lanes<S> {
        match *self {
            Self::Nowhere => zero,
            Self::Everywhere(value) | Self::Somewhere(_, value) => value,
        }
    }
}

/// Rates as a function of those in plan: `offset + spread . plan`.
pub(super) struct Follow<S: Vector> {
    /// Columns that are not zero but for those of the plan itself.
    pub unknown: [usize; UNKNOWNS],
    pub count: usize,
    /// By the rates in plan, for each unknown column.
    pub spread: [[Lanes<S>; 3]; UNKNOWNS],
    /// 1 where a rate in plan is not known.
    pub free: [Lanes<S>; 3],
    pub offset: Row<S>,
    /// Where it is sure what the plain way knows.
    pub sure: Mask<S>,
}

impl<S: Vector> Follow<S> {
    /// From what is known of every rate, and what the ground says. Of right-hand sides there are the three motions in plan, or
    /// what is known (1), or both (4).
    #[inline(always)]
    pub fn new<const RIGHT: usize>(
        simd: S,
        plan: &Plan,
        standing: &Standing<S>,
        known: &[Known<S>; COLUMNS],
        contacts: &Contacts<S>,
        equations: &mut Equations<S>,
    ) -> Self {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let mut follow = Self {
            unknown: [0; UNKNOWNS],
            count: 0,
            spread: [[zero; 3]; UNKNOWNS],
            free: [one; 3],
            offset: [zero; COLUMNS],
            sure: zero.at_most(zero),
        };
        if RIGHT != 3 {
            for (value, known) in follow.offset.iter_mut().zip(known) {
                *value = known.value(zero);
            }
            for (free, column) in follow.free.iter_mut().zip(PLAN) {
                *free = match known[column] {
                    Known::Nowhere => one,
                    Known::Everywhere(_) => zero,
                    Known::Somewhere(here, _) => one - here,
                };
            }
        }
        // What few wheels have a part in comes first: the others lose little of what they do not have.
        let joints = plan.order().iter().map(|joint| 6 + joint % MAX_FREE);
        for column in joints.chain(FOLLOWING.into_iter().take(3)) {
            if !matches!(known[column], Known::Everywhere(_)) {
                follow.unknown[follow.count % UNKNOWNS] = column;
                follow.count += 1;
            }
        }
        let (count, unknown) = (follow.count.min(UNKNOWNS), follow.unknown);
        equations.clear();
        for (wheel, contact) in contacts.iter().enumerate().take(plan.wheels()) {
            let (normal, moved) = (&contact.rows[0], contact.swivel[0]);
            let mut bits = 0;
            for (k, column) in unknown.iter().enumerate().take(count) {
                bits |= u32::from(moves(plan, wheel, *column)) << k;
            }
            let row = equations.add(bits);
            for (cell, column) in row.iter_mut().zip(&unknown[..count]) {
                *cell = match known[*column] {
                    Known::Somewhere(here, _) => normal[*column] * (one - here),
                    _ => normal[*column],
                };
            }
            if RIGHT > 1 {
                for (k, column) in PLAN.into_iter().enumerate() {
                    row[count + k] = -normal[column];
                    if RIGHT == 4 {
                        row[count + k] = row[count + k] * follow.free[k];
                    }
                }
            }
            if RIGHT != 3 {
                let mut rest = -moved;
                for (part, value) in normal.iter().zip(&follow.offset) {
                    rest = (-*part).mul_add(*value, rest);
                }
                row[count + RIGHT - 1] = rest;
            }
            if !standing.all_touch {
                for cell in &mut row[..count + RIGHT] {
                    *cell = *cell * standing.touching[wheel];
                }
            }
        }
        for (k, column) in unknown.iter().enumerate().take(count) {
            if let Known::Somewhere(here, _) = known[*column] {
                // Nothing is missing of what is known.
                let row = equations.add(1 << k);
                *row = [zero; UNKNOWNS + RIGHTS];
                row[k] = here;
            }
        }
        let (solution, sure) = equations.solve::<RIGHT>(simd, count);
        follow.sure = sure;
        for (k, told) in solution.iter().enumerate().take(count) {
            if RIGHT > 1 {
                follow.spread[k] = [told[0], told[1 % RIGHT], told[2 % RIGHT]];
            }
            if RIGHT != 3 {
                let column = unknown[k];
                follow.offset[column] = follow.offset[column] + told[RIGHT - 1];
            }
        }
        follow
    }

    /// Where there are as many rates to follow the ground as wheels on it: they follow it exactly.
    #[inline(always)]
    pub fn exactly(&self, simd: S, known: &[Known<S>; COLUMNS], wheels: usize) -> Mask<S> {
        let (one, mut missing) = (all(simd, 1.0), all(simd, 0.0));
        for column in &self.unknown[..self.count] {
            missing = missing
                + match known[*column] {
                    Known::Somewhere(here, _) => one - here,
                    _ => one,
                };
        }
        all(simd, wheels as f64).at_most(missing)
    }

    /// How what a direction says of a wheel answers to the motion in plan.
    #[inline(always)]
    fn plan<const RIGHT: usize>(
        &self,
        plan: &Plan,
        wheel: usize,
        direction: &Row<S>,
    ) -> [Lanes<S>; 3] {
        let mut told = PLAN.map(|column| direction[column]);
        if RIGHT != 3 {
            for (told, free) in told.iter_mut().zip(self.free) {
                *told = *told * free;
            }
        }
        for (column, spread) in self.unknown.iter().zip(&self.spread).take(self.count) {
            if moves(plan, wheel, *column) {
                for k in 0..3 {
                    told[k] = direction[*column].mul_add(spread[k], told[k]);
                }
            }
        }
        told
    }

    /// The same, and what is left without any motion in plan.
    #[inline(always)]
    pub fn told<const RIGHT: usize>(
        &self,
        plan: &Plan,
        wheel: usize,
        direction: &Row<S>,
        beside: Lanes<S>,
    ) -> ([Lanes<S>; 3], Lanes<S>) {
        let mut left = beside;
        if RIGHT != 3 {
            for (part, rate) in direction.iter().zip(&self.offset) {
                left = part.mul_add(*rate, left);
            }
        }
        (self.plan::<RIGHT>(plan, wheel, direction), left)
    }

    /// The rates of a motion in plan.
    #[inline(always)]
    pub fn rates(&self, plan: [Lanes<S>; 3]) -> Row<S> {
        let mut rates = self.offset;
        for k in 0..3 {
            rates[PLAN[k]] = self.free[k].mul_add(plan[k], rates[PLAN[k]]);
        }
        for (column, spread) in self.unknown.iter().zip(&self.spread).take(self.count) {
            for k in 0..3 {
                rates[*column] = spread[k].mul_add(plan[k], rates[*column]);
            }
        }
        rates
    }
}

/// Whether a rate moves a wheel: those of the body do, of the free angles some.
fn moves(plan: &Plan, wheel: usize, column: usize) -> bool {
    column < 6 || plan.moved(wheel) >> (column - 6) & 1 == 1
}
