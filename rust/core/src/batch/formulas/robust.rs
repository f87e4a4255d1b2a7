//! Robust fits of whole registers of readings: the rounds of [`Rover::fit`], until all rows of a block have settled.
//!
//! A steered wheel without scrub and trail measures its pivot's whole velocity, so what a wheel adds to the normal
//! equations is a constant of the rover times its weight; the rounds need no angle.

mod rounds;

use nalgebra::{Matrix3, Vector3};
use rounds::{Rounds, squares};

use super::cone::dot;
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::polynomials::sin_cos;
use crate::batch::machine::vector::Vector;
use crate::batch::machine::weave::{BLOCK, Column};
use crate::estimate::{NOISE, ROUNDS};
use crate::rover::{Mount, Rover};
use crate::wheels::Wheel;

/// Lanes at most.
const LANES: usize = 8;

/// Rounds after which the rows that have not settled yet are put together anew: some take three times as many as most.
const PHASE: usize = 10;

/// Wheels at most: their registers are sorted by comparing neighbours.
const MOST: usize = 8;

/// Sums of squares of rim speeds that neither overflow nor lose digits [m²/s²].
const SQUARES: [f64; 2] = [1e-200, 1e200];

/// Smallest eigenvalue of the weighted rows, as a share of the largest, whose root is exact to 1e-12. Below it, the plain
/// core.
const PLAIN_BELOW: f64 = 1e-3;

/// Rotations are over when what they take away is this share of the trace.
const DIAGONAL: f64 = 1e-18;
const SWEEPS: usize = 8;

/// A wheel's two rows, along its heading and across it, or along the axes where it is steered; none of a castor.
#[derive(Clone, Copy, Debug)]
struct Rows {
    /// For the unknowns about the centre of the pivots.
    rows: [[f64; 3]; 2],
    /// Sums of their products, for those unknowns and for the twist itself.
    normal: [f64; 6],
    raw: [f64; 6],
    radius: f64,
    /// Direction at steering angle 0 [rad], of a steered wheel.
    heading: Option<f64>,
}

/// What the kernel needs to know of a rover.
#[derive(Debug)]
pub(super) struct Plan {
    wheels: Vec<Rows>,
    /// From the right-hand side to the unknowns, every wheel alike.
    solution: [[f64; 3]; 3],
    centre: [f64; 2],
    size: f64,
}

/// The upper half of the sum of products of two rows with themselves.
fn products(rows: [Vector3<f64>; 2]) -> [f64; 6] {
    let sum = rows[0] * rows[0].transpose() + rows[1] * rows[1].transpose();
    [sum.m11, sum.m12, sum.m13, sum.m22, sum.m23, sum.m33]
}

impl Plan {
    /// Nothing where there are too many wheels.
    pub fn new(rover: &Rover, solution: &Matrix3<f64>) -> Option<Self> {
        let part = |(wheel, mount): (&Wheel, &Mount)| {
            let (raw, heading) = match *mount {
                Mount::Castor(_) => ([Vector3::zeros(); 2], None),
                Mount::Fixed(rows) => ([rows.rolling, rows.side_slip], None),
                Mount::Steered(..) => {
                    let pivot = [
                        Vector3::new(1.0, 0.0, -wheel.y),
                        Vector3::new(0.0, 1.0, wheel.x),
                    ];
                    (pivot, Some(wheel.heading))
                }
            };
            let shifted = raw.map(|row| rover.shifted(&row));
            Rows {
                rows: shifted.map(Into::into),
                normal: products(shifted),
                raw: products(raw),
                radius: wheel.radius,
                heading,
            }
        };
        let wheels: Vec<_> = rover.wheels().iter().zip(&rover.mounts).map(part).collect();
        (wheels.len() <= MOST).then(|| Self {
            wheels,
            solution: [0, 1, 2].map(|k| solution.row(k).into_owned().transpose().into()),
            centre: [rover.centre.x, rover.centre.y],
            size: rover.size,
        })
    }
}

/// Results of a block.
pub(super) struct Found<'a> {
    pub twists: &'a mut [Column; 3],
    pub residuals: &'a mut [Column],
    pub weights: &'a mut [Column],
    pub sigma_min: &'a mut Column,
    /// Not 0 where the plain core has to do it.
    pub doubts: &'a mut Column,
}

/// Rows of a block on their way.
struct Block {
    /// What each wheel reads along its rows [m/s].
    seen: [[Column; 2]; MOST],
    unknowns: [Column; 3],
    weights: [Column; MOST],
    /// Noise at least, and scale of the last round [m/s].
    least: Column,
    scale: Column,
}

