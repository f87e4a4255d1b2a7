"""The reference against cases a person can check, and against the laws every rover obeys.

The core is compared with the reference elsewhere; nothing here imports it.
"""

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from six_wheel.reference import (
    InfeasibleMotionError,
    Rover,
    UnderdeterminedError,
    Wheel,
    compose,
    differentiate,
    exp,
    integrate,
    log,
    wrap_angle,
)
from tests.core.oracles.reference_rovers import (
    admissible_twist,
    limits,
    rovers,
    speed,
    swerve,
    twists,
)
from tests.rovers import SIX_SIZES

OPEN_SOURCE = {
    "front_to_middle": 0.274,
    "middle_to_rear": 0.310,
    "track_width": 0.354,
    "middle_track_width": 0.506,
    "wheel_radius": 0.075,
}
PRINTED = 5e-7  # the cases are printed with six digits
ROUNDING = 1e-12  # a few operations on numbers of order one


def caster(trail, scrub=0.0, limit=math.pi):
    """A differential drive with a steered wheel in front whose contact point is not under its pivot."""
    front = Wheel("front", 0.5, 0.1, radius=0.1, steered=True, steering_limit=limit, scrub=scrub, trail=trail)
    return Rover((Wheel("left", 0.0, 0.3, radius=0.2), Wheel("right", 0.0, -0.3, radius=0.2), front))


# Exact cases


@pytest.mark.parametrize(
    ("rover", "twist", "angles", "rates"),
    [
        (
            SIX_SIZES,
            (0.5, 0.0, 0.5 / 1.5),
            (0.426627, 0.257324, -0.426627, -0.257324),
            (2.685121, 4.365974, 2.333333, 4.333333, 2.685121, 4.365974),
        ),
        (
            SIX_SIZES,
            (0.5, 0.0, 0.5 / 0.3),
            (-1.373401, 0.620249, 1.373401, -0.620249),
            (-5.665577, 9.558139, -1.666667, 8.333333, -5.665577, 9.558139),
        ),
    ],
)
def test_turns_of_the_first_rover(rover, twist, angles, rates):
    steering, speeds = Rover.six_wheel(**rover).inverse(twist)
    np.testing.assert_allclose(steering, angles, rtol=0, atol=PRINTED)
    np.testing.assert_allclose(speeds, rates, rtol=0, atol=PRINTED)


@pytest.mark.parametrize(
    ("twist", "degrees", "rates"),
    [
        (
            (0.5, 0.0, 0.5),
            (18.4141, 13.1048, -20.6399, -14.7555),  # the last is 14.755543
            (5.782752, 8.056481, 4.98, 8.353333, 5.862987, 8.114265),
        ),
        (
            (0.0, 0.0, 0.5),
            (-57.1381, 57.1381, 60.2750, -60.2750),
            (-2.174652, 2.174652, -1.686667, 1.686667, -2.379813, 2.379813),
        ),
    ],
)
def test_turns_with_unequal_axles(twist, degrees, rates):
    steering, speeds = Rover.six_wheel(**OPEN_SOURCE).inverse(twist)
    np.testing.assert_allclose(np.degrees(steering), degrees, rtol=0, atol=5.1e-5)  # four decimals
    np.testing.assert_allclose(speeds, rates, rtol=0, atol=PRINTED)


def test_straight_line_and_rest():
    rover = Rover.six_wheel(**SIX_SIZES)
    steering, speeds = rover.inverse((0.3, 0.0, 0.0))
    np.testing.assert_array_equal(steering, 0.0)
    np.testing.assert_allclose(speeds, 2.0, rtol=ROUNDING)
    held, still = rover.inverse((0.0, 0.0, 0.0), previous=(0.1, 0.2, 0.3, 2.0))
    np.testing.assert_array_equal(held, (0.1, 0.2, 0.3, math.pi / 2))  # the last one stands at its limit
    np.testing.assert_array_equal(still, 0.0)


