"""Checks of readings in memory: arrays, and the columns of frames."""

import math
import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from six_wheel._core import Encoder, Rover
from six_wheel.kinematics.errors import SuspiciousReadingsWarning
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.plausibility.agreement import check_turning
from six_wheel.logs.plausibility.checks import ReadingChecks
from six_wheel.logs.plausibility.proposals import Column, encoders
from six_wheel.logs.plausibility.readings import Readings

FEW = 20  # rows that tell nothing


def array_checks(
    rover: Rover,
    options: Mapping[str, Any],
    headers: Mapping[str, str] | None = None,
    clock_stated: bool = False,
    units_stated: bool = False,
    directions: Mapping[str, str] | None = None,
) -> ReadingChecks:
    """Checks of readings that go to `Odometry` with these options.

    `headers` of a table are by ``"stamp"``, wheels, and steered wheels as ``"NAME steering"``.
    """
    known, wheels = headers or {}, options.get("wheel_encoders")
    joints, speeds = options.get("steering_encoders"), options.get("readings") == "speeds"
    each = [_of(wheels, place, name) for place, name in enumerate(rover.wheel_names)]
    steered = [_of(joints, place, name) for place, name in enumerate(rover.steered_wheel_names)]
    described = Readings(
        rover,
        kind="increments" if options.get("increments") else "speeds" if speeds else "angles",
        wheels=[Column(known.get(name, f"wheel_angles of {name}"), name) for name in rover.wheel_names],
        steering=[
            Column(known.get(f"{name} steering", f"steering of {name}"), name)
            for name in rover.steered_wheel_names
        ],
        time=known.get("stamp", "stamps"),
        named=headers is not None,
        clock_stated=clock_stated,
        wheels_stated=wheels is not None or units_stated,
        steering_stated=joints is not None or units_stated,
        wraps=any(one.wraps_at is not None for one in each),
        steering_wraps=any(one.wraps_at is not None for one in steered),
        wraps_at=np.array([one.wraps_at or np.inf for one in each]),
        turn=each[0].ticks_per_turn if each else None,
        increments_stated=bool({"readings", "increments"} & options.keys()),
        scale=np.array([one.angle_per_tick for one in each]),
        max_speed=options.get("max_speed"),
        max_gap=options.get("max_gap"),
        first_row=0,
        directions=directions or {},
    )
    return ReadingChecks(described, lambda line: warnings.warn(line, SuspiciousReadingsWarning, stacklevel=2))


def check_arrays(
    checks: ReadingChecks,
    steering: Any,
    wheels: Any,
    stamps: Any,
    truth: Floats | None = None,
    yaw_rate: Any = None,
) -> None:
    """Check a whole log in arrays, beside the poses of its truth and a gyroscope; those of another shape are
    left to `Odometry`."""
    if any(isinstance(each, np.ma.MaskedArray) for each in (steering, wheels, stamps)):
        return  # `Odometry` refuses them
    times, raw = np.asarray(stamps), np.asarray(wheels)
    angles = None if steering is None else np.asarray(steering)
    count = len(checks.readings.rover.wheels)
    if raw.ndim != 2 or raw.shape != (len(times), count) or len(times) < FEW or times.ndim != 1:
        return
    if any(each is not None and each.dtype.kind not in "fiu" for each in (times, raw, angles)):
        return
    steered = len(checks.readings.rover.steered_wheel_names)
    fits = angles is not None and angles.shape == (len(times), steered) and steered
    compared = truth is not None and len(truth) == len(times) and not checks.agreement.judged_later
    checks.turns.see(truth, of_rows=compared)
    checks.take(times, raw, None, angles if fits else None)
    checks.finish()
    known = checks.readings
    turning = None if yaw_rate is None or isinstance(yaw_rate, str) else np.asarray(yaw_rate)
    plain = known.kind == "angles" and not known.wraps and not known.wheels_stated
    if plain and turning is not None and turning.shape == times.shape and turning.dtype.kind in "fiu":
        radius = float(np.median([wheel.radius for wheel in known.rover.wheels]))
        turns = {"rev": 1.0, "deg": 360.0, "m": 2.0 * math.pi * radius}
        check_turning(
            known.rover,
            raw.astype(np.float64),
            angles if fits else None,
            times.astype(np.float64),
            turning.astype(np.float64),
            {unit: encoders(turn=turn) for unit, turn in turns.items()},
        )


def check_log(
    log: Any, rover: Rover, *, clock_stated: bool, units_stated: bool = False, judged_later: bool = False
) -> None:
    """Check a `WheelLog`, beside its truth, unless that is done later by a calibration."""
    checks = array_checks(rover, log.options, clock_stated=clock_stated, units_stated=units_stated)
    checks.agreement.judged_later = judged_later
    poses = None if log.truth is None else log.truth.poses
    check_arrays(checks, log.steering, log.wheel_angles, log.stamps, poses, log.yaw_rate)


def _of(given: Any, place: int, name: str) -> Encoder:
    """The encoder of a wheel, of what `Odometry` takes."""
    if isinstance(given, Mapping):
        return given.get(name) or Encoder()
    if isinstance(given, Sequence):
        return given[place] if place < len(given) else Encoder()
    return given or Encoder()
