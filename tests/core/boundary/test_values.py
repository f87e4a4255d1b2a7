"""Immutable values: every one can be had again with other arguments of its constructor."""

import copy
import inspect
import math
import pickle
import re
import sys

import numpy as np
import pytest

import six_wheel as sw
from six_wheel import profiles
from six_wheel.kinematics.four_axle import FourAxleState, FourAxleStep
from tests.rovers import SIX_SIZES, SIX_WHEELS

ARM = sw.RockerBogie.preset("rocky7")
SIX = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=1.2)

# A value of every class, and another value for each of the arguments that make it.
VALUES = {
    sw.Wheel: (
        sw.Wheel("w", 0.1, 0.2, radius=0.1, steered=True),
        {
            "name": "v", "x": 0.3, "y": 0.4, "radius": 0.2, "steered": False, "heading": 0.5,
            "steering_limit": (-0.5, 1.0), "scrub": 0.01, "trail": 0.02, "driven": False,
        },
    ),
    sw.Noise: (
        sw.Noise(speed=0.02),
        {
            "speed": 0.03, "steering": 0.01, "slip": 0.04, "side_slip": 0.05, "yaw": 0.06, "yaw_rate": 0.07,
            "period": 0.1,
        },
    ),
    sw.Encoder: (
        sw.Encoder(4096), {"ticks_per_turn": 100.0, "gear_ratio": 30.0, "wraps_at": 65536.0, "offset": 0.1},
    ),
    sw.Gyroscope: (
        sw.Gyroscope(),
        {"noise": 0.1, "bias": 0.2, "bias_noise": 0.3, "bias_walk": 0.4, "scale_noise": 0.5},
    ),
    sw.RockerBogie: (
        ARM,
        {
            "rocker_pivot": (0.1, 0.3, 0.1), "rocker_to_front": (0.2, 0.0, -0.1),
            "rocker_to_bogie": (-0.1, 0.0, -0.05), "bogie_to_middle": (0.1, 0.05, -0.1),
            "bogie_to_rear": (-0.1, 0.05, -0.1), "wheel_radius": 0.07, "steered": "corners",
            "steering_limit": 0.5, "rocker_limit": 0.2, "bogie_limit": 0.3,
            "differential_bar": (0.2, 0.1, 0.1),
        },
    ),
    sw.Suspension: (
        sw.Suspension.pivoting_axles(wheelbase=1.9, track_width=1.6, drop=0.1, wheel_radius=0.3),
        {
            "wheelbase": 1.0, "track_width": 1.1, "drop": 0.2, "wheel_radius": 0.4, "steering_limit": 0.5,
            "roll_limit": 0.4,
        },
    ),
    sw.FourAxle: (
        sw.FourAxle((0.4, 0.3), 0.2, 0.1),
        {
            "pivots": (0.5, 0.3), "axle_length": 0.3, "wheel_radius": 0.2, "steering_limit": 1.0,
            "tolerance": 0.01,
        },
    ),
    sw.Terrain: (
        sw.Terrain(np.eye(3), 0.1),
        {"heights": np.ones((2, 2)), "spacing": (0.2, 0.3), "origin": (1.0, 2.0), "yaw": 0.3},
    ),
    sw.Costmap: (
        sw.Costmap(np.eye(3), 0.1, (1.0, 2.0), frame="map"),
        {
            "values": np.ones((2, 2)), "spacing": (0.2, 0.3), "origin": (0.0, 0.0), "lethal": 0.5,
            "outside": 0.7,
            "frame": "odom",
        },
    ),
    sw.FeasibilityLimits: (
        sw.FeasibilityLimits(),
        {
            "roll": 0.1, "pitch": 0.2, "tilt": 0.3, "rocker": 0.4, "bogie": 0.5, "clearance": 0.6,
            "wheel_drop": 0.7,
        },
    ),
    sw.Twist: (sw.Twist(0.1, 0.2, 0.3), {"vx": 1.0, "vy": 2.0, "omega": 3.0}),
    sw.Pose: (sw.Pose(0.1, 0.2, 0.3), {"x": 1.0, "y": 2.0, "yaw": 3.0}),
    FourAxleState: (
        FourAxleState(),
        {
            "steering": (0.1, 0.2, 0.3, 0.4), "front_brake": "free", "rear_brake": "free",
            "pose": (1.0, 2.0, 3.0),
        },
    ),
    FourAxleStep: (
        FourAxleStep("turn", 1.0, "free", "locked", (1.0, None, 2.0, 3.0)),
        {
            "action": "wait", "duration": 2.0, "front_brake": "locked", "rear_brake": "free",
            "wheel_speeds": (None, 1.0, 2.0, 3.0), "end": FourAxleState(),
        },
    ),
    sw.Rover: (
        SIX_WHEELS,
        {
            "wheels": [wheel.replace(radius=0.2) for wheel in SIX.wheels],
            "traction_joints": {f"drive_{name}": name for name in SIX.wheel_names},
            "steering_joints": {f"steer_{name}": name for name in SIX.steered_wheel_names},
            "reversed_joints": ["front_left_wheel_joint"],
            "suspension": ARM,
        },
    ),
    profiles.Profile: (
        profiles.trapezoid(0.0, 1.0, 2.0),
        {"start": 0.5, "end": 2.0, "duration": 3.0, "ramp": 0.4},
    ),
}  # fmt: skip
CASES = {kind.__name__: case for kind, case in VALUES.items()}
ARGUMENTS = [(name, argument) for name, (_, changes) in CASES.items() for argument in changes]


