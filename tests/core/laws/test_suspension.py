"""Rocker-bogie rovers: laws, the reference, exact cases, the boundary."""

import copy
import math
import pickle

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import six_wheel as sw
from six_wheel import RockerBogie  # noqa: F401  (the name that a repr refers to)
from six_wheel.reference.ground import suspension as reference
from tests.core.laws.suspensions import ROCKY

PRESETS = {name: sw.RockerBogie.preset(name) for name in ("rocky7", "perseverance", "curiosity")}
FRAMES = ["D", "B1", "B2", *(f"S{i}" for i in range(1, 7)), *(f"A{i}" for i in range(1, 7))]
WHEELS = [f"A{i}" for i in range(1, 7)]
NAMES = ("front_left", "front_right", "middle_left", "middle_right", "rear_left", "rear_right")
MIRRORED = dict(zip("123456", "214365", strict=True))
ROUNDING = 1e-14  # a chain of four transforms of numbers of order one

angles = st.floats(-1.5, 1.5)
betas = st.tuples(angles, angles)
presets = st.sampled_from(list(PRESETS.values()))


@st.composite
def suspensions(draw: st.DrawFn) -> sw.RockerBogie:
    def vector(x, y, z):
        return tuple(draw(st.floats(*bounds)) for bounds in (x, y, z))

    return sw.RockerBogie(
        rocker_pivot=vector((-0.5, 0.5), (0.1, 1.0), (0.0, 1.0)),
        rocker_to_front=vector((0.1, 1.0), (0.0, 0.5), (-1.0, 0.0)),
        rocker_to_bogie=vector((-1.0, 0.2), (0.0, 0.5), (-0.5, 0.2)),
        bogie_to_middle=vector((0.05, 0.6), (-0.05, 0.5), (-0.5, 0.0)),
        bogie_to_rear=vector((-0.7, -0.05), (-0.05, 0.5), (-0.5, 0.0)),
        wheel_radius=draw(st.floats(0.05, 0.4)),
        steered=draw(st.sampled_from(["front", "corners"])),
    )


def chain(rho, beta) -> np.ndarray:
    """Rows of joints of the suspension, of the angles as the papers name them."""
    return np.concatenate([np.asarray(rho)[..., None], beta], axis=-1)


def steered(arm: sw.RockerBogie) -> int:
    return len(arm.joint_names) - 3


def psis(arm: sw.RockerBogie, generator: np.random.Generator, *leading: int) -> np.ndarray:
    return generator.uniform(-1.5, 1.5, (*leading, steered(arm)))


def plain(arm: sw.RockerBogie) -> reference.RockerBogie:
    """The same suspension in the symbols of the table; both wheels of a bogie have one height there."""
    of = arm.dimensions
    (k2, half_track, k1), (k4, y_front, z_front) = of["rocker_pivot"], of["rocker_to_front"]
    x, y, z = of["rocker_to_bogie"]
    middle, rear = of["bogie_to_middle"], of["bogie_to_rear"]
    assert middle[2] == rear[2]
    return reference.RockerBogie(
        k1,
        k2,
        half_track + y_front,
        k4,
        -z_front,
        math.hypot(x, z),
        (middle[0], -rear[0]),
        -middle[2],
        math.atan2(-z, x),
        of["wheel_radius"],
        k3b=(y + middle[1] - y_front, y + rear[1] - y_front),
        corners=of["steered"] == "corners",
    )


# Laws


@given(suspensions(), angles, betas)
def test_every_frame_is_a_rigid_motion(arm, rho, beta):
    for frame in arm.frames(chain(rho, beta), [0.3] * steered(arm)).values():
        rotation = frame[:3, :3]
        np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), rtol=0, atol=ROUNDING)
        assert np.linalg.det(rotation) == pytest.approx(1.0, abs=ROUNDING)
        assert frame[3].tolist() == [0, 0, 0, 1]


