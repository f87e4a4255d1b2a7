//! One step of odometry with its covariance: the lanes of a register are the wheels.
//!
//! Every wheel has two rows, each a constant times the cosine and the sine of where it points; for a wheel that is
//! not steered these are 1 and 0. Where the normal equations are the same for all readings, so are the rows times
//! their inverse: what a metre of rolling is of the displacement. Displacement, residuals and errors are sums of these.

mod plan;

use crate::batch::machine::lanes::Lanes;
use crate::batch::machine::level::Kernel;
use crate::batch::machine::polynomials::{LARGEST_ANGLE, sin_cos, sinc_of_square};
use crate::batch::machine::vector::Vector;
use crate::batch::one_row::inverse::{Eight, GROUP, padded};
use crate::error::HUGE;
use crate::odometry::{
    Fused, ROUNDING, SUSPICIOUS, Spread, State, StepJacobian, StepNoise, step_jacobian,
};
pub(crate) use plan::Plan;
use plan::{Room, Triple};

/// Half turn of a steered wheel during a step up to which its chord is the polynomial [rad].
const LARGEST_HALF_TURN: f64 = std::f64::consts::FRAC_PI_4;

/// Way and turn of a wheel over one step beyond which it is left to the plain core [m, rad].
const LARGEST_WAY: f64 = 1e50;

/// Share of a bound that is surely below it, however it is rounded.
pub(crate) const SURELY: f64 = 1.0 - 1e-9;

/// The columns of joints come in whole registers, on every level that has this kernel.
pub(crate) const COLUMNS: usize = 4;

impl Plan {
    /// One step: whether a wheel slides further than the noise explains. Nothing where the plain core has to do it; no
    /// more than the angles at the end have changed then.
    #[inline]
    pub fn step<'b>(&mut self, given: &Given<'b>, targets: &mut Targets<'b>) -> Option<bool> {
        let level = self.level;
        level.run(Step {
            plan: self,
            given,
            targets,
        })?
    }
}

/// What a step starts from, and what is known of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given<'a> {
    /// Readings of the wheels at its start and end.
    pub wheels: [&'a [f64]; 2],
    /// Readings of the steering joints at its start and end.
    pub steering: [&'a [f64]; 2],
    /// Steering angles at its start [rad].
    pub angles: &'a [f64],
    /// Duration [s].
    pub dt: f64,
    /// Variance of what a wheel rolled, but for slip [m²].
    pub reading_variance: f64,
    /// Deviation of a steering angle [rad].
    pub steering_deviation: f64,
    /// Variance along and across a wheel's heading per metre of its pivot [m].
    pub slip_variances: [f64; 2],
    /// How far a wheel slides that is reported [m]; None: by the variances.
    pub slip_bound: Option<f64>,
    /// Time constant of the filter of the twist [s].
    pub smoothing: f64,
    /// Way of a wheel and turn of a joint beyond which the plain core is asked [m, rad].
    pub most: [f64; 2],
}

/// Where the results of a step go.
#[derive(Debug)]
pub(crate) struct Targets<'a> {
    /// Steering angles at the end [rad].
    pub angles: &'a mut [f64],
    /// Speed at which each contact slid [m/s].
    pub residual: &'a mut [f64],
    /// Changed at the very end.
    pub state: &'a mut State,
    pub noise: &'a mut StepNoise,
}

struct Step<'a, 'b> {
    plan: &'a mut Plan,
    given: &'a Given<'b>,
    targets: &'a mut Targets<'b>,
}

/// Fused multiplication by the instruction of the level.
struct Instruction;

impl Fused for Instruction {
    #[inline(always)]
    fn fused(a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, c)
    }
}

/// Sum of the outer products of vectors, one in every lane.
#[derive(Clone, Copy)]
struct Squares<S: Vector>([Lanes<S>; 6]);

impl<S: Vector> Squares<S> {
    #[inline(always)]
    fn new(simd: S) -> Self {
        Self([Lanes::splat(simd, 0.0); 6])
    }

    #[inline(always)]
    fn add(&mut self, [x, y, z]: [Lanes<S>; 3], share: Lanes<S>) {
        self.add_product([x * share, y * share, z * share], [x, y, z]);
    }