def test_six_wheel_order_and_limits():
    rover = Rover.six_wheel(**SIX_SIZES, steering_limit=(-0.5, 0.6))
    names = [f"{axle}_{side}" for axle in ("front", "middle", "rear") for side in ("left", "right")]
    assert [wheel.name for wheel in rover.wheels] == names
    assert [wheel.name for wheel in rover.steered] == names[:2] + names[4:]
    assert {wheel.steering_range for wheel in rover.wheels} == {(-0.5, 0.6), None}
    assert Rover.like(rover).wheels == rover.wheels


def test_limit_of_sixty_degrees():
    rover = Rover.six_wheel(**SIX_SIZES, steering_limit=math.radians(60))
    assert rover.min_radius == pytest.approx(0.4 + 0.5 / math.tan(math.radians(60)), abs=ROUNDING)
    assert rover.spin_radius == pytest.approx(0.4 - 0.5 / math.tan(math.radians(60)), abs=ROUNDING)
    assert (round(rover.min_radius, 3), round(rover.spin_radius, 3)) == (0.689, 0.111)
    # Every radius is possible on one side of the limits, none between them.
    radii = np.array([0.0, 0.05, 0.111, 0.112, 0.4, 0.688, 0.689, 1.0, 1e6])
    possible = rover.admissible([[sign * r, 0.0, 1.0] for sign in (1, -1) for r in radii])
    np.testing.assert_array_equal(possible, np.tile([True] * 3 + [False] * 3 + [True] * 3, 2))


def test_radii_without_limits_without_spin_and_without_turns():
    free = Rover.six_wheel(**SIX_SIZES)
    assert (free.min_radius, free.spin_radius) == (0.0, math.inf)
    narrow = Rover.six_wheel(**SIX_SIZES, steering_limit=math.radians(40))
    assert narrow.min_radius == pytest.approx(0.4 + 0.5 / math.tan(math.radians(40)), abs=ROUNDING)
    assert narrow.spin_radius == 0.0
    crossed = Rover((Wheel("a", 0.3, 0.0, radius=0.1), Wheel("b", 0.0, 0.3, radius=0.1, heading=0.5)))
    assert (crossed.min_radius, crossed.spin_radius) == (math.inf, 0.0)


NEARLY_STILL = (0.3, 2)  # turning radius [m], wheel
RADII = [-0.2, 0.0, 0.05, 0.3, 0.8, 1.5, 5.0, 100.0, math.inf]


# Without the middle wheel that all but stands: half of nearly nothing is no fault.
@pytest.mark.parametrize(
    ("radius", "wheel"), [pair for pair in product(RADII, range(6)) if pair != NEARLY_STILL]
)
def test_robust_fit_finds_the_wheel_that_reads_half_as_much_again(radius, wheel):
    rover = Rover.six_wheel(**OPEN_SOURCE)
    omega = 0.5 / max(abs(radius), 0.3)
    twist = admissible_twist(0.5, 0.0) if radius == math.inf else admissible_twist(omega * radius, omega)
    steering, speeds = rover.inverse(twist)
    assert abs(speeds[wheel]) >= 0.1 * np.max(np.abs(speeds))
    speeds[wheel] *= 1.5
    fit = rover.fit(steering, speeds, method="robust")
    scale = max(abs(twist[0]), 0.3 * abs(twist[2]))
    np.testing.assert_allclose(fit.twist, twist, rtol=0, atol=0.001 * scale)  # a tenth of what is promised
    assert np.argmax(fit.residuals) == np.argmin(fit.weights) == wheel


