"""Motion of body, joints and wheels together on the ground a rover stands on.

At a contact the normal of the ground is n, the rim's tangent ``T = h cos t + u sin t``, and ``l = n x T``
points to the left. The touching point of the wheel has no velocity along n, none along T once the wheel's own
turning is taken off, and none along l as far as it does not slip. With c the wheel's centre and w its link:

    v_touch = v_c + w x (p - c) - radius rate T

All vectors are in the body's axes; a twist is ``(vx, vy, vz, wx, wy, wz)`` of the body's origin.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from six_wheel.reference.ground.chain import Chain, Posture
from six_wheel.reference.ground.settle import SettledPose, attitude
from six_wheel.reference.planar.geometry import Floats


@dataclass(frozen=True)
class Contacts:
    """Rows of the contacts, linear in ``(twist, joint rates)``: `normal`, `along` and `left`, each of shape
    (wheels, 6 + joints), give the touching point's velocity before the wheel turns."""

    posture: Posture
    touching: list[int]
    normal: Floats
    along: Floats  # over the radius, less the turning of the link: the encoder's rate
    left: Floats
    steered: Floats  # (wheels, 2) what a rate of the wheel's own steering adds to normal and left


def touch(chain: Chain, stand: SettledPose, steering: ArrayLike | None = None) -> Contacts:
    """The contacts of a stand, or those of other steering angles on the tangent planes it stands on."""
    assert stand.joints is not None
    assert stand.steering is not None
    turned = steering is not None
    posture = Posture(chain, stand.joints, steering if turned else stand.steering)
    to_body = attitude(stand.roll, stand.pitch, float(stand.pose[2])).T
    joints = len(chain.limits)
    rows = np.zeros((3, len(chain.wheels), 6 + joints))
    swivels = np.zeros((len(chain.wheels), 2))
    for k, (wheel, at) in enumerate(zip(chain.wheels, stand.gaps, strict=True)):
        assert at.slope is not None
        normal = to_body @ [-at.slope[0], -at.slope[1], 1.0]
        normal /= np.linalg.norm(normal)
        h, u = posture.forward[k], posture.up[k]
        angle = math.atan2(-(h @ normal), u @ normal) if turned else at.angle
        tangent = h * math.cos(angle) + u * math.sin(angle)
        left = np.cross(normal, tangent)
        centre = posture.centres[k]
        point = centre + wheel.radius * (h * math.sin(angle) - u * math.cos(angle))

        def velocities(turn: Floats, lever: Floats) -> list[float]:
            """Of the touching point, for a turn of the link and a velocity of the centre."""
            moved = lever + np.cross(turn, point - centre)  # noqa: B023 - called within this round
            axle = posture.axle[k]  # noqa: B023
            rolled = lever @ tangent / wheel.radius - turn @ axle  # noqa: B023
            return [moved @ normal, rolled, moved @ left]  # noqa: B023

        for column, axis in enumerate(np.eye(3)):
            rows[:, k, column] = velocities(np.zeros(3), axis)
            rows[:, k, 3 + column] = velocities(axis, np.cross(axis, centre))
        for joint in range(joints):
            rows[:, k, 6 + joint] = velocities(posture.turns[k, joint], posture.levers[k, joint])
        swivels[k] = np.delete(velocities(posture.mounts[k], np.zeros(3)), 1)
    touching = [k for k in range(len(chain.wheels)) if k not in stand.hanging]
    return Contacts(posture, touching, rows[0], rows[1], rows[2], swivels)


@dataclass(frozen=True)
class Forward:
    """The motion that the wheels tell."""

    twist: Floats
    joint_rates: Floats
    residuals: Floats  # (wheels, 3): along n, T and l [m/s], what the contacts slip; NaN for hanging wheels


