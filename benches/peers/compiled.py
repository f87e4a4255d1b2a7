"""numba: loops as one writes them, and what an expert makes of them: blocks, columns, own polynomials."""

import math

import numba
import numpy as np

BLOCK = 256  # rows taken apart into columns at a time
jit = numba.njit(cache=False, error_model="numpy")
fast = numba.njit(cache=False, error_model="numpy", fastmath={"contract", "arcp", "nsz", "nnan", "ninf"})


def _fit(function, end, degree):
    """A polynomial in s on [0, end], lowest power first, by interpolation at the Chebyshev points."""
    series = np.polynomial.Chebyshev.interpolate(function, degree, domain=[0.0, end])
    return tuple(series.convert(kind=np.polynomial.Polynomial).coef)


TAN_EIGHTH = math.sqrt(2.0) - 1.0
ATAN = _fit(lambda s: np.arctan(np.sqrt(s)) / np.sqrt(s), TAN_EIGHTH**2 * 1.0001, 10)
SIN = _fit(lambda s: np.sin(np.sqrt(s)) / np.sqrt(s), (math.pi / 4) ** 2 * 1.01, 6)
COS = _fit(lambda s: np.cos(np.sqrt(s)), (math.pi / 4) ** 2 * 1.01, 7)
HALF_PI = math.pi / 2, 6.123233995736766e-17  # the second is what the first lacks


@fast
def _polynomial(coefficients, s):
    value = coefficients[len(coefficients) - 1]
    for k in range(len(coefficients) - 2, -1, -1):
        value = value * s + coefficients[k]
    return value


@fast
def _sincos(angle):
    quarter = np.floor(angle * (2 / math.pi) + 0.5)
    t = (angle - quarter * HALF_PI[0]) - quarter * HALF_PI[1]
    s, c = t * _polynomial(SIN, t * t), _polynomial(COS, t * t)
    odd = quarter - 2 * np.floor(quarter / 2)
    turn = quarter - 4 * np.floor(quarter / 4)
    swapped_s, swapped_c = (c, s) if odd > 0.5 else (s, c)
    sign_s = -1.0 if turn > 1.5 else 1.0
    sign_c = -1.0 if (turn > 0.5) and (turn < 2.5) else 1.0
    return sign_s * swapped_s, sign_c * swapped_c


@fast
def _steer(vx, vy, omega, x, y, inverse_radius, angle, rate, m):
    """A column of a steered wheel: on its own, so that the compiler sees one simple loop."""
    for k in range(m):
        ux, uy = vx[k] - omega[k] * y, vy[k] + omega[k] * x
        a, b = abs(uy), abs(ux)
        low, high = (a, b) if a < b else (b, a)
        far = low > TAN_EIGHTH * high
        top = low - high if far else low
        bottom = low + high if far else high
        t = top / (bottom + 1e-300)
        arc = t * _polynomial(ATAN, t * t) + (math.pi / 4 if far else 0.0)
        arc = math.pi / 2 - arc if a > b else arc
        angle[k] = math.copysign(arc, ux) * math.copysign(1.0, uy)
        rate[k] = math.copysign(math.sqrt(ux * ux + uy * uy), ux) * inverse_radius


@fast
def _read(angle, rate, x, y, radius, bx, by, turn, m):
    """Contribution of a column of a steered wheel to the sums."""
    for k in range(m):
        s, c = _sincos(angle[k])
        rim = radius * rate[k]
        ux, uy = rim * c, rim * s
        bx[k] += ux
        by[k] += uy
        turn[k] += x * uy - y * ux


