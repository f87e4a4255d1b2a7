//! The last samples with the states after them, for poses from outside that come late: the state is restored at the
//! sample of the pose's instant and corrected, and the samples after it are integrated again.
//!
//! The same history serves poses in the plane and in space: `R` holds the readings of a step, `S` is the state after it, `P`
//! a pose from outside with its covariance.

use std::collections::VecDeque;

use crate::settings::Settings;
use six_wheel_numerics::error::{Error, ErrorKind, number};

/// Part of a history entry, copied without allocation.
pub trait Snapshot: Clone {
    /// Copies another one of the same size.
    fn copy_from(&mut self, other: &Self);

    /// Bytes that it holds on the heap, at most.
    fn heap_size(&self) -> usize {
        0
    }
}

/// A sample with the step that ends there, and the state after it.
#[derive(Clone, Debug)]
pub struct HistoryEntry<R, S> {
    /// Time of the sample [s].
    pub stamp: f64,
    /// Duration of the step [s].
    pub dt: f64,
    /// Readings of the step.
    pub readings: R,
    /// State after it.
    pub state: S,
}

/// A pose from outside, propagated to the stamp of an entry.
#[derive(Clone, Copy, Debug)]
struct Correction<P> {
    entry: u64,
    pose: P,
}

/// Instant of a pose from outside among the entries.
#[derive(Debug)]
pub struct Instant<'a, S> {
    /// Number of the first entry at or after it, or of the last one; None where no entry is kept.
    pub number: Option<u64>,
    /// State of the entry, from or to which its twist is constant; the state after the last sample where no entry is
    /// kept.
    pub state: &'a S,
    /// Time of that state [s].
    pub stamp: f64,
}

/// Samples for which memory is reserved at the start.
const INITIAL_CAPACITY: usize = 1024;

/// A ring buffer of samples. Its memory is reserved for [`INITIAL_CAPACITY`] samples at the start, and doubled when it
/// is full.
#[derive(Clone, Debug)]
pub struct History<R, S, P> {
    /// Entry `k` at index `(k - base) % capacity`, those from `first` to `next`.
    entries: Vec<HistoryEntry<R, S>>,
    /// In the order in which they came.
    corrections: VecDeque<Correction<P>>,
    capacity: usize,
    base: u64,
    first: u64,
    next: u64,
    /// Largest capacity.
    limit: usize,
    /// Largest delay of a pose [s].
    lag: f64,
    /// Duration of the last step [s]; 0 if there was none.
    last_dt: f64,
}

impl<R: Snapshot, S: Snapshot, P: Copy> History<R, S, P> {
    /// Without entries.
    pub fn new(settings: &Settings) -> Self {
        let limit = if settings.lag > 0.0 { settings.history.max(2) } else { 0 };
        let capacity = limit.min(INITIAL_CAPACITY);
        Self {
            entries: Vec::with_capacity(capacity),
            corrections: VecDeque::with_capacity(capacity),
            capacity,
            base: 0,
            first: 0,
            next: 0,
            limit,
            lag: settings.lag,
            last_dt: 0.0,
        }
    }

    /// Makes all entries with the memory on the heap that each of them holds, so that no sample allocates.
    #[must_use]
    pub fn filled(mut self, readings: &R, state: &S) -> Self {
        let entry = HistoryEntry { stamp: 0.0, dt: 0.0, readings: readings.clone(), state: state.clone() };
        self.entries.resize(self.capacity, entry);
        self
    }

    /// Removes every entry and correction.
    #[inline]
    pub fn clear(&mut self) {
        self.first = self.next;
        self.corrections.clear();
        self.last_dt = 0.0;
    }

    /// Duration of the last step [s]; 0 if there was none.
    #[inline]
    pub fn last_duration(&self) -> f64 {
        self.last_dt
    }

    fn index(&self, entry: u64) -> usize {
        ((entry - self.base) % self.capacity as u64) as usize
    }

    fn entry(&self, number: u64) -> &HistoryEntry<R, S> {
        &self.entries[self.index(number)]
    }

    /// Enlarges the memory if a sample at this stamp would replace one inside the lag. Fails if there is not enough.
    #[inline]
    pub fn make_room(&mut self, stamp: f64) -> Result<(), Error> {
        let is_full = self.capacity > 0 && self.next - self.first == self.capacity as u64;
        if !is_full || self.capacity >= self.limit || self.is_too_old(self.first, stamp) {
            return Ok(());
        }
        self.double_capacity()
    }

    /// True if an update may fail: with `strict`, or while the memory may have to be enlarged. Fails if an update may
    /// fail and there is no memory for a copy.
    pub fn needs_copy(&self, strict: bool) -> Result<bool, Error> {
        let may_fail = strict || self.capacity < self.limit;
        if may_fail { self.check_room(self.entries.len()).map(|()| true) } else { Ok(false) }
    }