def test_middle_wheel_fault_on_the_open_source_rover():
    rover = Rover.six_wheel(**OPEN_SOURCE)
    twist = admissible_twist(0.5, 0.5 / 1.5)
    steering, speeds = rover.inverse(twist)
    speeds[2] *= 1.5
    error = {
        method: rover.fit(steering, speeds, method=method).twist[2] / twist[2] - 1.0
        for method in ("middle_wheels", "least_squares", "robust")
    }
    assert error["middle_wheels"] == pytest.approx(-1.23, abs=0.005)
    assert error["least_squares"] == pytest.approx(-0.265, abs=0.0005)
    assert abs(error["robust"]) <= 0.001


def test_fit_reports_rank_weights_and_residuals():
    rover = Rover.six_wheel(**SIX_SIZES)
    steering, speeds = rover.inverse([(0.5, 0.0, 0.3), (0.0, 0.0, 1.0)])
    for method in ("least_squares", "middle_wheels", "robust"):
        fit = rover.fit(steering, speeds, method=method)
        np.testing.assert_allclose(fit.twist, [(0.5, 0.0, 0.3), (0.0, 0.0, 1.0)], atol=ROUNDING)
        np.testing.assert_allclose(fit.residuals, np.zeros((2, 6)), atol=ROUNDING)
        np.testing.assert_array_equal(fit.rank, (3, 3))
        assert np.all(fit.sigma_min > 0.1)
    np.testing.assert_array_equal(
        rover.fit(steering, speeds, method="middle_wheels").weights[0], [0, 0, 1, 1, 0, 0]
    )
    one = Rover((Wheel("one", 0.2, 0.1, radius=0.1, steered=True),))
    assert one.fit([0.1], [1.0]).rank == 2
    with pytest.raises(UnderdeterminedError, match="rank 2"):
        one.forward([0.1], [1.0])


def test_two_parallel_axles_turn_about_their_mean():
    rover = Rover(tuple(Wheel(f"{x}{y}", x, y, radius=0.1) for x in (0.4, -0.2) for y in (0.3, -0.3)))
    twist = np.array([0.5, -0.1 * 0.7, 0.7])
    assert rover.admissible(twist)
    assert not rover.admissible((0.5, 0.0, 0.7))
    _, speeds = rover.inverse(twist)
    np.testing.assert_allclose(rover.forward([], speeds), twist, atol=ROUNDING)
    np.testing.assert_allclose(rover.project((0.5, 0.0, 0.7)), twist, atol=ROUNDING)


def test_equivalent_angles():
    rover = swerve(limit=3.1)
    forward, _ = rover.inverse((1.0, 0.1, 0.0))
    np.testing.assert_allclose(forward, math.atan2(0.1, 1.0), atol=ROUNDING)
    turned, speeds = rover.inverse((1.0, 0.1, 0.0), previous=np.full(4, -2.5))
    np.testing.assert_allclose(turned, math.atan2(0.1, 1.0) - math.pi, atol=ROUNDING)
    assert np.all(speeds < 0.0)
    for vy in (1.0, -1.0):  # both angles are equally far: the wheel drives forwards
        crab, speeds = swerve().inverse((0.0, vy, 0.0))
        np.testing.assert_allclose(crab, vy * math.pi / 2, atol=ROUNDING)
        assert np.all(speeds > 0.0)


def test_centre_of_rotation():
    rover = swerve()
    np.testing.assert_array_equal(rover.icr((1.0, -1.0, 2.0)), (0.5, 0.5))
    np.testing.assert_array_equal(
        rover.icr([(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, -1.0, 0.0), (0.0, 0.0, 0.0)]),
        [(0.0, np.inf), (0.0, -np.inf), (-np.inf, 0.0), (np.inf, np.inf), (np.nan, np.nan)],
    )


def test_quarter_circle():
    np.testing.assert_allclose(
        exp((1.0, 0.0, math.pi / 2)), np.array([2, 2, math.pi**2 / 2]) / math.pi, rtol=1e-15
    )
    square = integrate(np.tile((1.0, 0.0, math.pi / 2), (4, 1)), 1.0, start=(1.0, 2.0, 0.0))
    np.testing.assert_allclose(square[-1], (1.0, 2.0, math.tau), atol=ROUNDING)
    np.testing.assert_allclose(
        wrap_angle(square[:, 2]), np.array([0, 1, 2, -1, 0]) * math.pi / 2, atol=ROUNDING
    )


