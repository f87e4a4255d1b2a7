"""Motion of a rover: the commanded one and the one within limits. No mathematics of its own."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from six_wheel._core import Limits, Rover, SettledPose, Stability, compose, integrate
from six_wheel.kinematics.controller import Reason, reason_names
from six_wheel.kinematics.errors import InfeasibleMotionError
from six_wheel.kinematics.poses import Floats
from six_wheel.kinematics.statuses import SettleStatus
from six_wheel.simulation.drive.performance import within
from six_wheel.view.subject import Subject

POINTS = 41  # of a path ahead
AHEAD = 40.0  # [s] of it at most
FARTHEST = 2.5  # sizes of the rover that it is long at most
HANGING = 1e-4  # wheel radii of air under a wheel that hangs
STANDING = (SettleStatus.settled, SettleStatus.at_stop)


@dataclass(frozen=True)
class State:
    """The positions of the sliders.

    Attributes
    ----------
    twist : tuple of float
        Commanded vx, vy, omega [m/s, m/s, rad/s].
    steering_limit : float or None
        [rad]
    wheel_speed, speed : float
        Limits [rad/s, m/s].
    tilt : float
        Largest allowed [rad].
    pose : tuple of float
        x, y, yaw [m, m, rad].
    joints : tuple of float
        Angles of the suspension where there is no ground [rad].
    steering : tuple of float or None
        Angles of the steered wheels that are given, as in a record [rad]; None those of the motion.
    wheel_speeds : tuple of float or None
        Wheel speeds that are given [rad/s].
    scrub : tuple of float or None
        Of every wheel, from its steering axis to its contact on the left [m]; None as the rover has it.
    rolled : tuple of float
        Angles by which the wheels have turned [rad].
    """

    twist: tuple[float, float, float] = (0.0, 0.0, 0.0)
    steering_limit: float | None = None
    wheel_speed: float = 1.0
    speed: float = np.inf
    tilt: float = np.inf
    pose: tuple[float, float, float] = (0.0, 0.0, 0.0)
    joints: tuple[float, ...] = (0.0, 0.0, 0.0)
    steering: tuple[float, ...] | None = None
    wheel_speeds: tuple[float, ...] | None = None
    rolled: tuple[float, ...] = ()
    scrub: tuple[float, ...] | None = None

    def rover(self, subject: Subject) -> Rover:
        """The rover of the subject with the steering ranges and the scrub of the sliders."""
        rover = restricted(subject.rover, self.steering_limit)
        for wheel, scrub in zip(rover.wheels, self.scrub or (), strict=False):
            if scrub != wheel.scrub:
                rover = rover.replace(wheel.name, scrub=scrub)
        return rover

    def limits(self, subject: Subject) -> Limits:
        """The limits of the subject with those of the sliders."""
        speed = None if not np.isfinite(self.speed) else self.speed
        limit = self.steering_limit if self.steering_limit is None or self.steering_limit < np.pi else None
        return subject.limits.replace(wheel_speed=self.wheel_speed, speed=speed, steering_limit=limit)


@dataclass(frozen=True, eq=False)
class Motion:
    """The motion of a rover in a state.

    Attributes
    ----------
    state : State
    twist : ndarray, shape (3,)
        The motion the rover makes.
    reasons : Reason
        Reasons why it is not the commanded one.
    steering, wheel_speeds : ndarray
        Angles of the steered wheels, speeds of all [rad, rad/s].
    slide : ndarray, shape (wheels,)
        Speed at which every contact slides [m/s].
    icr : ndarray, shape (2,)
        Centre of rotation in the body [m]; not finite on a straight line.
    transform : ndarray, shape (4, 4)
        world_from_body.
    joints : ndarray, shape (3,)
        Rocker and bogies [rad].
    frames : dict of str to ndarray, shape (4, 4)
        Links of the suspension in the body, by name.
    wheels, straight : ndarray, shape (wheels, 4, 4)
        body_from_wheel, x along the direction in which it rolls; the same at steering angle 0.
    stand : SettledPose or None
    stability : Stability or None
    remarks : tuple of str
        Further lines.
    """

    state: State
    twist: Floats
    reasons: Reason
    steering: Floats
    wheel_speeds: Floats
    slide: Floats
    icr: Floats
    transform: Floats
    joints: Floats
    frames: dict[str, Floats]
    wheels: Floats
    straight: Floats
    stand: SettledPose | None = None
    stability: Stability | None = None
    remarks: tuple[str, ...] = ()

    @property
    def stands(self) -> bool:
        """True if the rover has settled; on a plane it always has."""
        return self.stand is None or self.stand.status in STANDING

    @property
    def possible(self) -> bool:
        """True if the motion is the commanded one."""
        return bool(np.allclose(self.twist, self.state.twist, rtol=1e-9, atol=1e-12))

    @property
    def hanging(self) -> list[str]:
        """Names of the wheels that touch nothing."""
        if self.stand is None or not self.stands:
            return []
        suspension: Any = self.stand.suspension
        hangs = np.asarray(self.stand.gap) > HANGING * float(suspension.dimensions["wheel_radius"])
        return [name for name, hanging in zip(suspension.wheel_names, hangs, strict=True) if hanging]


def restricted(rover: Rover, steering_limit: float | None) -> Rover:
    """The rover with no wheel steering farther than a limit [rad]."""
    if steering_limit is None or steering_limit >= np.pi:
        return rover
    for wheel in rover.wheels:
        if wheel.steering_range is not None:
            low, high = wheel.steering_range
            narrow = (max(low, -steering_limit), min(high, steering_limit))
            if narrow != (low, high):
                rover = rover.replace(wheel.name, steering_limit=narrow)
    return rover


def find_motion(subject: Subject, state: State, previous: Motion | None = None) -> Motion:
    """The motion within limits of a state, with its wheels and its settled pose.

    On ground the rover steers as on level ground and its wheels turn as far as they roll there, as in
    `simulate`. Where it does not settle it stays as it was.
    """
    rover = state.rover(subject)
    remarks: list[str] = []
    if state.steering is None:
        found = within(rover, state.limits(subject), state.twist)
        twist, reasons = found.twist, found.reasons
        before = None if previous is None else previous.steering
        steering, speeds = rover.inverse(twist, previous=_inside(rover, before))
    else:
        twist, reasons = np.array(state.twist), Reason(0)
        steering = np.array(state.steering)
        speeds = np.zeros(len(rover.wheels)) if state.wheel_speeds is None else np.array(state.wheel_speeds)
    fit = rover.fit(steering, speeds, allow_underdetermined=True)
    slide, icr = fit.residuals, rover.icr(twist)
    suspension, ground = subject.suspension, subject.ground
    if suspension is None:
        transform = _level(state.pose)
        wheels, straight = (_planar_wheels(rover, angles) for angles in (steering, np.zeros_like(steering)))
        return Motion(
            state, twist, reasons, steering, speeds, slide, icr, transform, np.zeros(0), {}, wheels, straight
        )
    stand = stability = None
    transform, joints = _level(state.pose), np.array(state.joints)
    if ground is not None:
        stand = suspension.settle(ground, state.pose, steering)
        if stand.status in STANDING:
            transform, joints = stand.transform, stand.joints
            stability = suspension.stability(stand, mass=1.0)
            speeds, slide = _rolling(stand, twist, steering, state, remarks, slide)
        elif previous is not None and previous.stands:
            remarks.append(f"{stand.status}: it stays where it stood")
            still = replace(state, pose=previous.state.pose)
            again = find_motion(subject, still) if previous.state.pose != state.pose else None
            if again is not None and again.stands:
                return replace(again, remarks=(*again.remarks, *remarks))
        else:
            remarks.append(f"{stand.status}: it does not stand there")
    frames = suspension.frames(joints, steering)
    unturned = suspension.frames(joints)
    names = [f"A{number}" for number in range(1, len(rover.wheels) + 1)]
    wheels, straight = (np.stack([each[name] for name in names]) for each in (frames, unturned))
    if state.scrub is not None:  # the wheels are so much farther to their left
        moved = np.subtract(state.scrub, [wheel.scrub for wheel in subject.rover.wheels])[:, None]
        for each in (wheels, straight):
            each[:, :3, 3] += moved * each[:, :3, 1]
    return Motion(
        state, twist, reasons, steering, speeds, slide, icr, transform, joints, dict(frames),
        wheels, straight, stand, stability, tuple(remarks),
    )  # fmt: skip


def _rolling(
    stand: SettledPose, twist: Floats, steering: Floats, state: State, remarks: list[str], slide: Floats
) -> tuple[Floats, Floats]:
    """Wheel speeds on the ground and how fast the contacts slide there."""
    inverse, forward = stand.suspension.inverse, stand.suspension.forward
    try:
        command = inverse(stand, twist[[0, 2]], view="plan", steering=steering)
        motion = forward(stand, steering, command.wheel_speeds, command.joint_rates, command.twist[3:])
    except InfeasibleMotionError as error:
        remarks.append(f"on this ground: {error}")
        return np.zeros_like(slide), slide
    if state.wheel_speeds is not None:
        return np.array(state.wheel_speeds), slide
    return command.wheel_speeds, np.linalg.norm(np.nan_to_num(motion.residuals), axis=-1)


def path_ahead(subject: Subject, motion: Motion, twist: Any) -> tuple[Floats, Floats]:
    """Poses (n, 3) of the next seconds at a twist, and the places (wheels, n, 3) of the wheels' contacts."""
    twist = np.asarray(twist, dtype=np.float64)
    # A turn moves the wheels too.
    speed = float(np.hypot(*twist[:2]) + abs(twist[2]) * subject.size / 2.0)
    duration = min(AHEAD, FARTHEST * subject.size / speed) if speed > 0.0 else 0.0
    steps = np.broadcast_to(twist, (POINTS - 1, 3))
    poses = integrate(steps, duration / (POINTS - 1), motion.state.pose)
    contacts = np.column_stack([motion.wheels[:, :2, 3], np.zeros(len(motion.wheels))])
    places = compose(poses[None], contacts[:, None])
    return poses, on_ground(subject, places)


