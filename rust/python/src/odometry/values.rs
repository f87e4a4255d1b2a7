//! `six_wheel.Noise` and `six_wheel.Encoder`.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use six_wheel_kinematics::units;
use six_wheel_odometry::{Encoder as CoreEncoder, Noise as CoreNoise};

use crate::arguments::{ArgumentKind, constructor_call};
use crate::classes::{hash_of_numbers, reduce};
use crate::convert::{OrRaise, number, optional_number};
use crate::unit_warnings::warn_units;

/// Standard deviations of the errors of readings and wheels.
///
/// Errors of different wheels and of different readings are independent. `speed`, `steering` and `yaw_rate` are
/// those of one reading, as a data sheet or a quick test gives them; what they add up to over a second depends on how
/// often one reads, unless `period` says for how long an error stays the same. `slip` and `side_slip` grow with the
/// root of the distance, at any rate.
///
/// ``Noise()``, and with nothing but `yaw`, `yaw_rate` and `period`, is a guess: slip of 0.1 m per root metre both ways, wide
/// enough for each of four laboratory robots with dimensions from a tape. Who gives any of the first four
/// has measured; then slip that is not given is 0. `calibrate` measures.
///
/// Parameters
/// ----------
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
///
/// Raises
/// ------
/// ValueError
///     If a number is negative or not finite.
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
    fn numbers(&self) -> [(&'static str, f64); 6] {
        let noise = &self.0;
        [
            ("speed", noise.speed),
            ("steering", noise.steering),
            ("slip", noise.slip),
            ("side_slip", noise.side_slip),
            ("yaw", noise.yaw),
            ("yaw_rate", noise.yaw_rate),
        ]
    }
}

impl ArgumentKind for Noise {
    const KIND: &'static str = "a Noise";

    fn remedy(value: &Bound<'_, PyAny>) -> String {
        constructor_call("Noise", "speed", value)
    }
}

getters! { Noise, this, py:
    /// Of every wheel's rim speed over one step [m/s].
    speed: f64 = this.0.speed;
    /// Of every steering angle [rad].
    steering: f64 = this.0.steering;
    /// Of the distance a wheel slips along its heading over one metre [m].
    slip: f64 = this.0.slip;
    /// The same across its heading [m].
    side_slip: f64 = this.0.side_slip;
    /// Of an absolute yaw reading [rad].
    yaw: f64 = this.0.yaw;
    /// Of a gyroscope's reading [rad/s].
    yaw_rate: f64 = this.0.yaw_rate;
    /// Time over which an error of a reading stays the same [s].
    period: Option<f64> = this.0.period;
}

equal_by!(Noise: 0);
replaceable!(Noise);

#[pymethods]
impl Noise {
    #[new]
    #[pyo3(
        signature = (speed=None, steering=None, *, slip=None, side_slip=None, yaw=None, yaw_rate=None, period=None),
        text_signature = "(speed=None, steering=None, *, slip=None, side_slip=None, yaw=0.0, yaw_rate=0.0, period=None)"
    )]
    fn new(
        py: Python<'_>,
        speed: Option<&Bound<'_, PyAny>>,
        steering: Option<&Bound<'_, PyAny>>,
        slip: Option<&Bound<'_, PyAny>>,
        side_slip: Option<&Bound<'_, PyAny>>,
        yaw: Option<&Bound<'_, PyAny>>,
        yaw_rate: Option<&Bound<'_, PyAny>>,
        period: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let measured = [speed, steering, slip, side_slip].map(|value| value.is_some());
        let is_guess = measured == [false; 4];
        let mut noise = if is_guess { CoreNoise::default() } else { CoreNoise::READINGS };
        let given = [
            ("speed", speed, &mut noise.speed),
            ("steering", steering, &mut noise.steering),
            ("slip", slip, &mut noise.slip),
            ("side_slip", side_slip, &mut noise.side_slip),
            ("yaw", yaw, &mut noise.yaw),
            ("yaw_rate", yaw_rate, &mut noise.yaw_rate),
        ];
        for (argument, value, target) in given {
            if let Some(value) = value {
                *target = number(argument, value)?;
            }
        }
        noise.period = optional_number("period", period)?;
        noise.check().or_raise(&[])?;
        let noise = Self(noise, measured);
        warn_units(py, units::settings(noise.numbers()))?;
        Ok(noise)
    }

    fn __repr__(&self) -> String {
        let [speed, steering, rest @ ..] = self.numbers();
        let mut text = format!("Noise(speed={:?}, steering={:?}", speed.1, steering.1);
        for (argument, value) in rest.iter().filter(|(_, value)| *value != 0.0) {
            text += &format!(", {argument}={value:?}");
        }
        if let Some(period) = self.0.period {
            text += &format!(", period={period:?}");
        }
        text + ")"
    }

    fn __hash__(&self) -> u64 {
        hash_of_numbers(self.numbers().map(|(_, number)| number).into_iter().chain([self.0.period.unwrap_or(-1.0)]))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (keywords, noise) = (PyDict::new(slf.py()), slf.get());
        let given = noise.1.into_iter().chain([true; 2]);
        for ((argument, value), _) in noise.numbers().into_iter().zip(given).filter(|(_, given)| *given) {
            keywords.set_item(argument, value)?;
        }
        keywords.set_item("period", noise.0.period)?;
        reduce(slf.as_any(), &PyTuple::empty(slf.py()), &keywords)
    }
}