def public_values():
    """Public classes with equality, and a call that makes an equal one: by pickle, tuples, dataclasses."""
    things = [getattr(module, name) for module in (sw, profiles) for name in module.__all__]
    for kind in {thing for thing in things if inspect.isclass(thing)}:
        has_call = "__reduce__" in vars(kind) or issubclass(kind, tuple) or hasattr(kind, "__post_init__")
        flag = issubclass(kind, int | str | BaseException) or not kind.__module__.startswith("six_wheel")
        if has_call and kind.__eq__ is not object.__eq__ and not flag:
            yield kind


def test_every_public_value_can_be_replaced():
    pytest.importorskip("scipy", reason="walks every public name, and calibration needs SciPy")
    found = set(public_values())
    assert found >= VALUES.keys()
    assert {kind.__name__ for kind in found if not hasattr(kind, "replace")} <= RESULTS
    assert {kind.__name__ for kind in found - VALUES.keys()} <= RESULTS | TRANSITIONS
    assert all("__replace__" in dir(kind) for kind in found if hasattr(kind, "replace"))


# Of the same mechanism as `Profile`.
TRANSITIONS = {"BodyTransition", "ModuleTransition", "IcrTransition"}
# Named tuples of arrays that calls return, and the limits of a controller, which have tests of their own.
RESULTS = {"RolloutCost", "State", "Peaks", "TransitionState", "Phase", "Limits"}


@pytest.mark.parametrize("name", CASES)
def test_nothing_replaced_is_the_same(name):
    value, _ = CASES[name]
    for again in (value.replace(), value.__replace__(), pickle.loads(pickle.dumps(value)), copy.copy(value)):
        assert type(again) is type(value)
        assert again == value
        assert repr(again) == repr(value)


@pytest.mark.parametrize("kind", [sw.Wheel, sw.Noise, sw.Encoder, sw.Gyroscope, sw.FourAxle, sw.Costmap])
def test_equal_values_hash_alike(kind):
    value, _ = VALUES[kind]
    assert hash(pickle.loads(pickle.dumps(value))) == hash(value)


@pytest.mark.parametrize(("name", "argument"), ARGUMENTS)
def test_each_argument_can_be_replaced(name, argument):
    value, changes = CASES[name]
    other = value.replace(**{argument: changes[argument]})
    assert other != value
    assert value.replace() == value  # which has not changed
    back = getattr(value, argument, None)
    if argument in ("radius", "x", "speed", "heights", "values", "roll", "vx", "front", "gear"):
        assert (other.replace(**{argument: back}) == value) is True
    if sys.version_info >= (3, 13):
        assert copy.replace(value, **{argument: changes[argument]}) == other
    if hasattr(other, argument) and isinstance(changes[argument], float | str):
        assert getattr(other, argument) == changes[argument]


