//! `six_wheel.kinematics.profiles`: transitions of a rover, and what its wheels do during them.

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use six_wheel_control::profiles::{self as core, IcrLimits, ModuleLimits, Modules, Shape, Synchronise};
use six_wheel_numerics::error::Error;

use super::inputs::{Keywords, one_of, row, states};
use super::made::{ConstructorCall, class, known_by_its_call, printed_by_its_call};
use crate::convert::{OrRaise, refuse};
use crate::rover::Rover;

/// A transition: its class, what all of them have, and the twist that is commanded at a time, if any is.
macro_rules! transition {
    (
        $(#[$doc:meta])* $class:ident;
        $(#[$at:meta])* |$this:ident, $time:ident, $wheels:ident| $twist:expr
    ) => {
        $(#[$doc])*
        #[pyclass(frozen, module = "six_wheel.kinematics.profiles")]
        pub struct $class {
            core: core::$class,
            made: ConstructorCall,
        }

        known_by_its_call!($class);

        impl $class {
            fn made(
                core: Result<core::$class, Error>,
                maker: &'static str,
                arguments: Bound<'_, PyTuple>,
                keywords: Keywords<'_>,
            ) -> PyResult<Self> {
                let (arguments, keywords) = (arguments.unbind(), keywords.0.unbind());
                Ok(Self { core: core.or_raise(&[])?, made: ConstructorCall { maker, arguments, keywords } })
            }
        }

        getters! { $class, self, py:
            /// Duration [s].
            duration: f64 = self.core.duration();
            /// The rover it is for.
            rover: PyResult<Py<PyAny>> = Ok(self.made.arguments.bind(py).get_item(0)?.unbind());
        }

        methods! { $class:
            $(#[$at])*
            #[doc = section!(Parameters)]
            /// times : float or array_like, shape (...)
            ///     [s]; before the start and after the end it holds what is there.
            fn at[&$this, py: Python<'py>](times) -> PyResult<Bound<'py, PyAny>> {
                states(py, $this.core.rover(), times, |$time, $wheels| $twist)
            }
        }
    };
}

/// Limits under the names that they have as keywords.
macro_rules! limits {
    ($keywords:ident, $limits:ident { $($name:ident)* }) => {
        $limits { $($name: $keywords.limit(stringify!($name), $name)?),* }
    };
}

transition! {
    /// The body's twist follows a profile; the wheels follow the twist. Made by `profiles.body_transition`.
    BodyTransition;
    /// Twist and wheels at one time or many: a `TransitionState`.
    |self, time, wheels| Some(self.core.at(time, wheels))
}

printed_by_its_call!(BodyTransition);

transition! {
    /// Every steering angle and wheel speed follows its own profile. Made by `profiles.module_transition`.
    ModuleTransition;
    /// Wheels at one time or many, and the twist that fits them best: a `TransitionState`.
    |self, time, wheels| {
        self.core.at(time, wheels);
        None
    }
}

printed_by_its_call!(ModuleTransition);

transition! {
    /// All wheels keep one centre of rotation at every instant. Made by `profiles.icr_transition`.
    IcrTransition;
    /// Twist and wheels at one time or many: a `TransitionState`.
    |self, time, wheels| Some(self.core.at(time, wheels))
}

methods! { BodyTransition:
    /// From one twist to another by a profile of the body's motion, in a given time or within its limits.
    ///
    /// The wheels follow through the wheel equation, so they agree with each other at every instant; how
    /// fast they have to steer comes out, and nothing limits it. A wheel that would have to leave its range
    /// stands at its end meanwhile, and scrubs.
    #[doc = section!(Parameters)]
    /// rover : Rover
    /// start_twist, end_twist : array_like, shape (3,)
    ///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
    /// duration : float, optional
    ///     Duration [s]; or give limits.
    /// shape : {'s_curve', 'trapezoid', 'linear'}
    ///     Profile of the twist in that time.
    /// acceleration, angular_acceleration : float, optional
    ///     Limits of the change of vx and vy each, and of omega [m/s^2, rad/s^2].
    /// jerk, angular_jerk : float, optional
    ///     Limits of the change of those [m/s^3, rad/s^3].
    /// synchronise : {'time', 'phase', 'none'}
    ///     Synchronization: vx, vy and omega arrive together, also in proportion, or each when it can.
    /// previous : array_like, shape (steered wheels,), optional
    ///     Steering angles before it [rad]; default 0.
    #[doc = raises!(
        InfeasibleMotionError: "If the rover cannot make one of the twists.",
        ValueError: "If a value is not as said, or a steered wheel has trail: its angle would depend on its rate."
    )]
    #[staticmethod]
    fn between[py: Python<'py>](rover: Bound<'py, Rover>, start_twist: [f64; 3], end_twist: [f64; 3],
        duration: Option<f64> = None, *, shape: Option<&str> = None, acceleration: Option<f64> = None,
        angular_acceleration: Option<f64> = None, jerk: Option<f64> = None, angular_jerk: Option<f64> = None,
        synchronise: Option<&str> = None, previous=None, **)
    as "(rover, start_twist, end_twist, duration=None, *, shape=None, acceleration=None, angular_acceleration=None, jerk=None, angular_jerk=None, synchronise=None, previous=None)" -> PyResult<Self> {
        let keywords = Keywords::new(py);
        let [start, end] = [start_twist, end_twist].map(|twist| twist.map(|number| number + 0.0));
        let duration = keywords.duration(duration)?;
        let shape: Shape = keywords.word("shape", shape)?;
        let linear = [keywords.limit("acceleration", acceleration)?, keywords.limit("jerk", jerk)?];
        let angular = [
            keywords.limit("angular_acceleration", angular_acceleration)?,
            keywords.limit("angular_jerk", angular_jerk)?,
        ];
        let synchronise: Synchronise = keywords.word("synchronise", synchronise)?;
        let previous = keywords.previous(rover.get(), previous)?;
        let limited = [linear, angular].concat().iter().any(|limit| *limit != f64::INFINITY);
        let names = "acceleration, angular_acceleration, jerk or angular_jerk";
        one_of(duration, limited, names)?;
        let (core, previous) = (&rover.get().core, previous.as_deref());
        let core = match duration {
            Some(duration) => shape
                .between(&start, &end, duration)
                .and_then(|profile| core::BodyTransition::new(core, profile, previous)),
            None => {
                let ends = [start.into(), end.into()];
                core::BodyTransition::within(core, ends, [linear, angular], synchronise, previous)
            }
        };
        let arguments = (rover, PyTuple::new(py, start)?, PyTuple::new(py, end)?).into_pyobject(py)?;
        Self::made(core, "body_transition", arguments, keywords)
    }
}

/// The pair (steering, wheel speeds).
fn modules(argument: &str, rover: &Rover, value: &Bound<'_, PyAny>) -> PyResult<(Vec<f64>, Vec<f64>)> {
    let pair: Vec<Bound<'_, PyAny>> = value
        .try_iter()
        .and_then(Iterator::collect)
        .map_err(|_| refuse(argument, "be a pair (steering, wheel_speeds)", "something else"))?;
    match pair.as_slice() {
        [steering, speeds] => Ok((
            row(format!("{argument}[0]"), steering, rover.joints())?,
            row(format!("{argument}[1]"), speeds, rover.count())?,
        )),
        _ => Err(refuse(argument, "be a pair (steering, wheel_speeds)", format!("{} values", pair.len()))),
    }
}

methods! { ModuleTransition:
    /// From one state of the modules to another, each by its own profile: for alignment at rest.
    ///
    /// While the rover moves, wheels that do not know of each other scrub: `at` says how much.
    #[doc = section!(Parameters)]
    /// rover : Rover
    /// start, end : (array_like, array_like)
    ///     Steering angles, shape (steered wheels,) [rad], and wheel speeds, shape (wheels,) [rad/s]: what
    ///     `Rover.inverse` returns.
    /// duration : float, optional
    ///     Duration [s]; or give limits.
    /// shape : {'s_curve', 'trapezoid', 'linear'}
    ///     Profile of every angle and speed in that time.
    /// steering_rate, steering_acceleration, steering_jerk : float, optional
    ///     Limits of every steering joint [rad/s, rad/s^2, rad/s^3].
    /// wheel_acceleration, wheel_jerk : float, optional
    ///     Limits of every wheel [rad/s^2, rad/s^3]; without any, wheels change speed evenly while the
    ///     steering takes its time.
    /// synchronise : {'time', 'phase', 'none'}
    ///     Synchronization: all arrive together, also in proportion, or each when it can.
    #[doc = raises!("If a value is not as said, or an angle lies outside its wheel's range.")]
    #[staticmethod]
    fn between[py: Python<'py>](rover: Bound<'py, Rover>, start, end, duration: Option<f64> = None, *,
        shape: Option<&str> = None, steering_rate: Option<f64> = None, steering_acceleration: Option<f64> = None,
        steering_jerk: Option<f64> = None, wheel_acceleration: Option<f64> = None, wheel_jerk: Option<f64> = None,
        synchronise: Option<&str> = None, **)
    as "(rover, start, end, duration=None, *, shape=None, steering_rate=None, steering_acceleration=None, steering_jerk=None, wheel_acceleration=None, wheel_jerk=None, synchronise=None)" -> PyResult<Self> {
        let keywords = Keywords::new(py);
        let from = modules("start", rover.get(), start)?;
        let to = modules("end", rover.get(), end)?;
        let duration = keywords.duration(duration)?;
        let shape: Shape = keywords.word("shape", shape)?;
        let limits = limits!(keywords, ModuleLimits {
            steering_rate steering_acceleration steering_jerk wheel_acceleration wheel_jerk
        });
        let synchronise: Synchronise = keywords.word("synchronise", synchronise)?;
        let given = [steering_rate, steering_acceleration, steering_jerk, wheel_acceleration, wheel_jerk];
        let limited = given.into_iter().flatten().any(|limit| limit != f64::INFINITY);
        one_of(duration, limited, "limits of the steering or the wheels")?;
        let view = |(steering, speeds): &(Vec<f64>, Vec<f64>)| {
            PyResult::Ok((PyTuple::new(py, steering)?, PyTuple::new(py, speeds)?))
        };
        let arguments = (&rover, view(&from)?, view(&to)?).into_pyobject(py)?;
        let [start, end] = [&from, &to].map(|(steering, speeds)| Modules { steering, speeds });
        let rover = &rover.get().core;
        let core = match duration {
            Some(duration) => core::ModuleTransition::shaped(rover, start, end, shape, duration),
            None => core::ModuleTransition::within(rover, start, end, &limits, synchronise),
        };
        Self::made(core, "module_transition", arguments, keywords)
    }
}

getters! { IcrTransition, self, py:
    /// Number of times the rover comes to rest on the way.
    stops: usize = self.core.stops();
    /// Phases in the order of time, each with its action and reason: a tuple of `Phase`.
    phases: PyResult<Bound<'py, PyTuple>> = {
        let kind = class(py, "Phase")?;
        let mut phases = Vec::new();
        for phase in self.core.phases() {
            let name = phase.action.name();
            phases.push(kind.call1((name, phase.start, phase.duration, &phase.reason))?);
        }
        PyTuple::new(py, phases)
    };
}

methods! { IcrTransition:
    /// From one twist to another with one centre of rotation (ICR) at every instant: no wheel scrubs.
    ///
    /// The twist goes straight from start to end in the space of (vx, vy, omega), where the ICR moves on a
    /// straight line on which infinity and the origin are points like any other. All limits hold along it,
    /// and it is the fastest on that path: exactly so under limits of rates, speeds and accelerations of the
    /// body and the wheels; to the width of its 256 cells under a limit of the steering acceleration as
    /// well; a limit of the steering jerk is kept, at more time than the least.
    ///
    /// If the wheels cannot follow that path without leaving their range, a rover without unsteered
    /// wheels goes round what is in the way; otherwise the rover stops, turns its wheels at rest and drives
    /// on, and `phases` says why.
    #[doc = section!(Parameters)]
    /// rover : Rover
    /// start_twist, end_twist : array_like, shape (3,)
    ///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
    /// steering_rate : float
    ///     Limit of every steering joint [rad/s].
    /// steering_acceleration, steering_jerk : float, optional
    ///     Limits of every steering joint [rad/s^2, rad/s^3]. With either, steering starts and ends at rest.
    /// wheel_speed, wheel_acceleration : float, optional
    ///     Limits of every driven wheel [rad/s, rad/s^2].
    /// acceleration, angular_acceleration : float, optional
    ///     Limits of the change of the body's twist in its own axes: length of that of (vx, vy), and of
    ///     omega [m/s^2, rad/s^2].
    /// previous : array_like, shape (steered wheels,), optional
    ///     Steering angles at the start [rad]; default those next to 0. They decide which way round wheels
    ///     stand, and are held by wheels whose pivots rest.
    #[doc = raises!(
        InfeasibleMotionError: "If the rover cannot make one of the twists, or not within the wheel speed.",
        ValueError: "If a value is not as said, or a steered wheel has trail: its angle would depend on its rate."
    )]
    #[staticmethod]
    fn between[py: Python<'py>](rover: Bound<'py, Rover>, start_twist: [f64; 3], end_twist: [f64; 3], *,
        steering_rate: f64, steering_acceleration: Option<f64> = None, steering_jerk: Option<f64> = None,
        wheel_speed: Option<f64> = None, wheel_acceleration: Option<f64> = None, acceleration: Option<f64> = None,
        angular_acceleration: Option<f64> = None, previous=None, **)
    as "(rover, start_twist, end_twist, *, steering_rate, steering_acceleration=None, steering_jerk=None, wheel_speed=None, wheel_acceleration=None, acceleration=None, angular_acceleration=None, previous=None)" -> PyResult<Self> {
        let keywords = Keywords::new(py);
        let [start, end] = [start_twist, end_twist].map(|twist| twist.map(|number| number + 0.0));
        let steering_rate = Some(steering_rate);
        let limits = limits!(keywords, IcrLimits {
            steering_rate steering_acceleration steering_jerk wheel_speed wheel_acceleration acceleration
            angular_acceleration
        });
        let previous = keywords.previous(rover.get(), previous)?;
        let core = core::IcrTransition::new(&rover.get().core, start.into(), end.into(), &limits, previous.as_deref());
        let arguments = (rover, PyTuple::new(py, start)?, PyTuple::new(py, end)?).into_pyobject(py)?;
        Self::made(core, "icr_transition", arguments, keywords)
    }
}

#[pymethods]
impl IcrTransition {
    fn __repr__(&self) -> String {
        let phase = |phase: &core::Phase| format!("{} {:.4} s ({})", phase.action.name(), phase.duration, phase.reason);
        let phases: Vec<String> = self.core.phases().iter().map(phase).collect();
        let stops = match self.core.stops() {
            0 => "no stop".into(),
            1 => "1 stop".into(),
            stops => format!("{stops} stops"),
        };
        let duration = self.core.duration();
        format!("<icr_transition of {duration:.4} s, {stops}: {}>", phases.join(", "))
    }
}
