"""Every call and command that takes several logs: what is given again adds no information, and is said.

Found by their signatures: a new one has to be told here how its answer is asked.
"""

import importlib
import inspect
import shutil
import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

pytest.importorskip("scipy")
pytest.importorskip("pyarrow")

import six_wheel as sw
from six_wheel.calibration import calibrate_files
from six_wheel.kinematics.errors import SuspiciousReadingsWarning
from six_wheel.log_odometry import reckon_all
from six_wheel.log_odometry.copies import cut
from six_wheel.simulation import write_log
from tests.cli.command_lines import callbacks
from tests.cli_runs import Run
from tests.rovers import SMALL_PAIR as PAIR

SEVERAL = ("logs", "paths")  # names of arguments that are several logs
MODULES = (
    "",
    ".calibration",
    ".log_odometry",
    ".logs",
    ".simulation",
    ".view",
    ".maps",
    ".control_loop.replay",
)
PARAMETERS = ("wheel_radius", "track_width")
PATH = [(0, 0.2, 0, 0.4), (9, 0.2, 0, -0.5), (20, 0.1, 0, 0.3), (30, 0, 0, 0)]
ONE = {"log.csv": slice(None)}
# Files of one drive beside it: a copy, another format, a part in each of them.
AGAIN = {
    "copy.csv": slice(None),
    "log.parquet": slice(None),
    "log.mcap": slice(None),
    "part.csv": slice(100, 400),
    "part.parquet": slice(0, 300),
}
# A record has its truth on a topic that has to be named.
NO_TRUTH = {("Noise.from_logs", "log.mcap"), ("calibrate_files", "log.mcap"), ("calibrate", "log.mcap")}
# Functions that take no logs in spite of the name of the argument.
NO_LOGS = {"Calibrated": "a result", "parameter_names": "names, asked of how a rover drove"}


def takers() -> Iterator[str]:
    """Public functions and methods with an argument for several logs."""
    for place in MODULES:
        module = importlib.import_module(f"six_wheel{place}")
        for name in module.__all__:
            thing = getattr(module, name)
            parts = [part for part in dir(thing) if part[0] != "_"] if inspect.isclass(thing) else []
            for path, call in [(name, thing), *((f"{name}.{part}", getattr(thing, part)) for part in parts)]:
                if not callable(call):
                    continue
                try:
                    given = inspect.signature(call).parameters
                except (TypeError, ValueError):
                    continue
                if set(SEVERAL) & given.keys():
                    yield path


def said(lines: Iterable[str]) -> None:
    for line in lines:
        if "they count once" in line:
            warnings.warn(line, SuspiciousReadingsWarning, stacklevel=2)


def calibrated(logs: list[Any], folder: Path) -> Any:
    result = sw.calibrate(PAIR, logs, parameters=PARAMETERS, cross_validation=False)
    said(result.observability.messages)
    return result.values, result.covariance


def calibrated_files(paths: list[Path], folder: Path) -> Any:
    done = calibrate_files(PAIR, paths, options={"parameters": PARAMETERS, "cross_validation": False})
    said(done.warnings)
    return done.result.values, done.result.covariance


def measured_noise(logs: list[Any], folder: Path) -> Any:
    noise = sw.Noise.from_logs(PAIR, logs)
    return noise.slip, noise.side_slip


def reckoned(paths: list[Path], folder: Path) -> Any:
    """Rows of all tracks."""
    done = list(reckon_all(PAIR, paths, folder / "tracks", workers=1))
    said(line for one in done for line in (one.summary or {}).get("warnings", ()))
    return sum(one.summary["rows"] for one in done if one.summary)


CALLS: dict[str, Callable[[list[Any], Path], Any]] = {
    "calibrate": calibrated,
    "calibrate_files": calibrated_files,
    "Noise.from_logs": measured_noise,
    "reckon_all": reckoned,
}
OBJECTS = ("calibrate", "Noise.from_logs")  # that take logs in memory too


def test_every_call_for_several_logs_is_walked() -> None:
    assert set(takers()) - NO_LOGS.keys() == CALLS.keys()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One drive in several files, whole and in parts."""
    made = tmp_path_factory.mktemp("logs")
    log = sw.simulate(PAIR, PATH, noise=sw.Noise(slip=0.01, side_slip=0.01), rate=20.0, seed=1)
    for name, rows in {**ONE, **AGAIN}.items():
        write_log(cut(log, rows), PAIR, made / name)
    return made


def answer(name: str, logs: list[Any], folder: Path) -> tuple[Any, list[str]]:
    """The answer of a call, and what it says of logs that count once."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        given = CALLS[name](logs, folder)
    return given, [str(each.message) for each in caught if "they count once" in str(each.message)]


@pytest.mark.parametrize(
    ("name", "again"), [(name, again) for name in CALLS for again in AGAIN if (name, again) not in NO_TRUTH]
)
def test_files_given_again_add_nothing(folder: Path, tmp_path: Path, name: str, again: str) -> None:
    """`Noise.from_logs` once took a copy for another session: less noise, the more often a log was given."""
    one = folder / "log.csv"
    alone, nothing = answer(name, [one], tmp_path / "alone")
    both, lines = answer(name, [one, folder / again], tmp_path / "both")
    assert nothing == []
    np.testing.assert_equal(both, alone)
    assert len(lines) == 1
    assert "log" in lines[0]
    assert Path(again).stem in lines[0]


@pytest.mark.parametrize("rows", [slice(None), slice(100, 400)], ids=["whole", "part"])
@pytest.mark.parametrize("name", OBJECTS)
def test_logs_in_memory_given_again_add_nothing(folder: Path, tmp_path: Path, name: str, rows: slice) -> None:
    log = sw.read_log(folder / "log.csv", PAIR)
    alone, _ = answer(name, [log], tmp_path)
    for again in (cut(log, rows), cut(replace(log, name="other"), rows)):
        both, lines = answer(name, [log, again], tmp_path)
        np.testing.assert_equal(both, alone)
        assert len(lines) == 1


COMMANDS = {
    "calibrate": ["--no-cross-validation", "--parameters", ",".join(PARAMETERS), "-o", "made.yaml"],
    "odometry": ["-o", "tracks", "--workers", "1"],
}


def commands() -> Iterator[str]:
    """Commands with an argument for several files."""
    for name, callback in callbacks().items():
        for parameter in inspect.signature(callback).parameters.values():
            kinds = get_args(get_args(parameter.annotation)[0]) if get_args(parameter.annotation) else ()
            info = next((each for each in get_args(parameter.annotation) if hasattr(each, "metavar")), None)
            if list[Path] in kinds and type(info).__name__ == "ArgumentInfo":
                yield name


def test_every_command_for_several_logs_is_walked() -> None:
    assert set(commands()) == COMMANDS.keys()


@pytest.mark.parametrize(
    ("name", "again"),
    [(name, again) for name in COMMANDS for again in AGAIN if (name, again) not in NO_TRUTH],
)
def test_commands_count_a_log_once(run: Run, folder: Path, name: str, again: str) -> None:
    for file in folder.iterdir():
        shutil.copy(file, file.name)
    PAIR.save("pair.yaml")
    code, _, err = run(name, "pair.yaml", "log.csv", again, *COMMANDS[name])
    lines = [line for line in err.splitlines() if "they count once" in line]
    assert code == 0, err
    assert len(lines) == 1, err
    assert "log.csv" in lines[0] or "log (" in lines[0]
    assert Path(again).stem in lines[0]