def forward(
    chain: Chain,
    stand: SettledPose,
    wheel_speeds: ArrayLike,
    *,
    steering_rates: ArrayLike | None = None,
    joint_rates: ArrayLike | None = None,
    angular_velocity: ArrayLike | None = None,
    weights: ArrayLike | None = None,
) -> Forward:
    """The motion in plan by weighted least squares over the contacts; what was measured is no unknown.

    For any motion in plan the suspension follows the ground: the vertical speed and what was not measured of
    tilt and joint rates are those that keep the wheels on it, in least squares where there are fewer of them
    than wheels. `weights` are per wheel, or (wheels, 2) for rolling and side slip.
    """
    contacts = touch(chain, stand)
    count, width = len(chain.wheels), 6 + len(chain.limits)
    radii = np.array([wheel.radius for wheel in chain.wheels])
    swivel = np.zeros(count)
    if steering_rates is not None:
        swivel[chain.steered] = steering_rates
    motion = np.full(width, math.nan)
    if angular_velocity is not None:
        motion[3:6] = angular_velocity
    if joint_rates is not None:
        motion[6:] = joint_rates
    motion[[6 + j for j in stand.stopped]] = 0.0
    known = np.where(np.isnan(motion), 0.0, motion)
    plan = [k for k in (0, 1, 5) if math.isnan(motion[k])]
    follows = [k for k in range(width) if math.isnan(motion[k]) and k not in plan]

    rolls = contacts.along * radii[:, None]
    lifted = contacts.normal @ known + contacts.steered[:, 0] * swivel
    on = contacts.touching
    follow = np.linalg.pinv(contacts.normal[np.ix_(on, follows)])
    # Twist and joint rates are `known + spread @ (motion in plan)` once the suspension has followed.
    known[follows] = -follow @ lifted[on]
    spread = np.eye(width)[:, plan]
    spread[follows] = -follow @ contacts.normal[np.ix_(on, plan)]
    weight = np.ones((count, 2)) if weights is None else np.asarray(weights, float)
    weight = np.broadcast_to(weight if weight.ndim == 2 else weight[:, None], (count, 2))
    root = np.sqrt(np.concatenate([weight.max(axis=1)[on], weight[on, 0], weight[on, 1]]))
    rows = np.concatenate([contacts.normal[on], rolls[on], contacts.left[on]])
    turned = [contacts.steered[on, 0] * swivel[on], -radii[on] * np.asarray(wheel_speeds, float)[on]]
    told = np.concatenate([*turned, contacts.steered[on, 1] * swivel[on]])
    slipping = root * (rows @ known + told)
    known = known - spread @ np.linalg.lstsq(root[:, None] * (rows @ spread), slipping, rcond=None)[0]
    residual = np.full((count, 3), math.nan)
    residual[on] = (rows @ known + told).reshape(3, -1).T
    return Forward(known[:6], known[6:], residual)


@dataclass(frozen=True)
class Inverse:
    """Steering angles and wheel speeds for a wanted motion, with twist and joint rates."""

    steering: Floats
    wheel_speeds: Floats  # [rad/s]
    twist: Floats
    joint_rates: Floats


def rest_offset(chain: Chain) -> float:
    """Distance behind the origin of the mean of the unsteered wheels, all joints at 0 [m]."""
    fixed = [wheel.centre[0] for wheel in chain.wheels if not wheel.steered]
    return -float(np.mean(fixed)) if fixed else 0.0


def rigid(chain: Chain, stand: SettledPose, told: Sequence[tuple[ArrayLike, float]]) -> Floats:
    """Twist and joint rates with every touching wheel on the ground, and three rows that say the rest."""
    contacts = touch(chain, stand)
    rows = [contacts.normal[k] for k in contacts.touching] + [np.asarray(row, float) for row, _ in told]
    right = [0.0] * len(contacts.touching) + [value for _, value in told]
    for joint in stand.stopped:
        rows.append(np.eye(contacts.normal.shape[1])[6 + joint])
        right.append(0.0)
    solution: Floats = np.linalg.solve(np.array(rows), np.array(right))
    return solution


def inverse(
    chain: Chain,
    stand: SettledPose,
    speed: float,
    yaw_rate: float,
    *,
    plan: bool = False,
    steering: ArrayLike | None = None,
) -> Inverse:
    """Wheels for a forward speed and a yaw rate: of the body about its own z, or, with `plan`, of the
    rover seen from above, along its heading.

    The point abreast of which the unsteered wheels stand at rest has no sideways speed. Twist and joint rates
    are those of the stand's own contacts. Steered wheels point where their touching points then go, on the
    planes they stand on, unless the angles are given.
    """
    sideways = yaw_rate * rest_offset(chain)
    body = np.eye(6 + len(chain.limits))
    if plan:
        level = attitude(stand.roll, stand.pitch, 0.0)  # axes along the heading, from those of the body
        rows = np.zeros((3, 6 + len(chain.limits)))
        rows[:2, :3] = level[:2]
        # Euler rate: yaw_rate = (sin(roll) wy + cos(roll) wz) / cos(pitch), not the vertical component of w.
        rows[2, 4:6] = np.array([math.sin(stand.roll), math.cos(stand.roll)]) / math.cos(stand.pitch)
    else:
        rows = body[[0, 1, 5]]
    motion = rigid(chain, stand, list(zip(rows, (speed, sideways, yaw_rate), strict=True)))
    if steering is None:
        angles = np.array([_heading(chain, stand, motion, k) for k in chain.steered])
    else:
        angles = np.asarray(steering, float)
    return Inverse(angles, touch(chain, stand, angles).along @ motion, motion[:6], motion[6:])


