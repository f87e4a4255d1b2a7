"""A rover's true dimensions from its logs: what fits them, how well it is known, and what they cannot tell.

>>> from six_wheel import calibration
>>> from six_wheel.logs import optiodom
>>> rover, log = optiodom.example()
>>> result = calibration.calibrate(rover, [log], parameters=["wheel_radius", "wheelbase", "steering_offset"])

Needs SciPy (``pip install "six-wheel[calibrate]"``).
"""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from numbers import Real
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from six_wheel._core import Rover, check_kind
from six_wheel.calibration import fitting, noise
from six_wheel.calibration.cross_validation import PIECES, CrossValidation, cross_validate, pieces
from six_wheel.calibration.cross_validation import candidates as all_candidates
from six_wheel.calibration.drives import Drive, default_lengths, encoders, heard, moving, prepare
from six_wheel.calibration.estimates import Estimate, RunErrors, Windows
from six_wheel.calibration.gyroscope import noise as gyroscope
from six_wheel.calibration.gyroscope.scale import mistaken, scale
from six_wheel.calibration.log_checks import slip, units
from six_wheel.calibration.log_checks.records import with_truth
from six_wheel.calibration.model import Model, with_mounts
from six_wheel.calibration.noise import MeasuredNoise
from six_wheel.calibration.observability import describe, told
from six_wheel.calibration.problem import LOSSES, Loss, Problem, Solution
from six_wheel.calibration.result import Calibration
from six_wheel.kinematics.errors import ArgumentTypeError
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.odometry.tracks import Track
from six_wheel.kinematics.poses import Floats
from six_wheel.log_odometry.copies import without_copies
from six_wheel.log_odometry.evaluation.slip import Stretch
from six_wheel.logs.detect_reader import as_logs
from six_wheel.logs.log_options import LogOptions
from six_wheel.logs.recordings import Reference, WheelLog
from six_wheel.parallel import Journal, one_thread
from six_wheel.robot_description.dimensions import Catalogue

Progress = Callable[[int, int, str], object]
OF_TRACKS = (
    "the truth is another odometry: dimensions are known as well as its own scale, "
    "and what both err by alike does not show"
)


@checked()
def parameter_names(rover: Rover, logs: Sequence[WheelLog] = ()) -> list[str]:
    """Names that `calibrate` takes for this rover: groups such as ``wheel_radii``, and their members.

    Without `logs`, every wheel with a motor is taken to have an encoder.
    """
    heard = encoders(rover, logs) if logs else [wheel.driven for wheel in rover.wheels]
    return Catalogue(rover, heard).names


