//! Normal equations of the twists of a register of readings, and their solution. Forward kinematics, fits and
//! sensitivities start here.
//!
//! The rows of a steered wheel say together how fast its contact moves, whichever way it points. Without scrub and trail
//! the contact is the pivot, and the normal equations and their solution are constants of the rover.

use nalgebra::{Matrix3, Vector3};

use crate::rover_data::{Mount, RoverData};
use crate::table::Log;
use crate::wheels::Wheel;
use six_wheel_numerics::columns::{BLOCK, Column, transpose_to_columns};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::{LARGEST_ANGLE, sin_cos};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::stream::prefetch_ahead;

/// Speeds up to here surely make a finite twist [rad/s]. NaN, of a wheel without encoder, is not one.
pub(crate) const LARGEST_SPEED: f64 = 1e100;

/// Bound of what the rover multiplies readings by.
pub const LARGEST_ROVER: f64 = 1e100;

/// Pivot of the normal equations, as a share of their trace, that surely determines a direction.
const DETERMINED: f64 = 1e-10;

/// A wheel's two rows for the unknowns about the centre of the pivots: along its heading and across it, of its pivot along
/// the axes where it is steered, none of a castor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows {
    pub rows: [[f64; 3]; 2],
    radius: f64,
    /// True if the wheel has a share in the twist.
    says: bool,
    kind: Kind,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Fixed,
    /// Direction at steering angle 0 [rad].
    Steered(f64, Option<Offset>),
    Castor,
}

/// Scrub and trail: in metres, and as shares of the size of the rover.
#[derive(Clone, Copy, Debug)]
struct Offset {
    lengths: [f64; 2],
    shares: [f64; 2],
}

impl Rows {
    fn new(rover: &RoverData, i: usize, says: bool) -> Self {
        let wheel = &rover.wheels()[i];
        let (rows, kind) = match rover.mounts[i] {
            Mount::Castor(_) => ([Vector3::zeros(); 2], Kind::Castor),
            Mount::Fixed(rows) => ([rows.rolling, rows.side_slip], Kind::Fixed),
            Mount::Steered(..) => {
                let lengths = [wheel.scrub, wheel.trail];
                let shares = lengths.map(|length| length / rover.size);
                let offset = (!wheel.is_centred()).then_some(Offset { lengths, shares });
                (wheel.pivot_rows(), Kind::Steered(wheel.heading, offset))
            }
        };
        Self { rows: rows.map(|row| rover.shifted(&row).into()), radius: wheel.radius, says, kind }
    }

    /// Contribution to the normal equations in any direction of the wheel. The moments of a wheel with scrub or trail
    /// follow its direction and are left out.
    #[inline]
    pub fn normal(&self) -> [f64; 6] {
        let [mut along, mut across] = self.rows;
        if matches!(self.kind, Kind::Steered(_, Some(_))) {
            (along[2], across[2]) = (0.0, 0.0);
        }
        products([along, across])
    }
}

/// The upper half of the sum of products of two rows with themselves.
pub(crate) fn products(rows: [[f64; 3]; 2]) -> [f64; 6] {
    let places = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
    places.map(|(i, k)| rows.iter().map(|row| row[i] * row[k]).sum())
}

/// Constants of a rover for the kernels of readings.
pub(crate) struct ForwardConstants<'a> {
    pub(crate) rover: &'a RoverData,
    pub(crate) wheels: Vec<Rows>,
    pub(crate) joints: usize,
    /// Of the normal equations, `00 01 02 11 12 22`: what does not depend on the angles.
    normal: [f64; 6],
    /// From the right-hand side to the unknowns, where all of them do not.
    pub(crate) solution: Option<[[f64; 3]; 3]>,
}

/// Readings of a block; no rates where none are given, or they do not matter.
#[derive(Clone, Copy)]
pub(crate) struct ReadingColumns<'a> {
    pub steering: &'a [Column],
    pub speeds: &'a [Column],
    pub rates: &'a [Column],
}

