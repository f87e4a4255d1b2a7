//! `six_wheel.Noise`, `six_wheel.Encoder` and `six_wheel.Gyroscope`.

use pyo3::prelude::*;
use six_wheel_kinematics::units;
use six_wheel_odometry::{Encoder as CoreEncoder, Gyroscope as CoreGyroscope, Noise as CoreNoise};

use crate::arguments::constructor_call;
use crate::convert::OrRaise;
use crate::rover::Rover;
use crate::unit_warnings::warn_units;

/// Standard deviations of the errors of readings and wheels.
///
/// Errors of different wheels and of different readings are independent. `speed`, `steering` and `yaw_rate` are
/// those of one reading, as a data sheet or a quick test gives them; what they add up to over a second depends on how
/// often one reads, unless `period` says for how long an error stays the same. `slip` and `side_slip` grow with the
/// root of the distance, at any rate.
///
/// ``Noise()``, and with nothing but `yaw`, `yaw_rate` and `period`, is that of a typical rover, `Noise.typical`. Who gives
/// any of the first four has measured; then slip that is not given is 0. ``Noise.from_logs(rover, logs)`` measures.
#[doc = section!(Parameters)]
/// speed : float, optional
///     Of every wheel's rim speed over one step [m/s], default 0.01.
/// steering : float, optional
///     Of every steering angle [rad], default 0.009.
/// slip : float, optional
///     Of the distance a wheel slips along its heading while its pivot travels one metre [m per root m].
/// side_slip : float, optional
///     The same across its heading [m per root m]; rollers pass on along the wheel what does not turn them.
/// yaw : float, default 0.0
///     Of an absolute yaw reading [rad]; 0 takes it at its word.
/// yaw_rate : float, default 0.0
///     Of a gyroscope's reading [rad/s]; 0 takes it at its word.
/// period : float, optional
///     Time over which an error of `speed`, `steering` and `yaw_rate` stays the same [s]: readings that come more
///     often share it. Without it every reading errs on its own.
#[doc = raises!("If a number is negative or not finite.")]
#[pyclass(frozen, module = "six_wheel", from_py_object)]
#[derive(Clone, Copy)]
pub struct Noise(pub CoreNoise, Measured);

/// True for those of speed, steering, slip and side_slip that were given; the defaults of the others follow from that.
type Measured = [bool; 4];

impl From<CoreNoise> for Noise {
    fn from(core: CoreNoise) -> Self {
        Self(core, [true; 4])
    }
}

