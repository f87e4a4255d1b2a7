//! Motion between two instants by the wheels, as one factor of a graph: the motion, its covariance, and its derivatives
//! with respect to the quantities that an estimator may change afterwards.
//!
//! The motion is `delta = begin_from_end`. Errors and derivatives are in the tangent space of its end,
//! `delta exp(e)`, with e in axes of the body at the end: x [m], y [m], yaw [rad], or all six in space.
//!
//! The motion in the plane is that of [`Odometry`], step by step. Motions in space, cut steps and derivatives are
//! computed from the samples on request ([`replay`]).

mod replay;
mod samples;
pub mod space;

use nalgebra::{Matrix6, Vector6};
use six_wheel_numerics::threads::workers::{BETWEEN_CHECKS, IsInterrupted};

use super::planar::Odometry;
use super::settings::gyroscope::Gyroscope;
pub use super::settings::quantities::{Column, DIMENSIONS};
use super::settings::{Readings, Settings};
use crate::samples::recording::{Recording, Sample};
pub use replay::PreintegratedMotion;
pub use samples::Samples;
use six_wheel_kinematics::geometry::Pose;
use six_wheel_kinematics::rover::Rover;
use six_wheel_numerics::error::{Error, ErrorKind, finite, not_negative, number};
use space::{Motion3, right_jacobian};

/// Rows of a tangent in the plane among those in space.
pub const PLANE: [usize; 3] = [0, 1, 5];

/// Deviation of a quaternion's length from 1 up to which it is normalised, as rounded to few digits.
const UNIT: f64 = 1e-2;

/// Frame in which the errors of a motion are expressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorFrame {
    /// `delta exp(e)`: in axes of the body at the end.
    End,
    /// `exp(e) delta`: in axes of the body at the beginning.
    Begin,
    /// `(x, y, yaw) + e`: coordinates of the end seen from the beginning, as those of [`Odometry::covariance`].
    Coordinates,
}

/// Options of pre-integration.
#[derive(Clone, Debug, PartialEq)]
pub struct PreintegrationOptions {
    /// Settings of the odometry.
    pub settings: Settings,
    /// The gyroscope whose rates come with the samples.
    pub gyroscope: Option<Gyroscope>,
    /// True if every sample has an attitude.
    pub in_space: bool,
    /// Standard deviation of the tilt of an attitude, about x and about y of the body [rad].
    pub attitude_noise: f64,
}

/// Wheel motion between two instants; see the module.
#[derive(Clone, Debug)]
pub struct Preintegrated {
    options: PreintegrationOptions,
    /// Odometry before any sample.
    fresh: Odometry,
    /// Odometry after all samples, in the plane.
    odometry: Odometry,
    samples: Samples,
    /// Fractions of the first and of the last step at which the motion begins and ends, 0 to 1.
    begins: f64,
    ends: f64,
}

/// Residual of two poses against a motion, and its derivatives.
#[derive(Clone, Debug)]
pub struct Residual {
    /// `log(delta⁻¹ pose_i⁻¹ pose_j)`
    pub error: Vector6<f64>,
    /// Derivative of `error` by e in `pose_i exp(e)`.
    pub by_first: Matrix6<f64>,
    /// Derivative of `error` by e in `pose_j exp(e)`.
    pub by_second: Matrix6<f64>,
    /// Derivative of `error` by a change e of the motion, `delta exp(e)`.
    pub by_motion: Matrix6<f64>,
}

impl Preintegrated {
    /// Without samples.
    pub fn new(rover: Rover, options: PreintegrationOptions) -> Result<Self, Error> {
        let mut options = options;
        if let Some(gyroscope) = &options.gyroscope {
            gyroscope.check()?;
            if gyroscope.scale_noise != 0.0 {
                let rule = "be 0: a motion keeps no error that lasts beyond it";
                return Err(Error::value("scale_noise", rule, number(gyroscope.scale_noise)));
            }
            options.settings.noise.yaw_rate = gyroscope.noise;
        }
        not_negative("attitude_noise", options.attitude_noise)?;
        if !options.settings.dimensions.is_empty() {
            return Err(Error::value("dimensions", "be left out: a motion answers to each of them", "some"));
        }
        let odometry = Odometry::new(rover, options.settings.clone())?;
        Ok(Self { fresh: odometry.clone(), odometry, options, samples: Samples::default(), begins: 0.0, ends: 1.0 })
    }

