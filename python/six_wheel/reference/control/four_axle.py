"""Four axles on lockable pivots in plain NumPy, to be read beside section 6 of the models: slow and plain.

It shares no code with the core. Axles come in the order front left, front right, rear left, rear right.
"""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import numpy as np
from numpy.typing import ArrayLike

from six_wheel.reference.planar.geometry import Floats

SIDES = np.array((1.0, -1.0, 1.0, -1.0))  # left of the pivot, right of it


def pivot_points(h_x: float, h_y: float) -> Floats:
    """Hinges in the body [m], shape (4, 2)."""
    return np.array(((h_x, h_y), (h_x, -h_y), (-h_x, h_y), (-h_x, -h_y)))


def headings(angles: ArrayLike) -> tuple[Floats, Floats]:
    """e along each wheel and n to its left, shape (4, 2) each."""
    phi = np.asarray(angles, dtype=np.float64)
    e = np.stack((np.cos(phi), np.sin(phi)), axis=-1)
    return e, np.stack((-e[:, 1], e[:, 0]), axis=-1)


def pivot_velocities(pivots: Floats, twist: ArrayLike) -> Floats:
    """u = (vx - omega y, vy + omega x), shape (4, 2) [m/s]."""
    vx, vy, omega = np.asarray(twist, dtype=np.float64)
    return np.stack((vx - omega * pivots[:, 1], vy + omega * pivots[:, 0]), axis=-1)


def wheel_ends(pivots: Floats, axle_length: float, pose: ArrayLike, angles: ArrayLike) -> Floats:
    """Places of the wheels in the world [m], shape (4, 2)."""
    x, y, yaw = np.asarray(pose, dtype=np.float64)
    _, n = headings(angles)
    in_body = pivots + axle_length * SIDES[:, None] * n
    turn = np.array(((np.cos(yaw), -np.sin(yaw)), (np.sin(yaw), np.cos(yaw))))
    ends: Floats = in_body @ turn.T + (x, y)
    return ends


def wheel_end_velocities(
    pivots: Floats, axle_length: float, twist: ArrayLike, angles: ArrayLike, rates: ArrayLike
) -> Floats:
    """c = u - scrub (omega + phi_dot) e, scrub = +-L, in body axes, shape (4, 2) [m/s]."""
    e, _ = headings(angles)
    turning = np.asarray(twist, dtype=np.float64)[2] + np.asarray(rates, dtype=np.float64)
    ends: Floats = pivot_velocities(pivots, twist) - (axle_length * SIDES * turning)[:, None] * e
    return ends


def side_slip_rows(pivots: Floats, angles: ArrayLike) -> Floats:
    """n . u = 0 as rows for (vx, vy, omega), shape (4, 3)."""
    _, n = headings(angles)
    return np.column_stack((n, pivots[:, 0] * n[:, 1] - pivots[:, 1] * n[:, 0]))


def concurrent_angles(pivots: Floats, icr: ArrayLike) -> Floats:
    """Headings square to the way from each pivot to the point, folded into a quarter turn to either side."""
    dx, dy = (np.asarray(icr, dtype=np.float64) - pivots).T
    heading = np.arctan2(-dx, dy)
    folded: Floats = heading - np.pi * np.round(heading / np.pi)
    return folded


def forward(
    pivots: Floats, axle_length: float, angles: ArrayLike, rim_speeds: ArrayLike, free: ArrayLike
) -> tuple[Floats, Floats, Floats]:
    """Twist, pivot rates and slip per wheel, from driven wheels; `free` says which axles turn."""
    e, _ = headings(angles)
    loose = np.flatnonzero(np.asarray(free))
    rows = np.zeros((8, 3 + len(loose)))
    rows[:4, :3] = side_slip_rows(pivots, angles)
    scrub = axle_length * SIDES
    rows[4:, :3] = np.column_stack((e, pivots[:, 0] * e[:, 1] - pivots[:, 1] * e[:, 0] - scrub))
    rows[4 + loose, 3 + np.arange(len(loose))] = -scrub[loose]
    wanted = np.concatenate((np.zeros(4), np.asarray(rim_speeds, dtype=np.float64)))
    found = np.asarray(np.linalg.lstsq(rows, wanted, rcond=None)[0], dtype=np.float64)
    rates = np.zeros(4)
    rates[loose] = found[3:]
    missed = rows @ found - wanted
    slip: Floats = np.hypot(missed[:4], missed[4:])
    return found[:3], rates, slip


