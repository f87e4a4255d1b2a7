"""Putting every wheel on the ground: the whole rim is walked, and Newton's method closes the gaps."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from six_wheel.reference.ground.chain import Chain, Posture, axis_turn
from six_wheel.reference.ground.terrain import Terrain
from six_wheel.reference.planar.geometry import Floats

SAMPLES = 1440  # of a rim: a quarter of a degree apart
NEAR = 0.01  # [m] a sampled minimum this far above the least is looked at too
TOLERANCE = 1e-12  # [m] what counts as touching: rounding at heights of some metres


@dataclass(frozen=True)
class Gap:
    """The least vertical distance of a rim from the ground, and where it is."""

    value: float  # [m]; NaN over unknown ground
    angle: float = math.nan  # contact angle [rad], from straight below towards the front
    point: Floats | None = None  # of the rim, in world axes [m]
    # of the ground along x and y; on a crease the mix that is level along the rim
    slope: Floats | None = None


@dataclass(frozen=True)
class SettledPose:
    """Settled pose of a rover: ``x, y, yaw`` were given, all else follows from the ground.

    `status` is ``settled``, ``at_stop``, ``off_map``, ``unknown_cells`` or ``not_converged``.
    """

    status: str
    pose: Floats  # x, y, yaw
    z: float = math.nan
    roll: float = math.nan
    pitch: float = math.nan
    joints: Floats | None = None
    steering: Floats | None = None
    gaps: tuple[Gap, ...] = ()
    hanging: tuple[int, ...] = ()  # wheels in the air, because a joint is at its stop
    stopped: tuple[int, ...] = ()  # joints at a stop


def attitude(roll: float, pitch: float, yaw: float) -> Floats:
    """``world_from_body``: ``Rz(yaw) Ry(pitch) Rx(roll)``."""
    rotation: Floats = axis_turn((0, 0, 1), yaw) @ axis_turn((0, 1, 0), pitch) @ axis_turn((1, 0, 0), roll)
    return rotation


def gap(ground: Terrain, centre: Floats, forward: Floats, up: Floats, radius: float) -> Gap:
    """The gap of one rim ``centre + radius (forward sin t - up cos t)``, all in world axes."""

    def rim(t: Floats) -> Floats:
        away = np.multiply.outer(np.sin(t), forward) - np.multiply.outer(np.cos(t), up)
        return centre + radius * away

    def rise(t: Floats) -> Floats:
        """Derivative of the distance by t, over the radius."""
        tangent = np.multiply.outer(np.cos(t), forward) + np.multiply.outer(np.sin(t), up)
        slope = ground.gradient_at(rim(t)[..., :2])
        risen: Floats = tangent[..., 2] - np.sum(slope * tangent[..., :2], axis=-1)
        return risen

    def above(t: Floats) -> Floats:
        point = rim(t)
        height: Floats = point[..., 2] - ground.height_at(point[..., :2])
        return height

    angles = 2 * math.pi * np.arange(SAMPLES) / SAMPLES - math.pi
    sampled = above(angles)
    if np.isnan(sampled).any():
        return Gap(math.nan)
    low = (sampled <= np.roll(sampled, 1)) & (sampled <= np.roll(sampled, -1))
    low &= sampled < sampled.min() + NEAR
    step = angles[1] - angles[0]
    before, after = angles[low] - step, angles[low] + step
    for _ in range(9):  # the slope changes its sign from below to above in between, smoothly or with a jump
        tried = before + (after - before) * np.linspace(0, 1, 33)[:, None]
        later = np.clip(np.argmax(rise(tried) > 0, axis=0), 1, 32)
        before, after = (np.take_along_axis(tried, k[None], axis=0)[0] for k in (later - 1, later))
    found = np.concatenate([0.5 * (before + after), angles[low]])  # the samples: beside a jump downwards
    best = int(np.argmin(above(found)))
    angle = found[best : best + 1]
    sides = angle + np.array([-1e-9, 1e-9])
    left, right = rise(sides)
    slopes = ground.gradient_at(rim(sides)[:, :2])
    share = right / (right - left) if left < 0 < right else 0.5
    point = rim(angle)[0]
    return Gap(float(above(angle)[0]), float(angle[0]), point, share * slopes[0] + (1 - share) * slopes[1])


def gaps(
    ground: Terrain, chain: Chain, pose: ArrayLike, free: ArrayLike, steering: ArrayLike | None
) -> list[Gap]:
    """The gaps of all wheels at ``x, y, yaw`` and ``z, roll, pitch, joints``."""
    x, y, yaw = np.asarray(pose, float)
    z, roll, pitch, *joints = np.asarray(free, float)
    rotation, posture = attitude(roll, pitch, yaw), Posture(chain, joints, steering)
    return [
        gap(
            ground,
            np.array([x, y, z]) + rotation @ posture.centres[k],
            rotation @ posture.forward[k],
            rotation @ posture.up[k],
            wheel.radius,
        )
        for k, wheel in enumerate(chain.wheels)
    ]


def slopes(chain: Chain, pose: ArrayLike, free: ArrayLike, found: list[Gap]) -> Floats:
    """Derivatives of the gaps by ``z, roll, pitch, joints``, (wheels, 3 + joints).

    The contact angle is the least one, so it does not matter how it moves.
    """
    x, y, yaw = np.asarray(pose, float)
    z, roll, pitch, *joints = np.asarray(free, float)
    rotation, posture = attitude(roll, pitch, yaw), Posture(chain, joints)
    nose = axis_turn((0, 0, 1), yaw) @ axis_turn((0, 1, 0), pitch)
    rows = []
    for k, at in enumerate(found):
        assert at.point is not None
        assert at.slope is not None
        upwards = np.array([-at.slope[0], -at.slope[1], 1.0])
        arm = at.point - [x, y, z]
        moved = [np.array([0, 0, 1.0]), np.cross(nose[:, 0], arm), np.cross(nose[:, 1], arm)]
        from_centre = arm - rotation @ posture.centres[k]
        for lever, turn in zip(posture.levers[k], posture.turns[k], strict=True):
            moved.append(rotation @ lever + np.cross(rotation @ turn, from_centre))
        rows.append([upwards @ way for way in moved])
    return np.array(rows)


def place(
    ground: Terrain,
    chain: Chain,
    pose: ArrayLike,
    steering: ArrayLike | None = None,
    start: ArrayLike | None = None,
    *,
    held: dict[int, float] | None = None,
    hanging: tuple[int, ...] = (),
) -> Floats | None:
    """``z, roll, pitch, joints`` that close the gaps of all but the hanging wheels, joints held where told.

    None where Newton's method does not get there from any of its starts.
    """
    held = held or {}
    width = 3 + len(chain.limits)
    touching = [k for k in range(len(chain.wheels)) if k not in hanging]
    loose = [k for k in range(width) if k - 3 not in held]
    spread = np.random.default_rng(7)
    for attempt in range(30 if start is None else 1):
        free = np.zeros(width) if start is None else np.array(start, float)
        if start is None:
            free[0] = _height(ground, chain, pose)
        free[1:] += 0.05 * attempt**0.5 * spread.standard_normal(width - 1) * (attempt > 0)
        for joint, angle in held.items():
            free[3 + joint] = angle
        stalled = 0
        while stalled < 8:
            found = gaps(ground, chain, pose, free, steering)
            values = np.array([at.value for at in found])[touching]
            if np.isnan(values).any():
                break
            if np.abs(values).max() < TOLERANCE:
                return free
            if np.abs(free[1:]).max() > 2:
                break  # far from any way a rover stands
            matrix = slopes(chain, pose, free, found)[np.ix_(touching, loose)]
            try:
                step = np.linalg.solve(matrix, -values)
            except np.linalg.LinAlgError:
                break
            step *= min(1.0, 0.3 / max(np.abs(step[1:]).max(), 1e-12))
            for halving in range(8):
                trial = free.copy()
                trial[loose] += step / 2**halving
                after = np.array([at.value for at in gaps(ground, chain, pose, trial, steering)])[touching]
                if np.abs(after).max() < np.abs(values).max():
                    break
            else:
                stalled += 1  # across a crease the way down may first lead up
            free = trial
    return None


def _height(ground: Terrain, chain: Chain, pose: ArrayLike) -> float:
    """A height to start from: the middle of what is under the wheels."""
    x, y, yaw = np.asarray(pose, float)
    turn = axis_turn((0, 0, 1), yaw)
    places = np.array([x, y, 0]) + np.array([wheel.centre for wheel in chain.wheels]) @ turn.T
    heights = ground.height_at(places[:, :2])
    wheel = chain.wheels[0]
    known = heights[~np.isnan(heights)]
    return float(known.mean() if known.size else 0) + wheel.radius - wheel.centre[2]


def stops(chain: Chain, free: Floats) -> list[int]:
    """Joints past their stops."""
    pairs = enumerate(zip(free[3:], chain.limits, strict=True))
    return [j for j, (angle, (low, high)) in pairs if not low - 1e-12 <= angle <= high + 1e-12]


def candidates(
    ground: Terrain, chain: Chain, pose: ArrayLike, steering: ArrayLike | None, near: Floats
) -> Iterator[tuple[Floats, tuple[int, ...], tuple[int, ...]]]:
    """Every way to stand with joints at their stops: ``z, roll, pitch, joints``, joints, hanging wheels.

    As many joints are stopped as wheels hang. No joint is past its stop, no wheel in the ground, and every
    hanging wheel is one that a joint would lower if it could turn on. `near` is where it
    would stand without stops.
    """
    joints, wheels = range(len(chain.limits)), range(len(chain.wheels))
    for count in joints:
        for stopped in itertools.combinations(joints, count + 1):
            past = tuple(int(near[3 + j] > chain.limits[j][1]) for j in stopped)
            ends = set(itertools.product((0, 1), repeat=count + 1)) - {past}
            for sides in (past, *sorted(ends)):  # the likely ones first
                held = {j: chain.limits[j][side] for j, side in zip(stopped, sides, strict=True)}
                if not all(map(math.isfinite, held.values())):
                    continue
                for hanging in itertools.combinations(wheels, count + 1):
                    free = place(ground, chain, pose, steering, near, held=held, hanging=hanging)
                    if free is None or stops(chain, free):
                        continue
                    values = [at.value for at in gaps(ground, chain, pose, free, steering)]
                    if min(values) < -1e-9:
                        continue
                    levers = Posture(chain, free[3:]).levers
                    falls = levers[hanging, :, 2][:, stopped] * (1 - 2 * np.array(sides))
                    if (falls.max(axis=1) > 0).all():
                        yield free, stopped, hanging


def settle(ground: Terrain, chain: Chain, pose: ArrayLike, steering: ArrayLike | None = None) -> SettledPose:
    """Settles the rover on the ground at ``x, y, yaw``."""
    pose = np.asarray(pose, float)
    angles = np.zeros(len(chain.steered)) if steering is None else np.asarray(steering, float)
    free = place(ground, chain, pose, steering)
    if free is None:
        return SettledPose(_why_not(ground, chain, pose), pose)
    status, stopped, hanging = "settled", tuple[int, ...](), tuple[int, ...]()
    if stops(chain, free):
        standing = next(candidates(ground, chain, pose, steering, free), None)
        if standing is None:
            return SettledPose("not_converged", pose)
        status, (free, stopped, hanging) = "at_stop", standing
    found = tuple(gaps(ground, chain, pose, free, steering))
    z, roll, pitch = free[:3].tolist()
    return SettledPose(status, pose, z, roll, pitch, free[3:], angles, found, hanging, stopped)


def _why_not(ground: Terrain, chain: Chain, pose: Floats) -> str:
    """Status of a rover that does not stand: the ground under the level rover ends, has holes, or neither."""
    turn = axis_turn((0, 0, 1), float(pose[2]))
    spacing = np.broadcast_to(ground.spacing, 2)
    low = np.asarray(ground.origin)
    high = low + spacing * (np.array(ground.grid.shape[::-1]) - 1)
    unknown = False
    for wheel in chain.wheels:
        along = np.linspace(-wheel.radius, wheel.radius, 201)
        places = (pose[:2] + (turn @ wheel.centre)[:2]) + along[:, None] * turn[:2, 0]
        if ((places < low) | (places > high)).any():
            return "off_map"
        unknown |= bool(np.isnan(ground.height_at(places)).any())
    return "unknown_cells" if unknown else "not_converged"
