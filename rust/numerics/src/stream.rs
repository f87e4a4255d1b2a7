//! Writing past the caches: a batch larger than they are would fetch every line of its output before overwriting it,
//! and evict the input that it reads next.

use super::columns::BLOCK;
use crate::simd::vector::Vector;

/// Doubles in a cache line.
pub const LINE: usize = 8;

/// Outputs of more doubles than this are larger than the caches: 32 MB.
const LARGE: usize = (32 << 20) / size_of::<f64>();

/// Blocks from the one that is computed to the one that is prefetched.
const AHEAD: usize = 4;

/// True if an output of this number of doubles is written past the caches.
#[inline]
pub fn is_large(numbers: usize) -> bool {
    numbers > LARGE
}

/// Prefetches part `k` of `parts` of the rows [`AHEAD`] blocks after these: the processor's own prefetching starts anew
/// at every page, and it can wait for a few lines only at a time.
#[inline(always)]
pub fn prefetch_ahead<S: Vector>(simd: S, rows: &[f64], k: usize, parts: usize) {
    let part = rows.len() / parts;
    let first = rows.as_ptr().wrapping_add(AHEAD * rows.len() + k * part);
    for line in 0..part.div_ceil(LINE) {
        simd.prefetch(first.wrapping_add(line * LINE));
    }
}

/// Doubles in the buffer: a block of rows of up to eight, and the rest of a line.
const CAPACITY: usize = 8 * BLOCK + LINE;

/// Target of the rows that a kernel writes, one piece after the other, of at most `CAPACITY - LINE` doubles.
#[allow(clippy::large_enum_variant)] // on the stack of the kernel, one per array; a box would be an allocation
pub enum Output<'a, S: Vector> {
    /// Straight into the array.
    Direct(&'a mut [f64]),
    /// Past the caches.
    NonTemporal(NonTemporalStore<'a, S>),
}

#[inline_always]
impl<'a, S: Vector> Output<'a, S> {
    /// Pieces are of so many numbers at most.
    pub fn new(simd: S, target: &'a mut [f64], piece: usize, non_temporal: bool) -> Self {
        if non_temporal && S::STREAMS && piece + LINE <= CAPACITY {
            Self::NonTemporal(NonTemporalStore::new(simd, target))
        } else {
            Self::Direct(target)
        }
    }

    /// Memory for the next `count` numbers. They are written to the array at the next call, or when this value is
    /// dropped.
    pub fn next(&mut self, count: usize) -> &mut [f64] {
        match self {
            Self::Direct(target) => {
                let (next, rest) = std::mem::take(target).split_at_mut(count);
                *target = rest;
                next
            }
            Self::NonTemporal(stream) => stream.next(count),
        }
    }
}

#[repr(align(64))]
struct Buffer([f64; CAPACITY]);

/// A buffer from which whole cache lines are written past the caches: a line in two pieces takes longer than one
/// through the caches.
pub struct NonTemporalStore<'a, S: Vector> {
    simd: S,
    /// Part of the array that is not written yet.
    target: &'a mut [f64],
    /// Numbers to be written, those from `first` to `end`, at the same offset in a line as in the target.
    buffer: Buffer,
    first: usize,
    end: usize,
}

#[inline_always]
impl<'a, S: Vector> NonTemporalStore<'a, S> {
    fn new(simd: S, target: &'a mut [f64]) -> Self {
        let first = target.as_ptr().addr() / size_of::<f64>() % LINE;
        Self { simd, target, buffer: Buffer([0.0; CAPACITY]), first, end: first }
    }

    fn next(&mut self, count: usize) -> &mut [f64] {
        self.send();
        let first = self.end;
        self.end += count;
        &mut self.buffer.0[first..self.end]
    }

    /// The next `count` numbers of the buffer, and their place in the target.
    fn take(&mut self, count: usize) -> (&[f64], &mut [f64]) {
        let (target, rest) = std::mem::take(&mut self.target).split_at_mut(count);
        self.target = rest;
        let first = self.first;
        self.first += count;
        (&self.buffer.0[first..self.first], target)
    }

    /// Writes the buffer but for the beginning of its last line.
    fn send(&mut self) {
        let simd = self.simd;
        let waiting = self.first..self.end;
        // Numbers before the first whole line of the target.
        let head = waiting.start.next_multiple_of(LINE).min(waiting.end) - waiting.start;
        let (numbers, target) = self.take(head);
        target.copy_from_slice(numbers);
        let lines = (self.end - self.first) / LINE * LINE;
        let (numbers, target) = self.take(lines);
        let registers = S::as_simd_f64s(numbers).0;
        let targets = S::as_mut_simd_f64s(target).0;
        for (target, register) in targets.iter_mut().zip(registers) {
            // SAFETY: after the head every register begins at a multiple of its size. The target is borrowed until this
            // value is dropped, which ends with the fence.
            unsafe { simd.stream(target, *register) };
        }
        let first = self.first % LINE;
        self.buffer.0.copy_within(self.first..self.end, first);
        self.end = first + (self.end - self.first);
        self.first = first;
    }
}

impl<S: Vector> Drop for NonTemporalStore<'_, S> {
    #[inline(always)]
    fn drop(&mut self) {
        self.send();
        let (numbers, target) = self.take(self.end - self.first);
        target.copy_from_slice(numbers);
        self.simd.store_fence();
    }
}
