"""The rocker-bogie chain in plain NumPy, to be read beside the design notes.

Nothing here is shared with the compiled core. The frames are products of the four elementary transforms of
every row of the Denavit-Hartenberg table, the steering angles the formulas printed with it. Symbols are
those of M. Tarokh, G. McDermott, S. Hayati, J. Hung, Kinematic modeling of a high mobility Mars rover,
ICRA 1999, with misprints corrected.
"""

import math
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass
from typing import NamedTuple, Self, TypeAlias

import numpy as np

from six_wheel.reference.planar.geometry import Floats

Row: TypeAlias = tuple[str, str, float, float, float, float]


def rot_x(angle: float) -> Floats:
    """Turn about x [rad], as a (4, 4) matrix."""
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0, 0], [0, cos, -sin, 0], [0, sin, cos, 0], [0, 0, 0, 1]], dtype=float)


def rot_z(angle: float) -> Floats:
    """Turn about z [rad], as a (4, 4) matrix."""
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin, 0, 0], [sin, cos, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], dtype=float)


def trans(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Floats:
    """Shift [m], as a (4, 4) matrix."""
    return np.array([[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]], dtype=float)


class Steer(NamedTuple):
    """Steering angles [rad], speeds of all wheels [rad/s], side slip of the unsteered ones [m/s]."""

    psi: Floats
    wheel_speeds: Floats
    scrub: Floats


@dataclass(frozen=True)
class RockerBogie:
    """The dimensions of the table [m, rad].

    `k3` is the half track of the front wheels, `k3b` what the middle and the rear wheels have more; `k7` is
    the way from the bogie joint forward to the middle wheel and back to the rear one.
    """

    k1: float
    k2: float
    k3: float
    k4: float
    k5: float
    k6: float
    k7: tuple[float, float]
    k8: float
    k9: float
    k10: float
    _: KW_ONLY
    k3b: tuple[float, float] = (0.0, 0.0)
    corners: bool = False  # the rear wheels steer too

    @classmethod
    def rocky7(cls) -> Self:
        """Two steered wheels in front, a bogie pair behind."""
        nine = math.radians(139)
        return cls(0.105, 0.12075, 0.20, 0.288, 0.125, 0.16, (0.069, 0.069), 0.02, nine, 0.065)

    @property
    def steered(self) -> tuple[int, ...]:
        """Numbers of the steered wheels, 1 to 6."""
        return (1, 2, 5, 6) if self.corners else (1, 2)

    def table(self, rho: float, beta: Sequence[float], psi: Sequence[float]) -> list[Row]:
        """Frame, parent, gamma, d, a, alpha of every row."""
        k1, k2, k3, k4, k5, k6 = self.k1, self.k2, self.k3, self.k4, self.k5, self.k6
        (k7, k7_rear), k8, k9 = self.k7, self.k8, self.k9
        k3b, k3b_rear = self.k3b
        more = k3b_rear - k3b  # half track of the rear wheels less that of the middle ones
        turn = dict(zip(self.steered, psi, strict=True))
        quarter = math.pi / 2
        return [
            ("D", "R", 0, k1, k2, -quarter),
            ("B1", "D", k9 + rho, k3 + k3b, k6, 0),
            ("B2", "D", k9 - rho, -(k3 + k3b), k6, 0),
            ("S1", "D", rho, k3, k4, quarter),
            ("S2", "D", -rho, -k3, k4, quarter),
            ("S3", "B1", beta[0] - k9, 0, k7, quarter),
            ("S4", "B2", beta[1] - k9, 0, k7, quarter),
            ("S5", "B1", beta[0] - k9, more, -k7_rear, quarter),
            ("S6", "B2", beta[1] - k9, -more, -k7_rear, quarter),
            ("A1", "S1", turn[1], -k5, 0, 0),
            ("A2", "S2", turn[2], -k5, 0, 0),
            ("A3", "S3", 0, -k8, 0, 0),
            ("A4", "S4", 0, -k8, 0, 0),
            ("A5", "S5", turn.get(5, 0.0), -k8, 0, 0),
            ("A6", "S6", turn.get(6, 0.0), -k8, 0, 0),
        ]

    def frames(
        self, rho: float, beta: Sequence[float], psi: Sequence[float] | None = None
    ) -> dict[str, Floats]:
        """Transforms (4, 4) by name that take coordinates of the frame to those of R."""
        frames = {"R": np.eye(4)}
        for name, parent, gamma, d, a, alpha in self.table(rho, beta, psi or [0.0] * len(self.steered)):
            frames[name] = frames[parent] @ rot_z(gamma) @ trans(z=d) @ trans(x=a) @ rot_x(alpha)
        return frames

    def wheels(self, rho: float, beta: Sequence[float]) -> Floats:
        """Centres of the six wheels in R, shape (6, 3) [m]."""
        frames = self.frames(rho, beta)
        return np.array([frames[f"A{i}"][:3, 3] for i in range(1, 7)])

    def icr_offset(self, rho: float, beta: Sequence[float]) -> float:
        """x_R [m]: the unsteered wheels scrub least turning about a point of x = -x_R."""
        x = self.wheels(rho, beta)[:, 0]
        return -float(np.mean([x[i - 1] for i in range(1, 7) if i not in self.steered]))

    def steer(self, speed: float, yaw_rate: float, rho: float, beta: Sequence[float]) -> Steer:
        """The formulas of the paper, corrected: every steered wheel has its own x and its own half track."""
        x_R = self.icr_offset(rho, beta)
        psi, wheel_speeds, scrub = [], [], []
        for i, (x, y, _) in enumerate(self.wheels(rho, beta), start=1):
            forward, sideways = speed - yaw_rate * y, yaw_rate * (x + x_R)
            if i in self.steered:
                # Within a quarter turn: a wheel that would point backwards rolls backwards instead.
                sign = -1.0 if forward < 0 else 1.0
                psi.append(math.atan2(sign * sideways, sign * forward))
                wheel_speeds.append(sign * math.hypot(forward, sideways) / self.k10)
            else:
                wheel_speeds.append(forward / self.k10)
                scrub.append(sideways)
        return Steer(np.array(psi), np.array(wheel_speeds), np.array(scrub))
