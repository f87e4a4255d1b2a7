"""Wheels that are not simply driven: castors, passive wheels, offset contacts; mobility; bad arguments."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

import six_wheel as sw
from six_wheel import Rover, Wheel, reference
from tests.rovers import CART, CORNERS, SIX_WHEELS, THREE_AXLES
from tests.strategies import any_twists

RING = np.radians([210.0, -30.0, 90.0])
OMNI = Rover.omni(0.2 * np.stack((-np.sin(RING), np.cos(RING)), axis=-1), RING, 0.05)


def castor(name: str, x: float, y: float = 0.0, **keywords: float) -> Wheel:
    return Wheel(name, x, y, radius=0.04, castor=True, **{"trail": 0.05, **keywords})


ROBOT = Rover([*CART.wheels, castor("front", 0.4), castor("rear", -0.4)])
ONE_STEERED = [Wheel("front", 0.5, 0.0, radius=0.1, steered=True), castor("a", -0.3, 0.2), castor("b", -0.3)]


# Classification of G. Campion, G. Bastin and B. d'Andrea-Novel, 1996


@pytest.mark.parametrize(("rover", "degrees"), [
    (OMNI, (3, 0)),
    (Rover.mecanum(0.6, 0.4, 0.05), (3, 0)),
    (CART, (2, 0)),
    (THREE_AXLES, (2, 0)),
    (Rover.tracked(0.5, 0.1, icr_left=0.4), (2, 0)),
    (ROBOT, (2, 0)),
    (Rover(ONE_STEERED), (2, 1)),
    (Rover.ackermann(1.0, 0.6, 0.2), (1, 1)),
    (Rover.tricycle(1.0, 0.6, 0.2), (1, 1)),
    (Rover.bicycle(1.0, 0.3), (1, 1)),
    (SIX_WHEELS, (1, 1)),
    (Rover.swerve(CORNERS[:2], 0.1), (1, 2)),
    (Rover.swerve(CORNERS, 0.1), (1, 2)),
])  # fmt: skip
def test_types_of_vehicles(rover, degrees):
    mobility = rover.mobility()
    mobile, steerable = degrees
    assert (mobility.degree_of_mobility, mobility.degree_of_steerability) == degrees
    assert mobility.degree_of_manoeuvrability == mobile + steerable
    assert mobility.rank == 3 - mobile
    assert mobility.motion.shape == (mobile, 3)
    assert_allclose(mobility.motion @ mobility.motion.T, np.eye(mobile), atol=1e-14)
    assert mobility.margin == (mobility.singular_values[2 - mobile] if mobile < 3 else 0.0)
    plain = reference.Rover.like(rover).mobility()
    assert (plain.degree_of_mobility, plain.degree_of_steerability) == degrees
    assert_allclose(plain.motion.T @ plain.motion, mobility.motion.T @ mobility.motion, atol=1e-12)


def test_four_modules_that_agree_and_four_that_do_not():
    # Equal angles front and rear look right and lock the vehicle: design notes, four axles.
    rover = Rover.swerve(CORNERS, 0.1)
    locked = rover.mobility([0.2, 0.2, -0.2, -0.2])
    assert locked.degree_of_mobility == 0
    assert_allclose(locked.singular_values, (1.960, 0.885, 0.053), atol=5e-4)
    assert locked.motion.shape == (0, 3)
    free = rover.mobility(
        [math.atan2(0.4, 0.7), math.atan2(0.4, 1.3), -math.atan2(0.4, 0.7), -math.atan2(0.4, 1.3)]
    )
    assert free.degree_of_mobility == 1
    assert_allclose(free.singular_values, (1.826, 1.153, 0.0), atol=5e-4)
    (motion,) = free.motion
    assert_allclose(rover.icr(motion), (0.0, 1.0), atol=1e-12)


@pytest.mark.parametrize("share", [0.5, 2.0])
def test_both_sides_of_what_counts_as_concurrent(share):
    # Two fixed directions that differ by so little: their rows (0, 1, 0) and (0, 1, 0) - d (1, 0, 0.2) differ
    # by 1.02 d, and the second singular value is that over the square root of two.
    turned = share * 1e-6 / math.sqrt(0.52)
    rover = Rover([Wheel("a", 0.0, 0.2, radius=0.1), Wheel("b", 0.0, -0.2, radius=0.1, heading=turned)])
    mobility = rover.mobility()
    assert mobility.singular_values[1] == pytest.approx(share * 1e-6, rel=1e-6)
    assert mobility.rank == (1 if share < 1.0 else 2)


# Castors and passive wheels


@given(any_twists(), st.lists(st.floats(-50, 50) | st.just(math.nan), min_size=2, max_size=2))
def test_castors_have_no_say(twist, garbage):
    vx, _, omega = twist
    _, speeds = ROBOT.inverse((vx, 0.0, omega))
    assert_allclose(speeds[:2], CART.inverse((vx, 0.0, omega))[1], rtol=0, atol=1e-14)
    readings = [*speeds[:2], *garbage]
    assert_allclose(ROBOT.forward(None, readings), (vx, 0.0, omega), rtol=0, atol=1e-12)
    for method in ("least_squares", "robust", "middle_wheels"):
        fit = ROBOT.fit(None, readings, method=method)
        assert_array_equal(fit.residuals[2:], 0.0)
        assert_allclose(fit.twist, (vx, 0.0, omega), rtol=0, atol=1e-12)
    assert ROBOT.admissible((vx, 0.0, omega))


def test_a_castor_rolls_behind_its_pivot():
    # On the spot its pivot does 0.4 m/s, and its contact swings at 0.05 m/s: sqrt(0.4**2 - 0.05**2) along.
    along = math.sqrt(0.4**2 - 0.05**2)
    _, speeds = ROBOT.inverse((0.0, 0.0, 1.0))
    assert_allclose(speeds[2:], along / 0.04, rtol=1e-14)
    for twist in ((0.3, 0.0, 0.0), (-0.3, 0.0, 0.0)):  # straight either way: it has swung in behind
        assert_allclose(ROBOT.inverse(twist)[1][2:], 0.3 / 0.04, rtol=1e-14)
    # Counted the other way round the same wheel rolls backwards, and a scrub adds its share.
    other = Rover([*ROBOT.wheels[:2], castor("c", 0.4, trail=-0.05), castor("d", 0.4, scrub=0.02)])
    assert_allclose(other.inverse((0.0, 0.0, 1.0))[1][2:] * 0.04, (-along, along - 0.02), rtol=1e-13)
    # A pivot slower than its contact would have to swing: turned about, it only scrubs.
    about = Rover([*ROBOT.wheels[:2], castor("c", 0.0, 0.01)])
    assert about.inverse((0.0, 0.0, 1.0))[1][2] == 0.0
    for rover in (ROBOT, other, about):
        plain = reference.Rover.like(rover).inverse((0.1, 0.0, 1.0))[1]
        assert_allclose(rover.inverse((0.1, 0.0, 1.0))[1], plain, rtol=1e-13)


@given(st.floats(-2, 2), st.floats(-1.2, 1.2))
def test_a_tricycle_measures_with_its_front_wheel_alone(v, angle):
    rover = Rover.tricycle(1.0, 0.6, 0.1)
    assert [wheel.driven for wheel in rover.wheels] == [True, False, False]
    speeds = [v / 0.1, math.nan, math.nan]
    expected = (v * math.cos(angle), 0.0, v * math.sin(angle) / 1.0)
    assert_allclose(rover.forward([angle], speeds), expected, rtol=0, atol=1e-14)
    fit = rover.fit([angle], speeds)
    assert_allclose(fit.twist, expected, rtol=0, atol=1e-14)
    assert_allclose(fit.residuals, 0.0, atol=1e-14)
    # One encoder more, and it counts: a rear wheel that reads nothing at all pulls at the estimate.
    assert fit.sigma_min < rover.fit([angle], [v / 0.1, 0.0, math.nan]).sigma_min + 1e-12
    plain = reference.Rover.like(rover)
    for readings in (speeds, [v / 0.1, 0.0, math.nan]):
        assert_allclose(rover.forward([angle], readings), plain.forward([angle], readings), atol=1e-13)


def test_a_motor_has_a_reading():
    rover = Rover.tricycle(1.0, 0.6, 0.1, driven="all")
    with pytest.raises(ValueError, match=r"speeds must be finite, got \(nan, 1.0, 1.0\)"):
        rover.forward([0.1], [math.nan, 1.0, 1.0])
    passive = Rover.tricycle(1.0, 0.6, 0.1)
    with pytest.raises(ValueError, match="speeds must be finite, got .*inf"):
        passive.forward([0.1], [1.0, math.inf, math.nan])
    assert list(passive.commands((0.5, 0.0, 0.1))) == ["front_steering_joint", "front_wheel_joint"]


# Contacts that do not lie under the pivot


def offset_rover(**offsets: float) -> Rover:
    return Rover(
        [Wheel(f"m{i}", x, y, radius=0.1, steered=True, **offsets) for i, (x, y) in enumerate(CORNERS)]
    )


@pytest.mark.parametrize("offsets", [{"scrub": 0.05}, {"trail": 0.03}, {"scrub": -0.05, "trail": 0.03}])
@given(twist=any_twists(), rates=st.lists(st.floats(-1, 1), min_size=4, max_size=4))
def test_steering_while_driving_is_no_slip(offsets, twist, rates):
    rover = offset_rover(**offsets)
    if "trail" in offsets:
        twist = (1.0 + abs(twist[0]), 0.0, 0.3 * twist[2])  # the pivots outrun the trail, forwards
    steering, speeds = rover.inverse(twist, steering_rates=rates)
    fit = rover.fit(steering, speeds, steering_rates=rates)
    assert_allclose(fit.twist, twist, rtol=0, atol=1e-12)
    assert_allclose(fit.residuals, 0.0, atol=1e-12)


def test_what_it_costs_to_forget_the_steering_rates():
    # All four wheels steer left at 1 rad/s, 5 cm beside their pivots: 5 cm/s of every reading is not travel.
    rover, rates = offset_rover(scrub=0.05), [1.0, 1.0, 1.0, 1.0]
    steering, speeds = rover.inverse((0.5, 0.0, 0.0), steering_rates=rates)
    error = rover.forward(steering, speeds) - (0.5, 0.0, 0.0)
    print(f"error without steering rates: {error} m/s, m/s, rad/s")
    assert_allclose(error, (-0.05, 0.0, 0.0), rtol=0, atol=1e-14)
    assert_allclose(rover.fit(steering, speeds).residuals, 0.0, atol=1e-14)  # and no residual tells of it
    assert_allclose(rover.forward(steering, speeds, steering_rates=rates), (0.5, 0, 0), rtol=0, atol=1e-14)
    # A trail turns the wheels instead: 3 cm at 1 rad/s is 3 cm/s aside.
    rover = offset_rover(trail=0.03)
    steering, speeds = rover.inverse((0.5, 0.0, 0.0), steering_rates=rates)
    assert_allclose(steering, -math.asin(0.03 / 0.5), rtol=1e-13)
    error = rover.forward(steering, speeds) - (0.5, 0.0, 0.0)
    assert np.hypot(*error[:2]) == pytest.approx(0.03, rel=1e-12)


# Too few readings


@pytest.mark.parametrize(("rover", "angles", "speeds", "unseen"), [
    (Rover([Wheel("one", 0.2, 0.1, radius=0.1, steered=True)]), [0.4], [2.0], (0.1, -0.2, 1.0)),
    (Rover.omni([(0.0, 0.2), (0.0, -0.2)], [0.0, 0.0], 0.1), None, [1.0, 3.0], (0.0, 1.0, 0.0)),
    (Rover.omni([(0.3, 0.2), (0.3, -0.2)], [math.pi / 4] * 2, 0.1), None, [1.0, 3.0], (-1.0, 1.0, 0.0)),
])  # fmt: skip
def test_what_no_wheel_sees_is_named_or_taken_to_be_zero(rover, angles, speeds, unseen):
    with pytest.raises(
        sw.UnderdeterminedError, match="wheels must determine the twist, got no reading"
    ) as caught:
        rover.forward(angles, speeds)
    named = np.array(eval(str(caught.value).partition("= ")[2]))
    assert_allclose(np.cross(named / np.linalg.norm(named), unseen), 0.0, atol=1e-12)
    with pytest.raises(sw.UnderdeterminedError):
        rover.fit(angles, speeds)
    rows = (None if angles is None else [angles] * 3), [speeds] * 3
    with pytest.raises(sw.UnderdeterminedError, match=r"wheels\[0\] must determine the twist"):
        rover.forward(*rows)

    fit = rover.fit(angles, speeds, allow_underdetermined=True)
    assert fit.rank == 2
    assert_allclose(fit.residuals, 0.0, atol=1e-15)
    assert_array_equal(rover.forward(angles, speeds, allow_underdetermined=True), fit.twist)
    assert_array_equal(rover.forward(*rows, allow_underdetermined=True), [fit.twist] * 3)
    plain = reference.Rover.like(rover)
    assert_allclose(plain.forward(angles, speeds, allow_underdetermined=True), fit.twist, atol=1e-14)

    def pivots(twist):
        speeds = [(twist[0] - twist[2] * w.y, twist[1] + twist[2] * w.x) for w in rover.wheels]
        return np.linalg.norm(speeds)

    if len(rover.wheels) > 1:  # the least motion of the pivots; one pivot alone does not tell a spin
        for step in (-1e-3, 1e-3):
            assert pivots(fit.twist) < pivots(fit.twist + step * np.array(unseen))
    else:
        assert fit.twist[2] == 0.0


# Bad arguments

nan, inf = math.nan, math.inf


@pytest.mark.parametrize(("name", "arguments", "keywords", "message"), [
    ("swerve", (CORNERS, 0.0), {}, "wheel_radius must be finite and positive, got 0.0"),
    ("swerve", ([(0, 0), (nan, 0)], 0.1), {}, "positions must be finite, got (nan, 0.0)"),
    ("swerve", ([(0, 0)], 0.1), {}, "positions must hold at least 2, got 1"),
    ("swerve", (np.zeros((2, 3)), 0.1), {}, "positions must have shape (..., 2), got shape (2, 3)"),
    ("swerve", (np.arange(130.0).reshape(65, 2), 0.1), {}, "wheels must hold 1 to 64 wheels, got 65"),
    ("swerve", ([(0, 0), (1, 0), (0, 0)], 0.1), {},
     'positions must differ from module to module, got "module_0" and "module_2" both at (0.0, 0.0)'),
    ("swerve", ([(1, 0), (1, 0)], 0.1), {"names": ["left", "right"]},
     'positions must differ from module to module, got "left" and "right" both at (1.0, 0.0)'),
    ("swerve", (CORNERS, 0.1), {"names": list("abca")}, 'wheels must have a name each, got "a" twice'),
    ("swerve", (CORNERS, 0.1), {"names": ["a"]}, "names must hold 4 names, one per position, got 1"),
    ("swerve", (CORNERS, 0.1), {"steering_limit": 0.0},
     "steering_limit must be finite and positive, got 0.0"),
    ("swerve", (CORNERS, 0.1), {"steering_limit": (1.0, -1.0)},
     "steering_limit must be finite, the lower angle below the upper, got 1.0 to -1.0 rad (57.3° to -57.3°)"),
    ("differential", (0.0, 0.1), {}, "track_width must be finite and positive, got 0.0"),
    ("differential", (0.3, (0.1, -0.1)), {}, "wheel_radius must be finite and positive, got -0.1"),
    ("differential", (0.3, 0.1), {"wheels_per_side": 0}, "wheels_per_side must be 1 to 32, got 0"),
    ("differential", (0.3, 0.1), {"wheels_per_side": -1}, "wheels_per_side must be 1 to 32, got -1"),
    ("differential", (0.3, 0.1), {"wheels_per_side": 10**15, "wheelbase": 1.0},
     "wheels_per_side must be 1 to 32, got 1000000000000000"),
    ("differential", (0.3, 0.1), {"wheels_per_side": 2},
     "wheelbase must be given for more than one wheel per side, got None"),
    ("differential", (0.3, 0.1), {"wheels_per_side": 2, "wheelbase": -1.0},
     "wheelbase must be finite and positive, got -1.0"),
    ("tracked", (nan, 0.1), {}, "track_width must be finite and positive, got nan"),
    ("tracked", (0.3, 0.1), {"icr_left": -0.2},
     "icr_left must lie to the left of icr_right, got (-0.2, -0.15)"),
    ("tracked", (0.3, 0.1), {"icr_right": nan}, "icr_right must be finite, got nan"),
    ("tracked", (0.3, 0.1), {"icr_forward": inf}, "icr_forward must be finite, got inf"),
    ("ackermann", (0.0, 0.5, 0.1), {}, "wheelbase must be finite and positive, got 0.0"),
    ("ackermann", (1.0, nan, 0.1), {}, "track_width must be finite and positive, got nan"),
    ("ackermann", (1.0, 0.5, -0.1), {}, "wheel_radius must be finite and positive, got -0.1"),
    ("ackermann", (1.0, 0.5, 0.1), {"driven": "left"},
     "driven must be 'front', 'rear' or 'all', got \"left\""),
    ("ackermann", (1.0, 0.5, 0.1), {"steering_limit": nan},
     "steering_limit must be finite and positive, got nan"),
    ("tricycle", (-1.0, 0.5, 0.1), {}, "wheelbase must be finite and positive, got -1.0"),
    ("tricycle", (1.0, 0.0, 0.1), {}, "track_width must be finite and positive, got 0.0"),
    ("bicycle", (inf, 0.1), {}, "wheelbase must be finite and positive, got inf"),
    ("bicycle", (1.0, 0.0), {}, "wheel_radius must be finite and positive, got 0.0"),
    ("mecanum", (0.0, 0.2, 0.1), {}, "wheelbase must be finite and positive, got 0.0"),
    ("mecanum", (0.3, nan, 0.1), {}, "track_width must be finite and positive, got nan"),
    ("mecanum", (0.3, 0.2, 0.0), {}, "wheel_radius must be finite and positive, got 0.0"),
    ("mecanum", (0.3, 0.2, 0.1), {"roller_angle": nan}, "roller_angle must be finite and no multiple of pi"),
    ("omni", (CORNERS, [0.0] * 4, 0.0), {}, "wheel_radius must be finite and positive, got 0.0"),
    ("omni", (CORNERS, [0.0] * 3, 0.1), {}, "headings must have shape (4,), got shape (3,)"),
    ("omni", (CORNERS, [0.0, 1.0, nan, 2.0], 0.1), {}, "headings[2] must be finite, got nan"),
    ("omni", ([(0, inf)], [0.0], 0.1), {}, "positions must be finite, got (0.0, inf)"),
    ("omni", (CORNERS, [0.0] * 4, 0.1), {"names": ["a"] * 4}, 'wheels must have a name each, got "a" twice'),
    ("omni", (CORNERS, [0.0] * 4, 0.1), {"roller_angle": 0.0},
     "roller_angle must be finite and no multiple of pi: "
     "rollers along the axle leave nothing to drive, got 0.0"),
])  # fmt: skip
def test_bad_arguments_are_named(name, arguments, keywords, message):
    with pytest.raises(ValueError, match="must") as caught:
        getattr(Rover, name)(*arguments, **keywords)
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("keywords", "message"), [
    ({"roller_angle": 0.0}, "roller_angle must be finite and no multiple of pi"),
    ({"roller_angle": math.pi}, "roller_angle must be finite and no multiple of pi"),
    ({"roller_angle": 1.0, "steered": True}, "roller_angle must be left out for a wheel that turns"),
    ({"castor": True}, "trail must not be 0 for a castor"),
    ({"castor": True, "trail": nan}, "trail must be finite, got nan"),
    ({"castor": True, "trail": 0.1, "steered": True}, "castor must be neither steered nor driven"),
    ({"castor": True, "trail": 0.1, "driven": True}, "castor must be neither steered nor driven"),
    ({"steering_limit": 1.0}, "steering_limit must be left out for a wheel that is not steered, got 1"),
    ({"scrub": inf}, "scrub must be finite, got inf"),
    ({"radius": 0.0}, "radius must be finite and positive, got 0.0"),
])  # fmt: skip
def test_bad_wheels_are_named(keywords, message):
    with pytest.raises(ValueError, match="must") as caught:
        Wheel("w", 0.0, 0.0, **{"radius": 0.1, **keywords})
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("call", "message"), [
    (lambda r: r.mobility([nan]), "steering must be finite, got nan"),
    (lambda r: r.mobility([0.1, 0.2]), "steering must have shape (..., 1), got shape (2,)"),
    (lambda r: r.inverse((1, 0, 0), centre=(0, nan)), "centre must be finite, got (0.0, nan)"),
    (lambda r: r.inverse((1, 0, 0), centre=(0, 0, 0)), "centre must have shape (..., 2), got shape (3,)"),
    (lambda r: r.inverse([(1, 0, 0)] * 3, centre=[(0, 0)] * 2),
     "centre must have shape (3, 2), got shape (2, 2) beside twist"),
    (lambda r: r.inverse((1, 0, 0), previous_wheel_speeds=(nan, 0)),
     "previous_wheel_speeds must be finite, got (nan, 0.0)"),
    (lambda r: r.inverse((1, 0, 0), previous_wheel_speeds=(0,)),
     "previous_wheel_speeds must have shape (..., 2), got shape (1,)"),
])  # fmt: skip
def test_bad_options_are_named(call, message):
    with pytest.raises(ValueError, match="must") as caught:
        call(Rover.bicycle(1.0, 0.1))
    assert str(caught.value) == message
