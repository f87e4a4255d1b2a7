"""Any calls with any arguments, in a process of its own: ``python storm.py SEED SECONDS MEBIBYTES``.

Random dtype, order, overlap, size, threads, arguments that raise; several Python threads, under a limit of
memory. A call is right, or is refused by an error of the library, `MemoryError` or what its argument raised;
what is only read stays as it was. Prints how often which.
"""

import json
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np

import six_wheel as sw

SWERVE = sw.Rover.swerve([(0.4, 0.3), (0.4, -0.3), (-0.4, 0.3), (-0.4, -0.3)], 0.1)
ARM = sw.RockerBogie.preset("perseverance")
GROUND = sw.Terrain(np.round(0.2 * np.random.default_rng(1).normal(size=(60, 60)), 3), 1.0, (-20.0, -20.0))
ROWS = [0, 1, 2, 7, 31, 32, 33, 500, 20_001]
DTYPES = ["d", "d", "d", "f", "e", ">f8", "i4", "u8", "i1", "g", ">i2"]
ERRORS = [KeyboardInterrupt(), MemoryError("no room on the card"), RuntimeError("use .cpu() first")]
THREADS = 3

# Widths of what is read and of what is written, the most rows, and the call.
Call = Callable[..., Any]
CALLS: dict[str, tuple[list[int], list[int], int, Call]] = {
    "inverse": ([3], [4, 4], 10**6, lambda a, **k: SWERVE.inverse(a, **k)),
    "inverse, previous": ([3, 4], [4, 4], 10**6, lambda a, b, **k: SWERVE.inverse(a, previous=b, **k)),
    "forward": ([4, 4], [3], 10**6, lambda a, b, **k: SWERVE.forward(a, b, **k)),
    "project": ([3], [3], 10**6, lambda a, threads=1, **k: SWERVE.project(a, **k)),
    "admissible": ([3], [], 10**6, lambda a, threads=1: SWERVE.admissible(a)),
    "fit": ([4, 4], [], 500, lambda a, b, threads=1: SWERVE.fit(a, b).twist),
    "exp": ([3], [], 10**6, lambda a, threads=1: sw.exp(a, 0.5)),
    "compose": ([3, 3], [], 10**6, lambda a, b, threads=1: sw.compose(a, b)),
    "wrap_angle": ([3], [], 10**6, lambda a, threads=1: sw.wrap_angle(a)),
    "integrate": ([3], [], 10**6, lambda a, **k: sw.integrate(a, 0.1, **k)),
    "height": ([2], [], 10**6, lambda a, threads=1: GROUND.height_at(a)),
    "settle": ([3], [], 40, lambda a, **k: ARM.settle(GROUND, a, **k).z),
    "bounds": ([3], [], 500, lambda a, **k: ARM.bounds(GROUND, a, **k).roll),
    "traction": ([3, 3, 3], [], 40, lambda a, b, c, threads=1: ARM.traction(0.1, 0.1, a, b, c).wheel_speeds),
}  # fmt: skip


class Raises:
    """Raises when it is looked at."""

    def __init__(self, error: BaseException) -> None:
        self.error = error

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        raise self.error


class Interface:
    """Hands its memory over, and is no array itself."""

    def __init__(self, array: np.ndarray) -> None:
        self.__array_interface__ = array.__array_interface__
        self.array = array


