//! Poses along many short logs, one in every lane: the rollouts of a sampling planner.

use super::tile::{LANES, LARGEST_HEADING, PerStep, STEPS, Sums, Tile, WIDTH, durations};
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::level::{Kernel, Level};
use crate::batch::machine::polynomials::ROUND;
use crate::batch::machine::vector::Vector;
use crate::geometry::{Steps, Sum, TAU_REST, Walk};

/// Their starts, and one pose after every step.
pub(crate) fn place(level: Level, logs: Logs<'_>, poses: &mut [[f64; 3]]) {
    level.run(Place { logs, poses });
}

/// Logs of `count` steps each that have been checked, with one start for every log or one for all.
#[derive(Clone, Copy)]
pub(crate) struct Logs<'a> {
    pub twists: &'a [[f64; 3]],
    pub count: usize,
    pub steps: Steps<'a>,
    pub starts: &'a [[f64; 3]],
}

/// Something that follows the steps of a group of logs, tile by tile.
pub(crate) trait Watch<S: Vector> {
    /// Twists of the next steps, number by number, and how long they are held.
    fn tile(&mut self, simd: S, twists: &[S::f64s; WIDTH], dts: &PerStep<S>);
}

impl<S: Vector> Watch<S> for () {
    #[inline(always)]
    fn tile(&mut self, _: S, _: &[S::f64s; WIDTH], _: &PerStep<S>) {}
}

struct Place<'a> {
    logs: Logs<'a>,
    poses: &'a mut [[f64; 3]],
}

impl Kernel for Place<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let group = S::F64_LANES * (self.logs.count + 1);
        for (k, poses) in self.poses.chunks_mut(group).enumerate() {
            side_by_side(simd, self.logs, k * S::F64_LANES, poses, &mut ());
        }
    }
}

/// As many logs as there are lanes, from log `first` on, or fewer.
#[inline(always)]
pub(crate) fn side_by_side<S: Vector>(
    simd: S,
    logs: Logs<'_>,
    first: usize,
    poses: &mut [[f64; 3]],
    watch: &mut impl Watch<S>,
) {
    let Logs { count, steps, .. } = logs;
    let starts = match logs.starts {
        [start] => [*start; LANES],
        starts => {
            let mut own = [[0.0; 3]; LANES];
            for (own, start) in own.iter_mut().zip(&starts[first..]) {
                *own = *start;
            }
            own
        }
    };
    let mut logs = logs.twists[first * count..].chunks_exact(count.max(1));
    let logs: [&[[f64; 3]]; LANES] = std::array::from_fn(|_| logs.next().unwrap_or_default());
    let tiles = logs.map(|log| log.as_flattened().as_chunks().0);
    let mut targets = poses.chunks_exact_mut(count + 1);
    let mut targets = starts.map(|start| {
        let (first, poses) = targets.next()?.split_first_mut()?;
        *first = start;
        Some(poses.as_flattened_mut().as_chunks_mut())
    });
    let mut walks = Walks::new(simd, &starts);
    let constant = durations(simd, steps, 0);
    let mut tile = Tile::new(simd);
    // The last steps, and lanes without a log: what is missing stands still.
    let mut padded = [[0.0; WIDTH]; LANES];
    let mut spare = padded;
    for k in 0..count.div_ceil(STEPS) {
        let first = k * STEPS;
        let (dts, steps) = match steps {
            Steps::Constant(dt) => (constant, Steps::Constant(dt)),
            Steps::Each(each) => (durations(simd, steps, first), Steps::Each(&each[first..])),
        };
        if count - first < STEPS {
            for (padded, log) in padded.iter_mut().zip(logs) {
                let numbers = log.get(first..).unwrap_or_default().as_flattened();
                padded[..numbers.len()].copy_from_slice(numbers);
            }
        }
        let twists: [&[f64; WIDTH]; LANES] =
            std::array::from_fn(|lane| tiles[lane].get(k).unwrap_or(&padded[lane]));
        let mut poses = spare.each_mut();
        for (poses, target) in poses.iter_mut().zip(&mut targets) {
            if let Some(whole) = target.as_mut().and_then(|(whole, _)| whole.get_mut(k)) {
                *poses = whole;
            }
        }
        let before = walks;
        tile.read(simd, &twists);
        watch.tile(simd, &tile.numbers, &dts);
        let (turn, near) = tile.turn(simd, &dts, Some(&walks.yaw));
        let way = tile.walk(simd, &walks.heading, Some([&walks.x, &walks.y]));
        tile.write(simd, &mut poses);
        walks.step(simd, way, turn);
        let near = near & before.heading.is_usual(simd);
        if (!near).any() {
            let mut marks = [0.0; LANES];
            let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
            near.select(zero, one)
                .store(S::as_mut_simd_f64s(&mut marks).0, 0);
            for lane in (0..LANES).filter(|lane| marks[*lane] != 0.0) {
                let mut walk = before.lane(lane);
                let count = STEPS.min(count - first);
                walk.follow(
                    &twists[lane].as_chunks().0[..count],
                    steps,
                    &mut poses[lane].as_chunks_mut().0[..count],
                );
                walks.set_lane(simd, lane, walk);
            }
        }
    }
    for (target, spare) in targets.iter_mut().zip(spare) {
        if let Some((_, rest)) = target {
            rest.copy_from_slice(&spare[..rest.len()]);
        }
    }
}

