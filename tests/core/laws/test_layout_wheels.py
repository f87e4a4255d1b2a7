"""The named layouts take scrub, trail, steering ranges and names: for all their wheels, or one each."""

import math

import pytest
from numpy.testing import assert_allclose

import six_wheel as sw
from six_wheel import Rover, reference
from tests.rovers import CORNERS, SIX_SIZES

LAYOUTS = {
    "six_wheel": lambda **more: Rover.six_wheel(**SIX_SIZES, **more),
    "swerve": lambda **more: Rover.swerve(CORNERS, 0.1, **more),
    "ackermann": lambda **more: Rover.ackermann(1.0, 0.6, 0.2, **more),
    "tricycle": lambda **more: Rover.tricycle(1.0, 0.6, 0.2, **more),
    "bicycle": lambda **more: Rover.bicycle(1.0, 0.2, **more),
    "differential": lambda **more: Rover.differential(0.5, 0.1, wheels_per_side=2, wheelbase=0.4, **more),
    "tracked": lambda **more: Rover.tracked(0.5, 0.1, **more),
    "mecanum": lambda **more: Rover.mecanum(0.6, 0.4, 0.05, **more),
    "omni": lambda **more: Rover.omni(CORNERS, [0.1, 0.2, 0.3, 0.4], 0.05, **more),
}
STEERING = [name for name, make in LAYOUTS.items() if make().steered_wheel_names]


def values(rover, name):
    return [getattr(wheel, name) for wheel in rover.wheels]


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("argument", ["scrub", "trail"])
def test_scrub_and_trail(layout, argument):
    make = LAYOUTS[layout]
    plain = make()
    count = len(plain.wheels)
    assert make(**{argument: 0.03}) == plain.replace(**{argument: 0.03})
    each = [0.01 * (k + 1) for k in range(count)]
    assert values(make(**{argument: each}), argument) == each
    assert make(**{argument: tuple(each)}) == make(
        **{argument: dict(zip(plain.wheel_names, each, strict=True))}
    )
    last = plain.wheel_names[-1]
    assert make(**{argument: {last: 0.02}}) == plain.replace(last, **{argument: 0.02})
    assert make(**{argument: None}) == plain
    for wrong, message in [
        ("a", f"{argument} must be a number, got 'a'"),
        (
            [0.1] * (count + 1),
            f"{argument} must be one value or {count}, one each for .*got {count + 1} values",
        ),
        ({"nobody": 0.1}, f"{argument} must name wheels of .*{last}, got 'nobody'"),
        ([0.0] * (count - 1) + ["a"], rf"{argument}\[{count - 1}\] must be a number, got 'a'"),
        (math.nan, f"{argument} must be finite"),
    ]:
        with pytest.raises(ValueError, match=message):
            make(**{argument: wrong})


@pytest.mark.parametrize("layout", LAYOUTS)
def test_names(layout):
    make = LAYOUTS[layout]
    plain = make()
    names = [f"w{k}" for k in range(len(plain.wheels))]
    rover = make(names=names, trail={"w0": 0.01})
    assert rover.wheel_names == tuple(names)
    assert rover.wheels[0].trail == 0.01
    assert rover.wheels[-1] == plain.wheels[-1].replace(name=names[-1])
    with pytest.raises(ValueError, match=f"names must hold {len(names)} names"):
        make(names=names[:-1])
    with pytest.raises(ValueError, match="w0"):
        make(names=["w0"] * len(names))


@pytest.mark.parametrize("layout", STEERING)
def test_steering_ranges(layout):
    make = LAYOUTS[layout]
    plain = make()
    steered = plain.steered_wheel_names
    ranges = [(-0.5 - 0.1 * k, 0.6) for k in range(len(steered))]

    def found(**more):
        return [wheel.steering_range for wheel in make(**more).wheels if wheel.steered]

    assert found(steering_limit=0.5) == [(-0.5, 0.5)] * len(steered)
    assert found(steering_limit=(-0.5, 0.7)) == [(-0.5, 0.7)] * len(steered)
    assert found(steering_limit=ranges) == ranges
    assert found(steering_limit=dict(zip(steered, ranges, strict=True))) == ranges
    assert found(steering_limit=math.inf) == [(-math.inf, math.inf)] * len(steered)
    assert found(steering_limit={steered[0]: math.inf})[0] == (-math.inf, math.inf)
    usual = (-math.inf, math.inf) if layout == "swerve" else (-math.pi / 2, math.pi / 2)
    assert found() == found(steering_limit=None) == [usual] * len(steered)
    for wrong, message in [
        ("a", "steering_limit must be a number, got 'a'"),
        (-1.0, "steering_limit must be finite and positive"),
        (math.nan, "steering_limit must be finite and positive"),
        ((0.5, -0.5), "steering_limit must be finite, the lower angle below the upper"),
        ((-math.inf, 1.0), "steering_limit must be finite, the lower angle below the upper"),
        ([0.1] * 9, f"steering_limit must be one value or {len(steered)}, one each for {steered[0]}"),
        ({"rear": "a", steered[0]: "a"}, "steering_limit"),
    ]:
        with pytest.raises(ValueError, match=message):
            make(steering_limit=wrong)


def test_centres_of_treads_and_contacts_say_the_same():
    by_centres = Rover.tracked(0.5, 0.1, icr_left=0.35, icr_right=-0.3, icr_forward=0.1)
    by_contacts = Rover.tracked(0.5, 0.1, scrub=(0.1, -0.05), trail=-0.1)
    for name in ("scrub", "trail"):
        assert_allclose(values(by_centres, name), values(by_contacts, name), rtol=0, atol=1e-16)
    with pytest.raises(ValueError, match="scrub must be left out beside icr_left and icr_right"):
        Rover.tracked(0.5, 0.1, icr_left=0.35, scrub=0.1)
    with pytest.raises(ValueError, match="trail must be left out beside icr_forward"):
        Rover.differential(0.5, 0.1, icr_forward=0.1, trail=0.1)


def test_an_endless_wheel_is_a_value_like_any_other():
    wheel = sw.Wheel("a", 0.1, 0.2, radius=0.1, steered=True, steering_limit=math.inf)
    assert wheel == eval(repr(wheel), {"Wheel": sw.Wheel})
    assert wheel == wheel.replace(steering_limit=(-math.inf, math.inf))
    assert wheel.steering_limit == math.inf
    rover = Rover.swerve(CORNERS, 0.1)
    assert rover == eval(repr(rover), {"Rover": Rover, "Wheel": sw.Wheel})
    assert hash(rover) == hash(Rover.swerve(CORNERS, 0.1, steering_limit=math.inf))


@pytest.mark.parametrize("trail", [0.0, 0.02])
def test_endless_modules_follow_a_direction_round_and_round(trail):
    rover = Rover.swerve(CORNERS, 0.1, trail=trail)
    plain = reference.Rover.like(rover)
    previous = None
    for step in range(0, 5 * 360, 10):
        angle = math.radians(step)
        twist = 0.5 * math.cos(angle), 0.5 * math.sin(angle), 0.0
        steering, speeds = rover.inverse(twist, previous=previous)
        assert_allclose(steering, angle, rtol=0, atol=1e-9)
        assert (speeds > 0).all()
        assert_allclose(rover.forward(steering, speeds), twist, rtol=0, atol=1e-12)
        theirs = plain.inverse(twist, previous=previous)
        assert_allclose(steering, theirs[0], rtol=0, atol=1e-9)
        previous = steering
    assert (rover.min_radius, rover.spin_radius) == (0.0, math.inf)