/// Fits the first `count` rows of a block. Whether that was all.
#[inline(always)]
pub(super) fn solve_block<S: Vector>(
    simd: S,
    plan: &Plan,
    steering: &[Column],
    speeds: &[Column],
    count: usize,
    found: &mut Found<'_>,
) -> bool {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let mut rows = Block {
        seen: [[Column::ZERO; 2]; MOST],
        unknowns: [Column::ZERO; 3],
        weights: [Column([1.0; BLOCK]); MOST],
        least: Column::ZERO,
        scale: Column([f64::INFINITY; BLOCK]),
    };
    let registers = count.div_ceil(S::F64_LANES);
    for k in 0..registers {
        let sure = begin(simd, plan, steering, speeds, k, &mut rows);
        found.doubts.store(k, sure.select(zero, one));
    }
    let mut active = [0; BLOCK];
    let mut left = 0;
    for row in 0..count {
        if found.doubts.0[row] == 0.0 {
            active[left] = row;
            left += 1;
        }
    }
    for _ in 0..ROUNDS / PHASE {
        let mut kept = 0;
        for first in (0..left).step_by(2 * S::F64_LANES) {
            let mut chosen = [0; 2 * LANES];
            let chunk = &active[first..left.min(first + 2 * S::F64_LANES)];
            chosen[..chunk.len()].copy_from_slice(chunk);
            let length = chunk.len();
            let mut pair = [
                Rounds::load(simd, plan, &rows, &chosen[..S::F64_LANES], length),
                Rounds::load(
                    simd,
                    plan,
                    &rows,
                    &chosen[S::F64_LANES..2 * S::F64_LANES],
                    length.saturating_sub(S::F64_LANES),
                ),
            ];
            for _ in 0..PHASE {
                for rounds in &mut pair {
                    rounds.round(simd, plan);
                }
                if !(pair[0].active | pair[1].active).any() {
                    break;
                }
            }
            let mut marks = [[0.0; LANES]; 4];
            for (half, rounds) in pair.iter().enumerate() {
                let of = &chosen[half * S::F64_LANES
                    ..length.clamp(half * S::F64_LANES, (half + 1) * S::F64_LANES)];
                rounds.store(plan, &mut rows, of);
                for (mark, mask) in [(0, rounds.active), (2, !rounds.sure)] {
                    let lanes = mask.select(one, zero);
                    lanes.store(S::as_mut_simd_f64s(&mut marks[mark + half]).0, 0);
                }
            }
            for (j, row) in chosen.into_iter().enumerate().take(length) {
                let (half, lane) = (j / S::F64_LANES, j % S::F64_LANES);
                if marks[2 + half][lane] != 0.0 {
                    found.doubts.0[row] = 1.0;
                } else if marks[half][lane] != 0.0 {
                    // Not further than where it was read from.
                    active[kept] = row;
                    kept += 1;
                }
            }
        }
        left = kept;
        if left == 0 {
            break;
        }
    }
    let mut all = zero.at_most(zero);
    for k in 0..registers {
        all = all & finish(simd, plan, &rows, k, found);
    }
    !(!all).any()
}

/// What a register of rows starts from: every wheel alike. Where the readings are of a usual size.
#[inline(always)]
fn begin<S: Vector>(
    simd: S,
    plan: &Plan,
    steering: &[Column],
    speeds: &[Column],
    k: usize,
    rows: &mut Block,
) -> Mask<S> {
    let splat = |number| Lanes::splat(simd, number);
    let zero = splat(0.0);
    let mut sum = [zero; 3];
    let (mut rolling, mut joint) = (zero, 0);
    for (i, wheel) in plan.wheels.iter().enumerate() {
        let rolled = speeds[i].load(simd, k) * splat(wheel.radius);
        let seen = match wheel.heading {
            Some(heading) => {
                let (sin, cos) = sin_cos(simd, steering[joint].load(simd, k) + splat(heading));
                joint += 1;
                [rolled * cos, rolled * sin]
            }
            None if wheel.normal == [0.0; 6] => continue,
            None => [rolled, zero],
        };
        rolling = rolled.mul_add(rolled, rolling);
        for (sum, moment) in sum.iter_mut().zip(wheel.moment(simd, seen)) {
            *sum = *sum + moment;
        }
        rows.seen[i][0].store(k, seen[0]);
        rows.seen[i][1].store(k, seen[1]);
    }
    for (unknown, row) in rows.unknowns.iter_mut().zip(&plan.solution) {
        unknown.store(k, dot(simd, row, sum));
    }
    let mean = rolling * splat(1.0 / plan.wheels.len() as f64);
    rows.least.store(k, mean.sqrt() * splat(NOISE));
    let [tiny, huge] = SQUARES.map(splat);
    rolling.at_most(zero) | (tiny.at_most(rolling) & rolling.at_most(huge))
}

