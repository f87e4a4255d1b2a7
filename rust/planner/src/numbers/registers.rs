//! Registers of either kind of number, so that a planner's cycle is written once for `f32` and `f64`.

use std::ops::{Add, BitAnd, BitOr, Mul, Not, Sub};

use pulp::Simd;

use super::real::Real;
use six_wheel_numerics::simd::vector::Vector;

/// Rollouts of a block: as many as fill two of the widest registers.
pub(crate) const BLOCK: usize = 32;

/// Registers with the operators of a number, `N` in lockstep: while one result is on its way, the processor works on the
/// others.
pub(crate) struct Regs<S: Simd, R: Real, const N: usize> {
    simd: S,
    values: [R::Register<S>; N],
}

/// A single one.
pub(crate) type Reg<S, R> = Regs<S, R, 1>;

impl<S: Simd, R: Real, const N: usize> Clone for Regs<S, R, N> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Simd, R: Real, const N: usize> Copy for Regs<S, R, N> {}

/// One truth value per lane.
pub(crate) struct Truths<S: Simd, R: Real, const N: usize> {
    simd: S,
    values: [R::Truths<S>; N],
}

/// Of a single register.
pub(crate) type Truth<S, R> = Truths<S, R, 1>;

impl<S: Simd, R: Real, const N: usize> Clone for Truths<S, R, N> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Simd, R: Real, const N: usize> Copy for Truths<S, R, N> {}

// Loops instead of `map`: a closure may be left to call, without the level's instructions.