@checked(LogOptions)
@one_thread()
def calibrate(
    rover: Rover,
    logs: Any,
    truth: Reference | ArrayLike | Sequence[Reference | ArrayLike] | None = None,
    parameters: Literal["auto"] | str | Iterable[str] = "auto",
    *,
    loss: Loss | Literal["auto"] = "auto",
    window: float | Sequence[float] | None = None,
    confidence: float = 0.95,
    cross_validation: bool = True,
    max_time_offset: float = 0.5,
    progress: Progress | None = None,
    cluster: Any = None,
    workers: int | None = 1,
    journal: Journal | None = None,
    **how: Any,
) -> Calibration:
    """Identify a rover's dimensions from what its encoders said and how it really moved.

    Least squares on the motion over windows of the drive, so that early errors do not count again in all that
    follows: windows of several lengths, and windows from the start, each weighed by its own usual error.

    Parameters
    ----------
    rover : Rover
        With its nominal dimensions: what the drives do not tell stays as it is.
    logs : WheelLog, path or table, or a sequence of them
        Drives of this rover: what `dead_reckon` takes, and any file that `read_log` reads. `WheelLog.session`
        says which belong together.
    truth : GroundTruth, poses, or a sequence of them, optional
        One per log, instead of the truth the logs carry: poses, positions or headings (see `GroundTruth`),
        those of another odometry, or the same place again where a loop closes. A log with a gyroscope and
        without a truth is calibrated by its headings.
    parameters : 'auto' or str or sequence of str
        Parameters to find; `parameter_names` lists those of a rover. In short: ``wheel_radius`` (shared),
        ``side_radii``, ``wheel_radii``, ``track_width``, ``wheelbase``, ``arm_length``, ``steering_offset``,
        ``steering_gain``, ``roller_angle``, ``encoder_scale``, ``skid``, ``time_offset`` (a stamp of the
        truth less that of the log), ``sensor`` (where what the truth follows sits in the body) and
        ``origin`` (the same, and the rover comes back about it). ``"auto"`` takes those that predict drives
        best that were not fitted.
    loss : {'auto', 'soft_l1', 'linear', 'huber', 'cauchy'}
        Weight of windows in which the rover slipped: from three times the usual error on less and less.
        ``"auto"`` is ``"soft_l1"``; where a drive slid by more than 1.5 times the rover's size at a stretch,
        or for longer than 1.75 s, that is left out of fit and cross-validation (`Calibration.slips`) and the
        loss is ``"cauchy"``.
    window : float or sequence of float, optional
        Lengths of the windows [m], a turn in place counting as what its outermost wheel drives; default 5,
        10, 20 and 40 times the distance of the farthest wheel from the origin.
    confidence : float, default 0.95
        Of the intervals, the share of them that hold the true value.
    cross_validation : bool
        True to leave out one session (run, part of a run) after another and report the errors there.
    max_time_offset : float, default 0.5
        Largest time offset looked for [s]; only when ``time_offset`` is among the parameters.
    progress : callable, optional
        Called with steps done, steps in all and what is being done.
    cluster : distributed.Client or str, optional
        A Dask cluster, or its address, that tries the sets of parameters; the result is the same to the bit.
    workers : int or None, default 1
        Processes of this machine that do so without a cluster, None for one per core.
    journal : six_wheel.parallel.Journal, optional
        Keeps the errors of each set of parameters: a calibration of the same logs that was stopped goes on
        there.
    **how
        Reading of logs that are paths or tables: `columns`, `wheel_encoders`, `steering_encoders`,
        `increments`, `topics`, `stamp_unit`, `plausibility`, as in `read_log`.

    Returns
    -------
    Calibration
        The new rover, values with intervals, what stayed unidentified, residuals, and how it does on drives
        that were left out.

    Raises
    ------
    ValueError
        If an argument breaks its rule, a log does not fit the rover or has no truth.
    ModuleNotFoundError
        If SciPy is not installed.

    Source: relative poses as in Censi, Franchi, Marchionni & Oriolo, Simultaneous Calibration of Odometry and
    Sensor Parameters for Mobile Robots, IEEE T-RO 29(2), 2013; intervals from leaving out clusters, see
    `six_wheel.calibration.fitting.covariance`.
    """
    check_kind("rover", rover)
    given = with_truth(as_logs(logs, rover, LogOptions(**how)), truth)
    if loss not in ("auto", *LOSSES):
        raise ValueError(f"loss must be one of auto, {', '.join(LOSSES)}, got {loss!r}")
    if not (isinstance(confidence, Real) and 0.0 < confidence < 1.0):
        raise ValueError(f"confidence must be between 0 and 1, got {confidence!r}")
    if not (isinstance(max_time_offset, Real) and np.isfinite(max_time_offset) and max_time_offset > 0.0):
        raise ValueError(f"max_time_offset must be finite and positive, got {max_time_offset!r}")
    given = [_readable(rover, log, number) for number, log in enumerate(given)]
    lengths = _lengths(rover, window)
    catalogue = Catalogue(rover, encoders(rover, given))
    records, numbers, copies = without_copies(given)
    asked, margin = _asked(catalogue, parameters, max_time_offset)
    sets = all_candidates(catalogue) if asked is None else [asked]
    prepared = partial(prepare, rover, lengths=lengths, margin=margin)
    whole = records
    drives = [prepared(log, number=number) for number, log in zip(numbers, records, strict=True)]
    slipped = list[slip.Slip]()
    if loss == "auto":
        model = with_mounts(rover, catalogue.find(sets[0]), drives)
        slipped = slip.slipped(Problem(model, drives, "cauchy", lengths, margin), records, PIECES)
        loss = "cauchy" if slipped else "soft_l1"
    if slipped:
        records, drives = _without_slides(records, drives, slipped, prepared)
    checked: CrossValidation | None = None
    if cross_validation or asked is None:
        folds = _parts(rover, whole[0], numbers[0], slipped, margin, prepared) if len(whole) == 1 else drives
        problem = Problem(Model(rover, []), folds, loss, lengths, margin)
        checked = cross_validate(problem, catalogue, sets, progress, cluster, workers, journal)
    chosen = asked if asked is not None else checked.chosen if checked is not None else sets[0]
    if progress is not None:
        progress(0, 1, "fitting all drives")
    model = with_mounts(rover, catalogue.find(chosen), drives)
    problem = Problem(model, drives, loss, lengths, margin)
    result = _fit(problem, records, confidence, tuple(chosen), checked)
    result = replace(_with_gyroscope(result, whole), slips=tuple(map(str, slipped)))
    of_tracks = any(isinstance(one, Track) for one in (truth if isinstance(truth, list | tuple) else [truth]))
    result = _with_messages(result, *copies, *([OF_TRACKS] if of_tracks else []))
    if progress is not None:
        progress(1, 1, "fitting all drives")
    return result


