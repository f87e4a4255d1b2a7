"""Ends of the windows of a drive by dead reckoning, and their derivatives by every parameter.

The derivatives of the twist come from the core (`Rover.sensitivity`); here they are carried along the drive
by the chain rule, all rows at once.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from six_wheel._core import Rover, integrate, wrap_angle
from six_wheel.calibration.drives import Drive
from six_wheel.kinematics.poses import Floats, between, inverse, joined
from six_wheel.logs import WheelLog
from six_wheel.robot_description.dimensions import (
    FRAME,
    PLACE,
    WHEEL_QUANTITIES,
    Parameter,
    apart,
    mounts,
    moves,
    prior,
    size,
)
from six_wheel.robot_description.wheels_of_rover import with_wheels

# Below this half-turn per step the derivative of sin(x)/x is its series, good to 1e-16 there.
SMALL_TURN = 1e-2
# Share of what a mount does that no parameter does, below which they do the same.
ALIKE = 1e-3
PLACES = [f"{kind}_{axis}" for kind in ("sensor", "origin") for axis in FRAME]


class Model:
    """Parameters of a rover, and the errors of its dead reckoning as a function of their values."""

    def __init__(
        self, nominal: Rover, parameters: Sequence[Parameter], mounts: Sequence[Parameter] = ()
    ) -> None:
        """`mounts` are fitted beside the parameters, for what belongs to sessions, and thrown away."""
        self.nominal = nominal
        self.own = len(parameters)
        self.parameters = (*parameters, *mounts)
        self.names = tuple(parameter.name for parameter in self.parameters)
        self.start = np.array([parameter.value for parameter in self.parameters])
        self.plausible = np.array([parameter.plausible for parameter in self.parameters])
        # Takes independent changes of deviation 1 to those that are plausible, in units of these; and back.
        self.likely = np.asarray(np.linalg.cholesky(prior(self.parameters)), dtype=np.float64)
        self.surprise = np.asarray(np.linalg.inv(self.likely), dtype=np.float64)
        self._by: dict[str, Floats] = {}
        for quantity in WHEEL_QUANTITIES:
            columns = [p.wheels.get(quantity, np.zeros(len(nominal.wheels))) for p in parameters]
            if columns and np.any(columns):
                self._by[quantity] = np.stack(columns, axis=1)
        self._values = {
            name: np.array([getattr(w, name) or 0.0 for w in nominal.wheels]) for name in WHEEL_QUANTITIES
        }
        self._gains = np.array(
            [np.zeros(len(nominal.steered_wheel_names)) if p.gain is None else p.gain for p in parameters]
        ).reshape(self.own, len(nominal.steered_wheel_names))

    def value(self, values: Floats, name: str, default: float) -> float:
        """The value of one parameter, or what it is when it is not calibrated."""
        return float(values[self.names.index(name)]) if name in self.names else default

    def change(self, values: Floats) -> Floats:
        """Differences of the rover's own parameters from their start values, (own,), without mounts."""
        change: Floats = (values - self.start)[: self.own]
        return change

    def wheels(self, values: Floats) -> Rover:
        """The rover with these values, in the nominal body frame. Raises `ValueError` if a wheel may not have
        such a value."""
        change = self.change(values)
        moved = {name: self._values[name] + columns @ change for name, columns in self._by.items()}
        rollers = [wheel.roller_angle is not None for wheel in self.nominal.wheels]
        return with_wheels(
            self.nominal,
            (
                {name: float(column[i]) for name, column in moved.items() if name != "roller_angle" or has}
                for i, has in enumerate(rollers)
            ),
        )

    def pose(self, values: Floats, kind: str, mount: str | None = None) -> Floats:
        """The sensor, or the origin that the result shall have, as a pose in the nominal body; the sensor
        of one session with its `mount`."""
        found = [self.value(values, f"{kind}_{axis}", 0.0) for axis in FRAME]
        if kind == "sensor" and mount is not None:
            own = [self.value(values, f"mount_{axis}[{mount}]", 0.0) for axis in FRAME]
            found = [one + other for one, other in zip(found, own, strict=True)]
        return np.array(found)

    def columns(self, kind: str, axis: str, mount: str) -> list[int]:
        """Indices of the parameters that move an axis of the sensor, or of the origin, in a session."""
        names = [f"{kind}_{axis}", *([f"mount_{axis}[{mount}]"] if kind == "sensor" else [])]
        return [self.names.index(name) for name in names if name in self.names]

    def tracked(self, values: Floats, mount: str | None = None) -> Floats:
        """Pose in the nominal body of the point that the truth follows: origin and sensor composed."""
        return joined(self.pose(values, "origin"), self.pose(values, "sensor", mount))

    def rover(self, values: Floats) -> Rover:
        """The rover with these values, about the new origin where there is one."""
        rover, origin = self.wheels(values), self.pose(values, "origin")
        if not origin.any():
            return rover
        places = np.array([(wheel.x, wheel.y, wheel.heading) for wheel in rover.wheels])
        seen = joined(inverse(origin), places)
        return with_wheels(rover, ({"x": x, "y": y, "heading": yaw} for x, y, yaw in seen.tolist()))

    def deviations(self, values: Floats, covariance: Floats) -> Floats:
        """Deviations of the dimensions, from a covariance (own, own), in the form that `Odometry` takes."""
        rover, moved = self.rover(values), []
        yaw = self.pose(values, "origin")[2]
        for parameter, value in zip(self.parameters[: self.own], values, strict=False):
            moved.append(moves(rover, parameter, float(value)))
            if parameter.name != "origin_yaw":  # in the axes that the wheels were given in
                moved[-1][:, PLACE] = _rotated(np.full(len(moved[-1]), -yaw), moved[-1][:, PLACE, None])[
                    :, :, 0
                ]
        return apart(moved, covariance)

    def readings(self, drive: Drive, values: Floats) -> tuple[Floats, Floats]:
        """Steering angles and wheel speeds, as the encoders mean them under these values."""
        gain = np.ones(drive.steering.shape[1]) + self.change(values) @ self._gains
        return gain * drive.steering, self.value(values, "encoder_scale", 1.0) * drive.wheel_speeds

    def corrected(self, log: WheelLog, values: Floats) -> WheelLog:
        """The log as its encoders mean it under these values."""
        steering = log.steering
        if steering is not None:
            steering = steering * (np.ones(steering.shape[1]) + self.change(values) @ self._gains)
        return replace(
            log,
            steering=steering,
            wheel_angles=log.wheel_angles * self.value(values, "encoder_scale", 1.0),
        )

    def twists(self, drive: Drive, values: Floats, rover: Rover) -> tuple[Floats, Floats]:
        """Body twists between the rows (n, 3) and their derivatives by the rover's numbers (n, 3, own)."""
        steering, speeds = self.readings(drive, values)
        wanted = list(self._by)
        if self._gains.any():
            wanted.append("steering")
        if "encoder_scale" in self.names:
            wanted.append("wheel_speeds")
        if not wanted:
            return rover.forward(steering, speeds), np.zeros((len(speeds), 3, self.own))
        found = rover.sensitivity(steering, speeds, quantities=wanted)  # type: ignore[arg-type]
        by = np.zeros((len(speeds), 3, self.own))
        for name, columns in self._by.items():
            by += getattr(found, name) @ columns
        if self._gains.any():
            by += (found.steering * drive.steering[:, None, :]) @ self._gains.T
        if "encoder_scale" in self.names:
            turned = np.nan_to_num(drive.wheel_speeds)[:, None, :]
            by[:, :, self.names.index("encoder_scale")] += (found.wheel_speeds * turned).sum(axis=2)
        return found.twist, by

    def poses(self, drive: Drive, values: Floats) -> Floats:
        """Dead reckoning of what the truth follows, one pose per row of the drive, from anywhere."""
        body = integrate(self.wheels(values).forward(*self.readings(drive, values)), drive.dt)
        return joined(body, self.tracked(values))

    def errors(self, drive: Drive, values: Floats) -> tuple[Floats, Floats]:
        """Error of the end of each window in the frame of the truth (m, 3), and its derivatives (m, 3, p)."""
        twists, by_twist = self.twists(drive, values, self.wheels(values))
        poses = integrate(twists, drive.dt)
        by_pose = carried(poses, twists, by_twist, drive.dt)
        rest = len(values) - self.own  # parameters that move only the tracked point
        offset = self.value(values, "time_offset", 0.0)
        if drive.truth.has_yaw:
            first, last = drive.rows.T
            moved, by_moved = _between_with(poses[first], poses[last], by_pose[first], by_pose[last])
            by_moved = np.pad(by_moved, ((0, 0), (0, 0), (0, rest)))
            seen, by_seen = self._seen_from(drive.mount, values, moved, by_moved)
            ends, rates = drive.truth_at(drive.rows, offset)
            wanted, by_clock = _between_with(
                ends[:, 0], ends[:, 1], rates[:, 0, :, None], rates[:, 1, :, None]
            )
        else:
            rows = np.stack((drive.rows[:, 0], drive.middles, drive.rows[:, 1]))
            by_rows = np.pad(by_pose[rows], ((0, 0), (0, 0), (0, 0), (0, rest)))
            seen, by_seen = _between_chords(*self._places(drive.mount, values, poses[rows], by_rows))
            places, rates = drive.truth_at(rows, offset)
            wanted, by_clock = _between_chords(places[..., :2], rates[..., :2, None])
        error = between(wanted, seen)
        by_error = by_seen
        if "time_offset" in self.names:
            by_error = by_seen.copy()
            by_error[:, :, self.names.index("time_offset")] -= by_clock[:, :, 0]
        turned = _rotated(-wanted[:, 2], by_error)
        if "time_offset" in self.names:
            column = self.names.index("time_offset")
            turned[:, :2, column] -= _left_of(error[:, :2]) * by_clock[:, 2]
        if not drive.truth.has_positions:
            error[:, :2], turned[:, :2] = 0.0, 0.0
        return error, turned

    def shortened(self, drive: Drive, values: Floats) -> Floats:
        """Second-order shortening of each window's displacement (m, 2) per squared error of its heading.

        A heading errs by the root of the way since the start of a window, so what comes early counts least:
        the mean over the way of what is left to the end. In the frame of `errors`; 0 where headings are not
        compared.
        """
        if not (drive.truth.has_yaw and drive.truth.has_positions):
            return np.zeros((len(drive.rows), 2))
        poses = self.poses(drive, values)
        steps = np.diff(poses, axis=0) * (1.0, 1.0, size(self.nominal))
        way = np.linalg.norm(steps, axis=1)
        middles = (poses[1:, :2] + poses[:-1, :2]) / 2.0
        begin = np.zeros((1, 2))
        sums = np.concatenate((begin, np.cumsum(middles * way[:, None], axis=0)))
        along = np.concatenate(([0.0], np.cumsum(way)))
        first, last = drive.rows.T
        mean = (sums[last] - sums[first]) / (along[last] - along[first])[:, None]
        left = (poses[last, :2] - mean)[:, :, None]
        return _rotated(-poses[last, 2], left)[:, :, 0]

    def _places(self, mount: str, values: Floats, poses: Floats, by_pose: Floats) -> tuple[Floats, Floats]:
        """Positions of what is tracked (..., 2) at poses (..., 3), with their derivatives (..., 2, p)."""
        origin, sensor = self.pose(values, "origin"), self.pose(values, "sensor", mount)
        tracked = self.tracked(values, mount)
        cos, sin = np.cos(poses[..., 2]), np.sin(poses[..., 2])
        turn = np.moveaxis(np.array([[cos, -sin], [sin, cos]]), (0, 1), (-2, -1))
        arm = turn @ tracked[:2]
        by = (
            by_pose[..., :2, :]
            + np.stack((-arm[..., 1], arm[..., 0]), axis=-1)[..., None] * by_pose[..., 2:, :]
        )
        tilt = np.array([[np.cos(origin[2]), -np.sin(origin[2])], [np.sin(origin[2]), np.cos(origin[2])]])
        moves = {
            ("origin", "x"): (1.0, 0.0),
            ("origin", "y"): (0.0, 1.0),
            ("sensor", "x"): tilt[:, 0],
            ("sensor", "y"): tilt[:, 1],
            ("origin", "yaw"): tilt @ np.array([-sensor[1], sensor[0]]),
        }
        for (kind, axis), direction in moves.items():
            for column in self.columns(kind, axis, mount):
                by[..., column] += turn @ np.asarray(direction)
        return poses[..., :2] + arm, by

    def _seen_from(
        self, mount: str, values: Floats, moved: Floats, by_moved: Floats
    ) -> tuple[Floats, Floats]:
        """The motion of what is tracked, which the body carries along, with its derivatives."""
        tracked = self.tracked(values, mount)
        poses = np.broadcast_to(tracked, moved.shape)
        seen = joined(joined(inverse(poses), moved), poses)
        arm = _rotated(moved[:, 2], np.broadcast_to(tracked[:2, None], (len(moved), 2, 1)))[:, :, 0]
        by = by_moved.copy()
        by[:, :2] += _left_of(arm)[:, :, None] * by_moved[:, 2:3]
        by = _rotated(np.full(len(moved), -tracked[2]), by)

        # By the place and the yaw of what is tracked; the origin turns the sensor with it.
        turn = wrap_angle(moved[:, 2])
        eye = np.broadcast_to(np.eye(2), (len(moved), 2, 2))
        by_place = _rotated(np.full(len(moved), -tracked[2]), _rotated(np.asarray(turn), eye) - eye)
        by_yaw = -_left_of(seen[:, :2])
        origin, sensor = self.pose(values, "origin"), self.pose(values, "sensor", mount)
        cos, sin = np.cos(origin[2]), np.sin(origin[2])
        places = {"origin": np.eye(2), "sensor": np.array([[cos, -sin], [sin, cos]])}
        carried_along = places["sensor"] @ np.array([-sensor[1], sensor[0]])
        for kind, directions in places.items():
            for number, axis in enumerate("xy"):
                for column in self.columns(kind, axis, mount):
                    by[:, :2, column] += by_place @ directions[:, number]
            for column in self.columns(kind, "yaw", mount):
                by[:, :2, column] += by_yaw
                if kind == "origin":
                    by[:, :2, column] += by_place @ carried_along
        return seen, by


