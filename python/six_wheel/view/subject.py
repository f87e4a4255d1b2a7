"""The thing to be shown: a rover with its limits, the ground below it, a record of it."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import os
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from six_wheel._core import Limits, RockerBogie, Rover, SettledPose, Suspension, Terrain
from six_wheel.kinematics.errors import ArgumentTypeError, shown
from six_wheel.kinematics.objects.checked_values import is_number
from six_wheel.kinematics.poses import Floats
from six_wheel.robot_description.doubts import DoubtError, Proposal
from six_wheel.robot_description.missing_files import no_file
from six_wheel.robot_description.named_rover import find_rover
from six_wheel.simulation.on_terrain import middle

if TYPE_CHECKING:
    from six_wheel.robot_description.urdf import Robot
    from six_wheel.view.records.record import Record

WHEEL_SPEED = 1.0  # [rad/s] of a wheel where nothing limits it: rovers are slow
DESCRIPTIONS = (".urdf", ".xacro")
PARAMETERS = (".yaml", ".yml", ".json")


@dataclass(frozen=True, eq=False)
class Subject:
    """A rover, its suspension if it has one, its limits, and a record of it if there is one.

    `rover` is that on level ground, in the neutral position of its suspension; a `ground` of None is a plane;
    `robot` has the meshes of its description. `given` is its name on a command line or in a script, None for
    an object made in a program; `ground_given` the same of the ground, `rover_given` of the rover a record
    was given, "" for an object. `start` is the first pose [m, m, rad], `stand` the settled pose that was
    given, which has its ground and its steering angles. `other` is another record, shown beside this one on
    the same ground.
    """

    rover: Rover
    suspension: RockerBogie | None = None
    name: str = "rover"
    limits: Limits = Limits()  # noqa: RUF009 - immutable
    ground: Terrain | None = None
    record: Record | None = None
    robot: Robot | None = None
    given: str | None = None
    ground_given: str | None = None
    rover_given: str | None = None
    start: tuple[float, float, float] = (0.0, 0.0, 0.0)
    stand: SettledPose | None = None
    other: Subject | None = None

    @property
    def radius(self) -> float:
        """Of the largest wheel [m]: what is drawn is as large as it says."""
        return max(wheel.radius for wheel in self.rover.wheels)

    @property
    def size(self) -> float:
        """Largest extent of the wheels seen from above [m]."""
        places = np.array([[wheel.x, wheel.y] for wheel in self.rover.wheels])
        return float(max(*np.ptp(places, axis=0), 4.0 * self.radius))

    @cached_property
    def origin(self) -> Floats:
        """Origin of the scene in the world (3,) [m]: the browser has single precision, maps long numbers."""
        x, y, _ = self.start
        height = 0.0 if self.ground is None else float(self.ground.height_at((x, y)))
        return np.array([x, y, height if np.isfinite(height) else 0.0])

    @property
    def wheel_speed(self) -> float:
        """The limit of the wheels, or a likely one [rad/s]."""
        limit = self.limits.wheel_speed
        return limit if np.isfinite(limit) else WHEEL_SPEED

    @property
    def steering_limit(self) -> float | None:
        """Largest angle that the limits and the joints allow [rad]; None without steered wheels."""
        ranges = [wheel.steering_range for wheel in self.rover.wheels if wheel.steering_range is not None]
        if not ranges:
            return None
        widest = max(max(abs(low), abs(high)) for low, high in ranges)
        return float(min(widest, self.limits.steering_limit, np.pi))  # half a turn is any direction

    @property
    def top_speed(self) -> float:
        """Half the range of the sliders for speeds [m/s]."""
        limit = self.limits.speed
        return 1.5 * (limit if np.isfinite(limit) else self.wheel_speed * self.radius)

    @property
    def top_yaw_rate(self) -> float:
        """Half the range of the slider for yaw rates [rad/s]."""
        limit = self.limits.yaw_rate
        return 1.5 * limit if np.isfinite(limit) else 2.0 * self.top_speed / self.size


def find_subject(
    what: Any, ground: Any = None, *, rover: Any = None, at: Any = None, other: Any = None, **reading: Any
) -> Subject:
    """The subject that an argument means; `rover` says whose a record is where it does not say so itself,
    `other` is a record to be shown beside it, `reading` is for a rover's file, as of `find_rover`. Raises
    `ValueError` if it is a file or a name that cannot be used: one line. Raises `TypeError` if it is nothing
    that can be shown."""
    from six_wheel.view.records.reading import find_record, is_record

    if is_record(what):
        owner = None if rover is None else named_rover(rover, **reading)
        record = find_record(what, None if owner is None else owner.rover)
        limits = record.limits if owner is None else owner.limits
        suspension = record.suspension or (
            known_suspension(record.rover) if owner is None else owner.suspension
        )
        given = os.fspath(what) if isinstance(what, str | os.PathLike) else None
        named = None if rover is None else os.fspath(rover) if isinstance(rover, str | os.PathLike) else ""
        found = Subject(
            record.rover, suspension, record.name, limits, record.ground, record,
            given=given, rover_given=named,
        )  # fmt: skip
    else:
        found = _of_stand(what) if isinstance(what, SettledPose) else named_rover(what, **reading)
    if ground is None and found.ground is None and found.suspension is not None and found.record is None:
        ground = "yard"
    if ground is not None:
        if found.stand is not None:
            raise ValueError(f"ground must be left out for a settled pose, got {_shown(ground)}")
        if found.suspension is None and not (isinstance(ground, str) and ground == "flat"):
            raise ValueError(
                f"ground must be left out for a rover without a suspension, got {_shown(ground)}"
            )
        made = find_ground(ground, found.size)
        given = ground if isinstance(ground, str) else None
        found = replace(found, ground=made, ground_given=given)
    start = found.start
    if at is not None:
        start = triple("at", at)
    elif found.record is not None:
        start = tuple(np.nan_to_num(found.record.poses[0]).tolist())
    elif found.ground is not None and found.stand is None:
        start = (*middle(found.ground), 0.0)
    found = replace(found, start=(float(start[0]), float(start[1]), float(start[2])))
    return found if other is None else _beside(found, other, rover, reading)


def _beside(found: Subject, other: Any, rover: Any, reading: dict[str, Any]) -> Subject:
    """The subject of a record with another one beside it."""
    from six_wheel.view.records.reading import is_record

    if found.record is None:
        raise ValueError(f"other (--with) must be left out unless a record is shown, got {shown(other)}")
    if not is_record(other):
        raise ArgumentTypeError(f"other (--with) must be a record, got {shown(other)}")
    made = find_subject(other, rover=rover, **reading)
    return replace(found, other=replace(made, ground=found.ground, start=found.start))


def find_ground(ground: Any, size: float) -> Terrain | None:
    """A map, what `Terrain.read` takes, ``"yard"`` (rocks, as large as the rover needs) or ``"flat"``."""
    if isinstance(ground, Terrain):
        return ground
    if not isinstance(ground, str | os.PathLike):
        raise ArgumentTypeError(f"ground must be a Terrain, a path, yard or flat, got {shown(ground)}")
    if ground == "flat":
        return None
    if ground == "yard":
        extent = 17.0 * size
        # Rocks of a yard are as large as on Mars: the yard of a smaller rover is that of a large one, scaled.
        scale = size / 2.3
        yard = Terrain.yard(extent / scale, 0.1, 0.09, 3, roughness=0.25)
        return Terrain(np.asarray(yard.heights, dtype=np.float64) * scale, 0.1 * scale)
    try:
        return Terrain.read(ground)
    except DoubtError as error:
        # The command line has the options itself; in Python they are those of `Terrain.read`.
        given = f", as ground=sw.Terrain.read({str(ground)!r}, ...)"
        where = () if all(isinstance(part, str) for part in error.parts) else (Proposal("", "", given),)
        raise type(error)(*error.parts, *where) from None


def named_rover(what: Any, **reading: Any) -> Subject:
    """The subject of a rover, a suspension, a preset's name or a file with a rover."""
    if isinstance(what, RockerBogie):
        return Subject(what.planar(), what)
    if isinstance(what, Rover):
        return Subject(what, known_suspension(what))
    if isinstance(what, Suspension):
        raise ArgumentTypeError(f"x must be a RockerBogie to be shown on its links, got {what!r}")
    if not isinstance(what, str | os.PathLike):
        raise ArgumentTypeError(
            "x must be a Rover, a RockerBogie, a SettledPose, a preset, a Track, a WheelLog, a drive "
            f"or a path, got {type(what).__name__}"
        )
    path, given = Path(what), os.fspath(what)
    if (path.is_file() or path.suffix) and path.suffix.lower() not in (*DESCRIPTIONS, *PARAMETERS):
        raise ValueError(
            f"{given}: the ending must be .yaml, .json, .urdf, .xacro, .mcap, .csv or .parquet"
            if path.exists()
            else no_file(given)
        )
    found = find_rover(given, "x must be a file or a preset", **reading)
    rover, suspension = found.rover, found.rover.suspension
    if found.path is None and (suspension := preset_suspension(given)) is not None:
        rover = suspension.planar()
    return Subject(rover, suspension, found.name, found.limits, robot=found.robot, given=given)


