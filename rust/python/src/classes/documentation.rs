//! Documentation of calls: headings of its sections, and parameters that many calls have.

/// Lines on parameters, as numpydoc has them: `#[doc = parameters!(out "(..., 3)", dtype, threads)]`.
macro_rules! parameters {
    ($first:ident $($shape:literal)?, $($rest:tt)+) => {
        concat!(parameters!($first $($shape)?), "\n", parameters!($($rest)+))
    };
    (threads) => {
        "threads : int, optional\n    Threads at most, default `default_threads()`. No result depends on it."
    };
    (dtype) => {
        "dtype : dtype, optional
    float32 for results of single precision, default float64; they are computed in double precision."
    };
    (level) => {
        "level : str, optional\n    One of `simd_levels()`, default the best."
    };
    (out $shape:literal) => {
        concat!("out : ndarray, shape ", $shape, ", optional\n    Array for the result.")
    };
    (twist $shape:literal) => {
        concat!("twist : array_like, shape ", $shape, "\n    ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].")
    };
    (poses) => {
        "poses : array_like, shape (..., 3)\n    Rows ``[x, y, yaw]`` of the body's origin in the world [m, m, rad]."
    };
    (points) => {
        "xy : array_like, shape (..., 2)\n    Points [m]."
    };
    (wheel_radius) => {
        "wheel_radius : float\n    Hub to ground [m]."
    };
    (names $order:literal) => {
        concat!("names : sequence of str, optional\n    ", $order)
    };
    (scrub_and_trail) => {
        "scrub, trail : float, sequence or mapping of str to float, default 0.0
    Contact to the left of the steering axis, and behind it [m]. Of every wheel alike, left and right ones too, or one
    each: in their order, or by name."
    };
    (steering_limit) => {
        "steering_limit : float or (float, float), optional
    Largest steering angle to either side, or smallest and largest [rad]; default a quarter turn."
    };
    (steering_limit $wheels:literal) => {
        concat!(
            "steering_limit : float, (float, float), sequence or mapping, optional
    Largest steering angle to either side, or smallest and largest [rad]; default a quarter turn, ``math.inf`` for endless.
    ",
            $wheels,
            ": a mapping by name, or a sequence of pairs."
        )
    };
    (wheel_readings) => {
        "steering : array_like, shape (..., steered wheels)
    Steering angles [rad]; None for a rover that does not steer.
wheel_speeds : array_like, shape (..., wheels)
    Wheel speeds [rad/s]; NaN where a passive wheel has no encoder."
    };
    (steering) => {
        "steering : array_like, shape (..., steered wheels), optional\n    Steering angles [rad], default 0."
    };
    (steering_rates) => {
        "steering_rates : array_like, shape (..., steered wheels), optional
    Rates of the steering angles [rad/s], default 0; they matter to wheels with scrub or trail."
    };
    (rocker_joints) => {
        "joints : array_like, shape (..., 3)
    Angles of the left rocker, `rho` (the right one has ``-rho``), and of the left and the right bogie against their
    rockers, `beta_1` and `beta_2` [rad]; ``SettledPose.joints`` is such."
    };
    (controls) => {
        "controls : array_like, shape (..., k, t, 3)
    Rows ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s]: k rollouts of t steps.
dt : float or array_like, shape (t,)
    Duration of the steps [s].
start : array_like, shape (3,) or (..., k, 3), default (0, 0, 0)
    First pose ``[x, y, yaw]`` [m, m, rad], of all rollouts or of each."
    };
    (log) => {
        "steering : array_like, shape (n, steered wheels)
    As in `update`; None for a rover that does not steer.
wheel_angles : array_like, shape (n, wheels)
    As in `update`.
stamps : array_like, shape (n,)
    When they were read [s]."
    };
    (ends) => {
        "start, end : float or array_like, shape (axes,)\n    Values at both ends, in any unit."
    };
    (duration) => {
        "duration : float\n    Duration [s]."
    };
    (readings_and_encoders) => {
        "readings : {'angles', 'speeds', 'ticks'}
    Kind of the wheels' readings: running totals [rad]; rates at the stamps [rad/s], of which a step takes the mean
    of its two ends; or totals in ticks of `wheel_encoders`.
increments : bool, default False
    Angles or ticks are those since the sample before, not totals.
wheel_encoders, steering_encoders : Encoder, sequence of Encoder or dict of str to Encoder, optional
    For readings in counts: one for all, one each, or by the name of the wheel."
    };
}

/// The heading of the parameters, and the first of them where [`parameters!`] has these: `#[doc = section!(Parameters: threads)]`.
macro_rules! section {
    (Parameters $(: $($first:tt)+)?) => {
        concat!("\nParameters\n----------" $(, "\n", parameters!($($first)+))?)
    };
}

/// The section on what a call returns, its type and a line on it: `#[doc = returns!("float": "Duration [s].")]`.
macro_rules! returns {
    ($kind:literal $(: $text:literal)?) => {
        concat!("\nReturns\n-------\n", $kind $(, "\n    ", $text)?)
    };
}

/// The section on errors: `#[doc = raises!(TypeError: "If it is no number.", ValueError: "If it is not finite.")]`; with a rule
/// alone it is that of `ValueError`, with names alone the lines on them follow.
macro_rules! raises {
    ($rule:literal) => {
        raises!(ValueError: $rule)
    };
    ($kind:ident $(, $other:ident)*) => {
        concat!("\nRaises\n------\n", stringify!($kind) $(, ", ", stringify!($other))*)
    };
    ($kind:ident: $rule:literal $(, $other:ident: $more:literal)*) => {
        concat!(raises!($kind), "\n    ", $rule $(, "\n", stringify!($other), "\n    ", $more)*)
    };
}