def with_mounts(nominal: Rover, parameters: Sequence[Parameter], drives: Sequence[Drive]) -> Model:
    """A model that also fits, for every session, from where its truth looks, as far as nobody asks for that.

    What a parameter does just as well is left to it: the centres of rotation of a tracked rover all the way
    forward, the same offset of all wheels of one that steers with every wheel.
    """
    if not all(drive.truth.has_yaw and drive.truth.has_positions for drive in drives):
        return Model(nominal, parameters)
    asked = {parameter.name.partition("_")[2] for parameter in parameters if parameter.name in PLACES}
    axes = [axis for axis in FRAME if axis not in asked]
    first = drives[0]
    trial = Model(nominal, parameters, mounts(nominal, [first.mount], axes))
    _, by = trial.errors(first, trial.start)
    slopes = (by * trial.plausible).reshape(-1, len(trial.names))
    own = slopes[:, : trial.own]
    left = slopes[:, trial.own :] - own @ np.linalg.lstsq(own, slopes[:, trial.own :], rcond=None)[0]
    sizes = np.linalg.norm(slopes[:, trial.own :], axis=0)
    free = np.array(axes)[np.linalg.norm(left, axis=0) > ALIKE * sizes]
    sessions = dict.fromkeys(drive.mount for drive in drives)
    return Model(nominal, parameters, mounts(nominal, sessions, free.tolist()))


