//! The last samples, so that a pose from outside may come late: the state goes back to it and the samples after it
//! are taken in again.

use nalgebra::Matrix3;

use crate::recording::Sample;
use crate::settings::Settings;
use crate::state::State;
use six_wheel_kinematics::geometry::Pose;
use six_wheel_numerics::error::{Error, ErrorKind};

/// A sample with the state after it.
#[derive(Clone, Debug)]
pub(crate) struct HistoryEntry {
    pub(crate) stamp: f64,
    pub(crate) dt: f64,
    pub(crate) angles: Vec<f64>,
    pub(crate) turned: Vec<f64>,
    pub(crate) yaw: Option<f64>,
    pub(crate) gyro_turn: Option<f64>,
    pub(crate) state: State,
}

/// A pose from outside, brought to the stamp of an entry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Correction {
    pub(crate) entry: u64,
    pub(crate) pose: Pose,
    pub(crate) covariance: Matrix3<f64>,
}

/// Bytes that a piece of memory takes beside what is asked for, at most.
const OVERHEAD: usize = 32;

/// Samples for which there is room from the start.
const FEW: usize = 1024;

/// A ring of samples. Its memory for the first [`FEW`] is taken at the start, and grows as more have to be kept.
#[derive(Clone, Debug)]
pub(crate) struct History {
    /// Entry `k` at place `k % entries.len()`, those from `first` to `next`.
    pub(crate) entries: Vec<HistoryEntry>,
    pub(crate) corrections: Vec<Correction>,
    /// Number of the oldest entry and of the next one.
    pub(crate) first: u64,
    pub(crate) next: u64,
    /// Place of the oldest correction, once there is no room for more.
    pub(crate) oldest_correction: usize,
    /// Samples to keep at most.
    pub(crate) most: usize,
    pub(crate) lag: f64,
    pub(crate) last_dt: f64,
    /// Stamp of the last command, if no sample came since.
    pub commanded: Option<f64>,
}

impl History {
    pub fn new(settings: &Settings, state: &State, wheels: usize, joints: usize) -> Self {
        let most = if settings.lag > 0.0 { settings.history.max(2) } else { 0 };
        let capacity = most.min(FEW);
        let entry = HistoryEntry {
            stamp: 0.0,
            dt: 0.0,
            angles: vec![0.0; joints],
            turned: vec![0.0; wheels],
            yaw: None,
            gyro_turn: None,
            state: state.clone(),
        };
        Self {
            entries: vec![entry; capacity],
            corrections: Vec::with_capacity(capacity),
            first: 0,
            next: 0,
            oldest_correction: 0,
            most,
            lag: settings.lag,
            last_dt: 0.0,
            commanded: None,
        }
    }

    #[inline]
    pub fn clear(&mut self) {
        self.first = self.next;
        self.corrections.clear();
        self.oldest_correction = 0;
        self.last_dt = 0.0;
        self.commanded = None;
    }

    /// Duration of the last step [s]; 0 if there was none.
    pub fn last_duration(&self) -> f64 {
        self.last_dt
    }

    pub(crate) fn place(&self, entry: u64) -> usize {
        (entry % self.entries.len() as u64) as usize
    }

    /// Makes room for one more sample, at this stamp, where what is kept has to stay. Fails where there is none.
    #[inline]
    pub fn make_room(&mut self, stamp: f64) -> Result<(), Error> {
        let length = self.entries.len();
        let is_full = length > 0 && self.next - self.first == length as u64;
        if !is_full || length >= self.most || self.is_too_old(self.first, stamp) {
            return Ok(());
        }
        self.double_capacity()
    }

    /// True if more samples may have to be kept than there is room for now.
    pub fn may_grow(&self) -> bool {
        self.entries.len() < self.most
    }

    /// Fails unless there is memory for a copy of all of it.
    pub fn check_copy(&self) -> Result<(), Error> {
        self.check_room(self.entries.len())
    }

    /// Fails unless there is memory for so many more entries and what they hold. It is asked for in one piece and
    /// given back: there are no small requests that may fail.
    fn check_room(&self, more: usize) -> Result<(), Error> {
        let Some(entry) = self.entries.first() else {
            return Ok(());
        };
        let uncertainty = &entry.state.uncertainty;
        let numbers = entry.angles.len() + entry.turned.len() + 3 * uncertainty.carried.len();
        let lasting = size_of_val(uncertainty.lasting.as_slice());
        let each = size_of::<HistoryEntry>() + numbers * size_of::<f64>() + lasting + 4 * OVERHEAD;
        let probe = Vec::<u8>::new().try_reserve_exact(each.saturating_mul(more));
        probe.map_err(|_| {
            let total = self.entries.len().saturating_add(more).to_string();
            Error::value("history", "fit into memory", total).of_kind(ErrorKind::Memory)
        })
    }

    /// Twice as much room.
    #[cold]
    fn double_capacity(&mut self) -> Result<(), Error> {
        let grown = self.most.min(2 * self.entries.len());
        // The entries move to a larger place, and the new ones are made.
        self.check_room(2 * grown)?;
        // The oldest first, so that numbers and places go together again.
        let oldest = self.place(self.first);
        self.entries.rotate_left(oldest);
        self.entries.resize(grown, self.entries[0].clone());
        let shift = (self.first % grown as u64) as usize;
        self.entries.rotate_right(shift);
        Ok(())
    }

    fn is_too_old(&self, entry: u64, stamp: f64) -> bool {
        self.entries[self.place(entry)].stamp < stamp - self.lag
    }

    #[inline]
    pub fn push(
        &mut self,
        sample: &Sample<'_>,
        dt: f64,
        angles: &[f64],
        turned: &[f64],
        gyro_turn: Option<f64>,
        state: &State,
    ) {
        self.last_dt = dt;
        self.commanded = None;
        if !self.entries.is_empty() {
            self.push_entry(sample, dt, angles, turned, gyro_turn, state);
        }
    }

    #[inline(never)]
    fn push_entry(
        &mut self,
        sample: &Sample<'_>,
        dt: f64,
        angles: &[f64],
        turned: &[f64],
        gyro_turn: Option<f64>,
        state: &State,
    ) {
        let capacity = self.entries.len() as u64;
        let place = self.place(self.next);
        let entry = &mut self.entries[place];
        entry.stamp = sample.stamp;
        entry.dt = dt;
        entry.angles.copy_from_slice(angles);
        entry.turned.copy_from_slice(turned);
        entry.yaw = sample.yaw;
        entry.gyro_turn = gyro_turn;
        entry.state.copy_from(state);
        self.next += 1;
        self.first = self.first.max(self.next.saturating_sub(capacity));
        while self.first < self.next && self.is_too_old(self.first, sample.stamp) {
            self.first += 1;
        }
    }

    /// Remembers a correction; the oldest one makes room.
    pub(crate) fn remember(&mut self, correction: Correction) {
        let is_full = self.corrections.len() >= self.most;
        if !is_full && self.corrections.try_reserve(1).is_ok() {
            self.corrections.push(correction);
        } else if !self.corrections.is_empty() {
            self.corrections[self.oldest_correction] = correction;
            self.oldest_correction = (self.oldest_correction + 1) % self.corrections.len();
        }
    }
}
