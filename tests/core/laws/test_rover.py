"""Six-wheel rovers and any layout: laws first, then exact cases."""

import copy
import math
import pickle

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel import Rover, Wheel  # noqa: F401  (names that a repr refers to)
from tests.rovers import SIX_SIZES
from tests.strategies import any_twists, forward_twists, layouts, six_wheel_rovers


@pytest.fixture(scope="module")
def rover() -> sw.Rover:
    return sw.Rover.six_wheel(**SIX_SIZES)


@pytest.fixture(scope="module")
def osr() -> sw.Rover:
    return sw.Rover.preset("open_source_rover")


# Laws


def test_inverse_then_forward_is_the_identity_over_a_million_cases():
    # 1000 rovers x 1000 twists: turns of every radius, spins, straight lines and rest.
    generator = np.random.default_rng(20261121)
    worst_twist = worst_residual = 0.0
    for _ in range(1000):
        rover = sw.Rover.six_wheel(**{name: generator.uniform(0.05, 3.0) for name in SIX_SIZES})
        twists = np.zeros((1000, 3))
        twists[:, 0] = generator.uniform(-3, 3, 1000) * 10.0 ** generator.uniform(-3, 0, 1000)
        twists[:, 2] = generator.uniform(-3, 3, 1000) * 10.0 ** generator.uniform(-3, 0, 1000)
        twists[:50, 0] = twists[50:100, 2] = twists[100] = 0.0
        steering, speeds = rover.inverse(twists)
        fit = rover.fit(steering, speeds)
        worst_twist = max(worst_twist, np.abs(rover.forward(steering, speeds) - twists).max())
        worst_residual = max(worst_residual, fit.residuals.max())
    print(f"worst twist error {worst_twist:.2e}, worst residual {worst_residual:.2e} m/s")
    assert worst_twist < 1e-12  # rounding: speeds up to 12 m/s, 2e-15 each
    assert worst_residual < 1e-12


@given(layouts(offset=True), any_twists())
def test_inverse_then_forward_is_the_identity_for_any_layout(rover, twist):
    twist = rover.project(twist)
    steering, speeds = rover.inverse(twist)
    np.testing.assert_allclose(rover.forward(steering, speeds), twist, rtol=0, atol=1e-12)


@given(six_wheel_rovers(), forward_twists())
def test_every_wheel_axis_passes_through_the_icr(rover, twist):
    steering, _ = rover.inverse(twist)
    angles = dict(zip(rover.steered_wheel_names, steering, strict=True))
    icr = rover.icr(twist)
    assume(np.isfinite(icr).all())
    for wheel in rover.wheels:
        heading = np.array([math.cos(a := angles.get(wheel.name, 0.0)), math.sin(a)])
        arm = icr - [wheel.x, wheel.y]
        # The axis is square to the heading; rounding of positions and of an angle that an ulp of u turned.
        assert abs(heading @ arm) <= 1e-14 * (1 + np.abs(icr).max() + abs(wheel.x) + abs(wheel.y))


@given(six_wheel_rovers(), forward_twists())
def test_mirror_symmetry(rover, twist):
    vx, vy, omega = twist

    def rim_velocities(twist):
        steering, speeds = rover.inverse(twist)
        angles = np.zeros(6)
        angles[[0, 1, 4, 5]] = steering
        return np.array([speeds * np.cos(angles), speeds * np.sin(angles)])

    mirrored = rim_velocities((vx, -vy, -omega))
    seen_in_the_mirror = rim_velocities((vx, vy, omega))[:, [1, 0, 3, 2, 5, 4]] * [[1], [-1]]
    np.testing.assert_allclose(mirrored, seen_in_the_mirror, rtol=0, atol=1e-11)  # up to 600 rad/s


@given(six_wheel_rovers(), forward_twists(), st.floats(1e-3, 1e3))
def test_speeds_scale_with_the_twist_and_angles_do_not(rover, twist, factor):
    steering, speeds = rover.inverse(twist)
    same_steering, scaled_speeds = rover.inverse(np.multiply(twist, factor))
    np.testing.assert_allclose(same_steering, steering, rtol=0, atol=1e-13)
    np.testing.assert_allclose(scaled_speeds, speeds * factor, rtol=1e-13, atol=1e-13 * factor)


