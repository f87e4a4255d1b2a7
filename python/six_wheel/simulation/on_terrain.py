"""`simulate` on ground: a suspension driven over a map, every wheel on it, with what its sensors report."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from six_wheel._core import RockerBogie, SettledPose, Terrain
from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.poses import Floats, quaternions
from six_wheel.logs.recordings import GroundTruth
from six_wheel.simulation.course import read_course
from six_wheel.simulation.planar import FINER, Motion, Simulation, Slip, SlippingRover, generator, step_of
from six_wheel.simulation.sensor_model import Sensors

if TYPE_CHECKING:
    from six_wheel._core import WheelSlip


@checked_class
@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class GroundSimulation(Simulation):
    """A log of a drive over ground, with its truth and with where the rover stood all along.

    Attributes
    ----------
    stand : SettledPose
        The settled pose at every sample: z, roll, pitch, joints, contact angles, contacts, statuses.
    wheel_speeds : ndarray, shape (n, wheels)
        True speeds of the wheels against their links [rad/s].
    flat_wheel_speeds : ndarray, shape (n, wheels)
        Wheel speeds of the same commands on level ground [rad/s].
    twists : ndarray, shape (n, 6)
        ``vx, vy, vz, wx, wy, wz`` of the body's origin in its own axes [m/s, rad/s].
    joint_rates : ndarray, shape (n, joints)
        Rates of the free angles [rad/s].
    slip : WheelSlip
        Slip ratio and slip angle of every wheel.
    orientations : ndarray, shape (n, 4)
        Of the body, as quaternions x, y, z, w.
    angular_velocity : ndarray, shape (n, 3)
        Rates of an IMU about the body's axes, with the noise of the gyroscope [rad/s].
    """

    stand: SettledPose
    wheel_speeds: Floats
    flat_wheel_speeds: Floats
    twists: Floats
    joint_rates: Floats
    slip: WheelSlip
    orientations: Floats
    angular_velocity: Floats


def simulate_on_ground(
    suspension: RockerBogie,
    path: ArrayLike | tuple[ArrayLike, ArrayLike],
    ground: Terrain,
    sensors: Sensors,
    slips: Sequence[Slip],
    *,
    rate: float,
    speed: float,
    start: ArrayLike | None,
    seed: int,
    named: Mapping[str, Any],
) -> GroundSimulation:
    """See `simulate`: speeds and yaw rates of `path` are those seen from above, along the heading.

    The rover steers as on level ground and goes where that leads; it settles at every row, eight rows a
    sample, and its wheels turn as far as they roll there.
    """
    random = generator(seed)
    planar = suspension.planar()
    course = read_course(path, planar, speed)
    slipping = SlippingRover(planar, sensors.noise, slips, random)
    first = course.begin(start)
    moved = slipping.drive(course, step_of(course, rate), first)
    stand = suspension.settle(ground, moved.poses, moved.steering)
    _check(stand, moved)
    wanted = course.at(moved.stamps)[:, [0, 2]]
    told = suspension.inverse(stand, wanted, view="plan", steering=moved.steering)
    speeds = _filled(told.wheel_speeds)
    turning = (speeds[1:] + speeds[:-1]) / 2.0
    slipping.spin(moved.stamps, turning)
    dt = np.diff(moved.stamps)[:, None]
    turned = np.concatenate((np.zeros((1, len(planar.wheels))), np.cumsum(turning * dt, axis=0)))
    yaw_rate = np.where(np.isnan(told.twist[:, 5]), moved.yaw_rate, told.twist[:, 5])
    motion = Motion(moved.stamps, moved.poses, moved.steering, turned, yaw_rate)
    sampled = Motion(*(getattr(motion, one.name)[::FINER] for one in fields(motion)))
    read = sensors.read(planar, sampled, random)
    there = suspension.settle(ground, sampled.poses, sampled.steering)
    twists, joint_rates = told.twist[::FINER], told.joint_rates[::FINER]
    ends = np.concatenate((turning[:1], turning, turning[-1:]))
    real = (ends[1:] + ends[:-1]) / 2.0  # at a row, the mean of the steps beside it
    known = ~np.isnan(twists[:, 0])
    slid = suspension.slip(
        there, real[::FINER], np.where(known[:, None], twists, 0.0), np.nan_to_num(joint_rates)
    )
    spread = 0.0 if sensors.gyroscope is None else sensors.gyroscope.noise
    space = np.stack((there.z, there.roll, there.pitch), axis=-1)
    stamps, stands = read["stamps"], bool(np.isfinite(space).all())
    return GroundSimulation(
        **read,
        **named,
        truth=GroundTruth(stamps, sampled.poses, space=space if stands else None),
        motion=motion,
        stand=there,
        wheel_speeds=speeds[::FINER],
        flat_wheel_speeds=planar.inverse(course.at(stamps), previous=sampled.steering)[1],
        twists=twists,
        joint_rates=joint_rates,
        slip=slid,
        orientations=quaternions(np.stack((there.roll, there.pitch, there.poses[:, 2]), axis=-1)),
        angular_velocity=twists[:, 3:] + spread * random.standard_normal((len(twists), 3)),
    )


def _filled(speeds: Floats) -> Floats:
    """Speeds of the wheels; rows without a settled pose, which the status says, between those beside."""
    rows, known = np.arange(len(speeds)), ~np.isnan(speeds[:, 0])
    return np.stack([np.interp(rows, rows[known], column[known]) for column in speeds.T], axis=-1)


def _check(stand: SettledPose, moved: Motion) -> None:
    """Fails where the map ends or has holes, and where nothing at all settles."""
    statuses = np.asarray(stand.status).astype(str)
    for status, rule in (("off_map", "stay on the map"), ("unknown_cells", "stay on known ground")):
        if (statuses == status).any():
            row = int(np.argmax(statuses == status))
            x, y, _ = moved.poses[row]
            raise ValueError(f"path must {rule}, got x {x:.6g}, y {y:.6g} after {moved.stamps[row]:.6g} s")
    if (statuses == "not_converged").all():
        raise ValueError("path must lead where the rover can stand, got none of it")


def middle(ground: Terrain) -> tuple[float, float]:
    """Middle of a map, x and y [m]."""
    (rows, columns), (dx, dy), (x, y) = ground.shape, ground.spacing, ground.origin
    ahead, aside = dx * (columns - 1) / 2, dy * (rows - 1) / 2
    cos, sin = math.cos(ground.yaw), math.sin(ground.yaw)
    return x + cos * ahead - sin * aside, y + sin * ahead + cos * aside