class Storm:
    """The calls of one Python thread, on memory of its own."""

    def __init__(self, seed: list[int]) -> None:
        self.generator = np.random.default_rng(seed)
        self.memory = np.zeros(3_000_000)
        self.counts: Counter[str] = Counter()

    def chance(self, share: float) -> bool:
        return self.generator.random() < share

    def choice(self, values: list[Any]) -> Any:
        return values[self.generator.integers(len(values))]

    def view(self, rows: int, width: int) -> np.ndarray:
        """Somewhere in the memory, in some order."""
        order = self.choice(["C", "F", "every other", "backwards"])
        step = 2 if order == "every other" else 1
        start = int(self.generator.integers(0, 40))
        rows_of = self.memory[start:][: step * rows * width]
        if order == "F":
            return rows_of.reshape(width, rows).T
        array = rows_of.reshape(step * rows, width)[::step]
        return array[::-1, ::-1] if order == "backwards" else array

    def argument(self, rows: int, width: int) -> np.ndarray:
        """Small whole numbers, which any dtype holds."""
        numbers = self.generator.integers(0, 9, (rows, width)).astype(float)
        if self.chance(0.4):
            array = self.view(rows, width)
            array[...] = numbers
        else:
            array = numbers.astype(self.choice(DTYPES), order=self.choice(["C", "F"]))
        return array

    def handed_over(self, array: np.ndarray) -> Any:
        """The same numbers by another object."""
        if self.chance(0.1):
            return Interface(array)
        if self.chance(0.1) and array.dtype.char == "d" and array.dtype.isnative:
            return memoryview(array)
        return array.tolist() if self.chance(0.05) and 0 < len(array) < 1000 else array

    def once(self) -> None:
        name = self.choice(list(CALLS))
        read, written, most, call = CALLS[name]
        rows = min(self.choice(ROWS), most)
        arrays = [self.argument(rows, width) for width in read]
        # Views of one memory write over each other: what they hold now is what is meant.
        numbers, given = [np.array(array, float) for array in arrays], [self.handed_over(a) for a in arrays]
        options: dict[str, Any] = {"threads": int(self.choice([1, 1, 2, 5, 70, 4000]))}
        own: BaseException | None = None
        is_huge = False
        if self.chance(0.1):
            own = self.choice(ERRORS)
            given[self.generator.integers(len(given))] = Raises(own)
        elif self.chance(0.05):
            is_huge = True
            place = self.generator.integers(len(given))
            # Not even a byte for each row is there: 1e8 rows of `admissible` may well be answered in 3 GiB.
            shape = (int(10.0 ** self.generator.uniform(10, 13)), read[place])
            given[place] = np.broadcast_to(np.float64(1.0), shape)
        outs = [self.view(rows, width) if self.chance(0.5) else np.empty((rows, width)) for width in written]
        if outs and self.chance(0.6):
            options["out"] = tuple(outs) if len(outs) > 1 else outs[0]
        apart = [[not np.shares_memory(array, out) for out in outs] for array in arrays]
        before = [array.copy() for array in (*arrays, *outs)]
        try:
            found = call(*given, **options)
        except ValueError:
            outcome = "refused"
        except BaseException as error:
            if error is own:
                outcome = "raised by the argument"
            elif isinstance(error, MemoryError):
                outcome = "no memory"
            else:
                raise
        else:
            outcome = "answered"
            assert own is None, f"{name} has not asked the argument that raises"
            assert not is_huge, f"{name}, {shape} answered"
            expected = call(*numbers, **({"threads": 1} if "threads" in options else {}))
            pairs = zip(found, expected, strict=True) if isinstance(found, tuple) else [(found, expected)]
            for one, other in pairs:
                np.testing.assert_array_equal(np.asarray(one), np.asarray(other), f"{name}, {rows} rows")
        self.counts[outcome] += 1
        kept = len(arrays) + len(outs) if outcome != "answered" else len(arrays)
        for k, (array, was) in enumerate(zip((*arrays, *outs)[:kept], before, strict=False)):
            if outcome != "answered" or all(apart[k]):
                np.testing.assert_array_equal(array, was, f"{name} has changed what it read ({outcome})")


def main() -> None:
    import resource

    seed, seconds, mebibytes = int(sys.argv[1]), float(sys.argv[2]), int(sys.argv[3])
    storms = [Storm([seed, thread]) for thread in range(THREADS)]
    resource.setrlimit(resource.RLIMIT_AS, (mebibytes * 2**20,) * 2)
    end, failures = time.monotonic() + seconds, []

    def rage(storm: Storm) -> None:
        try:
            while time.monotonic() < end:
                storm.once()
        except BaseException as error:
            failures.append(f"{type(error).__name__}: {error}")

    threads = [threading.Thread(target=rage, args=(storm,)) for storm in storms]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    counts = sum((storm.counts for storm in storms), Counter())
    print(json.dumps({"counts": counts, "failures": failures}))


if __name__ == "__main__":
    main()
