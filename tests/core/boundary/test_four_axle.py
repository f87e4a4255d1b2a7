"""The boundary of four axles: what is taken, what is refused and in which words, and the picture."""

import copy
import pickle

import numpy as np
import pytest

import six_wheel as sw
from six_wheel import FourAxle, FourAxleState, FourAxleStep

STRAIGHT = FourAxleState()


@pytest.fixture(scope="module")
def car() -> FourAxle:
    return FourAxle(pivots=(0.4, 0.3), axle_length=0.2, wheel_radius=0.1)


@pytest.fixture(scope="module")
def tandem() -> FourAxle:
    return FourAxle(pivots=(0.4, 0.0), axle_length=0.3, wheel_radius=0.1)


def test_repr_equality_pickle(car, tandem):
    narrow = FourAxle((0.5, 0.1), 0.2, 0.1, steering_limit=1.0, tolerance=1e-5)
    for each in (car, tandem, narrow):
        assert eval(repr(each)) == each
        assert pickle.loads(pickle.dumps(each)) == copy.deepcopy(each) == each
        assert hash(copy.deepcopy(each)) == hash(each)
    assert car != tandem
    assert narrow.steering_range == (-1.0, 1.0)
    assert (car.pivots, car.axle_length, car.wheel_radius, car.tolerance) == ((0.4, 0.3), 0.2, 0.1, 1e-3)
    assert isinstance(car.rover, sw.Rover)
    assert car.rover.wheel_names == ("front_left", "front_right", "rear_left", "rear_right")
    plan = car.turn_sequence(STRAIGHT, 0.5, speed=0.5, steer="rear")
    assert pickle.loads(pickle.dumps(plan)) == plan
    assert eval(repr(plan.steps[1])) == plan.steps[1]


def test_whatever_numpy_takes_is_taken(car):
    expected = car.mobility((0.5, 0.25, -0.5, -0.25)).slip
    for angles in ([0.5, 0.25, -0.5, -0.25], np.float32([0.5, 0.25, -0.5, -0.25])):
        assert car.mobility(angles).slip == expected
        assert car.forward(angles, np.ones(4, dtype=int)).rank == 3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (((0.0, 0.3), 0.2, 0.1), r"pivots\[0\] must be finite and positive, got 0.0"),
        (((0.4, -0.3), 0.2, 0.1), r"pivots\[1\] must be finite and not negative, got -0.3"),
        (((0.4, np.nan), 0.2, 0.1), r"pivots\[1\] must be"),
        (((0.4,), 0.2, 0.1), r"pivots must have shape"),
        (((0.4, 0.3), 0.0, 0.1), "axle_length must be finite and positive"),
        (((0.4, 0.3), 0.2, np.inf), "wheel_radius must be finite and positive"),
        (((0.4, 0.3), "long", 0.1), "axle_length must be a number"),
    ],
)
def test_a_car_that_cannot_be(arguments, message):
    with pytest.raises(ValueError, match=message):
        FourAxle(*arguments)


@pytest.mark.parametrize("tolerance", [0.0, -1e-3, 1.0, np.nan])
def test_a_tolerance_that_cannot_be(tolerance):
    with pytest.raises(ValueError, match="tolerance must be at least 1e-9"):
        FourAxle((0.4, 0.3), 0.2, 0.1, tolerance=tolerance)


def test_bad_angles_and_points(car, tandem):
    for angles, message in [
        ((np.nan, 0, 0, 0), "steering must be finite"),
        ((2.0, 0, 0, 0), "steering must lie within"),
        ((0, 0, 0), r"steering must have shape"),
        (np.zeros((2, 4)), r"steering must have shape \(4,\)"),
    ]:
        with pytest.raises(ValueError, match=message):
            car.mobility(angles)
    with pytest.raises(ValueError, match="equal left and right on a rigid axle"):
        tandem.mobility((0.2, 0.1, 0, 0))
    with pytest.raises(ValueError, match="one direction"):
        car.concurrent_angles((np.inf, -np.inf))
    with pytest.raises(ValueError, match=r"icr\[1\] must be a point"):
        car.concurrent_angles(((0, 1), (np.nan, 0)))
    narrow = FourAxle((0.4, 0.3), 0.2, 0.1, steering_limit=0.3)
    with pytest.raises(sw.InfeasibleMotionError, match=r"icr .*got \(0.0, 0.0\)"):
        narrow.concurrent_angles((0, 0))
    with pytest.raises(sw.InfeasibleMotionError, match="curvature .*got 1.0"):
        narrow.turn_sequence(STRAIGHT, 1.0)


