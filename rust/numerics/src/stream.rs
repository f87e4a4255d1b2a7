//! Writing past the caches: a batch larger than they are would fetch every line of its output only to overwrite
//! it, and push out what it is about to read.

use super::vector::Vector;
use super::weave::BLOCK;

/// Numbers of a line of the caches.
const LINE: usize = 8;

/// Outputs of more numbers than this do not stay in the caches anyway: 32 MB.
const LARGE: usize = (32 << 20) / size_of::<f64>();

/// Blocks from the one that is worked on to the one that is fetched.
const AHEAD: usize = 4;

/// Whether an output of so many numbers is written past the caches.
pub(crate) fn is_large(numbers: usize) -> bool {
    numbers > LARGE
}

/// Asks for the rows a few blocks after these, part `k` of them: left to itself, the processor starts anew at every
/// page, and it can wait for some lines only at a time.
#[inline(always)]
pub(crate) fn fetch_ahead<S: Vector>(simd: S, rows: &[f64], k: usize, parts: usize) {
    let part = rows.len() / parts;
    let first = rows.as_ptr().wrapping_add(AHEAD * rows.len() + k * part);
    for line in 0..part.div_ceil(LINE) {
        simd.fetch(first.wrapping_add(line * LINE));
    }
}

/// Numbers that wait at most: a block of rows of up to eight, and what is left of a line.
const ROOM: usize = 8 * BLOCK + LINE;

/// Where a kernel writes its rows, one piece after the other, of at most `ROOM - LINE` numbers.
#[allow(clippy::large_enum_variant)] // on the stack of the kernel, one per array; a box would be an allocation
pub(crate) enum Output<'a, S: Vector> {
    /// Where they belong.
    Direct(&'a mut [f64]),
    /// Past the caches.
    Past(Stream<'a, S>),
}

impl<'a, S: Vector> Output<'a, S> {
    /// Pieces are of so many numbers at most.
    #[inline(always)]
    pub fn new(simd: S, target: &'a mut [f64], piece: usize, past: bool) -> Self {
        if past && S::STREAMS && piece + LINE <= ROOM {
            Self::Past(Stream::new(simd, target))
        } else {
            Self::Direct(target)
        }
    }

    /// Room for the next numbers. They are written when there is no more to do to them: at the next call, or
    /// at the end.
    #[inline(always)]
    pub fn next(&mut self, count: usize) -> &mut [f64] {
        match self {
            Self::Direct(target) => {
                let (next, rest) = std::mem::take(target).split_at_mut(count);
                *target = rest;
                next
            }
            Self::Past(stream) => stream.next(count),
        }
    }
}

#[repr(align(64))]
struct Buffer([f64; ROOM]);

/// Numbers on their way, in whole lines: a line written in two pieces costs more than it saves.
pub(crate) struct Stream<'a, S: Vector> {
    simd: S,
    /// What is not written yet.
    target: &'a mut [f64],
    /// What waits to be written, at the same places of the lines as in the target.
    buffer: Buffer,
    first: usize,
    end: usize,
}

impl<'a, S: Vector> Stream<'a, S> {
    #[inline(always)]
    fn new(simd: S, target: &'a mut [f64]) -> Self {
        let first = target.as_ptr().addr() / size_of::<f64>() % LINE;
        Self { simd, target, buffer: Buffer([0.0; ROOM]), first, end: first }
    }

    #[inline(always)]
    fn next(&mut self, count: usize) -> &mut [f64] {
        self.send();
        let first = self.end;
        self.end += count;
        &mut self.buffer.0[first..self.end]
    }

    /// The next numbers that wait, and where they go.
    #[inline(always)]
    fn take(&mut self, count: usize) -> (&[f64], &mut [f64]) {
        let (target, rest) = std::mem::take(&mut self.target).split_at_mut(count);
        self.target = rest;
        let first = self.first;
        self.first += count;
        (&self.buffer.0[first..self.first], target)
    }

    /// Writes all that waits, but for the beginning of a line.
    #[inline(always)]
    fn send(&mut self) {
        let simd = self.simd;
        let waiting = self.first..self.end;
        // Only the target's first line begins before it.
        let head = waiting.start.next_multiple_of(LINE).min(waiting.end) - waiting.start;
        let (numbers, target) = self.take(head);
        target.copy_from_slice(numbers);
        let lines = (self.end - self.first) / LINE * LINE;
        let (numbers, target) = self.take(lines);
        let registers = S::as_simd_f64s(numbers).0;
        let targets = S::as_mut_simd_f64s(target).0;
        for (target, register) in targets.iter_mut().zip(registers) {
            // SAFETY: after the head lines begin. Nobody looks at the target before this value is dropped,
            // which ends with the fence.
            unsafe { simd.stream(target, *register) };
        }
        let first = self.first % LINE;
        self.buffer.0.copy_within(self.first..self.end, first);
        self.end = first + (self.end - self.first);
        self.first = first;
    }
}

