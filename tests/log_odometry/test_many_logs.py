"""Many logs at once: tracks as of one by one, whoever makes them, whatever dies or stops on the way."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pyarrow")

import six_wheel as sw
from six_wheel.kinematics.errors import SuspiciousReadingsWarning
from six_wheel.kinematics.objects.whole_files import _beside
from six_wheel.log_odometry import FleetLog, ReckonSettings, reckon, reckon_all
from six_wheel.simulation import write_log
from tests.cli_runs import Run
from tests.rovers import PAIR

NOISE = ReckonSettings(sw.Noise(slip=0.01, side_slip=0.01))
COUNT = 12


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Logs of two days, one of them no log."""
    folder = tmp_path_factory.mktemp("logs")
    for number in range(COUNT):
        (day := folder / ("monday", "tuesday")[number % 2]).mkdir(exist_ok=True)
        commands = [(0, 0.4, 0, 0.1 * (number - 5)), (4, 0.4, 0, -0.3), (8, 0.2, 0, 0)]
        log = sw.simulate(PAIR, commands, noise=sw.Noise(slip=0.01), rate=20.0, seed=number)
        write_log(log, PAIR, day / f"run{number}.csv")
    (folder / "tuesday" / "broken.csv").write_text("time,left,right\n")
    return folder


