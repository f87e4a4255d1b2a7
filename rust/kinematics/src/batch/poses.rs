//! Poses along logs: rows are checked, divided between threads and passed to the kernels block by block.

use std::ops::Range;

use super::BLOCK_ROWS;
use crate::geometry::{Steps, Twist};
use crate::pose_logs::integrate::{LARGEST_TOTAL, integrate_logs, integrate_steps};
use crate::pose_logs::logs::Logs;
use crate::rover::Rover;
use crate::se2::accumulate::{Bound, PoseAccumulator};
use crate::table::{Durations, Table};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::sizes::sum_of_sizes;
use six_wheel_numerics::stream::is_large;
use six_wheel_numerics::threads::workers::{Interruption, Workers};

/// Logs up to this long are checked and read several at a time.
const SHORT_LOG: usize = 1024;

/// Blocks of long logs, 2^20 rows, between two questions whether the call is interrupted.
const BLOCKS_BETWEEN_CHECKS: usize = 512;

/// Logs in the lanes of a register: as many as the widest register has.
const GROUP: usize = 8;

/// Logs of `count` steps each, and their starts: one for every log, or one for all.
#[derive(Clone, Copy)]
pub struct PoseLogs<'a> {
    /// Twists, row after row.
    pub twists: Table<'a>,
    /// Steps of a log.
    pub count: usize,
    /// Durations of the steps [s].
    pub steps: Durations<'a>,
    /// First poses.
    pub starts: &'a [[f64; 3]],
    /// The longest step [s].
    pub longest: f64,
    /// Bound of the sum of all magnitudes of a log up to which its poses are finite.
    pub largest: f64,
    /// Rover whose wheel speeds have to be finite too, if any.
    pub rover: Option<&'a Rover>,
    /// True if poses of a log on its own are written past the caches.
    pub non_temporal: bool,
}

/// Memory of one thread for what has to be read.
#[derive(Default)]
pub struct Buffers {
    /// Twists that were read.
    pub twists: Vec<f64>,
    /// Durations that were read [s].
    pub steps: Vec<f64>,
}

impl<'a> PoseLogs<'a> {
    /// Fails where a duration is negative or not finite, or their number is not `count`.
    #[inline]
    pub fn new(twists: Table<'a>, count: usize, steps: Durations<'a>, starts: &'a [[f64; 3]]) -> Result<Self, Error> {
        Ok(Self {
            twists,
            count,
            steps,
            starts,
            longest: steps.check(count, BLOCK_ROWS)?,
            largest: LARGEST_TOTAL,
            rover: None,
            non_temporal: false,
        })
    }

    /// First pose of a log.
    #[inline]
    pub fn start(&self, log: usize) -> [f64; 3] {
        let one = self.starts.len() == 1;
        self.starts[if one { 0 } else { log }]
    }

    /// True if several logs are computed together, one in every lane. It depends on the length of a log alone, so that
    /// no result depends on the other logs.
    #[inline]
    pub fn is_side_by_side(&self) -> bool {
        self.count <= SHORT_LOG
    }

    /// Number of logs that are read at a time.
    #[inline]
    pub fn block(&self) -> usize {
        (BLOCK_ROWS / self.count.max(1)).next_multiple_of(GROUP).max(GROUP)
    }

    /// First steps of the blocks of a log, each after the question whether the call is interrupted where that is due,
    /// counted over all logs.
    fn blocks(&self, log: usize, interruption: &Interruption) -> impl Iterator<Item = Result<usize, Error>> {
        let count = self.count.div_ceil(BLOCK_ROWS);
        (0..count).map(move |k| {
            if (log * count + k) % BLOCKS_BETWEEN_CHECKS == BLOCKS_BETWEEN_CHECKS - 1 {
                interruption.check()?;
            }
            Ok(k * BLOCK_ROWS)
        })
    }

