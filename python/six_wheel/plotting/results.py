"""The picture of a result, whichever it is."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import inspect
from importlib import import_module
from typing import Any

from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from six_wheel._core import Limits, Rover
from six_wheel.kinematics.keywords import checked, unknown_keyword
from six_wheel.kinematics.odometry.tracks import Track
from six_wheel.logs.recordings import GroundTruth, Reference

# Ways to a picture for what is none of this package's results.
HINTS = {
    "ndarray": "; poses are drawn by six_wheel.plotting.path_figure(rover, poses, steering)",
    "DataFrame": "; Track.from_pandas and WheelLog.from_pandas read a table",
    "type": "; give an object of the class",
    "str": "; read the file first: six_wheel.load, six_wheel.logs.read_log, Terrain.read, Costmap.read",
    "PurePath": "; read the file first: six_wheel.load, six_wheel.logs.read_log, Terrain.read, Costmap.read",
}
MOST = 6  # pictures below each other


def figure(result: Any, *, title: str | None = None, **options: Any) -> Figure:
    """Picture of a result: what ``six_wheel.plot(result)`` draws.

    Parameters
    ----------
    result
        Nearly everything that this package returns: rovers, wheels, limits, fits, logs, truths, tracks,
        states of odometry, settled poses, terrains, costmaps, plans, profiles, simulations, evaluations,
        calibrations, traversed maps; or a list of these: paths in one picture, others one below the other.
        A track takes ``truth=`` (a `GroundTruth`, a `WheelLog` that has one, another track), a rover
        ``twist=`` or ``limits=``, limits ``rover=``, motions on ground and a `Stability` ``stand=``, plans
        and rollouts ``costmap=``, a planner ``plan=`` and ``costmap=``.
    title : str, optional
        Written above the picture.
    **options
        Those of the picture; none is required.

    Returns
    -------
    matplotlib.figure.Figure
        To be written by `save`. A notebook shows it.

    Raises
    ------
    TypeError
        If there is no picture of such a thing, or no such option; the message lists the options there are.
    """
    if type(result) is tuple:
        result = list(result)
    for kind in type(result).__mro__:
        if kind.__name__ in PICTURES:
            module, function = PICTURES[kind.__name__]
            draw = getattr(import_module(module, __package__), function)
            known = [name for name in inspect.signature(draw).parameters if name != "title"][1:]
            for name in options:
                if name not in known:
                    raise TypeError(unknown_keyword("sw.plot", name, ["title", *known]))
            made: Figure = checked(call="sw.plot")(draw)(result, title=title, **options)
            return made
    rule = "a Rover, Track, Terrain or another result that help(six_wheel.plot.figure) names"
    hint = next((words for name, words in HINTS.items() if name in map(_name, type(result).__mro__)), "")
    raise TypeError(f"result must be {rule}, got {type(result).__name__}{hint}")


def _name(kind: type) -> str:
    return kind.__name__


def _track(track: Track, *, title: str | None, truth: Reference | None = None) -> Figure:
    from six_wheel.log_odometry.tracks import of_track
    from six_wheel.plotting.log_odometry import reckoning_figure

    if track.covariances is None or track.residuals is None or len(track) < 2:
        path: Figure = _pictures("paths").truth_figure(GroundTruth(track.stamps, track.poses), title=title)
        return path
    return reckoning_figure(of_track(track, truth), title=title)


def _rover(
    rover: Rover, *, title: str | None, twist: ArrayLike | None = None, limits: Limits | None = None
) -> Figure:
    from six_wheel.plotting.limits import limits_figure
    from six_wheel.plotting.twist import show_figure

    if twist is not None and limits is not None:
        raise TypeError("a rover's picture takes twist= or limits=, got both")
    if limits is not None:
        return limits_figure(rover, limits, title=title)
    if twist is not None:
        return show_figure(rover, twist, title=title)
    made: Figure = _pictures("above").rover_figure(rover, title=title)
    return made


def _limits(limits: Limits, *, title: str | None, rover: Rover | None = None) -> Figure:
    from six_wheel.plotting.limits import box_figure, limits_figure

    return box_figure(limits, title=title) if rover is None else limits_figure(rover, limits, title=title)


def _traversed(done: Any, *, title: str | None) -> Figure:
    from six_wheel.plotting.ground.safety import traverse_figure

    return traverse_figure(done.picture.safe, done.picture.tilt, done.extent, title)


def _four_axle_rover(car: Any, *, title: str | None) -> Figure:
    return _rover(car.rover, title=title)


def _axle_state(state: Any, *, title: str | None) -> Figure:
    names = ("front left", "front right", "rear left", "rear right")
    angles = dict(zip(names, state.steering, strict=True))
    words = f"front {state.front_brake}, rear {state.rear_brake}"
    made: Figure = _pictures("bars").named_bars(angles, title=title, below=words, unit="axle angle [rad]")
    return made


def _sequence(sequence: Any, *, title: str | None) -> Figure:
    steps = sequence.steps if hasattr(sequence, "steps") else (sequence,)
    bars = {f"{k + 1}. {step.action}": step.duration for k, step in enumerate(steps)}
    words = getattr(sequence, "reason", "") or "steps and their durations"
    made: Figure = _pictures("bars").named_bars(bars, title=title, below=words, unit="duration [s]")
    return made


def _drive(engine: Any, *, title: str | None) -> Figure:
    from six_wheel.plotting.drive import engine_figure

    return engine_figure(engine, title=title or "drive")


def _several(results: Any, *, title: str | None) -> Figure:
    """Paths in one picture; other results one below the other, those of one kind at the same scales."""
    if not results:
        raise TypeError("a list must hold results that have pictures, got an empty one")
    several = _pictures("several")
    made: Figure
    if all(several.path_of(one) is not None for one in results):
        made = several.paths_figure(results, title=title)
    elif len(results) > MOST:
        raise TypeError(f"a list must hold at most {MOST} results, or paths, got {len(results)}")
    else:
        kinds = [type(one) for one in results]
        made = several.stacked([figure(one) for one in results], kinds, title=title)
    return made


def _pictures(name: str) -> Any:
    return import_module(f".pictures.{name}", __package__)


# Module and function by the name of the class: most of these need what a picture of another does not.
PICTURES: dict[str, tuple[str, str]] = {
    "Track": (".results", "_track"),
    "Rover": (".results", "_rover"),
    "Limits": (".results", "_limits"),
    "Calibration": (".pictures.calibrated", "calibration_figure"),
    "Traversed": (".results", "_traversed"),
    "Replayed": (".replay", "replay_figure"),
    "FourAxle": (".results", "_four_axle_rover"),
    "FourAxleState": (".results", "_axle_state"),
    "FourAxleStep": (".results", "_sequence"),
    "TurnSequence": (".results", "_sequence"),
    "FourAxleSimulation": (".four_axle", "four_axle_figure"),
    "Drive": (".results", "_drive"),
    "ControlledDrive": (".results", "_drive"),
    "Reckoned": (".log_odometry", "reckoning_figure"),
    "list": (".results", "_several"),
    "Wheel": (".pictures.above", "wheel_figure"),
    "TwistFit": (".pictures.above", "fit_figure"),
    "Mobility": (".pictures.above", "mobility_figure"),
    "FourAxleMobility": (".pictures.above", "mobility_figure"),
    "ControllerOutput": (".pictures.above", "output_figure"),
    "OdometryState": (".pictures.above", "pose_figure"),
    "Odometry3State": (".pictures.above", "pose_figure"),
    "Preintegrated": (".pictures.above", "pose_figure"),
    "TwistJacobian": (".pictures.bars", "jacobian_bars"),
    "Stability": (".pictures.support", "stability_figure"),
    "PoseBounds": (".pictures.bars", "bounds_bars"),
    "Feasibility": (".pictures.bars", "feasible_bars"),
    "BodySlip": (".pictures.bars", "slip_bars"),
    "Terrain": (".pictures.fields", "terrain_figure"),
    "Costmap": (".pictures.fields", "costmap_figure"),
    "Mppi": (".pictures.fields", "planner_figure"),
    "MppiPlan": (".pictures.fields", "plan_path_figure"),
    "RolloutCost": (".pictures.fields", "rollouts_figure"),
    "GroundTruth": (".pictures.paths", "truth_figure"),
    "WheelLog": (".pictures.paths", "log_figure"),
    "GroundSimulation": (".pictures.paths", "drive_figure"),
    "Track3": (".pictures.paths", "track3_figure"),
    "Evaluation": (".pictures.paths", "evaluation_figure"),
    "Twist": (".pictures.paths", "twist_path_figure"),
    "SettledPose": (".pictures.sides", "stand_figure"),
    "Suspension": (".pictures.sides", "suspension_figure"),
    "GroundCommand": (".pictures.sides", "ground_motion_figure"),
    "GroundMotion": (".pictures.sides", "ground_motion_figure"),
    "FourAxleMotion": (".pictures.sides", "motion_figure"),
    "Traction": (".pictures.sides", "motion_figure"),
    "SteeringCommand": (".pictures.sides", "motion_figure"),
    "WheelSlip": (".pictures.sides", "motion_figure"),
    "ControllerRun": (".pictures.strips", "run_strips"),
    "Profile": (".pictures.strips", "profile_strips"),
    "BodyTransition": (".pictures.strips", "transition_strips"),
    "ModuleTransition": (".pictures.strips", "transition_strips"),
    "IcrTransition": (".pictures.strips", "transition_strips"),
    "SlipReport": (".pictures.strips", "slip_strips"),
}
