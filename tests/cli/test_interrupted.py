"""Ctrl-C in the middle of every command: it ends at once by its code, without a word, files as they were.

Which commands there are is asked of the command line; a new one needs a case, or a word on why it is short.
"""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.machinery import ExtensionFileLoader
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.cli.names import COMMANDS
from six_wheel.cli.signals import ended_by_signals
from tests.core.door.long_calls import commands_file, description, map_file, record_file

pytestmark = pytest.mark.skipif(
    not Path("/proc/self/stat").exists(), reason="reads processor times as Linux has them"
)

BOUND = 0.3  # [s] of processor time from the signal to the end
# The interpreter takes down what libraries have loaded; a machine with other work makes that slower.
ALLOWANCE = 0.3
WAITING = 20.0  # [s] until which a command has ended that other processes keep from the processor
TRIES = 3
MOMENTS = (0.2, 0.9)  # [s] of processor time after the command has begun
ROWS = 200_000
PROGRAM = "import sys; from six_wheel.__main__ import main; print('begins', flush=True); sys.exit(main())"


def log_file(folder: Path) -> Path:
    """A log with its truth."""
    from six_wheel.simulation.writing import write_log

    path, rover = folder / "log.csv", sw.load(folder / "rover.yaml")
    if not path.exists():
        stamps = np.arange(0.0, ROWS / 50.0, 5.0)
        turning = 0.1 * np.sin(stamps)
        drive = (stamps, np.stack([0.1 + 0 * stamps, 0 * stamps, turning], axis=-1))
        write_log(sw.simulate(rover, drive, seed=1, rate=50.0), rover, path)
    return path


Words = list[object]
# Command lines that take several seconds, of files made in a folder.
LONG: dict[str, Callable[[Path], Words]] = {
    "demo": lambda _: ["-o", "pictures"],
    "check": lambda folder: [description(ROWS, folder)],
    "drive": lambda folder: ["rover.yaml", commands_file(ROWS, folder), "-o", "made.csv"],
    "simulate": lambda folder: ["rover.yaml", commands_file(ROWS, folder), "-o", "made.csv"],
    "inspect": lambda folder: [log_file(folder)],
    "odometry": lambda folder: ["rover.yaml", log_file(folder), "-o", "made.csv"],
    "calibrate": lambda folder: ["rover.yaml", log_file(folder), "-o", "made.yaml"],
    "traverse": lambda folder: [
        *("rover.yaml", map_file(ROWS, folder), "-o", "made.tif", "--workers", "1", "--headings", "4")
    ],
    "show": lambda folder: [map_file(10 * ROWS, folder), "-o", "made.png"],
    "view": lambda folder: [log_file(folder), "--rover", "rover.yaml", "--export", "made.html"],
    "convert": lambda folder: [description(ROWS, folder), "made.yaml"],
    "replay": lambda folder: [record_file(3 * ROWS, folder), "-o", "made.mcap"],
    "bench": lambda _: [],
}
SHORT = {
    "example": "copies a small file",
    "node": "runs until it is ended: the tests of the nodes do that",
    "filter": "runs until it is ended: the tests of the nodes do that",
}


def test_every_command_is_interrupted_or_short() -> None:
    assert LONG.keys() | SHORT.keys() == COMMANDS.keys()


def processor_time(process: int) -> float:
    """Processor time of a process [s]."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@dataclass
class End:
    """End of a command."""

    code: int
    out: str
    err: str
    late: float  # processor time from the signal on [s]
    waited: float  # [s]


def interrupted(words: Words, moment: float, folder: Path) -> End | None:
    """A command that gets SIGINT when it has used so much processor time; None if it ended before."""
    environment = os.environ | {"PYTHONPATH": str(Path(sw.__file__).parents[1])}
    command = [sys.executable, "-c", PROGRAM, *map(str, words)]
    err = folder / "told"
    with err.open("wb") as told:
        process = subprocess.Popen(
            command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=told, text=True
        )
        assert process.stdout is not None
        try:
            assert process.stdout.readline() == "begins\n"
            begin = processor_time(process.pid)
            while processor_time(process.pid) - begin < moment:
                if process.poll() is not None:
                    return None
                time.sleep(0.002)
            process.send_signal(signal.SIGINT)
            sent, used = time.monotonic(), processor_time(process.pid)
            while os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None:
                assert time.monotonic() - sent < WAITING, "goes on"
                time.sleep(0.002)
            waited, late = time.monotonic() - sent, processor_time(process.pid) - used
            out = process.stdout.read()
        finally:
            process.kill()
            process.wait()
            process.stdout.close()
    return End(process.returncode, out, err.read_text(), late, waited)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A rover and the files that commands make of it, as they were before a run."""
    made = tmp_path_factory.mktemp("long")
    arm = sw.RockerBogie.preset("perseverance")
    sw.Rover(arm.planar().wheels, suspension=arm).save(made / "rover.yaml")
    for ending in ("csv", "yaml", "tif", "png", "html", "mcap"):
        (made / f"made.{ending}").write_text("before")
    return made


