//! Inverse and forward kinematics of many rows: rows are checked, divided between threads and passed to the kernels
//! block by block.

use std::ops::Range;

use super::BLOCK_ROWS;
use crate::estimate::{Readings, Unseen};
use crate::geometry::Twist;
use crate::inverse::rows;
use crate::rover::Rover;
use crate::rover_data::Inputs;
use crate::table::{InputTables, Log, Table};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::stream::is_large;
use six_wheel_numerics::threads::workers::Workers;

/// Rows from which on the kernel of many rows takes less time than as many calls of the kernel of one row.
pub(crate) const FEW: usize = 8;

/// Splits rows into blocks of this size.
fn blocks(rows: Range<usize>, size: usize) -> impl Iterator<Item = Range<usize>> {
    let end = rows.end;
    rows.step_by(size).map(move |first| first..end.min(first + size))
}

/// Rows of a block: all of a share, unless a table has to be read.
fn block_of<const N: usize>(share: usize, tables: [Option<Table<'_>>; N]) -> usize {
    if tables.into_iter().flatten().any(Table::is_read) {
        return share.min(BLOCK_ROWS);
    }
    share
}

/// Twists with their optional inputs.
struct Commands<'a> {
    rover: &'a Rover,
    level: Level,
    twists: Table<'a>,
    tables: InputTables<'a>,
    /// True if the outputs are written past the caches.
    non_temporal: bool,
}

impl<'a> Commands<'a> {
    fn rows<'b>(
        &self,
        rows: Range<usize>,
        [twists, previous, speeds, rates]: &'b mut [Vec<f64>; 4],
    ) -> (&'b [[f64; 3]], Inputs<'b>)
    where
        'a: 'b,
    {
        let (joints, wheels) = (self.rover.steered().len(), self.rover.wheels().len());
        let twists = self.twists.rows(rows.clone(), 3, twists);
        let InputTables { previous: held, previous_speeds, steering_rates } = self.tables;
        let inputs = Inputs {
            previous: held.map(|table| table.rows(rows.clone(), joints, previous)),
            previous_speeds: previous_speeds.map(|table| table.rows(rows.clone(), wheels, speeds)),
            steering_rates: steering_rates.map(|table| table.rows(rows, joints, rates)),
        };
        (twists.as_chunks().0, inputs)
    }

    fn check(&self, first: usize, twists: &[[f64; 3]], inputs: Inputs<'_>) -> Result<(), Error> {
        rows::check(self.rover, &self.rover.cone, self.level, twists, inputs, first)
    }

    fn solve(&self, twists: &[[f64; 3]], inputs: Inputs<'_>, steering: &mut [f64], speeds: &mut [f64]) {
        let (rover, level) = (self.rover, self.level);
        if twists.len() >= FEW {
            return rover.inverse_constants.solve_rows(level, twists, inputs, steering, speeds, self.non_temporal);
        }
        let level = if level == Level::Scalar { level } else { rover.inverse_constants.level };
        let joints = rover.steered().len();
        let speeds = speeds.chunks_exact_mut(rover.wheels().len());
        for (k, (twist, speeds)) in twists.iter().zip(speeds).enumerate() {
            let steering = &mut steering[k * joints..(k + 1) * joints];
            let inputs = inputs.row(rover, k);
            rover.solve_row(level, Twist::from(*twist), inputs, [steering, speeds], false);
        }
    }
}

