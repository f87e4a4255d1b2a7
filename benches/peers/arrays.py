"""NumPy: as one writes it down, and tuned (blocks that stay in the cache, results into given arrays)."""

import numpy as np

BLOCK = 2048  # rows of which all columns fit into the second-level cache


class Arrays:
    """A rover of steered and fixed wheels, all of one radius; `wheels` as in `Plain`."""

    def __init__(self, wheels, radius):
        self.xy = np.array([wheel[:2] for wheel in wheels])
        self.steered = np.array([wheel[2] for wheel in wheels])
        self.radius = radius
        x, y = self.xy.T
        one, zero = np.ones_like(x), np.zeros_like(x)
        rows = np.stack([np.stack([one, zero, -y], 1), np.stack([zero, one, x], 1)])  # (2, wheels, 3)
        normal = np.einsum("awi,awj->ij", rows, rows)
        self.solve = np.linalg.solve(normal, rows.reshape(-1, 3).T).reshape(3, 2, -1)
        self.pose, self.angles = np.zeros(3), np.zeros(len(wheels))

    def inverse(self, twists):
        vx, vy, omega = np.moveaxis(np.asarray(twists), -1, 0)[..., None]
        x, y = self.xy.T
        ux, uy = vx - omega * y, vy + omega * x
        backwards = np.where(ux < 0, -1.0, 1.0)
        angles = np.arctan2(uy * backwards, ux * backwards)
        speeds = np.where(self.steered, np.hypot(ux, uy) * backwards, ux) / self.radius
        return angles[..., self.steered], speeds

    def forward(self, steering, speeds):
        angles = np.zeros_like(speeds)
        angles[..., self.steered] = steering
        rim = self.radius * np.asarray(speeds)
        ux, uy = rim * np.cos(angles), rim * np.sin(angles)
        return ux @ self.solve[:, 0].T + uy @ self.solve[:, 1].T

    def update(self, steering, angles):
        self.pose = integrate(self.forward(steering, angles - self.angles)[None], 1.0, self.pose)[1]
        self.angles = angles
        return self.pose


def integrate(twists, dt, start=(0.0, 0.0, 0.0)):
    """Poses (n + 1, 3), each step an exact arc."""
    turns = twists[:, 2] * dt
    yaw = start[2] + np.concatenate([[0.0], np.cumsum(turns)])
    chord = np.sinc(turns / (2 * np.pi)) * dt
    middle = yaw[:-1] + turns / 2
    c, s = np.cos(middle) * chord, np.sin(middle) * chord
    dx = c * twists[:, 0] - s * twists[:, 1]
    dy = s * twists[:, 0] + c * twists[:, 1]
    x, y = (at + np.concatenate([[0.0], np.cumsum(d)]) for at, d in ((start[0], dx), (start[1], dy)))
    return np.stack([x, y, yaw], axis=1)


def rollout(controls, dt):
    """Poses (k, t + 1, 3) from the origin."""
    turns = controls[..., 2] * dt
    yaw = np.cumsum(turns, axis=1)
    chord = np.sinc(turns / (2 * np.pi)) * dt
    middle = yaw - turns / 2
    c, s = np.cos(middle) * chord, np.sin(middle) * chord
    poses = np.zeros((len(controls), controls.shape[1] + 1, 3))
    poses[:, 1:, 0] = np.cumsum(c * controls[..., 0] - s * controls[..., 1], axis=1)
    poses[:, 1:, 1] = np.cumsum(s * controls[..., 0] + c * controls[..., 1], axis=1)
    poses[:, 1:, 2] = yaw
    return poses


class Tuned(Arrays):
    """The same without temporaries of the whole batch: columns of a block, every operation in place."""

    def __init__(self, wheels, radius):
        super().__init__(wheels, radius)
        self._vx, self._vy, self._omega, self._ux, self._uy, self._a, self._b = np.empty((7, BLOCK))

    def inverse(self, twists, out):
        steering, speeds = out
        inverse_radius = 1 / self.radius
        for begin in range(0, len(twists), BLOCK):
            rows = twists[begin : begin + BLOCK]
            n = len(rows)
            vx, vy, omega = self._vx[:n], self._vy[:n], self._omega[:n]
            ux, uy, a, b = self._ux[:n], self._uy[:n], self._a[:n], self._b[:n]
            vx[:], vy[:], omega[:] = rows.T
            joint = 0
            for wheel, ((x, y), steered) in enumerate(zip(self.xy, self.steered, strict=True)):
                np.multiply(omega, -y, out=ux)
                ux += vx
                if steered:
                    np.multiply(omega, x, out=uy)
                    uy += vy
                    np.divide(uy, ux, out=a)
                    steering[begin : begin + n, joint] = np.arctan(a, out=a)
                    joint += 1
                    np.multiply(ux, ux, out=a)
                    np.multiply(uy, uy, out=b)
                    a += b
                    np.sqrt(a, out=a)
                    ux = np.copysign(a, ux, out=ux)
                np.multiply(ux, inverse_radius, out=speeds[begin : begin + n, wheel])
        return out

    def forward(self, steering, speeds, out):
        for begin in range(0, len(out), BLOCK):
            n = len(out[begin : begin + BLOCK])
            sums = self._vx[:n], self._vy[:n], self._omega[:n]
            for each in sums:
                each[:] = 0
            ux, uy, a, angle = self._ux[:n], self._uy[:n], self._a[:n], self._b[:n]
            joint = 0
            for wheel, steered in enumerate(self.steered):
                np.multiply(speeds[begin : begin + n, wheel], self.radius, out=ux)
                if steered:
                    angle[:] = steering[begin : begin + n, joint]  # sine and cosine are slow on strides
                    joint += 1
                    np.sin(angle, out=a)
                    np.multiply(ux, a, out=uy)
                    np.cos(angle, out=a)
                    ux *= a
                for row, each in enumerate(sums):
                    each += np.multiply(ux, self.solve[row, 0, wheel], out=a)
                    if steered:
                        each += np.multiply(uy, self.solve[row, 1, wheel], out=a)
            for row, each in enumerate(sums):
                out[begin : begin + n, row] = each
        return out