def build(wheels, radius):
    """Functions for one rover, its dimensions constants of the compiled code."""
    count, steered = len(wheels), tuple(bool(wheel[2]) for wheel in wheels)
    xs, ys = tuple(float(w[0]) for w in wheels), tuple(float(w[1]) for w in wheels)
    n, sx, sy = float(count), sum(xs), sum(ys)
    spread = sum(x * x + y * y for x, y in zip(xs, ys, strict=True)) - (sx * sx + sy * sy) / n
    joints = tuple(int(k) for k in np.cumsum((0, *steered[:-1])))

    @jit
    def inverse(vx, vy, omega, steering, speeds):
        joint = 0
        for wheel in range(count):
            ux, uy = vx - omega * ys[wheel], vy + omega * xs[wheel]
            if steered[wheel]:
                sign = -1.0 if ux < 0.0 else 1.0
                steering[joint] = math.atan2(sign * uy, sign * ux)
                speeds[wheel] = sign * math.sqrt(ux * ux + uy * uy) / radius
                joint += 1
            else:
                speeds[wheel] = ux / radius

    @jit
    def inverse_fresh(vx, vy, omega):
        steering, speeds = np.empty(sum(steered)), np.empty(count)
        inverse(vx, vy, omega, steering, speeds)
        return steering, speeds

    @jit
    def forward(steering, speeds):
        bx = by = turn = 0.0
        joint = 0
        for wheel in range(count):
            ux, uy = radius * speeds[wheel], 0.0
            if steered[wheel]:
                ux, uy = ux * math.cos(steering[joint]), ux * math.sin(steering[joint])
                joint += 1
            bx, by, turn = bx + ux, by + uy, turn + xs[wheel] * uy - ys[wheel] * ux
        omega = (turn - (sx * by - sy * bx) / n) / spread
        return (bx + sy * omega) / n, (by - sx * omega) / n, omega

    @jit
    def update(state, last, steering, angles):
        bx = by = turn = 0.0
        joint = 0
        for wheel in range(count):
            ux, uy = radius * (angles[wheel] - last[wheel]), 0.0
            last[wheel] = angles[wheel]
            if steered[wheel]:
                ux, uy = ux * math.cos(steering[joint]), ux * math.sin(steering[joint])
                joint += 1
            bx, by, turn = bx + ux, by + uy, turn + xs[wheel] * uy - ys[wheel] * ux
        omega = (turn - (sx * by - sy * bx) / n) / spread
        _step(state, (bx + sy * omega) / n, (by - sx * omega) / n, omega)

    @jit
    def inverse_batch(twists, steering, speeds):
        for k in range(len(twists)):
            inverse(twists[k, 0], twists[k, 1], twists[k, 2], steering[k], speeds[k])

    @jit
    def forward_batch(steering, speeds, out):
        for k in range(len(out)):
            out[k, 0], out[k, 1], out[k, 2] = forward(steering[k], speeds[k])

    @fast
    def inverse_blocked(twists, steering, speeds):
        vx, vy, omega = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
        angles, rates = np.empty((count, BLOCK)), np.empty((count, BLOCK))
        inverse_radius = 1.0 / radius
        for begin in range(0, len(twists), BLOCK):
            m = min(BLOCK, len(twists) - begin)
            for k in range(m):
                vx[k], vy[k], omega[k] = twists[begin + k, 0], twists[begin + k, 1], twists[begin + k, 2]
            for wheel in range(count):
                x, y = xs[wheel], ys[wheel]
                if steered[wheel]:
                    _steer(vx, vy, omega, x, y, inverse_radius, angles[joints[wheel]], rates[wheel], m)
                else:
                    rate = rates[wheel]
                    for k in range(m):
                        rate[k] = (vx[k] - omega[k] * y) * inverse_radius
            for k in range(m):
                for joint in range(steering.shape[1]):
                    steering[begin + k, joint] = angles[joint, k]
                for wheel in range(count):
                    speeds[begin + k, wheel] = rates[wheel, k]

    @fast
    def forward_blocked(steering, speeds, out):
        angles, rates = np.empty((count, BLOCK)), np.empty((count, BLOCK))
        bx, by, turn = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
        for begin in range(0, len(out), BLOCK):
            m = min(BLOCK, len(out) - begin)
            for k in range(m):
                bx[k] = by[k] = turn[k] = 0.0
                for joint in range(steering.shape[1]):
                    angles[joint, k] = steering[begin + k, joint]
                for wheel in range(count):
                    rates[wheel, k] = speeds[begin + k, wheel]
            for wheel in range(count):
                x, y = xs[wheel], ys[wheel]
                if steered[wheel]:
                    _read(angles[joints[wheel]], rates[wheel], x, y, radius, bx, by, turn, m)
                else:
                    for k in range(m):
                        ux = radius * rates[wheel, k]
                        bx[k] += ux
                        turn[k] -= y * ux
            for k in range(m):
                omega = (turn[k] - (sx * by[k] - sy * bx[k]) / n) / spread
                out[begin + k, 0] = (bx[k] + sy * omega) / n
                out[begin + k, 1] = (by[k] - sx * omega) / n
                out[begin + k, 2] = omega

    return {
        "inverse": inverse,
        "inverse_fresh": inverse_fresh,
        "forward": forward,
        "update": update,
        "inverse_batch": inverse_batch,
        "forward_batch": forward_batch,
        "inverse_blocked": inverse_blocked,
        "forward_blocked": forward_blocked,
    }


