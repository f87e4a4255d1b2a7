//! Instruction sets that the kernels use: chosen at run time for the processor, or by the caller.

use std::str::FromStr;

#[cfg(all(target_arch = "aarch64", not(feature = "scalar-only")))]
use pulp::aarch64::Neon;
#[cfg(target_arch = "x86_64")]
use pulp::x86::V3;
#[cfg(all(target_arch = "x86_64", feature = "all-levels"))]
use pulp::x86::V4;
use pulp::{NullaryFnOnce, Scalar, Simd};

use super::vector::Vector;
use crate::error::Error;

/// A set of vector instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// One number at a time, on every machine; with FMA where the processor has it.
    Scalar,
    /// Two numbers at a time (aarch64).
    Neon,
    /// Four numbers at a time (x86-64 with AVX2 and FMA).
    Avx2,
    /// Eight numbers at a time (x86-64 with AVX-512).
    Avx512,
}

/// Levels that can be requested, best last.
const LEVELS: [Level; 4] = [Level::Scalar, Level::Neon, Level::Avx2, Level::Avx512];

impl Level {
    /// Its name in Python.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Neon => "neon",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// True if this machine has it.
    #[inline]
    pub fn is_here(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(all(target_arch = "x86_64", feature = "all-levels"))]
            Self::Avx512 => V4::try_new().is_some(),
            #[cfg(all(target_arch = "x86_64", not(feature = "scalar-only")))]
            Self::Avx2 => V3::try_new().is_some(),
            #[cfg(all(target_arch = "aarch64", not(feature = "scalar-only")))]
            Self::Neon => Neon::try_new().is_some(),
            _ => false,
        }
    }

    /// The levels this machine has, best last.
    #[inline]
    pub fn available() -> Vec<Self> {
        LEVELS.into_iter().filter(|level| level.is_here()).collect()
    }

    /// Numbers in a register.
    pub fn lanes(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Neon => 2,
            Self::Avx2 => 4,
            Self::Avx512 => 8,
        }
    }

    /// The best level this machine has.
    #[inline]
    pub fn best() -> Self {
        let best = LEVELS.into_iter().rev().find(|level| level.is_here());
        best.unwrap_or(Self::Scalar)
    }

    /// Runs a kernel with these instructions, one number at a time where the machine does not have them.
    pub fn run_any<K: Kernel>(self, kernel: K) -> K::Output {
        #[cfg(all(target_arch = "x86_64", feature = "all-levels"))]
        if self == Self::Avx512
            && let Some(simd) = V4::try_new()
        {
            return simd.vectorize(Run { kernel, simd });
        }
        #[cfg(all(target_arch = "x86_64", not(feature = "scalar-only")))]
        if self == Self::Avx2
            && let Some(simd) = V3::try_new()
        {
            return simd.vectorize(Run { kernel, simd });
        }
        #[cfg(all(target_arch = "aarch64", not(feature = "scalar-only")))]
        if self == Self::Neon
            && let Some(simd) = Neon::try_new()
        {
            return simd.vectorize(Run { kernel, simd });
        }
        // Without the instruction, a multiplication and addition rounded once is a call of a library: the same bits,
        // many times slower.
        #[cfg(target_arch = "x86_64")]
        if let Some(simd) = V3::try_new() {
            return simd.vectorize(Run { kernel, simd: Scalar });
        }
        kernel.run(Scalar)
    }
}

/// Calls a function of single numbers with the instructions of [`Level::Scalar`]. It has to be `#[inline(always)]`.
pub fn run_scalar<A, R>(function: impl FnOnce(A) -> R, arguments: A) -> R {
    Level::Scalar.run_any(ScalarCall { function, arguments })
}

/// See [`run_scalar`].
struct ScalarCall<F, A> {
    function: F,
    arguments: A,
}

impl<A, R, F: FnOnce(A) -> R> Kernel for ScalarCall<F, A> {
    type Output = R;

    #[inline(always)]
    fn run<S: Vector>(self, _: S) -> R {
        (self.function)(self.arguments)
    }
}

/// Runs a kernel at the level of its caller, in a function of its own, so that a rare case takes no registers from the
/// frequent one.
#[cold]
#[inline(never)]
pub fn run_rarely<S: Vector, K: LevelKernel<S>>(simd: S, kernel: K) -> K::Output {
    let run = Run { kernel, simd };
    #[cfg(target_arch = "x86_64")]
    if S::IS_SCALAR
        && let Some(simd) = V3::try_new()
    {
        return simd.vectorize(run);
    }
    Simd::vectorize(simd, run)
}

/// Code that is compiled once for every level.
pub trait Kernel {
    /// Result of the kernel.
    type Output;

    /// Has to be `#[inline(always)]`, with every function of registers that it calls.
    fn run<S: Vector>(self, simd: S) -> Self::Output;
}

/// A kernel of one level, which may hold registers of it.
pub trait LevelKernel<S: Vector> {
    /// Result of the kernel.
    type Output;

    /// As [`Kernel::run`].
    fn run_at_level(self, simd: S) -> Self::Output;
}

impl<S: Vector, K: Kernel> LevelKernel<S> for K {
    type Output = K::Output;

    #[inline(always)]
    fn run_at_level(self, simd: S) -> K::Output {
        self.run(simd)
    }
}

/// A kernel and the token of its level, to be called inside the function that is compiled with its instructions.
struct Run<K, S> {
    kernel: K,
    simd: S,
}

impl<K: LevelKernel<S>, S: Vector> NullaryFnOnce for Run<K, S> {
    type Output = K::Output;

    #[inline(always)]
    fn call(self) -> K::Output {
        self.kernel.run_at_level(self.simd)
    }
}

impl FromStr for Level {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        let available = Self::available();
        let found = available.iter().find(|level| level.name() == name);
        found.copied().ok_or_else(|| {
            let names: Vec<_> = available.iter().map(|level| format!("{:?}", level.name())).collect();
            Error::value("level", format!("be one this machine has ({})", names.join(", ")), format!("{name:?}"))
        })
    }
}
