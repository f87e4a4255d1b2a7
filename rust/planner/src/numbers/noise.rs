//! Normal noise of a counter-based generator: the noise of a rollout at a step is a function of the seed, the cycle,
//! the number of the rollout and the step alone, so it does not depend on threads or on the level.
//!
//! Source: J. Salmon et al., Parallel random numbers: as easy as 1, 2, 3, SC 2011 (Philox4x32-7, which passes BigCrush);
//! G. Box & M. Muller, A note on the generation of random normal deviates, Ann. Math. Stat. 29(2), 1958.

use pulp::Simd;

use crate::numbers::BLOCK;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::{horner, taylor};

/// Rounds of the generator: the fewest that pass BigCrush.
pub(crate) const ROUNDS: u32 = 7;
const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];

/// `ln(1 + f) / f` for `1 + f` between the roots of 1/2 and 2, to 2e-8.
const LN: [f64; 9] = [
    0.999_999_97,
    -0.499_999_96,
    0.333_341_93,
    -0.250_013_52,
    0.199_559_33,
    -0.165_779_92,
    0.149_774_01,
    -0.142_692_58,
    0.085_333_13,
];
/// `sin x / x` and `cos x` up to an eighth of a turn, in powers of the square.
const SIN: [f64; 5] = taylor(1);
const COS: [f64; 6] = taylor(0);

/// Counter of the random numbers of one block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhiloxCounter {
    pub seed: u64,
    pub cycle: u32,
    /// First rollout of the block.
    pub first: u32,
}

/// A register of words of 32 bits.
#[derive(Clone, Copy)]
struct RandomWords<S: Simd>(S, S::u32s);

#[inline_always]
impl<S: Simd> RandomWords<S> {
    fn all(simd: S, word: u32) -> Self {
        Self(simd, simd.splat_u32s(word))
    }
    fn xor(self, other: Self) -> Self {
        Self(self.0, self.0.xor_u32s(self.1, other.1))
    }
    fn and(self, word: u32) -> Self {
        Self(self.0, self.0.and_u32s(self.1, self.0.splat_u32s(word)))
    }
    fn or(self, word: u32) -> Self {
        Self(self.0, self.0.or_u32s(self.1, self.0.splat_u32s(word)))
    }
    fn minus(self, word: u32) -> Self {
        Self(self.0, self.0.sub_u32s(self.1, self.0.splat_u32s(word)))
    }
    fn real(self) -> Lanes<S, f32> {
        Lanes::from_bits(self.0, self.1)
    }
    fn shift_right(self, by: u32) -> Self {
        let by = self.0.splat_u32s(by);
        Self(self.0, self.0.wrapping_dyn_shr_u32s(self.1, by))
    }
    fn shift_left(self, by: u32) -> Self {
        let by = self.0.splat_u32s(by);
        Self(self.0, self.0.wrapping_dyn_shl_u32s(self.1, by))
    }
    /// Lanes in which the bit is set.
    fn has(self, bit: u32) -> Mask<S, f32> {
        let Self(simd, word) = self.and(bit);
        Mask::from_bits(simd, word)
    }
}

/// Philox4x32 of a register of counters.
#[inline(always)]
fn philox<S: Simd>(simd: S, mut x: [RandomWords<S>; 4], seed: u64) -> [RandomWords<S>; 4] {
    let [mut k0, mut k1] = [seed as u32, (seed >> 32) as u32];
    let (m0, m1) = (simd.splat_u32s(MULTIPLIERS[0]), simd.splat_u32s(MULTIPLIERS[1]));
    for _ in 0..ROUNDS {
        let (low0, high0) = simd.widening_mul_u32s(x[0].1, m0);
        let (low1, high1) = simd.widening_mul_u32s(x[2].1, m1);
        x = [
            RandomWords(simd, high1).xor(x[1]).xor(RandomWords::all(simd, k0)),
            RandomWords(simd, low1),
            RandomWords(simd, high0).xor(x[3]).xor(RandomWords::all(simd, k1)),
            RandomWords(simd, low0),
        ];
        (k0, k1) = (k0.wrapping_add(WEYL[0]), k1.wrapping_add(WEYL[1]));
    }
    x
}

/// 23 bits as the fraction of a float of [1, 2), less 1: exact.
#[inline(always)]
fn fraction<S: Simd>(word: RandomWords<S>) -> Lanes<S, f32> {
    word.shift_right(9).or(0x3F80_0000).real() - Lanes::splat(word.0, 1.0)
}

/// Two normal numbers of two words.
#[inline(always)]
fn normal<S: Simd>(simd: S, a: RandomWords<S>, b: RandomWords<S>) -> [Lanes<S, f32>; 2] {
    let number = |value: f32| Lanes::<S, f32>::splat(simd, value);
    let uniform = fraction(a) + number(0.5 / 8_388_608.0); // of (0, 1)
    // Exponent and fraction, the latter between the roots of 1/2 and 2.
    let bits = RandomWords(simd, uniform.to_bits());
    let from = bits.minus(0x3F35_04F3);
    let exponent = from.shift_right(23);
    let f = RandomWords(simd, simd.sub_u32s(bits.1, exponent.shift_left(23).1)).real() - number(1.0);
    // Nine bits in two's complement, counted from 256 on: the lowest ones of 2^23 as a float.
    let k = exponent.xor(RandomWords::all(simd, 0x100)).or(0x4B00_0000);
    let k = k.real() - number(8_388_608.0 + 256.0);
    let log = horner(simd, LN, f).mul_add(f, k * number(std::f32::consts::LN_2));
    let radius = (log * number(-2.0)).max(number(0.0)).sqrt();
    // An angle within an eighth of a turn of an axis, the axis, and the side of it.
    let x = (fraction(b.shift_left(2)) - number(0.5)) * number(std::f32::consts::FRAC_PI_2);
    let square = x * x;
    let sin = horner(simd, SIN, square) * x;
    let cos = horner(simd, COS, square);
    let radius = radius.xor_sign(b.and(0x8000_0000).real());
    let swap = b.has(1 << 30);
    [radius * swap.select(cos, sin), radius * swap.select(sin, cos)]
}

/// Numbers of mean 0 and variance 1 for a block of rollouts: `[step][component][rollout]`.
#[inline(always)]
pub(crate) fn fill<S: Simd>(simd: S, counter: PhiloxCounter, components: usize, steps: usize, to: &mut [f32]) {
    let lanes = S::F32_LANES;
    let mut who = [0_u32; BLOCK];
    for (k, who) in who.iter_mut().enumerate() {
        *who = counter.first.wrapping_add(k as u32);
    }
    let count = components * steps;
    // Four words are two pairs of numbers.
    for quad in 0..count.div_ceil(4) {
        for at in (0..BLOCK).step_by(lanes) {
            let rollout = RandomWords(simd, S::as_simd_u32s(&who[at..at + lanes]).0[0]);
            let x = [
                rollout,
                RandomWords::all(simd, quad as u32),
                RandomWords::all(simd, counter.cycle),
                RandomWords::all(simd, 0),
            ];
            let [a, b, c, d] = philox(simd, x, counter.seed);
            let pairs = [normal(simd, a, b), normal(simd, c, d)];
            for (k, value) in pairs.into_iter().flatten().enumerate() {
                let row = 4 * quad + k;
                if row < count {
                    value.copy_to_slice(&mut to[row * BLOCK + at..]);
                }
            }
        }
    }
}
