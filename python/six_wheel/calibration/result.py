"""Result of a calibration: values with their uncertainty, errors before and after, a report."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from six_wheel._core import Noise, Rover
from six_wheel.calibration.cross_validation import CrossValidation
from six_wheel.calibration.estimates import Estimate, RunErrors, Windows
from six_wheel.calibration.gyroscope.noise import MeasuredGyroscope
from six_wheel.calibration.noise import MeasuredNoise
from six_wheel.calibration.observability import Observability
from six_wheel.kinematics.objects.notebooks import Shown
from six_wheel.kinematics.poses import Floats


@dataclass(frozen=True, eq=False)
class Calibration(Shown):
    """A calibrated rover and how far it can be believed.

    Attributes
    ----------
    rover, nominal : Rover
        With the values found, and as it was given.
    parameters : tuple of Estimate
        One per number, in the order of `covariance`.
    covariance : ndarray, shape (p, p)
        Of the values; rows of what is not identified cover only what is.
    widened : ndarray, shape (p, p)
        The same, so that a normal distribution has as wide intervals of 95 % as Student's t with the degrees
        of freedom that there were.
    dimensions : ndarray, shape (k, wheels, 9)
        Uncertainty of `rover` according to `widened`, for ``Odometry(rover, noise, dimensions=...)``.
    confidence : float
        Of the intervals.
    basis : str
        Unit that was left out one after another for the intervals.
    observability : Observability
        Parameters that the data do not tell.
    windows : Windows
        The residuals.
    runs : tuple of RunErrors
        Every run before and after, as fitted.
    cross_validation : CrossValidation or None
        Errors on drives left out of the fit.
    sensor : ndarray, shape (3,)
        Place in the body of `rover` of the point that the truth follows [m, m, rad].
    time_offset : float
        Stamp of the truth less that of the log [s].
    chosen : tuple of str
        Names of the parameters as asked for, or as cross-validation chose them.
    loss : str
    converged : bool
    measured_noise : MeasuredNoise or None
        Noise of dead reckoning with `rover`, with intervals and their grounds.
    slips : tuple of str
        Stretches in which drives slipped and were left out, a sentence for each log.
    gyroscope : MeasuredGyroscope or None
        Errors of the gyroscope of the logs; None where there is none, or the rover never stands for a second.
    """

    rover: Rover
    nominal: Rover
    parameters: tuple[Estimate, ...]
    covariance: Floats
    widened: Floats
    dimensions: Floats
    confidence: float
    basis: str
    observability: Observability
    windows: Windows
    runs: tuple[RunErrors, ...]
    cross_validation: CrossValidation | None
    sensor: Floats
    time_offset: float
    chosen: tuple[str, ...] = field(default=())
    loss: str = "soft_l1"
    converged: bool = True
    measured_noise: MeasuredNoise | Any = None
    slips: tuple[str, ...] = ()
    gyroscope: MeasuredGyroscope | None = None

    @property
    def noise(self) -> Noise:
        """Measured noise, for ``Odometry(result.rover, result.noise)``; the default if none was measured."""
        return Noise() if self.measured_noise is None else self.measured_noise.noise

    @property
    def known(self) -> dict[str, Any]:
        """Uncertainty of dimensions and noise, each apart: ``Odometry(result.rover, **result.known)``."""
        measured = self.measured_noise
        noise, wheels = (Noise(), None) if measured is None else (measured.beside, measured.wheel_noise)
        known = {"noise": noise, "wheel_noise": wheels, "dimensions": self.dimensions}
        return known if self.gyroscope is None else known | {"gyroscope": self.gyroscope.known}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(one.name for one in self.parameters)

    @property
    def values(self) -> Floats:
        """Values found, shape (p,)."""
        return np.array([one.value for one in self.parameters])

    @property
    def std(self) -> Floats:
        """Their standard deviations, shape (p,); NaN where one is not identified."""
        return np.array([one.std for one in self.parameters])

    @property
    def intervals(self) -> Floats:
        """Their intervals, shape (p, 2)."""
        return np.array([one.interval for one in self.parameters]).reshape(-1, 2)

    def __getitem__(self, name: str) -> Estimate:
        """One parameter by name.

        Raises
        ------
        KeyError
            If it was not calibrated.
        """
        try:
            return next(one for one in self.parameters if one.name == name)
        except StopIteration:
            raise KeyError(f"{name!r} is not among {', '.join(self.names)}") from None

    def __repr__(self) -> str:
        runs = "1 run" if len(self.runs) == 1 else f"{len(self.runs)} runs"
        lines = [f"Calibration of {runs}{'' if self.converged else ', NOT CONVERGED'}"]
        width = max((len(one.name) for one in self.parameters), default=0)
        for one in self.parameters:
            known = f"± {one.half_width:.2g}" if one.identified else "not identified"
            lines.append(
                f"  {one.name:<{width}}  {one.value:.6g} {known} {one.unit}".rstrip()
                + f"  (was {one.nominal:.6g})"
            )
        if not self.parameters:
            lines.append("  no set of parameters predicts better than the nominal dimensions")
        for unit, what in (("m", "position"), ("rad", "heading")):
            if errors := [(run.before, run.after) for run in self.runs if run.unit == unit]:
                before, after = np.median(errors, axis=0).tolist()
                lines.append(f"  rms {what} error, median of the runs: {before:.4f} -> {after:.4f} {unit}")
        if self.cross_validation is not None and self.cross_validation.chosen == self.chosen:
            lines.append(f"  {self.cross_validation!r}")
        if (measured := self.measured_noise) is not None:
            lines.append(f"  {measured!r}")
        lines += [f"  {sentence}" for sentence in (*self.slips, *self.observability.messages)]
        return "\n".join(lines)

    def to_markdown(self, *, title: str = "Calibration") -> str:
        """The whole report: values, what is not identified, errors per run, residuals, cross-validation."""
        parts = [
            [f"# {title}"],
            self._value_lines(),
            [f"Intervals from leaving out one after another of {self.basis}. Loss: {self.loss}."],
            [] if self.converged else ["**The fit did not settle; do not trust these values.**"],
            ["## Slip", "", *(f"- {sentence}" for sentence in self.slips)] if self.slips else [],
            [] if self.measured_noise is None else self._noise_lines(self.measured_noise),
            [] if self.gyroscope is None else _gyroscope_lines(self.gyroscope),
        ]
        if messages := self.observability.messages:
            parts.append(["## What the drives do not tell", "", *(f"- {message}" for message in messages)])
        parts += [self._run_lines("m", "position"), self._run_lines("rad", "heading"), self._window_lines()]
        if (checked := self.cross_validation) is not None:
            rule = f"Mean error of the runs of each {checked.kind} under a fit without it"
            said = [f"{rule}; the chosen set in bold.", "", checked.to_markdown()]
            parts.append(["## Cross-validation", "", *said])
        return "\n\n".join("\n".join(part) for part in parts if part) + "\n"

    def _value_lines(self) -> list[str]:
        percent = f"{100 * self.confidence:g} %"
        head = f"| parameter | nominal | calibrated | standard deviation | {percent} interval |"
        lines = [head, "|---|---|---|---|---|"]
        for one in self.parameters:
            low, high = one.interval
            name = f"`{one.name}`" + (f" [{one.unit}]" if one.unit else "")
            known = f"{one.std:.2g} | {low:.6g} to {high:.6g}" if one.identified else "| not identified"
            lines.append(f"| {name} | {one.nominal:.6g} | {one.value:.6g} | {known} |")
        return lines

    def _noise_lines(self, measured: MeasuredNoise) -> list[str]:
        named = [(f"`{slip.name}`", slip) for slip in (measured.slip, measured.side_slip)]
        named += [(f"times that, of `{wheel.name}`", wheel) for wheel in measured.wheels]
        percent = f"{100 * self.confidence:g} %"
        lines = ["## Noise", "", f"From {measured.basis}: `{measured.noise!r}`.", ""]
        lines += [f"| slip [m per root m] | most likely | {percent} interval |", "|---|---|---|"]
        for name, one in named:
            low, high = one.interval
            lines.append(f"| {name} | {one.value:.3g} | {low:.3g} to {high:.3g} |")
        if not measured.wheels:
            lines += ["", "These ends do not tell the slip of one wheel from that of another."]
        return lines

    def _run_lines(self, unit: str, what: str) -> list[str]:
        """Errors of the runs whose truth has this unit; nothing if there is none."""
        rows = [
            f"| {run.name} | {run.distance:.2f} | {run.before:.4f} | {run.after:.4f} | {run.dropped} |"
            for run in self.runs
            if run.unit == unit
        ]
        if not rows:
            return []
        said = f"Root mean square {what} error, first pose given."
        head = f"| run | distance [m] | nominal [{unit}] | calibrated [{unit}] | rows left out |"
        return ["## Runs", "", said, "", head, "|---|---|---|---|---|", *rows]

    def _window_lines(self) -> list[str]:
        lines = [
            "## Windows",
            "",
            "Root mean square error of the motion over windows of the drives.",
            "",
            "| window | count | nominal [m] | calibrated [m] | nominal [deg] | calibrated [deg] |",
            "|---|---|---|---|---|---|",
        ]
        for name, number, before, after, turned, turns in self.windows.table():
            degrees = f"{math.degrees(turned):.2f} | {math.degrees(turns):.2f}"
            lines.append(f"| {name} | {number} | {before:.4f} | {after:.4f} | {degrees} |")
        return lines


def _gyroscope_lines(found: MeasuredGyroscope) -> list[str]:
    rate, walk = found.noise, found.bias_walk
    said = f"A reading of the gyroscope errs by {rate.value:.3g} rad/s "
    said += f"({rate.interval[0]:.3g} to {rate.interval[1]:.3g}), "
    said += f"{found.period:.3g} s after the one before, about a bias that was {found.bias:.3g} rad/s and "
    said += f"wanders by {walk.value:.3g} rad/s per root s ({walk.interval[0]:.3g} to {walk.interval[1]:.3g})"
    lines = [f"{said}: `{found.known!r}`."]
    if (scale := found.scale) is not None:
        low, high = scale.interval
        lines.append(f"Its readings are to be multiplied by {scale.value:.5g} ({low:.5g} to {high:.5g}).")
    return lines
