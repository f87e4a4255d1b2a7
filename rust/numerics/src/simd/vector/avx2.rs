//! Registers of four numbers.

use std::arch::x86_64::*;

use pulp::bytemuck::cast;
use pulp::x86::V3;
use pulp::{f32x8, f64x4};

use super::{Vector, ZEROTH};

/// Halves of two registers.
#[inline(always)]
fn halves<const WHICH: i32>(simd: V3, a: __m256d, b: __m256d) -> __m256d {
    simd.avx._mm256_permute2f128_pd::<WHICH>(a, b)
}

/// The first singles of pairs, and the second ones.
const EVEN: i32 = 0b10_00_10_00;
const ODD: i32 = 0b11_01_11_01;

const LOW_LOW: i32 = 0x20;
const HIGH_HIGH: i32 = 0x31;
const LOW_HIGH: i32 = 0x30;
const HIGH_LOW: i32 = 0x21;

/// Columns of four rows.
#[inline(always)]
fn square(simd: V3, [a, b, c, d]: [f64x4; 4]) -> [f64x4; 4] {
    let (a, b, c, d) = (cast(a), cast(b), cast(c), cast(d));
    let low = [
        simd.avx._mm256_unpacklo_pd(a, b), // a0 b0 a2 b2
        simd.avx._mm256_unpacklo_pd(c, d),
    ];
    let high = [
        simd.avx._mm256_unpackhi_pd(a, b), // a1 b1 a3 b3
        simd.avx._mm256_unpackhi_pd(c, d),
    ];
    [
        cast(halves::<LOW_LOW>(simd, low[0], low[1])),
        cast(halves::<LOW_LOW>(simd, high[0], high[1])),
        cast(halves::<HIGH_HIGH>(simd, low[0], low[1])),
        cast(halves::<HIGH_HIGH>(simd, high[0], high[1])),
    ]
}

/// Pairs of numbers at every other place. A closure would not get the instructions of the level.
macro_rules! every_other {
    ($table: ident, $places: ident, $first: literal) => {{
        let a = _mm_loadu_pd($table.add($places[$first]));
        let b = _mm_loadu_pd($table.add($places[$first + 2]));
        _mm256_set_m128d(b, a)
    }};
}

#[inline_always]
impl Vector for V3 {
    fn zip(self, [a, b]: [f64x4; 2]) -> [f64x4; 2] {
        let even = self.avx._mm256_unpacklo_pd(cast(a), cast(b)); // a0 b0 a2 b2
        let odd = self.avx._mm256_unpackhi_pd(cast(a), cast(b)); // a1 b1 a3 b3
        [cast(halves::<LOW_LOW>(self, even, odd)), cast(halves::<HIGH_HIGH>(self, even, odd))]
    }

    fn unzip(self, [a, b]: [f64x4; 2]) -> [f64x4; 2] {
        let low = halves::<LOW_LOW>(self, cast(a), cast(b)); // 0 1 4 5
        let high = halves::<HIGH_HIGH>(self, cast(a), cast(b)); // 2 3 6 7
        [cast(self.avx._mm256_unpacklo_pd(low, high)), cast(self.avx._mm256_unpackhi_pd(low, high))]
    }

    fn interleave3(self, [a, b, c]: [f64x4; 3]) -> [f64x4; 3] {
        let (a, b, c) = (cast(a), cast(b), cast(c));
        let ab = self.avx._mm256_unpacklo_pd(a, b); // a0 b0 a2 b2
        let bc = self.avx._mm256_unpackhi_pd(b, c); // b1 c1 b3 c3
        let ca = self.avx._mm256_shuffle_pd::<0b1010>(c, a); // c0 a1 c2 a3
        [
            cast(halves::<LOW_LOW>(self, ab, ca)),   // a0 b0 c0 a1
            cast(halves::<LOW_HIGH>(self, bc, ab)),  // b1 c1 a2 b2
            cast(halves::<HIGH_HIGH>(self, ca, bc)), // c2 a3 b3 c3
        ]
    }

