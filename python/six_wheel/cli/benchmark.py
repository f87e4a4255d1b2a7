"""Speed of the compiled core on this machine, beside `six_wheel.reference`, the same in plain NumPy.

The timer of a call is here too, for the longer comparison under `benches`.
"""

import os
import platform
import statistics
import sys
import timeit
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from six_wheel import reference
from six_wheel._core import Rover, integrate, simd_levels

if TYPE_CHECKING:
    from rich.console import RenderableType

ROWS = 100_000
FEW_ROWS = 200  # for the reference, which takes a millisecond for ten rows
REPEATS = 20
SPAN = 0.005  # [s] a timing takes about as long: more than the clock resolves, less than a busy core's turn


# --- timing ----------------------------------------------------------------------------------------------


class Timing:
    """A statement that is timed again and again.

    `names` are those in it, and times are per item of the `items` that it treats; the time of the part
    `baseline` is subtracted.
    """

    def __init__(
        self, statement: str, names: Mapping[str, Any], *, items: int = 1, baseline: str = "pass"
    ) -> None:
        names = dict(names)
        self._timer, self._empty = (timeit.Timer(each, globals=names) for each in (statement, baseline))
        # To do it once, untimed; gives its value.
        self.once: Callable[[], Any] = eval(f"lambda: {statement}", names)
        self._number = 0
        self._loop = float("inf")
        self._times: list[float] = []
        self.items = items

    @classmethod
    def of(cls, function: Callable[..., Any], *arguments: Any, items: int = 1, **keywords: Any) -> Self:
        """Timing of a call. Every argument has its own name: unpacking takes as long as a short call."""
        values = {f"argument_{k}": value for k, value in enumerate(arguments)}
        words = [*values, *(f"{name}={name}" for name in keywords)]
        return cls(f"call({', '.join(words)})", {"call": function, **values, **keywords}, items=items)

    def measure(self) -> None:
        """Time it as often as fills `SPAN`, and the loop around it."""
        if not self._number:
            self._timer.timeit(1)  # the first time may compile, or fault pages in
            self._number = max(1, round(SPAN / max(min(self._timer.repeat(3, 1)), 1e-7)))
        self._times.append(self._timer.timeit(self._number) / self._number)
        # The least of its own: what else the machine did meanwhile must not be taken off the time of a call.
        self._loop = min(self._loop, self._empty.timeit(self._number) / self._number)

    @property
    def best(self) -> float:
        """Least time per item so far [s], without the loop."""
        return (min(self._times) - self._loop) / self.items

    @property
    def median(self) -> float:
        """Median time per item [s], without the loop."""
        return (statistics.median(self._times) - self._loop) / self.items

    def __len__(self) -> int:
        """Number of times it was timed."""
        return len(self._times)


@dataclass
class Comparison:
    """The same job done by several, by name."""

    name: str
    timings: dict[str, Timing] = field(default_factory=dict)


def round_robin(
    jobs: Sequence[Comparison], rounds: int, *, progress: Callable[[int, int], None] | None = None
) -> None:
    """Time everyone once, then once again: a machine that slows down slows all alike.

    `progress` is called after every timing with how many are done and how many there are.
    """
    everyone = [timing for job in jobs for timing in job.timings.values()]
    for turn in range(rounds):
        for number, timing in enumerate(everyone, start=1):
            timing.measure()
            if progress is not None:
                progress(turn * len(everyone) + number, rounds * len(everyone))


# --- tables ----------------------------------------------------------------------------------------------