impl Noise {
    fn all(&self) -> [(&'static str, f64); 6] {
        by_name!(self.0, speed steering slip side_slip yaw yaw_rate)
    }

    /// Those that are not 0, and the first two; of a typical rover those that are not its.
    fn numbers(&self) -> Vec<(&'static str, Option<f64>)> {
        let typical = self.0.is_typical();
        let shown = self.all().into_iter().enumerate();
        let shown =
            shown.filter(|(k, (_, number))| if typical { *k > 3 && *number != 0.0 } else { *k < 2 || *number != 0.0 });
        let numbers = shown.map(|(_, (name, number))| (name, Some(number)));
        numbers.chain(self.0.period.map(|period| ("period", Some(period)))).collect()
    }

    /// Those that were given.
    fn given(&self) -> Vec<(&'static str, Option<f64>)> {
        let given = self.all().into_iter().zip(self.1.into_iter().chain([true; 2]));
        let numbers = given.filter_map(|((name, number), given)| given.then_some((name, Some(number))));
        numbers.chain([("period", self.0.period)]).collect()
    }
}

argument_kind! { Noise: "a Noise", |value| constructor_call("Noise", "speed", value) }

getters! { Noise, self, py:
    /// Of every wheel's rim speed over one step [m/s].
    speed: f64 = self.0.speed;
    /// Of every steering angle [rad].
    steering: f64 = self.0.steering;
    /// Of the distance a wheel slips along its heading over one metre [m].
    slip: f64 = self.0.slip;
    /// The same across its heading [m].
    side_slip: f64 = self.0.side_slip;
    /// Of an absolute yaw reading [rad].
    yaw: f64 = self.0.yaw;
    /// Of a gyroscope's reading [rad/s].
    yaw_rate: f64 = self.0.yaw_rate;
    /// Time over which an error of a reading stays the same [s].
    period: Option<f64> = self.0.period;
}

value_of_numbers!(Noise: given, |noise| if noise.0.is_typical() { "Noise.typical" } else { "Noise" });

methods! { Noise:
    #[new]
    fn new[py: Python<'py>](speed: Option<f64> = None, steering: Option<f64> = None, *, slip: Option<f64> = None,
        side_slip: Option<f64> = None, yaw: Option<f64> = None, yaw_rate: Option<f64> = None, period: Option<f64> = None, **)
    as "(speed=None, steering=None, *, slip=None, side_slip=None, yaw=0.0, yaw_rate=0.0, period=None)"
    -> PyResult<Self> {
        let measured = [speed, steering, slip, side_slip].map(|value| value.is_some());
        let usual = if measured == [false; 4] { CoreNoise::default() } else { CoreNoise::READINGS };
        let noise = with_given!(CoreNoise { period, ..usual }, speed steering slip side_slip yaw yaw_rate);
        noise.check().or_raise(&[])?;
        let noise = Self(noise, measured);
        warn_units(py, units::settings(noise.all()))?;
        Ok(noise)
    }

    /// That of a typical rover, which is the default: 0.01 m/s, 0.009 rad, slip of 0.03 m per root metre along and across.
    ///
    /// It is that of the laboratory tricycle of the OptiOdom recordings, with dimensions from a tape: the ends of its nine
    /// runs lie as far off as it says. Of the two robots with rollers beside it, too, it is right within a factor of 2.4 in
    /// variance; those of the two-wheeled one end six times nearer than it says.
    #[doc = section!(Parameters)]
    /// yaw, yaw_rate, period : float, optional
    ///     Deviations of a measured yaw [rad] and yaw rate [rad/s], and the interval of samples [s], as of the class.
    #[doc = returns!("Noise")]
    #[doc = raises!("If a number is negative or not finite, or the period not positive.")]
    #[staticmethod]
    fn typical[](*, yaw: Option<f64> = None, yaw_rate: Option<f64> = None, period: Option<f64> = None, **)
    as "(*, yaw=0.0, yaw_rate=0.0, period=None)" -> PyResult<Self> {
        let noise = with_given!(CoreNoise { period, ..CoreNoise::default() }, yaw yaw_rate);
        noise.check().or_raise(&[])?;
        Ok(Self(noise, [false; 4]))
    }

    /// Noise that was measured: by what dead reckoning of logs with a truth ends beside it, the rover taken as it is.
    #[doc = section!(Parameters)]
    /// rover : Rover
    ///     With the dimensions that odometry will have.
    /// logs : WheelLog, or anything that `calibrate` takes
    ///     One drive or several, with their truth.
    /// truth : optional
    ///     As of `calibrate`.
    #[doc = returns!("Noise")]
    ///     `slip` and `side_slip`, by maximum likelihood; `speed` and `steering` are 0, for slip holds all that ends err by.
    #[doc = raises!("If the logs have no truth, or their ends tell nothing.")]
    #[staticmethod]
    fn from_logs[py: Python<'py>](rover: Bound<'py, Rover>, logs, truth=None, **)
    as "(rover, logs, truth=None)" -> PyResult<Bound<'py, PyAny>> {
        py.import("six_wheel.calibration.noise")?.call_method1("noise_of", (rover, logs, truth))
    }
}

/// An encoder: its ticks per turn, the gear before it, and where its counter starts over.
#[doc = section!(Parameters)]
/// ticks_per_turn : float, optional
///     Ticks per turn of the shaft it sits on. Without it the reading is in radians (or radians per second).
/// gear_ratio : float, default 1.0
///     Turns of that shaft per turn of the wheel or steering joint; negative if it runs the other way round.
/// wraps_at : float, optional
///     Ticks after which the counter starts over: ``2**16``, ``2**32``, or `ticks_per_turn` for an absolute encoder.
///     Between two samples a counter is taken to have gone the shorter way.
/// offset : float, default 0.0
///     Angle of a steering joint where the counter is zero [rad].
#[doc = raises!("If a number is not finite, ticks_per_turn or wraps_at not positive, or gear_ratio 0.")]
#[pyclass(frozen, module = "six_wheel", from_py_object)]
#[derive(Clone, Copy)]
pub struct Encoder(pub CoreEncoder);