@given(suspensions(), angles, betas, st.lists(angles, min_size=2, max_size=2))
def test_the_right_hand_side_mirrors_the_left(arm, rho, beta, psi):
    # Rockers and bogies exchanged, every wheel steered the other way: y changes its sign and nothing else.
    psi = psi * (steered(arm) // 2)
    mirrored_psi = [-angle for pair in zip(psi[1::2], psi[::2], strict=True) for angle in pair]
    frames, mirrored = arm.frames(chain(rho, beta), psi), arm.frames(chain(-rho, beta[::-1]), mirrored_psi)
    flip = np.diag([1.0, -1.0, 1.0, 1.0])
    for wheel in WHEELS:
        twin = mirrored["A" + MIRRORED[wheel[1]]]
        np.testing.assert_allclose(flip @ frames[wheel] @ flip, twin, rtol=0, atol=ROUNDING)


@given(suspensions(), angles, betas)
def test_links_are_rigid(arm, rho, beta):
    # Turning about y by hand: pivot + R(rho) (to_bogie + R(beta) to_wheel).
    def turned(angle, vector):
        cos, sin = math.cos(angle), math.sin(angle)
        return np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]) @ vector

    of, frames = arm.dimensions, arm.frames(chain(rho, beta))
    pivot = np.array(of["rocker_pivot"])
    front = pivot + turned(rho, np.array(of["rocker_to_front"]))
    np.testing.assert_allclose(frames["A1"][:3, 3], front, rtol=0, atol=ROUNDING)
    for wheel, vector in (("A3", "bogie_to_middle"), ("A5", "bogie_to_rear")):
        arm_of_rocker = np.array(of["rocker_to_bogie"]) + turned(beta[0], np.array(of[vector]))
        np.testing.assert_allclose(
            frames[wheel][:3, 3], pivot + turned(rho, arm_of_rocker), rtol=0, atol=ROUNDING
        )


@given(suspensions(), angles, betas, st.lists(angles, min_size=4, max_size=4))
def test_jacobians_are_the_differences_of_frames(arm, rho, beta, psi):
    joints, step = np.array([rho, *beta, *psi[: steered(arm)]]), 1e-5
    jacobians = arm.jacobians(chain(rho, beta), joints[3:])
    for joint in range(len(joints)):
        ahead, behind = joints.copy(), joints.copy()
        ahead[joint] += step
        behind[joint] -= step
        there, back = (arm.frames(q[:3], q[3:]) for q in (ahead, behind))
        for wheel in WHEELS:
            slope = (there[wheel][:3, 3] - back[wheel][:3, 3]) / (2 * step)
            # Arms up to 2.5 m: truncated arm step^2 / 6 = 4e-11, rounding eps arm / step = 6e-11.
            np.testing.assert_allclose(jacobians[wheel][:, joint], slope, rtol=0, atol=5e-10)


@given(presets, st.integers(0, 2**32 - 1))
def test_a_batch_is_its_rows(arm, seed):
    generator = np.random.default_rng(seed)
    rho, beta = generator.uniform(-1, 1, (2, 3)), generator.uniform(-1, 1, (2, 3, 2))
    psi, speeds = psis(arm, generator, 2, 3), generator.uniform(-1, 1, (2, 2, 3))
    frames, jacobians = arm.frames(chain(rho, beta), psi), arm.jacobians(chain(rho, beta), psi)
    offsets = arm.icr_offset(chain(rho, beta))
    # Speed before yaw rate: Rocky 7 cannot make every turn.
    command = arm.steer(speeds[0], 0.1 * speeds[0] * speeds[1], chain(rho, beta))
    for i in np.ndindex(2, 3):
        for name, frame in arm.frames(chain(rho[i], beta[i]), psi[i]).items():
            np.testing.assert_array_equal(frames[name][i], frame)
        for name, jacobian in arm.jacobians(chain(rho[i], beta[i]), psi[i]).items():
            np.testing.assert_array_equal(jacobians[name][i], jacobian)
        assert offsets[i] == arm.icr_offset(chain(rho[i], beta[i]))
        one = arm.steer(speeds[0][i], 0.1 * speeds[0][i] * speeds[1][i], chain(rho[i], beta[i]))
        for field in ("steering", "wheel_speeds", "turning_radius", "scrub"):
            np.testing.assert_array_equal(getattr(command, field)[i], getattr(one, field))