impl<S: Vector> Drop for Stream<'_, S> {
    #[inline(always)]
    fn drop(&mut self) {
        self.send();
        let (numbers, target) = self.take(self.end - self.first);
        target.copy_from_slice(numbers);
        self.simd.fence();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::formulas::{forward, integrate, inverse};
    use crate::batch::{Level, Log};
    use crate::error::Error;
    use crate::estimate::Unseen;
    use crate::geometry::{Steps, Walk};
    use crate::presets::preset;
    use crate::rover::Inputs;

    /// Numbers between -1 and 1, the same every time, and a few zeros.
    fn numbers(count: usize) -> Vec<f64> {
        let number = |k: usize| ((k * 2_654_435_761) % 2001) as f64 / 1000.0 - 1.0;
        (0..count).map(|k| if k % 97 < 3 { 0.0 } else { number(k) }).collect()
    }

    /// What `write` writes to the same bits past the caches and not, for every place in a line the output may begin at;
    /// nothing beside it is touched.
    fn is_the_same(count: usize, mut write: impl FnMut(&mut [f64], bool)) {
        for first in 0..LINE {
            let [mut direct, mut past] = [vec![f64::MAX; count + 2 * LINE], vec![f64::MAX; count + 2 * LINE]];
            // Both at the same place of a line.
            let place = |values: &[f64]| (LINE - values.as_ptr().addr() / size_of::<f64>() % LINE) % LINE + first;
            let (from, to) = (place(&direct), place(&past));
            let margin = |values: &[f64], at: usize| {
                let beside = values.iter().enumerate().filter(|(k, _)| !(at..at + count).contains(k));
                beside.filter(|(_, value)| **value == f64::MAX).count()
            };
            write(&mut direct[from..from + count], false);
            write(&mut past[to..to + count], true);
            assert_eq!(margin(&past, to), 2 * LINE, "beside");
            let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&direct[from..from + count]), bits(&past[to..to + count]), "{first}");
        }
    }

    const COUNTS: [usize; 7] = [1, 2, 63, 64, 65, 333, 2048];

    #[test]
    fn rows_are_the_same_past_the_caches() -> Result<(), Error> {
        for (name, count) in COUNTS.into_iter().flat_map(|n| [("perseverance", n), ("husky", n)]) {
            let rover = preset(name, None)?;
            let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
            let mut twists = numbers(3 * count);
            for twist in twists.as_chunks_mut::<3>().0 {
                // What fixed wheels in the middle allow, some at rest and some for the plain core.
                *twist = [twist[0], 0.0, twist[2] * if twist[1] < 0.0 { 1e-120 } else { 0.3 }];
            }
            let readings = numbers(wheels * count);
            let log = Log { steering: &readings[..joints * count], speeds: &readings, steering_rates: None };
            for level in Level::available().into_iter().filter(|level| *level != Level::Plain) {
                if let Some(plan) = rover.cone.as_ref().and_then(|cone| inverse::Plan::new(&rover, cone)) {
                    let mut others = vec![0.0; wheels * count];
                    is_the_same(joints * count, |steering, past| {
                        let inputs = Inputs::default();
                        plan.solve(level, twists.as_chunks().0, inputs, steering, &mut others, past);
                    });
                    let mut others = vec![0.0; joints * count];
                    is_the_same(wheels * count, |speeds, past| {
                        let inputs = Inputs::default();
                        plan.solve(level, twists.as_chunks().0, inputs, &mut others, speeds, past);
                    });
                }
                if let Some(plan) = forward::Plan::new(&rover) {
                    is_the_same(3 * count, |twists, past| {
                        let twists = twists.as_chunks_mut().0;
                        let solved = plan.solve(level, log, Unseen::Refuse, twists, past);
                        assert!(solved.is_ok());
                    });
                }
            }
        }
        Ok(())
    }

    #[test]
    fn poses_are_the_same_past_the_caches() {
        for count in COUNTS {
            let twists = numbers(3 * count);
            let (twists, steps) = (twists.as_chunks().0, Steps::Constant(0.7));
            for level in Level::available().into_iter().filter(|level| *level != Level::Plain) {
                is_the_same(3 * count, |poses, past| {
                    let walk = &mut Walk::new([1.0, 2.0, 3.0]);
                    let poses = poses.as_chunks_mut().0;
                    integrate::follow(level, twists, steps, poses, past, walk);
                });
            }
        }
    }
}
