"""An argument of another kind is refused in one line: its name, what is wanted, what came, what to give."""

import re

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.simulation.planar import Slip

ROVER = sw.Rover.preset("perseverance")
ARM = sw.RockerBogie.preset("perseverance")
GROUND = sw.Terrain(np.zeros((50, 50)), spacing=0.5)
STAND = ARM.settle(GROUND, (10, 10, 0))
COURSE = (np.arange(3.0), np.zeros((3, 3)))
A_FILE = "give sw.load(...) of a file, or sw.Rover.preset(...) of one of Rover.presets()"

WRONG = {
    "a preset": (
        lambda: sw.Odometry("perseverance"),
        "rover must be a Rover, got 'perseverance': give sw.Rover.preset(\"perseverance\")",
    ),
    "a file": (lambda: sw.Controller("rover.yaml"), f"rover must be a Rover, got 'rover.yaml': {A_FILE}"),
    "None": (lambda: sw.Controller(None), "rover must be a Rover, got None: give one that sw.Rover makes"),
    "an arm": (lambda: sw.Mppi(ARM), "rover must be a Rover, got a RockerBogie: give its planar(...)"),
    "limits": (
        lambda: sw.Controller(ROVER, 1.0),
        "limits must be Limits, got 1.0: give sw.Limits(speed=1.0)",
    ),
    "a dict": (
        lambda: sw.Mppi(ROVER, {"speed": 1}),
        "limits must be Limits, got a dict: give sw.Limits(**...)",
    ),
    "noise": (lambda: sw.Odometry(ROVER, 0.1), "noise must be a Noise, got 0.1: give sw.Noise(speed=0.1)"),
    "its noise": (
        lambda: sw.Preintegrated(ROVER, noise={}),
        "noise must be a Noise, got a dict: give sw.Noise(**...)",
    ),
    "gyroscope": (
        lambda: sw.Odometry(ROVER, gyroscope=0.1),
        "gyroscope must be a Gyroscope, got 0.1: give sw.Gyroscope(noise=0.1)",
    ),
    "encoders": (
        lambda: sw.Odometry(ROVER, wheel_encoders=5),
        "wheel_encoders must be an Encoder, several of them or a dict of them by name, got 5",
    ),
    "in space": (
        lambda: sw.Odometry3(ROVER),
        "suspension must be a Suspension, such as a RockerBogie, got a Rover: give one like sw.RockerBogie.",
    ),
    "heights": (
        lambda: ARM.settle(np.zeros((3, 3)), (0, 0, 0)),
        "ground must be a Terrain, got an ndarray: give sw.Terrain(heights, spacing=...)",
    ),
    "a map": (
        lambda: ARM.bounds("map.tif", (0, 0, 0)),
        "ground must be a Terrain, got 'map.tif': give sw.Terrain.read('map.tif')",
    ),
    "its stand": (
        lambda: ARM.stability(5, mass=1.0),
        "stand must be a SettledPose, got 5: give what settle(...) has returned",
    ),
    "a stand": (
        lambda: ARM.inverse(5, (0.1, 0)),
        "stand must be a SettledPose, got 5: give what settle(...) has returned",
    ),
    "a number": (lambda: ARM.stability(STAND, mass="1"), "mass must be a number, got '1'"),
    "a time": (lambda: sw.Controller(ROVER, timeout="0.5"), "timeout must be a number, got '0.5'"),
    "a bool": (
        lambda: sw.Wheel("a", 0, 0, radius=1, steered="yes"),
        "steered must be True or False, got 'yes'",
    ),
    "threads": (
        lambda: ROVER.inverse(np.zeros((9, 3)), threads=2.5),
        "threads must be a whole number, got 2.5",
    ),
    "no count": (
        lambda: ROVER.inverse(np.zeros((9, 3)), threads=True),
        "threads must be a whole number, got True",
    ),
    "level": (lambda: ROVER.inverse(np.zeros((9, 3)), level=5), "level must be a str, got 5"),
    "a name": (lambda: sw.Rover.preset(5), "name must be a str, got 5"),
    "a method": (lambda: ROVER.fit([0] * 4, [0] * 6, method=5), "method must be a str, got 5"),
    "belly": (lambda: ARM.bounds(GROUND, (9, 9, 0), belly=3), "belly must be four numbers, got 3"),
    "costmap": (
        lambda: sw.Mppi(ROVER).step((0, 0, 0), goal=(1, 0), costmap=np.zeros((3, 3))),
        "costmap must be a Costmap, got an ndarray: give sw.Costmap(costs, spacing=...)",
    ),
    "another": (lambda: sw.Preintegrated(ROVER).merge(5), "other must be a Preintegrated, got 5"),
    "a reckoned rover": (
        lambda: sw.dead_reckon("husky", *COURSE),
        "rover must be a Rover, got 'husky': give one that sw.Rover makes, or sw.load(...) of a file",
    ),
    "a simulated rover": (
        lambda: sw.simulate("husky", COURSE),
        "rover must be a Rover, got 'husky': give sw.Rover.preset(\"husky\")",
    ),
    "simulated noise": (
        lambda: sw.simulate(ROVER, COURSE, noise=0.1),
        "noise must be a Noise, got 0.1: give sw.Noise(speed=0.1)",
    ),
    "simulated slip": (
        lambda: sw.simulate(ROVER, COURSE, slip=0.1),
        "slip must be a Slip or several, got 0.1",
    ),
    "simulated encoders": (
        lambda: sw.simulate(ROVER, COURSE, wheel_encoders=0.1),
        "wheel_encoders must be an Encoder, several of them or a dict of them by name, got 0.1",
    ),
    "simulated ground": (
        lambda: sw.simulate(ARM, COURSE, ground=5),
        "ground must be a Terrain, got 5: give sw.Terrain(heights, spacing=...)",
    ),
    "a map's path": (lambda: sw.Terrain.read(5), "path must be a path, got 5"),
    # pyo3's own errors of these named no argument: "'int' object is not an instance of 'Sequence'".
    "names": (lambda: sw.Suspension.rigid(np.eye(3), 0.1, names=3), "names must be a list of str, got 3"),
    "names of a rover": (
        lambda: sw.Rover.swerve(np.eye(3)[:, :2], 0.1, names=5),
        "names must be a list of str, got 5",
    ),
    "steered wheels": (
        lambda: sw.Suspension.rigid(np.eye(3), 0.1, steered=0),
        "steered must be a list of whole numbers from 0 on, got 0",
    ),
    "a URDF's name": (lambda: ROVER.urdf(name=3), "name must be a str, got 3"),
    "a URDF's name in space": (lambda: ARM.urdf(name=3), "name must be a str, got 3"),
    "weights": (lambda: sw.Mppi(ROVER, cost_weights=[1]), "cost_weights must be a dict, got a list"),
    "extra costs": (
        lambda: sw.Mppi(ROVER).step((0, 0, 0), extra_cost=3),
        "extra_cost must be a function, got 3",
    ),
    "joints": (lambda: ROVER.readings(3), "joints must be a mapping, got 3"),
    "joints of wheels": (
        lambda: sw.Rover(ROVER.wheels, traction_joints=3),
        "traction_joints must be a mapping, got 3",
    ),
    "reversed joints": (
        lambda: sw.Rover(ROVER.wheels, reversed_joints=3),
        "reversed_joints must be a list of str, got 3",
    ),
    "spacing as text": (
        lambda: sw.Terrain(np.zeros((3, 3)), "12"),
        "spacing must be a number, got '12'",
    ),
    "spacing of three": (
        lambda: sw.Costmap(np.zeros((3, 3)), [1, 2, 3]),
        "spacing must be a number or two numbers, got [1, 2, 3]",
    ),
    # The text of these was that of the array, in several lines.
    "horizon as a table": (
        lambda: sw.Mppi(ROVER, horizon=np.zeros((2, 3))),
        "horizon must be a whole number, got array([[0., 0., 0.], [0., 0., 0.]])",
    ),
    "seed as a table": (
        lambda: sw.Mppi(ROVER, seed=np.eye(2)),
        "seed must be a whole number, got array([[1., 0.], [0., 1.]])",
    ),
}


