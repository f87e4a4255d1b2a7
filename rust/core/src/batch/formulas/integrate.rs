//! Poses along one log, cut into as many pieces as a register has lanes, tile by tile.

use super::tile::{LANES, LARGEST_HEADING, PerStep, STEPS, Sums, Tile, WIDTH, columns, durations};
use crate::batch::machine::lanes::Lanes;
use crate::batch::machine::level::{Kernel, Level};
use crate::batch::machine::stream::{Output, fetch_ahead};
use crate::batch::machine::vector::Vector;
use crate::geometry::{Steps, Sum, Walk};

/// Numbers up to here surely add up to something finite.
pub(crate) const LARGEST_TOTAL: f64 = 1e300;

/// Sum of the absolute values. NaN if one is NaN.
pub(crate) fn sum_of_sizes(level: Level, values: &[f64]) -> f64 {
    level.run(SumOfSizes(values)).unwrap_or(f64::NAN)
}

struct SumOfSizes<'a>(&'a [f64]);

impl Kernel for SumOfSizes<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> f64 {
        let (registers, rest) = S::as_simd_f64s(self.0);
        let mut sums = [Lanes::splat(simd, 0.0); 4];
        let (quads, singles) = registers.as_chunks::<4>();
        for quad in quads {
            for (j, sum) in sums.iter_mut().enumerate() {
                *sum = *sum + Lanes::load(simd, quad, j).abs();
            }
        }
        for k in 0..singles.len() {
            sums[0] = sums[0] + Lanes::load(simd, singles, k).abs();
        }
        let sum = (sums[0] + sums[1]) + (sums[2] + sums[3]);
        sum.total() + rest.iter().map(|value| value.abs()).sum::<f64>()
    }
}

/// Goes on along a log that has been checked; the pose after every step.
pub(crate) fn follow(
    level: Level,
    twists: &[[f64; 3]],
    steps: Steps<'_>,
    poses: &mut [[f64; 3]],
    past: bool,
    walk: &mut Walk,
) {
    if level == Level::Plain {
        return walk.follow(twists, steps, poses);
    }
    level.run(Follow {
        twists,
        steps,
        poses,
        past,
        walk,
    });
}

struct Follow<'a> {
    twists: &'a [[f64; 3]],
    steps: Steps<'a>,
    poses: &'a mut [[f64; 3]],
    past: bool,
    walk: &'a mut Walk,
}

impl Kernel for Follow<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let size = STEPS * S::F64_LANES;
        let constant = durations(simd, self.steps, 0);
        let mut tile = Tile::new(simd);
        let mut spare = [[0.0; WIDTH]; LANES];
        let poses = self.poses.as_flattened_mut();
        let mut output = Output::new(simd, poses, 3 * size, self.past);
        for (k, twists) in self.twists.chunks(size).enumerate() {
            fetch_ahead(simd, twists.as_flattened(), 0, 1);
            let poses = output.next(3 * twists.len());
            let steps = match self.steps {
                Steps::Constant(dt) => Steps::Constant(dt),
                Steps::Each(dts) => Steps::Each(&dts[k * size..k * size + twists.len()]),
            };
            let dts = |dts: &[[f64; STEPS]]| side_by_side(simd, dts);
            let done = if twists.len() == size {
                let dts = match steps {
                    Steps::Constant(_) => constant,
                    Steps::Each(each) => dts(each.as_chunks().0),
                };
                let twists = twists.as_flattened().as_chunks().0;
                let poses = poses.as_chunks_mut().0;
                place(simd, &mut tile, twists, &dts, poses, &mut spare, self.walk)
            } else {
                // The last steps: those that are missing stand still.
                let mut padded = [[0.0; WIDTH]; LANES];
                let mut placed = padded;
                fill(&mut padded, twists.as_flattened());
                let dts = match steps {
                    Steps::Constant(_) => constant,
                    Steps::Each(each) => {
                        let mut padded = [[0.0; STEPS]; LANES];
                        fill(&mut padded, each);
                        dts(&padded)
                    }
                };
                let done = place(
                    simd,
                    &mut tile,
                    &padded,
                    &dts,
                    &mut placed,
                    &mut spare,
                    self.walk,
                );
                poses.copy_from_slice(&placed.as_flattened()[..poses.len()]);
                done
            };
            if !done {
                self.walk.follow(twists, steps, poses.as_chunks_mut().0);
            }
        }
    }
}

