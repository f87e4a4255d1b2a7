//! The two precisions: every operation of a level under one name for `f32` and `f64`.

use pulp::Simd;

use super::vector::Vector;

/// Declares [`Float`] and implements it. Every line is an operation on registers, with pulp's name for it in double and in
/// single precision; the first two lists are the numbers and functions that differ in more than that.
macro_rules! float {
    ($($(#[$doc:meta])* $name:ident($($in:ident: $kind:ident),*) -> $out:ident = $double:ident, $single:ident;)*) => {
        /// A precision: `f64` or `f32`. Operations differ between levels in the number of lanes alone.
        pub trait Float: Copy + Default + PartialOrd + From<f32> + Into<f64> + Send + Sync + 'static {
            /// A register of a level.
            type Register<S: Simd>: Copy;
            /// One truth value for each.
            type Mask<S: Simd>: Copy;

            /// The number whose bits are all set but the sign.
            const ABS: Self;
            /// Numbers of this size and more have no fraction.
            const INTEGERS: f64;
            /// `1.5 INTEGERS`: adding it brings the nearest whole number, of either sign, into the lowest bits.
            const ROUND: f64;
            /// A quarter turn in three parts, each the rounding error of the sum before it.
            const QUARTER_TURN: [f64; 3];
            /// Smallest square that it is safe to divide by.
            const TINY: f64;
            /// True if [`Self::roots`] are rounded once each, for every argument.
            const EXACT_ROOTS: bool;

            /// The nearest number of this precision.
            fn from_f64(value: f64) -> Self;
            /// The number as a double, exactly.
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self.into()
            }
            /// The whole number n below 2^23 of the sum `INTEGERS + n`, from its lowest bits.
            fn to_index(self) -> usize;
            /// Lanes of a register.
            fn lanes<S: Simd>() -> usize;
            /// The whole registers of a slice.
            fn as_registers<S: Simd>(numbers: &[Self]) -> &[Self::Register<S>];
            /// The whole registers of a slice, to be written.
            fn as_mut_registers<S: Simd>(numbers: &mut [Self]) -> &mut [Self::Register<S>];
            /// The same number in every lane.
            fn splat<S: Simd>(simd: S, value: Self) -> Self::Register<S>;
            /// Lanes whose bit `bit` is set.
            fn has_bit<S: Simd>(simd: S, a: Self::Register<S>, bit: u32) -> Self::Mask<S>;
            /// `yes` where true, `no` elsewhere.
            fn select<S: Simd>(
                simd: S,
                mask: Self::Mask<S>,
                yes: Self::Register<S>,
                no: Self::Register<S>,
            ) -> Self::Register<S>;
            /// True if any lane is.
            fn any<S: Simd>(simd: S, a: Self::Mask<S>) -> bool;
            /// [`Vector::steady_roots`].
            fn roots<S: Vector>(simd: S, a: Self::Register<S>) -> [Self::Register<S>; 2];
            /// [`Vector::corners`].
            ///
            /// # Safety
            ///
            /// As there.
            unsafe fn corners<S: Vector>(
                simd: S,
                values: &[f32],
                columns: usize,
                cell: [Self::Register<S>; 2],
            ) -> [[Self::Register<S>; 2]; 2];
            $($(#[$doc])* fn $name<S: Simd>(simd: S, $($in: Self::$kind<S>),*) -> Self::$out<S>;)*
        }

        impl Float for f64 {
            precision! { f64 u64: f64s m64s F64_LANES as_simd_f64s as_mut_simd_f64s splat_f64s transmute_u64s_f64s and_u64s
            splat_u64s greater_than_u64s select_u64s transmute_f64s_u64s first_true_m64s corners steady_roots }
            const INTEGERS: f64 = 4_503_599_627_370_496.0; // 2^52
            const QUARTER_TURN: [f64; 3] =
                [std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17, -1.497_384_904_859_169_8e-33];
            const TINY: f64 = 1e-280;
            const EXACT_ROOTS: bool = false;
            $(
                #[inline(always)]
                fn $name<S: Simd>(simd: S, $($in: Self::$kind<S>),*) -> Self::$out<S> {
                    simd.$double($($in),*)
                }
            )*
        }

        impl Float for f32 {
            precision! { f32 u32: f32s m32s F32_LANES as_simd_f32s as_mut_simd_f32s splat_f32s transmute_u32s_f32s and_u32s
            splat_u32s greater_than_u32s select_u32s transmute_f32s_u32s first_true_m32s corners_single steady_roots_single }
            const INTEGERS: f64 = 8_388_608.0; // 2^23
            const QUARTER_TURN: [f64; 3] =
                [1.570_796_370_506_286_6, -4.371_138_828_673_793e-8, -1.715_124_510_005_881_9e-15];
            const TINY: f64 = 1e-30;
            const EXACT_ROOTS: bool = true;
            $(
                #[inline(always)]
                fn $name<S: Simd>(simd: S, $($in: Self::$kind<S>),*) -> Self::$out<S> {
                    simd.$single($($in),*)
                }
            )*
        }
    };
}

/// Functions that read alike in both precisions.
macro_rules! precision {
    ($float:ident $word:ident: $register:ident $mask:ident $lanes:ident $as_simd:ident $as_mut_simd:ident $splat:ident
     $bits:ident $and:ident $splat_bits:ident $greater:ident $select:ident $from_bits:ident $first:ident $corners:ident $roots:ident) => {
        type Register<S: Simd> = S::$register;
        type Mask<S: Simd> = S::$mask;
        const ABS: Self = Self::from_bits($word::MAX >> 1);
        const ROUND: f64 = 1.5 * Self::INTEGERS;

        #[inline(always)]
        fn from_f64(value: f64) -> Self {
            value as $float
        }
        #[inline(always)]
        fn to_index(self) -> usize {
            (self.to_bits() & 0x7F_FFFF) as usize
        }
        #[inline(always)]
        fn lanes<S: Simd>() -> usize {
            S::$lanes
        }
        #[inline(always)]
        fn as_registers<S: Simd>(numbers: &[Self]) -> &[S::$register] {
            S::$as_simd(numbers).0
        }
        #[inline(always)]
        fn as_mut_registers<S: Simd>(numbers: &mut [Self]) -> &mut [S::$register] {
            S::$as_mut_simd(numbers).0
        }
        #[inline(always)]
        fn splat<S: Simd>(simd: S, value: Self) -> S::$register {
            simd.$splat(value)
        }
        #[inline(always)]
        fn has_bit<S: Simd>(simd: S, a: S::$register, bit: u32) -> S::$mask {
            let set = simd.$and(simd.$bits(a), simd.$splat_bits(1 << bit));
            simd.$greater(set, simd.$splat_bits(0))
        }
        #[inline(always)]
        fn select<S: Simd>(simd: S, mask: S::$mask, yes: S::$register, no: S::$register) -> S::$register {
            // pulp's selection of this type might not be inlined.
            simd.$from_bits(simd.$select(mask, simd.$bits(yes), simd.$bits(no)))
        }
        #[inline(always)]
        fn any<S: Simd>(simd: S, a: S::$mask) -> bool {
            simd.$first(a) < S::$lanes
        }
        #[inline(always)]
        fn roots<S: Vector>(simd: S, a: S::$register) -> [S::$register; 2] {
            simd.$roots(a)
        }
        #[inline(always)]
        unsafe fn corners<S: Vector>(
            simd: S,
            values: &[f32],
            columns: usize,
            cell: [S::$register; 2],
        ) -> [[S::$register; 2]; 2] {
            // SAFETY: the caller's.
            unsafe { simd.$corners(values, columns, cell) }
        }
    };
}

float! {
    /// `a + b`
    add(a: Register, b: Register) -> Register = add_f64s, add_f32s;
    /// `a - b`
    sub(a: Register, b: Register) -> Register = sub_f64s, sub_f32s;
    /// `a b`
    mul(a: Register, b: Register) -> Register = mul_f64s, mul_f32s;
    /// `a / b`
    div(a: Register, b: Register) -> Register = div_f64s, div_f32s;
    /// `a b + c`, rounded once.
    mul_add(a: Register, b: Register, c: Register) -> Register = mul_add_f64s, mul_add_f32s;
    /// Square root.
    sqrt(a: Register) -> Register = sqrt_f64s, sqrt_f32s;
    /// The smaller of two numbers, neither of them NaN.
    min(a: Register, b: Register) -> Register = min_f64s, min_f32s;
    /// The larger of two numbers, neither of them NaN.
    max(a: Register, b: Register) -> Register = max_f64s, max_f32s;
    /// Bits that are set in both.
    and(a: Register, b: Register) -> Register = and_f64s, and_f32s;
    /// Bits that are set in one of them.
    xor(a: Register, b: Register) -> Register = xor_f64s, xor_f32s;
    /// `a < b`; false where either is NaN.
    less(a: Register, b: Register) -> Mask = less_than_f64s, less_than_f32s;
    /// `a <= b`; false where either is NaN.
    less_equal(a: Register, b: Register) -> Mask = less_than_or_equal_f64s, less_than_or_equal_f32s;
    /// Lanes in which both are true.
    both(a: Mask, b: Mask) -> Mask = and_m64s, and_m32s;
    /// Lanes in which one or both are true.
    either(a: Mask, b: Mask) -> Mask = or_m64s, or_m32s;
    /// Lanes in which it is false.
    not(a: Mask) -> Mask = not_m64s, not_m32s;
}