@pytest.mark.parametrize(("call", "message"), WRONG.values(), ids=WRONG)
def test_another_kind_is_named(call, message):
    with pytest.raises(TypeError, match="^" + re.escape(message)) as caught:
        call()
    assert isinstance(caught.value, ValueError)
    assert "\n" not in str(caught.value)


def test_ragged_costs_are_named():
    with pytest.raises(
        ValueError, match="^values must be numbers of one rectangular shape, got a ragged list"
    ):
        sw.Costmap([[1.0], [1.0, 2.0]], 1.0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: sw.Controller(ROVER).command(0.2, 0, 0.1),
            "Controller.command() takes one twist, as in command((vx, vy, omega), stamp), got 3 arguments",
        ),
        (
            lambda: sw.Controller(ROVER).command(0.2, 0, 0.1, 0.0),
            "Controller.command() takes one twist, as in command((vx, vy, omega), stamp), got 4 arguments",
        ),
        (
            lambda: sw.Odometry(ROVER).command(0.2, 0, 0.1),
            "Odometry.command() takes one twist, as in command((vx, vy, omega), stamp), got 3 arguments",
        ),
        (
            lambda: sw.Mppi(ROVER).step(0, 0, 0),
            "Mppi.step() takes one state, as in step((x, y, yaw)), got 3 arguments",
        ),
    ],
)
def test_numbers_one_by_one_belong_into_one_row(call, message):
    with pytest.raises(TypeError, match="^" + re.escape(message)):
        call()


def test_a_file_is_asked_for_by_its_path():
    pytest.importorskip("yaml")
    with pytest.raises(TypeError, match="^path must be a path, got 5"):
        sw.load(5)


def test_a_calibration_asks_too():
    pytest.importorskip("scipy")
    with pytest.raises(TypeError, match="^rover must be a Rover, got None: give one that sw.Rover makes"):
        sw.calibrate(None, 5)
    log = sw.simulate(ROVER, COURSE)
    with pytest.raises(TypeError, match="^parameters must be 'auto' or names, got 5"):
        sw.calibrate(ROVER, log, parameters=5)
    with pytest.raises(TypeError, match="^window must be a number or several, got 'x'"):
        sw.calibrate(ROVER, log, window="x")
    with pytest.raises(ValueError, match="^confidence must be a number, got 'x'"):
        sw.calibrate(ROVER, log, confidence="x")


def test_what_is_right_stays_right():
    slip = Slip(0.5, 1.0, ratio=0.3)
    assert len(sw.simulate(ROVER, COURSE, slip=slip)) == len(sw.simulate(ROVER, COURSE, slip=[slip]))
    assert ROVER.inverse(np.zeros((9, 3)), threads=np.int64(1))[0].shape == (9, 4)
    assert sw.Controller(ROVER, timeout=None) is not None
    assert sw.Controller(ROVER, timeout=np.float32(1)) is not None