fn fill<const N: usize>(padded: &mut [[f64; N]; LANES], numbers: &[f64]) {
    padded.as_flattened_mut()[..numbers.len()].copy_from_slice(numbers);
}

/// One row per lane; where there are fewer lanes, nobody looks at the others.
#[inline(always)]
fn lanes<const N: usize>(rows: &[[f64; N]]) -> [&[f64; N]; LANES] {
    std::array::from_fn(|lane| &rows[lane.min(rows.len() - 1)])
}

/// Durations of the steps of pieces of a log.
#[inline(always)]
fn side_by_side<S: Vector>(simd: S, dts: &[[f64; STEPS]]) -> PerStep<S> {
    let mut registers = [simd.splat_f64s(0.0); STEPS];
    columns(simd, &lanes(&dts[..S::F64_LANES]), &mut registers);
    let mut dts = [Lanes::splat(simd, 0.0); STEPS];
    for (t, dt) in dts.iter_mut().enumerate() {
        *dt = Lanes::load(simd, &registers, t);
    }
    dts
}

/// A tile whose lanes follow each other. Whether no step turns too far for the polynomials; if one does,
/// nothing has happened to `walk`.
#[inline(always)]
fn place<S: Vector>(
    simd: S,
    tile: &mut Tile<S>,
    twists: &[[f64; WIDTH]],
    dts: &PerStep<S>,
    poses: &mut [[f64; WIDTH]],
    spare: &mut [[f64; WIDTH]; LANES],
    walk: &mut Walk,
) -> bool {
    if walk.heading.sum.abs() > LARGEST_HEADING {
        return false;
    }
    tile.read(simd, &lanes(&twists[..S::F64_LANES]));
    let (turn, near) = tile.turn(simd, dts, None);
    if (!near).any() {
        return false;
    }
    let (turns, turn) = one_after_another(simd, turn);
    let heading = after(simd, &walk.heading, turns);
    let [x, y] = tile.walk(simd, &heading, None);
    let ((easts, east), (norths, north)) = (one_after_another(simd, x), one_after_another(simd, y));
    let sums = [
        after(simd, &walk.x, easts),
        after(simd, &walk.y, norths),
        after(simd, &walk.yaw, turns),
    ];
    let mut targets = spare.each_mut();
    for (target, poses) in targets.iter_mut().zip(&mut poses[..S::F64_LANES]) {
        *target = poses;
    }
    tile.place(simd, [&sums[0], &sums[1], &sums[2]]);
    tile.write(simd, &mut targets);
    walk.turn(turn);
    walk.shift(east, north);
    true
}

/// What comes before every lane, and what all come to.
#[inline(always)]
fn one_after_another<S: Vector>(simd: S, terms: Lanes<S>) -> (Lanes<S>, f64) {
    let mut sum = terms + Lanes::shift::<0>(simd, terms);
    if S::F64_LANES > 2 {
        sum = sum + Lanes::shift::<1>(simd, sum);
    }
    if S::F64_LANES > 4 {
        sum = sum + Lanes::shift::<2>(simd, sum);
    }
    (Lanes::shift::<0>(simd, sum), sum.last(simd))
}

/// A sum, and so much more in every lane.
#[inline(always)]
fn after<S: Vector>(simd: S, sum: &Sum, more: Lanes<S>) -> Sums<S> {
    let mut sums = Sums::splat(simd, sum);
    sums.lost = sums.lost + more;
    sums
}
