"""Settings that are likely in degrees: one warning for a call, at the caller's line, with the value meant."""

import math
import re
import warnings

import numpy as np
import pytest

import six_wheel as sw
from tests.rovers import CORNERS, SIX_SIZES

CENTRES = [(0.3, 0.2, 0.1), (0.3, -0.2, 0.1), (-0.3, 0.0, 0.1)]
QUARTER, EIGHT = math.pi / 2, 8 * math.pi


def six(limit):
    return sw.Rover.six_wheel(**SIX_SIZES, steering_limit=limit)


def wheel(limit):
    return sw.Wheel("w", 0.1, 0.2, radius=0.1, steered=True, steering_limit=limit)


# The largest value that is not questioned, and the call that takes it.
BOUNDS = {
    "Limits(steering_limit)": (math.pi, lambda value: sw.Limits(steering_limit=value)),
    "Limits(steering_rate)": (EIGHT, lambda value: sw.Limits(steering_rate=value)),
    "Limits(yaw_rate)": (EIGHT, lambda value: sw.Limits(yaw_rate=value)),
    "Noise(steering)": (0.5, lambda value: sw.Noise(steering=value)),
    "Noise(yaw_rate)": (EIGHT, lambda value: sw.Noise(yaw_rate=value)),
    "Noise.replace": (0.5, lambda value: sw.Noise().replace(steering=value)),
    **{
        f"FeasibilityLimits({name})": (
            QUARTER,
            lambda value, name=name: sw.FeasibilityLimits(**{name: value}),
        )
        for name in ("roll", "pitch", "tilt", "rocker", "bogie")
    },
    "FeasibilityLimits, by place": (QUARTER, lambda value: sw.FeasibilityLimits(value)),
    "FeasibilityLimits.replace": (QUARTER, lambda value: sw.FeasibilityLimits().replace(tilt=value)),
    "Wheel": (math.pi, wheel),
    "Wheel, a pair": (math.pi, lambda value: wheel((-value, 0.5))),
    "Wheel.replace": (math.pi, lambda value: wheel(1.0).replace(steering_limit=value)),
    "six_wheel": (math.pi, six),
    "Rover.replace": (math.pi, lambda value: six(1.0).replace(steering_limit=value)),
    "ackermann": (
        math.pi,
        lambda value: sw.Rover.ackermann(1.0, 0.6, 0.2, steering_limit={"front_left": value}),
    ),
    "swerve": (10 * math.pi, lambda value: sw.Rover.swerve(CORNERS, 0.1, steering_limit=value)),
    "RockerBogie": (math.pi, lambda value: sw.RockerBogie.preset("rocky7").replace(steering_limit=value)),
    "rigid": (math.pi, lambda value: sw.Suspension.rigid(CENTRES, 0.1, steered=[0], steering_limit=value)),
    "preset": (math.pi, lambda value: sw.Rover.preset("perseverance", steering_limit=value)),
}


@pytest.mark.parametrize("case", BOUNDS)
def test_beyond_the_bound_there_is_one_warning_at_it_none(case):
    largest, call = BOUNDS[case]
    for value, count in ((largest, 0), (np.nextafter(largest, math.inf), 1), (57.0, 1)):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            call(float(value))
        assert [each.category for each in caught] == [sw.SuspiciousUnitsWarning] * count
        assert [each.filename for each in caught] == [__file__] * count
    assert re.search(r"57 rad(/s)? is 9.072 turns", str(caught[0].message))
    assert re.search(r"57 degrees( per second)? are 0.9948 rad", str(caught[0].message))


@pytest.mark.parametrize("value", [math.inf, None])
def test_without_a_limit_nothing_is_asked(value):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sw.Limits(steering_limit=value, steering_rate=value, yaw_rate=value)
        wheel(value)
        sw.Rover.swerve(CORNERS, 0.1, steering_limit=value)
        six(value)
        sw.FeasibilityLimits(tilt=math.inf)
        sw.Limits(angular_acceleration=1e3, steering_acceleration=1e3, wheel_speed=1e3)


def test_several_of_them_are_one_warning():
    with pytest.warns(sw.SuspiciousUnitsWarning) as caught:
        sw.Limits(steering_rate=60, steering_limit=45)
    assert len(caught) == 1
    text = str(caught[0].message)
    assert "steering_rate of 60 rad/s is 9.549 turns per second; 60 degrees per second are 1.047 rad" in text
    assert "steering_limit of 45 rad is 7.162 turns; 45 degrees are 0.7854 radians" in text


def test_the_line_is_the_callers_through_any_of_our_own():
    with pytest.warns(sw.SuspiciousUnitsWarning) as caught:
        six(1.0).replace(steering_limit=60)
    assert len(caught) == 1
    assert caught[0].filename == __file__


def test_a_file_is_warned_of_at_its_lines(tmp_path):
    pytest.importorskip("pydantic", reason="needs what reads parameter files")
    from six_wheel.robot_description.parameters import read_parameters

    path = tmp_path / "rover.yaml"
    lines = [
        "preset: perseverance",
        "steering_limit: 45.0",
        "limits:",
        "  steering_rate: 60.0",
        "  speed: 1.0",
    ]
    path.write_text("\n".join([*lines, "noise: {steering: 1.0}"]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = [(each.line, each.message, each.remedy) for each in read_parameters(path).warnings]
    assert found == [
        (2, "steering_limit of 45 rad is 7.162 turns", "45 degrees are 0.7854 radians"),
        (4, "steering_rate of 60 rad/s is 9.549 turns per second", "60 degrees per second are 1.047 rad/s"),
        (6, "steering of 1 rad is 0.1592 turns", "1 degree is 0.01745 radians"),
    ]
