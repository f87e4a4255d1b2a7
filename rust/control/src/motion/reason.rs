//! Reasons why a step is not the desired motion: one bit each.

/// Declares the bits and the table of their names.
macro_rules! reasons {
    ($($(#[$doc:meta])* $name:ident = $bit:expr;)*) => {
        $($(#[$doc])* pub const $name: u32 = 1 << $bit;)*
        /// Every reason by name.
        pub const ALL: &[(&str, u32)] = &[$((stringify!($name), $name)),*];
    };
}

reasons! {
    /// The desired turn is too tight for the steering angles.
    STEERING_LIMIT = 0;
    /// A joint turns as fast as it may.
    STEERING_RATE = 1;
    /// A joint changes its rate as fast as it may.
    STEERING_ACCELERATION = 2;
    /// A wheel would turn too fast.
    WHEEL_SPEED = 3;
    /// A wheel would speed up or slow down too fast.
    WHEEL_ACCELERATION = 4;
    /// The body would be too fast.
    SPEED = 5;
    /// The body would turn too fast.
    YAW_RATE = 6;
    /// Speed times yaw rate would be too much.
    LATERAL_ACCELERATION = 7;
    /// The body speeds up, or changes its direction, as fast as it may.
    ACCELERATION = 8;
    /// The body slows down as fast as it may.
    DECELERATION = 9;
    /// The acceleration changes as fast as it may.
    JERK = 10;
    /// The yaw rate grows, or follows the direction, as fast as it may.
    ANGULAR_ACCELERATION = 11;
    /// The yaw rate shrinks as fast as it may.
    ANGULAR_DECELERATION = 12;
    /// The angular acceleration changes as fast as it may.
    ANGULAR_JERK = 13;
    /// No continuous turn of the wheels leads to the desired motion: the rover stops and aligns its wheels at rest.
    SPIN_ISLAND = 14;
    /// The desired twist is not possible; the motion is the nearest possible one.
    PROJECTED = 15;
    /// The last command is too old: the rover stops.
    STALE = 16;
    /// The latest command was not finite and is ignored.
    NOT_FINITE = 17;
    /// The wheels are not yet where the motion needs them.
    ALIGNING = 18;
    /// A command older than the last one came since the last step, and is ignored.
    OUT_OF_ORDER = 19;
    /// The step took longer than a step may, and counts as one of that length.
    PAUSED = 20;
    /// A halt was commanded, or a joint does not follow: the rover stays at rest until it is released.
    HALTED = 21;
    /// A steering joint does not follow its commands.
    JOINT_STUCK = 22;
}
