"""Plain Python: `math`, tuples and lists, one twist at a time."""

import math


class Plain:
    """A rover of steered and fixed wheels, all of one radius.

    Parameters
    ----------
    wheels : sequence of (x, y, steered)
        The fixed ones point straight ahead.
    radius : float
    """

    def __init__(self, wheels, radius):
        self.wheels, self.radius = wheels, radius
        # The two rows of a wheel are a rotation: they add up to the same 3 x 3 matrix at any steering angle.
        n, sx, sy = len(wheels), sum(w[0] for w in wheels), sum(w[1] for w in wheels)
        spread = sum(x * x + y * y for x, y, _ in wheels) - (sx * sx + sy * sy) / n
        self.sums = n, sx, sy, spread
        self.pose, self.angles = (0.0, 0.0, 0.0), [0.0] * n

    def inverse(self, twist):
        vx, vy, omega = twist
        steering, speeds = [], []
        for x, y, steered in self.wheels:
            ux, uy = vx - omega * y, vy + omega * x
            if not steered:
                speeds.append(ux / self.radius)
            elif ux == 0.0 and uy == 0.0:
                steering.append(0.0)
                speeds.append(0.0)
            else:
                steering.append(math.atan2(uy, ux) if ux >= 0.0 else math.atan2(-uy, -ux))
                speeds.append(math.copysign(math.hypot(ux, uy), ux) / self.radius)
        return steering, speeds

    def forward(self, steering, speeds):
        bx = by = turn = 0.0
        angles = iter(steering)
        for (x, y, steered), speed in zip(self.wheels, speeds, strict=True):
            angle = next(angles) if steered else 0.0
            ux, uy = self.radius * speed * math.cos(angle), self.radius * speed * math.sin(angle)
            bx, by, turn = bx + ux, by + uy, turn + x * uy - y * ux
        n, sx, sy, spread = self.sums
        omega = (turn - (sx * by - sy * bx) / n) / spread
        return (bx + sy * omega) / n, (by - sx * omega) / n, omega

    def update(self, steering, angles):
        steps = [new - old for new, old in zip(angles, self.angles, strict=True)]
        vx, vy, omega = self.forward(steering, steps)
        x, y, yaw = self.pose
        half = omega / 2.0
        chord = math.sin(half) / half if abs(half) > 1e-8 else 1.0
        c, s = math.cos(yaw + half) * chord, math.sin(yaw + half) * chord
        self.pose = x + c * vx - s * vy, y + s * vx + c * vy, yaw + omega
        self.angles = angles
        return self.pose