impl<'a> ForwardConstants<'a> {
    /// Nothing where the twist is never determined, or sizes are extreme.
    pub fn new(rover: &'a RoverData) -> Option<Self> {
        let solution = rover.solution;
        let swings = |i: &usize| !rover.wheels()[*i].is_centred();
        if solution.is_none() && !rover.steered().iter().any(swings) {
            return None;
        }
        Self::weighted(rover, solution, |_| 1.0)
    }

    /// Wheels with a say of 1 or 0, and the solution of their normal equations, where it is a constant.
    pub fn weighted(
        rover: &'a RoverData,
        solution: Option<Matrix3<f64>>,
        weight: impl Fn(usize) -> f64,
    ) -> Option<Self> {
        let turned = |wheel: &Wheel| wheel.heading.abs() > LARGEST_ANGLE / 2.0;
        if rover.reading_bound > LARGEST_ROVER || rover.wheels().iter().any(turned) {
            return None;
        }
        let wheel = |i| Rows::new(rover, i, weight(i) != 0.0);
        let wheels: Vec<_> = (0..rover.wheels().len()).map(wheel).collect();
        let mut normal = [0.0; 6];
        for wheel in &wheels {
            for (sum, part) in normal.iter_mut().zip(wheel.normal()) {
                *sum += part;
            }
        }
        Some(Self {
            rover,
            wheels,
            joints: rover.steered().len(),
            normal,
            solution: solution.map(|solution| [0, 1, 2].map(|k| solution.row(k).transpose().into())),
        })
    }

    /// Columns of the rates, where they matter.
    #[inline]
    pub fn rates(&self, log: Log<'_>) -> usize {
        match (self.solution, log.steering_rates) {
            (None, Some(_)) => self.joints,
            _ => 0,
        }
    }
}

/// Data of a block that are kept beside its twists.
pub(crate) struct FitColumns<'a> {
    /// Reading of each wheel along its rows [m/s].
    pub seen: &'a mut [[Column; 2]],
    /// About the centre of the pivots, the last one a speed.
    pub unknowns: [Column; 3],
    /// Sum of squares of the rim speeds [m²/s²].
    pub rolling: Column,
    /// Not 0 where the plain core has to do it.
    pub doubts: Column,
}

impl<'a> FitColumns<'a> {
    /// Nothing yet; no readings are kept of wheels without a place for them.
    #[inline]
    pub fn new(seen: &'a mut [[Column; 2]]) -> Self {
        Self { seen, unknowns: [Column::ZERO; 3], rolling: Column::ZERO, doubts: Column::ZERO }
    }
}

/// Solves a block. Marks the rows that are not surely of a usual size, or determined; whether there are none.
#[inline(always)]
pub(crate) fn solve_block<S: Vector, const KEEP: bool>(
    simd: S,
    plan: &ForwardConstants<'_>,
    heard: ReadingColumns<'_>,
    twists: &mut [Column; 3],
    kept: &mut FitColumns<'_>,
    log: Log<'_>,
) -> bool {
    if plan.solution.is_some() {
        solve_registers::<S, KEEP, true>(simd, plan, heard, twists, kept, log)
    } else {
        solve_registers::<S, KEEP, false>(simd, plan, heard, twists, kept, log)
    }
}