/// [`Rover::inverse`] of every twist.
pub fn inverse<'a>(
    rover: &'a Rover,
    twists: impl Into<Table<'a>>,
    inputs: impl Into<InputTables<'a>>,
    steering: &mut [f64],
    speeds: &mut [f64],
    workers: Workers,
) -> Result<(), Error> {
    let Workers { level, fresh, .. } = workers.here();
    let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
    let (count, tables) = (speeds.len() / wheels, inputs.into());
    let commands =
        Commands { rover, level, twists: twists.into(), tables, non_temporal: is_large(steering.len() + speeds.len()) };
    let share = workers.share(count);
    let (twists, tables) = (Some(commands.twists), commands.tables);
    let block = block_of(share, [twists, tables.previous, tables.previous_speeds, tables.steering_rates]);
    if !fresh {
        workers.for_each((0..count).step_by(share), |first| {
            let buffers = &mut Default::default();
            for rows in blocks(first..count.min(first + share), block) {
                let (twists, inputs) = commands.rows(rows.clone(), buffers);
                commands.check(rows.start, twists, inputs)?;
            }
            Ok(())
        })?;
    }
    let block = if fresh { block.min(BLOCK_ROWS) } else { block };
    // Chunks of size 1 for a rover without steered wheels, whose steering has no elements.
    let mut steering = steering.chunks_mut((share * joints).max(1));
    let targets = speeds.chunks_mut(share * wheels).map(|speeds| (steering.next().unwrap_or_default(), speeds));
    workers.for_each(targets.enumerate(), |(k, (steering, speeds))| {
        let buffers = &mut Default::default();
        let first = k * share;
        for rows in blocks(first..first + speeds.len() / wheels, block) {
            let (twists, inputs) = commands.rows(rows.clone(), buffers);
            if fresh {
                commands.check(rows.start, twists, inputs)?;
            }
            let (from, end) = (rows.start - first, rows.end - first);
            let steering = &mut steering[from * joints..end * joints];
            commands.solve(twists, inputs, steering, &mut speeds[from * wheels..end * wheels]);
        }
        Ok(())
    })
}

/// Readings, and the treatment of motion that they do not determine.
struct Reports<'a> {
    rover: &'a Rover,
    level: Level,
    readings: Readings<Table<'a>>,
    unseen: Unseen,
    /// True if the outputs are written past the caches.
    non_temporal: bool,
}

impl<'a> Reports<'a> {
    fn rows<'b>(&self, rows: Range<usize>, [steering, speeds, rates]: &'b mut [Vec<f64>; 3]) -> Log<'b>
    where
        'a: 'b,
    {
        let (joints, wheels) = (self.rover.steered().len(), self.rover.wheels().len());
        let readings = self.readings;
        Log {
            steering: readings.steering.rows(rows.clone(), joints, steering),
            speeds: readings.speeds.rows(rows.clone(), wheels, speeds),
            steering_rates: readings.steering_rates.map(|table| table.rows(rows, joints, rates)),
        }
    }

    /// Fails at the first row that cannot be read; rows of errors count from the log's first.
    fn check(&self, log: Log<'_>, count: usize) -> Result<(), Error> {
        self.rover.forward_constants.check(self.level, self.rover, log, 0..count, self.unseen)
    }

    fn solve(&self, log: Log<'_>, twists: &mut [[f64; 3]]) -> Result<(), Error> {
        let (rover, unseen) = (self.rover, self.unseen);
        if twists.len() >= FEW {
            let constants = &rover.forward_constants;
            return constants.solve_rows(self.level, rover, log, unseen, twists, self.non_temporal);
        }
        for (k, twist) in twists.iter_mut().enumerate() {
            *twist = rover.forward(log.row(rover, k), unseen)?.into();
        }
        Ok(())
    }
}

/// [`Rover::forward`] of every row of a log.
pub fn forward<'a>(
    rover: &'a Rover,
    readings: impl Into<Readings<Table<'a>>>,
    unseen: Unseen,
    twists: &mut [[f64; 3]],
    workers: Workers,
) -> Result<(), Error> {
    let Workers { level, fresh, .. } = workers.here();
    let (count, readings) = (twists.len(), readings.into());
    let non_temporal = is_large(twists.as_flattened().len());
    let reports = Reports { rover, level, readings, unseen, non_temporal };
    let share = workers.share(count);
    let tables = [Some(readings.steering), Some(readings.speeds), readings.steering_rates];
    let block = block_of(share, tables);
    let check = |rows: Range<usize>, log: Log<'_>| {
        let checked = reports.check(log, rows.len());
        checked.map_err(|error| error.below(rows.start))
    };
    if !fresh {
        workers.for_each((0..count).step_by(share), |first| {
            let buffers = &mut Default::default();
            for rows in blocks(first..count.min(first + share), block) {
                let log = reports.rows(rows.clone(), buffers);
                check(rows, log)?;
            }
            Ok(())
        })?;
    }
    let block = if fresh { block.min(BLOCK_ROWS) } else { block };
    workers.for_each(twists.chunks_mut(share).enumerate(), |(k, twists)| {
        let buffers = &mut Default::default();
        for (b, twists) in twists.chunks_mut(block).enumerate() {
            let first = k * share + b * block;
            let rows = first..first + twists.len();
            let log = reports.rows(rows.clone(), buffers);
            if fresh {
                check(rows, log)?;
            }
            reports.solve(log, twists)?;
        }
        Ok(())
    })
}