def carried(poses: Floats, twists: Floats, by_twist: Floats, dt: Floats) -> Floats:
    """Derivatives of integrated poses (n + 1, 3, p) by those of the twists (n, 3, p)."""
    half = twists[:, 2] * dt / 2.0
    small = np.abs(half) < SMALL_TURN
    safe = np.where(small, 1.0, half)
    chord = np.sinc(half / np.pi)
    square = half * half
    bent = np.where(
        small,
        half * (-1.0 / 3.0 + square * (1.0 / 30.0 - square / 840.0)),
        (safe * np.cos(safe) - np.sin(safe)) / (safe * safe),
    )
    # The step is chord(half) R(half) v dt; what follows is its derivative by `half`, and the step itself.
    linear = _rotated(half, (twists[:, :2] * dt[:, None])[:, :, None])[:, :, 0]
    by_half = bent[:, None] * linear + chord[:, None] * _left_of(linear)
    by_step = _rotated(half, by_twist[:, :2] * (chord * dt)[:, None, None])
    by_step += by_half[:, :, None] * (by_twist[:, 2:3] * (dt / 2.0)[:, None, None])

    by_poses = np.zeros((len(poses), 3, by_twist.shape[2]))
    np.cumsum(by_twist[:, 2] * dt[:, None], axis=0, out=by_poses[1:, 2])
    travelled = np.diff(poses[:, :2], axis=0)
    by_place = _rotated(poses[:-1, 2], by_step)
    by_place += _left_of(travelled)[:, :, None] * by_poses[:-1, 2:3]
    np.cumsum(by_place, axis=0, out=by_poses[1:, :2])
    return by_poses