def test_bad_states_steps_and_paces(car):
    with pytest.raises(ValueError, match="front_brake must be 'locked' or 'free', got 'open'"):
        FourAxleState(front_brake="open")
    with pytest.raises(ValueError, match="pose must be 3 finite numbers"):
        FourAxleState(pose=(0, 0))
    with pytest.raises(ValueError, match="duration must be finite and not negative"):
        FourAxleStep("back", -1.0, "locked", "locked", (1, 1, 1, 1))
    with pytest.raises(ValueError, match="wheel_speeds must be 4 finite numbers"):
        FourAxleStep("fast", 1.0, "locked", "locked", (1, 1, 1, np.inf))
    with pytest.raises(sw.ArgumentTypeError, match="state must be a FourAxleState, got tuple"):
        car.lock((0, 0, 0, 0), "rear")
    with pytest.raises(ValueError, match="pair must be 'front' or 'rear', got \"left\""):
        car.lock(STRAIGHT, "left")
    with pytest.raises(sw.ArgumentTypeError, match="sequence must be a FourAxleStep, got int"):
        car.simulate([1], 0.1)
    with pytest.raises(ValueError, match="dt must be finite and positive"):
        car.simulate([], 0.0)
    step = car.drive(STRAIGHT, 0.5, 1.0)
    with pytest.raises(ValueError, match="dt must give at most"):
        car.simulate([step], 1e-9)
    for keywords, message in [
        ({"speed": np.nan}, "speed must be finite"),
        ({"pivot_rate": 0.0}, "pivot_rate must be finite and positive"),
        ({"brake_time": -1.0}, "brake_time must be finite and not negative"),
        ({"steer": "middle"}, "steer must be"),
    ]:
        with pytest.raises(ValueError, match=message):
            car.turn_sequence(STRAIGHT, 0.5, **keywords)
    with pytest.raises(ValueError, match="curvature must be finite"):
        car.turn_sequence(STRAIGHT, np.inf)
    with pytest.raises(ValueError, match="both pairs locked"):
        car.turn_sequence(FourAxleState(rear_brake="free"), 0.5)
    assert car.turn_sequence(STRAIGHT, 0.5).reason == "asked for at speed 0"
    with pytest.raises(sw.InfeasibleMotionError, match="let the robot move"):
        car.drive(FourAxleState((0.2, 0.2, -0.2, -0.2)), 0.5, 1.0)
    with pytest.raises(ValueError, match="front_brake must be 'locked' or 'free'"):
        car.forward(np.zeros(4), np.zeros(4), front_brake="ajar")
    with pytest.raises(ValueError, match="wheel_speeds"):
        car.forward(np.zeros(4), (1e308, 1e308, 1e308, 1e308))


def test_the_picture_shows_both_pairs_and_every_place_of_action(car):
    pytest.importorskip("matplotlib")
    from six_wheel.plotting.four_axle import four_axle_figure

    ahead = car.drive(STRAIGHT, 0.5, 4.0)
    plan = car.turn_sequence(ahead.end, 0.7)
    on = car.drive(plan.steps[-1].end, 0.5, 4.0)
    result = car.simulate((ahead, *plan, on), 0.02)
    figure = four_axle_figure(result, title="drive, stop halfway, re-aim, drive on")
    figure.draw_without_rendering()
    path, angles, brakes = figure.axes
    assert [text.get_text() for text in path.texts if "\n" in text.get_text()] == ["turn rear\nturn front"]
    assert len(angles.get_lines()) == 4
    assert [label.get_text() for label in brakes.get_yticklabels()] == ["rear free", "front free"]
    standing = car.simulate([], 0.1)
    four_axle_figure(standing).draw_without_rendering()


def test_samples(car):
    plan = car.turn_sequence(STRAIGHT, 0.5, speed=0.5, steer="rear", brake_time=0.25)
    result = car.simulate(plan, 0.1)
    count = len(result.stamps)
    assert result.poses.shape == result.twists.shape == (count, 3)
    assert result.steering.shape == result.wheel_speeds.shape == result.residuals.shape == (count, 4)
    assert result.ends.shape == (len(plan),)
    np.testing.assert_allclose(
        result.stamps[result.ends], np.cumsum([step.duration for step in plan]), atol=1e-14
    )
    assert np.diff(result.stamps).max() <= 0.1 + 1e-12
    assert result.rover == car.rover
    assert result.steps == plan.steps
    empty = car.simulate([], 0.1)
    assert (empty.stamps.tolist(), empty.final) == ([0.0], STRAIGHT)


def test_a_simulation_refuses_the_brake_that_a_state_would(car):
    steps = [
        FourAxleStep("turn", 0.5, "locked", "free", (0, 0, 1, 1)),
        FourAxleStep("lock", 0.0, "locked", "locked", (0, 0, 0, 0)),
    ]
    with pytest.raises(sw.InfeasibleMotionError, match=r"sequence\[1\]: steering must let the robot move"):
        car.simulate(steps, 0.1)
    with pytest.raises(sw.InfeasibleMotionError, match=r"sequence\[0\]"):
        car.simulate([FourAxleStep("adrift", 1.0, "free", "free", (1, 1, 1, 1))], 0.1)
    with pytest.raises(ValueError, match=r"sequence\[0\]: steering must lie within"):
        car.simulate([FourAxleStep("too far", 5.0, "locked", "free", (0, 0, 3, 3))], 0.1)
