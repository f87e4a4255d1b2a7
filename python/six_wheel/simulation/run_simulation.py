"""`simulate`: a drive that never was, as a log with its truth."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from numbers import Real
from typing import Any, TypeGuard, overload

import numpy as np
from numpy.typing import ArrayLike

from six_wheel._core import Gyroscope, Limits, Noise, RockerBogie, Rover, Terrain, check_kind
from six_wheel.kinematics.errors import ArgumentTypeError, shown
from six_wheel.kinematics.keywords import checked
from six_wheel.logs.recordings import GroundTruth
from six_wheel.simulation.course import read_course
from six_wheel.simulation.on_terrain import GroundSimulation, simulate_on_ground
from six_wheel.simulation.planar import Simulation, Slip, SlippingRover, generator, step_of
from six_wheel.simulation.sensor_model import Encoders, Sensors, sample_times
from six_wheel.simulation.sticking import Stick, drive_stuck


@overload
def simulate(
    rover: RockerBogie,
    path: ArrayLike | tuple[ArrayLike, ArrayLike],
    *,
    ground: Terrain | None,
    noise: Noise | None = None,
    wheel_encoders: Encoders | None = None,
    steering_encoders: Encoders | None = None,
    slip: Slip | Sequence[Slip] = (),
    gyroscope: Gyroscope | None = None,
    rate: float = 50.0,
    speed: float = 0.5,
    start: ArrayLike | None = None,
    seed: int = 0,
    name: str = "",
    session: str = "",
) -> GroundSimulation: ...


@overload
def simulate(
    rover: Rover,
    path: ArrayLike | tuple[ArrayLike, ArrayLike],
    *,
    noise: Noise | None = None,
    wheel_encoders: Encoders | None = None,
    steering_encoders: Encoders | None = None,
    slip: Slip | Sequence[Slip] = (),
    stick: Stick | None = None,
    limits: Limits | None = None,
    control: Mapping[str, Any] | None = None,
    gyroscope: Gyroscope | None = None,
    rate: float = 50.0,
    jitter: float = 0.0,
    dropped: float = 0.0,
    speed: float = 0.5,
    start: ArrayLike | None = None,
    truth_noise: tuple[float, float] = (0.0, 0.0),
    seed: int = 0,
    name: str = "",
    session: str = "",
) -> Simulation: ...


@checked()
def simulate(
    rover: Rover | RockerBogie,
    path: ArrayLike | tuple[ArrayLike, ArrayLike],
    *,
    ground: Terrain | None = None,
    noise: Noise | None = None,
    wheel_encoders: Encoders | None = None,
    steering_encoders: Encoders | None = None,
    slip: Slip | Sequence[Slip] = (),
    stick: Stick | None = None,
    limits: Limits | None = None,
    control: Mapping[str, Any] | None = None,
    gyroscope: Gyroscope | None = None,
    rate: float = 50.0,
    jitter: float = 0.0,
    dropped: float = 0.0,
    speed: float = 0.5,
    start: ArrayLike | None = None,
    truth_noise: tuple[float, float] = (0.0, 0.0),
    seed: int = 0,
    name: str = "",
    session: str = "",
) -> Simulation:
    """A log with truth, of any rover on a plane, or of a suspension on ground: the same for the same seed.

    Parameters
    ----------
    rover : Rover or RockerBogie
        As it is built. On ground, a `RockerBogie`.
    path : array_like or pair of array_like
        Commands: rows ``[time, vx, vy, omega]``, shape (n, 4), or a pair of stamps (n,) and twists (n,
        3); between rows the twist changes evenly. Or poses, shape (n, 3), each reached from the one
        before on one arc at `speed`. Of twists the rover cannot make it makes the nearest.
    ground : Terrain, optional
        Ground under a `RockerBogie`. Speeds and yaw rates are then those seen from above, along the
        heading.
    noise : Noise, optional
        Errors of readings and slip of contacts, default ``Noise(speed=0, steering=0)``: none.
    wheel_encoders, steering_encoders : Encoder, sequence of Encoder or dict of str to Encoder, optional
        Encoders of wheels and joints: ticks, gear, where the counter starts over. Without one they
        read radians.
    slip : Slip or sequence of Slip
        Stretches in which wheels spin or the body drifts.
    stick : Stick, optional
        A steering joint that sticks. The rover is then driven through a `Controller` that measures its
        joints, on a plane.
    limits : Limits, optional
        Of that controller.
    control : mapping of str to object, optional
        Other keywords of it.
    gyroscope : Gyroscope, optional
        Its bias starts at random within its deviation, and wanders.
    rate : float, default 50.0
        Samples per second.
    jitter : float, default 0.0
        Standard deviation of the time between samples [s]; the stamps are right.
    dropped : float, default 0.0
        Share of the rows that get lost.
    speed : float, default 0.5
        Along poses [m/s].
    start : array_like, shape (3,), optional
        First pose [m, m, rad], default that of the poses, and the origin for commands. Another one moves the
        whole path there.
    truth_noise : tuple of float, default (0, 0)
        Standard deviation of the truth's places [m] and headings [rad].
    seed : int, default 0
        Of all that is random.
    name, session : str
        Of the log.

    Returns
    -------
    Simulation
        A `WheelLog` with `truth`, and `yaw_rate` if there is a gyroscope; `dead_reckon` takes it as it is. On
        ground a `GroundSimulation`, which also says how the rover stood.

    Raises
    ------
    ValueError
        If an argument breaks its rule.
    """
    check_kind("noise", noise)
    check_kind("gyroscope", gyroscope)
    slips = [slip] if isinstance(slip, Slip) else slip
    if not isinstance(slips, Sequence) or not all(isinstance(one, Slip) for one in slips):
        raise ArgumentTypeError(f"slip must be a Slip or several, got {shown(slip)}")
    _check_numbers(rate, speed, jitter, dropped, truth_noise)
    sensors = Sensors(noise or Noise(0.0, 0.0), wheel_encoders, steering_encoders, gyroscope)
    named: dict[str, Any] = {"name": name or f"seed {seed}", "session": session}
    if isinstance(rover, RockerBogie):
        check_kind("ground", ground)
        if ground is None:
            raise ValueError("ground must be given for a suspension, got None; or simulate rover.planar(...)")
        if jitter or dropped or any(truth_noise) or stick is not None:
            raise ValueError("jitter, dropped, truth_noise and stick must be left out on ground")
        return simulate_on_ground(
            rover, path, ground, sensors, slips, rate=rate, speed=speed, start=start, seed=seed, named=named
        )
    check_kind("rover", rover)
    if ground is not None:
        raise ValueError("rover must be a RockerBogie to drive over ground, got a Rover")
    random, course = generator(seed), read_course(path, rover, speed)
    step, first, controlled = step_of(course, rate), course.begin(start), None
    slipping = SlippingRover(rover, sensors.noise, slips, random)
    if stick is None:
        motion = slipping.drive(course, step, first)
    else:
        check_kind("limits", limits)
        options = (limits or Limits(), control or {})
        motion, controlled = drive_stuck(slipping, course, stick, *options, step=step, start=first)
    stamps = sample_times(motion.stamps[0], motion.stamps[-1], rate, jitter, dropped, random)
    # A gyroscope has the mean from halfway since the sample before to halfway on.
    edges = np.concatenate((stamps[:1], (stamps[1:] + stamps[:-1]) / 2.0, stamps[-1:]))
    yaw_rate = np.diff(motion.at(edges).poses[:, 2]) / np.diff(edges)
    there = replace(motion.at(stamps), yaw_rate=yaw_rate)
    read = sensors.read(rover, there, random)
    deviations = np.array(truth_noise)[[0, 0, 1]]
    poses = there.poses + deviations * random.standard_normal(there.poses.shape)
    return Simulation(**read, **named, truth=GroundTruth(stamps, poses), motion=motion, controlled=controlled)


def _check_numbers(
    rate: object, speed: object, jitter: object, dropped: Any, truth_noise: Sequence[object]
) -> None:
    """Arguments of `simulate` that are numbers."""
    if not (isinstance(truth_noise, Sequence) and len(truth_noise) == 2):
        rule = "must be two deviations, of places [m] and headings [rad]"
        raise ArgumentTypeError(f"truth_noise {rule}, got {shown(truth_noise)}")
    deviations = [("truth_noise", one) for one in truth_noise]
    for argument, value in (("jitter", jitter), ("dropped", dropped), *deviations):
        if not (_is_number(value) and value >= 0.0):
            raise ValueError(f"{argument} must be finite and not negative, got {value!r}")
    for argument, value in (("rate", rate), ("speed", speed)):
        if not (_is_number(value) and value > 0.0):
            raise ValueError(f"{argument} must be finite and positive, got {value!r}")
    if dropped >= 1.0:
        raise ValueError(f"dropped must be below 1, got {dropped}")


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, Real) and math.isfinite(value)
