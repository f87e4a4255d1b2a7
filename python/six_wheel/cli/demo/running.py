"""`six-wheel demo`: two rovers along the recording, directly and through the controller, one over a yard of
rocks; pictures, tables and timing."""

from pathlib import Path
from typing import Any, Protocol

import numpy as np

from six_wheel import reference
from six_wheel._core import Rover
from six_wheel.cli.benchmark import Comparison, Timing, nanoseconds, round_robin
from six_wheel.cli.demo import figures
from six_wheel.cli.demo.control import NOISE, draw_control, drive_controlled
from six_wheel.cli.demo.control import rows as control_rows
from six_wheel.cli.demo.ground import COVER, drive_yard
from six_wheel.cli.demo.motion import ROVERS, DemoResult, drive_path, load_path, recorded_motion
from six_wheel.cli.report.ground import ground_facts
from six_wheel.plotting.ground.run import ground_figure, speeds_figure
from six_wheel.plotting.saving import save


class Console(Protocol):
    """Output of the report: a rich console, or anything else that prints."""

    def print(self, *objects: Any) -> None: ...


def run(directory: Path, *, console: Console) -> None:
    """Drive two rovers along the recording, directly and through the controller, and one over rocks.

    Pictures and tables go into `directory`.

    Parameters
    ----------
    directory : Path
        Made if it is not there.
    console : Console
        A rich console, or anything else with a ``print`` method.

    Raises
    ------
    ImportError
        If matplotlib is missing.
    OSError
        If the directory cannot be written.
    """
    times, poses = load_path()
    console.print(figures.introduce(recorded_motion(times, poses)))
    results = [drive_path(Rover.preset(key), name, times, poses) for key, name in ROVERS.items()]
    names = [result.name for result in results]
    console.print(
        figures.table("The same path, driven by two rovers", ["", *names], figures.summary(results))
    )

    directory.mkdir(parents=True, exist_ok=True)
    written = []
    for key, result in zip(ROVERS, results, strict=True):
        written.append(directory / f"demo_{key}.csv")
        figures.write_commands(result, written[-1])
    written.append(directory / "demo.png")
    save(figures.draw(results), written[-1])

    through = [drive_controlled(result, noise) for result in results for noise in (0.0, NOISE)]
    header = ["", *(result.name for result in through)]
    title = "The recording through the controller, a new command in every step"
    console.print(figures.table(title, header, control_rows(through)))
    written.append(directory / "demo_control.png")
    save(draw_control(through[-1]), written[-1])

    suspension, yard, over = drive_yard()
    console.print(figures.table("Perseverance over a yard of rocks", ["", ""], ground_facts(over)))
    title = f"Perseverance over rocks on {COVER:.0%} of the ground"
    for name, figure in (
        ("demo_ground.png", ground_figure(over, suspension, yard, title=title)),
        ("demo_ground_speeds.png", speeds_figure(over, suspension, title=title)),
    ):
        written.append(directory / name)
        save(figure, written[-1])

    header = ["", "six_wheel", "reference", "times faster"]
    console.print(figures.table("Time", header, time_against_reference(results[0])))
    console.print("Written: " + ", ".join(str(path) for path in written))


def time_against_reference(result: DemoResult) -> list[list[str]]:
    """Best times of the core and of `six_wheel.reference` on the twists of a drive, as rows of a table."""
    core, plain = result.rover, reference.Rover.like(result.rover)
    row = int(np.argmax(np.abs(result.twists[:, 2])))
    twist = tuple(result.twists[row].tolist())  # as in a control loop: three floats in, arrays out and back
    jobs = []
    for method, one, many in (
        ("inverse", [twist], [result.twists]),
        ("forward", core.inverse(twist), [result.steering, result.wheel_speeds]),
    ):
        few = [array[::40] for array in many]  # the reference takes rows one by one: some stand for all
        calls = (("one call", one, 1, one, 1), ("per row of a batch", many, len(many[0]), few, len(few[0])))
        for what, ours, our_rows, theirs, their_rows in calls:
            fast = Timing.of(getattr(core, method), *ours, items=our_rows)
            slow = Timing.of(getattr(plain, method), *theirs, items=their_rows)
            jobs.append(Comparison(f"{method}, {what}", {"core": fast, "reference": slow}))
    round_robin(jobs, 6)
    return [
        [job.name, *(f"{nanoseconds(time)} ns" for time in best), f"{best[1] / best[0]:,.0f}"]
        for job in jobs
        for best in [[timing.best for timing in job.timings.values()]]
    ]