    fn deinterleave3(self, [first, second, third]: [f64x4; 3]) -> [f64x4; 3] {
        let (first, second, third) = (cast(first), cast(second), cast(third));
        let ab = halves::<LOW_HIGH>(self, first, second); // a0 b0 a2 b2
        let ca = halves::<HIGH_LOW>(self, first, third); // c0 a1 c2 a3
        let bc = halves::<LOW_HIGH>(self, second, third); // b1 c1 b3 c3
        [
            cast(self.avx._mm256_shuffle_pd::<0b1010>(ab, ca)),
            cast(self.avx._mm256_shuffle_pd::<0b0101>(ab, bc)),
            cast(self.avx._mm256_shuffle_pd::<0b1010>(ca, bc)),
        ]
    }

    fn transpose(self, [a, b, c, d, e, f, g, h]: [f64x4; 8]) -> [f64x4; 8] {
        let [a, b, c, d] = square(self, [a, b, c, d]);
        let [e, f, g, h] = square(self, [e, f, g, h]);
        [a, b, c, d, e, f, g, h]
    }

    fn shift<const LOG: u32>(self, register: f64x4) -> f64x4 {
        let register = cast(register);
        let low_up = self.avx._mm256_permute2f128_pd::<0x08>(register, register); // 0 0 a0 a1
        match LOG {
            0 => cast(
                self.avx._mm256_shuffle_pd::<0b0000>(self.avx._mm256_shuffle_pd::<0b0101>(low_up, low_up), register),
            ),
            _ => cast(low_up),
        }
    }

    fn last(self, register: f64x4) -> f64 {
        register.3
    }

    fn broadcast_last(self, register: f64x4) -> f64x4 {
        cast(self.avx2._mm256_permute4x64_pd::<0xFF>(cast(register)))
    }

    const STREAMS: bool = true;

    unsafe fn stream(self, target: &mut f64x4, register: f64x4) {
        let target: *mut _ = target;
        // SAFETY: a reference's memory may be written, and the caller sees to its alignment and the fence.
        unsafe { self.avx._mm256_stream_pd(target.cast(), cast(register)) }
    }

    fn store_fence(self) {
        self.sse._mm_sfence();
    }

    fn gather(self, table: &[f64], places: f64x4) -> f64x4 {
        let Some(last) = table.len().checked_sub(1) else {
            return self.splat_f64x4(f64::NAN);
        };
        let (simd, offset) = (self.avx, self.splat_f64x4(ZEROTH));
        // The second operand where the first is NaN.
        let low = simd._mm256_max_pd(cast(places), cast(self.splat_f64x4(0.0)));
        let near = simd._mm256_min_pd(low, cast(self.splat_f64x4(last as f64)));
        let whole = simd._mm256_add_pd(near, cast(offset));
        let places = self.avx2._mm256_xor_si256(cast(whole), cast(offset));
        // SAFETY: every index is inside the table, by the two comparisons.
        cast(unsafe { self.avx2._mm256_i64gather_pd::<8>(table.as_ptr(), places) })
    }

    /// As with registers of eight.
    fn square(self, table: &[f64], columns: usize, places: f64x4) -> [f64x4; 4] {
        assert!(columns >= 2 && table.len() >= 2 * columns);
        let (simd, offset) = (self.avx, self.splat_f64x4(ZEROTH));
        let last = self.splat_f64x4((table.len() - columns - 2) as f64);
        // The second operand where the first is NaN.
        let low = simd._mm256_max_pd(cast(places), cast(self.splat_f64x4(0.0)));
        let whole = simd._mm256_add_pd(simd._mm256_min_pd(low, cast(last)), cast(offset));
        let at: [usize; 4] = cast(self.avx2._mm256_xor_si256(cast(whole), cast(offset)));
        let (here, next) = (table.as_ptr(), table[columns..].as_ptr());
        // SAFETY: as there.
        unsafe {
            let (even, odd) = (every_other!(here, at, 0), every_other!(here, at, 1));
            let (even_next, odd_next) = (every_other!(next, at, 0), every_other!(next, at, 1));
            [
                cast(_mm256_unpacklo_pd(even, odd)),
                cast(_mm256_unpackhi_pd(even, odd)),
                cast(_mm256_unpacklo_pd(even_next, odd_next)),
                cast(_mm256_unpackhi_pd(even_next, odd_next)),
            ]
        }
    }

