//! The shuffles that turn rows into registers and back, for every level.
//!
//! They name their instructions, through the safe wrappers of the level's token. Loops and operations lane by lane were
//! compiled to gathers and scatters, which took three times as long.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "aarch64")]
mod neon;
mod scalar;

use pulp::Simd;

/// A level with its shuffles.
pub trait Vector: Simd {
    /// `a0 a1 .., b0 b1 ..` to `a0 b0 a1 b1 ..`.
    fn zip(self, registers: [Self::f64s; 2]) -> [Self::f64s; 2];

    /// The reverse of [`Self::zip`].
    fn unzip(self, registers: [Self::f64s; 2]) -> [Self::f64s; 2];

    /// `a0 a1 .., b0 b1 .., c0 c1 ..` to `a0 b0 c0 a1 b1 c1 ..`.
    fn interleave3(self, registers: [Self::f64s; 3]) -> [Self::f64s; 3];

    /// The reverse of [`Self::interleave3`].
    fn deinterleave3(self, registers: [Self::f64s; 3]) -> [Self::f64s; 3];

    /// Every `F64_LANES` of these registers are the rows of a square, and become its columns.
    fn transpose(self, registers: [Self::f64s; 8]) -> [Self::f64s; 8];

    /// `0 .. 0 a0 a1 ..`: every lane `1 << LOG` places on.
    fn shift<const LOG: u32>(self, register: Self::f64s) -> Self::f64s;

    /// The last lane.
    fn last(self, register: Self::f64s) -> f64;

    /// The last lane in every lane.
    fn broadcast_last(self, register: Self::f64s) -> Self::f64s;

    /// True if [`Self::stream`] goes past the caches.
    const STREAMS: bool = false;

    /// Writes a register past the caches.
    ///
    /// # Safety
    ///
    /// `target` begins at a multiple of the size of a register, and nothing reads it before this thread has called
    /// [`Self::store_fence`].
    #[inline(always)]
    unsafe fn stream(self, target: &mut Self::f64s, register: Self::f64s) {
        *target = register;
    }

    /// Waits until the writes of [`Self::stream`] are visible to every thread.
    #[inline(always)]
    fn store_fence(self) {}

    /// Numbers of a table at whole places; at its nearest end where there is none, NaN from an empty one.
    fn gather(self, table: &[f64], places: Self::f64s) -> Self::f64s;

    /// Of a table in rows of so many columns the numbers at whole places, those a column and a row on, and on both; at
    /// its nearest end where there are none. It has at least two of both.
    #[inline(always)]
    fn square(self, table: &[f64], columns: usize, places: Self::f64s) -> [Self::f64s; 4] {
        let next = &table[columns..];
        [
            self.gather(&table[..table.len() - columns - 1], places),
            self.gather(&table[1..table.len() - columns], places),
            self.gather(&next[..next.len() - 1], places),
            self.gather(&next[1..], places),
        ]
    }

    /// One over the square root of positive numbers that are neither tiny nor huge, with an error of some units in the
    /// last place.
    #[inline(always)]
    fn inverse_root(self, numbers: Self::f64s) -> Self::f64s {
        self.div_f64s(self.splat_f64s(1.0), self.sqrt_f64s(numbers))
    }

    /// The inverse square root in single precision: the same bits at every level.
    #[inline(always)]
    fn single_inverse_root(self, numbers: Self::f64s) -> Self::f64s {
        let mut roots = [0.0; 8];
        Self::as_mut_simd_f64s(&mut roots).0[0] = numbers;
        for root in &mut roots[..Self::F64_LANES] {
            *root = f64::from(1.0 / (*root as f32).sqrt());
        }
        Self::as_simd_f64s(&roots).0[0]
    }

