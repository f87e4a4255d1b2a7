//! Rates of the suspension that follow the ground, for any planar motion: `rates = offset + spread . planar rates`.

use super::constants::{FOLLOWING, MotionConstants, PLAN, UNKNOWNS};
use super::contact_rows::COLUMNS;
use super::contact_rows::{Contact, Contacts, Row};
use super::least_squares::{DenseLeastSquares, Equation, Solution};
use crate::lanes::pose_lanes::Touching;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::MAX_WHEELS;
use six_wheel_terrain::suspension::lanes::all;

/// A rate in lanes: unknown, known, or known in some lanes.
#[derive(Clone, Copy)]
pub(crate) enum KnownRate<S: Vector> {
    /// Unknown in every lane.
    Unknown,
    /// Its value, known in every lane.
    Known(Lanes<S>),
    /// 1 in lanes in which it is known, else 0; and its value there, else 0.
    KnownWhere(Lanes<S>, Lanes<S>),
}

/// The known rates.
pub(crate) type KnownRates<S> = [KnownRate<S>; COLUMNS];

#[inline_always]
impl<S: Vector> KnownRate<S> {
    fn value(&self, zero: Lanes<S>) -> Lanes<S> {
        match *self {
            Self::Unknown => zero,
            Self::Known(value) | Self::KnownWhere(_, value) => value,
        }
    }

    /// 1 in lanes in which it is not known.
    fn unknown(&self, simd: S) -> Lanes<S> {
        match *self {
            Self::Unknown => all(simd, 1.0),
            Self::Known(_) => all(simd, 0.0),
            Self::KnownWhere(here, _) => all(simd, 1.0) - here,
        }
    }
}

/// Rates as a function of the planar ones: `offset + spread . plan`.
pub(crate) struct SuspensionRates<S: Vector> {
    /// Columns of the rates that are solved for: those that are not planar and not known in every lane.
    pub unknown: [usize; UNKNOWNS],
    pub count: usize,
    /// Derivatives by the planar rates, for each unknown column.
    pub spread: [[Lanes<S>; 3]; UNKNOWNS],
    /// 1 where a planar rate is not known.
    pub free: [Lanes<S>; 3],
    pub offset: Row<S>,
    /// Lanes in which the ground determines the rates.
    pub determined: Mask<S>,
}

#[inline_always]
impl<S: Vector> SuspensionRates<S> {
    /// Solves for the rates that follow the ground, given the known ones and the contacts: those that keep the wheels on it,
    /// in least squares where there are fewer of them than wheels. Right-hand sides are the three planar motions, or the
    /// known rates (1), or both (4).
    pub fn new<const RIGHT: usize>(
        simd: S,
        constants: &MotionConstants,
        touching: &Touching<S>,
        known: &KnownRates<S>,
        contacts: &Contacts<S>,
        equations: &mut DenseLeastSquares<S>,
    ) -> Self {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let mut rates = Self {
            unknown: [0; UNKNOWNS],
            count: 0,
            spread: [[zero; 3]; UNKNOWNS],
            free: [one; 3],
            offset: [zero; COLUMNS],
            determined: Mask::splat(simd, true),
        };
        if RIGHT != 3 {
            for (value, known) in rates.offset.iter_mut().zip(known) {
                *value = known.value(zero);
            }
            for (free, column) in rates.free.iter_mut().zip(PLAN) {
                *free = known[column].unknown(simd);
            }
        }
        // Unknowns that few wheels share are eliminated first: this adds few non-zero entries to the rows of the others.
        let joints = constants.order().iter().map(|joint| 6 + joint);
        for column in joints.chain(FOLLOWING.into_iter().take(3)) {
            if !matches!(known[column % COLUMNS], KnownRate::Known(_)) {
                rates.unknown[rates.count % UNKNOWNS] = column;
                rates.count += 1;
            }
        }
        let (solution, determined) = rates.solve::<RIGHT>(simd, constants, touching, known, contacts, equations);
        rates.determined = determined;
        for (k, row) in solution.iter().enumerate().take(rates.count) {
            if RIGHT > 1 {
                rates.spread[k] = [row[0], row[1 % RIGHT], row[2 % RIGHT]];
            }
            if RIGHT != 3 {
                let column = rates.unknown[k];
                rates.offset[column] = rates.offset[column] + row[RIGHT - 1];
            }
        }
        rates
    }