@pytest.mark.parametrize("call", [
    lambda rover: rover.inverse((math.nan, 0.0, 0.0)),
    lambda rover: rover.admissible((0.0, math.inf, 0.0)),
    lambda rover: integrate([(1.0, 0.0, 0.0)], -0.1),
    lambda rover: exp((1.0, 0.0, 0.0), math.nan),
    lambda rover: rover.fit(np.zeros(4), np.zeros(6), method="best"),
])  # fmt: skip
def test_bad_arguments(call):
    with pytest.raises(ValueError, match="must be"):
        call(Rover.six_wheel(**SIX_SIZES))


def test_what_cannot_be_done_is_refused():
    rover = Rover.six_wheel(**SIX_SIZES, steering_limit=math.radians(60))
    with pytest.raises(InfeasibleMotionError, match="sideways"):
        rover.inverse((0.5, 0.1, 0.0))
    with pytest.raises(InfeasibleMotionError, match="front_left"):
        rover.inverse((0.4, 0.0, 1.0))
    fixed = Rover.six_wheel(**SIX_SIZES, steering_limit=math.radians(40))
    np.testing.assert_array_equal(fixed.project((0.0, 0.0, 1.0)), 0.0)  # a spin it cannot make is rest
    headings = {"a": (0.3, 0.0, 0.0), "b": (0.0, 0.3, 0.5), "c": (-0.3, 0.0, 1.0)}
    locked = Rover(tuple(Wheel(k, x, y, radius=0.1, heading=h) for k, (x, y, h) in headings.items()))
    np.testing.assert_allclose(locked.project((0.1, 0.2, 0.5)), 0.0, atol=ROUNDING)
    with pytest.raises(InfeasibleMotionError, match="yaw_rate"):
        locked.project((0.0, 0.1, 0.5), keep="yaw_rate")


@pytest.mark.parametrize("share", [0.5, 2.0])
def test_both_sides_of_the_slip_tolerance(share):
    rover = Rover.six_wheel(**SIX_SIZES, steering_limit=math.radians(60))
    slip = share * 1e-9
    assert rover.admissible((1.0, slip, 0.0)) == (share < 1.0)
    # Turning inside the smallest radius, the inner front wheel slips by cos(60 deg) times what is missing.
    limit = np.array([rover.min_radius, 0.0, 1.0])
    fastest = math.hypot(rover.min_radius + 0.4, 0.5)
    missing = np.array([slip * fastest / math.sin(math.radians(60)), 0.0, 0.0])
    assert rover.admissible(limit - missing) == (share < 1.0)
    if share < 1.0:
        steering, _ = rover.inverse(limit - missing)
        assert steering[0] == math.radians(60)


# Laws


@given(rovers, speed, speed)
def test_inverse_then_forward_is_the_twist(rover, vx, omega):
    twist = admissible_twist(vx, omega)
    for method in ("least_squares", "robust"):
        fit = rover.fit(*rover.inverse(twist), method=method)
        np.testing.assert_allclose(fit.twist, twist, rtol=0, atol=1e-11)  # rounding over d as small as 0.1 m
        np.testing.assert_allclose(fit.residuals, 0.0, atol=1e-11)


@given(twists, st.none() | limits)
def test_inverse_then_forward_is_the_twist_of_a_swerve(twist, limit):
    rover = swerve(limit)
    twist = rover.project(twist)
    # slip tolerance
    np.testing.assert_allclose(rover.forward(*rover.inverse(twist)), twist, rtol=0, atol=1e-8)


