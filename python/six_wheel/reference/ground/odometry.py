"""Dead reckoning in space, slow and obvious: one step at a time, looked at in its middle.

A step is a tangent ``(vx, vy, vz, wx, wy, wz)`` of the body over the whole of it, held as one screw. What
must hold is a linear system: conditions that hold exactly (wheels on the ground, measured joints and tilt)
leave a space of motions, in which least squares over rolling and side slip picks one.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from six_wheel.reference.ground.chain import Chain, Posture
from six_wheel.reference.ground.motion import touch
from six_wheel.reference.ground.settle import attitude, settle
from six_wheel.reference.ground.terrain import Terrain
from six_wheel.reference.planar.geometry import Floats

ROUNDS = 60  # of fixed-point iterations; each leaves a tenth
MEMORY = 25  # times the doubt is the way over which slopes are averaged


@dataclass(frozen=True)
class Rows:
    """Conditions on ``(twist, joint rates)``: `on` hold exactly, `along` are the encoders' rates, `left` is
    side slip; `lifted` and `swept` is what the wheels' own steering adds to the first and the last. `slopes`
    is how steeply the wheels climb against their plane, where there is no map."""

    on: Floats
    along: Floats
    left: Floats
    lifted: Floats
    swept: Floats
    slopes: Floats


def rotation_vector(turn: Floats) -> Floats:
    """The logarithm of a rotation by less than half a turn."""
    cosine = (np.trace(turn) - 1) / 2
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
    sine = float(np.linalg.norm(axis))
    angle = math.atan2(sine, cosine)
    vector: Floats = axis * (angle / sine if sine > 1e-8 else 1.0)
    return vector


def screw(tangent: Floats) -> tuple[Floats, Floats]:
    """Translation and rotation after one unit of time, by the power series of the matrix exponential."""
    way, turn = tangent[:3], tangent[3:]
    x, y, z = turn
    motion = np.zeros((4, 4))
    motion[:3, :3] = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    motion[:3, 3] = way
    total, term = np.eye(4), np.eye(4)
    for k in range(1, 40):
        term = term @ motion / k
        total = total + term
    return total[:3, 3], total[:3, :3]


def plane(points: Floats) -> Floats:
    """The upward normal of the plane nearest to points, in least squares of their heights."""
    around = points - points.mean(axis=0)
    slopes = np.linalg.lstsq(around[:, :2], around[:, 2], rcond=None)[0]
    normal: Floats = np.append(-slopes, 1.0)
    return normal / np.linalg.norm(normal)


def unmapped(
    chain: Chain,
    joints: Floats,
    steering: Floats,
    swivels: Floats,
    wheel_speeds: Floats,
    motion: Floats,
    before: Floats,
    doubt: float,
) -> Rows:
    """Rows of the contacts on unknown ground: the wheels together go along the plane they stand about, each
    alone goes where its centre goes."""
    posture = Posture(chain, joints, steering)
    radii = np.array([wheel.radius for wheel in chain.wheels])
    axle, centres = posture.axle, posture.centres
    normal = plane(centres)
    for _ in range(20):
        inward = normal - (axle @ normal)[:, None] * axle
        inward /= np.linalg.norm(inward, axis=1)[:, None]
        normal = plane(centres - radii[:, None] * inward)
    width = 6 + len(joints)
    velocity = np.zeros((len(radii), 3, width))  # of the centres
    turning = np.zeros((len(radii), 3, width))  # of their links
    velocity[:, :, :3], turning[:, :, 3:6] = np.eye(3), np.eye(3)
    for axis in range(3):
        velocity[:, :, 3 + axis] = np.cross(np.eye(3)[axis], centres)
    velocity[:, :, 6:] = posture.levers.transpose(0, 2, 1)
    turning[:, :, 6:] = posture.turns.transpose(0, 2, 1)
    along, left, swept = np.zeros((len(radii), width)), np.zeros((len(radii), width)), np.zeros(len(radii))
    slopes = before.copy()
    for k, radius in enumerate(radii):
        up = inward[k]
        tangent = np.cross(axle[k], up)
        if len(motion):
            rolled = radius * (wheel_speeds[k] + axle[k] @ turning[k] @ motion)
            length = rolled**2 / (abs(rolled) + doubt)
            kept = math.exp(-length / (MEMORY * doubt)) if doubt > 0 else 0.0
            slopes[k] = kept * slopes[k] + (1 - kept) * (up @ velocity[k] @ motion) / rolled
        slope = math.asin(slopes[k])
        turned_up = up * math.cos(slope) - tangent * math.sin(slope)
        tangent = tangent * math.cos(slope) + up * math.sin(slope)
        tilted = turned_up * (normal @ up) + axle[k] * (normal @ axle[k])
        touching = velocity[k] + np.cross(turning[k].T, -radius * turned_up).T
        along[k] = tangent @ velocity[k] / radius - axle[k] @ turning[k]
        left[k] = np.cross(tilted, tangent) @ touching
        swept[k] = np.cross(tilted, tangent) @ np.cross(posture.mounts[k], -radius * turned_up) * swivels[k]
    together = np.einsum("i,wic->c", normal, velocity)[None] / len(radii)
    return Rows(together, along, left, np.zeros(1), swept, slopes)


def solve(chain: Chain, rows: Rows, known: dict[int, float], wheel_speeds: Floats) -> Floats:
    """The motion: exact conditions first, then least squares; unsteered wheels share a row."""
    width = rows.along.shape[1]
    fixed = np.array([np.eye(width)[column] for column in known] or np.zeros((0, width)))
    exact = np.concatenate([rows.on, fixed])
    right = np.concatenate([-rows.lifted, list(known.values())])
    offset = np.linalg.lstsq(exact, right, rcond=None)[0]
    values, turned = np.linalg.svd(exact)[1:]
    space = turned[int((values > 1e-10 * values[0]).sum()) :].T
    left = rows.left.copy()
    straight = [k for k, wheel in enumerate(chain.wheels) if not wheel.steered]
    left[straight] = left[straight].mean(axis=0)
    radii = np.array([wheel.radius for wheel in chain.wheels])
    told = np.concatenate([rows.along * radii[:, None], left])
    wanted = np.concatenate([wheel_speeds * radii, -rows.swept]) - told @ offset
    motion: Floats = offset + space @ np.linalg.lstsq(told @ space, wanted, rcond=None)[0]
    return motion


def chorded(chain: Chain, angles: Floats, turned: Floats) -> tuple[Floats, Floats]:
    """Turns and steering of the wheels over a step, times ``sinc(steered / 2)``: along the chord."""
    steered, wheel_speeds = np.zeros(len(turned)), turned.copy()
    steered[chain.steered] = angles[1] - angles[0]
    chord = np.sinc(steered / math.tau)
    return wheel_speeds * chord, steered * chord


def dead_reckon(
    chain: Chain,
    steering: ArrayLike,
    wheel_angles: ArrayLike,
    *,
    joints: ArrayLike | None = None,
    attitudes: ArrayLike | None = None,
    ground: Terrain | None = None,
    start: ArrayLike = (0.0, 0.0, 0.0, 0.0),
    doubt: float = 0.0,
) -> Floats:
    """Poses ``x, y, z, roll, pitch, yaw`` at every sample.

    Either `joints` and `attitudes` (roll and pitch) tell how the rover stands, or `ground` does. `start` is
    ``x, y, z, yaw``; `doubt` is what the way of a wheel's centre across the ground may be off by [m].
    """
    angles, totals = np.asarray(steering, float), np.asarray(wheel_angles, float)
    x, y, z, yaw = np.asarray(start, float)
    if ground is None:
        assert joints is not None
        assert attitudes is not None
        bends, tilts = np.asarray(joints, float), np.asarray(attitudes, float)
        poses, slopes = [np.array([x, y, z, *tilts[0], yaw])], np.zeros(len(chain.wheels))
        for k in range(1, len(totals)):
            ends = [attitude(roll, pitch, 0.0) for roll, pitch in tilts[k - 1 : k + 1]]
            rows = slice(k - 1, k + 1)
            place, turn, slopes = _by_joints(
                chain, angles[rows], bends[rows], ends, totals[k] - totals[k - 1], slopes, doubt
            )
            last = poses[-1]
            moved = attitude(*last[3:]) @ place
            poses.append(np.array([*(last[:3] + moved), *tilts[k], last[5] + turn]))
        return np.array(poses)
    poses = []
    for k in range(len(totals)):
        if k > 0:
            x, y, yaw = _by_ground(chain, ground, poses[-1], angles[k - 1 : k + 1], totals[k] - totals[k - 1])
        stand = settle(ground, chain, (x, y, yaw), angles[k])
        poses.append(np.array([x, y, stand.z, stand.roll, stand.pitch, yaw]))
    return np.array(poses)


def _by_joints(
    chain: Chain,
    angles: Floats,
    joints: Floats,
    ends: list[Floats],
    turned: Floats,
    slopes: Floats,
    doubt: float,
) -> tuple[Floats, float, Floats]:
    """Way in the body, change of yaw and slopes: the body turns about its own z as the wheels say."""
    wheel_speeds, swivels = chorded(chain, angles, turned)
    yaw, motion = 0.0, np.zeros(0)

    def turn(yaw: float) -> Floats:
        return rotation_vector(ends[0].T @ attitude(0, 0, yaw) @ ends[1])

    middle = joints.mean(axis=0), angles.mean(axis=0)
    for _ in range(ROUNDS):
        about = turn(yaw)
        rows = unmapped(chain, *middle, swivels, wheel_speeds, motion, slopes, doubt)
        bent = dict(enumerate(joints[1] - joints[0], start=6))
        motion = solve(chain, rows, {3: about[0], 4: about[1], **bent}, wheel_speeds)
        yaw += (motion[5] - about[2]) / ends[1][2, 2]
    return screw(np.concatenate([motion[:3], turn(yaw)]))[0], yaw, rows.slopes


def _by_ground(chain: Chain, ground: Terrain, pose: Floats, angles: Floats, turned: Floats) -> Floats:
    """End of a step in plan by the midpoint rule: half the motion of the start leads to the middle."""
    wheel_speeds, swivels = chorded(chain, angles, turned)

    def motion(plan: ArrayLike, steering: Floats) -> Floats:
        stand = settle(ground, chain, plan, steering)
        contacts = touch(chain, stand)
        lifted, swept = contacts.steered.T * swivels
        rows = Rows(contacts.normal, contacts.along, contacts.left, lifted, swept, np.zeros(0))
        return solve(chain, rows, {}, wheel_speeds)[:6]

    def after(tangent: Floats) -> Floats:
        way, turn = screw(tangent)
        start = attitude(*pose[3:])
        place, facing = pose[:3] + start @ way, start @ turn
        yaw = math.atan2(facing[1, 0], facing[0, 0])
        return np.array([*place[:2], pose[5] + math.remainder(yaw - pose[5], math.tau)])

    start = motion((pose[0], pose[1], pose[5]), angles[0])
    return after(motion(after(start / 2), angles.mean(axis=0)))