    /// The steps of a log from `first` on, at most a block of them.
    fn piece<'b>(&self, log: usize, first: usize, buffers: &'b mut Buffers) -> (&'b [[f64; 3]], Steps<'b>)
    where
        'a: 'b,
    {
        let end = self.count.min(first + BLOCK_ROWS);
        let from = log * self.count;
        let numbers = self.twists.get(3 * (from + first), 3 * (from + end), &mut buffers.twists);
        let steps = self.steps.get(first, end, &mut buffers.steps);
        (numbers.as_chunks().0, steps)
    }

    /// All steps of some short logs.
    pub fn logs<'b>(&self, logs: Range<usize>, buffers: &'b mut Buffers) -> Logs<'b>
    where
        'a: 'b,
    {
        let (first, end) = (logs.start * self.count, logs.end * self.count);
        let numbers = self.twists.get(3 * first, 3 * end, &mut buffers.twists);
        Logs {
            twists: numbers.as_chunks().0,
            count: self.count,
            steps: self.steps.get(0, self.count, &mut buffers.steps),
            starts: match self.starts {
                [_] => self.starts,
                starts => &starts[logs],
            },
        }
    }

    /// Sum of the magnitudes of the first pose: its share of the bound of all others.
    fn size_of_start(&self, log: usize) -> f64 {
        self.start(log).iter().map(|value| value.abs()).sum()
    }

    /// True if a start and twists with these sums of magnitudes lead to finite poses. False for NaN.
    fn is_small(&self, start: f64, sizes: f64) -> bool {
        start + sizes * self.longest * 2.0 <= self.largest
    }

    /// Fails at the first step that does not lead to a finite pose, or once the call is interrupted.
    pub fn check(&self, level: Level, logs: Range<usize>, interruption: &Interruption) -> Result<(), Error> {
        let buffers = &mut Buffers::default();
        let short = self.count <= SHORT_LOG;
        let mut rest = logs;
        while short && !rest.is_empty() {
            let end = if self.twists.is_read() { rest.end.min(rest.start + self.block()) } else { rest.end };
            let block = rest.start..end;
            let (first, last) = (3 * block.start * self.count, 3 * end * self.count);
            let numbers = self.twists.get(first, last, &mut buffers.twists);
            let starts = match self.starts {
                [_] => self.size_of_start(0),
                _ => block.clone().map(|log| self.size_of_start(log)).sum(),
            };
            if !self.is_small(starts, sum_of_sizes(level, numbers)) {
                for log in block {
                    self.check_steps(log, buffers, interruption)?;
                }
            }
            rest.start = end;
        }
        for log in rest {
            let mut bound = LogBound::new(self, log);
            for first in self.blocks(log, interruption) {
                let twists = self.piece(log, first?, buffers).0;
                if !bound.holds(level, twists) {
                    self.check_steps(log, buffers, interruption)?;
                    break;
                }
            }
            // The start of a log without steps.
            if !bound.holds(level, &[]) {
                self.check_steps(log, buffers, interruption)?;
            }
        }
        Ok(())
    }

    /// [`Self::check`] of one log, step by step.
    fn check_steps(&self, log: usize, buffers: &mut Buffers, interruption: &Interruption) -> Result<(), Error> {
        let mut bound = Bound::new(self.start(log))?;
        for first in self.blocks(log, interruption) {
            let first = first?;
            let (twists, steps) = self.piece(log, first, buffers);
            let from = log * self.count + first;
            for (k, twist) in twists.iter().enumerate() {
                bound.extend(twist, steps.get(k)).map_err(|error| error.at_row(from + k))?;
                if let Some(rover) = self.rover {
                    rover.check_speeds(Twist::from(*twist)).map_err(|error| error.at_row(from + k))?;
                }
            }
        }
        Ok(())
    }

    /// The poses of one log, block by block, checked first unless `checked`.
    #[inline]
    pub fn integrate(
        &self,
        level: Level,
        log: usize,
        mut checked: bool,
        poses: &mut [[f64; 3]],
        buffers: &mut Buffers,
        interruption: &Interruption,
    ) -> Result<(), Error> {
        let start = self.start(log);
        let Some((first, poses)) = poses.split_first_mut() else {
            return Ok(());
        };
        *first = start;
        let mut bound = LogBound::new(self, log);
        if !(checked || bound.holds(level, &[])) {
            self.check_steps(log, buffers, interruption)?;
            checked = true;
        }
        let mut pose = PoseAccumulator::new(start);
        for (first, poses) in self.blocks(log, interruption).zip(poses.chunks_mut(BLOCK_ROWS)) {
            let first = first?;
            let (twists, steps) = self.piece(log, first, buffers);
            if checked || bound.holds(level, twists) {
                integrate_steps(level, twists, steps, poses, self.non_temporal, &mut pose);
                continue;
            }
            self.check_steps(log, buffers, interruption)?;
            checked = true;
            let (twists, steps) = self.piece(log, first, buffers);
            integrate_steps(level, twists, steps, poses, self.non_temporal, &mut pose);
        }
        Ok(())
    }
}