@given(suspensions(), angles, betas, st.floats(-2, 2), st.floats(-2, 2))
def test_steering_is_the_wheel_equation_of_the_planar_rover(arm, rho, beta, speed, yaw_rate):
    rover, offset = arm.planar(chain(rho, beta)), arm.icr_offset(chain(rho, beta))
    twist = (speed, yaw_rate * offset, yaw_rate)
    command = arm.steer(speed, yaw_rate, chain(rho, beta))
    steering, speeds = rover.inverse(twist, level="scalar")
    np.testing.assert_array_equal(command.steering, steering)
    np.testing.assert_array_equal(command.wheel_speeds, speeds)
    np.testing.assert_array_equal(command.turning_radius, rover.icr(twist)[1])
    np.testing.assert_allclose(rover.forward(steering, speeds), twist, rtol=0, atol=1e-12)
    unsteered = [wheel for wheel in rover.wheels if not wheel.steered]
    sideways = [yaw_rate * (wheel.x + offset) for wheel in unsteered]
    np.testing.assert_allclose(command.scrub, sideways, rtol=0, atol=ROUNDING)
    assert abs(command.scrub.sum()) <= ROUNDING  # least squares: what scrubs one way scrubs the other


@given(suspensions(), angles, betas)
def test_planar_wheels_are_under_the_frames(arm, rho, beta):
    rover, frames = arm.planar(chain(rho, beta)), arm.frames(chain(rho, beta))
    assert rover.wheel_names == NAMES
    for wheel, name in zip(rover.wheels, WHEELS, strict=True):
        assert [wheel.x, wheel.y] == frames[name][:2, 3].tolist()
        assert wheel.radius == arm.dimensions["wheel_radius"]


def test_steering_turns_a_wheel_about_its_centre():
    straight, turned = ROCKY.frames((0.2, 0.1, -0.3)), ROCKY.frames((0.2, 0.1, -0.3), (0.5, -0.4))
    for wheel, psi in (("A1", 0.5), ("A2", -0.4)):
        np.testing.assert_allclose(
            turned[wheel], straight[wheel] @ reference.rot_z(psi), rtol=0, atol=ROUNDING
        )
    for jacobian in ROCKY.jacobians((0.2, 0.1, -0.3), (0.5, -0.4)).values():
        np.testing.assert_allclose(jacobian[:, 3:], 0.0, atol=1e-15)


def test_a_held_angle_is_kept_at_rest():
    command = ROCKY.steer(0.0, 0.0, (0.1, 0.0, 0.0), previous=(0.3, -0.2))
    assert command.steering.tolist() == [0.3, -0.2]
    assert math.isnan(command.turning_radius)
    assert command.wheel_speeds.tolist() == [0.0] * 6


# Oracle


@given(presets, angles, betas, st.integers(0, 2**32 - 1))
def test_frames_agree_with_the_reference(arm, rho, beta, seed):
    psi = psis(arm, np.random.default_rng(seed)).tolist()
    expected = plain(arm).frames(rho, beta, psi)
    frames = arm.frames(chain(rho, beta), psi)
    assert list(frames) == FRAMES
    for wheel in WHEELS if arm is not ROCKY else FRAMES:
        np.testing.assert_allclose(frames[wheel], expected[wheel], rtol=0, atol=1e-12)


@given(st.floats(-math.pi, math.pi), betas, betas)
def test_every_frame_of_rocky_7_agrees_with_the_printed_table(rho, beta, psi):
    expected = reference.RockerBogie.rocky7().frames(rho, beta, list(psi))
    for name, frame in ROCKY.frames(chain(rho, beta), psi).items():
        np.testing.assert_allclose(frame, expected[name], rtol=0, atol=1e-12)