    /// The samples, and the fractions of the first and of the last step at which the motion begins and ends.
    pub fn samples(&self) -> (&Samples, [f64; 2]) {
        (&self.samples, [self.begins, self.ends])
    }

    /// The motion of other samples with the same options: the inverse of [`Self::samples`]. Fails if their numbers do not
    /// match or they do not determine the motion.
    pub fn with_samples(&self, samples: Samples, [begins, ends]: [f64; 2]) -> Result<Self, Error> {
        let count = samples.stamps.len();
        let (wheels, joints) = (self.rover().wheels().len(), self.rover().steered().len());
        let attitudes = if self.options.in_space { count } else { 0 };
        let lengths = [samples.steering.len(), samples.wheels.len(), samples.rates.len(), samples.attitudes.len()];
        if lengths != [count * joints, count * wheels, count, attitudes] {
            return Err(Error::value("samples", "have as many rows as stamps", format!("{lengths:?}")));
        }
        let source = Self { samples, ..self.clone() };
        source.part(0..count, begins, ends)
    }

    /// The rover.
    #[inline]
    pub fn rover(&self) -> &Rover {
        self.odometry.rover()
    }

    /// The options.
    pub fn options(&self) -> &PreintegrationOptions {
        &self.options
    }

    /// Number of samples.
    #[inline]
    pub fn len(&self) -> usize {
        self.samples.stamps.len()
    }

