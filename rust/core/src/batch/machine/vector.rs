//! The shuffles that turn rows into registers and back, for every level.
//!
//! They name their instructions, through the safe wrappers of the level's token. Written as loops or lane
//! by lane, the compiler turned them into gathers and scatters at three times the cost.

use pulp::{Scalar, Simd};

/// A level with its shuffles.
pub(crate) trait Vector: Simd {
    /// `a0 a1 .., b0 b1 ..` to `a0 b0 a1 b1 ..`.
    fn zip(self, registers: [Self::f64s; 2]) -> [Self::f64s; 2];

    /// The reverse of [`Self::zip`].
    fn unzip(self, registers: [Self::f64s; 2]) -> [Self::f64s; 2];

    /// `a0 a1 .., b0 b1 .., c0 c1 ..` to `a0 b0 c0 a1 b1 c1 ..`.
    fn braid(self, registers: [Self::f64s; 3]) -> [Self::f64s; 3];

    /// The reverse of [`Self::braid`].
    fn unbraid(self, registers: [Self::f64s; 3]) -> [Self::f64s; 3];

    /// Every `F64_LANES` of these registers are the rows of a square, and become its columns.
    fn transpose(self, registers: [Self::f64s; 8]) -> [Self::f64s; 8];

    /// `0 .. 0 a0 a1 ..`: every lane `1 << LOG` places on.
    fn shift<const LOG: u32>(self, register: Self::f64s) -> Self::f64s;

    /// The last lane.
    fn last(self, register: Self::f64s) -> f64;

    /// The last lane in every lane.
    fn spread(self, register: Self::f64s) -> Self::f64s;

    /// Whether [`Self::stream`] goes past the caches.
    const STREAMS: bool;

    /// Writes a register past the caches.
    ///
    /// # Safety
    ///
    /// `target` begins where a register may be stored whole, at a multiple of its size, and nobody looks at it
    /// before this thread has called [`Self::fence`].
    unsafe fn stream(self, target: &mut Self::f64s, register: Self::f64s);

    /// Waits until what [`Self::stream`] wrote is there for all to see.
    fn fence(self);

    /// Numbers of a table at whole places; at its nearest end where there is none, NaN from an empty one.
    fn gather(self, table: &[f64], places: Self::f64s) -> Self::f64s;

    /// One over the square root of positive numbers that are neither tiny nor huge, to some last places.
    #[inline(always)]
    fn inverse_root(self, numbers: Self::f64s) -> Self::f64s {
        self.div_f64s(self.splat_f64s(1.0), self.sqrt_f64s(numbers))
    }

    /// Pairs of singles of a table, each as it is in the bits of its lane. Places are counted from `2^52`, with whose
    /// bits they are as they are.
    ///
    /// # Safety
    ///
    /// The table has all the places.
    unsafe fn pairs(self, table: &[[f32; 2]], places: Self::f64s) -> Self::f64s;

    /// Of positive numbers above 1e-300 the largest whole power of two that they reach, as its exponent.
    fn exponent(self, register: Self::f64s) -> Self::f64s;

    /// Of two pairs in every lane the lesser first numbers and the lesser second ones, none of them NaN.
    fn least_pairs(self, a: Self::f64s, b: Self::f64s) -> Self::f64s;

    /// The first numbers of the pairs and the second ones.
    fn unpair(self, pairs: Self::f64s) -> [Self::f64s; 2];

    /// Asks for the line of an address, which need not be one.
    fn fetch(self, address: *const f64);

