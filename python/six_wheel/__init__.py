"""Kinematics of wheeled rovers: one wheel equation, any layout, a Rust core.

>>> import six_wheel as sw
>>> rover = sw.Rover.preset("perseverance")
>>> steering, speeds = rover.inverse((0.04, 0.0, 0.02))
>>> twist = rover.forward(steering, speeds)

Axes: x forward, y left, angles counter-clockwise (REP 103). Units: metres, seconds, radians.
"""

from os import PathLike
from os.path import exists
from typing import TYPE_CHECKING, Any

from six_wheel._core import (
    BodySlip,
    Controller,
    ControllerOutput,
    ControllerRun,
    Costmap,
    Encoder,
    Feasibility,
    FourAxle,
    GroundCommand,
    GroundMotion,
    Gyroscope,
    Limits,
    Link,
    MarginJacobian,
    Mobility,
    Mppi,
    MppiPlan,
    Noise,
    Odometry,
    Odometry3,
    Odometry3State,
    OdometryState,
    PoseBounds,
    Preintegrated,
    RockerBogie,
    Rover,
    SettledPose,
    Stability,
    SteeringCommand,
    Suspension,
    Terrain,
    Traction,
    TwistFit,
    TwistJacobian,
    Wheel,
    WheelSlip,
    __version__,
    body_slip,
    compose,
    default_threads,
    differentiate,
    exp,
    integrate,
    log,
    rollout,
    set_default_threads,
    simd_levels,
    wrap_angle,
)
from six_wheel.kinematics import config, profiles, se2
from six_wheel.kinematics.controller import Reason
from six_wheel.kinematics.errors import (
    ArgumentTypeError,
    InfeasibleMotionError,
    SuspiciousUnitsWarning,
    UnderdeterminedError,
    as_path,
    needed,
)
from six_wheel.kinematics.geometry import Pose, Twist
from six_wheel.kinematics.keywords import checked, unknown_keyword
from six_wheel.kinematics.lazy import attach
from six_wheel.kinematics.objects.notebooks import shown_in_notebooks
from six_wheel.kinematics.objects.rollout_cost import RolloutCost

if TYPE_CHECKING:
    # isort: off
    from six_wheel import calibration as calibration, cli as cli, control_loop as control_loop
    from six_wheel import kinematics as kinematics, log_odometry as log_odometry, logs as logs, maps as maps
    from six_wheel import parallel as parallel, plotting as plotting, reference as reference
    from six_wheel import robot_description as robot_description, simulation as simulation

    # isort: on
    from six_wheel.calibration import calibrate
    from six_wheel.control_loop.replay import replay
    from six_wheel.kinematics.four_axle import FourAxleState, FourAxleStep
    from six_wheel.kinematics.odometry import OdometryHealth, SlipReport, Track, Track3
    from six_wheel.kinematics.statuses import BoundsStatus, FeasibilityLimits, FeasibilityReason, SettleStatus
    from six_wheel.log_odometry import dead_reckon
    from six_wheel.log_odometry.evaluation import evaluate, umbmark
    from six_wheel.logs import GroundTruth, WheelLog
    from six_wheel.maps import traverse
    from six_wheel.plotting import plot as plot
    from six_wheel.simulation import simulate
    from six_wheel.simulation.drive import drive
    from six_wheel.view.opening import view as view

__all__ = [
    "ArgumentTypeError",
    "BodySlip",
    "BoundsStatus",
    "Controller",
    "ControllerOutput",
    "ControllerRun",
    "Costmap",
    "Encoder",
    "Feasibility",
    "FeasibilityLimits",
    "FeasibilityReason",
    "FourAxle",
    "FourAxleState",
    "FourAxleStep",
    "GroundCommand",
    "GroundMotion",
    "GroundTruth",
    "Gyroscope",
    "InfeasibleMotionError",
    "Limits",
    "Link",
    "MarginJacobian",
    "Mobility",
    "Mppi",
    "MppiPlan",
    "Noise",
    "Odometry",
    "Odometry3",
    "Odometry3State",
    "OdometryHealth",
    "OdometryState",
    "Pose",
    "PoseBounds",
    "Preintegrated",
    "Reason",
    "RockerBogie",
    "RolloutCost",
    "Rover",
    "SettleStatus",
    "SettledPose",
    "SlipReport",
    "Stability",
    "SteeringCommand",
    "Suspension",
    "SuspiciousUnitsWarning",
    "Terrain",
    "Track",
    "Track3",
    "Traction",
    "Twist",
    "TwistFit",
    "TwistJacobian",
    "UnderdeterminedError",
    "Wheel",
    "WheelLog",
    "WheelSlip",
    "__version__",
    "body_slip",
    "calibrate",
    "compose",
    "config",
    "dead_reckon",
    "default_threads",
    "differentiate",
    "drive",
    "evaluate",
    "exp",
    "integrate",
    "load",
    "log",
    "plot",
    "profiles",
    "read_log",
    "replay",
    "rollout",
    "se2",
    "set_default_threads",
    "simd_levels",
    "simulate",
    "traverse",
    "umbmark",
    "wrap_angle",
]