def tandem(
    h_x: float, front: float, rear: float, speed: float, turning: float, time: float
) -> tuple[float, Floats]:
    """Dual differential drive with the front axle locked and following, the rear one free and driven.

    The rear wheels have constant speeds, so the middle of the rear axle drives at `speed` along an arc in the
    world while its heading turns at the rate `turning`. The front axle must not slip sideways, hence with
    psi = rear - front

        psi' = turning + k sin psi,   k = speed / (2 h_x cos front)

    and tan(psi / 2) is a quotient of two solutions of a linear equation. Returns the rear angle in the body
    and the pose [x, y, yaw] of the body, which starts at the origin.
    """
    k = speed / (2 * h_x * np.cos(front))
    matrix = np.array(((k, turning), (-turning, -k))) / 2
    half = (rear - front) / 2
    root = np.sqrt(complex(k * k - turning * turning)) / 2
    # exp(matrix t) = cosh(root t) + matrix sinh(root t) / root, as matrix^2 = root^2.
    ratio = time if root == 0 else (np.sinh(root * time) / root).real
    p, q = (np.cosh(root * time).real * np.eye(2) + matrix * ratio) @ (np.sin(half), np.cos(half))
    angle = float(front + 2 * np.arctan2(p, q))
    heading = rear + turning * time  # of the rear axle in the world
    yaw = heading - angle
    chord = speed * time * np.sinc(turning * time / (2 * np.pi))
    middle = np.array((-h_x, 0.0)) + chord * np.array(
        (np.cos(rear + turning * time / 2), np.sin(rear + turning * time / 2))
    )
    x, y = middle + h_x * np.array((np.cos(yaw), np.sin(yaw)))
    return angle, np.array((x, y, yaw))


def rear_steering(
    h_x: float,
    h_y: float,
    axle_length: float,
    rim_speeds: tuple[float, float],
    time: float,
    steps: int = 2000,
) -> tuple[Floats, Floats]:
    """Hinged axles, the front ones locked straight ahead and following, the rear ones free and driven.

    From straight ahead at the origin. The centre of rotation stays abreast of the front pivots at 1 / kappa;
    the rear pivots move at (1 -+ h_y kappa, -2 h_x kappa) v, and the axles follow. Both rolling rows are
    solved for v and kappa', and summed up by Runge-Kutta's rule. Returns rear angles (left, right), pose.
    """
    sides = np.array((1.0, -1.0))

    def rear(kappa: float) -> tuple[Floats, Floats, Floats]:
        along, across = 1 - sides * h_y * kappa, np.full(2, -2 * h_x * kappa)
        square = along**2 + across**2
        slope = (-2 * h_x * along + across * sides * h_y) / square
        return np.arctan2(across, along), np.sqrt(square), slope

    def rates(state: Floats) -> Floats:
        kappa, _, _, yaw = state
        _, length, slope = rear(kappa)
        scrub = axle_length * sides
        rows = np.column_stack((length - scrub * kappa, -scrub * slope))
        v, kappa_rate = np.linalg.solve(rows, rim_speeds)
        side = -h_x * kappa * v  # of the body's origin
        return np.array((
            kappa_rate,
            v * np.cos(yaw) - side * np.sin(yaw),
            v * np.sin(yaw) + side * np.cos(yaw),
            kappa * v,
        ))  # fmt: skip

    state, dt = np.zeros(4), time / steps
    for _ in range(steps):
        k1 = rates(state)
        k2 = rates(state + dt / 2 * k1)
        k3 = rates(state + dt / 2 * k2)
        k4 = rates(state + dt * k3)
        state = state + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    angles, *_ = rear(state[0])
    return angles, state[1:]
