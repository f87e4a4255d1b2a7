"""An argument keeps the numbers it had when it was read, whatever the code of a later one does to it.

Code of a later argument once resized an array that was read already: the kernel read freed memory.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from six_wheel.cli import benchmark
from tests.core.laws.test_rows_alone import are_the_same, numbers

BENCHES = Path(__file__).parents[3] / "benches"


def resize(array: np.ndarray) -> None:
    array.resize((1,) * array.ndim, refcheck=False)


def write(array: np.ndarray) -> None:
    array[...] = 7.0


def reshape(array: np.ndarray) -> None:
    array.shape = (array.size,)


def free(array: np.ndarray) -> None:
    array.__setstate__((1, (2,), np.dtype("d"), False, np.full(2, 7.0).tobytes()))


class Hostile:
    """Has the numbers of one array, and does something to another one first."""

    def __init__(self, numbers: np.ndarray, victim: np.ndarray, harm: Callable[[np.ndarray], None]) -> None:
        self.numbers, self.victim, self.harm = numbers, victim, harm

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        self.harm(self.victim)
        return self.numbers


def pairs(row: Any) -> Iterator[tuple[int, int]]:
    """An argument and a later one, both arrays."""
    places = [k for k, each in enumerate(row.arguments) if isinstance(each, np.ndarray)]
    return ((first, later) for first in places for later in places if first < later)


def answers(found: Any, function: Callable[..., Any], arguments: list[Any], keywords: dict[str, Any]) -> bool:
    """True if these arguments give this result."""
    try:
        return are_the_same(found, numbers(function(*arguments, **keywords)))
    except (ValueError, TypeError):
        return False


@pytest.mark.filterwarnings("ignore::six_wheel.kinematics.errors.SuspiciousReadingsWarning")
@pytest.mark.parametrize("harm", [resize, write, reshape, free])
@pytest.mark.parametrize("rows", [4, 2000])
def test_every_call_keeps_what_it_has_read(
    harm: Callable[[np.ndarray], None], rows: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(benchmark, "SPAN", 1e-5)
    monkeypatch.syspath_prepend(BENCHES)
    import every_call

    wrong = []
    for row in every_call.listed(rows):
        if row.call == "Mppi.step":
            continue
        keywords = {name: value for name, value in row.keywords.items() if name != "out"}
        wanted = numbers(row.function(*row.arguments, **keywords))
        for first, later in pairs(row):
            given = [np.array(each) if isinstance(each, np.ndarray) else each for each in row.arguments]
            given[later] = Hostile(given[later], given[first], harm)
            try:
                found = numbers(row.function(*given, **keywords))
            except (ValueError, TypeError):
                continue
            # An argument that is read after the other one was read as it was then.
            harmed = [each.numbers if isinstance(each, Hostile) else each for each in given]
            if not are_the_same(found, wanted) and not answers(found, row.function, harmed, keywords):
                wrong.append((row.call, row.label, first, later))
    assert wrong == []