@given(layouts(), any_twists(), st.floats(-5, 5), st.floats(-5, 5), st.floats(-3, 3))
def test_the_choice_of_the_body_frame_does_not_matter(rover, twist, dx, dy, turn):
    # The same wheels and the same motion, described in a frame elsewhere on the body.
    cos, sin = math.cos(turn), math.sin(turn)

    def seen(x, y):
        return cos * (x - dx) + sin * (y - dy), -sin * (x - dx) + cos * (y - dy)

    moved = sw.Rover(
        [
            sw.Wheel(
                wheel.name,
                *seen(wheel.x, wheel.y),
                radius=wheel.radius,
                steered=wheel.steered,
                heading=wheel.heading - turn,
            )
            for wheel in rover.wheels
        ]
    )
    vx, vy, omega = rover.project(twist)
    u = (vx - omega * dy, vy + omega * dx)
    there = (cos * u[0] + sin * u[1], -sin * u[0] + cos * u[1], omega)
    _, speeds = rover.inverse((vx, vy, omega))
    steering, moved_speeds = moved.inverse(there)
    np.testing.assert_allclose(np.abs(moved_speeds), np.abs(speeds), rtol=0, atol=1e-11)
    np.testing.assert_allclose(moved.forward(steering, moved_speeds), there, rtol=0, atol=1e-12)


@given(six_wheel_rovers(), forward_twists(), st.lists(st.floats(-1.57, 1.57), min_size=4, max_size=4))
def test_a_previous_angle_never_changes_the_motion(rover, twist, previous):
    steering, speeds = rover.inverse(twist, previous=previous)
    np.testing.assert_allclose(rover.forward(steering, speeds), twist, rtol=0, atol=1e-12)


@given(st.floats(-8.0, 8.0), st.floats(-8.0, 8.0), st.floats(0.5, 9.0))
def test_the_nearest_equivalent_angle_is_taken(direction, previous, limit):
    wheels = [
        Wheel(n, 0, y, radius=0.1, steered=True, steering_limit=limit) for n, y in (("a", 0.2), ("b", -0.2))
    ]
    rover = sw.Rover(wheels)
    twist = (math.cos(direction), math.sin(direction), 0.0)
    turns = direction + math.pi * np.arange(-10, 11)
    possible = turns[np.abs(turns) <= limit]
    assume(np.abs(np.abs(turns) - limit).min() > 1e-6)
    if possible.size == 0:
        assert not rover.admissible(twist)
        return
    steering, _ = rover.inverse(twist, previous=[previous, previous])
    clipped = np.clip(previous, -limit, limit)
    nearest = np.abs(possible - clipped).min()
    np.testing.assert_allclose(np.abs(steering - clipped), nearest, atol=1e-12)


# Exact cases

CASES = [
    # twist, angles FL FR RL RR [rad], speeds FL FR ML MR RL RR [rad/s]; six printed digits
    (
        (0.5, 0.0, 0.5 / 1.5),
        (0.426627, 0.257324, -0.426627, -0.257324),
        (2.685121, 4.365974, 2.333333, 4.333333, 2.685121, 4.365974),
    ),
    (
        (0.5, 0.0, 0.5 / 0.3),
        (-1.373401, 0.620249, 1.373401, -0.620249),
        (-5.665577, 9.558139, -1.666667, 8.333333, -5.665577, 9.558139),
    ),
]
OSR_CASES = [
    # the same with angles in degrees
    (
        (0.5, 0.0, 0.5),
        (18.4141, 13.1048, -20.6399, -14.7555),  # the last is 14.755543; it is also found printed as 14.7556
        (5.782752, 8.056481, 4.98, 8.353333, 5.862987, 8.114265),
    ),
    (
        (0.0, 0.0, 0.5),
        (-57.1381, 57.1381, 60.2750, -60.2750),
        (-2.174652, 2.174652, -1.686667, 1.686667, -2.379813, 2.379813),
    ),
]


@pytest.mark.parametrize(("twist", "angles", "rates"), CASES)
def test_published_cases(rover, twist, angles, rates):
    steering, speeds = rover.inverse(twist)
    np.testing.assert_allclose(steering, angles, rtol=0, atol=5.1e-7)
    np.testing.assert_allclose(speeds, rates, rtol=0, atol=5.1e-7)


@pytest.mark.parametrize(("twist", "angles", "rates"), OSR_CASES)
def test_published_cases_with_unequal_axles(osr, twist, angles, rates):
    steering, speeds = osr.inverse(twist)
    np.testing.assert_allclose(np.degrees(steering), angles, rtol=0, atol=5.1e-5)
    np.testing.assert_allclose(speeds, rates, rtol=0, atol=5.1e-7)


def test_straight_lines_are_exact(rover):
    steering, speeds = rover.inverse((0.3, 0.0, 0.0))
    assert steering.tolist() == [0.0] * 4
    assert speeds.tolist() == [0.3 / 0.15] * 6
    steering, speeds = rover.inverse((-0.3, 0.0, 0.0))
    assert steering.tolist() == [0.0] * 4
    assert speeds.tolist() == [-0.3 / 0.15] * 6


