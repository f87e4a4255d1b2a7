"""How fast the compiled core is on this machine, beside the plain Python of `six_wheel.reference`."""

import os
import platform
import timeit
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from six_wheel import _core, reference

if TYPE_CHECKING:
    from rich.console import RenderableType

ROWS = 100_000
FEW_ROWS = 200  # for the reference, which takes a millisecond for ten rows
REPEATS = 5
SPAN = 0.02  # [s] a timing takes about as long: far more than the clock resolves


@dataclass
class Job:
    """A call on either side, the rows each of them treats, and the best time per row so far [s]."""

    name: str
    core: Callable[[], float]
    reference: Callable[[], float]
    rows: int = 1
    core_time: float = float("inf")
    reference_time: float = float("inf")


def best_of(function: Callable[..., Any], *arguments: Any, repeat: int = 1, **keywords: Any) -> float:
    """Shortest time of one call in `repeat` timings [s]; each timing calls as often as fills `SPAN`."""
    # Every argument is a name of its own: unpacking a tuple would cost as much as a short call.
    values = {f"argument_{k}": value for k, value in enumerate(arguments)}
    words = [*values, *(f"{name}={name}" for name in keywords)]
    timer = timeit.Timer(f"call({', '.join(words)})", globals={"call": function, **values, **keywords})
    number = max(1, round(SPAN / max(timer.timeit(1), 1e-7)))
    return min(timer.repeat(repeat, number)) / number


def jobs() -> list[Job]:
    """What is timed: one call as in a control loop, and a batch."""
    core = _core.Rover.six_wheel(d1=0.4, d2=0.5, d3=0.5, d4=0.45, wheel_radius=0.15)
    plain = reference.Rover.like(core)
    twist = (0.5, 0.0, 0.3)
    twists = np.zeros((ROWS, 3))  # vy = 0 and steering over +-90 degrees: the rover can make every one
    twists[:, 0], twists[:, 2] = np.random.default_rng(1).uniform(-1.0, 1.0, (2, ROWS))
    one, many, few = core.inverse(twist), core.inverse(twists), core.inverse(twists[:FEW_ROWS])
    back, poses = np.empty((ROWS, 3)), np.empty((ROWS + 1, 3))
    slow_inverse = partial(best_of, plain.inverse, twist)
    slow_batch = partial(best_of, plain.inverse, twists[:FEW_ROWS])
    slow_integrate = partial(best_of, reference.integrate, twists[:FEW_ROWS], 0.01)
    return [
        Job("inverse, one call", partial(best_of, core.inverse, twist), slow_inverse),
        Job("inverse, one call, out=", partial(best_of, core.inverse, twist, out=one), slow_inverse),
        Job("forward, one call", partial(best_of, core.forward, *one), partial(best_of, plain.forward, *one)),
        Job("inverse, batch", partial(best_of, core.inverse, twists, out=many), slow_batch, ROWS),
        Job(
            "forward, batch",
            partial(best_of, core.forward, *many, out=back),
            partial(best_of, plain.forward, *few),
            ROWS,
        ),
        Job(
            "integrate, batch",
            partial(best_of, _core.integrate, twists, 0.01, out=poses),
            slow_integrate,
            ROWS,
        ),
    ]


def measure(*, progress: Callable[[int, int], None] | None = None) -> list[Job]:
    """Time every job on both sides, in turn, and keep the best of `REPEATS`.

    Parameters
    ----------
    progress : callable, optional
        Called after every job with how many timings are done and how many there are.
    """
    todo = jobs()
    for turn in range(REPEATS):
        # Core and reference one after the other: a machine that slows down slows both.
        for number, job in enumerate(todo, start=1):
            job.core_time = min(job.core_time, job.core() / job.rows)
            job.reference_time = min(job.reference_time, job.reference() / min(job.rows, FEW_ROWS))
            if progress is not None:
                progress(turn * len(todo) + number, REPEATS * len(todo))
    return todo


def table(results: list[Job]) -> "RenderableType":
    """The results as a table for a rich console."""
    from rich.table import Table

    machine = f"{platform.machine()}, {os.cpu_count()} processors"
    shown = Table(
        title=f"Best of {REPEATS} on {machine}, Python {platform.python_version()}, NumPy {np.__version__}",
        title_justify="left",
    )
    shown.add_column("job")
    for heading in ("core [ns]", "plain Python [ns]", "ratio"):
        shown.add_column(heading, justify="right")
    for job in results:
        core, plain = 1e9 * job.core_time, 1e9 * job.reference_time
        name = job.name if job.rows == 1 else f"{job.name} of {job.rows:,} rows, per row"
        shown.add_row(
            name, f"{core:.3g}" if core < 100 else f"{core:,.0f}", f"{plain:,.0f}", f"{plain / core:,.0f}"
        )
    return shown