def _heading(chain: Chain, stand: SettledPose, motion: Floats, wheel: int) -> float:
    """The angle at which a steered wheel's touching point has no velocity along its axle, and so rolls.

    Half a turn on it goes to the other side: every half turn has such an angle. It is looked for about the
    one at which the point goes where it goes now.
    """
    assert stand.steering is not None
    angles = np.array(stand.steering, float)
    place = chain.steered.index(wheel)
    present = float(angles[place])

    def way(angle: float) -> tuple[float, float]:
        angles[place] = angle
        contacts = touch(chain, stand, angles)
        posture = contacts.posture
        spin = motion[3:6] + motion[6:] @ posture.turns[wheel]
        rolled = float(contacts.along[wheel] @ motion + spin @ posture.axle[wheel])
        return rolled * chain.wheels[wheel].radius, float(contacts.left[wheel] @ motion)

    ahead, aside = way(present)
    if ahead == aside == 0:
        return present
    first = present + (math.atan2(aside, ahead) if ahead >= 0 else math.atan2(-aside, -ahead))
    # False position; the end that stays twice counts half, so that both come.
    (low, below), (high, above) = ((end, way(end)[1]) for end in (first - math.pi / 2, first + math.pi / 2))
    angle, side = first, 0
    while True:
        slip = way(angle)[1]
        if (slip > 0) == (below > 0):
            low, below, above = angle, slip, above / 2 if side == -1 else above
            side = -1
        else:
            high, above, below = angle, slip, below / 2 if side == 1 else below
            side = 1
        last, angle = angle, low + (high - low) * below / (below - above)
        if slip == 0 or abs(angle - last) < 1e-15 or not low < angle < high:
            return present + math.remainder(last - present, math.pi)


@dataclass(frozen=True)
class Traction:
    """Wheels without a map."""

    steering: Floats
    wheel_speeds: Floats
    contact_angles: Floats
    vertical: float  # vz of the body's origin [m/s]


def traction(
    chain: Chain,
    speed: float,
    curvature: float,
    angular_velocity: ArrayLike,
    joints: ArrayLike,
    joint_rates: ArrayLike,
) -> Traction:
    """Speeds that roll, from speed, curvature and rates alone: each wheel's centre moves along its rim's
    tangent, whichever way that is. The vertical speed is the median of those that let one wheel each roll
    level with its link: least in the sum of ``|v . u| / u_z``.

    (O. Toupet et al., Terrain-adaptive wheel speed control on the Curiosity Mars rover, JFR 37(5), 2020,
    with the turning of the wheel's link, which the paper leaves out.)
    """
    turn, rates = np.asarray(angular_velocity, float), np.asarray(joint_rates, float)
    posture = Posture(chain, joints)
    side = curvature * speed * rest_offset(chain)
    centres = (
        np.cross(turn, posture.centres) + np.einsum("j,wjc->wc", rates, posture.levers) + [speed, side, 0]
    )
    vertical = float(np.median([-(v @ u) / u[2] for v, u in zip(centres, posture.up, strict=True)]))
    centres[:, 2] += vertical
    command = np.array([speed, side, 0.0]) + np.cross([0, 0, curvature * speed], posture.centres)
    steering = []
    for k in chain.steered:
        h, a = posture.forward[k], posture.axle[k]
        ahead, aside = float(command[k] @ h), float(command[k] @ a)
        steering.append(math.atan2(aside, ahead) if ahead >= 0 else math.atan2(-aside, -ahead))
    posture = Posture(chain, joints, steering)
    wheel_speeds, angles = [], []
    for k, wheel in enumerate(chain.wheels):
        along, lift = float(centres[k] @ posture.forward[k]), float(centres[k] @ posture.up[k])
        way = 1.0 if along >= 0 else -1.0
        angles.append(math.atan2(way * lift, way * along))
        link = turn + np.einsum("j,jc->c", rates, posture.turns[k])
        wheel_speeds.append(way * math.hypot(along, lift) / wheel.radius - link @ posture.axle[k])
    return Traction(np.array(steering), np.array(wheel_speeds), np.array(angles), vertical)