@dataclass
class Grid:
    """A table of text, for a terminal or a page."""

    title: str
    headings: Sequence[str]
    rows: list[Sequence[str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def rich(self) -> "RenderableType":
        """The grid as a table that rich draws."""
        from rich.table import Table

        shown = Table(title=self.title, title_justify="left", caption="\n".join(self.notes) or None)
        shown.caption_justify = "left"
        for k, heading in enumerate(self.headings):
            shown.add_column(heading, justify="right" if k else "left")
        for row in self.rows:
            shown.add_row(*row)
        return shown

    def markdown(self) -> str:
        """The grid as a table in Markdown."""
        lines = [f"**{self.title}**", "", "| " + " | ".join(self.headings) + " |"]
        lines.append("|" + "|".join("---" if not k else "---:" for k in range(len(self.headings))) + "|")
        lines += ["| " + " | ".join(row) + " |" for row in self.rows]
        return "\n".join([*lines, *(f"\n{note}" for note in self.notes)])


def nanoseconds(seconds: float) -> str:
    """A time in nanoseconds, to three digits."""
    value = 1e9 * seconds
    return f"{value:.3g}" if value < 100 else f"{value:,.0f}"


@cache
def machine() -> dict[str, str]:
    """Properties of this machine that the figures depend on, by name."""
    processor = platform.processor() or platform.machine()
    with suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                processor = line.partition(":")[2].strip()
                break
    return {
        "processor": f"{processor} ({platform.machine()}), {os.cpu_count()} cores",
        "vectors": simd_levels()[-1],
        "Python": f"{sys.implementation.name} {platform.python_version()}",
        "NumPy": np.__version__,
    }


# --- the short form --------------------------------------------------------------------------------------


def jobs() -> list[Comparison]:
    """Jobs that `six-wheel bench` times: one call as in a control loop, and a batch."""
    core = Rover.six_wheel(
        front_to_middle=0.5, middle_to_rear=0.5, track_width=0.8, middle_track_width=0.9, wheel_radius=0.15
    )
    plain = reference.Rover.like(core)
    twist = (0.5, 0.0, 0.3)
    twists = np.zeros((ROWS, 3))  # vy = 0 and steering over +-90 degrees: the rover can make every one
    twists[:, 0], twists[:, 2] = np.random.default_rng(1).uniform(-1.0, 1.0, (2, ROWS))
    one, many = core.inverse(twist), core.inverse(twists)
    few = min(FEW_ROWS, ROWS)
    few_twists, few_joints = twists[:few], tuple(array[:few] for array in many)
    back, poses = np.empty((ROWS, 3)), np.empty((ROWS + 1, 3))
    batch = f"batch of {ROWS:,} rows, per row"
    ours, theirs = partial(Timing.of, items=ROWS), partial(Timing.of, items=few)
    timings = {
        "inverse, one call": (Timing.of(core.inverse, twist), Timing.of(plain.inverse, twist)),
        "inverse, one call, out=": (Timing.of(core.inverse, twist, out=one), Timing.of(plain.inverse, twist)),
        "forward, one call": (Timing.of(core.forward, *one), Timing.of(plain.forward, *one)),
        f"inverse, {batch}": (ours(core.inverse, twists, out=many), theirs(plain.inverse, few_twists)),
        f"forward, {batch}": (ours(core.forward, *many, out=back), theirs(plain.forward, *few_joints)),
        f"integrate, {batch}": (
            ours(integrate, twists, 0.01, out=poses),
            theirs(reference.integrate, few_twists, 0.01),
        ),
    }
    return [Comparison(name, {"core": fast, "reference": slow}) for name, (fast, slow) in timings.items()]


def measure(*, progress: Callable[[int, int], None] | None = None) -> list[Comparison]:
    """Time every job on both sides, in turn, `REPEATS` times; `progress` as in `round_robin`."""
    todo = jobs()
    round_robin(todo, REPEATS, progress=progress)
    return todo


def table(results: Sequence[Comparison]) -> "RenderableType":
    """The results as a table for a rich console."""
    facts = ", ".join(f"{name} {value}" for name, value in machine().items())
    grid = Grid(f"Best of {REPEATS}; {facts}", ["job", "core [ns]", "reference [ns]", "ratio"])
    for job in results:
        core, plain = (job.timings[name].best for name in ("core", "reference"))
        grid.rows.append([job.name, nanoseconds(core), nanoseconds(plain), f"{plain / core:,.0f}"])
    return grid.rich()