    /// Values of a grid, row after row, at whole places `[x, y]` that are in it with their neighbours: of each place
    /// and the next one in its row, and the two above.
    ///
    /// # Safety
    ///
    /// They are in the grid, which has less than 2^31 values.
    #[inline(always)]
    unsafe fn corners(
        self,
        values: &[f32],
        columns: usize,
        place: [Self::f64s; 2],
    ) -> [[Self::f64s; 2]; 2] {
        let mut places = [[0.0; 8]; 2];
        for (to, from) in places.iter_mut().zip(place) {
            Self::as_mut_simd_f64s(to).0[0] = from;
        }
        let mut cells = [[0.0; 8]; 4];
        for lane in 0..Self::F64_LANES {
            let [x, y] = places.map(|place: [f64; 8]| place[lane] as usize);
            for (cell, value) in cells.iter_mut().zip(around(values, columns, x, y)) {
                cell[lane] = value.into();
            }
        }
        let [a, b, c, d] = cells.map(|cell| Self::as_simd_f64s(&cell).0[0]);
        [[a, b], [c, d]]
    }

    /// The same in single precision.
    ///
    /// # Safety
    ///
    /// As [`Self::corners`].
    #[inline(always)]
    unsafe fn corners_single(
        self,
        values: &[f32],
        columns: usize,
        place: [Self::f32s; 2],
    ) -> [[Self::f32s; 2]; 2] {
        let mut places = [[0.0; 16]; 2];
        for (to, from) in places.iter_mut().zip(place) {
            Self::as_mut_simd_f32s(to).0[0] = from;
        }
        let mut cells = [[0.0; 16]; 4];
        for lane in 0..Self::F32_LANES {
            let [x, y] = places.map(|place: [f32; 16]| place[lane] as usize);
            for (cell, value) in cells.iter_mut().zip(around(values, columns, x, y)) {
                cell[lane] = value;
            }
        }
        let [a, b, c, d] = cells.map(|cell| Self::as_simd_f32s(&cell).0[0]);
        [[a, b], [c, d]]
    }
}

#[inline(always)]
fn around(values: &[f32], columns: usize, x: usize, y: usize) -> [f32; 4] {
    let first = y * columns + x;
    let (low, high) = (
        &values[first..first + 2],
        &values[first + columns..first + columns + 2],
    );
    [low[0], low[1], high[0], high[1]]
}

/// A pair in the bits of a lane.
#[inline(always)]
fn pair([first, second]: [f32; 2]) -> f64 {
    f64::from_bits(u64::from(first.to_bits()) | u64::from(second.to_bits()) << 32)
}

/// The reverse of [`pair`].
#[inline(always)]
fn of_pair(pair: f64) -> [f32; 2] {
    let bits = pair.to_bits();
    [bits as u32, (bits >> 32) as u32].map(f32::from_bits)
}

/// What a lane of [`Vector::pairs`] holds.
#[inline(always)]
fn pair_at(table: &[[f32; 2]], place: f64) -> f64 {
    let found = table.get((place.to_bits() ^ ZEROTH.to_bits()) as usize);
    pair(found.copied().unwrap_or([f32::NAN; 2]))
}

/// What [`Vector::exponent`] is of one number.
#[inline(always)]
fn exponent_of(number: f64) -> f64 {
    (number.to_bits() >> 52) as f64 - 1023.0
}

/// Whole numbers below 2^52 added to this are in its last bits.
pub(crate) const ZEROTH: f64 = 4_503_599_627_370_496.0; // 2^52

#[inline(always)]
fn least_pair(a: f64, b: f64) -> f64 {
    // Compared, not `f32::min`: one instruction, and there is no NaN.
    let pick = |a: f32, b: f32| if a < b { a } else { b };
    let (a, b) = (of_pair(a), of_pair(b));
    pair([pick(a[0], b[0]), pick(a[1], b[1])])
}

/// One number at a time.
impl Vector for Scalar {
    #[inline(always)]
    fn zip(self, pair: [f64; 2]) -> [f64; 2] {
        pair
    }

    #[inline(always)]
    fn unzip(self, pair: [f64; 2]) -> [f64; 2] {
        pair
    }

    #[inline(always)]
    fn braid(self, registers: [f64; 3]) -> [f64; 3] {
        registers
    }

