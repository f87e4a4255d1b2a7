//! Contacts in lanes, and the suspension that follows the ground: see [`Contacts`](super::super::Contacts).

use super::least_squares::{Equation, Equations, Square, UNKNOWNS};
use super::settled_poses::{Eights, Standing};
use crate::contact::COLUMNS;
use crate::motion::{FOLLOWING, PLAN};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::lanes::{ChainConstants, Placing, Turned, Vectors, all, along, cross, dot, less};
use six_wheel_terrain::suspension::{MAX_FREE, MAX_WHEELS};

/// Derivatives of a velocity by the rates, in lanes.
pub(crate) type Row<S> = [Lanes<S>; COLUMNS];

/// Room for rows that stand, and what the ground says of them.
pub(crate) struct MotionScratch<S: Vector> {
    pub eights: Eights,
    pub equations: Equations<S>,
    pub contacts: Contacts<S>,
    pub standing: Standing<S>,
}

impl<S: Vector> MotionScratch<S> {
    /// Nothing is in it yet.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Self {
            eights: Eights::new(),
            equations: Equations::new(simd),
            standing: Standing::new(simd),
            contacts: [Contact { rows: [[all(simd, 0.0); COLUMNS]; 3], swivel: [all(simd, 0.0); 3] }; MAX_WHEELS],
        }
    }
}

/// Tangent and contact point of a wheel.
#[derive(Clone, Copy)]
pub(crate) struct Touch<S: Vector> {
    pub tangent: Vectors<S>,
    pub point: Vectors<S>,
}

impl<S: Vector> Touch<S> {
    /// At a contact angle, of a wheel with this centre that is turned about its steering axis.
    #[inline(always)]
    pub fn new(
        placing: &Placing<'_, S>,
        wheel: usize,
        centre: Vectors<S>,
        radius: Lanes<S>,
        steered: Option<Turned<S>>,
        (sin, cos): Turned<S>,
    ) -> Self {
        let zero = all(sin.simd(), 0.0);
        let limb = placing.limb(wheel);
        // h cos + u sin, and a quarter turn back.
        let (mut tangent, mut spoke) = ([cos, zero, sin], [sin, zero, -cos]);
        if let Some((s, c)) = steered {
            (tangent, spoke) = ([cos * c, cos * s, sin], [sin * c, sin * s, -cos]);
        }
        Self { tangent: limb.out(tangent), point: along(centre, radius, limb.out(spoke)) }
    }
}

/// Velocity of a wheel's touching point along the normal, along the rim and to the left [m/s], as a function of the
/// rates.
#[derive(Clone, Copy)]
pub(crate) struct Contact<S: Vector> {
    /// By the rates. Along the rim that is what its centre does, less its turning with its carrier.
    pub rows: [Row<S>; 3],
    /// Velocity per rate of its own steering [m/rad].
    pub swivel: [Lanes<S>; 3],
}

/// Contacts of all wheels.
pub(crate) type Contacts<S> = [Contact<S>; MAX_WHEELS];

/// Derivatives by the rates of the velocities of a point of a wheel's carrier along some directions.
#[inline(always)]
pub(crate) fn answers<S: Vector, const N: usize>(
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
    for &mover in placing.movers(wheel) {
        let (joint, moved) = placing.swing(mover, point);
        let again = told >> joint & 1 == 1;
        told |= 1 << joint;
        for (row, direction) in rows.iter_mut().zip(directions) {
            let along = placing.swung(mover, moved, direction);
            row[6 + joint] = if again { row[6 + joint] + along } else { along };
        }
    }
}

/// Velocity of a point along some directions per rate of the wheel's own steering [m/rad].
#[inline(always)]
pub(crate) fn swivel<S: Vector>(
    simd: S,
    placing: &Placing<'_, S>,
    wheel: usize,
    point: Vectors<S>,
    directions: [Vectors<S>; 3],
) -> [Lanes<S>; 3] {
    let limb = placing.limb(wheel);
    let [ahead, left, _] = limb.own(less(point, placing.pivot(simd, wheel)));
    let moved = limb.out([-left, ahead, all(simd, 0.0)]);
    let [normal, ahead, left] = directions;
    [dot(moved, normal), dot(moved, ahead), dot(moved, left)]
}