@given(presets, st.floats(-0.5, 0.5), betas, st.floats(-1, 1), st.floats(-1, 1))
def test_steering_agrees_with_the_reference(arm, rho, beta, speed, yaw_rate):
    limit = arm.dimensions["steering_limit"][1]
    expected = plain(arm).steer(speed, yaw_rate, rho, beta)
    assume(np.abs(expected.psi).max() < limit - 1e-6)  # the reference knows no limits, nor ties at 90 degrees
    assume(np.abs(expected.wheel_speeds).min() > 1e-3 or speed == yaw_rate == 0.0)  # nor pivots at rest
    command = arm.steer(speed, yaw_rate, chain(rho, beta))
    # Pivots move at 0.065 mm/s or more: rounding of 1e-16 m/s turns them by 2e-12 at most.
    np.testing.assert_allclose(command.steering, expected.psi, rtol=0, atol=1e-11)
    np.testing.assert_allclose(command.wheel_speeds, expected.wheel_speeds, rtol=0, atol=1e-12)
    np.testing.assert_allclose(command.scrub, expected.scrub, rtol=0, atol=1e-12)
    assert arm.icr_offset(chain(rho, beta)) == pytest.approx(plain(arm).icr_offset(rho, beta), abs=1e-13)


# Exact cases


def test_rocky_7_at_rest():
    frames = ROCKY.frames((0.0, 0.0, 0.0))
    places = {
        "A1": (0.40875, 0.2, -0.02),
        "A3": (0.068996, 0.2, -0.019969),
        "A5": (-0.069004, 0.2, -0.019969),
    }
    for left, (x, y, z) in places.items():
        right = "A" + MIRRORED[left[1]]
        np.testing.assert_allclose(frames[left][:3, 3], (x, y, z), rtol=0, atol=5e-7)  # six digits
        np.testing.assert_allclose(frames[right][:3, 3], (x, -y, z), rtol=0, atol=5e-7)
    for wheel in WHEELS:
        np.testing.assert_allclose(frames[wheel][:3, :3], np.eye(3), rtol=0, atol=1e-15)


def test_rocky_7_has_the_printed_table():
    nine, quarter = math.radians(139), math.pi / 2
    rows = [
        ("D", "R", None, 0, 0, 0.105, 0.12075, -quarter),
        ("B1", "D", "rho", 1, nine, 0.2, 0.16, 0),
        ("B2", "D", "rho", -1, nine, -0.2, 0.16, 0),
        ("S1", "D", "rho", 1, 0, 0.2, 0.288, quarter),
        ("S2", "D", "rho", -1, 0, -0.2, 0.288, quarter),
        ("S3", "B1", "beta_1", 1, -nine, 0, 0.069, quarter),
        ("S4", "B2", "beta_2", 1, -nine, 0, 0.069, quarter),
        ("S5", "B1", "beta_1", 1, -nine, 0, -0.069, quarter),
        ("S6", "B2", "beta_2", 1, -nine, 0, -0.069, quarter),
        ("A1", "S1", "psi_1", 1, 0, -0.125, 0, 0),
        ("A2", "S2", "psi_2", 1, 0, -0.125, 0, 0),
        *((f"A{i}", f"S{i}", None, 0, 0, -0.02, 0, 0) for i in (3, 4, 5, 6)),
    ]
    for link, (frame, parent, joint, *numbers) in zip(ROCKY.links, rows, strict=True):
        assert (link.frame, link.parent, link.joint) == (frame, parent, joint)
        got = (link.sign, link.gamma, link.d, link.a, link.alpha)
        np.testing.assert_allclose(got, numbers, rtol=0, atol=1e-15)
    assert ROCKY.dimensions["wheel_radius"] == 0.065
    assert ROCKY.dimensions["steering_limit"] == pytest.approx((-math.pi / 3, math.pi / 3))
    assert ROCKY.joint_names == ("rho", "beta_1", "beta_2", "psi_1", "psi_2")
    assert PRESETS["curiosity"].joint_names[3:] == ("psi_1", "psi_2", "psi_5", "psi_6")


