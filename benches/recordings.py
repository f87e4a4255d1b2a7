"""Gain of a calibration on recordings that were not fitted: ``python benches/recordings.py DATA``.

DATA is a folder of OptiOdom recordings, one folder per robot. Every session is left out once: the others
choose the parameters, fit them and measure the noise; the session left out is dead-reckoned with what they
found, its first pose given. With ``--alone`` it is the other way round: each session by itself fits and
measures, and all others are reckoned. ``--way 0.5`` reckons with dimensions halfway between the nominal ones
and those found: whether shrinking would pay. Prints two tables in Markdown.
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from six_wheel.calibration import Calibration
from six_wheel.kinematics.poses import Floats, between
from six_wheel.log_odometry.evaluation import absolute_error
from six_wheel.logs import WheelLog, optiodom
from six_wheel.robot_description.wheels_of_rover import with_wheels

TRUTH = np.array([1e-3, 1e-3, 1e-3])  # errors of motion capture [m, m, rad]
BOUND = 7.8147  # of chi-squared with three degrees of freedom, 95 %


@dataclass(frozen=True)
class Reckoned:
    """Root mean square position error [m] and normalised error squared of the end of one run."""

    error: float
    nees: float


def reckoned(rover: sw.Rover, log: WheelLog, noise: sw.Noise, **known: Any) -> Reckoned:
    """A run, its first pose given."""
    truth = log.truth
    assert truth is not None
    track = sw.dead_reckon(rover, log, noise=noise, start=truth.poses[0], residuals=False, **known)
    assert track.covariances is not None
    error = between(truth.poses[-1], track.poses[-1])
    heading = truth.poses[-1, 2]
    turn = np.array(
        [[np.cos(heading), np.sin(heading), 0], [-np.sin(heading), np.cos(heading), 0], [0, 0, 1]]
    )
    spread = turn @ track.covariances[-1] @ turn.T + np.diag(TRUTH**2)
    return Reckoned(
        absolute_error(track.poses, truth.poses).rmse, float(error @ np.linalg.solve(spread, error))
    )


def left_out(
    rovers: list[sw.Rover], logs: list[WheelLog], names: list[str] | None, alone: bool
) -> Iterator[tuple[list[int], Calibration]]:
    """The runs of every session with what the others say, or of all others with what it says `alone`."""
    how = {} if names is None else {"parameters": names, "cross_validation": False}
    for session in dict.fromkeys(log.session for log in logs):
        fitted = [number for number, log in enumerate(logs) if (log.session == session) == alone]
        result = sw.calibrate(rovers[fitted[0]], [logs[number] for number in fitted], **how)
        yield [number for number in range(len(logs)) if number not in fitted], result


def on_the_way(nominal: sw.Rover, found: sw.Rover, way: float) -> sw.Rover:
    """The rover whose wheels have gone this share of the way from one to the other."""
    numbers = ("x", "y", "radius", "heading")
    return with_wheels(
        nominal,
        [
            {name: (1.0 - way) * getattr(a, name) + way * getattr(b, name) for name in numbers}
            for a, b in zip(nominal.wheels, found.wheels, strict=True)
        ],
    )


def judged(
    folder: Path, names: list[str] | None = None, alone: bool = False, way: float = 1.0
) -> tuple[str, str]:
    """The rows of one robot in both tables."""
    paths = sorted(folder.rglob("*_run-*.csv"))
    rovers, logs = [optiodom.read_rover(path) for path in paths], [optiodom.read(path) for path in paths]
    guess = [reckoned(rover, log, sw.Noise()) for rover, log in zip(rovers, logs, strict=True)]
    left = list[int]()
    after, beside = list[Reckoned](), list[Reckoned]()
    chosen = dict[str, None]()
    for own, result in left_out(rovers, logs, names, alone):
        chosen[", ".join(result.chosen)] = None
        left += own
        for number in own:
            rover = result.rover if way == 1.0 else on_the_way(rovers[number], result.rover, way)
            after.append(reckoned(rover, logs[number], result.noise))
            beside.append(reckoned(rover, logs[number], **result.known))
    before = np.array([guess[number].error for number in left])
    errors = np.array([one.error for one in after])
    worse = int(np.sum(errors > before))
    return (
        f"| {folder.name} | {len(left)} | {'; '.join(chosen)} | {np.median(before):.4f} "
        f"| {np.median(errors):.4f} | {worse} |",
        f"| {folder.name} | {share(guess)} | {share(after)} | {share(beside)} |",
    )


def share(runs: list[Reckoned]) -> str:
    """Share of the ends within their 95 % bound, and the median of their normalised errors squared."""
    nees: Floats = np.array([run.nees for run in runs])
    return f"{100 * np.mean(nees <= BOUND):.0f} % | {np.median(nees):.2f}"


def main() -> None:
    """Both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("robots", nargs="*")
    parser.add_argument("--parameters", type=lambda text: text.split(","), help="a set, instead of choosing")
    parser.add_argument(
        "--alone", action="store_true", help="fit each session by itself, judge by all others"
    )
    parser.add_argument("--way", type=float, default=1.0, help="of the nominal dimensions to those found")
    arguments = parser.parse_args()
    folders = [each for each in sorted(arguments.data.iterdir()) if each.is_dir()]
    names = arguments.parameters
    wanted = [each for each in folders if not arguments.robots or each.name in arguments.robots]
    rows = [judged(each, names, arguments.alone, arguments.way) for each in wanted]
    print("| robot | runs | chosen | nominal [m] | left out [m] | runs worse |")
    print("|---|---|---|---|---|---|", *(row for row, _ in rows), sep="\n")
    head = "default noise, nominal", "measured, left out", "and dimensions"
    print(f"\n| robot | {' | '.join(f'{one} | median NEES' for one in head)} |")
    print("|---|---|---|---|---|---|---|", *(row for _, row in rows), sep="\n")


if __name__ == "__main__":
    main()