    unsafe fn pairs(self, table: &[[f32; 2]], places: f64x4) -> f64x4 {
        let simd = self.avx2;
        let places = simd._mm256_xor_si256(cast(places), cast(self.splat_f64x4(ZEROTH)));
        // SAFETY: the caller keeps every index inside the table, and a pair is as large as a double.
        cast(unsafe { simd._mm256_i64gather_pd::<8>(table.as_ptr().cast(), places) })
    }

    fn exponent(self, register: f64x4) -> f64x4 {
        let zeroth = self.splat_f64x4(ZEROTH);
        let shifted = self.avx2._mm256_srli_epi64::<52>(cast(register));
        let whole = self.avx2._mm256_xor_si256(shifted, cast(zeroth));
        let bias = self.splat_f64x4(ZEROTH + 1023.0);
        cast(self.avx._mm256_sub_pd(cast(whole), cast(bias)))
    }

    fn least_pairs(self, a: f64x4, b: f64x4) -> f64x4 {
        cast(self.avx._mm256_min_ps(cast(a), cast(b)))
    }

    fn deinterleave2(self, pairs: f64x4) -> [f64x4; 2] {
        let (low, high) =
            (self.avx._mm256_castps256_ps128(cast(pairs)), self.avx._mm256_extractf128_ps::<1>(cast(pairs)));
        [
            cast(self.avx._mm256_cvtps_pd(self.sse._mm_shuffle_ps::<EVEN>(low, high))),
            cast(self.avx._mm256_cvtps_pd(self.sse._mm_shuffle_ps::<ODD>(low, high))),
        ]
    }

    fn single_inverse_root(self, numbers: f64x4) -> f64x4 {
        // SAFETY: the token is that of the level.
        unsafe {
            let root = _mm_sqrt_ps(_mm256_cvtpd_ps(cast(numbers)));
            cast(_mm256_cvtps_pd(_mm_div_ps(_mm_set1_ps(1.0), root)))
        }
    }

    fn prefetch(self, address: *const f64) {
        self.sse._mm_prefetch::<_MM_HINT_T0>(address.cast());
    }

    unsafe fn corners(self, values: &[f32], columns: usize, [x, y]: [f64x4; 2]) -> [[f64x4; 2]; 2] {
        let first = values.as_ptr();
        // SAFETY: the token is that of the level, and the caller sees to the places.
        unsafe {
            let (x, y) = (_mm256_cvttpd_epi32(cast(x)), _mm256_cvttpd_epi32(cast(y)));
            let at = _mm_add_epi32(_mm_mullo_epi32(y, _mm_set1_epi32(columns as i32)), x);
            let take = |first: *const f32| cast(_mm256_cvtps_pd(_mm_i32gather_ps::<4>(first, at)));
            let row = |first: *const f32| [take(first), take(first.add(1))];
            [row(first), row(first.add(columns))]
        }
    }

    unsafe fn corners_single(self, values: &[f32], columns: usize, [x, y]: [f32x8; 2]) -> [[f32x8; 2]; 2] {
        let first = values.as_ptr();
        // SAFETY: as above.
        unsafe {
            let (x, y) = (_mm256_cvttps_epi32(cast(x)), _mm256_cvttps_epi32(cast(y)));
            let at = _mm256_add_epi32(_mm256_mullo_epi32(y, _mm256_set1_epi32(columns as i32)), x);
            let take = |first: *const f32| cast(_mm256_i32gather_ps::<4>(first, at));
            let row = |first: *const f32| [take(first), take(first.add(1))];
            [row(first), row(first.add(columns))]
        }
    }
}