/// An encoder as it is: how much it counts, through which gear, and where its counter starts over.
///
/// Parameters
/// ----------
/// resolution : float, optional
///     Counts per turn of the shaft it sits on. Without it the reading is in radians (or radians per second).
/// gear : float, default 1.0
///     Turns of that shaft per turn of the wheel or steering joint; negative if it runs the other way round.
/// modulus : float, optional
///     Counts after which the counter starts over: ``2**16``, ``2**32``, or `resolution` for an absolute encoder.
///     Between two samples a counter is taken to have gone the shorter way.
/// offset : float, default 0.0
///     Angle of a steering joint where the counter is zero [rad].
///
/// Raises
/// ------
/// ValueError
///     If a number is not finite, resolution or modulus not positive, or the gear 0.
#[pyclass(frozen, module = "six_wheel", from_py_object)]
#[derive(Clone, Copy)]
pub struct Encoder(pub CoreEncoder);

getters! { Encoder, this, py:
    /// Counts per turn of the shaft it sits on; None if it reads radians.
    resolution: Option<f64> = this.0.resolution;
    /// Turns of that shaft per turn of the joint.
    gear: f64 = this.0.gear;
    /// Counts after which the counter starts over; None if it never does.
    modulus: Option<f64> = this.0.modulus;
    /// Angle of the joint where the counter is zero [rad].
    offset: f64 = this.0.offset;
    /// Angle of the joint per count [rad].
    angle_per_count: f64 = this.0.angle_per_count();
}

equal_by!(Encoder: 0);
replaceable!(Encoder);

#[pymethods]
impl Encoder {
    #[new]
    #[pyo3(
        signature = (resolution=None, *, gear=None, modulus=None, offset=None),
        text_signature = "(resolution=None, *, gear=1.0, modulus=None, offset=0.0)"
    )]
    fn new(
        resolution: Option<&Bound<'_, PyAny>>,
        gear: Option<&Bound<'_, PyAny>>,
        modulus: Option<&Bound<'_, PyAny>>,
        offset: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let encoder = CoreEncoder {
            resolution: optional_number("resolution", resolution)?,
            gear: optional_number("gear", gear)?.unwrap_or(1.0),
            modulus: optional_number("modulus", modulus)?,
            offset: optional_number("offset", offset)?.unwrap_or(0.0),
        };
        encoder.check().or_raise(&[])?;
        Ok(Self(encoder))
    }

    fn __repr__(&self) -> String {
        let optional = |value: Option<f64>| value.map_or("None".into(), |value| format!("{value:?}"));
        let CoreEncoder { resolution, gear, modulus, offset } = self.0;
        format!(
            "Encoder(resolution={}, gear={gear:?}, modulus={}, offset={offset:?})",
            optional(resolution),
            optional(modulus)
        )
    }

    fn __hash__(&self) -> u64 {
        let CoreEncoder { resolution, gear, modulus, offset } = self.0;
        hash_of_numbers([resolution.unwrap_or(0.0), gear, modulus.unwrap_or(0.0), offset])
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, encoder) = (slf.py(), slf.get().0);
        let keywords = PyDict::new(py);
        keywords.set_item("gear", encoder.gear)?;
        keywords.set_item("modulus", encoder.modulus)?;
        keywords.set_item("offset", encoder.offset)?;
        let arguments = (encoder.resolution,).into_pyobject(py)?;
        reduce(slf.as_any(), &arguments, &keywords)
    }
}
