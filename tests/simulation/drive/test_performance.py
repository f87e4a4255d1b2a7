"""Performance of a rover within limits, against closed forms."""

import math

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.kinematics.controller import Reason
from six_wheel.simulation.drive.performance import (
    bound,
    defaults,
    halt_from,
    rim,
    stop_from,
    time_to_full_lock,
)
from tests.rovers import CART
from tests.rovers import LIMITED as ROVER

LIMITS = sw.Limits(speed=0.6, yaw_rate=0.9, wheel_speed=6.0, lateral_acceleration=0.2)


def test_the_lowest_limit_binds():
    ahead = bound(ROVER, LIMITS, (1.0, 0.0, 0.0))
    assert ahead is not None
    assert (tuple(ahead.twist), ahead.reasons) == ((0.6, 0.0, 0.0), Reason.SPEED)
    slow = bound(ROVER, sw.Limits(speed=0.6, wheel_speed=2.0), (-1.0, 0.0, 0.0))
    assert slow is not None
    assert slow.twist == pytest.approx((-0.3, 0.0, 0.0), abs=1e-15)
    assert slow.reasons == Reason.WHEEL_SPEED


def test_what_is_not_limited_has_no_bound():
    assert bound(ROVER, sw.Limits(yaw_rate=1.0), (1.0, 0.0, 0.0)) is None
    assert rim(ROVER, sw.Limits(speed=1.0, yaw_rate=1.0)) is not None
    assert rim(ROVER, sw.Limits(yaw_rate=1.0)) is None
    assert rim(ROVER, sw.Limits(speed=1.0)) is None  # it can spin
    assert time_to_full_lock(ROVER, sw.Limits(steering_rate=math.inf)) is None
    assert stop_from(ROVER, sw.Limits(acceleration=math.inf), (1.0, 0.0, 0.0)) is None
    assert halt_from(ROVER, sw.Limits(acceleration=0.5, halt_deceleration=math.inf), (1.0, 0.0, 0.0)) is None


def test_what_is_left_out_has_a_default():
    assert time_to_full_lock(ROVER, sw.Limits(speed=1.0)) == pytest.approx(1.0 / 12.0)
    stop = stop_from(ROVER, sw.Limits(speed=1.0), (1.0, 0.0, 0.0))
    assert stop is not None
    assert stop.distance == pytest.approx(1.0 / (2 * 9.81), rel=1e-2)
    found = defaults(ROVER, sw.Limits(acceleration=0.5, jerk=math.inf, steering_rate=1.0))
    reach = math.hypot(0.5, 0.4)  # of the farthest wheel
    assert found == pytest.approx(
        {
            "deceleration": 0.5,
            "angular_acceleration": 0.5 / reach,
            "angular_deceleration": 0.5 / reach,
            "halt_deceleration": 0.5,
        }
    )
    assert "steering_rate" not in defaults(CART, sw.Limits())


def test_a_halt_has_its_own_deceleration():
    limits = sw.Limits(acceleration=0.5, jerk=1.0, halt_deceleration=2.0)
    halt = halt_from(ROVER, limits, (0.6, 0.0, 0.0))
    assert halt is not None
    assert halt.distance == pytest.approx(0.6**2 / (2 * 2.0), rel=1e-2)
    assert halt.time == pytest.approx(0.6 / 2.0, rel=0.02)


def test_every_direction_reaches_the_limit_that_is_said_to_bind():
    found = rim(ROVER, LIMITS)
    assert found is not None
    ROVER.inverse(found.twists)  # or it raises
    _, speeds = ROVER.inverse(found.twists)
    vx, _, omega = found.twists.T
    reached = {
        Reason.SPEED: np.abs(vx) / 0.6,
        Reason.YAW_RATE: np.abs(omega) / 0.9,
        Reason.WHEEL_SPEED: np.abs(speeds).max(axis=1) / 6.0,
        Reason.LATERAL_ACCELERATION: np.abs(vx * omega) / 0.2,
    }
    assert max(float(share.max()) for share in reached.values()) <= 1.0 + 1e-12
    binding = {kind for reasons in found.reasons for kind in reached if kind in reasons}
    assert len(binding) >= 2
    for k, reasons in enumerate(found.reasons):
        assert any(kind in reasons and share[k] >= 1.0 - 1e-9 for kind, share in reached.items()) or (
            Reason.STEERING_LIMIT in reasons
        )


def test_time_to_full_lock_counts_the_joints_acceleration():
    assert time_to_full_lock(ROVER, sw.Limits(steering_rate=0.5)) == pytest.approx(2.0, abs=1e-12)
    ramped = sw.Limits(steering_rate=0.5, steering_acceleration=1.0)
    assert time_to_full_lock(ROVER, ramped) == pytest.approx(1.0 / 0.5 + 0.5 / 1.0, abs=1e-9)
    narrow = sw.Limits(steering_rate=0.5, steering_limit=0.25)
    assert time_to_full_lock(ROVER, narrow) == pytest.approx(0.5, abs=1e-12)


def test_stopping_counts_deceleration_and_jerk():
    stop = stop_from(ROVER, sw.Limits(deceleration=0.5), (0.6, 0.0, 0.0))
    assert stop is not None
    assert stop.distance == pytest.approx(0.6**2 / (2 * 0.5), rel=1e-3)
    assert stop.time == pytest.approx(0.6 / 0.5, rel=0.01)  # one step
    soft = stop_from(ROVER, sw.Limits(acceleration=0.5, jerk=1.0), (0.6, 0.0, 0.0))
    assert soft is not None
    # Half a second up to the deceleration, as long back: v (v / a + a / j) / 2.
    assert soft.distance == pytest.approx(0.6 * (0.6 / 0.5 + 0.5 / 1.0) / 2, rel=0.01)


def test_the_picture_has_a_colour_for_every_limit_that_binds():
    plot = pytest.importorskip("six_wheel.plotting")
    figure = plot.limits_figure(ROVER, LIMITS, title="rover")
    words = {text.get_text() for text in figure.axes[0].get_legend().get_texts()}
    found = rim(ROVER, LIMITS)
    assert found is not None
    binding = {str(kind.name).lower().replace("_", " ") for kinds in found.reasons for kind in kinds}
    assert words <= binding | {
        "past the steering range",
        "not without side slip",
        "faster than a limit allows",
    }
    assert "past the steering range" in words
    assert {"speed", "lateral acceleration"} <= words
    with pytest.raises(ValueError, match="limits must bound every motion"):
        plot.limits_figure(ROVER, sw.Limits(yaw_rate=1.0))


def test_a_rover_of_any_kind_has_a_picture():
    plot = pytest.importorskip("six_wheel.plotting")
    square = [(0.3, 0.3), (0.3, -0.3), (-0.3, 0.3), (-0.3, -0.3)]
    for rover in (
        sw.Rover.swerve(square, 0.05),
        CART,
        sw.Rover.ackermann(2.5, 1.5, 0.3, steering_limit=0.6),
        sw.Rover.mecanum(0.6, 0.5, 0.08),
    ):
        plot.limits_figure(rover, sw.Limits(speed=1.0, wheel_speed=10.0, yaw_rate=math.pi))