/// A rate in lanes, as far as it is known.
#[derive(Clone, Copy)]
pub(crate) enum Known<S: Vector> {
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
pub(crate) struct SuspensionRates<S: Vector> {
    /// Columns that are not zero but for those of the plan itself.
    pub unknown: [usize; UNKNOWNS],
    pub count: usize,
    /// By the rates in plan, for each unknown column.
    pub spread: [[Lanes<S>; 3]; UNKNOWNS],
    /// 1 where a rate in plan is not known.
    pub free: [Lanes<S>; 3],
    pub offset: Row<S>,
    /// Lanes in which the result is the same as that for one row.
    pub sure: Mask<S>,
}

impl<S: Vector> SuspensionRates<S> {
    /// Solves for the rates that follow the ground, given the known ones and the contacts. Of right-hand sides there
    /// are the three motions in plan, or what is known (1), or both (4).
    #[inline(always)]
    pub fn new<const RIGHT: usize>(
        simd: S,
        plan: &ChainConstants,
        square: Option<&Square>,
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
        // All touch, and nothing is known.
        let mut usual = zero.at_most(zero);
        for touching in &standing.touching[..plan.wheels()] {
            usual = usual & one.at_most(*touching);
        }
        for column in &unknown[..count] {
            if let Known::Somewhere(here, _) = known[*column] {
                usual = usual & here.at_most(zero);
            }
        }
        let mut found = [[zero; RIGHT]; UNKNOWNS];
        let square = square.filter(|_| count == UNKNOWNS && usual.any());
        if let Some(square) = square {
            equations.clear();
            for wheel in square.wheels {
                let row = equations.add(0);
                follow.put_down::<RIGHT>(&contacts[wheel % MAX_WHEELS], known, row);
            }
            (found, follow.sure) = equations.eliminate(simd, square);
        }
        if square.is_none() || (!(usual | standing.nowhere)).any() {
            equations.clear();
            for (wheel, contact) in contacts.iter().enumerate().take(plan.wheels()) {
                let mut bits = 0;
                for (k, column) in unknown.iter().enumerate().take(count) {
                    bits |= u32::from(moves(plan.moved(wheel), *column)) << k;
                }
                follow.put_down::<RIGHT>(contact, known, equations.add(bits));
            }
            equations.limit(standing, plan.wheels(), count + RIGHT);
            for (k, column) in unknown.iter().enumerate().take(count) {
                if let Known::Somewhere(here, _) = known[*column] {
                    equations.know(simd, k, here);
                }
            }
            let (solution, sure) = equations.solve::<RIGHT>(simd, count);
            if square.is_none() {
                usual = zero.below(zero);
            }
            follow.sure = usual & follow.sure | !usual & sure;
            for (found, told) in found.iter_mut().zip(solution) {
                for k in 0..RIGHT {
                    found[k] = usual.select(found[k], told[k]);
                }
            }
        }
        for (k, told) in found.iter().enumerate().take(count) {
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

    /// The equation of a wheel.
    #[inline(always)]
    fn put_down<const RIGHT: usize>(&self, contact: &Contact<S>, known: &[Known<S>; COLUMNS], row: &mut Equation<S>) {
        let (normal, moved) = (&contact.rows[0], contact.swivel[0]);
        let count = self.count.min(UNKNOWNS);
        for (cell, column) in row.iter_mut().zip(&self.unknown[..count]) {
            *cell = normal[column % COLUMNS];
        }
        if RIGHT > 1 {
            for (k, column) in PLAN.into_iter().enumerate() {
                row[count + k] = -normal[column];
                if RIGHT == 4 {
                    row[count + k] = row[count + k] * self.free[k];
                }
            }
        }
        if RIGHT != 3 {
            let mut rest = -moved;
            for ((part, value), known) in normal.iter().zip(&self.offset).zip(known) {
                if !matches!(known, Known::Nowhere) {
                    rest = (-*part).mul_add(*value, rest);
                }
            }
            row[count + RIGHT - 1] = rest;
        }
    }

    /// Lanes with at least as many unknown rates as wheels: those rates follow the ground exactly.
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

    /// Derivatives of a wheel's velocity along `direction` by the motion in plan.
    #[inline(always)]
    fn plan<const RIGHT: usize>(&self, moved: u32, direction: &Row<S>) -> [Lanes<S>; 3] {
        let [x, y, turn] = PLAN;
        let mut told = [direction[x], direction[y], direction[turn]];
        if RIGHT != 3 {
            for (told, free) in told.iter_mut().zip(self.free) {
                *told = *told * free;
            }
        }
        for (column, spread) in self.unknown.iter().zip(&self.spread).take(self.count) {
            if moves(moved, *column) {
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
        plan: &ChainConstants,
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
        (self.plan::<RIGHT>(plan.moved(wheel), direction), left)
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

/// True if a rate moves a wheel that these free angles move: those of the body do.
fn moves(moved: u32, column: usize) -> bool {
    column < 6 || moved >> (column - 6) & 1 == 1
}
