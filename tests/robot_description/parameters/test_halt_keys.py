"""Keys of the halt and of joints that do not follow; limits that are given as none."""

import math
from pathlib import Path

import pytest

pytest.importorskip("pydantic", reason='needs pip install "six-wheel[cli]"')

import six_wheel as sw
from six_wheel.kinematics.rover_edit import limits_given
from six_wheel.robot_description.diagnostics import ParameterFileError
from six_wheel.robot_description.parameters import dump, read_parameters
from six_wheel.robot_description.parameters.file import parse_parameters

ROVER = "kind: six_wheel\nd1: 0.4\nd2: 0.5\nd3: 0.5\nd4: 0.45\nwheel_radius: 0.15\n"


def test_they_are_read_and_come_back(tmp_path: Path):
    text = (
        ROVER
        + "limits: {speed: 1.0, acceleration: 0.5, halt_deceleration: 2.0, jerk: .inf}\n"
        + "control: {following_error: 0.3, following_time: 1.0}\n"
    )
    found = parse_parameters(text)
    assert found.limits == sw.Limits(speed=1.0, acceleration=0.5, halt_deceleration=2.0, jerk=math.inf)
    assert found.control == {"following_error": 0.3, "following_time": 1.0}
    path = tmp_path / "rover.yaml"
    path.write_text(dump(found.rover, limits=found.limits, control=found.control))
    again = read_parameters(path)
    assert (again.limits, again.control) == (found.limits, found.control)
    assert limits_given(again.limits) == limits_given(found.limits)
    assert "jerk: .inf" in path.read_text()
    assert "\ndeceleration" not in path.read_text().replace(" ", "")  # it was not given


def test_never_is_none(tmp_path: Path):
    found = parse_parameters(ROVER + "control: {following_error: never}\n")
    assert found.control == {"following_error": None}
    assert "following_error: never" in dump(found.rover, control=found.control)
    controller = found.build_controller()
    for k in range(400):
        controller.command((0.5, 0.0, 0.5), 0.01 * k)
        out = controller.step(0.01 * k, [0.0] * 4)
    assert not controller.halted
    assert not out.reasons & sw.Reason.JOINT_STUCK


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("limits: {halt_deceleration: 0}", "limits.halt_deceleration must be finite and positive, got 0"),
        (
            "limits: {deceleration: 1.0, halt_deceleration: 0.5}",
            "halt_deceleration must be at least deceleration",
        ),
        ("control: {following_time: never}", "control.following_time must be a number, got 'never'"),
        ("control: {following_error: -0.1}", "control.following_error must be finite and positive, got -0.1"),
        (
            "control: {following_eror: 0.1}",
            "unknown key control.following_eror (did you mean following_error?)",
        ),
    ],
)
def test_what_cannot_be_is_named(line: str, message: str):
    with pytest.raises(ParameterFileError) as caught:
        parse_parameters(f"{ROVER}{line}\n")
    assert message in str(caught.value)
