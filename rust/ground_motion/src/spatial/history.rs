//! The last samples in space, so that a pose from outside may come late: the state goes back to it and the samples
//! after it are taken in again.

use std::collections::VecDeque;

use nalgebra::Matrix6;

use super::sample::Read;
use super::state::State;
use six_wheel_odometry::preintegrated::space::Motion3;
use six_wheel_odometry::settings::Settings;
use six_wheel_terrain::suspension::MAX_WHEELS;

/// A sample with the state after it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) read: Read,
    pub(crate) turned: [f64; MAX_WHEELS],
    pub(crate) dt: f64,
    pub(crate) state: State,
}

/// A pose from outside, brought to the stamp of an entry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Correction {
    pub(crate) entry: u64,
    pub(crate) pose: Motion3,
    pub(crate) covariance: Matrix6<f64>,
}

/// Samples for which there is room from the start.
const FEW: usize = 1024;

/// The last samples, oldest first. Room for the first [`FEW`] is taken at the start, and grows as more have to be kept.
#[derive(Clone, Debug)]
pub(crate) struct History {
    pub(crate) entries: VecDeque<Entry>,
    /// Number of the oldest entry.
    pub(crate) first: u64,
    pub(crate) corrections: VecDeque<Correction>,
    pub(crate) most: usize,
    pub(crate) lag: f64,
}

impl History {
    pub fn new(settings: &Settings) -> Self {
        let most = match settings.lag > 0.0 {
            true => settings.history.max(2),
            false => 0,
        };
        Self {
            entries: VecDeque::with_capacity(most.min(FEW)),
            first: 0,
            corrections: VecDeque::with_capacity(most.min(FEW)),
            most,
            lag: settings.lag,
        }
    }

    pub fn clear(&mut self) {
        self.entries.clear();
        self.corrections.clear();
    }

    /// Number of the entry that comes next.
    pub(crate) fn next(&self) -> u64 {
        self.first + self.entries.len() as u64
    }

    pub(crate) fn place(&self, entry: u64) -> usize {
        (entry - self.first) as usize
    }

    pub(crate) fn forget_oldest(&mut self) {
        self.entries.pop_front();
        self.first += 1;
        while self.corrections.front().is_some_and(|known| known.entry < self.first) {
            self.corrections.pop_front();
        }
    }

    pub fn push(&mut self, read: Read, turned: &[f64; MAX_WHEELS], dt: f64, state: &State) {
        let oldest = read.stamp - self.lag;
        while self.entries.front().is_some_and(|entry| entry.read.stamp < oldest) {
            self.forget_oldest();
        }
        // Without memory for one more the oldest makes room.
        while self.entries.len() >= self.most || self.entries.try_reserve(1).is_err() {
            if self.entries.is_empty() {
                return;
            }
            self.forget_oldest();
        }
        self.entries.push_back(Entry { read, turned: *turned, dt, state: *state });
    }

    /// Remembers a correction; the oldest one makes room.
    pub(crate) fn remember(&mut self, correction: Correction) {
        while self.corrections.len() >= self.most || self.corrections.try_reserve(1).is_err() {
            if self.corrections.pop_front().is_none() {
                return;
            }
        }
        self.corrections.push_back(correction);
    }
}