    #[inline(always)]
    fn add_square(&mut self, vector: [Lanes<S>; 3]) {
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

    #[inline(always)]
    fn total(self) -> Spread {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        Spread::from([
            xx.total(),
            xy.total(),
            xz.total(),
            yy.total(),
            yz.total(),
            zz.total(),
        ])
    }
}

/// Registers of three columns.
#[inline(always)]
fn load<S: Vector>(simd: S, triple: &Triple, k: usize) -> [Lanes<S>; 3] {
    let [x, y, z] = triple;
    [
        Lanes::load(simd, S::as_simd_f64s(x).0, k),
        Lanes::load(simd, S::as_simd_f64s(y).0, k),
        Lanes::load(simd, S::as_simd_f64s(z).0, k),
    ]
}

#[inline(always)]
fn store<S: Vector>([x, y, z]: [Lanes<S>; 3], triple: &mut Triple, k: usize) {
    let [a, b, c] = triple;
    x.store(S::as_mut_simd_f64s(a).0, k);
    y.store(S::as_mut_simd_f64s(b).0, k);
    z.store(S::as_mut_simd_f64s(c).0, k);
}

/// `a . b`.
#[inline(always)]
fn dot<S: Vector>([a, b, c]: [Lanes<S>; 3], [x, y, z]: [Lanes<S>; 3]) -> Lanes<S> {
    c.mul_add(z, b.mul_add(y, a * x))
}

/// As many numbers as there is room for.
#[inline(always)]
fn put<S: Vector>(lanes: Lanes<S>, numbers: &mut [f64]) {
    if let ([register, ..], _) = S::as_mut_simd_f64s(numbers) {
        lanes.store(std::slice::from_mut(register), 0);
        return;
    }
    let mut room = [0.0; GROUP];
    lanes.store(S::as_mut_simd_f64s(&mut room).0, 0);
    for (number, lane) in numbers.iter_mut().zip(room) {
        *number = lane;
    }
}

impl Kernel for Step<'_, '_> {
    type Output = Option<bool>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Option<bool> {
        let Self {
            plan,
            given,
            targets,
        } = self;
        let heading = targets.state.walk.heading.value();
        let (sin, cos) = sin_cos(simd, Lanes::splat(simd, heading));
        let displacement = displace(simd, plan, given, targets)?;
        let twist = displacement.map(|part| part / given.dt);
        let is_usual = displacement.iter().all(|part| part.abs() < HUGE)
            && twist.iter().all(|part| part.is_finite());
        if !is_usual {
            return None;
        }
        let jacobian =
            step_jacobian::<Instruction>(displacement.into(), [sin.last(simd), cos.last(simd)]);
        let (own, slips) = doubt(simd, plan, given, displacement);
        if !own.is_below(HUGE) {
            return None;
        }
        report(simd, plan, given.dt, targets.residual);
        let Targets { state, noise, .. } = targets;
        let uncertainty = &mut state.uncertainty;
        let [ends, met] = carry(simd, plan, given, &mut uncertainty.carried, &jacobian);
        let by = &jacobian.by_displacement;
        let mut settled = uncertainty.settled.swung::<Instruction>(jacobian.lever());
        settled.add_spread(&own.displaced::<Instruction>(by));
        settled.add_spread(&met);
        uncertainty.follow(settled, ends.displaced::<Instruction>(by), &jacobian);
        (noise.own, noise.ends) = (own, ends.doubled());
        state.go(jacobian.shift, displacement[2]);
        state.hold(twist.into(), given.dt, given.smoothing);
        Some(slips)
    }
}

/// The displacement in body axes; none where a reading is not of a usual size.
#[inline(always)]
fn displace<S: Vector>(
    simd: S,
    plan: &mut Plan,
    given: &Given<'_>,
    targets: &mut Targets<'_>,
) -> Option<[f64; 3]> {
    let splat = |number| Lanes::splat(simd, number);
    let (zero, one) = (splat(0.0), splat(1.0));
    let [most_way, most_turn] = [
        splat(given.most[0].min(LARGEST_WAY)),
        splat(given.most[1].min(2.0 * LARGEST_HALF_TURN)),
    ];
    let (largest, largest_angle) = (splat(LARGEST_WAY), splat(LARGEST_ANGLE / 4.0));
    let [before, after] = given.wheels;
    let mut unusual = one.below(zero);
    let [mut x, mut y, mut z] = [zero; 3];
    let mut joints = 0;
    for (group, room) in plan.groups.iter().zip(&mut plan.rooms) {
        for k in 0..group.registers(S::F64_LANES) {
            let wheels = &group.wheels[k * S::F64_LANES..][..S::F64_LANES];
            let column = |numbers: &Eight| Lanes::load(simd, S::as_simd_f64s(numbers).0, k);
            let gather = |all: &[f64]| {
                let mut room = [0.0; GROUP];
                for (place, &i) in room.iter_mut().zip(wheels) {
                    *place = all.get(i).copied().unwrap_or(0.0);
                }
                Lanes::load(simd, S::as_simd_f64s(&room).0, 0)
            };
            let turned = (gather(after) - gather(before)) * column(&group.per_count[0]);
            let mut rolled = turned * column(&group.radius);
            unusual = unusual | !rolled.abs().at_most(most_way) | !turned.abs().at_most(largest);
            let (mut shares, mut way) = (
                group.shares.each_ref().map(|row| load(simd, row, k)),
                [rolled, zero],
            );
            if k * S::F64_LANES < group.steered {
                let rest = joints..given.angles.len();
                joints += S::F64_LANES;
                let [before, after] = given.steering.map(|all| padded(simd, &all[rest.clone()]));
                let start = padded(simd, &given.angles[rest.clone()]);
                let end = (after - before) * column(&group.per_count[1]) + start;
                put(end, &mut targets.angles[rest]);
                let turn = end - start;
                let middle = (start + end) * splat(0.5);
                unusual =
                    unusual | !turn.abs().at_most(most_turn) | !middle.abs().at_most(largest_angle);
                let half = turn * splat(0.5);
                let (sin, cos) = sin_cos(simd, middle + column(&group.heading));
                rolled = rolled * sinc_of_square(simd, half * half);
                way = [rolled * cos, rolled * sin];
                let [along, across] = shares;
                for part in 0..3 {
                    shares[0][part] = cos.mul_add(along[part], sin * across[part]);
                    shares[1][part] = cos.mul_add(across[part], -(sin * along[part]));
                }
            }
            let [along, _] = shares;
            x = rolled.mul_add(along[0], x);
            y = rolled.mul_add(along[1], y);
            z = rolled.mul_add(along[2], z);
            for (share, target) in shares.into_iter().zip(&mut room.shares) {
                store(share, target, k);
            }
            rolled.store(S::as_mut_simd_f64s(&mut room.rolled).0, k);
            for (way, target) in way.into_iter().zip(&mut room.way) {
                way.store(S::as_mut_simd_f64s(target).0, k);
            }
        }
    }
    if unusual.any() {
        return None;
    }
    Some([x.total(), y.total(), z.total()])
}

/// What the displacement may be off by in this step alone. Whether a wheel slid further than the
/// noise explains.
#[inline(always)]
fn doubt<S: Vector>(
    simd: S,
    plan: &mut Plan,
    given: &Given<'_>,
    displacement: [f64; 3],
) -> (Spread, bool) {
    let splat = |number| Lanes::splat(simd, number);
    let zero = splat(0.0);
    let step = displacement.map(splat);
    let slips = given.slip_variances != [0.0; 2];
    let reading = splat(given.reading_variance);
    let steering = splat(given.steering_deviation * given.steering_deviation);
    let suspicious = splat(SURELY * SUSPICIOUS * SUSPICIOUS);
    let mut squares = Squares::new(simd);
    let mut suspects = zero.below(zero);
    for (group, room) in plan.groups.iter().zip(&mut plan.rooms) {
        for k in 0..group.registers(S::F64_LANES) {
            let column = |numbers: &Eight| Lanes::load(simd, S::as_simd_f64s(numbers).0, k);
            let [rolling, side_slip] = group.rows.each_ref().map(|row| load(simd, row, k));
            let along = dot(rolling, step) - column(&room.way[0]);
            let across = dot(side_slip, step) - column(&room.way[1]);
            let square = along.mul_add(along, across * across);
            let slid = square.sqrt();
            let [mut own, mut sides] = [reading, zero];
            if slips {
                let [px, py] = group.pivot.each_ref().map(column);
                let x = step[0] - step[2] * py;
                let y = step[1] + step[2] * px;
                let distance = x.mul_add(x, y * y).sqrt();
                own = own + distance * splat(given.slip_variances[0]);
                sides = distance * splat(given.slip_variances[1]);
                squares.add(load(simd, &room.shares[1], k), sides);
            }
            squares.add(load(simd, &room.shares[0], k), own);
            let rolled = column(&room.rolled);
            let turned = steering * column(&group.steers) * (rolled * rolled);
            let [has_rolling, has_side_slip] = group.has.each_ref().map(column);
            let variance = has_rolling.mul_add(own, has_side_slip * (sides + turned));
            suspects = suspects
                | match given.slip_bound {
                    Some(bound) => splat(bound).below(slid),
                    None => (variance * suspicious).below(square),
                };
            slid.store(S::as_mut_simd_f64s(&mut room.slid).0, k);
            variance.store(S::as_mut_simd_f64s(&mut room.variance).0, k);
        }
    }
    let is_sure = given.slip_bound.is_some() || !suspects.any();
    let slips = if is_sure {
        suspects.any()
    } else {
        is_slip(&plan.rooms)
    };
    (squares.total(), slips)
}

/// The residuals of a step that was made.
#[inline(always)]
fn report<S: Vector>(simd: S, plan: &Plan, dt: f64, residual: &mut [f64]) {
    let dt = Lanes::splat(simd, dt);
    for (group, room) in plan.groups.iter().zip(&plan.rooms) {
        for k in 0..group.registers(S::F64_LANES) {
            let slid = Lanes::load(simd, S::as_simd_f64s(&room.slid).0, k);
            let mut speeds = [0.0; GROUP];
            slid.quotient(dt)
                .store(S::as_mut_simd_f64s(&mut speeds).0, 0);
            let wheels = &group.wheels[k * S::F64_LANES..][..S::F64_LANES];
            for (&i, speed) in wheels.iter().zip(speeds) {
                if let Some(target) = residual.get_mut(i) {
                    *target = speed;
                }
            }
        }
    }
}

/// Whether a wheel slid further than the noise explains, and than the rounding of the others' fit.
#[inline(never)]
fn is_slip(rooms: &[Room]) -> bool {
    let furthest = rooms
        .iter()
        .flat_map(|room| room.rolled)
        .fold(0.0_f64, |most, rolled| most.max(rolled.abs()));
    rooms.iter().any(|room| {
        let wheels = room.slid.iter().zip(&room.variance);
        wheels
            .into_iter()
            .any(|(slid, variance)| *slid > SUSPICIOUS * variance.sqrt() + ROUNDING * furthest)
    })
}

/// Takes the joints' errors along: what one end of the step adds to the displacement's covariance, and what the
/// columns that were carried come to at its end.
#[inline(always)]
fn carry<S: Vector>(
    simd: S,
    plan: &Plan,
    given: &Given<'_>,
    carried: &mut [[f64; 3]],
    jacobian: &StepJacobian,
) -> [Spread; 2] {
    let splat = |number| Lanes::splat(simd, number);
    let by = &jacobian.by_displacement;
    let [first, second] =
        [[by.m11, by.m12, by.m13], [by.m21, by.m22, by.m23]].map(|row| row.map(splat));
    let [lever_x, lever_y] = jacobian.lever().map(splat);
    let deviation = splat(given.steering_deviation / 2.0);
    let (mut ends, mut settled) = (Squares::new(simd), Squares::new(simd));
    let mut columns = carried
        .as_flattened_mut()
        .chunks_exact_mut(3 * S::F64_LANES);
    for (group, room) in plan.groups.iter().zip(&plan.rooms) {
        for k in 0..group.steered.div_ceil(S::F64_LANES) {
            let Some(columns) = columns.next() else { break };
            let column = |numbers: &Eight| Lanes::load(simd, S::as_simd_f64s(numbers).0, k);
            let error = column(&room.rolled) * column(&group.steers) * deviation;
            let half = load(simd, &room.shares[1], k).map(|share| share * error);
            ends.add_square(half);
            let end = [dot(first, half), dot(second, half), half[2]];
            let [x, y, z] = Lanes::unbraid(simd, columns);
            settled.add_square([
                lever_x.mul_add(z, x + end[0]),
                lever_y.mul_add(z, y + end[1]),
                z + end[2],
            ]);
            Lanes::braid(end, columns);
        }
    }
    [ends.total(), settled.total()]
}