def test_a_positive_rocker_angle_lowers_the_left_front():
    up, down = ROCKY.frames((0.0, 0, 0)), ROCKY.frames((0.1, 0, 0))
    assert down["A1"][2, 3] < up["A1"][2, 3]
    assert down["A2"][2, 3] > up["A2"][2, 3]
    assert ROCKY.frames((0, 0.1, 0))["A3"][2, 3] < up["A3"][2, 3]
    assert ROCKY.frames((0, 0, 0.1))["A4"][2, 3] < up["A4"][2, 3]


@pytest.mark.parametrize(
    ("speed", "psi", "rim_speeds"),
    [
        (0.1, (0.472359, 0.328299), (0.089837, 0.126771, 0.08, 0.12)),
        (0.3, (0.144958, 0.127046), (0.282968, 0.322600, 0.28, 0.32)),
    ],
)
def test_rocky_7_turns(speed, psi, rim_speeds):
    # The cases put the bogie joint exactly over the origin; Rocky 7 has it 3.5 um behind.
    dimensions = ROCKY.dimensions
    dimensions["rocker_to_bogie"] = (-dimensions["rocker_pivot"][0], *dimensions["rocker_to_bogie"][1:])
    exact = sw.RockerBogie(**dimensions)
    assert exact.icr_offset((0, 0, 0)) == pytest.approx(0.0, abs=1e-16)
    assert ROCKY.icr_offset((0, 0, 0)) == pytest.approx(3.5e-6, abs=1e-7)
    v1, v2, left, right = rim_speeds
    for arm, tolerance in ((exact, 5.1e-7), (ROCKY, 5e-6)):
        command = arm.steer(speed, 0.1, (0.0, 0.0, 0.0))
        np.testing.assert_allclose(command.steering, psi, rtol=0, atol=tolerance)
        expected = (v1, v2, left, right, left, right)
        np.testing.assert_allclose(command.wheel_speeds * 0.065, expected, rtol=0, atol=tolerance)
        np.testing.assert_allclose(command.scrub, 0.1 * 0.069 * np.array([1, 1, -1, -1]), rtol=0, atol=1e-15)
        assert command.turning_radius == pytest.approx(speed / 0.1, abs=1e-15)


@pytest.mark.parametrize(("name", "radius"), [("perseverance", 0.26288), ("curiosity", 0.25)])
def test_flight_rovers_at_rest_are_their_flat_presets(name, radius):
    arm, flat = PRESETS[name], sw.Rover.preset(name)
    for wheel, expected in zip(arm.planar().wheels, flat.wheels, strict=True):
        assert (wheel.name, wheel.radius) == (expected.name, radius)
        assert wheel.steering_range == expected.steering_range
        assert (wheel.x, wheel.y) == pytest.approx((expected.x, expected.y), abs=1e-15)
    for wheel in WHEELS:  # on the ground
        assert arm.frames((0.0, 0.0, 0.0))[wheel][2, 3] == pytest.approx(radius, abs=1e-15)
    twist = (0.04, 0.0, 0.02)
    command = arm.steer(0.04, 0.02, (0.0, 0.0, 0.0))
    for got, expected in zip((command.steering, command.wheel_speeds), flat.inverse(twist), strict=True):
        np.testing.assert_allclose(got, expected, rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(command.scrub, 0.0, atol=ROUNDING)


def test_rocky_7_at_rest_is_its_flat_preset_moved():
    for wheel, flat in zip(ROCKY.planar().wheels, sw.Rover.preset("rocky7").wheels, strict=True):
        moved = (wheel.x + ROCKY.icr_offset((0, 0, 0)), wheel.y)
        assert moved == pytest.approx((flat.x, flat.y), abs=1e-15)
        assert (wheel.name, wheel.radius, wheel.steering_range) == (
            flat.name,
            flat.radius,
            flat.steering_range,
        )


# Values


@given(suspensions())
def test_suspensions_are_values(arm):
    twin = sw.RockerBogie(**arm.dimensions)
    assert twin == arm
    assert hash(twin) == hash(arm)
    for same in (eval(repr(arm)), pickle.loads(pickle.dumps(arm)), copy.deepcopy(arm)):
        assert same == arm
    assert arm not in (ROCKY, "rover")
    with pytest.raises(AttributeError):
        arm.steered = "front"


# The boundary
