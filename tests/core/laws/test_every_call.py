"""Every public call that takes a batch stands in the benchmark's table of cliffs."""

from pathlib import Path
from types import ModuleType

import pytest

from six_wheel.cli import benchmark

BENCHES = Path(__file__).parents[3] / "benches"


@pytest.fixture
def every_call(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.setattr(benchmark, "SPAN", 1e-5)
    monkeypatch.syspath_prepend(BENCHES)
    import every_call

    return every_call


def test_no_public_batch_call_is_missing(every_call: ModuleType) -> None:
    found = set(every_call.public_calls()) - set(every_call.NO_BATCH)
    listed = {row.call for row in every_call.listed(256)}
    assert found - listed == set(), "calls without a row in benches/every_call.py"
    assert listed - found == set(), "rows of calls that the walk does not find"


def test_every_row_can_be_timed(every_call: ModuleType) -> None:
    grid = every_call.measured(rows=256, rounds=1)
    assert len(grid.rows) == len(every_call.listed(256))
    assert all(row[2] for row in grid.rows)
