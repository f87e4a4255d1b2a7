"""The tables: the core and its peers in one run, in turn, with ratios and goals.

python benches/run.py [--markdown] [--only calls batches every ...] [--rounds 30] [--most 1e7]
"""

import argparse
import os
import sys
import time

# One thread each, unless said otherwise: before NumPy looks.
for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import contenders  # noqa: E402
import every_call  # noqa: E402
import ground  # noqa: E402
import latency  # noqa: E402
import memory  # noqa: E402
import planner  # noqa: E402

from six_wheel.cli.benchmark import Grid, machine, nanoseconds, round_robin  # noqa: E402

PARTS = ("calls", "batches", "every", "ground", "planner", "growth", "latency", "memory")
CALLS = ("core", "numba", "plain Python", "wpimath, bare", "wpimath", "NumPy", "reference")
BATCHES = ("numba, blocked", "numba", "NumPy, tuned", "NumPy", "reference")


def shown(job, name):
    timing = job.timings.get(name)
    return nanoseconds(timing.best) if timing else ""


def times(job, name, other):
    """Time of `name` in times of `other`."""
    if name not in job.timings or other not in job.timings:
        return ""
    return f"{job.timings[name].best / job.timings[other].best:.2g}"


def against_goal(job):
    """The goal and whether it is reached."""
    goal = contenders.goal(job.name)
    if goal is None:
        return ["", ""]
    if "core" not in job.timings:
        return [f"{goal:g}", "not here yet"]
    taken = 1e9 * job.timings["core"].best
    return [f"{goal:g}", "reached" if taken <= goal else f"{taken / goal:.2g} x"]


def one_call(rounds, progress):
    """Table one."""
    jobs = contenders.calls()
    round_robin(jobs, rounds, progress=progress)
    grid = Grid("One call [ns]", ["job", "core", "goal", "", "core / numba", *CALLS[1:]])
    for job in jobs:
        ratio = times(job, "core", "numba")
        grid.rows.append(
            [job.name, shown(job, "core"), *against_goal(job), ratio, *(shown(job, n) for n in CALLS[1:])]
        )
        if "core, out=" in job.timings:
            grid.rows.append(
                [f"{job.name}, out=", shown(job, "core, out="), *[""] * (len(grid.headings) - 2)]
            )
    grid.notes.append(
        "Net of the loop. wpimath: a swerve module at every wheel; bare calls take and return its own "
        "objects, the others floats."
    )
    return grid


def whole_batches(rounds, progress):
    """Table two, and each level of vectors."""
    jobs = contenders.batches()
    round_robin(jobs, rounds, progress=progress)
    others = [level for level in reversed(contenders.LEVELS) if level != contenders.BEST]
    headings = [
        "job",
        f"core ({contenders.BEST})",
        "goal",
        "",
        *others,
        "copy",
        "core / numba, blocked",
        *BATCHES,
    ]
    grid = Grid("Batches [ns per item], one thread, outputs reused", headings)
    for job in jobs:
        levels = [shown(job, level) for level in others]
        peers = [shown(job, name) for name in BATCHES]
        ratio = times(job, "core", "numba, blocked")
        grid.rows.append(
            [job.name, shown(job, "core"), *against_goal(job), *levels, shown(job, "copy"), ratio, *peers]
        )
    grid.notes.append(
        "copy: NumPy moving as many bytes as the job's items have (half read, half written). "
        "reference: its first 200 rows. The peers check nothing and add up without compensation."
    )
    return grid


