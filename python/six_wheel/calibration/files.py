"""Calibration of a rover from logs on disk: read them, fit, and write the rover."""

import contextlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from six_wheel._core import Rover, __version__
from six_wheel.calibration.drives import heard, moving
from six_wheel.calibration.estimates import Estimate
from six_wheel.calibration.result import Calibration
from six_wheel.calibration.run_calibration import calibrate
from six_wheel.kinematics.errors import TableError
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.objects.whole_files import replacing
from six_wheel.kinematics.poses import Floats, joined
from six_wheel.log_odometry.copies import without_copies
from six_wheel.log_odometry.dead_reckoning import dead_reckon
from six_wheel.log_odometry.evaluation.paths import align
from six_wheel.logs.detect_reader import AnyLog, logs_in, read_log
from six_wheel.logs.log_options import LogOptions, keys_of
from six_wheel.logs.recordings import WheelLog
from six_wheel.parallel import Journal
from six_wheel.parallel.journal import file_states
from six_wheel.robot_description.diagnostics import ParameterFileError
from six_wheel.robot_description.dimensions import FRAME
from six_wheel.robot_description.gyroscope_errors import ARGUMENTS
from six_wheel.robot_description.parameters.edit_in_place import text_for
from six_wheel.robot_description.parameters.file import Parameters, parse_parameters

YAML = (".yaml", ".yml")
FACTORS = ("encoder_scale", "steering_gain")
MANY = 8  # logs from which on it is worth starting processes


