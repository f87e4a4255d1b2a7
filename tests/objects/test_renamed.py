"""The table of renamed things: every new name is there, every old one is gone."""

import importlib
import re
import subprocess
import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("scipy", reason="walks every public name, and calibration needs SciPy")

import six_wheel as sw
from tests.objects.samples import ARM, ROVER, samples


def names() -> dict[str, Any]:
    """Names for the expressions of the table: an object of every class by its name in small letters."""
    modules = (
        "logs",
        "calibration",
        "log_odometry",
        "simulation",
        "control_loop",
        "maps",
        "kinematics.odometry",
    )
    found: dict[str, Any] = {name.lower(): one for name, one in samples().items()}
    found |= {name.rpartition(".")[2]: importlib.import_module(f"six_wheel.{name}") for name in modules}
    evaluation = importlib.import_module("six_wheel.log_odometry.evaluation")
    zeros = np.zeros((1, 6))
    return found | {
        "sw": sw, "np": np, "arm": ARM, "rover": ROVER, "evaluation_module": evaluation, "zeros": zeros,
        "sides": {"wheelbase": 0.5, "track_width": 0.4},
        "six": {"front_to_middle": 0.5, "middle_to_rear": 0.5, "track_width": 0.8},
    }  # fmt: skip


# Old and new, as expressions; what is called raises for its name alone.
TABLE = [
    ("sw.Rover.six_wheel(0.4, 0.5, 0.5, 0.4, 0.15)", "sw.Rover.six_wheel(**six, wheel_radius=0.15)"),
    ("sw.Rover.six_wheel(d1=0.4, d2=0.5, d3=0.5, d4=0.4, wheel_radius=0.15)", "rover.wheels"),
    ("sw.Rover.mecanum(half_wheelbase=0.2, half_track=0.2, wheel_radius=0.1)",
     "sw.Rover.mecanum(**sides, wheel_radius=0.1)"),
    ("sw.Wheel('a', 0, 0, radius=0.1, steering_range=(-1, 1))",
     "sw.Wheel('a', 0, 0, radius=0.1, steered=True, steering_limit=1.0).steering_range"),
    ("rover.forward(np.zeros(4), speeds=np.zeros(6))",
     "rover.forward(np.zeros(4), wheel_speeds=np.zeros(6))"),
    ("controlleroutput.speeds", "controlleroutput.wheel_speeds"),
    ("groundcommand.speeds", "groundcommand.wheel_speeds"),
    ("traction.speeds", "traction.wheel_speeds"),
    ("mppiplan.speeds", "mppiplan.wheel_speeds"),
    ("steeringcommand.speeds", "steeringcommand.wheel_speeds"),
    ("rolloutcost.wheel_speed", "rolloutcost.max_wheel_speed"),
    ("rolloutcost.steering_angle", "rolloutcost.max_steering_angle"),
    ("rolloutcost.steering_rate", "rolloutcost.max_steering_rate"),
    ("rolloutcost.scrub", "rolloutcost.max_side_slip"),
    ("twistfit.residual", "twistfit.residuals"),
    ("odometrystate.residual", "odometrystate.residuals"),
    ("groundmotion.residual", "groundmotion.residuals"),
    ("odometry3state.slip", "odometry3state.slips"),
    ("track.pose", "track.poses"),
    ("track.twist", "track.twists"),
    ("track.covariance", "track.covariances"),
    ("track.residual", "track[10:20].residuals"),
    ("rover.steered_names", "rover.steered_wheel_names"),
    ("rover.command_joints", "rover.joint_names"),
    ("track3.arm", "track3.suspension"),
    ("sw.Odometry3(arm=arm)", "sw.Odometry3(suspension=arm)"),
    ("arm.frames(rho=0.1)", "arm.frames(joints=(0.1, 0, 0), steering=(0, 0))"),
    ("sw.RockerBogie.perseverance", "sw.RockerBogie.preset('perseverance')"),
    ("sw.RockerBogie.rocky7", "sw.RockerBogie.presets()"),
    ("sw.Suspension.zoe", "sw.Suspension.preset('zoe')"),
    ("terrain.height", "terrain.height_at((0.0, 0.0))"),
    ("terrain.gradient", "terrain.gradient_at((0.0, 0.0))"),
    ("terrain.normal", "terrain.normal_at((0.0, 0.0))"),
    ("terrain.orientation", "terrain.yaw"),
    ("controller.run([0.0], times=[0.1])",
     "sw.Controller(rover, limits).run(twists=[(0, 0, 0)], stamps=[0.0], step_stamps=[0.1])"),
    ("controller.now", "controller.stamp"),
    ("controller.step(now=9.0)", "sw.Controller(rover, limits).step(stamp=9.0)"),
    ("fouraxlesimulation.times", "fouraxlesimulation.stamps"),
    ("sw.Encoder(resolution=10)", "sw.Encoder(ticks_per_turn=10, gear_ratio=2.0, wraps_at=100)"),
    ("encoder.angle_per_count", "encoder.angle_per_tick"),
    ("sw.simulate(rover, [(0, 0, 0, 0), (1, 0.1, 0, 0)], encoder=encoder)",
     "sw.simulate(rover, [(0, 0, 0, 0), (1, 0.1, 0, 0)], wheel_encoders=encoder)"),
    ("logs.LogOptions(encoders={})", "logs.LogOptions(wheel_encoders={})"),
    ("sw.Odometry(rover, readings='increments')", "sw.Odometry(rover, increments=True)"),
    ("odometry.WheelSlip", "odometry.WheelContradiction"),
    ("evaluation.first.heading_rmse", "evaluation.first.yaw_rmse"),
    ("groundtruth.has_headings", "groundtruth.has_yaw"),
    ("evaluation_module.align(zeros[:, :3], zeros[:, :3], how='none')",
     "evaluation_module.align(zeros[:, :3], zeros[:, :3], align='none')"),
    ("slipreport.told", "slipreport.observable"),
    ("track.slip_report(shortest=3)", "track.slip_report(min_rows=3)"),
    ("sw.Mppi(rover, limits, noise=(0.1, 0, 0.1))",
     "sw.Mppi(rover, limits, sampling_std=(0.1, 0, 0.1)).cost_weights"),
    ("sw.Mppi(rover, limits, weights={})", "sw.Mppi(rover, limits, cost_weights={}).sampling_std"),
    ("sw.FourAxle((0.4, 0.3), 0.2, 0.1).hinges", "sw.FourAxle((0.4, 0.3), 0.2, 0.1).pivots"),
    ("fouraxle.forward(angles=(0, 0, 0, 0), speeds=(1, 1, 1, 1))",
     "fouraxle.forward(steering=(0, 0, 0, 0), wheel_speeds=(1, 1, 1, 1))"),
    ("fouraxlemobility.degree", "fouraxlemobility.degree_of_mobility"),
    ("log_odometry.Settings", "log_odometry.ReckonSettings"),
    ("sw.StandLimits", "sw.FeasibilityLimits.curiosity()"),
    ("sw.dead_reckon(rover, wheellog, tell=print)", "sw.dead_reckon(rover, wheellog)"),
    ("maps.traverse(tell=print)", "sw.traverse"),
    ("sw.demo", "sw.se2.compose"),
    ("sw.parameters", "rover.save"),
    ("sw.urdf", "sw.read_log"),
    ("sw.kernels", "sw.config.simd_levels()"),
    ("sw.Health", "sw.OdometryHealth"),
    ("sw.Stand", "sw.SettledPose"),
    ("sw.Fit", "sw.TwistFit"),
    ("sw.Log", "sw.WheelLog"),
    ("sw.Truth", "sw.GroundTruth"),
    ("sw.Bounds", "sw.PoseBounds"),
    ("sw.Sensitivity", "sw.TwistJacobian"),
    ("costmap.resolution", "costmap.spacing"),
    ("sw.Pose(0, 0, 0) * 2", "sw.Pose(0, 0, 0) @ sw.Pose(1, 0, 0)"),
    ("sw.Pose(0, 0, 0) + sw.Pose(0, 0, 0)", "sw.Pose(1, 0, 0).inverse()"),
    ("abs(sw.Twist())", "2 * sw.Twist(vx=1) / 2 + sw.Twist()"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new"), TABLE, ids=[new for _, new in TABLE])
def test_the_new_name_is_there_and_the_old_one_gone(old: str, new: str) -> None:
    known = names()
    eval(new, known)
    with pytest.raises((TypeError, AttributeError, ValueError)):
        eval(old, known)


def help_of(*command: str) -> str:
    done = subprocess.run(
        [sys.executable, "-m", "six_wheel", *command, "--help"], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


OPTIONS = SimpleNamespace(
    odometry=("--start --segment --output-format --log-format --parameters-node --readings --increments",
              "--length --ending --per-sample"),
    calibrate=("--segment --log-format --cluster --parameters", "--window --client"),
    simulate=("--start --plot-speeds", "--speeds"),
    show=("--twist --parameters-node", "--layout"),
    drive=("--plot --parameters-node", "--as"),
    check=("--parameters-node --kind --plot", "--as"),
    traverse=("--limit --cluster --plot", "--rover"),
    convert=("--kind", "--as"),
)  # fmt: skip


@pytest.mark.parametrize("command", vars(OPTIONS))
def test_options_of_commands(command: str) -> None:
    pytest.importorskip("typer")
    there, gone = getattr(OPTIONS, command)
    shown = set(re.findall(r"--[a-z][a-z-]*", help_of(command)))
    assert set(there.split()) <= shown
    assert not set(gone.split()) & shown
