"""Files that commands write: never one that is read, never one twice, all or none; ends by signals."""

import contextlib
import itertools
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import six_wheel
from six_wheel.cli.shared import WRITTEN
from six_wheel.kinematics.errors import TableError, as_path
from six_wheel.kinematics.objects.whole_files import _beside, replacing, together
from tests.cli.command_lines import READ, Argument, arguments, callbacks, line, read, written
from tests.cli_runs import Run

WRITERS = [name for name in callbacks() if written(name) and name != "demo"]
OUTPUTS = [(name, one) for name in WRITERS for one in written(name)]
SIGNALS = [getattr(signal, name) for name in ("SIGTERM", "SIGINT", "SIGHUP") if hasattr(signal, name)]
# Every command by one of the signals in turn; by each of them with `SOAK` in the environment.
TURNS = len(SIGNALS) if "SOAK" in os.environ else 1
ENDS = [(name, SIGNALS[(k + turn) % len(SIGNALS)]) for k, name in enumerate(WRITERS) for turn in range(TURNS)]
IDS = [f"{name}-{one.name}" for name, one in OUTPUTS]


@pytest.mark.parametrize("name", callbacks())
def test_every_path_is_known_as_read_or_written(name: str) -> None:
    assert {one.name for one in arguments(name)} <= READ.keys() | set(WRITTEN)


@pytest.mark.parametrize(("name", "output"), OUTPUTS, ids=IDS)
@pytest.mark.parametrize("spelling", ["same", "other", "symbolic", "hard", "chain"])
@pytest.mark.usefixtures("files")
def test_no_command_writes_what_it_reads(run: Run, name: str, output: Argument, spelling: str) -> None:
    """`simulate commands.csv -o commands.csv` once replaced its input."""
    for one in read(name):
        source = Path(READ[one.name][0])
        before = source.read_bytes()
        target = Path(f"link{source.suffix}")
        target.unlink(missing_ok=True)
        Path("between").unlink(missing_ok=True)
        match spelling:
            case "same":
                target = source
            case "other":
                target = Path("..") / Path.cwd().name / source
            case "symbolic":
                target.symlink_to(source)
            case "hard":
                os.link(source, target)
            case "chain":
                Path("between").symlink_to(source)
                target.symlink_to("between")
        code, _, err = run(*line(name, **{one.name: source, output.name: target}))
        assert code == 2
        assert err.count("\n") == 1
        assert "must be another file than" in err
        assert source.read_bytes() == before


PAIRS = [(name, *pair) for name in WRITERS for pair in itertools.combinations(written(name), 2)]


@pytest.mark.parametrize(("name", "one", "other"), PAIRS, ids=[f"{n}-{a.name}-{b.name}" for n, a, b in PAIRS])
@pytest.mark.usefixtures("files")
def test_two_outputs_are_two_files(run: Run, name: str, one: Argument, other: Argument) -> None:
    before = sorted(Path().iterdir())
    target = f"made{one.endings[0]}"
    code, _, err = run(*line(name, **{one.name: target, other.name: f"./{target}"}))
    assert (code, sorted(Path().iterdir())) == (2, before)
    assert "must be two files" in err


@pytest.mark.parametrize("name", [n for n in WRITERS if any(one.name == "report" for one in written(n))])
@pytest.mark.usefixtures("files")
def test_pictures_beside_a_report_are_files_of_their_own(run: Run, name: str) -> None:
    """`calibrate --plot r_windows.png --report r.md` once wrote one of two pictures over the other."""
    before = set(Path().iterdir())
    assert run(*line(name, report="r.md"))[0] == 0
    pictures = [path for path in set(Path().iterdir()) - before if path.suffix == ".png"]
    assert Path("r.png") in pictures
    assert run(*line(name, report="r.md", plot=Path("r.png")))[0] == 0  # the same picture, as pages type it
    for picture in pictures:
        for is_link in (False, True):
            if picture == Path("r.png") and not is_link:
                continue
            plot = Path("mine.png") if is_link else picture
            if is_link:
                picture.rename(plot)
                picture.symlink_to(plot)
            was = kept()
            code, _, err = run(*line(name, report="r.md", plot=plot))
            assert (code, kept()) == (2, was)
            assert "must be another file than the output" in err


