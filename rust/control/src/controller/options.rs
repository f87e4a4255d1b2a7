//! Options of a controller, beside rover and limits.

use std::str::FromStr;

use crate::motion::goal::Mode;
use crate::motion::limits::Limits;
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::wheels::{Pivot, Wheel};
use six_wheel_numerics::error::{Error, number, positive};

/// The drive while measured steering angles differ from the commanded ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlignmentPolicy {
    /// The speed is reduced by the cosine of the largest error.
    Cosine,
    /// The speed is 0.
    Hold,
}

impl AlignmentPolicy {
    /// Name of the option.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cosine => "cosine",
            Self::Hold => "hold",
        }
    }
}

impl FromStr for AlignmentPolicy {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        match name {
            "cosine" => Ok(Self::Cosine),
            "hold" => Ok(Self::Hold),
            _ => Err(Error::value("align", "be 'cosine', 'hold' or None", format!("{name:?}"))),
        }
    }
}

/// Options of a controller, beside rover and limits.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Age above which a command is stale [s]; infinite for never.
    pub timeout: f64,
    /// Time between steps [s]: of the first step, and of the arcs of `discretise`.
    pub period: Option<f64>,
    /// Longest time one step may count for [s].
    pub max_step: f64,
    /// Motions that a command is restricted to.
    pub mode: Mode,
    /// Reduction of the speed while measured steering angles differ from the commanded ones; None for none.
    pub align: Option<AlignmentPolicy>,
    /// Error of a steering angle up to which the wheel counts as aligned [rad].
    pub align_tolerance: f64,
    /// Error of a measured steering angle above which `following_time` runs [rad]; None for no limit.
    pub following_error: Option<f64>,
    /// Longest time for which the error of a joint may exceed `following_error` [s]; None for no limit.
    pub following_time: Option<f64>,
    /// True if a command is the motion of one period, not the velocity at its beginning.
    pub discretise: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            timeout: 0.5,
            period: None,
            max_step: 0.1,
            mode: Mode::Free,
            align: Some(AlignmentPolicy::Cosine),
            align_tolerance: 0.02,
            following_error: Some(0.2),
            following_time: Some(0.5),
            discretise: false,
        }
    }
}

impl Options {
    pub(super) fn check(&self) -> Result<(), Error> {
        if self.timeout.is_nan() || self.timeout <= 0.0 {
            let rule = "be positive (None for no timeout)";
            return Err(Error::value("timeout", rule, number(self.timeout)));
        }
        positive("max_step", self.max_step)?;
        positive("align_tolerance", self.align_tolerance)?;
        for (name, value) in fields!(self: following_error, following_time) {
            value.map_or(Ok(()), |value| positive(name, value))?;
        }
        if let Some(period) = self.period {
            positive("period", period)?;
            if period > self.max_step {
                let rule = format!("not exceed max_step={}", number(self.max_step));
                return Err(Error::value("period", rule, number(period)));
            }
        } else if self.discretise {
            let rule = "be given with discretise=True: it is the time one command is for";
            return Err(Error::value("period", rule, "None"));
        }
        Ok(())
    }

    /// The rover with the steering limit and in its mode, and the indices of its joints among those of `rover`.
    pub(super) fn model(&self, rover: &Rover, limits: &Limits) -> Result<(Rover, Vec<usize>), Error> {
        let mut wheels = rover.wheels().to_vec();
        let places = rover.steered().iter().map(|&i| wheels[i].x).collect::<Vec<_>>();
        let middle = places.iter().sum::<f64>() / places.len() as f64;
        let mut joints = Vec::new();
        for (joint, &i) in rover.steered().iter().enumerate() {
            let wheel = &mut wheels[i];
            if self.mode == Mode::FrontOnly && wheel.x < middle {
                let range = wheel.steering().unwrap_or_default();
                if range.lower > 0.0 || range.upper < 0.0 {
                    let rule = format!("leave wheel {:?} where it can steer", wheel.name);
                    return Err(Error::value("mode", rule, "\"front_only\""));
                }
                wheel.pivot = Pivot::Fixed;
            } else {
                restrict_steering(wheel, limits.steering_limit)?;
                joints.push(joint);
            }
        }
        Ok((Rover::new(wheels)?, joints))
    }
}

/// Restricts the range of a steered wheel to a steering limit [rad].
fn restrict_steering(wheel: &mut Wheel, limit: f64) -> Result<(), Error> {
    let Some(range) = wheel.steering().filter(|_| limit.is_finite()) else {
        return Ok(());
    };
    if limit > range.upper.max(-range.lower) {
        let rule = format!("lie inside the steering range, {range}, of wheel {:?}", wheel.name);
        return Err(Error::value("steering_limit", rule, number(limit)));
    }
    let narrowed = SteeringRange { lower: range.lower.max(-limit), upper: range.upper.min(limit) };
    narrowed.check()?;
    wheel.pivot = Pivot::Steered(narrowed);
    Ok(())
}