/// Methods of one register, of all in lockstep.
macro_rules! alone {
    ($($(#[$doc:meta])* $name:ident: $function:ident;)*) => {
        $($(#[$doc])*
        #[inline(always)]
        pub fn $name(mut self) -> Self {
            for value in &mut self.values {
                *value = R::$function(self.simd, *value);
            }
            self
        })*
    };
}

/// The same of two.
macro_rules! paired {
    ($($(#[$doc:meta])* $name:ident: $function:ident;)*) => {
        $($(#[$doc])*
        #[inline(always)]
        pub fn $name(mut self, other: Self) -> Self {
            for (value, other) in self.values.iter_mut().zip(other.values) {
                *value = R::$function(self.simd, *value, other);
            }
            self
        })*
    };
}

impl<S: Simd, R: Real, const N: usize> Regs<S, R, N> {
    /// Numbers of all of them.
    #[inline(always)]
    pub fn lanes() -> usize {
        N * R::lanes::<S>()
    }

    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: R) -> Self {
        Self { simd, values: [R::splat(simd, value); N] }
    }

    /// The same, of a constant.
    #[inline(always)]
    pub fn all(simd: S, value: f64) -> Self {
        Self::splat(simd, R::of(value))
    }

    /// The first numbers of a slice, which has enough of them.
    #[inline(always)]
    pub fn load(simd: S, from: &[R]) -> Self {
        let mut loaded = Self::splat(simd, R::default());
        for (k, value) in loaded.values.iter_mut().enumerate() {
            *value = R::load(simd, &from[k * R::lanes::<S>()..]);
        }
        loaded
    }

    #[inline(always)]
    pub fn store(self, to: &mut [R]) {
        for (k, value) in self.values.into_iter().enumerate() {
            R::store::<S>(&mut to[k * R::lanes::<S>()..], value);
        }
    }

    /// `self * factor + term`, rounded once.
    #[inline(always)]
    pub fn mul_add(mut self, factor: Self, term: Self) -> Self {
        for k in 0..N {
            let (factor, term) = (factor.values[k], term.values[k]);
            self.values[k] = R::fused(self.simd, self.values[k], factor, term);
        }
        self
    }

    alone! {
        sqrt: sqrt;
        abs: abs;
    }

    paired! {
        over: div;
        max: max;
        min: min;
        /// Minus the number where `sign` has its sign bit set.
        flip: xor;
    }

    /// The sign bit, on a zero.
    #[inline(always)]
    pub fn sign(mut self) -> Self {
        let bit = R::splat(self.simd, R::of(-0.0));
        for value in &mut self.values {
            *value = R::and(self.simd, *value, bit);
        }
        self
    }

    /// A number that is not negative to the next whole number below.
    #[inline(always)]
    pub fn floor(self) -> Self {
        let whole = Self::all(self.simd, R::WHOLE);
        let near = (self + whole) - whole;
        let one = Self::all(self.simd, 1.0);
        self.below(near).select(near - one, near)
    }

    /// A whole number as [`Real::count`] takes it.
    #[inline(always)]
    pub fn counted(self) -> Self {
        self + Self::all(self.simd, R::WHOLE)
    }

    #[inline(always)]
    pub fn below(self, other: Self) -> Truths<S, R, N> {
        let mut values = [R::below(self.simd, self.values[0], other.values[0]); N];
        for (k, value) in values.iter_mut().enumerate().skip(1) {
            *value = R::below(self.simd, self.values[k], other.values[k]);
        }
        Truths { simd: self.simd, values }
    }
}

impl<S: Vector, R: Real, const N: usize> Regs<S, R, N> {
    /// One over the square root of a number that is not negative, and the root, each to two last places.
    #[inline(always)]
    pub fn roots(self) -> [Self; 2] {
        let number = |value: f64| Self::all(self.simd, value);
        let (mut inverse, mut root) = (self, self);
        for k in 0..N {
            [inverse.values[k], root.values[k]] = R::roots(self.simd, self.values[k]);
        }
        let odd = self.below(number(1e-30)) | number(1e36).below(self);
        if !R::EXACT_ROOTS && odd.any() {
            let exact = self.sqrt();
            root = odd.select(exact, root);
            inverse = odd.select(number(1.0).over(exact), inverse);
        }
        [inverse, root]
    }
}

impl<S: Simd> Reg<S, f32> {
    /// Numbers of their bits.
    #[inline(always)]
    pub fn of_bits(simd: S, bits: S::u32s) -> Self {
        Self { simd, values: [simd.transmute_f32s_u32s(bits)] }
    }

    #[inline(always)]
    pub fn bits(self) -> S::u32s {
        self.simd.transmute_u32s_f32s(self.values[0])
    }
}

impl<S: Vector, R: Real> Reg<S, R> {
    /// The four cells around places, `[x, y]` of the first of them: the two of its row, and of the next one.
    ///
    /// # Safety
    ///
    /// As [`Vector::corners`].
    #[inline(always)]
    pub unsafe fn corners(simd: S, values: &[f32], columns: usize, [x, y]: [Self; 2]) -> [[Self; 2]; 2] {
        // SAFETY: the caller's.
        let cells = unsafe { R::corners(simd, values, columns, [x.values[0], y.values[0]]) };
        cells.map(|row| row.map(|value| Self { simd, values: [value] }))
    }
}

impl<S: Simd> Truth<S, f32> {
    #[inline(always)]
    pub fn of(simd: S, value: S::m32s) -> Self {
        Self { simd, values: [value] }
    }
}

impl<S: Simd, R: Real, const N: usize> Truths<S, R, N> {
    /// `yes` where true, `no` elsewhere.
    #[inline(always)]
    pub fn select(self, yes: Regs<S, R, N>, no: Regs<S, R, N>) -> Regs<S, R, N> {
        let mut chosen = yes;
        for k in 0..N {
            chosen.values[k] = R::select(self.simd, self.values[k], yes.values[k], no.values[k]);
        }
        chosen
    }

    #[inline(always)]
    pub fn any(self) -> bool {
        let mut all = self.values[0];
        for value in &self.values[1..] {
            all = R::either(self.simd, all, *value);
        }
        R::any(self.simd, all)
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $function:ident, $of:ident) => {
        impl<S: Simd, R: Real, const N: usize> $trait for $of<S, R, N> {
            type Output = Self;
            #[inline(always)]
            fn $name(mut self, other: Self) -> Self {
                for (value, other) in self.values.iter_mut().zip(other.values) {
                    *value = R::$function(self.simd, *value, other);
                }
                self
            }
        }
    };
}
operator!(Add, add, add, Regs);
operator!(Sub, sub, sub, Regs);
operator!(Mul, mul, mul, Regs);
operator!(BitAnd, bitand, both, Truths);
operator!(BitOr, bitor, either, Truths);

impl<S: Simd, R: Real, const N: usize> Not for Truths<S, R, N> {
    type Output = Self;
    #[inline(always)]
    fn not(mut self) -> Self {
        for value in &mut self.values {
            *value = R::not(self.simd, *value);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use six_wheel_numerics::simd::level::{Kernel, Level};

    struct Roots<'a, R>(&'a [R], &'a mut [[R; 2]]);

    impl<R: Real> Kernel for Roots<'_, R> {
        type Output = ();

        #[inline(always)]
        fn run<S: Vector>(self, simd: S) {
            let lanes = R::lanes::<S>();
            for (from, to) in self.0.chunks(lanes).zip(self.1.chunks_mut(lanes)) {
                let mut columns = [[R::default(); 16]; 3];
                columns[0][..from.len()].copy_from_slice(from);
                let [inverse, root] = Reg::load(simd, &columns[0]).roots();
                inverse.store(&mut columns[1]);
                root.store(&mut columns[2]);
                for (lane, to) in to.iter_mut().enumerate() {
                    *to = [columns[1][lane], columns[2][lane]];
                }
            }
        }
    }

    /// At every level, in every company.
    fn roots<R: Real>(numbers: &[R]) -> Vec<Vec<[R; 2]>> {
        let mut all = Vec::new();
        for level in Level::available() {
            let mut found = vec![[R::default(); 2]; numbers.len()];
            level.run_any(Roots(numbers, &mut found));
            all.push(found);
        }
        all
    }

    #[test]
    fn roots_are_right_to_two_last_places_and_the_same_at_every_level() {
        let extremes = [0.0, 1e-310, 9e-31, 1e-30, 1.0, 1e36, 1.1e36, 1e300, f64::MAX];
        let mut numbers: Vec<f64> = (0..20_000).map(|k| f64::from(k).mul_add(0.0067, -66.0).exp()).collect();
        for (k, extreme) in extremes.into_iter().enumerate() {
            numbers.insert(7 * k, extreme);
        }
        let all = roots(&numbers);
        for (number, [inverse, root]) in numbers.iter().zip(&all[0]) {
            let exact = number.sqrt();
            // A root of a subnormal has all its digits.
            assert!((root - exact).abs() <= 2.0 * f64::EPSILON * exact, "{number}");
            let exact = 1.0 / exact;
            assert!(*inverse == exact || (inverse - exact).abs() <= 2.0 * f64::EPSILON * exact, "{number}");
        }
        for found in &all[1..] {
            assert!(found == &all[0]);
        }
        let singles: Vec<f32> = numbers.iter().map(|number| *number as f32).collect();
        let all = roots(&singles);
        for (number, [inverse, root]) in singles.iter().zip(&all[0]) {
            let exact = number.sqrt();
            assert!(*root == exact || (root - exact).abs() <= 2.0 * f32::EPSILON * exact, "{number}");
            let exact = 1.0 / exact;
            assert!(*inverse == exact, "{number}");
        }
        for found in &all[1..] {
            assert!(found == &all[0]);
        }
    }

    #[test]
    fn what_is_not_a_number_stays_so_and_infinity_is_no_odd_one_out() {
        for found in roots(&[f64::NAN, 4.0, f64::INFINITY, 9.0]) {
            assert!(found[0].iter().all(|part| part.is_nan()));
            assert_eq!(found[1..], [[0.5, 2.0], [0.0, f64::INFINITY], [1.0 / 3.0, 3.0]]);
        }
    }
}
