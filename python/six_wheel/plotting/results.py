"""The picture of a result, whichever it is."""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import inspect
from importlib import import_module
from typing import Any

from matplotlib.figure import Figure

from six_wheel.kinematics.keywords import checked, unknown_keyword

# Ways to a picture for what is none of this package's results.
HINTS = {
    "ndarray": "; poses are drawn by six_wheel.plotting.path_figure(rover, poses, steering)",
    "DataFrame": "; Track.from_pandas and WheelLog.from_pandas read a table",
    "type": "; give an object of the class",
    "str": "; read the file first: six_wheel.load, six_wheel.logs.read_log, Terrain.read, Costmap.read",
    "PurePath": "; read the file first: six_wheel.load, six_wheel.logs.read_log, Terrain.read, Costmap.read",
}


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
    hint = next(
        (words for name, words in HINTS.items() if name in (kind.__name__ for kind in type(result).__mro__)),
        "",
    )
    raise TypeError(f"result must be {rule}, got {type(result).__name__}{hint}")


# Module and function by the name of the class: most of these need what a picture of another does not.
PICTURES: dict[str, tuple[str, str]] = {
    "Track": (".pictures.paths", "track_figure"),
    "Rover": (".pictures.above", "rover_figure"),
    "Limits": (".limits", "given_limits_figure"),
    "Calibration": (".pictures.calibrated", "calibration_figure"),
    "Traversed": (".ground.safety", "traversed_figure"),
    "Replayed": (".replay", "replay_figure"),
    "FourAxle": (".pictures.above", "four_axle_figure"),
    "FourAxleState": (".pictures.bars", "axle_bars"),
    "FourAxleStep": (".pictures.bars", "sequence_bars"),
    "TurnSequence": (".pictures.bars", "sequence_bars"),
    "FourAxleSimulation": (".four_axle", "four_axle_figure"),
    "Drive": (".drive", "engine_figure"),
    "ControlledDrive": (".drive", "engine_figure"),
    "Reckoned": (".log_odometry", "reckoning_figure"),
    "list": (".pictures.several", "list_figure"),
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
