"""The benchmarks themselves: fair turns, honest figures, tables of every job, and no peer needed."""

import itertools
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import pytest

import six_wheel as sw
from six_wheel.cli import benchmark
from six_wheel.cli.benchmark import Comparison, Grid, Timing, machine, nanoseconds, round_robin

BENCHES = Path(__file__).parents[2] / "benches"
PEERS = ("numba", "wpimath")


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(benchmark, "SPAN", 1e-5)


def test_a_timing_is_that_of_one_item() -> None:
    pause = Timing.of(time.sleep, 0.01, items=2)
    pause.measure()
    assert 0.004 <= pause.best < 0.5
    timing = Timing.of(sorted, [3, 1, 2], reverse=True)
    assert timing.once() == [3, 2, 1]
    for _ in range(3):
        timing.measure()
    assert len(timing) == 3
    assert 0 < timing.best <= timing.median


def test_what_is_not_to_be_counted_is_not(quick: None) -> None:
    names = {"pause": lambda _: time.sleep(2e-3), "stamps": itertools.count()}
    statement = Timing("pause(next(stamps))", names, baseline="next(stamps)")
    statement.measure()
    assert 1e-3 < statement.best < 0.2
    assert next(names["stamps"]) >= 3


def test_everyone_has_a_turn_before_anyone_has_two(quick: None) -> None:
    seen: list[str] = []

    def turn(who: str) -> None:
        seen.append(who)
        time.sleep(1e-4)

    jobs = [Comparison(job, {name: Timing.of(turn, job + name) for name in "ab"}) for job in "xy"]
    progress: list[tuple[int, int]] = []
    round_robin(jobs, 3, progress=lambda done, total: progress.append((done, total)))
    assert [who for who, _ in itertools.groupby(seen)] == 3 * ["xa", "xb", "ya", "yb"]
    assert progress == [(k, 12) for k in range(1, 13)]
    assert all(len(timing) == 3 for job in jobs for timing in job.timings.values())


def test_a_grid_in_markdown_and_for_a_terminal() -> None:
    grid = Grid("One call [ns]", ["job", "core"], [["inverse", "71"]], ["a note"])
    assert grid.markdown().splitlines() == [
        "**One call [ns]**", "", "| job | core |", "|---|---:|", "| inverse | 71 |", "", "a note"
    ]  # fmt: skip
    rich = pytest.importorskip("rich.console")
    console = rich.Console(markup=False, width=80, record=True, file=open("/dev/null", "w"))  # noqa: SIM115
    with console.file:
        console.print(grid.rich())
    text = console.export_text()
    for word in ("One call [ns]", "inverse", "71", "a note"):
        assert word in text


def test_figures() -> None:
    assert [nanoseconds(value) for value in (7.123e-9, 71e-9, 5.5e-6)] == ["7.12", "71", "5,500"]
    assert machine()["vectors"] == sw.simd_levels()[-1]
    assert "cores" in machine()["processor"]


def test_batches_agree_whoever_takes_part(monkeypatch: pytest.MonkeyPatch, quick: None) -> None:
    monkeypatch.syspath_prepend(BENCHES)
    import contenders

    jobs = contenders.batches(rows=3000, rollouts=(20, 8))  # which checks all of them
    assert [job.name for job in jobs] == [
        "inverse, n = 3,000", "forward, n = 3,000", "integrate, n = 3,000", "rollout, 20 x 8"
    ]  # fmt: skip
    for job in jobs:
        assert {"core", "copy", "NumPy", *sw.simd_levels()[:-1]} <= set(job.timings)
    assert contenders.goal("inverse, n = 1e5") in (4.5, 8.0, None)
    with pytest.raises(AssertionError, match="a liar"):
        contenders.agree("a liar", [1.0], [1.1])


@pytest.mark.parametrize("without_peers", [True, False], ids=["no peers", "those there are"])
def test_the_runner_prints_every_table(tmp_path: Path, without_peers: bool) -> None:
    pytest.importorskip("rich")
    if not (without_peers or any(map(find_spec, PEERS))):
        pytest.skip("no peer is installed: the same as without them")
    hide = (
        "import importlib.util as util\n"
        "find = util.find_spec\n"
        f"util.find_spec = lambda name, *rest: None if name in {PEERS} else find(name, *rest)\n"
    )
    code = (
        (hide if without_peers else "")
        + "import sys, runpy\n"
        + f"sys.path.insert(0, {str(BENCHES)!r})\n"
        + "from six_wheel.cli import benchmark\n"
        + "benchmark.SPAN = 1e-5\n"
        + "sys.argv = ['benches/run.py', *sys.argv[1:]]\n"
        + f"runpy.run_path({str(BENCHES / 'run.py')!r}, run_name='__main__')\n"
    )
    options = ["--markdown", "--rounds", "1", "--most", "1e4", "--ticks", "5"]
    done = subprocess.run([sys.executable, "-c", code, *options], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    for words in (
        "command: python benches/run.py --markdown", "**One call [ns]**", "| inverse into two arrays |",
        "| odometry update |", "| rollout, 4096 x 64 |", "| inverse, n = 1e3 |", "| inverse, n = 1e4 |",
        "| forward, out= | 1 kHz, caches flushed |", "**Peak memory",
    ):  # fmt: skip
        assert words in done.stdout
    if without_peers:
        assert 'numba is not installed and left out: pip install "six-wheel[bench]"' in done.stderr
        assert "numba:" not in done.stdout