# Left out of `dir`: names that `se2` and `config` have too, results that only calls make, and rooms whose
# functions are here.
_BESIDE = (
    *("compose", "exp", "log", "wrap_angle", "default_threads", "set_default_threads", "simd_levels"),
    *("BodySlip", "FourAxleState", "FourAxleStep", "GroundCommand", "GroundMotion", "Link", "MarginJacobian"),
    *("Mobility", "MppiPlan", "RolloutCost", "SteeringCommand", "Traction", "WheelSlip"),
    *("calibration", "cli", "control_loop", "kinematics", "log_odometry", "parallel", "plotting"),
    *("robot_description", "simulation"),
)


@checked()
def load(
    path: str | PathLike[str],
    *,
    node: str | None = None,
    kind: str | None = None,
    wheel_radius: float | None = None,
) -> Rover:
    """Read a rover from a file as teams have it: ROS 2 parameters, plain keys, a URDF or xacro file.

    Parameters
    ----------
    path : str or PathLike
        A YAML or JSON file, or a robot description ending in ``.urdf`` or ``.xacro``; or the name of one of
        `Rover.presets`, unless there is a file of that name.
    node : str, optional
        Node of a parameter file that describes the rover, where several do.
    kind : str, optional
        The kind or the controller whose keys a parameter file has, where it does not say by itself.
    wheel_radius : float, optional
        Hub to ground [m], for a robot description whose shapes do not tell it.

    Returns
    -------
    Rover
        With the file's joint names, so that `commands` come out in the file's order; with its `suspension`
        where the file describes a rocker-bogie.

    Raises
    ------
    six_wheel.robot_description.diagnostics.ParameterFileError
        A `ValueError` that lists every mistake in the file with its line, the rule and a remedy.
    ModuleNotFoundError
        If what reads such files is not installed; the message has the install line.
    """
    if str(path).endswith((".urdf", ".xacro")):
        from six_wheel.robot_description.urdf import read_urdf

        return read_urdf(path, wheel_radius=wheel_radius).rover
    if isinstance(path, str) and path in Rover.presets() and not exists(path):
        return Rover.preset(path)
    if wheel_radius is not None:
        raise ValueError(f"wheel_radius must be left out except for a URDF or xacro file, got {wheel_radius}")
    with needed("six-wheel[cli]", "parameter files need"):
        from six_wheel.robot_description.parameters import file
    return file.load(path, node=node, kind=kind)


@checked()
def read_log(
    path: str | PathLike[str] | Any, rover: Rover, *, truth: str | PathLike[str] | None = None, **options: Any
) -> "WheelLog":
    """Read the wheel readings of a drive from a file as it is, or from a table in memory.

    Parameters
    ----------
    path : str, PathLike, or DataFrame
        A CSV or Parquet table, a ROS bag, a record; a DataFrame, a `pyarrow.Table` or a dict of columns.
    rover : Rover
        Names the joints.
    truth : str or PathLike, optional
        The file with the true poses, where the log has none.
    **options
        Facts beside the log: `columns`, `wheel_encoders`, `steering_encoders`, `topics`, `stamp_unit`
        and others of `six_wheel.logs.LogOptions`; of a table in memory `name` and options of `Odometry`.

    Returns
    -------
    WheelLog
        Angles in radians from a file; what `six_wheel.logs.read_log` has found beside it is not here.

    Raises
    ------
    six_wheel.logs.TableError
        A `ValueError` that names file, row and remedy, if the log or the truth cannot be used.
    """
    from six_wheel.logs import LogOptions, WheelLog, detect_reader
    from six_wheel.logs.frames.tabular_input import check_table

    if isinstance(path, str) or hasattr(path, "__fspath__"):
        import inspect

        known_options = ("path", "rover", "truth", *inspect.signature(LogOptions).parameters)
        for name in options.keys() - set(known_options):
            raise TypeError(unknown_keyword("read_log", name, known_options))
        known = None if truth is None else as_path("truth", truth)
        return detect_reader.read_log(path, rover, truth=known, **options)[0]
    if truth is not None:
        raise ValueError("truth must be left out for a table in memory: give it x, y and yaw")
    check_table("path", path)
    return WheelLog.from_pandas(path, rover, **options)


def _as_command(name: str) -> str:
    """A hint for the names of commands, which are not in the package."""
    from six_wheel.cli.names import COMMANDS, PROGRAM

    return f"; it is a command: {PROGRAM} {name} in a shell" if name in COMMANDS else ""


shown_in_notebooks(ControllerRun, Costmap, FourAxle, Rover, SettledPose, Suspension, Terrain, TwistFit)

if not TYPE_CHECKING:  # names that are loaded when they are used have their types above
    __getattr__, __dir__ = attach(
        __name__,
        {
            "calibration": ("calibrate",),
            "cli": (),
            "control_loop": (),
            "control_loop.replay": ("replay",),
            "kinematics": (),
            "kinematics.four_axle": ("FourAxleState", "FourAxleStep"),
            "kinematics.odometry": ("OdometryHealth", "SlipReport", "Track", "Track3"),
            "kinematics.statuses": ("BoundsStatus", "FeasibilityReason", "SettleStatus", "FeasibilityLimits"),
            "log_odometry": ("dead_reckon",),
            "log_odometry.evaluation": ("evaluate", "umbmark"),
            "logs": ("WheelLog", "GroundTruth"),
            "maps": ("traverse",),
            "parallel": (),
            "plotting": ("plot",),
            "reference": (),
            "robot_description": (),
            "simulation": ("simulate",),
            "simulation.drive": ("drive",),
            "view": (),
        },
        beside=_BESIDE,
        hint=_as_command,
    )