    /// Solves for the unknown columns: by elimination where all wheels touch, no rate is known and the pivots are
    /// large, else by reflections. The choice is made lane by lane, so that a row's bits do not depend on its
    /// neighbours.
    fn solve<const RIGHT: usize>(
        &self,
        simd: S,
        constants: &MotionConstants,
        touching: &Touching<S>,
        known: &KnownRates<S>,
        contacts: &Contacts<S>,
        equations: &mut DenseLeastSquares<S>,
    ) -> Solution<S, RIGHT> {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let (wheels, unknown) = (constants.wheels.min(MAX_WHEELS), &self.unknown[..self.count.min(UNKNOWNS)]);
        let mut eliminated = Mask::splat(simd, false);
        let mut solution = [[zero; RIGHT]; UNKNOWNS];
        if let Some(order) = constants.pivot_order.as_ref().filter(|_| self.count == UNKNOWNS) {
            let mut square = Mask::splat(simd, true);
            for touching in &touching.wheels[..wheels] {
                square = square & one.le(*touching);
            }
            for column in unknown {
                if let KnownRate::KnownWhere(here, _) = known[*column] {
                    square = square & here.le(zero);
                }
            }
            if square.any() {
                equations.clear();
                for wheel in order.wheels {
                    self.write_equation::<RIGHT>(&contacts[wheel % MAX_WHEELS], known, equations.add(0));
                }
                let (found, good) = equations.eliminate(simd, order);
                (solution, eliminated) = (found, square & good);
            }
        }
        if !(!(eliminated | touching.none)).any() {
            return (solution, eliminated);
        }
        equations.clear();
        for (wheel, contact) in contacts.iter().enumerate().take(wheels) {
            let mut bits = 0;
            for (k, column) in unknown.iter().enumerate() {
                bits |= u32::from(constants.moves(*column, wheel)) << k;
            }
            self.write_equation::<RIGHT>(contact, known, equations.add(bits));
        }
        equations.limit(simd, constants, touching, unknown.len() + RIGHT);
        for (k, column) in unknown.iter().enumerate() {
            if let KnownRate::KnownWhere(here, _) = known[*column] {
                equations.set_known(simd, k, here);
            }
        }
        let (reflected, determined) = equations.solve::<RIGHT>(simd, unknown.len());
        for (row, other) in solution.iter_mut().zip(reflected) {
            for k in 0..RIGHT {
                row[k] = eliminated.select(row[k], other[k]);
            }
        }
        (solution, eliminated | determined)
    }

    /// The equation of a wheel: its touching point has no velocity along the normal.
    fn write_equation<const RIGHT: usize>(&self, contact: &Contact<S>, known: &KnownRates<S>, row: &mut Equation<S>) {
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
                if !matches!(known, KnownRate::Unknown) {
                    rest = (-*part).mul_add(*value, rest);
                }
            }
            row[count + RIGHT - 1] = rest;
        }
    }

    /// Lanes with at least as many unknown rates as wheels: those rates follow the ground exactly.
    pub fn exactly(&self, simd: S, known: &KnownRates<S>, wheels: usize) -> Mask<S> {
        let mut missing = all(simd, 0.0);
        for column in &self.unknown[..self.count] {
            missing = missing + known[*column].unknown(simd);
        }
        all(simd, wheels as f64).le(missing)
    }

    /// Derivatives of a wheel's velocity along `direction` by the planar motion, and that velocity without planar motion.
    pub fn planar_row<const RIGHT: usize>(
        &self,
        constants: &MotionConstants,
        wheel: usize,
        direction: &Row<S>,
        beside: Lanes<S>,
    ) -> ([Lanes<S>; 3], Lanes<S>) {
        let [x, y, turn] = PLAN;
        let mut row = [direction[x], direction[y], direction[turn]];
        let mut left = beside;
        if RIGHT != 3 {
            for (cell, free) in row.iter_mut().zip(self.free) {
                *cell = *cell * free;
            }
            for (part, rate) in direction.iter().zip(&self.offset) {
                left = part.mul_add(*rate, left);
            }
        }
        for (column, spread) in self.unknown.iter().zip(&self.spread).take(self.count) {
            if constants.moves(*column, wheel) {
                for k in 0..3 {
                    row[k] = direction[*column].mul_add(spread[k], row[k]);
                }
            }
        }
        (row, left)
    }

    /// The rates of a planar motion.
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
