//! Magnitudes of all numbers of a batch, which are checked before anything is computed.

use crate::error::SHORTEST;
use crate::simd::lanes::Lanes;
use crate::simd::level::{Kernel, Level};
use crate::simd::vector::Vector;

/// Lanes of the widest register.
const LANES: usize = 8;

/// Registers in lockstep, so that their sums and comparisons are independent of each other.
const ABREAST: usize = 4;

/// Sum of the absolute values. NaN if one is NaN.
#[inline]
pub fn sum_of_sizes(level: Level, values: &[f64]) -> f64 {
    level.run_any(SumOfSizes(values))
}

struct SumOfSizes<'a>(&'a [f64]);

impl Kernel for SumOfSizes<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> f64 {
        let (registers, rest) = S::as_simd_f64s(self.0);
        let mut sums = [Lanes::splat(simd, 0.0); ABREAST];
        let (whole, left) = registers.as_chunks::<ABREAST>();
        for registers in whole {
            for (j, sum) in sums.iter_mut().enumerate() {
                *sum = *sum + Lanes::load(simd, registers, j).abs();
            }
        }
        for k in 0..left.len() {
            sums[0] = sums[0] + Lanes::load(simd, left, k).abs();
        }
        let sum = (sums[0] + sums[1]) + (sums[2] + sums[3]);
        sum.sum() + rest.iter().map(|value| value.abs()).sum::<f64>()
    }
}

/// True if every number is finite and smaller than `limit`.
#[inline]
pub fn are_below(values: &[f64], limit: f64) -> bool {
    Level::best().run_any(Extremes(values)).is_some_and(|[least, most]| least > -limit && most < limit)
}

/// The longest of some durations, 0 of none; None unless all are finite and at least [`SHORTEST`].
#[inline]
pub fn longest(dts: &[f64]) -> Option<f64> {
    let [least, most] = Level::best().run_any(Extremes(dts))?;
    (least >= SHORTEST).then_some(most)
}

/// The least and the largest of some numbers, infinity and 0 of an empty slice; None unless all are finite.
struct Extremes<'a>(&'a [f64]);

impl Kernel for Extremes<'_> {
    type Output = Option<[f64; 2]>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let (registers, rest) = S::as_simd_f64s(self.0);
        let (zero, endless) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, f64::INFINITY));
        let mut finite = [zero.lt(endless); ABREAST];
        let (mut least, mut most) = ([endless; ABREAST], [zero; ABREAST]);
        let (whole, left) = registers.as_chunks::<ABREAST>();
        for registers in whole {
            for j in 0..ABREAST {
                let values = Lanes::load(simd, registers, j);
                finite[j] = finite[j] & values.abs().lt(endless);
                least[j] = least[j].min(values);
                most[j] = most[j].max(values);
            }
        }
        for k in 0..left.len() {
            let values = Lanes::load(simd, left, k);
            finite[0] = finite[0] & values.abs().lt(endless);
            least[0] = least[0].min(values);
            most[0] = most[0].max(values);
        }
        let [a, b, c, d] = finite;
        if (!(a & b & c & d)).any() || !rest.iter().all(|value| value.is_finite()) {
            return None;
        }
        let mut extremes = [f64::INFINITY, 0.0];
        let ends = [least[0].min(least[1]).min(least[2].min(least[3])), most[0].max(most[1]).max(most[2].max(most[3]))];
        let mut lanes = [[0.0; LANES]; 2];
        for (lanes, end) in lanes.iter_mut().zip(ends) {
            end.store(S::as_mut_simd_f64s(lanes).0, 0);
        }
        let [least, most] = lanes;
        for (low, high) in least.into_iter().zip(most).take(S::F64_LANES) {
            extremes = widened(extremes, low, high);
        }
        for value in rest {
            extremes = widened(extremes, *value, *value);
        }
        Some(extremes)
    }
}

#[inline(always)]
fn widened([least, most]: [f64; 2], low: f64, high: f64) -> [f64; 2] {
    [least.min(low), most.max(high)]
}