/// [`solve_block`], with what is known beforehand out of the loop: whether all steered wheels are `CENTRED`.
#[inline(always)]
fn solve_registers<S: Vector, const KEEP: bool, const CENTRED: bool>(
    simd: S,
    plan: &ForwardConstants<'_>,
    heard: ReadingColumns<'_>,
    twists: &mut [Column; 3],
    kept: &mut FitColumns<'_>,
    log: Log<'_>,
) -> bool {
    let splat = |number| Lanes::splat(simd, number);
    let zero = splat(0.0);
    let [largest_angle, largest_speed] = [LARGEST_ANGLE / 2.0, LARGEST_SPEED].map(|largest| splat(largest * largest));
    let mut all: Mask<S> = zero.le(zero);
    for k in 0..BLOCK / S::F64_LANES {
        prefetch_ahead(simd, log.steering, k, BLOCK / S::F64_LANES);
        prefetch_ahead(simd, log.speeds, k, BLOCK / S::F64_LANES);
        let [mut x, mut y, mut z] = [zero; 3];
        // Sums of squares say as well whether all are of a usual size, or one of them is not a number.
        let [mut angles, mut rates, mut rolling] = [zero; 3];
        let mut normal = [zero; 6];
        if !CENTRED {
            for (sum, constant) in normal.iter_mut().zip(plan.normal) {
                *sum = splat(constant);
            }
        }
        let mut joint = 0;
        for (i, (wheel, speeds)) in plan.wheels.iter().zip(heard.speeds).enumerate() {
            let speed = speeds.load(simd, k);
            rates = speed.mul_add(speed, rates);
            let rolled = speed * splat(wheel.radius);
            let [along, across] = &wheel.rows;
            let mut seen = [rolled, zero];
            match wheel.kind {
                Kind::Fixed if KEEP && !wheel.says => {}
                Kind::Fixed => {
                    x = rolled.mul_add(splat(along[0]), x);
                    y = rolled.mul_add(splat(along[1]), y);
                    z = rolled.mul_add(splat(along[2]), z);
                }
                Kind::Steered(heading, offset) => {
                    let angle = heard.steering[joint].load(simd, k);
                    angles = angle.mul_add(angle, angles);
                    let (sin, cos) = sin_cos(simd, angle + splat(heading));
                    let (mut u, mut v) = (rolled * cos, rolled * sin);
                    let mut arm = [splat(across[2]), splat(-along[2])];
                    if let Some(offset) = offset
                        && !CENTRED
                    {
                        arm = offset.swung(arm, offset.shares, (sin, cos));
                        add_moments(&mut normal, arm);
                        if let Some(rate) = heard.rates.get(joint) {
                            let rate = rate.load(simd, k);
                            rates = rate.mul_add(rate, rates);
                            // The contact goes round the steering axis.
                            let [x, y] = offset.swung([zero; 2], offset.lengths, (sin, cos));
                            (u, v) = (u + y * rate, v - x * rate);
                        }
                    }
                    joint += 1;
                    if !KEEP || wheel.says {
                        x = x + u;
                        y = y + v;
                        z = v.mul_add(arm[0], z);
                        z = u.mul_add(-arm[1], z);
                    }
                    seen = [u, v];
                }
                Kind::Castor => seen = [zero; 2],
            }
            if KEEP {
                let [u, v] = seen;
                rolling = u.mul_add(u, v.mul_add(v, rolling));
                kept.seen[i][0].store(k, u);
                kept.seen[i][1].store(k, v);
            }
        }
        if KEEP {
            kept.rolling.store(k, rolling);
        }
        let is_safe = rates.le(largest_speed) & angles.le(largest_angle);
        all = all & store_twist::<S, KEEP, CENTRED>(simd, plan, (normal, [x, y, z]), is_safe, k, twists, kept);
    }
    !(!all).any()
}

/// Solves the normal equations of register `k` and stores the twists, and for fits what they go on from. Returns the lanes that
/// are solved.
#[inline(always)]
fn store_twist<S: Vector, const KEEP: bool, const CENTRED: bool>(
    simd: S,
    plan: &ForwardConstants<'_>,
    (normal, [x, y, z]): ([Lanes<S>; 6], [Lanes<S>; 3]),
    is_safe: Mask<S>,
    k: usize,
    twists: &mut [Column; 3],
    kept: &mut FitColumns<'_>,
) -> Mask<S> {
    let splat = |number| Lanes::splat(simd, number);
    let mut unknowns = [splat(0.0); 3];
    let mut is_solved = is_safe;
    if let Some(rows) = &plan.solution
        && CENTRED
    {
        for (unknown, [a, b, c]) in unknowns.iter_mut().zip(rows) {
            let sum = y.mul_add(splat(*b), x * splat(*a));
            *unknown = z.mul_add(splat(*c), sum);
        }
    } else {
        let (solved, determined) = solve(simd, normal, [x, y, z]);
        (unknowns, is_solved) = (solved, is_safe & determined);
    }
    if KEEP {
        for (column, unknown) in kept.unknowns.iter_mut().zip(unknowns) {
            column.store(k, unknown);
        }
    }
    for (column, part) in twists.iter_mut().zip(plan.unshifted(unknowns)) {
        column.store(k, part);
    }
    kept.doubts.store(k, is_solved.select(splat(0.0), splat(1.0)));
    is_solved
}