def _asked(
    catalogue: Catalogue, parameters: str | Iterable[str], max_time_offset: float
) -> tuple[tuple[str, ...] | None, float]:
    """Names of what to find, None for those that predict best; and the margin of the drives in time [s]."""
    if isinstance(parameters, str) and parameters != "auto":
        parameters = [parameters]
    if not isinstance(parameters, Iterable):
        raise ArgumentTypeError(f"parameters must be 'auto' or names, got {parameters!r}")
    if parameters == "auto":
        return None, 0.0
    asked = tuple(parameters)
    wanted = catalogue.find(asked)
    if not wanted:
        raise ValueError("parameters must name one at least, got none")
    return asked, max_time_offset if any(one.name == "time_offset" for one in wanted) else 0.0


def _without_slides(
    records: Sequence[WheelLog],
    drives: Sequence[Drive],
    slipped: Sequence[slip.Slip],
    prepared: Callable[..., Drive],
) -> tuple[list[WheelLog], list[Drive]]:
    """Logs and drives, cut where the rover slid."""
    cut: list[tuple[WheelLog, Drive]] = []
    for log, drive in zip(records, drives, strict=True):
        slides = _stretches_of_log(slipped, drive.number)
        again = partial(prepared, number=drive.number)
        cut += slip.clean(log, slides, again, drive.session) if slides else [(log, drive)]
    if not cut:
        raise ValueError(f"logs must hold a stretch without slip: {'; '.join(map(str, slipped))}")
    return [piece for piece, _ in cut], [drive for _, drive in cut]


def _parts(
    rover: Rover,
    log: WheelLog,
    number: int,
    slipped: Sequence[slip.Slip],
    margin: float,
    prepared: Callable[..., Drive],
) -> list[Drive]:
    """Parts of a single log in which the rover moves, to be left out one after another."""
    parts, slides = pieces(log), _stretches_of_log(slipped, number)
    found: list[Drive] = []
    for part, moves in zip(parts, moving(rover, parts, margin), strict=True):
        if moves and slides:
            found += [drive for _, drive in slip.clean(part, slides, prepared, part.name)]
        elif moves:
            found.append(prepared(part))
    return found


def _with_messages(result: Calibration, *messages: str) -> Calibration:
    seen = result.observability
    return replace(result, observability=replace(seen, messages=(*seen.messages, *messages)))


def _with_gyroscope(result: Calibration, logs: Sequence[WheelLog]) -> Calibration:
    """The result with the errors of a gyroscope in the logs, and with messages on oddities of it."""
    measured = gyroscope.measure(logs, result.confidence)
    messages: tuple[str, ...] = tuple(mistaken(result.nominal, logs))
    if measured is None and any(one.yaw_rate is not None for one in logs):
        rule = (
            "what the gyroscope errs by is not known: it shows where the rover stands still for 1 s and more"
        )
        messages = (*messages, rule)
    result = _with_messages(result, *messages)
    if measured is None:
        return result
    measured = replace(measured, scale=scale(logs, result.time_offset, result.confidence))
    noises = result.measured_noise
    noises = None if noises is None else gyroscope.with_gyroscope(noises, measured)
    return replace(result, measured_noise=noises, gyroscope=measured)


def _stretches_of_log(slipped: Sequence[slip.Slip], number: int) -> list[Stretch]:
    return [stretch for one in slipped if one.number == number for stretch in one.stretches]