def kept(folder: Path) -> dict[str, bytes]:
    """Small files and what is in them, names of others; without those that a run keeps for the next one."""
    files = [path for path in folder.rglob("*") if path.is_file() and path.name != "told"]
    files = [path for path in files if path.parent.suffix != ".tiles" and path.parent.name != "pictures"]
    return {str(path): path.read_bytes() if path.stat().st_size < 1000 else b"" for path in files}


@pytest.mark.slow
@pytest.mark.parametrize("moment", MOMENTS)
@pytest.mark.parametrize("name", LONG)
def test_a_command_ends_at_once(folder: Path, name: str, moment: float) -> None:
    """`simulate` once ended with an error of pandas, which it was loading; `drive` and `odometry` went on."""
    pytest.importorskip("rasterio", reason="maps need rasterio")
    pytest.importorskip("mcap", reason="records need mcap")
    words = [name, *LONG[name](folder)]
    before = kept(folder)
    for _ in range(TRIES):
        end = interrupted(words, moment, folder)
        assert end is not None, "ended before it was interrupted"
        assert (end.code, end.err) == (130, "")
        assert kept(folder) == before
        assert not [path for path in folder.rglob(".*") if path.parent.suffix != ".tiles"]
        if end.late <= BOUND + ALLOWANCE:
            return
    pytest.fail(f"went on for {end.late:.2f} s of processor time")


def send() -> None:
    os.kill(os.getpid(), signal.SIGINT)


def test_an_exception_that_a_library_loses_is_raised_again() -> None:
    """Code in C that asks for an attribute takes any error for an answer."""
    lost = 0

    def losing() -> None:
        nonlocal lost
        for _ in range(3):
            try:
                send() if not lost else time.sleep(5.0)
            except BaseException:
                lost += 1
        time.sleep(5.0)

    with pytest.raises(KeyboardInterrupt), ended_by_signals():
        losing()
    assert lost == 3


def test_another_error_of_a_library_that_lost_it_is_the_end_as_well() -> None:
    def losing() -> None:
        try:
            send()
        except BaseException:
            raise SystemError("returned a result with an exception set") from None

    with pytest.raises(KeyboardInterrupt), ended_by_signals():
        losing()


class Loader(ExtensionFileLoader):
    """A compiled module during whose initialisation a signal comes."""

    is_done = False

    def exec_module(self, module: object) -> None:
        send()
        time.sleep(0.3)
        self.is_done = True


def test_a_compiled_module_is_initialised_to_its_end() -> None:
    """pandas was not, and said that its parts have no attributes."""
    loader = Loader("module", "module.so")

    def loading() -> None:
        loader.exec_module(None)
        time.sleep(5.0)

    with pytest.raises(KeyboardInterrupt), ended_by_signals():
        loading()
    assert loader.is_done


def test_the_way_out_is_not_interrupted() -> None:
    """Files that are half written are removed on it."""
    is_removed = False

    def at_work() -> None:
        nonlocal is_removed
        try:
            send()
        finally:
            time.sleep(0.4)
            is_removed = True

    with pytest.raises(KeyboardInterrupt), ended_by_signals():
        at_work()
    assert is_removed
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_handlers_of_others_count() -> None:
    heard: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: heard.append(number))
    try:
        with ended_by_signals():
            send()
    finally:
        signal.signal(signal.SIGINT, before)
    assert heard == [signal.SIGINT]
