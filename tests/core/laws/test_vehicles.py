"""Every planar vehicle is a list of wheels: the same laws for all of them, then the closed forms of each."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from six_wheel import Rover, Wheel, reference
from tests.rovers import CORNERS, SIX_SIZES
from tests.strategies import any_twists, at_most, layouts, lengths, offsets, six_wheel_rovers

ROUNDING = 1e-12  # a few operations on speeds of a few metres per second

radii = st.floats(0.02, 0.5)
limits = st.none() | st.floats(0.3, 4.0) | st.tuples(st.floats(-4.0, -0.3), st.floats(0.3, 4.0))
drives = st.sampled_from(["front", "rear", "all"])


@st.composite
def rings(draw: st.DrawFn) -> Rover:
    """Three or more omni wheels about the origin, roughly tangential, so that they determine the twist."""
    count = draw(st.integers(3, 6))
    spots = [math.tau * i / count + draw(offsets(0.2)) for i in range(count)]
    headings = [angle + math.pi / 2 + draw(offsets(0.2)) for angle in spots]
    positions = [(draw(st.floats(0.2, 1.0)) * math.cos(a), 0.5 * math.sin(a)) for a in spots]
    return Rover.omni(positions, headings, draw(radii), roller_angle=draw(st.floats(1.2, 1.9)))


@st.composite
def swerves(draw: st.DrawFn) -> Rover:
    """Modules on a grid, a little off it."""
    count = draw(st.integers(2, 6))
    spots = [(0.5 * (i % 2) + draw(offsets(0.2)), 0.5 * (i // 2) + draw(offsets(0.2))) for i in range(count)]
    return Rover.swerve(spots, draw(radii), steering_limit=draw(limits))


VEHICLES = {
    "six_wheel": six_wheel_rovers(st.floats(0.3, 1.7)),
    "swerve": swerves(),
    "differential": st.builds(Rover.differential, lengths(), radii),
    "unequal wheels": st.builds(Rover.differential, lengths(), st.tuples(radii, radii)),
    "skid steering": st.builds(
        Rover.differential, lengths(), radii, wheels_per_side=st.integers(2, 5), wheelbase=lengths()
    ),
    "tracked": st.builds(
        Rover.tracked,
        st.floats(0.2, 1.0),
        radii,
        icr_left=st.floats(0.1, 2.0),
        icr_right=st.floats(-2.0, -0.1),
        icr_forward=offsets(0.2),
    ),
    "ackermann": st.builds(
        Rover.ackermann, lengths(), lengths(), radii, steering_limit=limits, driven=drives
    ),
    "tricycle": st.builds(Rover.tricycle, lengths(), lengths(), radii, steering_limit=limits, driven=drives),
    "bicycle": st.builds(Rover.bicycle, lengths(), radii, steering_limit=limits, driven=drives),
    "mecanum": st.builds(Rover.mecanum, lengths(), lengths(), radii, roller_angle=st.floats(0.3, 1.3)),
    "omni": rings(),
    "any layout": layouts(offset=True),
}


def every_vehicle(*more):
    """A law of any vehicle and a twist it can make, tried on each of them by name."""

    def decorate(law):
        @pytest.mark.parametrize("vehicle", VEHICLES)
        @at_most(40)
        @given(data=st.data())
        def test(vehicle, data):
            rover = data.draw(VEHICLES[vehicle], label="rover")
            twist = rover.project(data.draw(any_twists(), label="twist"), keep="nearest")
            law(rover, twist, *(data.draw(strategy) for strategy in more))

        test.__name__ = law.__name__
        return test

    return decorate


def rebuilt(wheel: Wheel, **changes) -> Wheel:
    kept = ("name", "x", "y", "radius", "steered", "heading", "scrub", "trail", "roller_angle", "driven")
    given_ = {key: getattr(wheel, key) for key in (*kept, "castor")}
    return Wheel(**{**given_, "steering_limit": wheel.steering_range, **changes})


def directions(rover: Rover, steering) -> np.ndarray:
    """Heading of every wheel as a unit vector (wheels, 2)."""
    angles = np.array([wheel.heading for wheel in rover.wheels])
    angles[[wheel.steered for wheel in rover.wheels]] += steering
    return np.stack((np.cos(angles), np.sin(angles)), axis=-1)


def along_the_wheels(rover: Rover, twist, commands=None) -> np.ndarray:
    """Velocity of every pivot along its wheel, (wheels, 2) [m/s]: the same for either angle."""
    steering, speeds = rover.inverse(twist) if commands is None else commands
    rim, scrub = np.array([(w.radius * q, w.scrub) for w, q in zip(rover.wheels, speeds, strict=True)]).T
    return (rim + scrub * twist[2])[:, None] * directions(rover, steering)


# Laws of every vehicle


@every_vehicle()
def test_inverse_then_forward_is_the_identity(rover, twist):
    steering, speeds = rover.inverse(twist)
    fit = rover.fit(steering, speeds)
    assert_allclose(fit.twist, twist, rtol=0, atol=ROUNDING)
    assert_allclose(fit.residuals, 0.0, atol=ROUNDING)
    assert_array_equal(rover.forward(steering, speeds, level="scalar"), fit.twist)
    assert fit.rank == 3


@every_vehicle()
def test_every_wheel_moves_with_the_body(rover, twist):
    steering, speeds = rover.inverse(twist)
    vx, vy, omega = twist
    fixed = [w for w in rover.wheels if not w.steered and w.roller_angle is None]
    heads = directions(rover, steering)
    for wheel, e, speed in zip(rover.wheels, heads, speeds, strict=True):
        n = np.array([-e[1], e[0]])
        contact = np.array([wheel.x, wheel.y]) - wheel.trail * e + wheel.scrub * n
        slip = np.array([vx - omega * contact[1], vy + omega * contact[0]]) - wheel.radius * speed * e
        if wheel.roller_angle is not None:  # free across the rollers' axis
            held = slip @ (math.sin(wheel.roller_angle) * e + math.cos(wheel.roller_angle) * n)
            assert abs(held) < ROUNDING
            continue
        assert abs(slip @ e) < ROUNDING
        # Fixed wheels ahead of the mean axle and behind it scrub by design. Else: angles to their limits.
        axle = np.mean([w.x for w in fixed]) if wheel in fixed else wheel.x
        assert abs(slip @ n - omega * (wheel.x - axle)) < 1e-8


@every_vehicle(st.randoms(use_true_random=False))
def test_the_order_of_the_wheels_does_not_matter(rover, twist, random):
    order = random.sample(range(len(rover.wheels)), len(rover.wheels))
    shuffled = Rover([rover.wheels[i] for i in order])
    assert_allclose(along_the_wheels(shuffled, twist), along_the_wheels(rover, twist)[order], atol=ROUNDING)
    assert_allclose(shuffled.forward(*shuffled.inverse(twist)), twist, rtol=0, atol=ROUNDING)


@every_vehicle()
def test_a_mirror_shows_the_same_vehicle(rover, twist):
    def mirrored(wheel):
        return rebuilt(
            wheel,
            y=-wheel.y,
            heading=-wheel.heading,
            scrub=-wheel.scrub,
            roller_angle=None if wheel.roller_angle is None else -wheel.roller_angle,
            steering_limit=wheel.steering_range and tuple(-a for a in reversed(wheel.steering_range)),
        )

    mirror = Rover([mirrored(wheel) for wheel in rover.wheels])
    seen = along_the_wheels(mirror, twist * (1.0, -1.0, -1.0))
    assert_allclose(seen, along_the_wheels(rover, twist) * (1.0, -1.0), rtol=0, atol=1e-8)  # angle tolerance


@every_vehicle(st.floats(-3, 3), st.floats(-3, 3), st.floats(-3, 3))
def test_the_origin_of_the_body_does_not_matter(rover, twist, dx, dy, turn):
    cos, sin = math.cos(turn), math.sin(turn)
    axes = np.array([[cos, sin], [-sin, cos]])  # body vectors in axes turned by `turn`

    def seen(wheel):
        x, y = axes @ (wheel.x - dx, wheel.y - dy)
        return rebuilt(wheel, x=x, y=y, heading=wheel.heading - turn)

    moved = Rover([seen(wheel) for wheel in rover.wheels])
    vx, vy, omega = twist
    there = (*(axes @ (vx - omega * dy, vy + omega * dx)), omega)
    assert_allclose(
        along_the_wheels(moved, there), along_the_wheels(rover, twist) @ axes.T, rtol=0, atol=1e-8
    )
    assert_allclose(moved.forward(*moved.inverse(there)), there, rtol=0, atol=1e-11)  # lever of 4 m


@every_vehicle(st.tuples(st.floats(-3, 3), st.floats(-3, 3)))
def test_a_twist_may_be_given_at_any_point(rover, twist, centre):
    vx, vy, omega = twist
    x, y = centre
    ours = rover.inverse((vx - omega * y, vy + omega * x, omega), centre=centre)
    assert_allclose(rover.forward(*ours), twist, rtol=0, atol=1e-11)


@every_vehicle(st.floats(-2, 2), st.integers(0, 2**32 - 1))
def test_core_and_reference_agree(rover, twist, centre, seed):
    plain, generator = reference.Rover.like(rover), np.random.default_rng(seed)
    ours, theirs = rover.inverse(twist), plain.inverse(twist)
    assert [array.shape for array in ours] == [array.shape for array in theirs]
    expected = along_the_wheels(rover, twist, theirs)
    assert_allclose(along_the_wheels(rover, twist, ours), expected, rtol=0, atol=1e-8)  # angle tolerance
    fixed = [not wheel.steered for wheel in rover.wheels]
    assert_allclose(ours[1][fixed], theirs[1][fixed], rtol=1e-12, atol=1e-11)
    vx, vy, omega = twist
    at = (vx, vy + centre * omega, omega)
    seen = plain.inverse(at, centre=(centre, 0.0))
    assert_allclose(along_the_wheels(rover, twist, seen), expected, rtol=0, atol=1e-8)

    angles, readings = (generator.uniform(-3, 3, array.shape) for array in ours)
    readings[[not wheel.driven and generator.random() < 0.5 for wheel in rover.wheels]] = math.nan
    core = rover.fit(angles, readings, allow_underdetermined=True)
    fit = plain.fit(angles, readings)
    assert core.rank == fit.rank
    assert_allclose(core.sigma_min, fit.sigma_min, rtol=0, atol=1e-9)
    if fit.sigma_min > 1e-2 or fit.sigma_min == 0.0:
        assert_allclose(core.twist, fit.twist, rtol=0, atol=1e-9)
        assert_allclose(core.residuals, fit.residuals, rtol=0, atol=1e-9)

    ours, theirs = rover.mobility(angles), plain.mobility(angles)
    assert_allclose(ours.singular_values, theirs.singular_values, rtol=0, atol=1e-9)
    if min(abs(value - 1e-6) for value in theirs.singular_values) > 1e-9:
        assert (ours.rank, ours.degree_of_mobility) == (theirs.rank, theirs.degree_of_mobility)
        assert ours.degree_of_manoeuvrability == theirs.degree_of_manoeuvrability
        assert_allclose(ours.margin, theirs.margin, rtol=0, atol=1e-9)
    for radius in ("min_radius", "spin_radius"):
        assert getattr(rover, radius) == pytest.approx(getattr(plain, radius), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(("name", "arguments", "keywords"), [
    ("six_wheel", (), SIX_SIZES | {"steering_limit": 1.0}),
    ("swerve", (CORNERS, 0.1), {"steering_limit": (-7.0, 8.0)}),
    ("differential", (0.5, (0.1, 0.11)), {}),
    *(("differential", (0.5, 0.1), {"wheels_per_side": n, "wheelbase": 0.9}) for n in (2, 3, 4)),
    ("tracked", (0.5, 0.1), {"icr_left": 0.4, "icr_right": -0.3, "icr_forward": 0.05}),
    *(("ackermann", (1.0, 0.6, 0.2), {"driven": driven}) for driven in ("front", "rear", "all")),
    ("tricycle", (1.0, 0.6, 0.2), {"steering_limit": 1.2}),
    ("bicycle", (1.0, 0.3), {}),
    ("mecanum", (0.3, 0.2, 0.05), {"roller_angle": 0.8}),
    ("omni", (CORNERS, [0.1, 0.2, 0.3, 0.4], 0.05), {"roller_angle": 1.5}),
])  # fmt: skip
def test_core_and_reference_fill_the_same_lists(name, arguments, keywords):
    core, plain = getattr(Rover, name)(*arguments, **keywords), getattr(reference.Rover, name)
    ours, theirs = reference.Rover.like(core).wheels, plain(*arguments, **keywords).wheels
    assert [wheel.name for wheel in ours] == [wheel.name for wheel in theirs]
    for one, other in zip(ours, theirs, strict=True):
        assert one.steering_range == other.steering_range
        assert (one.driven, one.castor, one.steered) == (other.driven, other.castor, other.steered)
        for key in ("x", "y", "radius", "heading", "scrub", "trail", "roller_angle"):
            assert getattr(one, key) == pytest.approx(getattr(other, key), abs=1e-15), key


# Closed forms

forwards, turns = st.floats(-3, 3), st.floats(-3, 3)


@given(lengths(), lengths(), radii, forwards, turns)
def test_ackermann(wheelbase, track, radius, v, omega):
    rover = Rover.ackermann(wheelbase, track, radius)
    assume(abs(v) > 1.01 * track / 2 * abs(omega))  # both front wheels on the same side of the centre
    steering, speeds = rover.inverse((v, 0.0, omega))
    inner, outer = (math.atan(wheelbase * omega / (v - side * omega * track / 2)) for side in (1, -1))
    assert_allclose(steering, (inner, outer), rtol=0, atol=ROUNDING)
    rear = [v - omega * track / 2, v + omega * track / 2]
    front = [along / math.cos(angle) for along, angle in zip(rear, steering, strict=True)]
    assert_allclose(speeds, np.array([*front, *rear]) / radius, rtol=1e-12, atol=1e-11)
    if abs(omega) > 0.01:  # the condition of Ackermann
        difference = 1 / math.tan(steering[1]) - 1 / math.tan(steering[0])
        assert difference == pytest.approx(track / wheelbase, rel=1e-6)


@given(lengths(), lengths(), radii, forwards, st.floats(-3, 3))
def test_bicycle_and_tricycle(wheelbase, track, radius, v, curvature):
    twist, angle = (v, 0.0, v * curvature), math.atan(wheelbase * curvature)
    assume(abs(v) > 1e-3)
    front = v / math.cos(angle) / radius
    for rover, rear in (
        (Rover.bicycle(wheelbase, radius), [v]),
        (Rover.tricycle(wheelbase, track, radius), v * (1 + curvature * track / 2 * np.array([-1, 1]))),
    ):
        steering, speeds = rover.inverse(twist)
        assert_allclose(steering, [angle], rtol=0, atol=ROUNDING)
        assert_allclose(speeds, [front, *np.divide(rear, radius)], rtol=1e-12, atol=1e-11)


@given(lengths(), radii, radii, st.floats(-20, 20), st.floats(-20, 20))
def test_differential(track, left_radius, right_radius, left, right):
    rover = Rover.differential(track, (left_radius, right_radius))
    v_left, v_right = left_radius * left, right_radius * right
    twist = ((v_left + v_right) / 2, 0.0, (v_right - v_left) / track)
    assert_allclose(rover.forward(None, (left, right)), twist, rtol=0, atol=1e-11)
    assert_allclose(rover.inverse(twist)[1], (left, right), rtol=0, atol=1e-10)


@given(st.floats(0.1, 2), st.floats(-2, -0.1), st.floats(-0.4, 0.4), st.floats(-2, 2), st.floats(-2, 2))
def test_tracks_that_skid(left, right, ahead, v_left, v_right):
    # Martinez et al. 2005, Eq. (3) to (5), their x to the right and y ahead turned into ours.
    rover = Rover.tracked(0.6, 0.1, icr_left=left, icr_right=right, icr_forward=ahead)
    omega = (v_right - v_left) / (left - right)
    twist = ((v_right * left - v_left * right) / (left - right), -omega * ahead, omega)
    assert_allclose(rover.forward(None, (v_left / 0.1, v_right / 0.1)), twist, rtol=0, atol=1e-11)
    assert_allclose(rover.inverse(twist)[1], (v_left / 0.1, v_right / 0.1), rtol=0, atol=1e-10)


@given(lengths(), lengths(), radii, st.floats(0.3, 1.3), any_twists())
def test_mecanum(half_base, half_track, radius, angle, twist):
    rover = Rover.mecanum(2 * half_base, 2 * half_track, radius, roller_angle=angle)
    vx, vy, omega = twist
    cot = 1 / math.tan(angle)
    aside, lever = cot * vy, (half_track + cot * half_base) * omega
    wheels = [vx - aside - lever, vx + aside + lever, vx + aside - lever, vx - aside + lever]
    assert_allclose(rover.inverse(twist)[1], np.array(wheels) / radius, rtol=1e-12, atol=1e-11)


def test_mecanum_rows_of_a_recorded_robot():
    # The recording's rows, found by regression: (v - w - L r), (-v - w - L r), (v + w - L r), (-v + w - L r).
    rover = Rover.mecanum(0.4, 0.3, 0.05)
    L, sign = 0.35, np.array([1, -1, 1, -1])
    rows = np.array([(1, -1, -L), (-1, -1, -L), (1, 1, -L), (-1, 1, -L)])
    assert_allclose(rover.inverse(np.eye(3))[1].T * 0.05, rows * sign[:, None], rtol=0, atol=1e-15)


@given(any_twists(), st.floats(0.05, 2), radii)
def test_three_omni_wheels(twist, L, radius):
    # The recording's rows: (-0.866 v - 0.5 w - L r), (0.866 v - 0.5 w - L r), (w - L r).
    headings = np.radians([210.0, -30.0, 90.0])
    positions = L * np.stack((-np.sin(headings), np.cos(headings)), axis=-1)
    root = math.sqrt(3) / 2
    rows = np.array([(-root, -0.5, -L), (root, -0.5, -L), (0.0, 1.0, -L)])
    rover = Rover.omni(positions, headings, radius)
    assert_allclose(rover.inverse(twist)[1], rows @ twist / radius, rtol=0, atol=1e-11)
    assert_allclose(rover.forward(None, rows @ twist / radius), twist, rtol=0, atol=1e-11)