@given(st.floats(-0.4, 0.4), st.floats(-0.2, 0.2), speed, speed, st.floats(-0.5, 0.5))
def test_inverse_then_forward_is_the_twist_of_a_caster(trail, scrub, vx, omega, rate):
    rover, twist = caster(trail, scrub), admissible_twist(vx, omega)
    u = np.array([vx - 0.1 * omega, 0.5 * omega])
    assume(np.linalg.norm(u) > abs((omega + rate) * trail) + 1e-3)
    steering, speeds = rover.inverse(twist, steering_rates=[rate])
    np.testing.assert_allclose(rover.forward(steering, speeds, steering_rates=[rate]), twist, atol=1e-9)
    # Differentiate pivot + R(angle) (-trail, scrub): the contact rolls along e and does not slip along n.
    cos, sin = math.cos(steering[0]), math.sin(steering[0])
    e, n = np.array([cos, sin]), np.array([-sin, cos])
    contact = u + (omega + rate) * (-scrub * e - trail * n)
    np.testing.assert_allclose((contact @ e, contact @ n), (0.1 * speeds[2], 0.0), atol=1e-9)


def test_a_caster_cannot_follow_a_pivot_slower_than_its_trail():
    rover = caster(trail=0.7)
    assert not rover.admissible((0.1, 0.0, 1.0))  # the pivot does 0.5 m/s, the contact would need 0.7 m/s
    radius = 0.1 + math.sqrt(0.7**2 - 0.5**2)
    assert rover.min_radius == pytest.approx(radius, abs=ROUNDING)
    assert rover.admissible([(radius + step, 0.0, 1.0) for step in (1e-6, -1e-6)]).tolist() == [True, False]


@given(rovers, speed, speed)
def test_mirror_symmetry(rover, vx, omega):
    steering, speeds = rover.inverse(admissible_twist(vx, omega))
    mirrored, rates = rover.inverse(admissible_twist(vx, -omega))
    np.testing.assert_allclose(mirrored[[1, 0, 3, 2]], -steering, atol=ROUNDING)
    # speeds up to 100 rad/s
    np.testing.assert_allclose(rates[[1, 0, 3, 2, 5, 4]], speeds, rtol=0, atol=1e-10)


@given(rovers, speed, speed)
def test_axles_of_the_wheels_meet_in_the_centre_of_rotation(rover, vx, omega):
    assume(abs(omega) > 1e-3)
    twist = admissible_twist(vx, omega)
    steering, _ = rover.inverse(twist)
    angles = np.array([*steering[:2], 0.0, 0.0, *steering[2:]])
    to_centre = rover.icr(twist) - [(wheel.x, wheel.y) for wheel in rover.wheels]
    along = np.cos(angles) * to_centre[:, 0] + np.sin(angles) * to_centre[:, 1]
    np.testing.assert_allclose(along, 0.0, atol=1e-12 * (1.0 + np.max(np.abs(to_centre))))


@given(twists, st.floats(0.01, 1.0))
def test_two_half_steps_make_one(twist, dt):
    half = exp(twist, dt / 2)
    np.testing.assert_allclose(compose(half, half), exp(twist, dt), atol=ROUNDING)


@given(st.lists(twists, min_size=1, max_size=8), st.floats(0.01, 1.5), twists)
def test_differentiate_undoes_integrate(steps, dt, start):
    poses = integrate(steps, dt, start)
    # A turn stays below pi; the shorter the step, the more of the position's rounding the speeds see.
    np.testing.assert_allclose(differentiate(poses, dt), steps, atol=1e-13 * len(steps) / dt + ROUNDING)


@given(twists, st.floats(-math.pi, math.pi))
def test_log_undoes_exp_up_to_half_a_turn(twist, turn):
    twist = np.array([twist[0], twist[1], turn])
    np.testing.assert_allclose(log(exp(twist)), twist, atol=ROUNDING)
    np.testing.assert_allclose(exp(log(exp(twist, 0.5), 0.5), 0.5), exp(twist, 0.5), atol=ROUNDING)