@dataclass(frozen=True)
class Calibrated:
    """A calibration and what it came from: `result`, the `logs` and what is to be said of them, and whether a
    gyroscope was all the truth."""

    result: Calibration
    logs: tuple[WheelLog, ...]
    warnings: tuple[str, ...]
    by_gyroscope: bool = False

    @property
    def shown(self) -> int:
        """The run for the picture: the one whose calibrated error is the median."""
        errors = [run.after for run in self.result.runs]
        return self.result.runs[int(np.argsort(errors, kind="stable")[(len(errors) - 1) // 2])].number


@checked()
def calibrate_files(
    rover: Rover,
    paths: Sequence[Path],
    output: Path | None = None,
    *,
    parameters: Parameters | None = None,
    truths: Sequence[Path] = (),
    finish: Callable[[Calibrated], None] | None = None,
    log_options: LogOptions | None = None,
    options: dict[str, Any] | None = None,
    progress: Callable[..., None] | None = None,
) -> Calibrated:
    """Calibrate a rover and write what comes of it. Outputs are replaced only if all went well.

    A run that was stopped goes on where it was: the errors of each set of parameters are kept in a folder
    beside the output until that is written.

    Parameters
    ----------
    rover : Rover
        With its nominal dimensions.
    paths : sequence of Path
        Logs, or folders of them. Those of one folder are one session, if there are several folders.
    output : Path, optional
        The calibrated rover as a parameter file, .yaml.
    parameters : Parameters, optional
        The file the rover comes from, whose keys and comments the output keeps where they can say it.
    truths : sequence of Path
        One for every log, or one that holds the times of all; none if the logs say it themselves.
    finish : callable, optional
        Called with what came of it before the output is replaced: what it raises leaves all as it was.
    log_options, options
        Options of reading the logs, and arguments of `calibrate`.
    progress : callable, optional
        Called with steps done, steps in all and what is being done.

    Raises
    ------
    TableError
        If a log, a truth or an output cannot be used.
    """
    paths = logs_in(paths)
    if len(truths) > 1 and len(truths) != len(paths):
        raise ValueError(
            f"truth must be given once, or once for every log, got {len(truths)} for {len(paths)} logs"
        )
    if output is not None and output.suffix.lower() not in YAML:
        raise TableError(f'{output}: the ending must be {" or ".join(YAML)}, got "{output.suffix}"')
    sources = [*paths, *truths, *([parameters.path] if parameters else [])]
    reading = log_options or LogOptions()
    with contextlib.ExitStack() as stack:
        target = stack.enter_context(replacing(output, sources)) if output else None
        logs, warnings, by_gyroscope = [], [], True
        for number, path in enumerate(paths):
            if progress is not None:
                progress(number, len(paths), f"reading {path.name}")
            truth = truths[number if len(truths) > 1 else 0] if truths else None
            log, reader = read_log(path, rover, reading, truth=truth)
            _check_truth(path, log)
            by_gyroscope &= log.truth is None
            logs.append(heard(log, number))
            warnings += _said(reader)
        logs, _, copies = without_copies(logs)
        warnings += copies
        for key, known in _known_encoders(rover, reading).items() if output else ():
            warnings += [] if known is not None else [f"{key} that differ have no keys: they are not written"]
        moves = moving(rover, logs)
        still = [log.name for log, moved in zip(logs, moves, strict=True) if not moved]
        warnings += [f"{name}: left out: the rover stands still while its truth is known" for name in still]
        logs = [log for log, moved in zip(logs, moves, strict=True) if moved]
        given = dict(options or {})
        if given.get("workers") is None:
            given["workers"] = 1 if len(logs) < MANY else None
        journal = None
        if output is not None:
            run = _run(rover, [*paths, *truths], repr(reading), given)
            journal = Journal.of_this_run(output.with_name(f".{output.name}.done"), run)
        try:
            result = calibrate(rover, logs, progress=progress, journal=journal, **given)
        finally:
            if journal is not None and not journal.done:
                journal.discard()  # nothing to go on from
        done = Calibrated(result, tuple(logs), tuple(warnings), by_gyroscope)
        text = text_for(result.rover, parameters, _beside(done, parameters, reading), _remarks(done))
        done = replace(done, warnings=(*done.warnings, *_read_back(text, parameters)))
        if target is not None:
            target.write_text(text, encoding="utf-8")
        if finish is not None:
            finish(done)
    if journal is not None:
        journal.discard()
    return done


def _run(rover: Rover, sources: Sequence[Path], reading: str, options: dict[str, Any]) -> dict[str, Any]:
    """Everything that the worth of a set of parameters depends on."""
    said = {name: repr(value) for name, value in options.items() if name not in ("cluster", "workers")}
    known = {"version": __version__, "rover": repr(rover), "reading": reading, "files": file_states(sources)}
    return said | known


def _read_back(text: str, parameters: Parameters | None) -> list[str]:
    """Makes sure that what was written can be read; says so where it is no longer the kind of file it was."""
    if parameters is None:
        parse_parameters(text)
        return []
    try:
        written = parse_parameters(text, node=parameters.node, kind=parameters.kind_given)
    except ParameterFileError:
        written = parse_parameters(text, node=parameters.node)
    if (written.kind, written.controller) == (parameters.kind, parameters.controller):
        return []
    was = parameters.controller or f"kind {parameters.kind}"
    return [f"the keys of {was} cannot say what was found: it is written as kind: {written.kind}"]


def _check_truth(path: Path, log: WheelLog) -> None:
    if log.truth is None and log.yaw_rate is not None:
        return  # the gyroscope is the truth of the heading
    if log.truth is None:
        remedy = "give --truth, or columns x, y and yaw"
        raise TableError(f"{path}: a calibration needs to know where the rover really was; {remedy}")
    first, last = log.truth.stamps[0], log.truth.stamps[-1]
    if first >= log.stamps[-1] or last <= log.stamps[0]:
        ours = f"{log.stamps[0]:g} to {log.stamps[-1]:g} s"
        raise TableError(
            f"{path}: the truth must overlap the log in time, got {first:g} to {last:g} s and {ours}"
        )


def _said(reader: AnyLog) -> list[str]:
    said = list(reader.warnings)
    for findings in (reader.findings, reader.truth_findings):
        if findings is not None and findings.rows:
            more = f"; {findings.rows} rows left out in all" if findings.rows > 1 else ""
            said.append(f"{findings.listed[0]}{more}")
    return said


# --- the calibrated rover --------------------------------------------------------------------------------


def _encoders(result: Calibration, known: Mapping[str, Any]) -> dict[str, Any]:
    """The key ``wheel_encoders`` with the factors that are no dimension of a rover, and what is known."""
    encoders = dict(known)
    gains = dict(encoders.get("steering_gain", {}))
    for one in result.parameters:
        kind, _, wheel = one.name.removesuffix("]").partition("[")
        if kind == "encoder_scale":
            encoders["scale"] = encoders.get("scale", 1.0) * one.value
        elif kind == "steering_gain":
            joints = (name for name, steered in result.rover.steering_joints.items() if steered == wheel)
            key = next((name for name in (wheel, *joints) if name in gains), wheel)
            gains[key] = gains.get(key, 1.0) * one.value
    return encoders | ({"steering_gain": gains} if gains else {})


def _known_encoders(rover: Rover, reading: LogOptions) -> dict[str, dict[str, Any] | None]:
    """The keys of encoders of wheels and of steering joints, None where no keys say them."""
    given = {"wheel_encoders": reading.wheel_encoders, "steering_encoders": reading.steering_encoders}
    names = rover.wheel_names, rover.steered_wheel_names
    return {key: keys_of(key, given[key], each) for key, each in zip(given, names, strict=True)}


def _beside(done: Calibrated, parameters: Parameters | None, reading: LogOptions) -> dict[str, Any]:
    """Calibrated sections beside the rover's dimensions, by the keys that every parameter file has, and what
    the logs were read with, so that the file reads them again."""
    result, read_with = done.result, dict[str, Any]()
    wheels, steering = (known or {} for known in _known_encoders(result.rover, reading).values())
    if steering and (parameters is None or steering != parameters.steering_encoders):
        read_with["steering_encoders"] = steering
    for name in ("columns", "topics"):
        if given := getattr(reading, name):
            read_with[name] = dict(given) if isinstance(given, Mapping) else list(given)
    if reading.stamp_unit is not None:
        read_with["stamp_unit"] = reading.stamp_unit
    if not reading.plausibility:
        read_with["plausibility"] = False
    return read_with | {
        "wheel_encoders": _encoders(result, {**wheels, **reading.wheel_keys}),
        "noise": _noise(result, parameters),
        "odometry": _odometry(result, parameters),
        "gyroscope": _gyroscope(done, parameters),
        "truth": None if done.by_gyroscope else _truth(done, parameters),
        "calibration": _known(result),
    }


def _noise(result: Calibration, parameters: Parameters | None) -> dict[str, float] | None:
    """The key ``noise``, as measured; what a sensor of its own errs by stays as the file has it."""
    if result.measured_noise is None:
        return None
    kept = {} if parameters is None else parameters.noise
    found = result.measured_noise.beside  # the dimensions that are written count by themselves
    return kept | {name: getattr(found, name) for name in ("speed", "steering", "slip", "side_slip")}


def _odometry(result: Calibration, parameters: Parameters | None) -> dict[str, Any] | None:
    """The key ``odometry`` with how much each wheel slips, where the drives told that."""
    kept = {} if parameters is None else parameters.odometry
    others = {name: value for name, value in kept.items() if name != "wheel_noise"}
    wheels = result.known["wheel_noise"]
    return others | ({"wheel_noise": wheels} if wheels else {}) if result.measured_noise else None


def _gyroscope(done: Calibrated, parameters: Parameters | None) -> dict[str, Any] | None:
    """The key ``gyroscope``: what one errs by, and its scale and clock on top of what the file had."""
    kept = {} if parameters is None else parameters.gyroscope
    measured, offset = done.result.gyroscope, done.result.time_offset if done.by_gyroscope else 0.0
    found: dict[str, Any] = {}
    if measured is not None:
        found = {name: getattr(measured.known, name) for name in ARGUMENTS} | {"period": measured.period}
        if (scale := measured.scale) is not None:
            if scale.interval[0] <= 1.0 <= scale.interval[1]:  # then it is left at that
                found["scale_noise"] = math.hypot(scale.value - 1.0, scale.std)
            else:
                found["scale"] = kept.get("scale", 1.0) * scale.value
    if offset:
        found["time_offset"] = kept.get("time_offset", 0.0) + offset
    return kept | found if found else None


def _truth(done: Calibrated, parameters: Parameters | None) -> dict[str, float] | None:
    """The key ``truth``: what was found counts on top of what the file had, with which the logs were read."""
    result = done.result
    if not (np.any(result.sensor) or result.time_offset):
        return None
    kept = {} if parameters is None else parameters.truth
    # Positions alone were read where the sensor is, wherever the file has it.
    turned = all(log.truth is not None and log.truth.has_yaw for log in done.logs)
    place = np.array([kept.get(axis, 0.0) for axis in FRAME]) if turned else np.zeros(3)
    pose = joined(result.sensor, place)
    offset = result.time_offset + kept.get("time_offset", 0.0)
    return dict(zip(FRAME, pose.tolist(), strict=True)) | {"time_offset": offset}


def _known(result: Calibration) -> dict[str, Any] | None:
    """The key ``calibration``: how well the dimensions in the file are known, as `deviations` takes it."""
    if not result.parameters:
        return None
    names = list(result.names)
    by = np.diag([1.0 / one.value if one.name.startswith(FACTORS) else 1.0 for one in result.parameters])
    if all(f"origin_{axis}" in names for axis in FRAME):
        x, y, yaw = names.index("origin_x"), names.index("origin_y"), result["origin_yaw"].value
        by[np.ix_((x, y), (x, y))] = [[math.cos(yaw), math.sin(yaw)], [-math.sin(yaw), math.cos(yaw)]]
    return {"parameters": names, "covariance": (by @ result.widened @ by.T).tolist()}


def interval(one: Estimate) -> str:
    """The interval of a value, in as many digits as it is worth."""
    if not one.identified:
        return "not identified"
    digits = max(0, 2 - math.ceil(math.log10(one.half_width))) if one.half_width > 0.0 else 6
    return " to ".join(f"{end:.{digits}f}" for end in one.interval)


def _remarks(done: Calibrated) -> list[str]:
    """Comment lines at the head of the calibrated file."""
    result = done.result
    runs = ", ".join(log.name for log in done.logs[:3]) + (", ..." if len(done.logs) > 3 else "")
    count = f"{len(done.logs)} run{'' if len(done.logs) == 1 else 's'}"
    lines = [f"Calibrated by six-wheel {__version__} on {count}: {runs}"]
    for one in result.parameters:
        unit = f" {one.unit}" if one.unit else ""
        said = f"{one.name} {one.value:.6g}{unit}, was {one.nominal:.6g}"
        lines.append(f"{said}; {100 * result.confidence:g} %: {interval(one)}")
    if (measured := result.measured_noise) is not None:
        lines.append(f"noise from {measured.basis}")
    lines += result.observability.messages
    return [line if line.isprintable() else repr(line) for line in lines]


def paths_of(done: Calibrated, number: int) -> tuple[dict[str, Floats], Floats]:
    """A run as dead-reckoned before and after, and the truth at the same times."""
    result, log = done.result, done.logs[number]
    if log.truth is None:
        raise ValueError(f"{log.name} must have a truth, got none")  # it was checked
    corrections = _encoders(result, {})
    gains = corrections.get("steering_gain", {})
    factors = np.array([gains.get(wheel, 1.0) for wheel in result.rover.steered_wheel_names])
    corrected = replace(
        log,
        steering=None if log.steering is None else log.steering * factors,
        wheel_angles=log.wheel_angles * corrections.get("scale", 1.0),
    )
    tracks = []
    for rover, one, sensor in (
        (result.nominal, log, np.zeros(3)),
        (result.rover, corrected, result.sensor),
    ):
        how: dict[str, Any] = {"covariances": False, "residuals": False, "plausibility": False}
        track = dead_reckon(rover, one.steering, one.wheel_angles, one.stamps, **how)
        tracks.append(joined(track.poses, sensor))
    truth = log.truth.at(log.stamps + result.time_offset)
    there = np.isfinite(truth[:, :2]).all(axis=1)
    if not log.truth.has_positions:  # nothing to lay the tracks over
        return dict(zip(("nominal", "calibrated"), tracks, strict=True)), truth[:0]
    known, shown = np.nan_to_num(truth[there]), [track[there] for track in tracks]
    if not log.truth.has_yaw:
        shown = [align(track, known, "se2") for track in shown]
    return dict(zip(("nominal", "calibrated"), shown, strict=True)), known