@pytest.fixture(scope="module")
def one_by_one(logs: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """The track of every log, by `reckon`."""
    folder, found = tmp_path_factory.mktemp("single"), {}
    for path in logs.rglob("run*.csv"):
        reckon(PAIR, path, folder / path.name, settings=NOISE)
        found[f"{path.parent.name}/{path.name}"] = (folder / path.name).read_bytes()
    assert len(found) == COUNT
    return found


@pytest.fixture(scope="module")
def client(local_cluster: Any) -> Iterator[Any]:
    """A client of a Dask cluster of two processes."""
    import distributed

    with distributed.Client(local_cluster, set_as_default=False) as found:
        yield found


def tracks(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("run*.csv")}


def failures(done: list[FleetLog]) -> list[str]:
    return [one.path.name for one in done if one.failure is not None]


@pytest.mark.parametrize("where", ["here", "processes", "dask"])
def test_tracks_are_those_of_one_by_one_to_the_bit(
    logs: Path,
    one_by_one: dict[str, bytes],
    where: str,
    tmp_path: Path,
    request: pytest.FixtureRequest,
) -> None:
    if where == "dask":
        ways = {"cluster": request.getfixturevalue("client")}
    else:
        ways = {"workers": 1 if where == "here" else 2}
    told: list[tuple[int, int]] = []
    done = list(
        reckon_all(
            PAIR, [logs], tmp_path / "tracks", settings=NOISE, progress=lambda *k: told.append(k), **ways
        )
    )
    assert tracks(tmp_path / "tracks") == one_by_one
    assert failures(done) == ["broken.csv"]
    assert told == [(k + 1, COUNT + 1) for k in range(COUNT + 1)]
    summaries = [one.summary for one in done if one.summary is not None]
    assert all(each["rows"] > 100 and each["ate"] < 0.2 for each in summaries)


def test_a_killed_worker_loses_nothing(
    logs: Path, one_by_one: dict[str, bytes], client: Any, tmp_path: Path
) -> None:
    victim = next(iter(client.run(os.getpid).values()))
    done = []
    for one in reckon_all(PAIR, [logs], tmp_path / "tracks", settings=NOISE, cluster=client):
        done.append(one)
        if len(done) == 3:
            os.kill(victim, signal.SIGKILL)
    assert failures(done) == ["broken.csv"]
    assert tracks(tmp_path / "tracks") == one_by_one


def test_what_a_worker_that_died_had_begun_is_gone(logs: Path, tmp_path: Path) -> None:
    """A part of a track was left beside it under a hidden name."""
    (folder := tmp_path / "tracks" / "monday").mkdir(parents=True)
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    begun, other = (
        folder / f"{_beside(folder / 'run4.csv')}{dead.pid}-0123abcd.csv",
        folder / ".run4.notes.csv",
    )
    for path in (begun, other):
        path.write_text("time,x\n0,")
    list(reckon_all(PAIR, [logs], tmp_path / "tracks", settings=NOISE, workers=1))
    assert (folder / "run4.csv").is_file()
    assert not begun.exists()
    assert other.exists()


def test_a_stopped_run_goes_on_and_what_changed_is_done_again(
    logs: Path, one_by_one: dict[str, bytes], tmp_path: Path
) -> None:
    def run(settings: ReckonSettings = NOISE) -> Iterator[FleetLog]:
        return reckon_all(PAIR, [logs], tmp_path / "tracks", settings=settings, workers=1)

    stopped = run()
    first = [next(stopped) for _ in range(5)]
    stopped.close()  # type: ignore[attr-defined]
    again = list(run())
    assert sum(one.resumed for one in again) == len(first) - len(failures(first))
    assert tracks(tmp_path / "tracks") == one_by_one
    kept = {one.path: one.summary for one in again if one.summary is not None}
    for one in first:
        if one.summary is not None:
            np.testing.assert_array_equal(kept[one.path]["pose"], one.summary["pose"])  # type: ignore[index]
    assert sum(one.resumed for one in run()) == COUNT
    lost = next((tmp_path / "tracks").rglob("run3.csv"))
    lost.unlink()
    assert sum(one.resumed for one in run()) == COUNT - 1
    assert not any(one.resumed for one in run(ReckonSettings(sw.Noise(slip=0.02))))


def test_a_run_that_is_killed_goes_on(logs: Path, one_by_one: dict[str, bytes], tmp_path: Path) -> None:
    """The whole command, killed in the middle; what it left is whole, and the next one does the rest."""
    rover = tmp_path / "rover.yaml"
    rover.write_text(
        "kind: differential\ntrack_width: 0.4\nwheel_radius: 0.1\nnoise: {slip: 0.01, side_slip: 0.01}\n"
    )
    arguments = ["odometry", str(rover), str(logs), "-o", str(tmp_path / "tracks"), "--workers", "1"]
    command = [sys.executable, "-m", "six_wheel", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    end = time.monotonic() + 60.0
    while time.monotonic() < end and len(tracks(tmp_path / "tracks")) < 3 and process.poll() is None:
        time.sleep(0.002)
    process.kill()
    process.wait()
    for name, text in tracks(tmp_path / "tracks").items():
        assert text == one_by_one[name]
    finished = subprocess.run(command, capture_output=True, text=True, timeout=100)
    assert finished.returncode == 1  # one log is none
    assert finished.stderr.count("broken.csv") == 1  # its path, and what is wrong
    assert "Traceback" not in finished.stderr
    assert "done before" in finished.stdout
    assert tracks(tmp_path / "tracks") == one_by_one


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["{logs}"], "several logs need a folder for their tracks: give -o"),
        (["{logs}", "-o", "t", "--plot", "p.png"], "--plot is for one log"),
        (["{logs}", "-o", "t", "--output-format", ".txt"], "ending"),
        (["{logs}/monday/run0.csv", "--cluster", "tcp://127.0.0.1:1"], "--cluster is for several logs"),
        (["{logs}", "-o", "{logs}/monday/run0.csv"], "the output of several logs must be a folder"),
    ],
)
def test_wrong_usage(
    run: Run, refused: Callable[..., str], logs: Path, arguments: list[str], words: str
) -> None:
    Path("cart.yaml").write_text("kind: differential\ntrack_width: 0.4\nwheel_radius: 0.1\n")
    assert words in refused("odometry", "cart.yaml", *(each.format(logs=logs) for each in arguments))


