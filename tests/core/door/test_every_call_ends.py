"""Every public call ends within 0.3 s of Ctrl-C, or by itself, with objects as they were.

Walks all of them: with so many rows that they take long, with numbers that may make them long, and on objects
of many rows. A new call is walked the day it is written; one that takes a file, or another long thing that
no docstring tells how to make, needs a line in `long_calls.LONG`, and the walk says so.
"""

import contextlib
import math
import re
import time
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("scipy", reason="walks every public name, and calibration needs SciPy")

import six_wheel as sw
from tests.core.door.interrupting import BOUND, Interrupter, interrupter
from tests.core.door.long_calls import LONG, SHORT, many
from tests.objects.calls import BEGIN, Call, calls, documented, functions
from tests.objects.samples import samples, terrain

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]

LEADING = re.compile(r"shape \((\.\.\.|n \+ 1|(?:n|m|k)\b)")
LONG_ENOUGH = 0.5  # [s] of a call that is interrupted
TIMED = 0.1  # [s] from which on the time of a call is told by how it grows with its rows
MOST_ROWS = 1000 << 10
MOMENTS = (0.1, 0.6)  # shares of the time that the call takes
NUMBERS = (1e3, 1e6, 1e9, 1e15, 1e-3, 1e-6, 1e-9, 1e-15)
# Arguments with a leading axis that is no number of rows: of what, and why it stays short.
FIXED = {
    "body_slip": "at most six numbers",
    "BodySlip.compensate": "at most six numbers",
    "Rover.swerve": "modules, which must differ",
    "Rover.omni": "wheels, which must differ",
    "integrate": "walked by its rows of twists with one dt, as LONG",
    "Preintegrated.add": "as LONG: stamps have to follow each other",
    "FourAxle.simulate": "as LONG",
}
# Numbers of processes, and of samples that no memory may hold.
NOT_NUMBERS = {"calibrate": ("workers",), "simulate": ("rate",)}


@pytest.fixture(autouse=True, scope="module")
def fresh_samples() -> Iterator[None]:
    """The walk changes the objects that it calls: tests after it get others."""
    yield
    for kept in (samples, many, standing):
        kept.cache_clear()


@pytest.fixture(autouse=True)
def default_threads() -> Iterator[None]:
    """As they were: one of the calls sets their number."""
    before = sw.default_threads()
    yield
    sw.set_default_threads(before)


def rows_of(call: Call) -> list[str]:
    """Arguments of a call that may have any number of rows."""
    kinds = documented(call.function)
    return [name for name in call.arguments if name == "stand" or LEADING.search(kinds.get(name, ""))]


@lru_cache(maxsize=8)
def standing(kind: str, rows: int) -> Any:
    """A suspension settled so many times."""
    return samples()[kind].settle(terrain(), np.tile((0.2, 0.1, 0.3), (rows, 1)))


def grown(call: Call, rows: int) -> dict[str, Any]:
    """The ordinary arguments with so many rows."""
    kinds, found = documented(call.function), dict(call.arguments)
    for name in rows_of(call):
        if name == "stand":
            found[name] = standing(call.name.partition(".")[0], rows)
            continue
        axis = LEADING.search(kinds[name])
        assert axis is not None
        count, value = rows + (axis[1] == "n + 1"), np.asarray(call.arguments[name])
        each = value if axis[1] == "..." or not value.ndim else value[0]
        found[name] = np.broadcast_to(each, (count, *each.shape)).copy()
        if "stamps" in name or name == "times":
            found[name] = BEGIN + 0.01 * np.arange(count)
    return found


def taking_long(call: Callable[[int], Callable[[], object]]) -> tuple[Callable[[], object], float]:
    """A call with so many rows that it takes `LONG_ENOUGH`, or the most that are tried; and its time [s].

    From `TIMED` on its time is told by what more rows took more, and it is not run whole. Rows are doubled,
    so that what was made of them may be kept.
    """
    rows, fewer, before = 1000, 0, 0.0
    while True:
        run = call(rows)
        begin = time.monotonic()
        run()
        taken = time.monotonic() - begin
        if taken >= LONG_ENOUGH or rows >= MOST_ROWS:
            return run, taken
        each = (taken - before) / (rows - fewer)
        if fewer and taken >= TIMED and each > 0.0:
            enough = min(rows * doubled((LONG_ENOUGH - taken) / (each * rows) + 1.0), MOST_ROWS)
            if enough <= 16 * rows:
                return call(enough), taken + each * (enough - rows)
        fewer, before = rows, taken
        rows = min(MOST_ROWS, rows * min(max(doubled(TIMED / max(taken, 1e-6)), 2), 32))


def doubled(times: float) -> int:
    """The least power of two that is as many."""
    return 1 << max(math.ceil(math.log2(times)), 0)