    /// Fails unless there is memory for `more` entries with what each of them holds on the heap. It is reserved in one
    /// piece and released, so that small allocations do not fail later.
    fn check_room(&self, more: usize) -> Result<(), Error> {
        let Some(entry) = self.entries.first() else {
            return Ok(());
        };
        let each = size_of::<HistoryEntry<R, S>>() + entry.readings.heap_size() + entry.state.heap_size();
        let probe = Vec::<u8>::new().try_reserve_exact(each.saturating_mul(more));
        probe.map_err(|_| {
            let total = self.entries.len().saturating_add(more).to_string();
            Error::value("history", "fit into memory", total).of_kind(ErrorKind::Memory)
        })
    }

    #[cold]
    fn double_capacity(&mut self) -> Result<(), Error> {
        let grown = self.limit.min(2 * self.capacity);
        // Memory for the entries that are moved, and for the new ones.
        self.check_room(2 * grown)?;
        // The oldest entry becomes index 0.
        let oldest = self.index(self.first);
        self.entries.rotate_left(oldest);
        (self.base, self.capacity) = (self.first, grown);
        self.entries.resize(grown, self.entries[0].clone());
        Ok(())
    }

    fn is_too_old(&self, entry: u64, stamp: f64) -> bool {
        self.entry(entry).stamp < stamp - self.lag
    }

    /// Adds a sample `[stamp, dt]` [s] with the state after it, in place of the oldest one if the ring is full. `write`
    /// overwrites the readings of an entry, `make` makes new ones.
    #[inline]
    pub fn push(&mut self, [stamp, dt]: [f64; 2], state: &S, make: impl FnOnce() -> R, write: impl FnOnce(&mut R)) {
        self.last_dt = dt;
        if self.capacity == 0 {
            return;
        }
        let index = self.index(self.next);
        if index < self.entries.len() {
            let entry = &mut self.entries[index];
            (entry.stamp, entry.dt) = (stamp, dt);
            write(&mut entry.readings);
            entry.state.copy_from(state);
        } else {
            self.entries.push(HistoryEntry { stamp, dt, readings: make(), state: state.clone() });
        }
        self.next += 1;
        self.first = self.first.max(self.next.saturating_sub(self.capacity as u64));
        while self.first < self.next && self.is_too_old(self.first, stamp) {
            self.first += 1;
        }
        while self.corrections.front().is_some_and(|known| known.entry < self.first) {
            self.corrections.pop_front();
        }
    }

    /// Instant of a pose at this stamp. Fails unless it lies between the oldest entry and the largest lag after the
    /// `last` sample, after which the state is `current`.
    pub fn locate<'a>(&'a self, stamp: f64, last: Option<f64>, current: &'a S) -> Result<Instant<'a, S>, Error> {
        let Some(last) = last.filter(|_| stamp.is_finite()) else {
            return Err(Error::value("stamp", "be finite and follow a first sample", number(stamp)));
        };
        let is_empty = self.first == self.next;
        let oldest = if is_empty {
            last - self.last_dt
        } else {
            let entry = self.entry(self.first);
            entry.stamp - entry.dt
        };
        let lag = self.lag.max(self.last_dt);
        if stamp < oldest || stamp - last > lag {
            let rule = format!("be between {} and {}, as lag and history allow", number(oldest), number(last + lag));
            return Err(Error::value("stamp", rule, number(stamp)));
        }
        if is_empty {
            return Ok(Instant { number: None, state: current, stamp: last });
        }
        let mut number = self.next - 1;
        while number > self.first && self.entry(number - 1).stamp >= stamp {
            number -= 1;
        }
        let HistoryEntry { stamp, state, .. } = self.entry(number);
        Ok(Instant { number: Some(number), state, stamp: *stamp })
    }

    /// Restores the state of an entry, corrects it by a pose, and integrates the samples after it again, with the
    /// corrections at them. `integrate` makes the step from one entry to the next, `correct` is the correction at an
    /// entry. The pose is stored, in place of the oldest one if there are too many.
    pub fn correct(
        &mut self,
        number: u64,
        pose: P,
        state: &mut S,
        mut integrate: impl FnMut(&mut S, &R, &HistoryEntry<R, S>),
        correct: impl Fn(&mut S, &R, &P),
    ) {
        let index = self.index(number);
        let entry = &mut self.entries[index];
        state.copy_from(&entry.state);
        correct(state, &entry.readings, &pose);
        entry.state.copy_from(state);
        for later in number + 1..self.next {
            let (before, index) = (self.index(later - 1), self.index(later));
            let entry = &self.entries[index];
            integrate(state, &self.entries[before].readings, entry);
            for known in self.corrections.iter().filter(|known| known.entry == later) {
                correct(state, &entry.readings, &known.pose);
            }
            self.entries[index].state.copy_from(state);
        }
        self.push_correction(Correction { entry: number, pose });
    }

    fn push_correction(&mut self, correction: Correction<P>) {
        let is_full = self.corrections.len() >= self.limit || self.corrections.try_reserve(1).is_err();
        if is_full && self.corrections.pop_front().is_none() {
            return;
        }
        self.corrections.push_back(correction);
    }
}