def _fit(
    problem: Problem,
    records: Sequence[WheelLog],
    confidence: float,
    asked: tuple[str, ...],
    checked: CrossValidation | None,
) -> Calibration:
    model, drives = problem.model, problem.drives
    solution = fitting.solve(problem)
    covariance, degrees, basis = fitting.covariance(problem, solution)
    mistaken_for, at_bounds = units.mistaken(problem, solution), units.at_bounds(problem, solution)
    hints = [*mistaken_for, *at_bounds, *units.unsettled(solution, bool(mistaken_for)), *told(drives)]
    observability = describe(model, solution, drives, hints)
    estimates, wider = [], np.ones(model.own)
    for number, parameter in enumerate(model.parameters[: model.own]):
        std = float(np.sqrt(covariance[number, number])) if observability.identified[number] else float("nan")
        value = float(solution.values[number])
        half = fitting.quantile(float(degrees[number]), confidence) * std
        wider[number] = fitting.quantile(float(degrees[number]), fitting.NORMAL) / fitting.quantile(
            np.inf, fitting.NORMAL
        )
        interval = (value - half, value + half)
        estimates.append(Estimate(parameter.name, parameter.unit, parameter.value, value, std, interval))
    before, _ = problem.errors(model.start)
    known = covariance[: model.own, : model.own]
    widened = known * np.outer(wider, wider)
    return Calibration(
        model.rover(solution.values),
        model.nominal,
        tuple(estimates),
        known,
        widened,
        model.deviations(solution.values, widened),
        confidence,
        basis,
        observability,
        Windows(problem.which, problem.lengths, before, solution.errors, solution.weights, solution.scales),
        tuple(RunErrors.of(model, drive, solution.values) for drive in drives),
        checked,
        model.pose(solution.values, "sensor"),
        model.value(solution.values, "time_offset", 0.0),
        asked,
        problem.loss,
        solution.converged and not at_bounds,
        _noise(problem, solution, records, confidence),
    )


def _readable(rover: Rover, log: WheelLog, number: int) -> WheelLog:
    """The log in radians, however it was read."""
    try:
        in_radians = log.in_radians(rover)
    except ValueError as error:
        raise ValueError(f"logs[{number}]: {error}") from None
    return replace(heard(in_radians, number), plausibility=False)  # it was checked


def _noise(
    problem: Problem, solution: Solution, records: Sequence[WheelLog], confidence: float
) -> MeasuredNoise | None:
    """Noise from where every log ends under a fit without its session, or without itself."""
    model, drives = problem.model, problem.drives
    sessions = [drive.session for drive in drives]
    alone = len(set(sessions)) in (1, len(drives))
    keys = list(range(len(drives))) if alone else [sessions.index(session) for session in sessions]
    pieces = 1 if len(drives) >= noise.ENOUGH else noise.PIECES
    linear = problem.linearised(solution.values, solution.scales)

    def ends_of(chosen: Sequence[WheelLog], values: Floats, known: Floats) -> list[noise.End]:
        rover, sensor = model.rover(values), model.pose(values, "sensor")
        dimensions = model.deviations(values, known)
        offset = model.value(values, "time_offset", 0.0)
        logs = (model.corrected(record, values) for record in chosen)
        return [end for log in logs for end in noise.ends(rover, dimensions, log, sensor, offset, pieces)]

    groups = []
    for key in dict.fromkeys(keys):
        values, known = solution.values, np.zeros((model.own, model.own))
        if len(values) and len(set(keys)) > 1:
            without, fitted = fitting.refit(linear.only([other != key for other in keys]), solution)
            values, known = fitted.values, fitting.covariance(without, fitted)[0]
        own = [record for record, other in zip(records, keys, strict=True) if other == key]
        groups.append(ends_of(own, values, known[: model.own, : model.own]))
    count = sum(map(len, groups))
    what = "ends of runs" if pieces == 1 else f"ends of {pieces} parts of each run"
    left = "fitted as well" if len(set(keys)) < 2 else f"each {'run' if alone else 'session'} left out"
    measured = noise.measure(
        groups, model.nominal.wheel_names, len(set(sessions)), confidence, f"{count} {what}, {left}"
    )
    return measured


def _lengths(rover: Rover, window: float | Sequence[float] | None) -> Floats:
    if window is None:
        return default_lengths(rover)
    try:
        lengths = np.unique(np.atleast_1d(np.asarray(window, dtype=np.float64)))
    except (TypeError, ValueError):
        raise ArgumentTypeError(f"window must be a number or several, got {window!r}") from None
    if not lengths.size or not (np.isfinite(lengths) & (lengths > 0.0)).all():
        raise ValueError(f"window must be finite and positive, got {window}")
    return lengths