/// What a register of rows has come to; where it is sure.
#[inline(always)]
fn finish<S: Vector>(
    simd: S,
    plan: &Plan,
    rows: &Block,
    k: usize,
    found: &mut Found<'_>,
) -> Mask<S> {
    let zero = Lanes::splat(simd, 0.0);
    let unknowns = super::steered::load(simd, &rows.unknowns, k);
    let [x, y, z] = unknowns;
    let omega = z * Lanes::splat(simd, 1.0 / plan.size);
    let [cx, cy] = plan.centre.map(|part| Lanes::splat(simd, part));
    let twist = [x + omega * cy, y - omega * cx, omega];
    for (column, part) in found.twists.iter_mut().zip(twist) {
        column.store(k, part);
    }
    let (mut seen, mut weights) = ([[zero; 2]; MOST], [zero; MOST]);
    for i in 0..plan.wheels.len() {
        let [a, b] = &rows.seen[i];
        (seen[i], weights[i]) = (
            [a.load(simd, k), b.load(simd, k)],
            rows.weights[i].load(simd, k),
        );
    }
    let squares = squares(simd, plan, &seen, &unknowns);
    let columns = found.residuals.iter_mut().zip(found.weights.iter_mut());
    for (i, (residual, weight)) in columns.enumerate() {
        residual.store(k, squares[i].sqrt());
        weight.store(k, weights[i]);
    }
    let (least, exact) = smallest(simd, plan, &weights);
    found.sigma_min.store(k, least.sqrt());
    let sure = exact & found.doubts.load(simd, k).at_most(zero);
    let one = Lanes::splat(simd, 1.0);
    found.doubts.store(k, sure.select(zero, one));
    sure
}

impl Rows {
    /// What it adds to the right-hand side.
    #[inline(always)]
    fn moment<S: Vector>(&self, simd: S, seen: [Lanes<S>; 2]) -> [Lanes<S>; 3] {
        let mut moment = [seen[0]; 3];
        for (part, moment) in moment.iter_mut().enumerate() {
            let across = seen[1] * Lanes::splat(simd, self.rows[1][part]);
            *moment = seen[0].mul_add(Lanes::splat(simd, self.rows[0][part]), across);
        }
        moment
    }
}

/// Smallest eigenvalue of the weighted rows of the twist itself, by rotations, and where its root is exact.
#[inline(always)]
fn smallest<S: Vector>(simd: S, plan: &Plan, weights: &[Lanes<S>; MOST]) -> (Lanes<S>, Mask<S>) {
    let splat = |number| Lanes::splat(simd, number);
    let mut sum = [splat(0.0); 6];
    for (wheel, weight) in plan.wheels.iter().zip(weights) {
        for (sum, part) in sum.iter_mut().zip(wheel.raw) {
            *sum = weight.mul_add(splat(part), *sum);
        }
    }
    let [mut a, mut b, mut c, mut d, mut e, mut f] = sum;
    let enough = (a + d + f) * splat(DIAGONAL);
    for _ in 0..SWEEPS {
        [a, d, b, c, e] = turned(simd, [a, d, b, c, e]);
        [a, f, c, b, e] = turned(simd, [a, f, c, b, e]);
        [d, f, e, b, c] = turned(simd, [d, f, e, b, c]);
        if !enough.below(b.abs().max(c.abs()).max(e.abs())).any() {
            break;
        }
    }
    let (least, most) = (a.min(d).min(f), a.max(d).max(f));
    (least, (most * splat(PLAIN_BELOW)).below(least))
}

/// Turns two axes until their product vanishes: their squares, the product, their products with the third one.
#[inline(always)]
fn turned<S: Vector>(simd: S, [p, q, pq, pr, qr]: [Lanes<S>; 5]) -> [Lanes<S>; 5] {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let (apart, twice) = (q - p, pq + pq);
    let length = apart.mul_add(apart, twice * twice).sqrt();
    let under = apart.abs() + length;
    let nothing = under.at_most(zero);
    let tangent = twice
        .quotient(nothing.select(one, under))
        .flip(apart.sign());
    let cos = one.quotient(tangent.mul_add(tangent, one).sqrt());
    let sin = tangent * cos;
    let moved = tangent * pq;
    [
        p - moved,
        q + moved,
        zero,
        cos * pr - sin * qr,
        sin * pr + cos * qr,
    ]
}