/// A sufficient form of [`Bound`]: the sum of all magnitudes times the longest step.
struct LogBound<'j, 'a> {
    pose_logs: &'j PoseLogs<'a>,
    start: f64,
    sizes: f64,
}

impl<'j, 'a> LogBound<'j, 'a> {
    fn new(pose_logs: &'j PoseLogs<'a>, log: usize) -> Self {
        Self { pose_logs, start: pose_logs.size_of_start(log), sizes: 0.0 }
    }

    /// True if all poses up to the end of these twists are finite by this bound.
    fn holds(&mut self, level: Level, twists: &[[f64; 3]]) -> bool {
        self.sizes += sum_of_sizes(level, twists.as_flattened());
        self.pose_logs.is_small(self.start, self.sizes)
    }
}

/// Poses along logs of `count` twists each, every twist held over its step: exact, whatever its length.
///
/// There is one start per log, or one for all; `poses` takes `count + 1` rows per log, the first of which is its
/// start. Rows of errors count over all logs.
pub fn integrate<'a>(
    twists: impl Into<Table<'a>>,
    count: usize,
    steps: impl Into<Durations<'a>>,
    starts: &'a [[f64; 3]],
    poses: &mut [[f64; 3]],
    workers: Workers,
) -> Result<(), Error> {
    let Workers { level, fresh, .. } = workers.here();
    let pose_logs = PoseLogs {
        non_temporal: is_large(poses.as_flattened().len()),
        ..PoseLogs::new(twists.into(), count, steps.into(), starts)?
    };
    let logs = poses.len() / (count + 1);
    let share = workers.share_of_logs(logs, count);
    if !fresh {
        let shares = (0..logs).step_by(share);
        workers.for_each_long(shares, |first, interruption| {
            pose_logs.check(level, first..logs.min(first + share), interruption)
        })?;
    }
    let targets = poses.chunks_mut(share * (count + 1)).enumerate();
    workers.for_each_long(targets, |(k, poses), interruption| {
        let buffers = &mut Buffers::default();
        let first = k * share;
        if count > SHORT_LOG {
            for (k, poses) in poses.chunks_exact_mut(count + 1).enumerate() {
                pose_logs.integrate(level, first + k, !fresh, poses, buffers, interruption)?;
            }
            return Ok(());
        }
        let block = pose_logs.block();
        for (k, poses) in poses.chunks_mut(block * (count + 1)).enumerate() {
            let first = first + k * block;
            let logs = first..first + poses.len() / (count + 1);
            if fresh {
                pose_logs.check(level, logs.clone(), interruption)?;
            }
            integrate_logs(level, pose_logs.logs(logs, buffers), poses, pose_logs.non_temporal);
        }
        Ok(())
    })
}