getters! { Encoder, self, py:
    /// Ticks per turn of the shaft it sits on; None if it reads radians.
    ticks_per_turn: Option<f64> = self.0.resolution;
    /// Turns of that shaft per turn of the joint.
    gear_ratio: f64 = self.0.gear;
    /// Ticks after which the counter starts over; None if it never does.
    wraps_at: Option<f64> = self.0.modulus;
    /// Angle of the joint where the counter is zero [rad].
    offset: f64 = self.0.offset;
    /// Angle of the joint per tick [rad].
    angle_per_tick: f64 = self.0.angle_per_count();
}

impl Encoder {
    fn numbers(&self) -> [(&'static str, Option<f64>); 4] {
        let CoreEncoder { resolution, gear, modulus, offset } = self.0;
        [("ticks_per_turn", resolution), ("gear_ratio", Some(gear)), ("wraps_at", modulus), ("offset", Some(offset))]
    }
}

value_of_numbers!(Encoder);

methods! { Encoder:
    #[new]
    fn new[](ticks_per_turn: Option<f64> = None, *, gear_ratio: Option<f64> = None, wraps_at: Option<f64> = None,
        offset: Option<f64> = None, **)
    as "(ticks_per_turn=None, *, gear_ratio=1.0, wraps_at=None, offset=0.0)" -> PyResult<Self> {
        let encoder = CoreEncoder {
            resolution: ticks_per_turn,
            gear: gear_ratio.unwrap_or(1.0),
            modulus: wraps_at,
            offset: offset.unwrap_or(0.0),
        };
        encoder.check().or_raise(&[])?;
        Ok(Self(encoder))
    }
}

/// Error model of a gyroscope about the vertical axis of the body.
#[doc = section!(Parameters)]
/// noise : float, default 0.005
///     Standard deviation of a reading [rad/s].
/// bias : float, default 0.0
///     Reading at rest, as far as is known beforehand [rad/s].
/// bias_noise : float, default 0.05
///     Standard deviation of that [rad/s].
/// bias_walk : float, default 0.0001
///     Random walk of the bias, as a standard deviation after one second [rad/s per root s].
/// scale_noise : float, default 0.0
///     Standard deviation of the factor that its readings are off by, a share of what it turns. It lasts: ten turns the
///     same way err ten times as much as one.
#[doc = raises!("If a number is not finite or a deviation negative.")]
#[pyclass(frozen, module = "six_wheel", from_py_object)]
#[derive(Clone, Copy)]
pub struct Gyroscope(pub CoreGyroscope);

impl Gyroscope {
    fn numbers(&self) -> [(&'static str, Option<f64>); 5] {
        by_name!(self.0, noise bias bias_noise bias_walk scale_noise).map(|(name, number)| (name, Some(number)))
    }
}

argument_kind! { Gyroscope: "a Gyroscope", |value| constructor_call("Gyroscope", "noise", value) }

getters! { Gyroscope, self, py:
    /// Standard deviation of a reading [rad/s].
    noise: f64 = self.0.noise;
    /// Reading at rest [rad/s].
    bias: f64 = self.0.bias;
    /// Standard deviation of the bias [rad/s].
    bias_noise: f64 = self.0.bias_noise;
    /// Random walk of the bias [rad/s per root s].
    bias_walk: f64 = self.0.bias_walk;
    /// Standard deviation of the factor that its readings are off by.
    scale_noise: f64 = self.0.scale_noise;
}

value_of_numbers!(Gyroscope);

methods! { Gyroscope:
    #[new]
    fn new[](noise: Option<f64> = None, *, bias: Option<f64> = None, bias_noise: Option<f64> = None,
        bias_walk: Option<f64> = None, scale_noise: Option<f64> = None, **)
    as "(noise=0.005, *, bias=0.0, bias_noise=0.05, bias_walk=0.0001, scale_noise=0.0)" -> PyResult<Self> {
        let known = with_given!(CoreGyroscope::default(), noise bias bias_noise bias_walk scale_noise);
        known.check().or_raise(&[])?;
        Ok(Self(known))
    }
}