def test_a_calibration_is_the_same_on_a_cluster(client: Any) -> None:
    pytest.importorskip("scipy")
    start = sw.Rover.differential(0.39, 0.102)
    commands = [(0, 0.4, 0, 0.5), (4, 0.4, 0, -0.6), (8, 0.2, 0, 0.3)]
    drives = [
        sw.simulate(PAIR, commands, noise=sw.Noise(slip=0.005), rate=20.0, seed=seed) for seed in range(3)
    ]
    alone, spread = sw.calibrate(start, drives), sw.calibrate(start, drives, cluster=client)
    np.testing.assert_array_equal(alone.values, spread.values)
    np.testing.assert_array_equal(alone.covariance, spread.covariance)
    assert alone.chosen == spread.chosen
    assert alone.noise == spread.noise
    for one, other in zip(alone.cross_validation.candidates, spread.cross_validation.candidates, strict=True):
        np.testing.assert_array_equal(one.errors, other.errors)


@pytest.mark.parametrize("again", ["name", "link", "copy"])
def test_a_log_that_is_given_again_counts_once(logs: Path, tmp_path: Path, again: str) -> None:
    """Two of one path had two workers write one track, and a copy counted twice in the median error."""
    first = logs / "monday" / "run0.csv"
    other = first if again == "name" else tmp_path / "other.csv"
    if again == "link":
        other.symlink_to(first)
    elif again == "copy":
        other.write_bytes(first.read_bytes())
    second = logs / "tuesday" / "run1.csv"
    line = f"{other} has the readings of {first}: they count once"
    with pytest.warns(SuspiciousReadingsWarning) as caught:
        done = list(reckon_all(PAIR, [first, other, second], tmp_path / "tracks", settings=NOISE, workers=1))
    assert [str(each.message) for each in caught] == [line]
    assert sorted(one.path for one in done) == [first, second]


@pytest.mark.parametrize(
    ("rows", "ending"),
    [((60, 160), ".csv"), ((0, 120), ".parquet"), ((60, 140), ".csv")],
    ids=["middle", "parquet", "80 rows"],
)
def test_a_part_of_a_log_counts_once(logs: Path, tmp_path: Path, rows: tuple[int, int], ending: str) -> None:
    """The rows of a part counted a second time in the distance and in the median error."""
    whole, other = logs / "monday" / "run0.csv", logs / "monday" / "run2.csv"
    part = tmp_path / f"part{ending}"
    lines = whole.read_text().splitlines()
    cut = "\n".join([lines[0], *lines[1 + rows[0] : 1 + rows[1]]]) + "\n"
    if ending == ".csv":
        part.write_text(cut)
    else:
        from pyarrow import BufferReader, csv, parquet

        parquet.write_table(csv.read_csv(BufferReader(cut.encode())), part)
    with pytest.warns(SuspiciousReadingsWarning) as caught:
        done = list(reckon_all(PAIR, [part, whole, other], tmp_path / "tracks", settings=NOISE, workers=1))
    assert [str(each.message) for each in caught] == [f"{part} has the readings of {whole}: they count once"]
    assert sorted(one.path for one in done) == [whole, other]


def test_logs_that_overlap_are_named_and_the_overlap_counts_once(logs: Path, tmp_path: Path) -> None:
    lines = (logs / "monday" / "run0.csv").read_text().splitlines()
    first, second = tmp_path / "first.csv", tmp_path / "second.csv"
    first.write_text("\n".join(lines[:110]) + "\n")
    second.write_text("\n".join([lines[0], *lines[60:]]) + "\n")
    for again in range(2):  # the second time from the journal
        done = list(reckon_all(PAIR, [first, second], tmp_path / "tracks", settings=NOISE, workers=1))
        assert len(failures(done)) == 1
        (failed,) = [one for one in done if one.failure is not None]
        (other,) = [one for one in done if one.failure is None]
        assert f"the readings of {other.path}, which would count twice" in str(failed.failure)
        assert other.resumed == bool(again)


def test_a_command_says_that_a_log_counts_once(run: Run, logs: Path) -> None:
    Path("cart.yaml").write_text("kind: differential\ntrack_width: 0.4\nwheel_radius: 0.1\n")
    paths = [logs / "monday" / "run0.csv", logs / "monday" / "run2.csv", logs / "monday" / "run0.csv"]
    code, _, said = run("odometry", "cart.yaml", *map(str, paths), "-o", "t", "--workers", "1")
    assert code == 0
    assert f"{paths[0]} has the readings of {paths[0]}: they count once" in said
