//! Registers of eight numbers.

use std::arch::x86_64::*;

use pulp::bytemuck::cast;
use pulp::x86::V4;
use pulp::{f32x16, f64x8};

use super::{Vector, ZEROTH};

/// Lanes of two registers, those of the second counted from 8.
#[inline(always)]
fn pick(simd: V4, [a, b]: [f64x8; 2], lanes: [i64; 8]) -> f64x8 {
    cast(simd.avx512f._mm512_permutex2var_pd(cast(a), cast(lanes), cast(b)))
}

/// Pairs of numbers at every other place. A closure would not get the instructions of the level.
macro_rules! every_other {
    ($table: ident, $places: ident, $first: literal) => {{
        let a = _mm_loadu_pd($table.add($places[$first]));
        let b = _mm_loadu_pd($table.add($places[$first + 2]));
        let c = _mm_loadu_pd($table.add($places[$first + 4]));
        let d = _mm_loadu_pd($table.add($places[$first + 6]));
        let low = _mm512_castpd256_pd512(_mm256_set_m128d(b, a));
        _mm512_insertf64x4::<1>(low, _mm256_set_m128d(d, c))
    }};
}

#[inline_always]
impl Vector for V4 {
    fn zip(self, pair: [f64x8; 2]) -> [f64x8; 2] {
        [pick(self, pair, [0, 8, 1, 9, 2, 10, 3, 11]), pick(self, pair, [4, 12, 5, 13, 6, 14, 7, 15])]
    }

    fn unzip(self, pair: [f64x8; 2]) -> [f64x8; 2] {
        [pick(self, pair, [0, 2, 4, 6, 8, 10, 12, 14]), pick(self, pair, [1, 3, 5, 7, 9, 11, 13, 15])]
    }

    fn interleave3(self, [a, b, c]: [f64x8; 3]) -> [f64x8; 3] {
        let first = pick(self, [a, b], [0, 8, 0, 1, 9, 0, 2, 10]);
        let second = pick(self, [a, b], [0, 3, 11, 0, 4, 12, 0, 5]);
        let third = pick(self, [a, b], [13, 0, 6, 14, 0, 7, 15, 0]);
        [
            pick(self, [first, c], [0, 1, 8, 3, 4, 9, 6, 7]),
            pick(self, [second, c], [10, 1, 2, 11, 4, 5, 12, 7]),
            pick(self, [third, c], [0, 13, 2, 3, 14, 5, 6, 15]),
        ]
    }

    fn deinterleave3(self, [a, b, c]: [f64x8; 3]) -> [f64x8; 3] {
        let first = pick(self, [a, b], [0, 3, 6, 9, 12, 15, 0, 0]);
        let second = pick(self, [a, b], [1, 4, 7, 10, 13, 0, 0, 0]);
        let third = pick(self, [a, b], [2, 5, 8, 11, 14, 0, 0, 0]);
        [
            pick(self, [first, c], [0, 1, 2, 3, 4, 5, 10, 13]),
            pick(self, [second, c], [0, 1, 2, 3, 4, 8, 11, 14]),
            pick(self, [third, c], [0, 1, 2, 3, 4, 9, 12, 15]),
        ]
    }

    fn transpose(self, rows: [f64x8; 8]) -> [f64x8; 8] {
        let [a, b, c, d, e, f, g, h] = rows.map(cast);
        let simd = self.avx512f;
        // a0 b0 a2 b2 .., and so on; then a1 b1 a3 b3 .., and so on.
        let [c0, c2, c4, c6] = pairs(
            self,
            [
                simd._mm512_unpacklo_pd(a, b),
                simd._mm512_unpacklo_pd(c, d),
                simd._mm512_unpacklo_pd(e, f),
                simd._mm512_unpacklo_pd(g, h),
            ],
        );
        let [c1, c3, c5, c7] = pairs(
            self,
            [
                simd._mm512_unpackhi_pd(a, b),
                simd._mm512_unpackhi_pd(c, d),
                simd._mm512_unpackhi_pd(e, f),
                simd._mm512_unpackhi_pd(g, h),
            ],
        );
        [c0, c1, c2, c3, c4, c5, c6, c7]
    }