impl ForwardConstants<'_> {
    /// Takes the readings of a block apart.
    #[inline(always)]
    pub fn load_readings<'c, S: Vector>(&self, simd: S, log: Log<'_>, columns: &'c mut [Column]) -> ReadingColumns<'c> {
        let (steering, rest) = columns.split_at_mut(self.joints);
        let (speeds, rates) = rest.split_at_mut(self.wheels.len());
        transpose_to_columns(simd, log.steering, steering);
        transpose_to_columns(simd, log.speeds, speeds);
        if !rates.is_empty() {
            transpose_to_columns(simd, log.steering_rates.unwrap_or_default(), rates);
        }
        ReadingColumns { steering, speeds, rates }
    }

    /// The normal equations of a register of angles.
    #[inline(always)]
    pub fn normal<S: Vector>(&self, simd: S, steering: &[Column], k: usize) -> [Lanes<S>; 6] {
        let splat = |number| Lanes::splat(simd, number);
        let mut normal = [splat(0.0); 6];
        for (sum, constant) in normal.iter_mut().zip(self.normal) {
            *sum = splat(constant);
        }
        let mut joint = 0;
        for wheel in &self.wheels {
            let Kind::Steered(heading, offset) = wheel.kind else {
                continue;
            };
            if let Some(offset) = offset {
                let angle = steering[joint].load(simd, k) + splat(heading);
                let [along, across] = &wheel.rows;
                let arm = [splat(across[2]), splat(-along[2])];
                let arm = offset.swung(arm, offset.shares, sin_cos(simd, angle));
                add_moments(&mut normal, arm);
            }
            joint += 1;
        }
        normal
    }

    /// [`Rover::unshifted`] in every lane.
    #[inline(always)]
    pub fn unshifted<S: Vector>(&self, [x, y, z]: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
        let omega = z * (1.0 / self.rover.size);
        [x + omega * self.rover.centre.y, y - omega * self.rover.centre.x, omega]
    }
}

impl Offset {
    /// A point away from the steering axis by scrub and trail.
    #[inline(always)]
    fn swung<S: Vector>(
        &self,
        [x, y]: [Lanes<S>; 2],
        [scrub, trail]: [f64; 2],
        (sin, cos): (Lanes<S>, Lanes<S>),
    ) -> [Lanes<S>; 2] {
        [x - sin * scrub - cos * trail, y + cos * scrub - sin * trail]
    }
}

/// Adds what a contact at the end of this arm measures to the moments of the normal equations.
#[inline(always)]
fn add_moments<S: Vector>(normal: &mut [Lanes<S>; 6], [x, y]: [Lanes<S>; 2]) {
    normal[2] = normal[2] - y;
    normal[4] = normal[4] + x;
    normal[5] = x.mul_add(x, y.mul_add(y, normal[5]));
}

/// The solution of normal equations `00 01 02 11 12 22`, and where their pivots are large enough.
#[inline(always)]
pub(crate) fn solve<S: Vector>(
    simd: S,
    [a, b, c, d, e, f]: [Lanes<S>; 6],
    [x, y, z]: [Lanes<S>; 3],
) -> ([Lanes<S>; 3], Mask<S>) {
    let least = (a + d + f) * DETERMINED;
    // By minors, so that there is one division.
    let (xx, xy, xz) = (d * f - e * e, c * e - b * f, b * e - c * d);
    let (yy, yz, zz) = (a * f - c * c, b * c - a * e, a * d - b * b);
    let whole = a * xx + b * xy + c * xz;
    let share = Lanes::splat(simd, 1.0) / whole;
    let unknowns =
        [(xx * x + xy * y + xz * z) * share, (xy * x + yy * y + yz * z) * share, (xz * x + yz * y + zz * z) * share];
    // The pivots, times those before them.
    (unknowns, least.lt(a) & (least * a).lt(zz) & (least * zz).lt(whole))
}
