"""Command lines that work: for every command, every file that it reads and every file that it writes.

Which these are is asked of the command line itself; a new command, argument or option is in it at once.
"""

import inspect
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np

import six_wheel as sw
from six_wheel.cli import app
from six_wheel.cli.shared import WRITTEN

ROVERS = ("rover.yaml", "rover.urdf")
LOGS = ("log.csv", "log.parquet", "log.mcap", "log.feather", "bag/bag.db3")
MAPS = ("map.asc", "map.tif", "map.yaml", "map.nc")
# Files that an argument of this name may be, the ordinary one first.
READ: dict[str, tuple[str, ...]] = {
    "commands": ("commands.csv", "commands.parquet"),
    "ground": MAPS,
    "log": LOGS,
    "logs": LOGS,
    "map": MAPS,
    "record": ("record.mcap",),
    "rover": ROVERS,
    "truth": ("truth.csv",),
    "what": (*ROVERS, "rover.xacro", "record.mcap", "log.csv"),
}
# Other arguments that have to be given, or that make a command quick.
OTHERS = {
    "calibrate": ("--no-cross-validation", "--parameters", "wheel_radius"),
    "example": ("commands.csv",),
    "show": ("--twist", "0.1", "0", "0.02"),
    "traverse": ("--workers", "1", "--headings", "2"),
}
UNREAD = ("bench",)  # commands without files


@dataclass(frozen=True)
class Argument:
    """An argument or an option that names a file."""

    name: str
    flag: str | None
    is_needed: bool
    help: str

    def given(self, path: object) -> list[str]:
        return [str(path)] if self.flag is None else [self.flag, str(path)]

    @property
    def endings(self) -> tuple[str, ...]:
        """Endings of files to write, as the help has them."""
        found = re.findall(r"\.(?:csv|parquet|mcap|png|svg|pdf|md|yaml|urdf|json)\b", self.help)
        return tuple(dict.fromkeys(found)) or {"export": (".html",), "output": (".tif",)}[self.name]


def callbacks() -> dict[str, Any]:
    """Commands by name."""
    commands = {command.name or command.callback.__name__: command for command in app.app.registered_commands}
    return {name: command.callback for name, command in commands.items() if name not in UNREAD}


def arguments(command: str) -> Iterator[Argument]:
    """Arguments and options of a command that name files, arguments in their order first."""
    options = []
    for name, parameter in inspect.signature(callbacks()[command]).parameters.items():
        info = next((each for each in get_args(parameter.annotation) if hasattr(each, "metavar")), None)
        positional = type(info).__name__ == "ArgumentInfo"
        if not ("Path" in str(parameter.annotation) or (positional and name in READ)):
            continue
        declared = next((each for each in info.param_decls or () if each.startswith("--")), None)
        flag = None if positional else declared or f"--{name}".replace("_", "-")
        one = Argument(name, flag, parameter.default is parameter.empty, info.help or "")
        if positional:
            yield one
        else:
            options.append(one)
    yield from options


def read(command: str) -> list[Argument]:
    return [each for each in arguments(command) if each.name not in WRITTEN]


def written(command: str) -> list[Argument]:
    return [each for each in arguments(command) if each.name in WRITTEN]


def line(command: str, **files: object) -> list[str]:
    """A command line with files by the names of their arguments; others are ordinary ones."""
    words = [command]
    named = [each.name for each in arguments(command)]
    for one in arguments(command):
        path = files.get(one.name)
        if path is None and one.name in READ and (one.flag is None or one.is_needed):
            path = READ[one.name][0]
        if path is None and one.is_needed:
            path = f"made{one.endings[0]}"
        if one.name == "what" and "export" in named and files.get("export") is None:
            words += ["--export", "page.html"]
        words += [] if path is None else one.given(path)
    if "plot_speeds" in files and "ground" not in files:
        words += ["--ground", READ["ground"][0]]
    if str(files.get("what", "")).endswith((".csv", ".parquet")):
        words += ["--rover", "rover.yaml"]
    return [*words, *OTHERS.get(command, ())]


