//! The last samples, so that a pose from outside may come late: the state goes back to it and the samples after it
//! are taken in again.

use nalgebra::Matrix3;

use super::state::{State, check_covariance, check_pose, follow, meet_yaw};
use super::step::Motion;
use super::{Odometry, Readings, Sample, Settings};
use crate::error::{Error, ErrorKind, number};
use crate::geometry::{Pose, wrap_angle};

/// A sample with the state after it.
#[derive(Clone, Debug)]
struct Entry {
    stamp: f64,
    dt: f64,
    angles: Vec<f64>,
    turned: Vec<f64>,
    yaw: Option<f64>,
    gyro_turn: Option<f64>,
    state: State,
}

/// A pose from outside, brought to the stamp of an entry.
#[derive(Clone, Copy, Debug)]
struct Correction {
    entry: u64,
    pose: Pose,
    covariance: Matrix3<f64>,
}

/// Bytes that a piece of memory takes beside what is asked for, at most.
const OVERHEAD: usize = 32;

/// Samples for which there is room from the start.
const FEW: usize = 1024;

/// A ring of samples. Its memory for the first [`FEW`] is taken at the start, and grows as more have to be kept.
#[derive(Clone, Debug)]
pub(crate) struct History {
    /// Entry `k` at place `k % entries.len()`, those from `first` to `next`.
    entries: Vec<Entry>,
    corrections: Vec<Correction>,
    /// Number of the oldest entry and of the next one.
    first: u64,
    next: u64,
    /// Where the oldest correction is, once there is no room for more.
    oldest_correction: usize,
    /// Samples to keep at most.
    most: usize,
    lag: f64,
    last_dt: f64,
    /// Stamp of the last command, if no sample came since.
    pub commanded: Option<f64>,
}

impl History {
    pub fn new(settings: &Settings, state: &State, wheels: usize, joints: usize) -> Self {
        let most = if settings.lag > 0.0 { settings.history.max(2) } else { 0 };
        let capacity = most.min(FEW);
        let entry = Entry {
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

    fn place(&self, entry: u64) -> usize {
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
        self.grow()
    }

    /// Whether more samples may have to be kept than there is room for now.
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
        let each = size_of::<Entry>() + numbers * size_of::<f64>() + lasting + 4 * OVERHEAD;
        let probe = Vec::<u8>::new().try_reserve_exact(each.saturating_mul(more));
        probe.map_err(|_| {
            let total = self.entries.len().saturating_add(more).to_string();
            Error::value("history", "fit into memory", total).of_kind(ErrorKind::Memory)
        })
    }

    /// Twice as much room.
    #[cold]
    fn grow(&mut self) -> Result<(), Error> {
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
            self.keep(sample, dt, angles, turned, gyro_turn, state);
        }
    }