@jit
def _step(state, vx, vy, turn):
    """Move a pose along an arc."""
    half = turn / 2.0
    chord = math.sin(half) / half if abs(half) > 1e-8 else 1.0
    c, s = math.cos(state[2] + half) * chord, math.sin(state[2] + half) * chord
    state[0] += c * vx - s * vy
    state[1] += s * vx + c * vy
    state[2] += turn


@jit
def integrate(twists, dt, out):
    """Poses (n + 1, 3) from the origin."""
    state = np.zeros(3)
    out[0] = state
    for k in range(len(twists)):
        _step(state, twists[k, 0] * dt, twists[k, 1] * dt, twists[k, 2] * dt)
        out[k + 1, 0], out[k + 1, 1], out[k + 1, 2] = state[0], state[1], state[2]


@jit
def rollout(controls, dt, out):
    """Poses (k, t + 1, 3) from the origin."""
    for k in range(len(controls)):
        integrate(controls[k], dt, out[k])


@fast
def _steps(vx, vy, omega, yaw, dt, dx, dy, m):
    """Displacements of m arcs, each in world axes, from the headings at their beginnings."""
    for k in range(m):
        half = omega[k] * dt / 2.0
        t = half * half
        # sin(h) / h is even and smooth: its own polynomial, where the arc is shorter than a quarter turn.
        chord = _polynomial(SIN, t) * dt
        s, c = _sincos(yaw[k] + half)
        dx[k] = chord * (c * vx[k] - s * vy[k])
        dy[k] = chord * (s * vx[k] + c * vy[k])


@fast
def integrate_blocked(twists, dt, out):
    """As `integrate`, for arcs of less than a quarter turn."""
    vx, vy, omega, yaw = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    dx, dy = np.empty(BLOCK), np.empty(BLOCK)
    x = y = heading = 0.0
    out[0, 0] = out[0, 1] = out[0, 2] = 0.0
    for begin in range(0, len(twists), BLOCK):
        m = min(BLOCK, len(twists) - begin)
        for k in range(m):
            vx[k], vy[k], omega[k] = twists[begin + k, 0], twists[begin + k, 1], twists[begin + k, 2]
            yaw[k] = heading
            heading += omega[k] * dt
        _steps(vx, vy, omega, yaw, dt, dx, dy, m)
        for k in range(m):
            x += dx[k]
            y += dy[k]
            out[begin + k + 1, 0], out[begin + k + 1, 1] = x, y
            out[begin + k + 1, 2] = yaw[k + 1] if k + 1 < m else heading


@fast
def rollout_blocked(controls, dt, out):
    """As `rollout`, with all trajectories of a block in step."""
    vx, vy, omega, yaw = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    x, y, dx, dy = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK)
    for begin in range(0, len(controls), BLOCK):
        m = min(BLOCK, len(controls) - begin)
        for k in range(m):
            x[k] = y[k] = yaw[k] = 0.0
            out[begin + k, 0, 0] = out[begin + k, 0, 1] = out[begin + k, 0, 2] = 0.0
        for t in range(controls.shape[1]):
            for k in range(m):
                vx[k], vy[k] = controls[begin + k, t, 0], controls[begin + k, t, 1]
                omega[k] = controls[begin + k, t, 2]
            _steps(vx, vy, omega, yaw, dt, dx, dy, m)
            for k in range(m):
                x[k] += dx[k]
                y[k] += dy[k]
                yaw[k] += omega[k] * dt
                out[begin + k, t + 1, 0], out[begin + k, t + 1, 1] = x[k], y[k]
                out[begin + k, t + 1, 2] = yaw[k]