def on_ground(subject: Subject, places: Floats) -> Floats:
    """Points (..., 3) on the ground at places x, y (..., 2 or 3); where it is unknown, at the mean height."""
    xy = np.ascontiguousarray(places[..., :2])
    if subject.ground is None:
        height = np.zeros(xy.shape[:-1])
    else:
        height = np.asarray(subject.ground.height_at(xy))
        height = np.where(
            np.isfinite(height), height, np.nanmean(height) if np.isfinite(height).any() else 0.0
        )
    return np.concatenate([xy, height[..., None]], axis=-1)


def words(subject: Subject, motion: Motion) -> str:
    """The feasibility of the commanded motion, with the reasons against it."""
    reasons, state = motion.reasons, motion.state
    if state.steering is not None:
        return "as recorded"
    if motion.possible or not reasons:
        return "possible as commanded" if any(state.twist) else "stands still"
    if not motion.twist.any():
        return "not possible without sliding, and nothing near it is"
    found = []
    if reasons & Reason.STEERING_LIMIT:
        found.append("past the steering range: the nearest is shown")
    elif reasons & Reason.PROJECTED:
        found.append("not without sliding: the nearest is shown")
    if reasons & Reason.WHEEL_SPEED:
        fastest = subject.rover.wheel_names[int(np.abs(motion.wheel_speeds).argmax())]
        found.append(f"slowed by the wheel speed of {fastest}")
    named = Reason(int(reasons) & ~int(Reason.STEERING_LIMIT | Reason.PROJECTED | Reason.WHEEL_SPEED))
    if named:
        found.append(f"limited by {reason_names(int(named)).lower().replace('|', ', ').replace('_', ' ')}")
    return "; ".join(found)


def _inside(rover: Rover, steering: Floats | None) -> Floats | None:
    """Previous angles, within the ranges of the wheels."""
    if steering is None:
        return None
    ranges = [wheel.steering_range for wheel in rover.wheels if wheel.steered]
    if not ranges:
        return None
    low, high = np.array(ranges).T
    clipped: Floats = np.clip(steering, low, high)
    return clipped


def _level(pose: tuple[float, float, float]) -> Floats:
    """world_from_body on a plane."""
    x, y, yaw = pose
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0.0, x], [s, c, 0.0, y], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])


def _planar_wheels(rover: Rover, steering: Floats) -> Floats:
    """body_from_wheel (wheels, 4, 4) of hubs that lie at their contacts, seen from above."""
    angles = iter(steering.tolist())
    transforms = []
    for wheel in rover.wheels:
        heading = wheel.heading + (next(angles) if wheel.steered else 0.0)
        transform = _level((wheel.x, wheel.y, heading))
        transform[:2, 3] += transform[:2, :2] @ (-wheel.trail, wheel.scrub)
        transform[2, 3] = wheel.radius
        transforms.append(transform)
    return np.stack(transforms)
