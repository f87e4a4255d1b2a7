"""No result depends on the rows beside it, their number or order, or on threads: bit for bit, in every call.

The calls are those of the benchmark's table, which is complete: see `test_every_call`.
"""

import inspect
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.cli import benchmark

BENCHES = Path(__file__).parents[3] / "benches"
ROWS = 96
# Rows that follow from one another, and a planner, which draws new samples in every step.
LOGS = {
    "differentiate", "integrate", "dead_reckon", "Odometry.run", "Odometry3.run", "Controller.run",
    "Preintegrated.add", "Mppi.step",
}  # fmt: skip


@pytest.fixture
def table(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.setattr(benchmark, "SPAN", 1e-5)
    monkeypatch.syspath_prepend(BENCHES)
    import every_call

    return every_call


def numbers(result: Any) -> list[np.ndarray]:
    """All arrays and numbers of a result, in a fixed order."""
    if isinstance(result, np.ndarray | float | int | np.generic):
        return [np.asarray(result)]
    if isinstance(result, tuple | list):
        return [each for part in result for each in numbers(part)]
    if isinstance(result, dict):
        return [each for part in result.values() for each in numbers(part)]
    names = [name for name, part in vars(type(result)).items() if inspect.isdatadescriptor(part)]
    parts = (getattr(result, name) for name in sorted(names))
    return [np.asarray(part) for part in parts if isinstance(part, np.ndarray)]


def are_the_same(one: list[np.ndarray], other: list[np.ndarray]) -> bool:
    pairs = zip(one, other, strict=True)
    return all(a.shape == b.shape and a.tobytes() == b.tobytes() for a, b in pairs if a.dtype != object)


def test_rows_alone_have_the_bits_of_a_batch(table: ModuleType) -> None:
    wrong = []
    for row in table.listed(ROWS):
        keywords = {name: value for name, value in row.keywords.items() if name != "out"}
        if row.call in LOGS or not all(isinstance(each, np.ndarray | str) for each in row.arguments[-1:]):
            continue
        count = next((len(each) for each in row.arguments if isinstance(each, np.ndarray)), None)

        def part(value: Any, rows: Any, count: int | None = count) -> Any:
            return value[rows] if isinstance(value, np.ndarray) and len(value) == count else value

        if count is None or any(type(each).__name__ == "SettledPose" for each in row.arguments):
            continue
        whole = numbers(row.function(*row.arguments, **keywords))
        orders = [slice(0, n) for n in (1, 2, 3, 5, 7, 8, 9, 17)]
        orders += [slice(k, k + 1) for k in range(0, count, 13)]
        for rows in [*orders, slice(None, None, -1), np.random.default_rng(1).permutation(count)]:
            given = [part(each, rows) for each in row.arguments]
            named = {name: part(value, rows) for name, value in keywords.items()}
            found = numbers(row.function(*given, **named))
            if not are_the_same(
                found, [each[rows] if each.ndim and len(each) == count else each for each in whole]
            ):
                wrong.append((row.call, row.label, rows))
    assert wrong == []


def test_no_result_depends_on_threads_or_on_earlier_calls(table: ModuleType) -> None:
    wrong = []
    for row in table.listed(ROWS):
        if row.call == "Mppi.step":
            continue
        keywords = {name: value for name, value in row.keywords.items() if name != "out"}
        whole = numbers(row.function(*row.arguments, **keywords))
        documented = "threads : int" in (inspect.getdoc(row.function) or "")
        ways: list[dict[str, int]] = [{}, *({"threads": n} for n in (1, 2, 3) if documented)]
        for way in ways:
            if not are_the_same(numbers(row.function(*row.arguments, **keywords, **way)), whole):
                wrong.append((row.call, row.label, way))
    assert wrong == []


@pytest.mark.parametrize("count", range(1, 21))
def test_logs_alone_have_the_bits_of_a_batch(count: int) -> None:
    """A log of under eight steps alone took another kernel than beside others: 2.8e-17 m of difference."""
    rover = sw.Rover.preset("perseverance")
    twists = np.random.default_rng(count).uniform(-1.0, 1.0, (9, count, 3))
    controls = twists * (0.1, 0.0, 0.1)
    calls = [
        (lambda rows: sw.integrate(rows, 0.1), twists),
        (lambda rows: sw.rollout(rows, 0.1, rover=rover), controls),
        (lambda rows: rover.rollout_cost(rows, 0.1), controls),
    ]
    for call, rows in calls:
        for part in (slice(0, 1), slice(0, 2), slice(3, 9), slice(None)):
            together = numbers(call(rows[part]))
            for k, log in enumerate(rows[part]):
                alone = [each[0] for each in numbers(call(log[None]))]
                assert are_the_same(alone, [each[k] for each in together])