    #[inline(always)]
    fn unbraid(self, registers: [f64; 3]) -> [f64; 3] {
        registers
    }

    #[inline(always)]
    fn transpose(self, rows: [f64; 8]) -> [f64; 8] {
        rows
    }

    #[inline(always)]
    fn shift<const LOG: u32>(self, _: f64) -> f64 {
        0.0
    }

    #[inline(always)]
    fn last(self, register: f64) -> f64 {
        register
    }

    #[inline(always)]
    fn spread(self, register: f64) -> f64 {
        register
    }

    const STREAMS: bool = false;

    #[inline(always)]
    unsafe fn stream(self, target: &mut f64, register: f64) {
        *target = register;
    }

    #[inline(always)]
    fn fence(self) {}

    #[inline(always)]
    fn gather(self, table: &[f64], place: f64) -> f64 {
        let last = table.len().saturating_sub(1);
        table
            .get((place as usize).min(last))
            .copied()
            .unwrap_or(f64::NAN)
    }

    #[inline(always)]
    unsafe fn pairs(self, table: &[[f32; 2]], place: f64) -> f64 {
        pair_at(table, place)
    }

    #[inline(always)]
    fn exponent(self, number: f64) -> f64 {
        exponent_of(number)
    }

    #[inline(always)]
    fn least_pairs(self, a: f64, b: f64) -> f64 {
        least_pair(a, b)
    }

    #[inline(always)]
    fn unpair(self, pair: f64) -> [f64; 2] {
        of_pair(pair).map(f64::from)
    }

    #[inline(always)]
    fn fetch(self, _: *const f64) {}
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use pulp::bytemuck::cast;
    use pulp::x86::{V3, V4};
    use pulp::{f32x8, f32x16, f64x4, f64x8};

    use super::{Vector, ZEROTH};

    /// Lanes of two registers, those of the second counted from 8.
    #[inline(always)]
    fn pick(simd: V4, [a, b]: [f64x8; 2], lanes: [i64; 8]) -> f64x8 {
        cast(
            simd.avx512f
                ._mm512_permutex2var_pd(cast(a), cast(lanes), cast(b)),
        )
    }

    impl Vector for V4 {
        #[inline(always)]
        fn zip(self, pair: [f64x8; 2]) -> [f64x8; 2] {
            [
                pick(self, pair, [0, 8, 1, 9, 2, 10, 3, 11]),
                pick(self, pair, [4, 12, 5, 13, 6, 14, 7, 15]),
            ]
        }

        #[inline(always)]
        fn unzip(self, pair: [f64x8; 2]) -> [f64x8; 2] {
            [
                pick(self, pair, [0, 2, 4, 6, 8, 10, 12, 14]),
                pick(self, pair, [1, 3, 5, 7, 9, 11, 13, 15]),
            ]
        }

        #[inline(always)]
        fn braid(self, [a, b, c]: [f64x8; 3]) -> [f64x8; 3] {
            let first = pick(self, [a, b], [0, 8, 0, 1, 9, 0, 2, 10]);
            let second = pick(self, [a, b], [0, 3, 11, 0, 4, 12, 0, 5]);
            let third = pick(self, [a, b], [13, 0, 6, 14, 0, 7, 15, 0]);
            [
                pick(self, [first, c], [0, 1, 8, 3, 4, 9, 6, 7]),
                pick(self, [second, c], [10, 1, 2, 11, 4, 5, 12, 7]),
                pick(self, [third, c], [0, 13, 2, 3, 14, 5, 6, 15]),
            ]
        }

