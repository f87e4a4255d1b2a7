"""Calls that no docstring tells how to make long: files, logs, maps and tables of any size."""

from collections.abc import Callable
from dataclasses import fields, replace
from functools import lru_cache, partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

import six_wheel as sw
from tests.calibration.drives import drive
from tests.control_loop.replay.test_replay import record
from tests.objects.samples import ARM, DRIVE, LIMITS, ROVER, TWIST, samples, terrain
from tests.rovers import PAIR


def readings(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Steering angles, wheel angles and stamps of a drive."""
    stamps = 0.01 * np.arange(count)
    steering, speeds = ROVER.inverse(TWIST)
    return np.tile(steering, (count, 1)), stamps[:, None] * speeds, stamps


def log_of(count: int) -> sw.WheelLog:
    steering, angles, stamps = readings(count)
    return sw.WheelLog(stamps, steering, angles)


def log_of_pair(count: int) -> sw.WheelLog:
    return drive(PAIR, seconds=max(count * 0.05, 20.0))


def written(count: int, ending: str, folder: Path) -> Path:
    path = folder / f"log{count}{ending}"
    log_of(count).save(path, rover=ROVER)
    return path


def map_file(count: int, folder: Path) -> Path:
    side, path = int(count**0.5) + 2, folder / f"map{count}.asc"
    row = " ".join(["0.25"] * side)
    path.write_text(
        f"ncols {side}\nnrows {side}\nxllcorner 0\nyllcorner 0\ncellsize 0.1\n" + f"{row}\n" * side
    )
    return path


def commands_file(count: int, folder: Path) -> Path:
    path = folder / f"commands{count}.csv"
    path.write_text("time,vx,omega\n" + "".join(f"{k / 100},0.1,0.01\n" for k in range(count)))
    return path


def record_file(count: int, folder: Path) -> Path:
    path = folder / f"record{count}.mcap"
    record(path, periods=max(count // 50, 60))
    return path


def description(count: int, folder: Path) -> Path:
    """A rover with so many links."""
    path = folder / f"rover{count}.urdf"
    ends = '<parent link="base_link"/><child link="a{0}"/>'
    part = f'<link name="a{{0}}"/><joint name="j{{0}}" type="fixed">{ends}</joint>'
    more = "".join(part.format(k) for k in range(count // 10))
    path.write_text(ROVER.urdf().replace("</robot>", f"{more}</robot>"))
    return path


def image(count: int, folder: Path) -> Path:
    """A map of nav2."""
    side, path = int(count**0.5) + 2, folder / f"map{count}.yaml"
    path.with_suffix(".pgm").write_bytes(f"P5 {side} {side} 255\n".encode() + bytes(side * side))
    path.write_text(f"image: {path.stem}.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n")
    return path


def grid(count: int) -> Any:
    """A message of occupancy."""
    side = int(count**0.5) + 2
    place = SimpleNamespace(x=0.0, y=0.0), SimpleNamespace(x=0.0, y=0.0, z=0.0, w=1.0)
    origin = SimpleNamespace(position=place[0], orientation=place[1])
    info = SimpleNamespace(height=side, width=side, resolution=0.1, origin=origin)
    return SimpleNamespace(
        info=info, data=np.tile(np.array([0, 100, -1], np.int8), side * side)[: side * side]
    )


Long = Callable[[int, Path], Callable[[], object]]
# Calls that no docstring tells how to make long: what to do so many times, files in a folder.
LONG: dict[str, Long] = {
    "integrate": lambda n, _: partial(sw.integrate, np.tile(TWIST, (n, 1)), 0.1),
    "read_log": lambda n, folder: partial(sw.read_log, written(n, ".csv", folder), ROVER),
    "read_log, Parquet": lambda n, folder: partial(sw.read_log, written(n, ".parquet", folder), ROVER),
    "read_log, a frame": lambda n, _: partial(sw.read_log, log_of(n).to_pandas(rover=ROVER), ROVER),
    "dead_reckon": lambda n, _: partial(sw.dead_reckon, ROVER, log_of(n)),
    "drive": lambda n, folder: partial(sw.drive, ROVER, commands_file(n, folder), folder / "made.csv"),
    "calibrate": lambda n, _: partial(sw.calibrate, PAIR, [log_of_pair(n // 50)], parameters=["track_width"]),
    "simulate": lambda n, _: partial(sw.simulate, ROVER, DRIVE, rate=max(n / 40.0, 1.0)),
    "simulate, limits": lambda n, _: partial(
        sw.simulate, ROVER, DRIVE, rate=max(n / 40.0, 1.0), limits=LIMITS
    ),
    "simulate, on ground": lambda n, _: partial(
        sw.simulate, ARM, DRIVE, ground=terrain(), rate=max(n / 1e3, 1.0)
    ),
    "Terrain": lambda n, _: partial(sw.Terrain, np.zeros((2, 12 * n)), 0.1),
    "Terrain.read": lambda n, folder: partial(sw.Terrain.read, map_file(n, folder)),
    "Terrain.yard": lambda n, _: partial(sw.Terrain.yard, 0.05 * n**0.5, 0.05, 0.3),
    "traverse": lambda n, folder: partial(
        sw.traverse, map_file(n, folder), ARM, folder / "made.tif", headings=2, workers=1
    ),
    "WheelLog": lambda n, _: partial(sw.WheelLog, *(readings(n)[k] for k in (2, 0, 1))),
    "WheelLog.from_pandas": lambda n, _: partial(
        sw.WheelLog.from_pandas, log_of(n).to_pandas(rover=ROVER), ROVER
    ),
    "WheelLog.from_increments": lambda n, _: partial(
        sw.WheelLog.from_increments, *(readings(n)[k] for k in (2, 0)), np.full((n, 6), 0.01)
    ),
    "WheelLog.in_radians": lambda n, _: partial(log_of(n).in_radians, ROVER),
    "GroundTruth.covers": lambda n, _: partial(many("GroundTruth", n).covers, np.linspace(0.0, 12.0, n)),
    "Track.from_pandas": lambda n, _: partial(sw.Track.from_pandas, many("Track", n).to_pandas(), ROVER),
    "Track.rows": lambda n, _: partial(many("Track", n).rows, sw.OdometryHealth.SLIP),
    "Track3.rows": lambda n, _: partial(many("Track3", n).rows, sw.OdometryHealth.SLIP),
    "SlipReport.of": lambda n, _: many("Track", n).slip_report,
    "replay": lambda n, folder: partial(sw.replay, record_file(n, folder), output=folder / "made.mcap"),
    "load": lambda n, folder: partial(sw.load, description(n, folder)),
    "Costmap.read": lambda n, folder: partial(sw.Costmap.read, image(n, folder), inflation=0.3),
    "Costmap.from_occupancy_grid": lambda n, _: partial(
        sw.Costmap.from_occupancy_grid, grid(n), inflation=0.5
    ),
    "Mppi.step": lambda n, _: partial(
        sw.Mppi(ROVER, LIMITS, horizon=100, samples=n // 100 + 2).step, (0.0, 0.0, 0.0), goal=(2.0, 0.5, 1.0)
    ),
    "Preintegrated.add": lambda n, _: partial(sw.Preintegrated(ROVER).add, *readings(n)),
    "FourAxle.simulate": lambda n, _: partial(
        sw.FourAxle((0.3, 0.3), 0.4, 0.1).simulate,
        [sw.FourAxleStep("drive", 1.0, "locked", "locked", (1.0,) * 4)],
        1.0 / n,
    ),
}

# Calls without an argument that can make them long, or an ordinary one.
SHORT = {
    "Rover.readings": "one message",
    "Rover.save": "one rover",
    "Mppi.restore": "the state of one planner",
    "Preintegrated.corrected": "one motion",
    "Preintegrated.factor": "one motion",
}


@lru_cache(maxsize=4)
def many(kind: str, count: int) -> Any:
    """An object of a table's class with so many rows."""
    one = samples()[kind]
    if kind == "ControllerRun":
        return sw.Controller(ROVER, LIMITS).run([TWIST], [0.0], np.arange(1, count + 1) * 0.02)
    if kind in ("State", "TransitionState"):
        times = np.linspace(0.0, 1.0, count)
        return samples()["Profile" if kind == "State" else "BodyTransition"].at(times)
    if kind == "Evaluation":
        path = sw.integrate(np.tile(TWIST, (count, 1)), 0.01)
        return sw.evaluate(path, path)
    columns = {each.name: getattr(one, each.name) for each in fields(one)}
    tall = {
        name: value[np.arange(count) % len(value)]
        for name, value in columns.items()
        if isinstance(value, np.ndarray) and value.ndim
    }
    tall |= {"stamps": 0.01 * np.arange(count)} if "stamps" in tall else {}
    return replace(one, **tall)