def late(interrupt: Interrupter, run: Callable[[], object], taken: float) -> list[float]:
    """Times from Ctrl-C at several moments to the end of the call [s], of those beyond `BOUND`."""
    found = [interrupt.lateness(run, share * taken)[1] for share in MOMENTS]
    return [round(each, 2) for each in found if each > BOUND]


ROWS = {call.name: call for call in calls() if rows_of(call) and call.name not in FIXED}


@pytest.mark.parametrize("name", ROWS)
def test_calls_of_many_rows_end(name: str) -> None:
    call = ROWS[name]
    one = getattr(call.function, "__self__", None)

    def with_rows(rows: int) -> Callable[[], object]:
        given = grown(call, rows)
        return lambda: call(**given)

    before = repr(one)
    run, taken = taking_long(with_rows)
    with interrupter() as interrupt:
        assert late(interrupt, run, taken) == []
    assert repr(one) == before


def numbers_of(call: Call) -> Iterator[tuple[str, Any]]:
    """Arguments that are one number, each with numbers that may make a call long."""
    for name, kind in documented(call.function).items():
        if re.match(r"(float|int)\b", kind) and name not in NOT_NUMBERS.get(call.name, ()):
            for number in NUMBERS:
                if kind.startswith("float") or number >= 1.0:
                    yield name, number if kind.startswith("float") else int(number)


@pytest.mark.parametrize("call", [pytest.param(each, id=each.name) for each in calls()])
def test_calls_end_whatever_number_is_given(call: Call) -> None:
    with interrupter() as interrupt:
        for name, number in numbers_of(call):
            _, after = interrupt.lateness(lambda name=name, number=number: call(**{name: number}), BOUND)
            assert after <= BOUND, (name, number)


TABLES = [name for name, one in samples().items() if hasattr(one, "to_arrays")]
METHODS = ("to_arrays", "to_arrow", "to_pandas", "to_csv", "save")


@pytest.mark.parametrize("name", LONG)
def test_long_calls_end(name: str, tmp_path: Path) -> None:
    run, taken = taking_long(lambda rows: LONG[name](rows // 4, tmp_path))
    with interrupter() as interrupt:
        assert late(interrupt, run, taken) == []
    assert not [path for path in tmp_path.iterdir() if path.is_file() and path.name.startswith(".")]


def test_one_long_log_ends() -> None:
    """Signals were taken between logs alone: 20 million rows of one went on for 1.9 s."""
    twists = np.broadcast_to((0.1, 0.0, 0.01), (1 << 24, 3))

    def run() -> object:
        return sw.integrate(twists, 0.1)

    begin = time.monotonic()
    run()
    with interrupter() as interrupt:
        assert late(interrupt, run, time.monotonic() - begin) == []


@pytest.mark.parametrize("kind", TABLES)
def test_tables_end(kind: str, tmp_path: Path) -> None:
    for method in METHODS:
        if not hasattr(samples()[kind], method):
            continue
        for ending in (".csv", ".parquet") if method == "save" else (".csv",):
            path = [tmp_path / f"made{ending}"] if method in ("to_csv", "save") else []

            def with_rows(rows: int, method: str = method, path: list[Path] = path) -> Callable[[], object]:
                one = many(kind, min(rows, 1000 << 8))
                return lambda: getattr(one, method)(*path)

            run, taken = taking_long(with_rows)
            for each in path:
                each.unlink()
            with interrupter() as interrupt:
                assert late(interrupt, run, taken) == [], (method, ending)


def test_every_batch_call_of_the_benchmark_is_walked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(Path(__file__).parents[3] / "benches")
    import every_call

    assert set(every_call.public_calls()) - ROWS.keys() - FIXED.keys() - LONG.keys() == set()


def test_every_public_call_is_walked_or_short() -> None:
    """Calls in none of the walks answer at once, and have no argument that could make them long."""
    made = {call.name: call for call in calls()}
    tables = {f"{kind}.{method}" for kind in TABLES for method in METHODS}
    known = {name.partition(",")[0] for name in LONG} | tables | FIXED.keys() | ROWS.keys()
    unknown = []
    for name, _, function in functions():
        part = name.rpartition(".")[2]
        same = [each for each in known if each.endswith(f".{part}") and one_function(each, function)]
        if name in known or same:
            continue
        if name in made:  # numbers alone
            begin = time.monotonic()
            with contextlib.suppress(ValueError):
                made[name]()
            if time.monotonic() - begin < 10.0 * BOUND:
                continue
        unknown.append(name)
    assert set(unknown) - SHORT.keys() == set(), "calls that need a line in LONG, or a word in SHORT why not"


def one_function(name: str, function: Callable[..., Any]) -> bool:
    """True if a method is that of another class, which is walked."""
    kind, _, part = name.partition(".")
    other = getattr(type(samples().get(kind)), part, None)
    return getattr(other, "__func__", other) is getattr(function, "__func__", function)