def growing(most, rounds, progress):
    """The same job for ever more rows."""
    jobs = contenders.growth(most)
    round_robin(jobs, rounds, progress=progress)
    others = [level for level in reversed(contenders.LEVELS[1:]) if level != contenders.BEST]
    headings = [
        "job",
        f"core ({contenders.BEST})",
        "goal",
        "",
        *others,
        "core, 2 threads",
        "1 / 2 threads",
        "copy",
    ]
    grid = Grid("Growth [ns per item], outputs reused", [*headings, "numba, blocked", "numba"])
    for job in jobs:
        names = ["core", *others, "core, 2 threads"]
        first, *rest = [shown(job, name) for name in names]
        ratio = times(job, "core", "core, 2 threads")
        tail = [shown(job, name) for name in ("copy", "numba, blocked", "numba")]
        grid.rows.append([job.name, first, *against_goal(job), *rest, ratio, *tail])
    best = [job.timings["core"].best for job in jobs]
    grid.notes.append(
        f"Largest over smallest time per item: {max(best) / min(best):.2g} (goal: 1.5). "
        "Goal of two threads: 1.8 times one until memory is the limit."
    )
    return grid


def worst_cases(ticks):
    """Latencies of one call."""
    grid = Grid("Latency of one call [ns]", ["job", "loop", *latency.SHARES, "p99.9 / p50"])
    for (job, manner), taken in latency.distributions(ticks).items():
        ratio = f"{taken['p99.9'] / taken['p50']:.2g}" if taken["p50"] else ""
        grid.rows.append([job, manner, *(f"{value:,.0f}" for value in taken.values()), ratio])
    grid.notes.append(
        f"{ticks:,} calls each ({10 * ticks:,} back to back), through a lambda, net of the clock; "
        "'nothing' is an empty lambda: what the machine itself adds."
    )
    return grid


def extra_memory(most):
    """Peak memory beside inputs and outputs."""
    grid = Grid(f"Peak memory beyond inputs and outputs, n = {most:,} [MiB]", ["job", "memory", "goal"])
    results = memory.beyond(most)
    for job, size in (results or {}).items():
        grid.rows.append([job, f"{size:.1f}", "16"])
    if results is None:
        grid.notes.append("This system does not say what a process took at most.")
    return grid


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--markdown", action="store_true", help="tables as Markdown, not for a terminal")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS, help="some of the tables")
    parser.add_argument("--rounds", type=int, default=30, help="timings of each; a third of them for growth")
    parser.add_argument(
        "--most", type=lambda text: int(float(text)), default=10**7, help="rows of the largest batch"
    )
    parser.add_argument("--ticks", type=int, default=2000, help="calls of a latency distribution")
    options = parser.parse_args()

    from rich.console import Console

    console = Console(markup=False, highlight=False, width=None if sys.stdout.isatty() else 200)
    words = Console(stderr=True, markup=False, highlight=False)
    for name in contenders.MISSING:
        words.print(f'{name} is not installed and left out: pip install "six-wheel[bench]"')
    parts = {
        "calls": lambda tell: one_call(options.rounds, tell),
        "batches": lambda tell: whole_batches(options.rounds, tell),
        "every": lambda tell: every_call.measured(rounds=options.rounds, progress=tell),
        "ground": lambda tell: ground.measured(max(options.rounds // 3, 1), tell),
        "planner": lambda tell: planner.measured(options.rounds, tell),
        "growth": lambda tell: growing(options.most, max(options.rounds // 3, 1), tell),
        "latency": lambda tell: worst_cases(options.ticks),
        "memory": lambda tell: extra_memory(options.most),
    }
    facts = {
        "command": " ".join(["python benches/run.py", *sys.argv[1:]]),
        **machine(),
        **contenders.versions(),
        "date": time.strftime("%Y-%m-%d"),
        "least of": f"{options.rounds} timings (ground and growth: a third)",
    }
    heading = "; ".join(f"{name}: {value}" for name, value in facts.items())
    print(heading, flush=True) if options.markdown else console.print(heading)
    for part in options.only:
        with words.status(part) as status:
            grid = parts[part](lambda done, total, part=part: status.update(f"{part}: {done} of {total}"))
        print(f"\n{grid.markdown()}", flush=True) if options.markdown else console.print(grid.rich())


if __name__ == "__main__":
    main()
