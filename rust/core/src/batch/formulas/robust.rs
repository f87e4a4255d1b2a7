//! Robust fits of whole registers of readings: the rounds of [`Rover::fit`], in every lane until it has settled.
//!
//! A steered wheel without scrub and trail measures its pivot's whole velocity, so what a wheel adds to the normal
//! equations is a constant of the rover times its weight; the rounds need no angle.

use nalgebra::{Matrix3, Vector3};

use super::cone::dot;
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::polynomials::sin_cos;
use crate::batch::machine::vector::Vector;
use crate::batch::machine::weave::Column;
use crate::estimate::{MEDIANS, NOISE, ROUNDS, SETTLED};
use crate::rover::{Mount, Rover};
use crate::wheels::Wheel;

/// Wheels at most: their registers are sorted by comparing neighbours.
const MOST: usize = 8;

/// Sums of squares of rim speeds that neither overflow nor lose digits [m²/s²].
const SQUARES: [f64; 2] = [1e-200, 1e200];

/// Pivot of the normal equations, as a share of their trace, that surely determines a direction.
const DETERMINED: f64 = 1e-10;

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
    let mut all = zero.at_most(zero);
    for k in 0..count.div_ceil(S::F64_LANES) {
        let fit = fit(simd, plan, steering, speeds, k);
        let [x, y, z] = fit.unknowns;
        let omega = z * Lanes::splat(simd, 1.0 / plan.size);
        let [cx, cy] = plan.centre.map(|part| Lanes::splat(simd, part));
        let twist = [x + omega * cy, y - omega * cx, omega];
        for (column, part) in found.twists.iter_mut().zip(twist) {
            column.store(k, part);
        }
        let columns = found.residuals.iter_mut().zip(found.weights.iter_mut());
        for (i, (residual, weight)) in columns.enumerate() {
            residual.store(k, fit.squares[i].sqrt());
            weight.store(k, fit.weights[i]);
        }
        let (least, sure) = smallest(simd, plan, &fit.weights);
        let sure = fit.sure & sure;
        found.sigma_min.store(k, least.sqrt());
        found.doubts.store(k, sure.select(zero, one));
        all = all & sure;
    }
    !(!all).any()
}

struct Fit<S: Vector> {
    /// About the centre of the pivots, the last one a speed.
    unknowns: [Lanes<S>; 3],
    /// Squared residuals [m²/s²].
    squares: [Lanes<S>; MOST],
    weights: [Lanes<S>; MOST],
    sure: Mask<S>,
}

