"""Damaged and foreign files through every public call that reads a path: an answer, or one line with it.

Which calls these are is asked of the package: functions, constructors and methods of every room with an
argument that is a path. A new one fails until it has a case, or a word on why it reads nothing. `SOAK` in the
environment makes as many damaged copies of each file.
"""

import contextlib
import gc
import importlib
import inspect
import os
import pkgutil
import random
import re
import shutil
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("scipy", reason="walks every room, and calibration needs SciPy")
pytest.importorskip("rasterio", reason="maps need rasterio")
pytest.importorskip("mcap", reason="records need mcap")

import six_wheel as sw
from six_wheel import logs, maps
from six_wheel.calibration import calibrate_files
from six_wheel.log_odometry import dead_reckon_chunks, reckon, reckon_all
from six_wheel.logs import mcap, optiodom
from six_wheel.parallel import Journal
from six_wheel.robot_description import parameters, urdf
from six_wheel.view.subject import find_subject
from tests.cli.command_lines import LOGS, MAPS, READ, write_files
from tests.cli.test_damaged import damaged
from tests.objects.calls import documented

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]

COPIES = int(os.environ.get("SOAK", "3"))
PATH = re.compile(r"\b(Path|PathLike|path|paths|path-like)\b")
NAMES = ("logs", "truth")  # of arguments that may be paths beside much else
ARM = sw.RockerBogie.preset("perseverance")
ROVER = sw.Rover(ARM.planar().wheels, suspension=ARM)
LOG, OUT, RUN = Path("log.csv"), Path("made.tif"), Path("cart_run-01.csv")
COSTMAPS = ("costs.yaml", "costs.pgm")
OWNERS = {".csv": ROVER}
JOURNAL = ("journal/journal.json", "journal/00000000.npz")
# A quick calibration, by a truth that is always the same.
QUICK: Any = {"parameters": ["wheel_radius"], "cross_validation": False}


def log() -> sw.WheelLog:
    return sw.read_log(LOG, ROVER)


def to_the_end(opened: Any) -> None:
    """All rows of a table."""
    with opened:
        for _ in opened.chunks(1000):
            pass


def with_truth(path: Path) -> object:
    with logs.JointLog(LOG, ROVER) as opened:
        return opened.read(truth=path)


# Runs in which a pattern may begin at every place, or brackets nest, with the share of the file before them:
# spaces of a header took a quarter of an hour, comments of a robot description without an end hours.
RUNS = (
    (0.0, b"["),
    *((0.5, run) for run in (b" ", b"[ ", b"<!--", b"1", b'"', b"<gazebo>")),
)