def write_files(folder: Path) -> None:
    """All files that commands read."""
    import pyarrow.feather
    import pyarrow.parquet

    from six_wheel.simulation.writing import write_log
    from tests.control_loop.replay.test_replay import record

    arm = sw.RockerBogie.preset("perseverance")
    rover = sw.Rover(arm.planar().wheels, suspension=arm)
    limits = sw.Limits(speed=0.4, yaw_rate=0.5, acceleration=0.5, steering_rate=1.0, wheel_speed=3.0)
    rover.save(folder / "rover.yaml", limits=limits)
    (folder / "rover.urdf").write_text(arm.urdf())
    names = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"'
    (folder / "rover.xacro").write_text(arm.urdf().replace("<robot", names, 1))
    stamps = 0.1 * np.arange(30)
    turning = 0.1 * np.sin(stamps)
    rows = [f"{t:.1f},0.3,0,{omega:.4f}" for t, omega in zip(stamps, turning, strict=True)]
    (folder / "commands.csv").write_text("\n".join(["time,vx,vy,omega", *rows, ""]))
    drive = (stamps, np.stack([0.3 + 0 * stamps, 0 * stamps, turning], axis=-1))
    log = sw.simulate(rover, drive, seed=1, rate=10.0)
    for name in ("log.csv", "log.parquet", "log.mcap"):
        write_log(log, rover, folder / name)
    pyarrow.feather.write_feather(pyarrow.parquet.read_table(folder / "log.parquet"), folder / "log.feather")
    write_bag(log, rover, folder / "bag")
    truth = np.column_stack([log.truth.stamps, log.truth.poses])
    np.savetxt(folder / "truth.csv", truth, delimiter=",", header="time,x,y,yaw", comments="")
    as_parquet(folder / "commands.csv")
    record(folder / "record.mcap", periods=60)
    write_maps(folder)


def write_bag(log: sw.WheelLog, rover: sw.Rover, folder: Path) -> None:
    """The joint states of a log as ROS 2 records them by default."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    from six_wheel.simulation.writing import joint_columns

    store = get_typestore(Stores.ROS2_HUMBLE)
    types, kind = store.types, "sensor_msgs/msg/JointState"
    columns = joint_columns(log, rover)
    rows = np.stack(list(columns.values()), axis=-1)
    with Writer(folder, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection("/joint_states", kind, typestore=store)
        for stamp, row in zip(np.round(1e9 * log.stamps).astype(int).tolist(), rows, strict=True):
            header = types["std_msgs/msg/Header"](
                types["builtin_interfaces/msg/Time"](*divmod(stamp, 10**9)), ""
            )
            message = types[kind](header, list(columns), row, row[:0], row[:0])
            writer.write(connection, stamp, store.serialize_cdr(message, kind))


def as_parquet(path: Path) -> None:
    """The same table beside it."""
    import pyarrow.csv
    import pyarrow.parquet

    pyarrow.parquet.write_table(pyarrow.csv.read_csv(path), path.with_suffix(".parquet"))


def write_maps(folder: Path) -> None:
    """The same ground as a text, as a GeoTIFF and by a description with YAML."""
    import rasterio

    from tests.maps.forms.images import affine

    heights = 0.05 * np.sin(np.arange(24.0)) * np.ones((24, 1))
    lines = ["ncols 24", "nrows 24", "xllcenter 0", "yllcenter 0", "cellsize 0.5"]
    text = "\n".join([*lines, *(" ".join(f"{value:.4f}" for value in row) for row in heights), ""])
    (folder / "map.asc").write_text(text)
    profile = {"driver": "GTiff", "width": 24, "height": 24, "count": 1, "dtype": "float32"}
    place = {"crs": "EPSG:32633", "transform": affine(0.5, 0.0, 0.0, 0.0, -0.5, 12.0)}
    with rasterio.open(folder / "map.tif", "w", **profile, **place) as target:
        target.write(heights.astype(np.float32), 1)
    (folder / "map.yaml").write_text("map: map.asc\n")
    write_netcdf(folder / "map.nc", heights)


def write_netcdf(path: Path, heights: np.ndarray) -> None:
    """Heights over their coordinates."""
    from scipy.io import netcdf_file

    with netcdf_file(path, "w") as file:
        for name, count in zip("yx", heights.shape, strict=True):
            file.createDimension(name, count)
            file.createVariable(name, "d", (name,))[:] = 0.5 * np.arange(count)
        file.createVariable("z", "d", ("y", "x"))[:] = heights