    fn shift<const LOG: u32>(self, register: f64x8) -> f64x8 {
        // Zeros by a mask: a register of zeros is compiled to an expansion, which occupies its one port for two cycles.
        let (masked, lanes): (_, [i64; 8]) = match LOG {
            0 => (0b1111_1110, [0, 0, 1, 2, 3, 4, 5, 6]),
            1 => (0b1111_1100, [0, 0, 0, 1, 2, 3, 4, 5]),
            _ => (0b1111_0000, [0, 0, 0, 0, 0, 1, 2, 3]),
        };
        let simd = self.avx512f;
        cast(simd._mm512_maskz_permutexvar_pd(masked, cast(lanes), cast(register)))
    }

    fn last(self, register: f64x8) -> f64 {
        register.7
    }

    fn broadcast_last(self, register: f64x8) -> f64x8 {
        pick(self, [register, register], [7; 8])
    }

    const STREAMS: bool = true;

    unsafe fn stream(self, target: &mut f64x8, register: f64x8) {
        let target: *mut _ = target;
        // SAFETY: a reference's memory may be written, and the caller sees to its alignment and the fence.
        unsafe { self.avx512f._mm512_stream_pd(target.cast(), cast(register)) }
    }

    fn store_fence(self) {
        self.sse._mm_sfence();
    }

    fn gather(self, table: &[f64], places: f64x8) -> f64x8 {
        let Some(last) = table.len().checked_sub(1) else {
            return self.splat_f64x8(f64::NAN);
        };
        let (simd, offset) = (self.avx512f, self.splat_f64x8(ZEROTH));
        // The second operand where the first is NaN.
        let low = simd._mm512_max_pd(cast(places), cast(self.splat_f64x8(0.0)));
        let near = simd._mm512_min_pd(low, cast(self.splat_f64x8(last as f64)));
        let whole = simd._mm512_add_pd(near, cast(offset));
        let places = simd._mm512_xor_si512(cast(whole), cast(offset));
        // SAFETY: every index is inside the table, by the two comparisons.
        cast(unsafe { simd._mm512_i64gather_pd::<8>(places, table.as_ptr()) })
    }

    /// Pairs of neighbours: gathers would take twice the time.
    fn square(self, table: &[f64], columns: usize, places: f64x8) -> [f64x8; 4] {
        assert!(columns >= 2 && table.len() >= 2 * columns);
        let (simd, offset) = (self.avx512f, self.splat_f64x8(ZEROTH));
        let last = self.splat_f64x8((table.len() - columns - 2) as f64);
        // The second operand where the first is NaN.
        let low = simd._mm512_max_pd(cast(places), cast(self.splat_f64x8(0.0)));
        let whole = simd._mm512_add_pd(simd._mm512_min_pd(low, cast(last)), cast(offset));
        let at: [usize; 8] = cast(simd._mm512_xor_si512(cast(whole), cast(offset)));
        let (here, next) = (table.as_ptr(), table[columns..].as_ptr());
        // SAFETY: the token is that of the level, and every place and the next one are in the table, in their row and a
        // row on, by the two comparisons.
        unsafe {
            let (even, odd) = (every_other!(here, at, 0), every_other!(here, at, 1));
            let (even_next, odd_next) = (every_other!(next, at, 0), every_other!(next, at, 1));
            [
                cast(_mm512_unpacklo_pd(even, odd)),
                cast(_mm512_unpackhi_pd(even, odd)),
                cast(_mm512_unpacklo_pd(even_next, odd_next)),
                cast(_mm512_unpackhi_pd(even_next, odd_next)),
            ]
        }
    }

    /// By an estimate of 14 bits and two steps of Newton's method, in less time than a square root and a division.
    fn inverse_root(self, numbers: f64x8) -> f64x8 {
        let half = self.mul_f64x8(numbers, self.splat_f64x8(-0.5));
        let mut root = cast(self.avx512f._mm512_rsqrt14_pd(cast(numbers)));
        for _ in 0..2 {
            let square = self.mul_f64x8(root, root);
            let missing = self.mul_add_f64x8(half, square, self.splat_f64x8(0.5));
            root = self.mul_add_f64x8(root, missing, root);
        }
        root
    }

    unsafe fn pairs(self, table: &[[f32; 2]], places: f64x8) -> f64x8 {
        let simd = self.avx512f;
        let places = simd._mm512_xor_si512(cast(places), cast(self.splat_f64x8(ZEROTH)));
        // SAFETY: the caller keeps every index inside the table, and a pair is as large as a double.
        cast(unsafe { simd._mm512_i64gather_pd::<8>(places, table.as_ptr().cast()) })
    }

    fn exponent(self, register: f64x8) -> f64x8 {
        cast(self.avx512f._mm512_getexp_pd(cast(register)))
    }

