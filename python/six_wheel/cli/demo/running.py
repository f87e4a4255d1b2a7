"""`six-wheel demo`: two rovers along the recording, directly and through the controller, one over a yard of
rocks; pictures, tables and timing."""

from pathlib import Path
from typing import Any, Protocol

import numpy as np
from matplotlib.figure import Figure

from six_wheel import reference
from six_wheel._core import Rover
from six_wheel.cli.benchmark import Comparison, Timing, nanoseconds, round_robin
from six_wheel.cli.demo import control, figures
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

    Pictures and tables go into `directory`, which is made if it is not there, words to `console`. Raises
    `ImportError` if matplotlib is missing. Raises `OSError` if the directory cannot be written.
    """
    times, poses = load_path()
    console.print(figures.introduce(recorded_motion(times, poses)))
    results = [drive_path(Rover.preset(key), name, times, poses) for key, name in ROVERS.items()]
    title, names = "The same path, driven by two rovers", [result.name for result in results]
    console.print(figures.compare(title, names, list(map(figures.summary, results))))

    directory.mkdir(parents=True, exist_ok=True)
    written: list[Path] = []

    def keep(name: str, figure: Figure) -> None:
        written.append(directory / name)
        save(figure, written[-1])

    for key, result in zip(ROVERS, results, strict=True):
        written.append(directory / f"demo_{key}.csv")
        figures.write_commands(result, written[-1])
    keep("demo.png", figures.draw(results))

    through = [
        control.drive_controlled(result, noise) for result in results for noise in (0.0, control.NOISE)
    ]
    title = "The recording through the controller, a new command in every step"
    names = [result.name for result in through]
    console.print(figures.compare(title, names, list(map(control.summary, through))))
    keep("demo_control.png", control.draw_control(through[-1]))

    suspension, yard, over = drive_yard()
    console.print(figures.table("Perseverance over a yard of rocks", ["", ""], ground_facts(over)))
    title = f"Perseverance over rocks on {COVER:.0%} of the ground"
    keep("demo_ground.png", ground_figure(over, suspension, yard, title=title))
    keep("demo_ground_speeds.png", speeds_figure(over, suspension, title=title))

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