    /// One over the square root of numbers from 1e-30 to 1e36, and the root, with an error of up to two units in the
    /// last place: the same bits at every level, and a third of the time of a root and a division of registers of
    /// eight.
    #[inline(always)]
    fn steady_roots(self, numbers: Self::f64s) -> [Self::f64s; 2] {
        let guess = self.single_inverse_root(numbers);
        // The error of the guess falls from 2e-7 to 1e-20.
        let square = self.mul_f64s(numbers, guess);
        let off = self.mul_add_f64s(square, self.neg_f64s(guess), self.splat_f64s(1.0));
        let half = self.mul_add_f64s(off, self.splat_f64s(0.375), self.splat_f64s(0.5));
        let inverse = self.mul_add_f64s(self.mul_f64s(guess, off), half, guess);
        [inverse, self.mul_f64s(numbers, inverse)]
    }

    /// [`Self::steady_roots`] of singles.
    #[inline(always)]
    fn steady_roots_single(self, numbers: Self::f32s) -> [Self::f32s; 2] {
        let root = self.sqrt_f32s(numbers);
        [self.div_f32s(self.splat_f32s(1.0), root), root]
    }

    /// Pairs of single-precision numbers of a table, each pair in the 64 bits of one lane. The index `i` of a pair is
    /// given as `2^52 + i`, whose lowest bits are those of `i`.
    ///
    /// # Safety
    ///
    /// Every index is inside the table.
    unsafe fn pairs(self, table: &[[f32; 2]], places: Self::f64s) -> Self::f64s;

    /// `floor(log2 a)` of numbers above 1e-300.
    fn exponent(self, register: Self::f64s) -> Self::f64s;

    /// Pairs of the lesser first numbers and the lesser second numbers of two pairs in every lane, none of them NaN.
    fn least_pairs(self, a: Self::f64s, b: Self::f64s) -> Self::f64s;

    /// The first numbers of the pairs and the second ones.
    fn deinterleave2(self, pairs: Self::f64s) -> [Self::f64s; 2];

    /// Prefetches the cache line of an address, which need not be mapped.
    #[inline(always)]
    fn prefetch(self, _: *const f64) {}

    /// Values of a grid, row after row, at nodes with the whole coordinates `[x, y]` and their neighbours: `(x, y), (x
    /// + 1, y)` and `(x, y + 1), (x + 1, y + 1)`.
    ///
    /// # Safety
    ///
    /// All four are in the grid, which has less than 2^31 values.
    #[inline(always)]
    unsafe fn corners(self, values: &[f32], columns: usize, place: [Self::f64s; 2]) -> [[Self::f64s; 2]; 2] {
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

    /// [`Self::corners`] in single precision.
    ///
    /// # Safety
    ///
    /// The conditions of [`Self::corners`].
    #[inline(always)]
    unsafe fn corners_single(self, values: &[f32], columns: usize, place: [Self::f32s; 2]) -> [[Self::f32s; 2]; 2] {
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
    let (low, high) = (&values[first..first + 2], &values[first + columns..first + columns + 2]);
    [low[0], low[1], high[0], high[1]]
}

/// A pair of single-precision numbers as the bits of a double.
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

/// One lane of [`Vector::pairs`].
#[inline(always)]
fn pair_at(table: &[[f32; 2]], place: f64) -> f64 {
    let found = table.get((place.to_bits() ^ ZEROTH.to_bits()) as usize);
    pair(found.copied().unwrap_or([f32::NAN; 2]))
}

/// [`Vector::exponent`] of one number.
#[inline(always)]
fn exponent_of(number: f64) -> f64 {
    (number.to_bits() >> 52) as f64 - 1023.0
}

/// The sum of this and a whole number below 2^52 has that number in its lowest bits.
pub const ZEROTH: f64 = 4_503_599_627_370_496.0; // 2^52

#[inline(always)]
fn least_pair(a: f64, b: f64) -> f64 {
    // Compared, not `f32::min`: one instruction, and there is no NaN.
    let pick = |a: f32, b: f32| if a < b { a } else { b };
    let (a, b) = (of_pair(a), of_pair(b));
    pair([pick(a[0], b[0]), pick(a[1], b[1])])
}