/// One register of rows.
#[inline(always)]
fn fit<S: Vector>(
    simd: S,
    plan: &Plan,
    steering: &[Column],
    speeds: &[Column],
    k: usize,
) -> Fit<S> {
    let splat = |number| Lanes::splat(simd, number);
    let (zero, one) = (splat(0.0), splat(1.0));
    let count = plan.wheels.len();
    let mut seen = [[zero; 2]; MOST];
    let mut moments = [[zero; 3]; MOST];
    let mut sum = [zero; 3];
    let (mut rolling, mut joint) = (zero, 0);
    for (i, wheel) in plan.wheels.iter().enumerate() {
        let rolled = speeds[i].load(simd, k) * splat(wheel.radius);
        seen[i] = match wheel.heading {
            Some(heading) => {
                let (sin, cos) = sin_cos(simd, steering[joint].load(simd, k) + splat(heading));
                joint += 1;
                [rolled * cos, rolled * sin]
            }
            None if wheel.normal == [0.0; 6] => continue,
            None => [rolled, zero],
        };
        rolling = rolled.mul_add(rolled, rolling);
        let [along, across] = wheel.rows;
        for part in 0..3 {
            let moment = seen[i][1] * splat(across[part]);
            moments[i][part] = seen[i][0].mul_add(splat(along[part]), moment);
            sum[part] = sum[part] + moments[i][part];
        }
    }
    let least_noise = (rolling * splat(1.0 / count as f64)).sqrt() * splat(NOISE);
    let [tiny, huge] = SQUARES.map(splat);
    let rests = rolling.at_most(zero);
    let mut sure = rests | (tiny.at_most(rolling) & rolling.at_most(huge));
    let mut unknowns = [zero; 3];
    for (unknown, row) in unknowns.iter_mut().zip(&plan.solution) {
        *unknown = dot(simd, row, sum);
    }
    let mut weights = [one; MOST];
    let mut scale = splat(f64::INFINITY);
    let mut active = sure;
    for round in 0..ROUNDS {
        let squares = squares(simd, plan, &seen, &unknowns);
        let mut sorted = squares;
        for last in 1..count {
            for at in (1..=last).rev() {
                let (low, high) = (sorted[at - 1], sorted[at]);
                (sorted[at - 1], sorted[at]) = (low.min(high), low.max(high));
            }
        }
        let upper = sorted[count / 2].sqrt();
        let median = if count % 2 == 1 {
            upper
        } else {
            (sorted[count / 2 - 1].sqrt() + upper) * splat(0.5)
        };
        let noise = (median * splat(MEDIANS)).max(least_noise);
        if round == 0 {
            scale = sorted[count - 1].sqrt().max(least_noise);
        }
        scale = scale.min(noise.max(scale * splat(0.5)));
        // Where nothing disagrees at all, nothing is weighed.
        active = active & zero.below(scale);
        let per_square = one.quotient(scale * scale);
        let mut change = zero;
        let (mut normal, mut right) = ([zero; 6], [zero; 3]);
        for (i, wheel) in plan.wheels.iter().enumerate() {
            let ratio = squares[i].mul_add(per_square, one);
            let next = active.select(one.quotient(ratio * ratio), weights[i]);
            change = change.max((next - weights[i]).abs());
            weights[i] = next;
            for (sum, part) in normal.iter_mut().zip(wheel.normal) {
                *sum = next.mul_add(splat(part), *sum);
            }
            for (sum, part) in right.iter_mut().zip(moments[i]) {
                *sum = next.mul_add(part, *sum);
            }
        }
        let (solved, determined) = solve(simd, normal, right);
        sure = sure & (determined | !active);
        for (unknown, solved) in unknowns.iter_mut().zip(solved) {
            *unknown = active.select(solved, *unknown);
        }
        active = active & sure & splat(SETTLED).below(change);
        if !active.any() {
            break;
        }
    }
    Fit {
        squares: squares(simd, plan, &seen, &unknowns),
        unknowns,
        weights,
        sure,
    }
}

/// Squared residuals.
#[inline(always)]
fn squares<S: Vector>(
    simd: S,
    plan: &Plan,
    seen: &[[Lanes<S>; 2]; MOST],
    unknowns: &[Lanes<S>; 3],
) -> [Lanes<S>; MOST] {
    let mut squares = [Lanes::splat(simd, 0.0); MOST];
    for (i, wheel) in plan.wheels.iter().enumerate() {
        let along = dot(simd, &wheel.rows[0], *unknowns) - seen[i][0];
        let across = dot(simd, &wheel.rows[1], *unknowns) - seen[i][1];
        squares[i] = along.mul_add(along, across * across);
    }
    squares
}

/// The solution of normal equations `00 01 02 11 12 22`, and where they surely have one.
#[inline(always)]
fn solve<S: Vector>(
    simd: S,
    [a, b, c, d, e, f]: [Lanes<S>; 6],
    [x, y, z]: [Lanes<S>; 3],
) -> ([Lanes<S>; 3], Mask<S>) {
    let one = Lanes::splat(simd, 1.0);
    let least = (a + d + f) * Lanes::splat(simd, DETERMINED);
    let first = one.quotient(a);
    let (l10, l20) = (b * first, c * first);
    let second = d - l10 * b;
    let (per_second, m) = (one.quotient(second), e - l20 * b);
    let l21 = m * per_second;
    let third = f - l20 * c - l21 * m;
    let y = y - l10 * x;
    let z = (z - l20 * x - l21 * y).quotient(third);
    let y = y * per_second - l21 * z;
    let x = x * first - l10 * y - l20 * z;
    let sure = least.below(a) & least.below(second) & least.below(third);
    ([x, y, z], sure)
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
