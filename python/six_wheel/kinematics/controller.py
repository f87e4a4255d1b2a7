"""Why a step of a `Controller` is not simply what was asked for."""

from six_wheel.kinematics.flags import NamedFlag

__all__ = ["Reason"]


class Reason(NamedFlag):
    """Reasons of one step, any number of them; empty for a step that makes the motion asked for."""

    STEERING_LIMIT = 1 << 0
    """The turn asked for is too tight for the steering angles."""
    STEERING_RATE = 1 << 1
    """A joint turns as fast as it may."""
    STEERING_ACCELERATION = 1 << 2
    """A joint changes its rate as fast as it may."""
    WHEEL_SPEED = 1 << 3
    """A wheel would turn too fast."""
    WHEEL_ACCELERATION = 1 << 4
    """A wheel would speed up or slow down too fast."""
    SPEED = 1 << 5
    """The body would be too fast."""
    YAW_RATE = 1 << 6
    """The body would turn too fast."""
    LATERAL_ACCELERATION = 1 << 7
    """Speed times yaw rate would be too much."""
    ACCELERATION = 1 << 8
    """The body speeds up, or changes its direction, as fast as it may."""
    DECELERATION = 1 << 9
    """The body slows down as fast as it may."""
    JERK = 1 << 10
    """The acceleration changes as fast as it may."""
    ANGULAR_ACCELERATION = 1 << 11
    """The yaw rate grows, or follows the direction, as fast as it may."""
    ANGULAR_DECELERATION = 1 << 12
    """The yaw rate shrinks as fast as it may."""
    ANGULAR_JERK = 1 << 13
    """The angular acceleration changes as fast as it may."""
    SPIN_ISLAND = 1 << 14
    """No continuous turn of the wheels leads to the motion asked for: stop, re-align, go on."""
    PROJECTED = 1 << 15
    """The rover cannot make the twist asked for; this is the nearest it can."""
    STALE = 1 << 16
    """The last command is too old: the rover stops."""
    NOT_FINITE = 1 << 17
    """The latest command was not finite and is ignored."""
    ALIGNING = 1 << 18
    """The wheels are not yet where the motion needs them."""
    OUT_OF_ORDER = 1 << 19
    """A command older than the last one came since the last step, and is ignored."""
    PAUSED = 1 << 20
    """The step took longer than a step may, and counts as one of that length."""