def test_crab_with_every_wheel_steered():
    spots = [(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)]
    rover = sw.Rover([Wheel(f"w{i}", x, y, radius=0.1, steered=True) for i, (x, y) in enumerate(spots)])
    steering, speeds = rover.inverse((0.3, 0.3, 0.0))
    np.testing.assert_allclose(steering, np.pi / 4, rtol=1e-15)
    np.testing.assert_allclose(speeds, np.hypot(0.3, 0.3) / 0.1, rtol=1e-15)
    steering, speeds = rover.inverse((0.0, -0.3, 0.0))
    np.testing.assert_array_equal(steering, -np.pi / 2)  # forwards, not backwards at +90 degrees
    np.testing.assert_allclose(speeds, 3.0)


def test_a_wheel_under_the_icr_holds_its_angle():
    # The ICR lies on the front left pivot.
    rover = sw.Rover(
        [Wheel("a", 0.3, 0.4, radius=0.1, steered=True), Wheel("b", 0, -1, radius=0.1, steered=True)]
    )
    twist = (0.4, -0.3, 1.0)
    assert rover.inverse(twist)[0][0] == 0.0
    assert rover.inverse(twist, previous=(0.7, 0.0))[0][0] == 0.7
    assert rover.inverse(twist, previous=(9.0, 0.0))[0][0] == math.pi / 2  # as far as it goes
    assert abs(rover.inverse(twist)[1][0]) < 1e-14
    np.testing.assert_array_equal(rover.inverse((0, 0, 0), previous=(0.7, -0.2))[0], (0.7, -0.2))


def test_limits_of_turning():
    rover = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=math.radians(60))
    # half the track width +- D / tan(60 degrees)
    assert rover.min_radius == pytest.approx(0.4 + 0.5 / math.sqrt(3), rel=1e-12)
    assert rover.spin_radius == pytest.approx(0.4 - 0.5 / math.sqrt(3), rel=1e-12)
    assert rover.min_radius == pytest.approx(0.689, abs=5e-4)
    assert rover.spin_radius == pytest.approx(0.111, abs=5e-4)
    for radius, possible in [(0.7, True), (0.68, False), (0.12, False), (0.11, True), (0.0, True)]:
        for sign in (1, -1):
            assert rover.admissible((sign * radius, 0.0, 1.0)) is possible, radius
    narrow = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=math.radians(45))
    assert narrow.spin_radius == 0.0
    assert not narrow.admissible((0.0, 0.0, 1.0))
    free = sw.Rover.six_wheel(**SIX_SIZES)
    assert (free.min_radius, free.spin_radius) == (0.0, math.inf)


@given(six_wheel_rovers(st.floats(0.05, 1.5)), st.floats(-4, 4))
def test_radii_tell_what_is_admissible(rover, radius):
    scale = max(abs(w.x) + abs(w.y) for w in rover.wheels)
    assume(abs(abs(radius) - rover.min_radius) > 1e-6 * scale)
    assume(abs(abs(radius) - rover.spin_radius) > 1e-6 * scale)
    possible = abs(radius) > rover.min_radius or abs(radius) < rover.spin_radius
    assert rover.admissible((radius, 0.0, 1.0)) is possible


def test_the_smallest_turn_is_a_turn():
    rover = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=1.1)
    assert rover.spin_radius > 0.1
    for sign in (1, -1):
        rover.inverse((rover.spin_radius, 0.0, sign * 1.0))
        steering, _ = rover.inverse((0.5, 0.0, sign * 0.5 / rover.min_radius))
        assert np.abs(steering).max() <= 1.1


def test_icr(rover):
    np.testing.assert_array_equal(rover.icr((0.5, 0.1, 0.25)), (-0.4, 2.0))
    np.testing.assert_array_equal(rover.icr((0.5, 0.0, 0.0)), (0.0, math.inf))
    np.testing.assert_array_equal(rover.icr((-0.5, 0.0, 0.0)), (0.0, -math.inf))
    np.testing.assert_array_equal(rover.icr((0.0, 0.0, 1.0)), (0.0, 0.0))
    np.testing.assert_array_equal(rover.icr((0.0, 0.0, 0.0)), (math.nan, math.nan))


# Values


def test_rovers_are_values(rover):
    twin = sw.Rover.six_wheel(**SIX_SIZES)
    other = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=1.0)
    assert rover == twin
    assert hash(rover) == hash(twin)
    assert rover != other
    assert rover != "rover"
    assert len({rover, twin, other}) == 2
    for same in (pickle.loads(pickle.dumps(rover)), copy.deepcopy(rover)):
        assert same == rover
    with pytest.raises(AttributeError):
        rover.min_radius = 1.0
    with pytest.raises(AttributeError):
        rover.colour = "red"