    /// True if there is none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.samples.stamps.is_empty()
    }

    /// Begin and end [s]; None without a sample.
    #[inline]
    pub fn span(&self) -> Option<[f64; 2]> {
        let stamps = &self.samples.stamps;
        let (first, last) = (*stamps.first()?, *stamps.last()?);
        if stamps.len() < 2 {
            return Some([first, last]);
        }
        let at = |k: usize, share: f64| stamps[k] + share * (stamps[k + 1] - stamps[k]);
        let ends = if self.ends < 1.0 { at(stamps.len() - 2, self.ends) } else { last };
        Some([at(0, self.begins), ends])
    }

    /// Adds a sample, in space with the attitude `world_from_body` as a quaternion x, y, z, w. On failure nothing has
    /// changed.
    #[inline]
    pub fn add(&mut self, sample: Sample<'_>, attitude: Option<[f64; 4]>) -> Result<(), Error> {
        if self.ends < 1.0 {
            return Err(Error::value("stamp", "belong to a motion that ends with a sample", number(sample.stamp)));
        }
        if sample.yaw.is_some() {
            return Err(Error::value("yaw", "be left out: a motion has no absolute yaw", "one"));
        }
        let attitude = self.checked(attitude)?;
        let bias = self.options.gyroscope.map_or(0.0, |gyroscope| gyroscope.bias);
        let sample = Sample { yaw_rate: sample.yaw_rate.map(|rate| rate - bias), ..sample };
        self.reserve(1)?;
        self.odometry.update(sample)?;
        self.samples.push(sample, attitude);
        Ok(())
    }

    fn checked(&self, attitude: Option<[f64; 4]>) -> Result<Option<[f64; 4]>, Error> {
        match (self.options.in_space, attitude) {
            (false, None) => Ok(None),
            (false, Some(_)) => {
                Err(Error::value("attitude", "be left out in the plane (in_space=True takes it)", "one"))
            }
            (true, None) => Err(Error::value("attitude", "come with every sample in space", "none")),
            (true, Some(attitude)) => {
                finite("attitude", &attitude)?;
                let length = attitude.iter().map(|part| part * part).sum::<f64>().sqrt();
                if (length - 1.0).abs() > UNIT {
                    let rule = "be a quaternion x, y, z, w of length 1";
                    let value = six_wheel_numerics::error::numbers(&attitude);
                    return Err(Error::value("attitude", rule, value));
                }
                Ok(Some(attitude.map(|part| part / length)))
            }
        }
    }

    /// Adds all rows of a log, or none of them.
    pub fn add_log(
        &mut self,
        log: Recording<'_>,
        attitudes: Option<&[[f64; 4]]>,
        is_interrupted: IsInterrupted,
    ) -> Result<(), Error> {
        let (wheels, joints) = (self.rover().wheels().len(), self.rover().steered().len());
        let before = self.len();
        self.reserve(log.stamps.len())?;
        for k in 0..log.stamps.len() {
            let attitude = attitudes.map(|attitudes| attitudes[k]);
            let ends = k % BETWEEN_CHECKS == BETWEEN_CHECKS - 1 && is_interrupted();
            let added = if ends { Err(Error::interrupted()) } else { self.add(log.row(wheels, joints, k), attitude) };
            if let Err(error) = added {
                self.truncate(before)?;
                return Err(error.at_row(k));
            }
        }
        Ok(())
    }

    /// Reserves memory for more samples.
    fn reserve(&mut self, more: usize) -> Result<(), Error> {
        let (wheels, joints) = (self.rover().wheels().len(), self.rover().steered().len());
        let samples = &mut self.samples;
        let room = samples
            .wheels
            .try_reserve(more.saturating_mul(wheels))
            .and_then(|()| samples.steering.try_reserve(more.saturating_mul(joints)))
            .and_then(|()| samples.stamps.try_reserve(more))
            .and_then(|()| samples.rates.try_reserve(more))
            .and_then(|()| samples.attitudes.try_reserve(more));
        room.map_err(|_| {
            Error::value("wheel_angles", "fit into memory", format!("{more} rows")).of_kind(ErrorKind::Memory)
        })
    }

    /// Removes all samples after the first `count`, as after a failure.
    fn truncate(&mut self, count: usize) -> Result<(), Error> {
        if count < self.len() {
            *self = self.part(0..count, self.begins, self.ends)?;
        }
        Ok(())
    }

    fn sample(&self, k: usize) -> Sample<'_> {
        let (wheels, joints) = (self.rover().wheels().len(), self.rover().steered().len());
        let rate = self.samples.rates[k];
        Sample {
            steering: &self.samples.steering[k * joints..(k + 1) * joints],
            wheels: &self.samples.wheels[k * wheels..(k + 1) * wheels],
            stamp: self.samples.stamps[k],
            yaw: None,
            yaw_rate: (!rate.is_nan()).then_some(rate),
        }
    }

    /// The motion over some of its samples.
    fn part(&self, rows: std::ops::Range<usize>, begins: f64, ends: f64) -> Result<Self, Error> {
        let mut part = Self {
            options: self.options.clone(),
            fresh: self.fresh.clone(),
            odometry: self.fresh.clone(),
            samples: Samples::default(),
            begins,
            ends,
        };
        part.append(self, rows)?;
        Ok(part)
    }

    /// Adds samples of another motion.
    fn append(&mut self, other: &Self, rows: std::ops::Range<usize>) -> Result<(), Error> {
        self.reserve(rows.len())?;
        for k in rows {
            let sample = other.sample(k);
            self.odometry.update(sample)?;
            self.samples.push(sample, other.samples.attitudes.get(k).copied());
        }
        Ok(())
    }

    /// The parts before and after an instant. Within a step the rover is on its arc.
    #[inline]
    pub fn split(&self, stamp: f64) -> Result<[Self; 2], Error> {
        let Some([begin, end]) = self.span() else {
            return Err(Error::value("stamp", "lie within the samples", "one before any sample"));
        };
        if !(stamp >= begin && stamp <= end) {
            let rule = format!("be between {} and {}", number(begin), number(end));
            return Err(Error::value("stamp", rule, number(stamp)));
        }
        let stamps = &self.samples.stamps;
        let last = self.len() - 1;
        // The last sample that is not after it.
        let at = stamps.partition_point(|time| *time <= stamp) - 1;
        let whole = stamps[at] == stamp && !(at == 0 && self.begins > 0.0);
        if whole || at == last {
            let before = if at == 0 { 0.0 } else { self.begins };
            let after = if at == last { 1.0 } else { self.ends };
            let first = self.part(0..at + 1, before, 1.0)?;
            return Ok([first, self.part(at..last + 1, 0.0, after)?]);
        }
        let share = (stamp - stamps[at]) / (stamps[at + 1] - stamps[at]);
        let first = self.part(0..at + 2, self.begins, share)?;
        Ok([first, self.part(at..last + 1, share, self.ends)?])
    }

    /// This motion and the one that follows it as one motion, equal to that of all their samples.
    pub fn merge(&self, next: &Self) -> Result<Self, Error> {
        let same = self.options == next.options && self.rover() == next.rover();
        if !same {
            let rule = "be of the same rover with the same noise, readings and gyroscope";
            return Err(Error::value("other", rule, "another one"));
        }
        let (Some([_, end]), Some([begin, _])) = (self.span(), next.span()) else {
            return Ok(if self.is_empty() { next } else { self }.clone());
        };
        // Samples that both motions hold: the one between two steps, or both ends of a step that was cut.
        let shared = if self.ends < 1.0 { 2 } else { 1 };
        let fits = end == begin
            && next.len() >= shared
            && self.len() >= shared
            && (shared == 1) == (next.begins == 0.0)
            && (shared == 1 || self.ends == next.begins);
        if !fits {
            return Err(Error::value("other", format!("begin where this one ends, at {}", number(end)), number(begin)));
        }
        let counts = self.options.settings.readings == Readings::Increments;
        let agrees = (0..shared).all(|k| {
            let (ours, theirs) = (self.sample(self.len() - shared + k), next.sample(k));
            let read = ours.wheels.iter().zip(theirs.wheels);
            ours.stamp == theirs.stamp
                && ours.steering == theirs.steering
                && (counts || read.clone().all(|(a, b)| a == b || a.is_nan() && b.is_nan()))
        });
        if !agrees {
            return Err(Error::value("other", "begin with the sample this one ends with", "other readings"));
        }
        let mut whole = self.clone();
        whole.append(next, shared..next.len())?;
        whole.ends = next.ends;
        Ok(whole)
    }

    /// True if the motion is that of odometry: in the plane, between two samples.
    fn is_plain(&self) -> bool {
        !self.options.in_space && self.begins == 0.0 && self.ends == 1.0
    }

    /// The motion in the plane, yaw with full turns; None if it is one of [`Self::replay`].
    #[inline]
    pub fn pose(&self) -> Option<Pose> {
        self.is_plain().then(|| self.odometry.pose())
    }

    /// Covariance in the plane, in coordinates; None if it is one of [`Self::replay`].
    #[inline]
    pub fn covariance(&self) -> Option<[[f64; 3]; 3]> {
        self.is_plain().then(|| self.odometry.covariance())
    }
}

impl Residual {
    /// Residual of two poses against a motion that is changed by `exp(change)` at its end.
    #[inline]
    pub fn of(motion: &Motion3, change: &Vector6<f64>, [first, second]: [&Motion3; 2]) -> Self {
        let between = first.inverse().compose(second);
        let difference = motion.inverse().compose(&between);
        let error = Motion3::exp(&-change).compose(&difference).log();
        let inverse = right_jacobian(&error).try_inverse().unwrap_or_else(Matrix6::identity);
        Self {
            error,
            by_first: -inverse * between.inverse().adjoint(),
            by_second: inverse,
            by_motion: -inverse * difference.inverse().adjoint() * right_jacobian(&-change),
        }
    }
}
