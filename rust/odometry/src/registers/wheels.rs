//! Share of the wheels in a step: the lanes of a register are the wheels of one step, or one wheel in successive steps.

use super::plan::{Group, StepScratch, Triple};
use super::terms::{LARGEST_STEP, NoiseTerms, SURELY};
use crate::arithmetic::Arithmetic;
use crate::motion::SUSPICIOUS;
use six_wheel_kinematics::kernels::wheel_lanes::Eight;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::{LARGEST_ANGLE, sin_cos, sinc_of_square};
use six_wheel_numerics::simd::vector::Vector;

/// Arithmetic with registers of successive steps.
#[derive(Clone, Copy)]
pub(crate) struct InLanes<S: Vector>(pub S);

impl<S: Vector> Arithmetic for InLanes<S> {
    type Number = Lanes<S>;

    #[inline(always)]
    fn number(self, value: f64) -> Lanes<S> {
        Lanes::splat(self.0, value)
    }

    #[inline(always)]
    fn fused(self, a: Lanes<S>, b: Lanes<S>, c: Lanes<S>) -> Lanes<S> {
        a.mul_add(b, c)
    }

    #[inline(always)]
    fn over(self, a: Lanes<S>, b: Lanes<S>) -> Lanes<S> {
        a.quotient(b)
    }

    #[inline(always)]
    fn sqrt(self, a: Lanes<S>) -> Lanes<S> {
        a.sqrt()
    }

    #[inline(always)]
    fn least(self, a: Lanes<S>, b: Lanes<S>) -> Lanes<S> {
        a.min(b)
    }
}

impl NoiseTerms<f64> {
    /// The same for every wheel.
    #[inline(always)]
    pub(crate) fn broadcast<S: Vector>(&self, simd: S) -> NoiseTerms<Lanes<S>> {
        let splat = |number| Lanes::splat(simd, number);
        NoiseTerms {
            dt: splat(self.dt),
            reading_variance: splat(self.reading_variance),
            half_deviation: splat(self.half_deviation),
            steering_variance: splat(self.steering_variance),
            slip_bound: self.slip_bound.map(splat),
            most: [splat(self.most[0]), splat(self.most[1])],
            slip_variances: self.slip_variances,
            smoothing: self.smoothing,
        }
    }
}

/// Source of the lanes: the numbers of register `k` of a group, or the number of one wheel in all lanes.
pub(crate) trait LaneSource<S: Vector>: Copy {
    fn of(self, numbers: &Eight) -> Lanes<S>;

    #[inline(always)]
    fn three(self, triple: &Triple) -> [Lanes<S>; 3] {
        let [x, y, z] = triple;
        [self.of(x), self.of(y), self.of(z)]
    }
}

#[derive(Clone, Copy)]
pub(crate) struct Register<S: Vector>(pub S, pub usize);

#[derive(Clone, Copy)]
pub(crate) struct Broadcast<S: Vector>(pub S, pub usize);

impl<S: Vector> LaneSource<S> for Register<S> {
    #[inline(always)]
    fn of(self, numbers: &Eight) -> Lanes<S> {
        Lanes::load(self.0, S::as_simd_f64s(numbers).0, self.1)
    }
}

impl<S: Vector> LaneSource<S> for Broadcast<S> {
    #[inline(always)]
    fn of(self, numbers: &Eight) -> Lanes<S> {
        Lanes::splat(self.0, numbers[self.1])
    }
}

/// Into register `k` of as many columns.
#[inline(always)]
pub(crate) fn store<S: Vector, const N: usize>(lanes: [Lanes<S>; N], columns: &mut [Eight; N], k: usize) {
    for (lanes, column) in lanes.into_iter().zip(columns) {
        lanes.store(S::as_mut_simd_f64s(column).0, k);
    }
}

/// `a . b`.
#[inline(always)]
pub(crate) fn dot<S: Vector>([a, b, c]: [Lanes<S>; 3], [x, y, z]: [Lanes<S>; 3]) -> Lanes<S> {
    c.mul_add(z, b.mul_add(y, a * x))
}

/// Sum of the outer products of vectors, one in every lane.
#[derive(Clone, Copy)]
pub(crate) struct Squares<S: Vector>(pub [Lanes<S>; 6]);

impl<S: Vector> Squares<S> {
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Self([Lanes::splat(simd, 0.0); 6])
    }

    #[inline(always)]
    fn add(&mut self, [x, y, z]: [Lanes<S>; 3], share: Lanes<S>) {
        self.add_product([x * share, y * share, z * share], [x, y, z]);
    }

    #[inline(always)]
    pub fn add_square(&mut self, vector: [Lanes<S>; 3]) {
        self.add_product(vector, vector);
    }

    #[inline(always)]
    fn add_product(&mut self, [a, b, c]: [Lanes<S>; 3], [x, y, z]: [Lanes<S>; 3]) {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        self.0 = [
            a.mul_add(x, xx),
            a.mul_add(y, xy),
            a.mul_add(z, xz),
            b.mul_add(y, yy),
            b.mul_add(z, yz),
            c.mul_add(z, zz),
        ];
    }
}