@pytest.mark.parametrize("name", CASES)
def test_an_unknown_name_lists_those_there_are(name):
    value, changes = CASES[name]
    with pytest.raises(TypeError, match=re.escape(f"{name}.replace() has no zzz; it takes ")) as caught:
        value.replace(zzz=1)
    assert all(re.search(rf"\b{argument}\b", str(caught.value)) for argument in changes)


def test_what_was_not_given_stays_not_given():
    assert sw.Noise().replace(speed=0.02) == sw.Noise(speed=0.02)  # no guess of slip any more
    assert sw.Noise(speed=0.02).replace(speed=None) == sw.Noise()
    assert pickle.loads(pickle.dumps(sw.Noise())).replace(yaw=0.1) == sw.Noise(yaw=0.1)
    assert sw.Noise(slip=0.1).replace(yaw_rate=0.2) == sw.Noise(slip=0.1, yaw_rate=0.2)
    fixed = sw.Wheel("a", 0.1, 0.0, radius=0.1)
    assert fixed.replace(castor=True, trail=0.1).driven is False
    assert fixed.replace(roller_angle=0.7).replace(roller_angle=None) == fixed
    assert (
        fixed.replace(steered=True, steering_limit=1.0).replace(steering_limit=None).steering_limit
        == math.pi / 2
    )
    assert fixed.replace(steered=True).replace(steered=False) == fixed


def test_a_value_that_may_not_be_is_refused_as_by_the_constructor():
    with pytest.raises(ValueError, match="radius must be finite and positive, got -1"):
        sw.Wheel("a", 0.1, 0.0, radius=0.1).replace(radius=-1.0)
    with pytest.raises(ValueError, match="radius must be a number, got None"):
        sw.Wheel("a", 0.1, 0.0, radius=0.1).replace(radius=None)


def test_a_rover_with_other_wheels():
    joints = {f"drive_{name}": name for name in reversed(SIX.wheel_names)}
    rover = sw.Rover(SIX.wheels, traction_joints=joints, reversed_joints=["drive_front_left"])
    larger = rover.replace(radius=0.08)
    assert [wheel.radius for wheel in larger.wheels] == [0.08] * 6
    assert larger.wheel_names == rover.wheel_names
    assert (larger.joint_names, larger.reversed_joints) == (rover.joint_names, rover.reversed_joints)
    one = rover.replace("front_left", scrub=0.03)
    assert [wheel.scrub for wheel in one.wheels] == [0.03, 0, 0, 0, 0, 0]
    assert one.wheels[1:] == rover.wheels[1:]
    assert one.joint_names == rover.joint_names
    narrow = rover.replace(steering_limit=0.5)
    assert [wheel.steering_limit for wheel in narrow.wheels] == [0.5, 0.5, None, None, 0.5, 0.5]
    both = rover.replace(radius=0.2, reversed_joints=None)
    assert (both.wheels[0].radius, both.reversed_joints) == (0.2, ())


def test_wheels_that_change_stand_on_no_suspension_of_before():
    rover = sw.Rover(ARM.planar().wheels, suspension=ARM)
    assert rover.replace().suspension == rover.replace(reversed_joints=[]).suspension == ARM
    assert rover.replace(radius=0.2).suspension is None
    assert rover.replace(radius=0.2, suspension=ARM).suspension == ARM


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (
            lambda: SIX.replace("nobody", radius=0.1),
            ValueError,
            "wheel must be one of front_left, .*got 'nobody'",
        ),
        (
            lambda: SIX.replace("front_left", wheels=[]),
            TypeError,
            "has no wheels; it takes x, y, radius",
        ),
        (lambda: SIX.replace("front_left", name="a"), TypeError, "has no name; it takes x"),
        (
            lambda: SIX.replace("middle_left", steering_limit=1.0),
            ValueError,
            "steering_limit must be left out",
        ),
        (
            lambda: sw.Rover.differential(1.0, 0.1).replace(steering_limit=1),
            ValueError,
            "where no wheel steers",
        ),
    ],
)
def test_wheels_of_a_rover_that_cannot_be_replaced(call, kind, message):
    with pytest.raises(kind, match=message):
        call()