def _between_with(
    first: Floats, second: Floats, by_first: Floats, by_second: Floats
) -> tuple[Floats, Floats]:
    """`between` with its derivatives, from those of both poses."""
    seen = between(first, second)
    by = _rotated(-first[:, 2], by_second - by_first)
    by[:, :2] -= _left_of(seen[:, :2])[:, :, None] * by_first[:, 2:3]
    return seen, by


def _between_chords(places: Floats, by_place: Floats) -> tuple[Floats, Floats]:
    """The last of three positions (3, m, 2) as seen from the first, facing along the chords.

    What positions say of a motion without any heading; with derivatives, from those of the positions
    (3, m, 2, p).
    """
    ends, by_ends = [], []
    for at, (first, last) in ((0, (0, 1)), (2, (1, 2))):
        chord, by_chord = places[last] - places[first], by_place[last] - by_place[first]
        square = np.sum(chord * chord, axis=1)
        by_yaw = np.einsum("mi,mip->mp", _left_of(chord) / square[:, None], by_chord)
        ends.append(np.column_stack((places[at], np.arctan2(chord[:, 1], chord[:, 0]))))
        by_ends.append(np.concatenate((by_place[at], by_yaw[:, None]), axis=1))
    return _between_with(*ends, *by_ends)


def _left_of(vectors: Floats) -> Floats:
    """Vectors (n, 2) turned left by a right angle: what a turn of one radian moves their tips by."""
    return np.stack((-vectors[:, 1], vectors[:, 0]), axis=1)


def _rotated(yaw: Floats, columns: Floats) -> Floats:
    """A copy of columns (n, 2 or 3, p) whose first two rows are turned by `yaw` (n,)."""
    cos, sin = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    turned = np.array(columns)
    turned[:, 0] = cos * columns[:, 0] - sin * columns[:, 1]
    turned[:, 1] = sin * columns[:, 0] + cos * columns[:, 1]
    return turned
