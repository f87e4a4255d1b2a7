"""Commands by name: whichever way joints and arrays are paired, a joint gets its own value."""

import inspect
import pickle

import numpy as np
import pytest

import six_wheel as sw
from tests.rovers import SIX_SIZES

STEERING = {"spare": "rear_right", "b": "front_right", "a": "front_left", "c": "rear_left"}
ROVER = sw.Rover(sw.Rover.preset("open_source_rover").wheels, steering_joints=STEERING)
TWIST = (0.2, 0.0, 0.1)


def test_joints_zip_with_arrays_though_a_file_had_them_in_another_order():
    # Once joints came in the file's order, arrays in that of the wheels: 0.351 went where -0.233 belonged.
    steering, speeds = ROVER.inverse(TWIST)
    commands = ROVER.commands(TWIST)
    assert dict(zip(ROVER.steering_joints, steering, strict=True)).items() <= commands.items()
    assert dict(zip(ROVER.traction_joints, speeds, strict=True)).items() <= commands.items()
    assert list(commands) == list(ROVER.joint_names)
    assert list(commands)[:4] == list(STEERING)  # as given


def test_the_controller_commands_by_name():
    controller = sw.Controller(ROVER, sw.Limits(speed=1.0))
    controller.command(TWIST, 0.0)
    for k in range(300):
        output = controller.step(0.001 * k)
    assert list(output.commands) == list(ROVER.joint_names)
    assert output.commands == pytest.approx(ROVER.commands(output.twist), abs=1e-12)
    run = controller.run([TWIST], [0.31], np.arange(0.4, 0.5, 0.01))
    shapes = {name: values.shape for name, values in run.commands.items()}
    assert shapes == dict.fromkeys(ROVER.joint_names, (10,))
    np.testing.assert_array_equal(
        run.commands["a"], run.steering[:, ROVER.steered_wheel_names.index("front_left")]
    )


def test_a_rover_keeps_the_order_it_was_given():
    again = eval(repr(ROVER), {"Rover": sw.Rover, "Wheel": sw.Wheel})
    assert again == ROVER
    assert again.joint_names == ROVER.joint_names


def test_flags_print_their_names():
    assert str(sw.OdometryHealth(0)) == "GOOD"
    assert (
        str(sw.OdometryHealth.LEFT_OUT)
        == "NOT_FINITE|DUPLICATE|BACKWARDS|JUMP|UNDETERMINED|OVERTURNED|OFF_GROUND"
    )
    assert f"{sw.OdometryHealth.DUPLICATE:>12}|{sw.OdometryHealth.DUPLICATE:d}" == "   DUPLICATE|32"


def test_reasons_have_texts_of_their_own():
    texts = [reason.help for reason in sw.Reason]
    assert all(texts)
    assert len(set(texts)) == len(texts)
    for reason in sw.Reason:
        assert str(reason) == f"{reason}" == f"{reason.name}: {reason.help}"
        if reason.name.lower() in inspect.signature(sw.Limits).parameters:
            assert f"`{reason.name.lower()}`" in reason.help  # the limit that was broken
    both = sw.Reason.STALE | sw.Reason.SPEED
    assert str(both) == f"{sw.Reason.SPEED}; {sw.Reason.STALE}"
    assert both.help == f"{sw.Reason.SPEED.help}; {sw.Reason.STALE.help}"
    assert str(sw.Reason(0)) == f"{sw.Reason(0)}" == "none"
    assert sw.Reason(0).help == ""
    assert f"{both:d}" == "65568"
    assert pickle.loads(pickle.dumps(both)) == both == sw.Reason(65568)


def test_three_numbers_are_no_twist():
    with pytest.raises(
        TypeError, match=r"Rover\.inverse\(\) takes one twist, as in inverse\(\(vx, vy, omega\)\), got 3"
    ):
        ROVER.inverse(0.2, 0.0, 0.1)


def test_angles_in_messages_are_short_and_in_degrees_too():
    rover = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=1.0)
    with pytest.raises(sw.InfeasibleMotionError) as caught:
        rover.inverse((0.5, 0.0, 1.5))
    assert "within -1.0 to 1.0 rad (-57.3° to 57.3°) (at -1.0 rad (-57.3°) it would slide" in str(
        caught.value
    )