# Public calls that read a path, by an argument of theirs: files that they read, and a call to the last row.
READERS: dict[str, tuple[tuple[str, ...], Callable[[Path], object]]] = {
    "Costmap.read": (COSTMAPS, lambda path: sw.Costmap.read(path.with_suffix(".yaml"))),
    "Noise.from_logs": (("log.csv",), lambda path: sw.Noise.from_logs(ROVER, path)),
    "Terrain.read": (MAPS, sw.Terrain.read),
    "calibrate": (("log.csv",), lambda path: sw.calibrate(ROVER, path, **QUICK)),
    "calibration.calibrate_files": (("log.csv",), lambda path: calibrate_files(ROVER, [path], options=QUICK)),
    "dead_reckon": (("log.parquet",), lambda path: sw.dead_reckon(ROVER, path)),
    "drive": (READ["commands"], lambda path: sw.drive(ROVER, path)),
    "evaluate": (("truth.csv",), lambda path: sw.evaluate(sw.dead_reckon(ROVER, log()), path)),
    "load": (READ["rover"], sw.load),
    "log_odometry.dead_reckon_chunks": (("log.parquet",), lambda path: [*dead_reckon_chunks(ROVER, path)]),
    "log_odometry.reckon": (LOGS, lambda path: reckon(ROVER, path)),
    "log_odometry.reckon, truth": (("truth.csv",), lambda path: reckon(ROVER, LOG, truth=path)),
    "log_odometry.reckon_all": (
        ("log.csv", "bag/bag.db3"),
        lambda path: [*reckon_all(ROVER, [path], Path("tracks"), workers=1)],
    ),
    "logs.CommandTable": (READ["commands"], lambda path: to_the_end(logs.CommandTable(path))),
    "logs.JointLog": (LOGS, lambda path: to_the_end(logs.JointLog(path, ROVER))),
    "logs.JointLog.read": (("truth.csv",), with_truth),
    "logs.mcap.Record": (("record.mcap",), lambda path: [*mcap.Record(path).messages()]),
    "logs.open_log": (LOGS, lambda path: to_the_end(logs.open_log(path, ROVER, logs.LogOptions()))),
    "logs.optiodom.read": ((str(RUN), "cart_metadata.csv"), lambda _: optiodom.read(RUN)),
    "logs.read_log": (LOGS, lambda path: logs.read_log(path, ROVER)),
    "logs.read_log, truth": (("truth.csv",), lambda path: logs.read_log(LOG, ROVER, truth=path)),
    "logs.read_truth": (("truth.csv", "log.csv"), logs.read_truth),
    "maps.read": (MAPS, maps.read),
    "parallel.Journal": (JOURNAL, lambda path: Journal(path.parent, {}).read(0)),
    "parallel.Journal.of_this_run": (JOURNAL, lambda path: Journal.of_this_run(path.parent, {})),
    "read_log": (LOGS, lambda path: sw.read_log(path, ROVER)),
    "read_log, truth": (("truth.csv",), lambda path: sw.read_log(LOG, ROVER, truth=path)),
    "replay": (("record.mcap",), sw.replay),
    "robot_description.parameters.load": (("rover.yaml",), parameters.load),
    "robot_description.parameters.read_parameters": (("rover.yaml",), parameters.read_parameters),
    "robot_description.urdf.read_urdf": (("rover.urdf", "rover.xacro"), urdf.read_urdf),
    "traverse": (MAPS, lambda path: sw.traverse(path, ARM, OUT, headings=2, workers=1)),
    "view.view": (
        READ["what"],
        lambda path: find_subject(path, rover=OWNERS.get(path.suffix)),
    ),
}
# Other calls with an argument that is a path, and what it is.
UNREAD = {
    "a result that names the file": """
        log_odometry.FleetLog maps.Traversed robot_description.parameters.Parameters
        robot_description.urdf.Robot
        """,
    "what messages call a text": """
        control_loop.Settings.of_text robot_description.parameters.parse_parameters
        """,
    "a file to be written": """
        ControllerRun.to_csv GroundTruth.save GroundTruth.to_csv Rover.save logs.TableWriter logs.replacing
        logs.mcap.RecordWriter logs.mcap.RoverRecord plotting.picture_path plotting.save
        simulation.write_ground simulation.write_log view.View.save
        """,
    "numbers or objects": """
        WheelLog WheelLog.from_increments calibration.Calibrated calibration.parameter_names
        log_odometry.Reckoned log_odometry.of_track log_odometry.evaluation.absolute_error
        log_odometry.evaluation.align log_odometry.evaluation.at_same_times
        log_odometry.evaluation.error_growth log_odometry.evaluation.relative_error
        log_odometry.evaluation.slip_against logs.JointRows logs.LogOptions logs.LogOptions.of_body
        plotting.track_figure simulation.GroundSimulation simulation.Simulation
        """,
}


