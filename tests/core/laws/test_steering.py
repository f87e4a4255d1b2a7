"""Steering angles: about any centre, held and counted turns, wheels that must agree."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from six_wheel import InfeasibleMotionError, Rover, Wheel, reference
from tests.rovers import CORNERS
from tests.strategies import any_twists

SWERVE = Rover.swerve(CORNERS, 0.05, steering_limit=math.pi / 2)
WIDE = Rover.swerve(CORNERS, 0.05, steering_limit=math.pi)


def towards(degrees: float, speed: float = 1.0) -> tuple[float, float, float]:
    return speed * math.cos(math.radians(degrees)), speed * math.sin(math.radians(degrees)), 0.0


# Centre of rotation


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(0.1, 2))
def test_turning_about_any_point(x, y, omega):
    steering, speeds = SWERVE.inverse((0.0, 0.0, omega), centre=(x, y))
    for (px, py), angle, speed in zip(CORNERS, steering, speeds, strict=True):
        arm = math.hypot(px - x, py - y)
        assert abs(speed) * 0.05 == pytest.approx(omega * arm, abs=1e-14)
        assert math.cos(angle) * (px - x) + math.sin(angle) * (py - y) == pytest.approx(0.0, abs=1e-14)
    twist = SWERVE.forward(steering, speeds)
    assert_allclose(SWERVE.icr(twist), (x, y), rtol=0, atol=1e-12)


def test_a_centre_for_the_call_and_one_for_each_row():
    twists, centres = np.tile((0.1, 0.2, 1.0), (3, 1)), [(0.0, 0.0), (0.4, 0.3), (-1.0, 2.0)]
    steering, speeds = SWERVE.inverse(twists, centre=centres)
    for k, centre in enumerate(centres):
        one = SWERVE.inverse(twists[k], centre=centre)
        assert_array_equal(one[0], steering[k])
        assert_array_equal(one[1], speeds[k])
        whole = SWERVE.inverse(twists, centre=centre)
        assert_array_equal(whole[0], [steering[k]] * 3)
        at_origin = (0.1 + centre[1], 0.2 - centre[0], 1.0)
        assert_allclose(SWERVE.forward(steering[k], speeds[k]), at_origin, rtol=0, atol=1e-14)
    plain = reference.Rover.like(SWERVE).inverse(twists, centre=centres)
    assert_allclose(plain[0], steering, rtol=0, atol=1e-13)
    # About its own pivot a module stands still and holds its angle.
    held, still = SWERVE.inverse((0.0, 0.0, 1.0), centre=CORNERS[0], previous=[0.7, 0, 0, 0])
    assert (held[0], still[0]) == (0.7, 0.0)


def test_a_centre_the_wheels_do_not_allow():
    car = Rover.ackermann(1.0, 0.6, 0.2)
    assert_allclose(
        car.inverse((0.0, 0.0, 0.5), centre=(0.0, 2.0))[1][2:],
        (-1.7 * 0.5 / 0.2, -2.3 * 0.5 / 0.2) * np.array(-1),
    )
    with pytest.raises(InfeasibleMotionError, match="rear_left"):
        car.inverse((0.0, 0.0, 0.5), centre=(0.1, 2.0))


# Angles held and counted


@given(st.lists(st.floats(-4, 4), min_size=4, max_size=4))
def test_modules_at_rest_hold_their_angles(previous):
    steering, speeds = WIDE.inverse((0.0, 0.0, 0.0), previous=previous)
    assert_array_equal(steering, np.clip(previous, -math.pi, math.pi))
    assert_array_equal(speeds, 0.0)


@pytest.mark.parametrize("way", [1, -1])
def test_turns_of_the_cable_are_counted(way):
    # The direction of travel goes round three times. The modules follow past 180 degrees and past 360, up to
    # where the cable ends, and there take the nearest angle that is left: half a turn back.
    rover = Rover.swerve(CORNERS, 0.05, steering_limit=math.radians(500))
    previous, speeds = np.zeros(4), np.full(4, 20.0)
    travelled = 0
    for step in range(0, 3 * 360, 5):
        steering, speeds = rover.inverse(towards(way * step), previous=previous, previous_wheel_speeds=speeds)
        assert np.ptp(steering) < 1e-12
        jump = abs(steering[0] - previous[0])
        if step <= 500:
            assert steering[0] == pytest.approx(way * math.radians(step), abs=1e-12)
            assert np.all(speeds > 0)
        elif jump > math.radians(10):
            travelled += 1
            assert jump == pytest.approx(math.radians(175), abs=1e-9)
        assert np.all(np.abs(steering) <= math.radians(500))
        assert_allclose(rover.forward(steering, speeds), towards(way * step), rtol=0, atol=1e-12)
        previous = steering
    assert travelled == (3 * 360 - 5 - 500 + 179) // 180


def test_an_angle_beyond_half_a_turn_stays_there():
    rover = Rover.swerve(CORNERS, 0.05, steering_limit=(-7.0, 7.0))
    for previous in (3.3, -3.3, 6.2, 3.3 - math.tau):
        steering, _ = rover.inverse(towards(math.degrees(previous) + 3), previous=[previous] * 4)
        assert_allclose(steering, previous + math.radians(3), rtol=1e-12)


# Wheels that are undecided go together


def nearly_aside(degrees):
    """A rover whose modules have to steer to these angles, though the twist is the same for all."""
    return Rover(
        [
            Wheel(
                f"m{i}",
                x,
                y,
                radius=0.05,
                steered=True,
                heading=math.radians(90 - angle),
                steering_limit=math.pi,
            )
            for i, ((x, y), angle) in enumerate(zip(CORNERS, degrees, strict=True))
        ]
    )


@pytest.mark.parametrize("angles", [(88, 88, 88, 92), (92, 88, 88, 88), (88, 92, 92, 92), (94, 86.5, 87, 88)])
def test_modules_about_a_quarter_turn_do_not_split(angles):
    rover = nearly_aside(angles)
    for previous in (None, np.zeros(4)):
        steering, speeds = rover.inverse((0.0, 1.0, 0.0), previous=previous)
        assert len(set(np.sign(speeds))) == 1
        # Forwards if that is the shorter way for all together, else backwards.
        forwards = sum(angles) <= sum(180 - angle for angle in angles)
        expected = np.array(angles) - (0 if forwards else 180)
        assert_allclose(np.degrees(steering), expected, rtol=0, atol=1e-9)
        assert_allclose(rover.forward(steering, speeds), (0, 1, 0), rtol=0, atol=1e-12)


def test_a_real_turn_does_not_split_the_modules():
    # About a far point behind, the left modules steer past a quarter turn and the right ones short of it.
    steering, speeds = WIDE.inverse((0.0, 0.0, 0.2), centre=(-5.0, 0.0))
    assert set(np.sign(speeds)) == {1.0}
    assert_allclose(
        np.degrees(steering),
        np.degrees([math.atan2(x + 5.0, -y) for x, y in CORNERS]),
        atol=1e-9,
    )


@pytest.mark.parametrize("rolling", [1.0, -1.0])
def test_modules_keep_rolling_the_way_they_do(rolling):
    """Ways that differ by less than 10 degrees do not turn wheels round: 5 either side of a quarter turn."""
    for degrees in np.arange(80.0, 100.1, 0.1):
        steering, speeds = WIDE.inverse(towards(degrees), previous_wheel_speeds=[rolling] * 4)
        decided = 1.0 if degrees < 90 else -1.0
        expected = rolling if 85.01 < degrees < 94.99 else decided
        if abs(abs(degrees - 90) - 5) > 0.01:
            assert set(np.sign(speeds)) == {expected}, degrees
        assert_allclose(WIDE.forward(steering, speeds), towards(degrees), rtol=0, atol=1e-14)


@pytest.mark.parametrize("start", [60.0, 120.0])
def test_hysteresis_walked_from_both_sides(start):
    """The direction goes across a quarter turn and back: the wheels turn round at two different places."""
    there = np.arange(start, 180 - start, 0.25 if start < 90 else -0.25)
    speeds = np.zeros(4)
    flips = []
    for degrees in [*there, *there[::-1]]:
        before = np.sign(speeds[0])
        _, speeds = WIDE.inverse(towards(degrees), previous_wheel_speeds=speeds)
        if before and np.sign(speeds[0]) != before:
            flips.append(degrees)
    first, second = flips
    up = start < 90
    assert first == pytest.approx(95.0 if up else 85.0, abs=0.26)
    assert second == pytest.approx(85.0 if up else 95.0, abs=0.26)


def test_the_rule_has_an_edge():
    for off, split in ((4.99, False), (5.01, True)):
        rover = nearly_aside((90 - off, 90 + off, 90 - off, 90 + off))
        _, speeds = rover.inverse((0.0, 1.0, 0.0))
        assert (len(set(np.sign(speeds))) == 2) == split


def test_a_tie_goes_forwards():
    for rover in (SWERVE, WIDE):
        for degrees in (90.0, -90.0):
            steering, speeds = rover.inverse((0.0, math.copysign(1.0, degrees), 0.0))
            assert_allclose(np.degrees(steering), degrees, atol=1e-12)
            assert_array_equal(np.sign(speeds), 1.0)


def test_a_range_that_allows_one_way_only_decides():
    # At +-90 degrees of range nothing is left to agree about: past a quarter turn only backwards is possible.
    steering, speeds = SWERVE.inverse(towards(92.0), previous_wheel_speeds=[1.0] * 4)
    assert_allclose(np.degrees(steering), -88.0, atol=1e-12)
    assert_array_equal(np.sign(speeds), -1.0)


DEGREES = st.integers(-180, 179).map(lambda d: d + 0.5)  # off the edges of the rule, 5 degrees from 90


@given(
    DEGREES,
    st.lists(st.integers(-170, 170), min_size=4, max_size=4),
    st.lists(st.integers(-3, 3), min_size=4, max_size=4),
)
def test_the_choice_is_that_of_the_reference(direction, previous, rolling):
    plain = reference.Rover.like(WIDE)
    keywords = {"previous": np.radians(previous), "previous_wheel_speeds": np.array(rolling, dtype=float)}
    ours = WIDE.inverse(towards(direction), **keywords)
    theirs = plain.inverse(towards(direction), **keywords)
    assert_allclose(ours[0], theirs[0], rtol=0, atol=1e-9)
    assert_allclose(ours[1], theirs[1], rtol=0, atol=1e-9)


@given(
    any_twists(),
    st.lists(st.floats(-3, 3), min_size=4, max_size=4),
    st.lists(st.floats(-9, 9), min_size=4, max_size=4),
)
def test_what_was_never_changes_the_motion(twist, previous, rolling):
    for keywords in (
        {"previous": previous},
        {"previous_wheel_speeds": rolling},
        {"previous": previous, "previous_wheel_speeds": rolling},
    ):
        steering, speeds = WIDE.inverse(twist, **keywords)
        assert_allclose(WIDE.forward(steering, speeds), twist, rtol=0, atol=1e-12)