/// Adds the share of these wheels to the least-squares displacement [m, m, rad], by their counts and the middle angle
/// and turn of their joints [rad]. Returns the lanes whose readings are of a usual size.
#[inline(always)]
pub(crate) fn accumulate_displacement<S: Vector, P: LaneSource<S>>(
    simd: S,
    (group, pick): (&Group, P),
    counts: Lanes<S>,
    joint: Option<[Lanes<S>; 2]>,
    [most_way, most_turn]: [Lanes<S>; 2],
    said: &mut [Lanes<S>; 3],
    (room, k): (&mut StepScratch, usize),
) -> Mask<S> {
    let splat = |number| Lanes::splat(simd, number);
    let turned = counts * pick.of(&group.per_count[0]);
    let mut rolled = turned * pick.of(&group.radius);
    let mut usual = rolled.abs().at_most(most_way) & turned.abs().at_most(splat(LARGEST_STEP[0]));
    let [along, across] = &group.shares;
    let mut shares = [pick.three(along), pick.three(across)];
    let mut way = [rolled, splat(0.0)];
    if let Some([middle, turn]) = joint {
        usual = usual & turn.abs().at_most(most_turn) & middle.abs().at_most(splat(LARGEST_ANGLE / 4.0));
        let half = turn * splat(0.5);
        let (sin, cos) = sin_cos(simd, middle + pick.of(&group.heading));
        rolled = rolled * sinc_of_square(simd, half * half);
        way = [rolled * cos, rolled * sin];
        let [along, across] = shares;
        for part in 0..3 {
            shares[0][part] = cos.mul_add(along[part], sin * across[part]);
            shares[1][part] = cos.mul_add(across[part], -(sin * along[part]));
        }
    }
    for (said, along) in said.iter_mut().zip(shares[0]) {
        *said = rolled.mul_add(along, *said);
    }
    for (share, target) in shares.into_iter().zip(&mut room.shares) {
        store(share, target, k);
    }
    store([rolled], std::array::from_mut(&mut room.rolled), k);
    store(way, &mut room.way, k);
    usual
}

/// Adds the share of these wheels to the covariance of the displacement, and keeps their residuals [m] and variances
/// [m²]. Returns the lanes that slid further than the noise explains, but for rounding.
#[inline(always)]
pub(crate) fn accumulate_noise<S: Vector, P: LaneSource<S>>(
    simd: S,
    (group, pick): (&Group, P),
    displacement: [Lanes<S>; 3],
    terms: &NoiseTerms<Lanes<S>>,
    squares: &mut Squares<S>,
    (room, k): (&mut StepScratch, usize),
) -> Mask<S> {
    let splat = |number| Lanes::splat(simd, number);
    let here = Register(simd, k);
    let [rolling, side_slip] = &group.rows;
    let along = dot(pick.three(rolling), displacement) - here.of(&room.way[0]);
    let across = dot(pick.three(side_slip), displacement) - here.of(&room.way[1]);
    let square = along.mul_add(along, across * across);
    let slid = square.sqrt();
    let [mut own, mut sides] = [terms.reading_variance, splat(0.0)];
    if terms.slip_variances != [0.0; 2] {
        let [px, py] = [pick.of(&group.pivot[0]), pick.of(&group.pivot[1])];
        let x = displacement[0] - displacement[2] * py;
        let y = displacement[1] + displacement[2] * px;
        let distance = x.mul_add(x, y * y).sqrt();
        sides = distance * splat(terms.slip_variances[1]);
        own = own + distance * splat(terms.slip_variances[0]);
        own = pick.of(&group.passed_on).mul_add(sides, own);
        squares.add(here.three(&room.shares[1]), sides);
    }
    squares.add(here.three(&room.shares[0]), own);
    let rolled = here.of(&room.rolled);
    let turned = terms.steering_variance * pick.of(&group.steers) * (rolled * rolled);
    let [has_rolling, has_side_slip] = [pick.of(&group.has[0]), pick.of(&group.has[1])];
    let variance = has_rolling.mul_add(own, has_side_slip * (sides + turned));
    store([slid], std::array::from_mut(&mut room.slid), k);
    store([variance], std::array::from_mut(&mut room.variance), k);
    match terms.slip_bound {
        Some(bound) => bound.below(slid),
        None => (variance * splat(SURELY * SUSPICIOUS * SUSPICIOUS)).below(square),
    }
}

/// Error of the displacement by half the deviation of a steering angle [m, m, rad].
#[inline(always)]
pub(crate) fn steering_error<S: Vector, P: LaneSource<S>>(
    simd: S,
    (group, pick): (&Group, P),
    terms: &NoiseTerms<Lanes<S>>,
    (room, k): (&StepScratch, usize),
) -> [Lanes<S>; 3] {
    let here = Register(simd, k);
    let error = here.of(&room.rolled) * pick.of(&group.steers) * terms.half_deviation;
    let [x, y, z] = here.three(&room.shares[1]);
    [x * error, y * error, z * error]
}