@given(layouts(offset=True))
def test_a_repr_can_be_pasted_back(rover):
    assert eval(repr(rover)) == rover
    assert pickle.loads(pickle.dumps(rover)) == rover
    for wheel in rover.wheels:
        assert eval(repr(wheel)) == wheel
        assert hash(pickle.loads(pickle.dumps(wheel))) == hash(wheel)


def test_every_argument_of_a_wheel_can_be_read():
    wheel = Wheel(
        "w", 0.1, 0.2, radius=0.3, steered=True, steering_limit=1.0, heading=0.4, scrub=0.5, trail=0.6
    )
    assert (wheel.name, wheel.x, wheel.y, wheel.radius, wheel.heading) == ("w", 0.1, 0.2, 0.3, 0.4)
    assert (wheel.steered, wheel.driven, wheel.castor, wheel.roller_angle) == (True, True, False, None)
    assert (wheel.steering_limit, wheel.steering_range) == (1.0, (-1.0, 1.0))
    assert (wheel.scrub, wheel.trail) == (0.5, 0.6)
    assert Wheel("w", 0, 0, radius=1, steered=True, steering_limit=(-1, 2)).steering_limit == (-1.0, 2.0)
    assert Wheel("w", 0, 0, radius=1).steering_limit is None


def test_zeros_of_either_sign_hash_alike():
    plus, minus = Wheel("w", 0.0, 0.1, radius=0.1), Wheel("w", -0.0, 0.1, radius=0.1)
    assert plus == minus
    assert hash(plus) == hash(minus)


@pytest.mark.parametrize("name", sw.Rover.presets())
def test_presets_drive(name):
    rover = sw.Rover.preset(name)
    assert eval(repr(rover)) == rover
    twist = rover.project((0.1, 0.0, 0.02))
    np.testing.assert_allclose(rover.forward(*rover.inverse(twist)), twist, rtol=0, atol=1e-14)
    assert sw.Rover.presets()[name]


def test_presets_have_the_published_dimensions():
    perseverance = {w.name: (w.x, w.y, w.radius) for w in sw.Rover.preset("perseverance").wheels}
    assert perseverance["front_left"] == (1.18502, 1.0625, 0.26288)
    assert perseverance["middle_right"] == (0.0, -1.1845, 0.26288)
    assert perseverance["rear_right"] == (-1.07498, -1.0625, 0.26288)
    assert sw.Rover.preset("rocky7").wheels[0].steering_range == pytest.approx((-math.pi / 3, math.pi / 3))
    limited = sw.Rover.preset("perseverance", steering_limit=1.0)
    assert limited.wheels[0].steering_range == (-1.0, 1.0)
    with pytest.raises(ValueError, match='name must be one of perseverance, .* got "spirit"'):
        sw.Rover.preset("spirit")


def test_two_fixed_axles_turn_about_their_mean():
    husky = sw.Rover.preset("husky")
    twist = (0.5, 0.0, 0.3)
    _, speeds = husky.inverse(twist)
    half_track = 0.5708 / 2
    left, right = (0.5 - 0.3 * half_track) / 0.1651, (0.5 + 0.3 * half_track) / 0.1651
    np.testing.assert_allclose(speeds, [left, right, left, right], rtol=1e-14)
    np.testing.assert_allclose(husky.forward(None, speeds), twist, rtol=0, atol=1e-14)


def test_commands_carry_joint_names_in_their_order():
    wheels = [Wheel("left", 0, 0.3, radius=0.1), Wheel("right", 0, -0.3, radius=0.1)]
    wheels.append(Wheel("nose", 0.5, 0, radius=0.1, steered=True))
    rover = sw.Rover(
        wheels,
        traction_joints={"j_nose": "nose", "j_right": "right", "j_left": "left"},
        steering_joints={"s_nose": "nose"},
    )
    steering, speeds = rover.inverse((0.2, 0.0, 0.1))
    commands = rover.commands((0.2, 0.0, 0.1))
    assert list(commands) == ["s_nose", "j_nose", "j_right", "j_left"]
    assert commands == {"s_nose": steering[0], "j_nose": speeds[2], "j_right": speeds[1], "j_left": speeds[0]}
    batch = rover.commands([(0.2, 0.0, 0.1)] * 3)
    np.testing.assert_array_equal(batch["j_right"], [speeds[1]] * 3)
    assert eval(repr(rover)) == rover
    assert pickle.loads(pickle.dumps(rover)).traction_joints == rover.traction_joints
    with pytest.raises(
        ValueError, match='traction_joints must name every wheel once, got no joint for "left"'
    ):
        sw.Rover(wheels, traction_joints={"a": "right", "b": "nose"})
