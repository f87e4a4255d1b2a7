"""Reasons for which a step of a `Controller` differs from the motion asked for."""

from __future__ import annotations  # NumPy is not loaded for its names

from typing import TYPE_CHECKING

from six_wheel.kinematics.objects.flags import TextFlag

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Reason(TextFlag):
    """Reasons of one step, any number of them; empty for a step that makes the motion asked for.

    Each has a text, `help`; as text a reason is its name and that, several one after the other.
    """

    STEERING_LIMIT = 1 << 0, "the turn is too tight for the wheels' ranges and `steering_limit`"
    STEERING_RATE = 1 << 1, "a steering joint turns as fast as `steering_rate` allows"
    STEERING_ACCELERATION = (
        1 << 2,
        "a steering joint changes its rate as fast as `steering_acceleration` allows",
    )
    WHEEL_SPEED = (
        1 << 3,
        "a wheel would turn faster than `wheel_speed` allows: the whole motion is slowed down",
    )
    WHEEL_ACCELERATION = 1 << 4, "a wheel would change its speed faster than `wheel_acceleration` allows"
    SPEED = 1 << 5, "the body would move faster than `speed` allows: the whole motion is slowed down"
    YAW_RATE = 1 << 6, "the body would turn faster than `yaw_rate` allows"
    LATERAL_ACCELERATION = 1 << 7, "speed times yaw rate would exceed `lateral_acceleration`"
    ACCELERATION = 1 << 8, "the body speeds up, or changes its direction, as fast as `acceleration` allows"
    DECELERATION = 1 << 9, "the body slows down as fast as `deceleration` allows"
    JERK = 1 << 10, "the acceleration changes as fast as `jerk` allows"
    ANGULAR_ACCELERATION = (
        1 << 11,
        "the yaw rate grows, or follows the direction, as fast as `angular_acceleration` allows",
    )
    ANGULAR_DECELERATION = 1 << 12, "the yaw rate shrinks as fast as `angular_deceleration` allows"
    ANGULAR_JERK = 1 << 13, "the angular acceleration changes as fast as `angular_jerk` allows"
    SPIN_ISLAND = 1 << 14, "no continuous turn of the wheels leads to the motion: stop, re-align, go on"
    PROJECTED = 1 << 15, "the rover cannot make the twist; this is the nearest it can make"
    STALE = 1 << 16, "the last command is older than `timeout`: the rover stops"
    NOT_FINITE = 1 << 17, "the latest command was not finite and is ignored"
    ALIGNING = 1 << 18, "the wheels are not yet where the motion needs them"
    OUT_OF_ORDER = 1 << 19, "a command older than the last one came since the last step, and is ignored"
    PAUSED = 1 << 20, "the step took longer than `max_step`, and counts as one of that length"
    HALTED = 1 << 21, "halt() was called, or a joint does not follow: at rest until release()"
    JOINT_STUCK = 1 << 22, "a steering joint does not follow its commands: `worst_joint`"

    def __str__(self) -> str:
        return "; ".join(f"{each.name}: {each._text}" for each in type(self) if each in self) or "none"


def reason_names(reasons: int) -> str:
    """The names of reasons, joined by ``|``."""
    return "|".join(str(each.name) for each in Reason if each & reasons)


def reason_counts(reasons: NDArray[np.uint32]) -> dict[str, int]:
    """Number of the steps with each reason there was."""
    counts = {str(each.name): int(((reasons & each.value) != 0).sum()) for each in Reason}
    return {name: count for name, count in counts.items() if count}


def reason_shares(reasons: NDArray[np.uint32]) -> dict[str, float]:
    """Share of the steps, 0 to 1, of every reason there was."""
    return {name: count / len(reasons) for name, count in reason_counts(reasons).items()}
