"""Memory of results that are gone is kept for the next ones: no result shows it, no program runs out."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from tests.core.door.test_memory import limited

BENCHES = Path(__file__).parents[3] / "benches"
ROWS = 3000
ROVER = sw.Rover.preset("perseverance")
TWISTS = np.tile((0.1, 0.0, 0.05), (ROWS, 1))


def arrays(result: Any) -> Iterator[np.ndarray]:
    """All arrays of a result, which may be a tuple or have names for them."""
    if isinstance(result, np.ndarray):
        yield result
    elif isinstance(result, tuple):
        for part in result:
            yield from arrays(part)
    elif type(result).__module__.startswith("six_wheel"):
        for name in dir(result):
            if not name.startswith("_") and isinstance(part := getattr(result, name), np.ndarray):
                yield part


def spoil(result: Any) -> int:
    """Writes over a result that is about to be gone; how many of its arrays are of a size that is kept."""
    own = [array for array in arrays(result) if array.flags.writeable and array.dtype == np.float64]
    for array in own:
        array.fill(-1.234e77)
    return sum(array.nbytes >= 2**16 for array in own)


def test_no_result_shows_what_was_written_there_before(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(BENCHES)
    import every_call

    seen = 0
    for row in every_call.listed(ROWS):
        if row.call == "Mppi.step":  # goes on from the step before
            continue
        keywords = {name: value for name, value in row.keywords.items() if name != "out"}
        first = [array.copy() for array in arrays(row.function(*row.arguments, **keywords))]
        seen += spoil(row.function(*row.arguments, **keywords))
        for expected, got in zip(first, arrays(row.function(*row.arguments, **keywords)), strict=True):
            np.testing.assert_array_equal(got, expected, err_msg=f"{row.call}, {row.label}")
    assert seen > 20


def test_results_own_their_memory_and_what_others_make_is_untouched() -> None:
    steering, _ = ROVER.inverse(TWISTS)
    assert steering.flags.owndata
    assert steering.base is None
    before = steering[:5].copy()
    steering.resize((5, 4), refcheck=False)
    assert np.array_equal(steering, before)
    steering.resize((2 * ROWS, 4), refcheck=False)
    assert np.array_equal(steering[:5], before)
    names = sys.modules[
        "numpy._core.multiarray"
        if np.lib.NumpyVersion(np.__version__) >= "2.0.0"
        else "numpy.core.multiarray"
    ]
    assert names.get_handler_name(ROVER.inverse(TWISTS)[0]) == "six_wheel"
    assert names.get_handler_name(ROVER.inverse(TWISTS[:5])[0]) == "default_allocator"
    assert names.get_handler_name(np.empty(2**16)) == names.get_handler_name() == "default_allocator"
    with pytest.raises(ValueError, match="must be finite"):
        ROVER.inverse(np.full_like(TWISTS, np.nan))
    assert names.get_handler_name() == "default_allocator"


def test_what_is_kept_is_given_back_where_memory_runs_out() -> None:
    """32 MB may be kept: all of it serves whoever asks for rooms of another size under a limit of memory."""
    result = limited(
        """
        import resource
        from pathlib import Path
        import numpy as np
        import six_wheel as sw
        rover = sw.Rover.preset("perseverance")
        few, many = np.zeros((80_000, 3)), np.zeros((160_000, 3))
        def limit(room):
            used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
            resource.setrlimit(resource.RLIMIT_AS, (used + room, resource.RLIM_INFINITY))
        held = [rover.project(few) for _ in range(16)]  # 1.92 MB each
        del held
        limit(8_000_000)
        held = [rover.project(many) for _ in range(8)]  # 3.84 MB each
        print(len(held))
        """
    )
    assert result.stdout.strip() == "8", result.stderr


@pytest.mark.slow
def test_what_is_kept_is_bounded() -> None:
    """A gigabyte of results that lived at once leaves 32 MB behind."""
    result = limited(
        """
        import resource
        from pathlib import Path
        import numpy as np
        import six_wheel as sw
        rover = sw.Rover.preset("perseverance")
        twists = np.zeros((400_000, 3))
        def resident():
            return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()
        rover.project(twists)
        before = resident()
        held = [rover.project(twists) for _ in range(100)]  # 9.6 MB each
        assert resident() - before > 500e6
        del held
        print(resident() - before)
        """
    )
    assert int(result.stdout) < 40e6, result.stderr