    #[inline(never)]
    fn keep(
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
    fn remember(&mut self, correction: Correction) {
        let is_full = self.corrections.len() >= self.most;
        if !is_full && self.corrections.try_reserve(1).is_ok() {
            self.corrections.push(correction);
        } else if !self.corrections.is_empty() {
            self.corrections[self.oldest_correction] = correction;
            self.oldest_correction = (self.oldest_correction + 1) % self.corrections.len();
        }
    }
}

impl State {
    /// Moves the pose towards one from outside.
    fn meet(&mut self, pose: Pose, covariance: &Matrix3<f64>) {
        let gain = self.uncertainty.correct(covariance);
        let here = self.pose();
        let mut apart = nalgebra::Vector3::new(pose.x - here.x, pose.y - here.y, wrap_angle(pose.yaw - here.yaw));
        for (part, variance) in apart.iter_mut().zip(covariance.diagonal().iter()) {
            if variance.is_infinite() {
                *part = 0.0;
            }
        }
        self.shift(&(gain * apart));
    }
}

impl Odometry {
    /// A pose from outside at some instant of the last `lag` seconds, with its covariance in world axes, infinite
    /// variances where it says nothing. Between two samples the rover is taken to be on the arc of the step; after
    /// the last one it is taken to have gone on as before.
    pub fn correct(&mut self, pose: Pose, stamp: f64, covariance: [[f64; 3]; 3]) -> Result<(), Error> {
        let covariance = check_covariance(covariance)?;
        check_pose(&<[f64; 3]>::from(pose))?;
        let Some(last) = self.stamp().filter(|_| stamp.is_finite()) else {
            let rule = "be finite and follow a first sample";
            return Err(Error::value("stamp", rule, number(stamp)));
        };
        let history = &self.history;
        let oldest = match history.entries.is_empty() || history.first == history.next {
            true => last - history.last_dt,
            false => {
                let entry = &history.entries[history.place(history.first)];
                entry.stamp - entry.dt
            }
        };
        if stamp < oldest || stamp - last > history.lag.max(history.last_dt) {
            let rule = format!(
                "be between {} and {}, as lag and history allow",
                number(oldest),
                number(last + history.lag.max(history.last_dt))
            );
            return Err(Error::value("stamp", rule, number(stamp)));
        }
        // The first entry at or after it.
        let mut at = history.next.saturating_sub(1).max(history.first);
        while at > history.first && history.entries[history.place(at - 1)].stamp >= stamp {
            at -= 1;
        }
        let kept = !history.entries.is_empty() && history.first < history.next;
        let (twist, then) = if kept {
            let entry = &history.entries[history.place(at)];
            (entry.state.twist, entry.stamp)
        } else {
            (self.state.twist, last)
        };
        let moved = pose.compose(twist.exp(then - stamp));
        let swing = Matrix3::new(
            1.0,
            0.0,
            pose.y - moved.y, //
            0.0,
            1.0,
            moved.x - pose.x, //
            0.0,
            0.0,
            1.0,
        );
        let pose = moved;
        let covariance = if covariance.iter().all(|value| value.is_finite()) {
            swing * covariance * swing.transpose()
        } else {
            covariance
        };
        if !kept {
            self.state.meet(pose, &covariance);
            return Ok(());
        }
        let correction = Correction { entry: at, pose, covariance };
        self.replay(correction);
        self.history.remember(correction);
        Ok(())
    }

    /// Goes back to an entry, corrects it, and takes in again what came after it.
    fn replay(&mut self, correction: Correction) {
        let rules = self.settings.rules();
        let (first, next) = (correction.entry, self.history.next);
        let place = self.history.place(first);
        self.state.copy_from(&self.history.entries[place].state);
        self.state.meet(correction.pose, &correction.covariance);
        self.history.entries[place].state.copy_from(&self.state);
        for number in first + 1..next {
            let (before, place) = (self.history.place(number - 1), self.history.place(number));
            let entry = &self.history.entries[place];
            let motion = Motion {
                steering: [&self.history.entries[before].angles, &entry.angles],
                turned: &entry.turned,
                from_rates: self.settings.readings == Readings::Speeds,
                dt: entry.dt,
                gyro_turn: entry.gyro_turn,
                bias_variance: self.state.uncertainty.bias.map_or(0.0, |bias| bias.variance),
            };
            // It was found the first time and does not depend on the pose: what was taken in is taken in again,
            // however large its noise is said to be by another way of summing it.
            let found = self.work.displacement(&self.rover, motion, &rules);
            let lasting = self.work.find_lasting(&self.rover, motion, rules.method);
            if let (Ok(found), Ok(())) = (found, lasting) {
                follow(found, motion, &self.work, &mut self.state, self.settings.habits());
            }
            if let Some(yaw) = entry.yaw {
                meet_yaw(&mut self.state, yaw, rules.noise.yaw);
            }
            for known in self.history.corrections.iter().filter(|known| known.entry == number) {
                self.state.meet(known.pose, &known.covariance);
            }
            self.history.entries[place].state.copy_from(&self.state);
        }
    }
}
