//! Numbers of either precision, as the registers of every level compute with them.
//!
//! Every operation here rounds once and in the same way at every level, so that no result depends on the level.

use pulp::Simd;

use six_wheel_numerics::simd::vector::Vector;

/// A number of a planner's cycle.
pub(crate) trait Real: Copy + Default + PartialOrd + Send + Sync + 'static {
    /// As many of them as a level computes with at once.
    type Register<S: Simd>: Copy;
    /// One truth value for each.
    type Truths<S: Simd>: Copy;
    /// Smallest square a division may safely be by.
    const TINY: f64;

    /// True if [`Self::roots`] are rounded once each, for every argument.
    const EXACT_ROOTS: bool;

    /// From here on up a number has no fraction: adding it brings a whole number into the lowest bits.
    const WHOLE: f64;

    fn of(value: f64) -> Self;
    fn single(value: f32) -> Self;
    /// The whole number in the lowest bits of `WHOLE` and itself.
    fn count(self) -> usize;
    fn wide(self) -> f64;
    fn lanes<S: Simd>() -> usize;
    fn splat<S: Simd>(simd: S, value: Self) -> Self::Register<S>;
    fn load<S: Simd>(simd: S, from: &[Self]) -> Self::Register<S>;
    fn store<S: Simd>(to: &mut [Self], value: Self::Register<S>);
    fn add<S: Simd>(s: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;
    fn sub<S: Simd>(s: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;
    fn mul<S: Simd>(s: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;
    fn div<S: Simd>(s: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;
    fn min<S: Simd>(s: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;
    fn max<S: Simd>(s: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;
    fn xor<S: Simd>(s: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;
    fn and<S: Simd>(s: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;
    fn abs<S: Simd>(s: S, a: Self::Register<S>) -> Self::Register<S>;
    fn sqrt<S: Simd>(s: S, a: Self::Register<S>) -> Self::Register<S>;
    fn fused<S: Simd>(s: S, a: Self::Register<S>, b: Self::Register<S>, c: Self::Register<S>) -> Self::Register<S>;
    fn below<S: Simd>(s: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Truths<S>;
    fn both<S: Simd>(s: S, a: Self::Truths<S>, b: Self::Truths<S>) -> Self::Truths<S>;
    fn either<S: Simd>(s: S, a: Self::Truths<S>, b: Self::Truths<S>) -> Self::Truths<S>;
    fn not<S: Simd>(s: S, a: Self::Truths<S>) -> Self::Truths<S>;
    fn any<S: Simd>(s: S, a: Self::Truths<S>) -> bool;
    /// [`Vector::corners`].
    ///
    /// # Safety
    ///
    /// As there.
    unsafe fn corners<S: Vector>(
        s: S,
        values: &[f32],
        columns: usize,
        cell: [Self::Register<S>; 2],
    ) -> [[Self::Register<S>; 2]; 2];
    /// [`Vector::steady_roots`].
    fn roots<S: Vector>(s: S, a: Self::Register<S>) -> [Self::Register<S>; 2];
    fn select<S: Simd>(s: S, mask: Self::Truths<S>, yes: Self::Register<S>, no: Self::Register<S>)
    -> Self::Register<S>;
}

/// Operations of a level on two registers, or on their masks.
macro_rules! of_two {
    ($register:ident: $($name:ident $level:ident),*) => {$(
        #[inline(always)]
        fn $name<S: Simd>(s: S, a: S::$register, b: S::$register) -> S::$register {
            s.$level(a, b)
        }
    )*};
}

macro_rules! real {
    ($real:ident, $tiny:literal, $exact:literal, $whole:literal, $mask:literal, $register:ident, $truths:ident, $lanes:ident,
     $as_simd:ident, $as_mut_simd:ident, $splat:ident, $add:ident, $sub:ident, $mul:ident, $div:ident,
     $min:ident, $max:ident, $xor:ident, $and:ident, $abs:ident, $sqrt:ident, $fused:ident, $below:ident,
     $both:ident, $either:ident, $not:ident, $first:ident, $select:ident, $corners:ident, $roots:ident) => {
        impl Real for $real {
            type Register<S: Simd> = S::$register;
            type Truths<S: Simd> = S::$truths;
            const TINY: f64 = $tiny;
            const EXACT_ROOTS: bool = $exact;
            const WHOLE: f64 = $whole;

            #[inline(always)]
            fn single(value: f32) -> Self {
                value.into()
            }
            #[inline(always)]
            fn count(self) -> usize {
                (self.to_bits() & $mask) as usize
            }

            #[inline(always)]
            fn of(value: f64) -> Self {
                value as $real
            }
            #[inline(always)]
            fn wide(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn lanes<S: Simd>() -> usize {
                S::$lanes
            }
            #[inline(always)]
            fn splat<S: Simd>(simd: S, value: Self) -> S::$register {
                simd.$splat(value)
            }
            #[inline(always)]
            fn load<S: Simd>(simd: S, from: &[Self]) -> S::$register {
                match S::$as_simd(from).0 {
                    [first, ..] => *first,
                    [] => simd.$splat(0.0),
                }
            }
            #[inline(always)]
            fn store<S: Simd>(to: &mut [Self], value: S::$register) {
                if let [first, ..] = S::$as_mut_simd(to).0 {
                    *first = value;
                }
            }
            of_two! { $register: add $add, sub $sub, mul $mul, div $div, min $min, max $max, xor $xor, and $and }
            #[inline(always)]
            fn abs<S: Simd>(s: S, a: S::$register) -> S::$register {
                s.$abs(a)
            }
            #[inline(always)]
            fn sqrt<S: Simd>(s: S, a: S::$register) -> S::$register {
                s.$sqrt(a)
            }
            #[inline(always)]
            fn fused<S: Simd>(s: S, a: S::$register, b: S::$register, c: S::$register) -> S::$register {
                s.$fused(a, b, c)
            }
            #[inline(always)]
            fn below<S: Simd>(s: S, a: S::$register, b: S::$register) -> S::$truths {
                s.$below(a, b)
            }
            of_two! { $truths: both $both, either $either }
            #[inline(always)]
            fn not<S: Simd>(s: S, a: S::$truths) -> S::$truths {
                s.$not(a)
            }
            #[inline(always)]
            fn any<S: Simd>(s: S, a: S::$truths) -> bool {
                s.$first(a) < S::$lanes
            }
            #[inline(always)]
            unsafe fn corners<S: Vector>(
                s: S,
                values: &[f32],
                columns: usize,
                cell: [S::$register; 2],
            ) -> [[S::$register; 2]; 2] {
                // SAFETY: the caller's.
                unsafe { s.$corners(values, columns, cell) }
            }
            #[inline(always)]
            fn roots<S: Vector>(s: S, a: S::$register) -> [S::$register; 2] {
                s.$roots(a)
            }
            #[inline(always)]
            fn select<S: Simd>(s: S, mask: S::$truths, yes: S::$register, no: S::$register) -> S::$register {
                s.$select(mask, yes, no)
            }
        }
    };
}

real!(
    f64,
    1e-280,
    false,
    4_503_599_627_370_496.0,
    0xFFFF_FFFF,
    f64s,
    m64s,
    F64_LANES,
    as_simd_f64s,
    as_mut_simd_f64s,
    splat_f64s,
    add_f64s,
    sub_f64s,
    mul_f64s,
    div_f64s,
    min_f64s,
    max_f64s,
    xor_f64s,
    and_f64s,
    abs_f64s,
    sqrt_f64s,
    mul_add_f64s,
    less_than_f64s,
    and_m64s,
    or_m64s,
    not_m64s,
    first_true_m64s,
    select_f64s,
    corners,
    steady_roots
);
real!(
    f32,
    1e-30,
    true,
    8_388_608.0,
    0x7F_FFFF,
    f32s,
    m32s,
    F32_LANES,
    as_simd_f32s,
    as_mut_simd_f32s,
    splat_f32s,
    add_f32s,
    sub_f32s,
    mul_f32s,
    div_f32s,
    min_f32s,
    max_f32s,
    xor_f32s,
    and_f32s,
    abs_f32s,
    sqrt_f32s,
    mul_add_f32s,
    less_than_f32s,
    and_m32s,
    or_m32s,
    not_m32s,
    first_true_m32s,
    select_f32s,
    corners_single,
    steady_roots_single
);