def _of_stand(stand: SettledPose) -> Subject:
    """The subject of a rover at one settled pose, on its ground."""
    if stand.poses.ndim != 1:
        raise ArgumentTypeError(f"x must be one settled pose, got {stand!r}")
    start = triple("x", stand.poses)
    return replace(named_rover(stand.suspension), ground=stand.ground, start=start, stand=stand)


def preset_suspension(name: str) -> RockerBogie | None:
    """The rocker-bogie of a preset, if it has one."""
    return RockerBogie.preset(name) if name in RockerBogie.presets() else None


def known_suspension(rover: Rover) -> RockerBogie | None:
    """The suspension of a rover, or of the preset that it is."""
    if rover.suspension is not None:
        return rover.suspension
    for name in Rover.presets():
        if Rover.preset(name).wheels == rover.wheels:
            return preset_suspension(name)
    return None


def triple(name: str, values: Any) -> tuple[float, float, float]:
    """Three finite numbers."""
    try:
        found = tuple(float(value) for value in values)
    except (TypeError, ValueError):
        raise ArgumentTypeError(f"{name} must be three numbers, got {shown(values)}") from None
    if len(found) != 3 or not np.isfinite(found).all():
        raise ValueError(f"{name} must be three finite numbers, got {shown(values)}")
    return found[0], found[1], found[2]


def number(name: str, value: Any) -> float:
    """A number."""
    if not is_number(value):
        raise ArgumentTypeError(f"{name} must be a number, got {shown(value)}")
    return float(value)


def _shown(ground: Any) -> str:
    return ground if isinstance(ground, str) else type(ground).__name__