/// A pose on its way, in every lane: see [`Walk`].
#[derive(Clone, Copy)]
struct Walks<S: Vector> {
    x: Sums<S>,
    y: Sums<S>,
    yaw: Sums<S>,
    heading: Sums<S>,
}

impl<S: Vector> Sums<S> {
    #[inline(always)]
    fn is_usual(&self, simd: S) -> Mask<S> {
        let largest = Lanes::splat(simd, LARGEST_HEADING);
        self.sum.abs().at_most(largest)
    }

    /// One sum per lane.
    #[inline(always)]
    fn of(simd: S, lanes: [Sum; LANES]) -> Self {
        let load = |lanes: [f64; LANES]| Lanes::load(simd, S::as_simd_f64s(&lanes).0, 0);
        Self {
            sum: load(lanes.map(|lane| lane.sum)),
            lost: load(lanes.map(|lane| lane.lost)),
        }
    }

    /// The sum of one lane.
    #[inline(always)]
    fn lane(&self, lane: usize) -> Sum {
        let [mut sum, mut lost] = [[0.0; LANES]; 2];
        self.sum.store(S::as_mut_simd_f64s(&mut sum).0, 0);
        self.lost.store(S::as_mut_simd_f64s(&mut lost).0, 0);
        Sum {
            sum: sum[lane],
            lost: lost[lane],
        }
    }

    #[inline(always)]
    fn set_lane(&mut self, simd: S, lane: usize, to: Sum) {
        for (register, value) in [(&mut self.sum, to.sum), (&mut self.lost, to.lost)] {
            let mut values = [0.0; LANES];
            register.store(S::as_mut_simd_f64s(&mut values).0, 0);
            values[lane] = value;
            *register = Lanes::load(simd, S::as_simd_f64s(&values).0, 0);
        }
    }
}

impl<S: Vector> Walks<S> {
    #[inline(always)]
    fn new(simd: S, starts: &[[f64; 3]; LANES]) -> Self {
        let mut walks = [Walk::new(starts[0]); LANES];
        for lane in 1..S::F64_LANES {
            if starts[lane] != starts[lane - 1] {
                walks[lane] = Walk::new(starts[lane]);
            } else {
                walks[lane] = walks[lane - 1];
            }
        }
        Self {
            x: Sums::of(simd, walks.map(|walk| walk.x)),
            y: Sums::of(simd, walks.map(|walk| walk.y)),
            yaw: Sums::of(simd, walks.map(|walk| walk.yaw)),
            heading: Sums::of(simd, walks.map(|walk| walk.heading)),
        }
    }

    /// [`Walk::shift`] and [`Walk::turn`].
    #[inline(always)]
    fn step(&mut self, simd: S, [x, y]: [Lanes<S>; 2], turn: Lanes<S>) {
        self.x.add(x);
        self.y.add(y);
        self.yaw.add(turn);
        self.heading.add(turn);
        let tau = Lanes::splat(simd, std::f64::consts::TAU);
        let per_turn = Lanes::splat(simd, 1.0 / std::f64::consts::TAU);
        let round = Lanes::splat(simd, ROUND);
        let turns = self.heading.sum.mul_add(per_turn, round) - round;
        let product = turns * tau;
        self.heading.add(-product);
        let rest = turns.mul_add(tau, -product) + turns * Lanes::splat(simd, TAU_REST);
        self.heading.lost = self.heading.lost - rest;
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> Walk {
        Walk {
            x: self.x.lane(lane),
            y: self.y.lane(lane),
            yaw: self.yaw.lane(lane),
            heading: self.heading.lane(lane),
        }
    }

    #[inline(always)]
    fn set_lane(&mut self, simd: S, lane: usize, walk: Walk) {
        self.x.set_lane(simd, lane, walk.x);
        self.y.set_lane(simd, lane, walk.y);
        self.yaw.set_lane(simd, lane, walk.yaw);
        self.heading.set_lane(simd, lane, walk.heading);
    }
}