        #[inline(always)]
        fn unbraid(self, [a, b, c]: [f64x8; 3]) -> [f64x8; 3] {
            let first = pick(self, [a, b], [0, 3, 6, 9, 12, 15, 0, 0]);
            let second = pick(self, [a, b], [1, 4, 7, 10, 13, 0, 0, 0]);
            let third = pick(self, [a, b], [2, 5, 8, 11, 14, 0, 0, 0]);
            [
                pick(self, [first, c], [0, 1, 2, 3, 4, 5, 10, 13]),
                pick(self, [second, c], [0, 1, 2, 3, 4, 8, 11, 14]),
                pick(self, [third, c], [0, 1, 2, 3, 4, 9, 12, 15]),
            ]
        }

        #[inline(always)]
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

        #[inline(always)]
        fn shift<const LOG: u32>(self, register: f64x8) -> f64x8 {
            let pair = [register, self.splat_f64x8(0.0)];
            match LOG {
                0 => pick(self, pair, [8, 0, 1, 2, 3, 4, 5, 6]),
                1 => pick(self, pair, [8, 8, 0, 1, 2, 3, 4, 5]),
                _ => pick(self, pair, [8, 8, 8, 8, 0, 1, 2, 3]),
            }
        }

        #[inline(always)]
        fn last(self, register: f64x8) -> f64 {
            register.7
        }

        #[inline(always)]
        fn spread(self, register: f64x8) -> f64x8 {
            pick(self, [register, register], [7; 8])
        }

        const STREAMS: bool = true;

        #[inline(always)]
        unsafe fn stream(self, target: &mut f64x8, register: f64x8) {
            let target: *mut _ = target;
            // SAFETY: a reference's memory may be written, and the caller sees to its alignment and the fence.
            unsafe { self.avx512f._mm512_stream_pd(target.cast(), cast(register)) }
        }

        #[inline(always)]
        fn fence(self) {
            self.sse._mm_sfence();
        }

        #[inline(always)]
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
            // SAFETY: every place is one of the table's, by the two comparisons.
            cast(unsafe { simd._mm512_i64gather_pd::<8>(places, table.as_ptr()) })
        }

        /// By an estimate of 14 bits, and two steps of Newton's method: a root and a quotient hold up all others.
        #[inline(always)]
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

        #[inline(always)]
        unsafe fn pairs(self, table: &[[f32; 2]], places: f64x8) -> f64x8 {
            let simd = self.avx512f;
            let places = simd._mm512_xor_si512(cast(places), cast(self.splat_f64x8(ZEROTH)));
            // SAFETY: the caller sees to the places, and a pair is as large as a double.
            cast(unsafe { simd._mm512_i64gather_pd::<8>(places, table.as_ptr().cast()) })
        }

        #[inline(always)]
        fn exponent(self, register: f64x8) -> f64x8 {
            cast(self.avx512f._mm512_getexp_pd(cast(register)))
        }

        #[inline(always)]
        fn least_pairs(self, a: f64x8, b: f64x8) -> f64x8 {
            cast(self.avx512f._mm512_min_ps(cast(a), cast(b)))
        }

        #[inline(always)]
        fn unpair(self, pairs: f64x8) -> [f64x8; 2] {
            let simd = self.avx512f;
            let first = simd._mm512_cvtepi64_epi32(cast(pairs));
            let second = simd._mm512_cvtepi64_epi32(simd._mm512_srli_epi64::<32>(cast(pairs)));
            [
                cast(simd._mm512_cvtps_pd(cast(first))),
                cast(simd._mm512_cvtps_pd(cast(second))),
            ]
        }

        #[inline(always)]
        fn fetch(self, address: *const f64) {
            self.sse._mm_prefetch::<_MM_HINT_T0>(address.cast());
        }