def no_folder(path: Path) -> Path:
    return path.parent / "nowhere" / path.name


def is_folder(path: Path) -> Path:
    path.mkdir()
    (path / "mine").write_text("before")
    return path


def circle(path: Path) -> Path:
    """A link to itself, which once ended every command with a traceback."""
    path.symlink_to(path.name)
    return path


def read_only(path: Path) -> Path:
    """On a disk that nobody may write to, not even a superuser."""
    return mounted("size=64k,ro") / path.name


def full_disk(path: Path) -> Path:
    """A file that is there already, on a disk without a byte left."""
    folder = mounted("size=64k")
    (folder / path.name).write_text("before")
    with contextlib.suppress(OSError), (folder / "filling").open("wb", buffering=0) as filling:
        while True:
            filling.write(bytes(4096))
    return folder / path.name


def mounted(options: str) -> Path:
    """A small disk as the folder `disk`."""
    folder = Path("disk")
    folder.mkdir(exist_ok=True)
    command = ["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(folder)]
    done = subprocess.run(command, capture_output=True, check=False) if shutil.which("mount") else None
    if done is None or done.returncode:
        pytest.skip("needs the right to mount a small disk")
    return folder


def unmount() -> None:
    if os.path.ismount("disk"):
        subprocess.run(["umount", "-l", "disk"], check=True)


@pytest.fixture
def disk() -> Iterator[None]:
    """Disks mounted in the folder of a run are gone after it."""
    yield
    unmount()


def kept() -> dict[str, bytes]:
    """All files beneath this folder and what is in them."""
    return {str(path): path.read_bytes() for path in Path().rglob("*") if path.is_file()}


@pytest.mark.parametrize(("name", "output"), OUTPUTS, ids=IDS)
@pytest.mark.parametrize("bad", [no_folder, is_folder, circle, read_only, full_disk])
@pytest.mark.usefixtures("files", "disk")
def test_all_outputs_are_replaced_or_none(
    run: Run, name: str, output: Argument, bad: Callable[[Path], Path]
) -> None:
    """An output that cannot be written is named as it was given, and all others stay as they were."""
    pictures = {".svg", ".pdf"}  # are written as .png is
    for ending in [each for each in output.endings if each not in pictures]:
        others = {one.name: Path(f"other_{one.name}{one.endings[0]}") for one in written(name)}
        for other in others.values():
            other.write_text("before")
        unmount()
        given = bad(Path(f"made{ending}"))
        before = kept()
        code, _, err = run(*line(name, **others | {output.name: given}))
        told = [text for text in err.splitlines() if "warning" not in text]
        assert (code, len(told)) == (2, 1), err
        assert told[0].startswith("six-wheel: ")
        assert str(given.with_suffix("")) in told[0]  # or a picture beside a report
        assert kept() == before


def test_files_together(tmp_path: Path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"

    def interrupted() -> None:
        with together(), replacing(one) as temporary:
            temporary.write_text("1")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert list(tmp_path.iterdir()) == []
    with together([tmp_path / "source"]):
        for path in (one, other):
            with replacing(path) as temporary:
                temporary.write_text(path.name)
            assert not path.exists()
        with pytest.raises(TableError, match="another file than the output"), replacing(one):
            pass
    assert (one.read_text(), other.read_text()) == ("one", "other")


def test_long_names_and_the_full_disk_of_another_file(tmp_path: Path) -> None:
    path = tmp_path / f"{'n' * 251}.csv"
    with replacing(path) as temporary:
        temporary.write_text("all")
    assert path.read_text() == "all"
    with (
        pytest.raises(OSError, match=re.escape("[Errno 28] No space left on device")),
        replacing(path),
    ):
        raise OSError(28, "No space left on device")
    assert path.read_text() == "all"


def test_names_that_no_file_can_have(tmp_path: Path) -> None:
    """A link to itself was a `RuntimeError`, and a name too long an `OSError` with the whole of it twice."""
    loop = tmp_path / "loop.csv"
    loop.symlink_to(loop)
    for path in (loop, tmp_path / f"{'n' * 300}.csv"):
        with pytest.raises(TableError, match="the output must be writeable, got: "), replacing(path):
            pass


@pytest.mark.parametrize("text", ["", "a\0b"])
def test_texts_that_are_no_path(text: str) -> None:
    """An empty one was the current folder."""
    with pytest.raises(ValueError, match="output must name a file, got"):
        as_path("output", text)


def test_what_a_killed_writer_left_is_removed_by_the_next(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    left = tmp_path / f"{_beside(path)}{dead.pid}-0123abcd.csv"
    at_work = tmp_path / f"{_beside(path)}{os.getppid()}-0123abcd.csv"
    for each in (left, at_work):
        each.write_text("half")
    with replacing(path) as temporary:
        temporary.write_text("all")
    assert sorted(tmp_path.iterdir()) == sorted([path, at_work])


# All that a command writes is written and nothing replaced yet when it says so and waits for its end.
WAITING = """
import os, sys, time

def wait(*_, **__):
    print("written", flush=True)
    time.sleep(60)

os.replace = wait
from six_wheel.__main__ import main
sys.exit(main(sys.argv[1:]))
"""


def ended(arguments: list[str], number: int) -> int:
    """The return code of a command that gets a signal when all is written, and nothing replaced yet."""
    environment = os.environ | {"PYTHONPATH": str(Path(six_wheel.__file__).parents[1])}
    command = [sys.executable, "-c", WAITING, *arguments]
    process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout is not None
    try:
        while (text := process.stdout.readline()) and b"written" not in text:
            pass
        assert text, process.communicate()
        process.send_signal(number)
        _, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert b"Traceback" not in err, err
    return process.returncode


@pytest.mark.skipif(sys.platform == "win32", reason="no signals to send")
@pytest.mark.parametrize(("name", "number"), ENDS)
@pytest.mark.usefixtures("files")
def test_an_end_by_a_signal_leaves_nothing(name: str, number: int) -> None:
    outputs = {one.name: f"other_{one.name}{one.endings[0]}" for one in written(name)}
    for path in outputs.values():
        if name != "example":
            Path(path).write_text("before")
    before = kept()
    code = ended(line(name, **outputs), number)
    assert code in ((130, -number) if number == signal.SIGINT else (-number,))
    # Finished tiles of a map stay, for the same call to go on.
    assert {path: text for path, text in kept().items() if ".tiles/" not in path} == before


@pytest.mark.parametrize("arguments", [("check", ""), ("drive", "rover.yaml", "commands.csv", "--output=")])
def test_an_empty_argument_is_no_path(run: Run, arguments: tuple[str, ...]) -> None:
    code, _, err = run(*arguments)
    assert (code, err) == (2, "six-wheel: an argument must not be empty, got one that is\n")


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs timers that send signals")
def test_a_signal_right_after_a_file_is_created_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Once the file that was just created stayed: what removes it began a statement later."""

    open_file = Path.open

    def interrupted(path: Path, mode: str) -> None:
        open_file(path, mode).close()
        monkeypatch.undo()
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "open", interrupted)
    with pytest.raises(KeyboardInterrupt), replacing(tmp_path / "run.csv"):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_signal_comes_before_all_outputs_are_replaced_or_after(tmp_path: Path) -> None:
    """Python handled one between two files, so that a part of them was new."""
    paths = [tmp_path / f"{k}.txt" for k in range(40)]

    class StopError(Exception):
        pass

    def stop(*_: object) -> None:
        raise StopError

    before = signal.signal(signal.SIGALRM, stop)
    try:
        for k in range(30):
            for path in paths:
                path.write_text("old")
            with contextlib.suppress(StopError):
                with together():
                    for path in paths:
                        with replacing(path) as temporary:
                            temporary.write_text("new")
                    signal.setitimer(signal.ITIMER_REAL, 1e-5 + 5e-5 * k)  # [s] 40 files take about 1e-3
                time.sleep(0.01)  # the signal comes here at the latest
            assert len({path.read_text() for path in paths}) == 1
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
