"""Differences between a record and its rerun."""

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from six_wheel._core import integrate
from six_wheel.control_loop.replay.run_summary import Replayed, Run
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.poses import Floats

SECOND = 1e9


@dataclass(frozen=True)
class Figures:
    """Figures of one run, in SI units."""

    steps: int
    path_length: float
    speed: float
    yaw_rate: float
    wheel_speed: float
    steering_rate: float
    end: Floats
    odometry_end: Floats | None
    reasons: dict[str, float]
    path: Floats


@dataclass(frozen=True)
class Difference:
    """Two runs beside each other.

    Attributes
    ----------
    same_bits : bool
    recorded, again : Figures
    common : int
        Steps that both have at the same time; the rest is of these.
    first : float or None
        When commands differ for the first time [s], from the first step of the record.
    differing : int
        Steps with other commands.
    twist, steering, wheel_speeds : float
        Largest differences: of the motion's speed [m/s], of a steering angle [rad], of a wheel's speed
        [rad/s].
    """

    same_bits: bool
    recorded: Figures
    again: Figures
    common: int = 0
    first: float | None = None
    differing: int = 0
    twist: float = 0.0
    steering: float = 0.0
    wheel_speeds: float = 0.0
    rows: list[tuple[str, str, str]] = field(default_factory=list)


@checked()
def compare(replayed: Replayed) -> Difference:
    """Differences between the recorded run and the rerun."""
    one, other = replayed.recorded, replayed.again
    figures = _figures(one), _figures(other)
    times, left, right = np.intersect1d(one.times, other.times, return_indices=True)
    rows = table(*figures)
    if not len(times):
        return Difference(replayed.same_bits, *figures, rows=rows)

    def gap(name: str) -> Floats:
        apart: Floats = np.abs(getattr(one, name)[left] - getattr(other, name)[right])
        return apart

    steering, speeds, twists = gap("steering"), gap("wheel_speeds"), gap("twists")
    apart = steering.any(axis=1) | speeds.any(axis=1)
    return Difference(
        replayed.same_bits,
        *figures,
        common=len(times),
        first=float(times[apart][0] - times[0]) / SECOND if apart.any() else None,
        differing=int(apart.sum()),
        twist=float(np.hypot(*twists[:, :2].T).max()),
        steering=float(steering.max(initial=0.0)),
        wheel_speeds=float(speeds.max(initial=0.0)),
        rows=rows,
    )


def _figures(run: Run) -> Figures:
    steps = np.diff(run.times) / SECOND
    onwards = steps > 0.0  # no distance is driven in steps in which time jumped back
    steps = steps[onwards]
    path = integrate(run.twists[:-1][onwards], steps) if len(steps) else np.zeros((1, 3))
    speed = np.hypot(run.twists[:, 0], run.twists[:, 1])
    rates = np.abs(np.diff(run.steering, axis=0))[onwards] / steps[:, None]
    counts = Counter(name for names in run.reasons for name in names.split("|") if name)
    return Figures(
        len(run.times),
        float(speed[:-1][onwards] @ steps),
        float(speed.max(initial=0.0)),
        float(np.abs(run.twists[:, 2]).max(initial=0.0)),
        float(np.abs(run.wheel_speeds).max(initial=0.0)),
        float(rates.max(initial=0.0)),
        path[-1],
        run.poses[-1] if len(run.poses) else None,
        {name: count / len(run.reasons) for name, count in counts.most_common()},
        path,
    )


def table(one: Figures, other: Figures) -> list[tuple[str, str, str]]:
    """Rows of what, in the record, and again."""

    def pose(end: Any) -> str:
        return "none" if end is None else "{:.4g} m, {:.4g} m, {:.4g} rad".format(*end)

    rows = [
        ("steps", one.steps, other.steps, "{:,}"),
        ("commanded way", one.path_length, other.path_length, "{:.4g} m"),
        ("end of it", pose(one.end), pose(other.end), "{}"),
        ("end by odometry", pose(one.odometry_end), pose(other.odometry_end), "{}"),
        ("largest speed", one.speed, other.speed, "{:.4g} m/s"),
        ("largest yaw rate", one.yaw_rate, other.yaw_rate, "{:.4g} rad/s"),
        ("largest wheel speed", one.wheel_speed, other.wheel_speed, "{:.4g} rad/s"),
        ("largest steering rate", one.steering_rate, other.steering_rate, "{:.4g} rad/s"),
    ]
    told = [(name, form.format(a), form.format(b)) for name, a, b, form in rows]
    for reason in dict.fromkeys([*one.reasons, *other.reasons]):
        shares = (figures.reasons.get(reason, 0.0) for figures in (one, other))
        a, b = (f"{share:.1%} of the steps" for share in shares)
        told.append((f"limited by {reason}", a, b))
    return told