        #[inline(always)]
        unsafe fn corners(
            self,
            values: &[f32],
            columns: usize,
            [x, y]: [f64x8; 2],
        ) -> [[f64x8; 2]; 2] {
            let first = values.as_ptr();
            // SAFETY: the token is that of the level, and the caller sees to the places.
            unsafe {
                let (x, y) = (_mm512_cvttpd_epi32(cast(x)), _mm512_cvttpd_epi32(cast(y)));
                let at =
                    _mm256_add_epi32(_mm256_mullo_epi32(y, _mm256_set1_epi32(columns as i32)), x);
                // Two values at a time.
                let row = |first: *const f32| {
                    let pairs = _mm512_i32gather_epi64::<4>(at, first.cast());
                    let half =
                        |pairs| _mm512_cvtps_pd(_mm256_castsi256_ps(_mm512_cvtepi64_epi32(pairs)));
                    [
                        cast(half(pairs)),
                        cast(half(_mm512_srli_epi64::<32>(pairs))),
                    ]
                };
                [row(first), row(first.add(columns))]
            }
        }

        #[inline(always)]
        unsafe fn corners_single(
            self,
            values: &[f32],
            columns: usize,
            [x, y]: [f32x16; 2],
        ) -> [[f32x16; 2]; 2] {
            let first = values.as_ptr();
            // SAFETY: as above.
            unsafe {
                let (x, y) = (_mm512_cvttps_epi32(cast(x)), _mm512_cvttps_epi32(cast(y)));
                let at =
                    _mm512_add_epi32(_mm512_mullo_epi32(y, _mm512_set1_epi32(columns as i32)), x);
                let halves = [
                    _mm512_castsi512_si256(at),
                    _mm512_extracti64x4_epi64::<1>(at),
                ];
                let even =
                    _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
                let odd = _mm512_add_epi32(even, _mm512_set1_epi32(1));
                let row = |first: *const f32| {
                    let [a, b] = halves.map(|at| {
                        _mm512_castsi512_ps(_mm512_i32gather_epi64::<4>(at, first.cast()))
                    });
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

    impl Vector for V3 {
        #[inline(always)]
        fn zip(self, [a, b]: [f64x4; 2]) -> [f64x4; 2] {
            let even = self.avx._mm256_unpacklo_pd(cast(a), cast(b)); // a0 b0 a2 b2
            let odd = self.avx._mm256_unpackhi_pd(cast(a), cast(b)); // a1 b1 a3 b3
            [
                cast(halves::<LOW_LOW>(self, even, odd)),
                cast(halves::<HIGH_HIGH>(self, even, odd)),
            ]
        }

        #[inline(always)]
        fn unzip(self, [a, b]: [f64x4; 2]) -> [f64x4; 2] {
            let low = halves::<LOW_LOW>(self, cast(a), cast(b)); // 0 1 4 5
            let high = halves::<HIGH_HIGH>(self, cast(a), cast(b)); // 2 3 6 7
            [
                cast(self.avx._mm256_unpacklo_pd(low, high)),
                cast(self.avx._mm256_unpackhi_pd(low, high)),
            ]
        }

        #[inline(always)]
        fn braid(self, [a, b, c]: [f64x4; 3]) -> [f64x4; 3] {
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

        #[inline(always)]
        fn unbraid(self, [first, second, third]: [f64x4; 3]) -> [f64x4; 3] {
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

        #[inline(always)]
        fn transpose(self, [a, b, c, d, e, f, g, h]: [f64x4; 8]) -> [f64x4; 8] {
            let [a, b, c, d] = square(self, [a, b, c, d]);
            let [e, f, g, h] = square(self, [e, f, g, h]);
            [a, b, c, d, e, f, g, h]
        }

        #[inline(always)]
        fn shift<const LOG: u32>(self, register: f64x4) -> f64x4 {
            let register = cast(register);
            let low_up = self.avx._mm256_permute2f128_pd::<0x08>(register, register); // 0 0 a0 a1
            match LOG {
                0 => cast(self.avx._mm256_shuffle_pd::<0b0000>(
                    self.avx._mm256_shuffle_pd::<0b0101>(low_up, low_up),
                    register,
                )),
                _ => cast(low_up),
            }
        }

        #[inline(always)]
        fn last(self, register: f64x4) -> f64 {
            register.3
        }

        #[inline(always)]
        fn spread(self, register: f64x4) -> f64x4 {
            cast(self.avx2._mm256_permute4x64_pd::<0xFF>(cast(register)))
        }

        const STREAMS: bool = true;

        #[inline(always)]
        unsafe fn stream(self, target: &mut f64x4, register: f64x4) {
            let target: *mut _ = target;
            // SAFETY: a reference's memory may be written, and the caller sees to its alignment and the fence.
            unsafe { self.avx._mm256_stream_pd(target.cast(), cast(register)) }
        }

        #[inline(always)]
        fn fence(self) {
            self.sse._mm_sfence();
        }

        #[inline(always)]
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
            // SAFETY: every place is one of the table's, by the two comparisons.
            cast(unsafe { self.avx2._mm256_i64gather_pd::<8>(table.as_ptr(), places) })
        }

        #[inline(always)]
        unsafe fn pairs(self, table: &[[f32; 2]], places: f64x4) -> f64x4 {
            let simd = self.avx2;
            let places = simd._mm256_xor_si256(cast(places), cast(self.splat_f64x4(ZEROTH)));
            // SAFETY: the caller sees to the places, and a pair is as large as a double.
            cast(unsafe { simd._mm256_i64gather_pd::<8>(table.as_ptr().cast(), places) })
        }

        #[inline(always)]
        fn exponent(self, register: f64x4) -> f64x4 {
            let zeroth = self.splat_f64x4(ZEROTH);
            let shifted = self.avx2._mm256_srli_epi64::<52>(cast(register));
            let whole = self.avx2._mm256_xor_si256(shifted, cast(zeroth));
            let bias = self.splat_f64x4(ZEROTH + 1023.0);
            cast(self.avx._mm256_sub_pd(cast(whole), cast(bias)))
        }

        #[inline(always)]
        fn least_pairs(self, a: f64x4, b: f64x4) -> f64x4 {
            cast(self.avx._mm256_min_ps(cast(a), cast(b)))
        }

        #[inline(always)]
        fn unpair(self, pairs: f64x4) -> [f64x4; 2] {
            let (low, high) = (
                self.avx._mm256_castps256_ps128(cast(pairs)),
                self.avx._mm256_extractf128_ps::<1>(cast(pairs)),
            );
            [
                cast(
                    self.avx
                        ._mm256_cvtps_pd(self.sse._mm_shuffle_ps::<EVEN>(low, high)),
                ),
                cast(
                    self.avx
                        ._mm256_cvtps_pd(self.sse._mm_shuffle_ps::<ODD>(low, high)),
                ),
            ]
        }

        #[inline(always)]
        fn fetch(self, address: *const f64) {
            self.sse._mm_prefetch::<_MM_HINT_T0>(address.cast());
        }

        #[inline(always)]
        unsafe fn corners(
            self,
            values: &[f32],
            columns: usize,
            [x, y]: [f64x4; 2],
        ) -> [[f64x4; 2]; 2] {
            let first = values.as_ptr();
            // SAFETY: the token is that of the level, and the caller sees to the places.
            unsafe {
                let (x, y) = (_mm256_cvttpd_epi32(cast(x)), _mm256_cvttpd_epi32(cast(y)));
                let at = _mm_add_epi32(_mm_mullo_epi32(y, _mm_set1_epi32(columns as i32)), x);
                let take =
                    |first: *const f32| cast(_mm256_cvtps_pd(_mm_i32gather_ps::<4>(first, at)));
                let row = |first: *const f32| [take(first), take(first.add(1))];
                [row(first), row(first.add(columns))]
            }
        }

        #[inline(always)]
        unsafe fn corners_single(
            self,
            values: &[f32],
            columns: usize,
            [x, y]: [f32x8; 2],
        ) -> [[f32x8; 2]; 2] {
            let first = values.as_ptr();
            // SAFETY: as above.
            unsafe {
                let (x, y) = (_mm256_cvttps_epi32(cast(x)), _mm256_cvttps_epi32(cast(y)));
                let at =
                    _mm256_add_epi32(_mm256_mullo_epi32(y, _mm256_set1_epi32(columns as i32)), x);
                let take = |first: *const f32| cast(_mm256_i32gather_ps::<4>(first, at));
                let row = |first: *const f32| [take(first), take(first.add(1))];
                [row(first), row(first.add(columns))]
            }
        }
    }
}

#[cfg(target_arch = "aarch64")]
mod aarch64 {
    use pulp::aarch64::Neon;
    use pulp::f64x2;

    use super::{Vector, exponent_of, least_pair, of_pair, pair_at};

    impl Vector for Neon {
        #[inline(always)]
        fn zip(self, [a, b]: [f64x2; 2]) -> [f64x2; 2] {
            [f64x2(a.0, b.0), f64x2(a.1, b.1)]
        }

        #[inline(always)]
        fn unzip(self, pair: [f64x2; 2]) -> [f64x2; 2] {
            self.zip(pair)
        }

        #[inline(always)]
        fn braid(self, [a, b, c]: [f64x2; 3]) -> [f64x2; 3] {
            [f64x2(a.0, b.0), f64x2(c.0, a.1), f64x2(b.1, c.1)]
        }

        #[inline(always)]
        fn unbraid(self, [a, b, c]: [f64x2; 3]) -> [f64x2; 3] {
            [f64x2(a.0, b.1), f64x2(a.1, c.0), f64x2(b.0, c.1)]
        }

        #[inline(always)]
        fn transpose(self, [a, b, c, d, e, f, g, h]: [f64x2; 8]) -> [f64x2; 8] {
            let ([a, b], [c, d]) = (self.zip([a, b]), self.zip([c, d]));
            let ([e, f], [g, h]) = (self.zip([e, f]), self.zip([g, h]));
            [a, b, c, d, e, f, g, h]
        }

        #[inline(always)]
        fn shift<const LOG: u32>(self, register: f64x2) -> f64x2 {
            f64x2(0.0, register.0)
        }

        #[inline(always)]
        fn last(self, register: f64x2) -> f64 {
            register.1
        }

        #[inline(always)]
        fn spread(self, register: f64x2) -> f64x2 {
            f64x2(register.1, register.1)
        }

        const STREAMS: bool = false;

        #[inline(always)]
        unsafe fn stream(self, target: &mut f64x2, register: f64x2) {
            *target = register;
        }

        #[inline(always)]
        fn fence(self) {}

        #[inline(always)]
        fn gather(self, table: &[f64], places: f64x2) -> f64x2 {
            let Some(last) = table.len().checked_sub(1) else {
                return f64x2(f64::NAN, f64::NAN);
            };
            let at = |place: f64| table[(place as usize).min(last)]; // NaN is 0
            f64x2(at(places.0), at(places.1))
        }

        #[inline(always)]
        unsafe fn pairs(self, table: &[[f32; 2]], places: f64x2) -> f64x2 {
            f64x2(pair_at(table, places.0), pair_at(table, places.1))
        }

        #[inline(always)]
        fn exponent(self, numbers: f64x2) -> f64x2 {
            f64x2(exponent_of(numbers.0), exponent_of(numbers.1))
        }

        #[inline(always)]
        fn least_pairs(self, a: f64x2, b: f64x2) -> f64x2 {
            f64x2(least_pair(a.0, b.0), least_pair(a.1, b.1))
        }

        #[inline(always)]
        fn unpair(self, pairs: f64x2) -> [f64x2; 2] {
            let ([a, c], [b, d]) = (of_pair(pairs.0), of_pair(pairs.1));
            [f64x2(a.into(), b.into()), f64x2(c.into(), d.into())]
        }

        #[inline(always)]
        fn fetch(self, _: *const f64) {}
    }
}