    fn least_pairs(self, a: f64x8, b: f64x8) -> f64x8 {
        cast(self.avx512f._mm512_min_ps(cast(a), cast(b)))
    }

    fn deinterleave2(self, pairs: f64x8) -> [f64x8; 2] {
        let simd = self.avx512f;
        let first = simd._mm512_cvtepi64_epi32(cast(pairs));
        let second = simd._mm512_cvtepi64_epi32(simd._mm512_srli_epi64::<32>(cast(pairs)));
        [cast(simd._mm512_cvtps_pd(cast(first))), cast(simd._mm512_cvtps_pd(cast(second)))]
    }

    fn single_inverse_root(self, numbers: f64x8) -> f64x8 {
        // SAFETY: the token is that of the level.
        unsafe {
            let root = _mm256_sqrt_ps(_mm512_cvtpd_ps(cast(numbers)));
            cast(_mm512_cvtps_pd(_mm256_div_ps(_mm256_set1_ps(1.0), root)))
        }
    }

    fn prefetch(self, address: *const f64) {
        self.sse._mm_prefetch::<_MM_HINT_T0>(address.cast());
    }

    unsafe fn corners(self, values: &[f32], columns: usize, [x, y]: [f64x8; 2]) -> [[f64x8; 2]; 2] {
        let first = values.as_ptr();
        // SAFETY: the token is that of the level, and the caller sees to the places.
        unsafe {
            let (x, y) = (_mm512_cvttpd_epi32(cast(x)), _mm512_cvttpd_epi32(cast(y)));
            let at = _mm256_add_epi32(_mm256_mullo_epi32(y, _mm256_set1_epi32(columns as i32)), x);
            // Two values at a time.
            let row = |first: *const f32| {
                let pairs = _mm512_i32gather_epi64::<4>(at, first.cast());
                let half = |pairs| _mm512_cvtps_pd(_mm256_castsi256_ps(_mm512_cvtepi64_epi32(pairs)));
                [cast(half(pairs)), cast(half(_mm512_srli_epi64::<32>(pairs)))]
            };
            [row(first), row(first.add(columns))]
        }
    }

    unsafe fn corners_single(self, values: &[f32], columns: usize, [x, y]: [f32x16; 2]) -> [[f32x16; 2]; 2] {
        let first = values.as_ptr();
        // SAFETY: as above.
        unsafe {
            let (x, y) = (_mm512_cvttps_epi32(cast(x)), _mm512_cvttps_epi32(cast(y)));
            let at = _mm512_add_epi32(_mm512_mullo_epi32(y, _mm512_set1_epi32(columns as i32)), x);
            let halves = [_mm512_castsi512_si256(at), _mm512_extracti64x4_epi64::<1>(at)];
            let even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
            let odd = _mm512_add_epi32(even, _mm512_set1_epi32(1));
            let row = |first: *const f32| {
                let [a, b] = halves.map(|at| _mm512_castsi512_ps(_mm512_i32gather_epi64::<4>(at, first.cast())));
                [even, odd].map(|which| cast(_mm512_permutex2var_ps(a, which, b)))
            };
            [row(first), row(first.add(columns))]
        }
    }
}

/// The columns of four registers of four pairs each.
#[inline(always)]
fn pairs(simd: V4, [a, b, c, d]: [__m512d; 4]) -> [f64x8; 4] {
    let simd = simd.avx512f;
    let ab = simd._mm512_shuffle_f64x2::<FIRST_PAIRS>(a, b); // a0 a2 b0 b2
    let cd = simd._mm512_shuffle_f64x2::<FIRST_PAIRS>(c, d);
    let first = simd._mm512_shuffle_f64x2::<FIRST_PAIRS>(ab, cd); // a0 b0 c0 d0
    let third = simd._mm512_shuffle_f64x2::<SECOND_PAIRS>(ab, cd);
    let ab = simd._mm512_shuffle_f64x2::<SECOND_PAIRS>(a, b); // a1 a3 b1 b3
    let cd = simd._mm512_shuffle_f64x2::<SECOND_PAIRS>(c, d);
    let second = simd._mm512_shuffle_f64x2::<FIRST_PAIRS>(ab, cd);
    let fourth = simd._mm512_shuffle_f64x2::<SECOND_PAIRS>(ab, cd);
    [cast(first), cast(second), cast(third), cast(fourth)]
}

/// Pairs 0 and 2 of the one register, then of the other; pairs 1 and 3 likewise.
const FIRST_PAIRS: i32 = 0b10_00_10_00;
const SECOND_PAIRS: i32 = 0b11_01_11_01;