def public() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Functions, classes and their methods of every package, once each: by the shortest name."""
    found: dict[int, tuple[str, Callable[..., Any]]] = {}
    rooms = [info.name for info in pkgutil.walk_packages(sw.__path__, "six_wheel.") if info.ispkg]
    for room in ["six_wheel", *sorted(each for each in rooms if not re.search(r"\.(cli|ros2)\b", each))]:
        module = importlib.import_module(room)
        for name in getattr(module, "__all__", ()):
            thing = getattr(module, name)
            if not (callable(thing) and getattr(thing, "__module__", "").startswith("six_wheel")):
                continue
            called = f"{room}.{name}".removeprefix("six_wheel.")
            found.setdefault(id(thing), (called, thing))
            for part in dir(thing) if inspect.isclass(thing) else ():
                if not part.startswith("_") and callable(each := getattr(thing, part)):
                    found.setdefault(id(getattr(each, "__func__", each)), (f"{called}.{part}", each))
    yield from found.values()


def paths_of(function: Callable[..., Any]) -> list[str]:
    """Arguments that may be paths."""
    try:
        arguments = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return []
    told = documented(function)
    kinds = {each.name: f"{each.annotation} {told.get(each.name, '')}" for each in arguments}
    return [name for name, kind in kinds.items() if name in NAMES or PATH.search(kind)]


CASES = [(name, file) for name, (files, _) in READERS.items() for file in files]


def test_every_public_call_with_a_path_is_known() -> None:
    known = {name.partition(",")[0] for name in READERS} | {*" ".join(UNREAD.values()).split()}
    assert sorted({name for name, function in public() if paths_of(function)} - known) == []


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Files of every kind."""
    folder = tmp_path_factory.mktemp("good")
    write_files(folder)
    run = optiodom.runs(Path(optiodom.__file__).parent / "data" / "optiodom")[0]
    shutil.copy(run, folder / RUN)
    shutil.copy(next(run.parent.glob("*_metadata.csv")), folder / "cart_metadata.csv")
    (folder / "costs.pgm").write_bytes(b"P5 8 8 255\n" + bytes(range(64)))
    (folder / "costs.yaml").write_text("image: costs.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n")
    Journal(folder / "journal", {}).write(0, {"value": 1.0})
    return folder


def copies(content: bytes, seed: str, folder: Path) -> Iterator[tuple[str, bytes | None]]:
    """Names and contents of what may stand where a file is expected; None for a folder."""
    generator = random.Random(zlib.crc32(seed.encode()))
    yield "empty", b""
    yield "a folder", None
    yield "half", content[: len(content) // 2]
    yield "noise", generator.randbytes(3000)
    yield "text of 16 bits", content.decode("latin-1").encode("utf-16-le")
    yield "not UTF-8", content.replace(b"e", b"\xe9")
    yield "zeros", bytes(len(content))
    for other in ("rover.yaml", "rover.urdf", "map.tif", "map.nc", "log.mcap", "log.parquet", "truth.csv"):
        yield other, (folder / other).read_bytes()
    for share, run in RUNS:
        place = round(share * len(content))
        yield f"a run of {run!r}", content[:place] + run * (200_000 // len(run)) + content[place:]
    for number in range(COPIES):
        yield f"damaged {number}", damaged(content, generator)


def wrong(error: Exception, path: Path) -> str | None:
    """Flaw of an error that a reader raised; None if it has none."""
    kind, text = type(error), str(error)
    if not isinstance(error, ValueError | OSError):
        return "is of another kind"
    if not kind.__module__.startswith(("six_wheel", "builtins")) or isinstance(error, UnicodeError):
        return "is of another library"
    if "\n" in text and not hasattr(error, "findings"):  # all mistakes of a description, a line each
        return "has several lines"
    if path.stem not in text and (len(path.parts) < 2 or str(path.parent) not in text):
        return "does not name the file"
    return None


def still_open(folder: Path) -> list[str]:
    """Files of a folder that this process holds open, where the system lists them."""
    found = []
    for each in Path("/proc/self/fd").glob("*"):
        with contextlib.suppress(OSError):  # the listing itself
            found.append(os.readlink(each))
    return [each for each in found if Path(each).is_relative_to(folder.resolve())]


@pytest.mark.parametrize(("name", "file"), CASES, ids=["-".join(case) for case in CASES])
def test_an_answer_or_one_line_with_the_path(
    good: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, file: str
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(good, tmp_path, dirs_exist_ok=True)
    read, path, found = READERS[name][1], Path(file), []
    content = path.read_bytes()
    read(path)
    for kind, copy in copies(content, f"{name} {file}", good):
        path.unlink()
        path.mkdir() if copy is None else path.write_bytes(copy)
        try:
            read(path)
        except Exception as error:
            if what := wrong(error, path):
                found.append(f"{kind} {what}: {type(error).__name__}: {error}")
        if copy is None:
            path.rmdir()
            path.touch()
        # apsw closes the database of rosbags at the next collection; files of Python itself warn then.
        if (left := still_open(tmp_path)) and gc.collect() and (left := still_open(tmp_path)):
            found.append(f"{kind} leaves open: {left}")
    assert not found, "\n".join(found)
