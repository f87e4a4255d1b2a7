"""Motion on the ground: the core against the plain model, laws, exact cases, and bad input."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.reference import ground as plain
from six_wheel.reference.ground.settle import Gap
from tests.core.ground.test_ground_reference import PERSEVERANCE, TURNED_ROUND, rough

CHAINS = {"behind": PERSEVERANCE, "in front": TURNED_ROUND}


def face(*stands: plain.SettledPose) -> Any:
    """Stands of the plain model with the face of settled ones; one, or a batch."""

    def of(stand: plain.SettledPose) -> dict[str, Any]:
        slopes = np.array([at.slope for at in stand.gaps])
        normals = np.column_stack([-slopes, np.ones(len(slopes))])
        transform = np.eye(4)
        transform[:3, :3] = plain.attitude(stand.roll, stand.pitch, float(stand.pose[2]))
        transform[:3, 3] = [*stand.pose[:2], stand.z]
        return {
            "roll": stand.roll,
            "pitch": stand.pitch,
            "transform": transform,
            "joints": stand.joints,
            "steering": stand.steering,
            "contact_angles": np.array([at.angle for at in stand.gaps]),
            "normals": normals / np.linalg.norm(normals, axis=1)[:, None],
            "gap": np.array([at.value for at in stand.gaps]),
        }

    rows = [of(stand) for stand in stands]
    one = rows[0] if len(rows) == 1 else {k: np.array([row[k] for row in rows]) for k in rows[0]}
    return SimpleNamespace(**one)


@pytest.fixture(scope="module", params=CHAINS)
def standing(request: pytest.FixtureRequest) -> tuple[sw.RockerBogie, plain.Chain, list[plain.SettledPose]]:
    """A rover, its plain model, and where it stands among bumps with turned wheels."""
    dimensions = CHAINS[request.param]
    arm, chain, land = sw.RockerBogie(**dimensions), plain.rocker_bogie(**dimensions), rough()
    rng, stands = np.random.default_rng(5), []
    while len(stands) < 6:
        pose = np.array([*rng.uniform(5, 35, 2), rng.uniform(-3, 3)])
        stand = plain.settle(land, chain, pose, rng.uniform(-0.4, 0.4, 4))
        if stand.status == "settled":
            stands.append(stand)
    return arm, chain, stands


@pytest.mark.slow
def test_inverse_is_the_plain_one(standing: tuple) -> None:
    """One by one and in a batch, both meanings of a command, and angles that are given."""
    arm, chain, stands = standing
    commands = np.random.default_rng(1).uniform(-0.3, 0.3, (len(stands), 2))
    commands[0] = 0.2, 0.0
    for view in ("body", "plan"):
        together = arm.inverse(face(*stands), commands, view=view)
        for k, (stand, command) in enumerate(zip(stands, commands, strict=True)):
            told = plain.inverse(chain, stand, *command, plan=view == "plan")
            steering, speeds = arm.inverse(face(stand), command, view=view)
            np.testing.assert_array_equal(speeds, together.wheel_speeds[k])
            # The plain model steers until 1e-15 is missing, and finds angles within half a turn of 0.
            np.testing.assert_allclose(np.cos(2 * (steering - told.steering)), 1, atol=1e-12)
            np.testing.assert_allclose(np.abs(together.twist[k] - told.twist), 0, atol=1e-12)
            np.testing.assert_allclose(together.joint_rates[k], told.joint_rates, atol=1e-12)
            same = np.abs(steering - told.steering).max() < 1
            if same:
                np.testing.assert_allclose(speeds, told.wheel_speeds, atol=1e-11)
            kept = arm.inverse(face(stand), command, view=view, steering=stand.steering)
            held = plain.inverse(chain, stand, *command, plan=view == "plan", steering=stand.steering)
            np.testing.assert_allclose(kept.wheel_speeds, held.wheel_speeds, atol=1e-11)


def test_forward_is_the_plain_one(standing: tuple) -> None:
    """Whatever was measured, and with weights."""
    arm, chain, stands = standing
    rng = np.random.default_rng(2)
    for stand in stands:
        speeds, swivel = rng.uniform(-1, 1, 6), rng.uniform(-0.1, 0.1, 4)
        turning, rates = rng.uniform(-0.1, 0.1, 3), rng.uniform(-0.1, 0.1, 3)
        for more in (
            {},
            {"angular_velocity": turning},
            {"joint_rates": rates},
            {"angular_velocity": turning, "joint_rates": rates},
            {"steering_rates": swivel, "weights": rng.uniform(0.1, 2, 6)},
            {"angular_velocity": turning, "weights": rng.uniform(0.1, 2, (6, 2))},
        ):
            told = plain.forward(chain, stand, speeds, **more)
            found = arm.forward(face(stand), None, speeds, **more)
            # Rates of up to 1 rad/s through systems with condition numbers of some tens.
            np.testing.assert_allclose(found.twist, told.twist, atol=1e-11)
            np.testing.assert_allclose(found.joint_rates, told.joint_rates, atol=1e-11)
            np.testing.assert_allclose(found.residuals, told.residuals, atol=1e-11)


def test_wheels_that_need_not_hold_sideways_tell_the_motion(standing: tuple) -> None:
    """Inverse, then forward with tilt and joints measured and side slip allowed, is the identity."""
    arm, _, stands = standing
    for stand in stands:
        at = face(stand)
        told = arm.inverse(at, (0.2, 0.05), steering=stand.steering)
        back = arm.forward(
            at,
            None,
            told.wheel_speeds,
            told.joint_rates,
            told.twist[3:],
            weights=np.tile([1.0, 0.0], (6, 1)),
        )
        # Given angles ask where the plane touches: on creases the plain model mixes slopes 1e-9 rad apart.
        np.testing.assert_allclose(back.twist, told.twist, atol=1e-9)
        np.testing.assert_allclose(back.residuals[:, :2], 0, atol=1e-9)
        slip = arm.slip(at, told.wheel_speeds, told.twist, told.joint_rates)
        np.testing.assert_allclose(slip.ratio, 0, atol=1e-8)
        aside = back.residuals[:, 2]
        assert (np.sign(slip.angle) == np.sign(aside) * np.sign(told.twist[0])).all()


def test_steered_wheels_roll_whatever_they_stand_on() -> None:
    """Random ground at every wheel, turning as fast as driving: steered wheels do not move to the left."""
    rng = np.random.default_rng(14)
    for dimensions in CHAINS.values():
        arm = sw.RockerBogie(**dict(dimensions) | {"steering_limit": math.pi})
        chain = plain.rocker_bogie(**dimensions)
        steered = [k for k, wheel in enumerate(arm.planar().wheels) if wheel.steered]
        for _ in range(100):
            stand = plain.SettledPose(
                "settled",
                rng.uniform(-3, 3, 3),
                0.0,
                *rng.uniform(-0.3, 0.3, 2),
                joints=rng.uniform(-0.3, 0.3, 3),
                steering=rng.uniform(-0.5, 0.5, len(steered)),
                gaps=tuple(
                    Gap(0.0, rng.uniform(-0.3, 0.3), None, rng.uniform(-0.7, 0.7, 2)) for _ in range(6)
                ),
            )
            told = arm.inverse(face(stand), (rng.uniform(-0.2, 0.2), rng.uniform(-1, 1)))
            contacts = plain.touch(chain, stand, told.steering)
            aside = contacts.left @ [*told.twist, *told.joint_rates]
            np.testing.assert_allclose(aside[steered], 0, rtol=0, atol=1e-13)


def test_traction_is_the_plain_one() -> None:
    """Random rates and joints, one by one and together."""
    rng, count = np.random.default_rng(3), 50
    for dimensions in CHAINS.values():
        arm, chain = sw.RockerBogie(**dimensions), plain.rocker_bogie(**dimensions)
        speed, curvature = rng.uniform(-0.1, 0.1, count), rng.uniform(-0.3, 0.3, count)
        turning = rng.uniform(-0.05, 0.05, (count, 3))
        turning[:, 2] = speed * curvature
        joints, rates = rng.uniform(-0.3, 0.3, (count, 3)), rng.uniform(-0.05, 0.05, (count, 3))
        found = arm.traction(speed, curvature, turning, joints, rates)
        for k in range(count):
            told = plain.traction(chain, speed[k], curvature[k], turning[k], joints[k], rates[k])
            np.testing.assert_allclose(found.wheel_speeds[k], told.wheel_speeds, atol=1e-12)
            np.testing.assert_allclose(found.steering[k], told.steering, atol=1e-12)
            np.testing.assert_allclose(found.contact_angles[k], told.contact_angles, atol=1e-10)
            np.testing.assert_allclose(found.vertical_speed[k], told.vertical, atol=1e-14)


@pytest.mark.parametrize("name", ["perseverance", "curiosity"])
def test_at_rest_traction_is_the_planar_inverse(name: str) -> None:
    """Rovers that stand level: to rounding."""
    arm = sw.RockerBogie.preset(name)
    for speed, curvature in ((0.1, 0.0), (0.1, 0.5), (-0.04, -0.2), (0.0, 1.0)):
        planar = arm.steer(speed, speed * curvature, (0, 0, 0))
        told = arm.traction(speed, curvature, (0, 0, speed * curvature), (0, 0, 0), (0, 0, 0))
        np.testing.assert_allclose(told.wheel_speeds, planar.wheel_speeds, atol=1e-12)
        np.testing.assert_allclose(told.steering, planar.steering, atol=1e-12)
        assert not told.lifted.any()
    planar = arm.steer(0, 0.2, (0, 0, 0))  # on the spot
    told = arm.traction(0, None, (0, 0, 0), (0, 0, 0), (0, 0, 0), yaw_rate=0.2)
    np.testing.assert_allclose(told.wheel_speeds, planar.wheel_speeds, atol=1e-12)
    np.testing.assert_allclose(told.steering, planar.steering, atol=1e-12)


def test_traction_finds_the_motion_of_a_rover_on_the_ground(standing: tuple) -> None:
    """Given the true vertical speed by the wheels' own rates, contact angles and speeds are the true ones."""
    arm, _, stands = standing
    for stand in stands:
        true = arm.inverse(face(stand), (0.2, 0.0), steering=np.zeros(4))
        told = arm.traction(
            0.2, 0.0, true.twist[3:], stand.joints, true.joint_rates, wheel_speeds=true.wheel_speeds
        )
        blind = arm.traction(0.2, 0.0, true.twist[3:], stand.joints, true.joint_rates)
        # Centres also move sideways there, which steers nothing: 1e-2 of the speed on this ground.
        missing = [np.abs(at.vertical_speed - true.twist[2]) for at in (told, blind)]
        assert missing[0] < 0.02
        assert missing[1] < 0.1


def test_a_wheelie_is_flagged() -> None:
    """The left bogie turns up its middle wheel faster than the rover drives."""
    arm = sw.RockerBogie.preset("perseverance")
    told = arm.traction(0.04, 0.0, (0, 0, 0), (0, 0, 0), (0, -0.3, 0))
    assert told.lifted[2]
    assert not told.lifted[[0, 1, 3, 5]].any()
    assert not arm.traction(0.04, 0.0, (0, 0, 0), (0, 0, 0), (0, -0.03, 0)).lifted.any()


def test_one_common_scale_keeps_wheels_below_their_limit(standing: tuple) -> None:
    """Curvature stays, speed goes."""
    arm, _, stands = standing
    free = arm.inverse(face(stands[0]), (1.0, 0.3))
    bound = arm.inverse(face(stands[0]), (1.0, 0.3), max_wheel_speed=2.0)
    assert np.abs(bound.wheel_speeds).max() == pytest.approx(2.0, abs=1e-12)
    np.testing.assert_allclose(bound.wheel_speeds, bound.scale * free.wheel_speeds, atol=1e-12)
    np.testing.assert_array_equal(bound.steering, free.steering)
    assert bound.scale < 1 == free.scale


def test_body_slip_is_found_at_its_rate() -> None:
    """False alarms come as often as allowed; slip of ten standard deviations is always found."""
    rng = np.random.default_rng(8)
    root = rng.standard_normal((3, 3)) * 0.01
    covariance = root @ root.T
    alarms = [
        sw.body_slip(root @ rng.standard_normal(3), np.zeros(3), covariance, false_alarm=0.05).slipping
        for _ in range(2000)
    ]
    assert abs(np.mean(alarms) - 0.05) < 4 * math.sqrt(0.05 * 0.95 / 2000)  # four standard deviations
    slip = sw.body_slip(10 * root @ np.array([1.0, 0, 0]), np.zeros(3), covariance)
    assert slip.slipping
    assert slip.statistic == pytest.approx(100)
    np.testing.assert_allclose(slip.compensate((0.1, 0, 0)), np.array([0.1, 0, 0]) - slip.slip)
    calm = sw.body_slip((1e-4, 0, 0), np.zeros(3), np.eye(3))
    np.testing.assert_array_equal(calm.compensate((0.1, 0, 0)), (0.1, 0, 0))


def test_what_does_not_settle_is_not_a_number(standing: tuple) -> None:
    """Rows of a batch that stand nowhere do not stop the others."""
    arm, _, stands = standing
    at = face(*stands)
    for name in ("roll", "pitch", "joints", "contact_angles", "normals", "gap"):
        values = np.array(getattr(at, name))
        values[2] = math.nan
        setattr(at, name, values)
    told = arm.inverse(at, (0.1, 0.0))
    assert np.isnan(told.wheel_speeds[2]).all()
    assert np.isfinite(np.delete(told.wheel_speeds, 2, axis=0)).all()
    moved = arm.forward(at, None, told.wheel_speeds)
    assert np.isnan(moved.twist[2]).all()
    assert np.isfinite(np.delete(moved.twist, 2, axis=0)).all()


def test_a_twist_is_a_command_as_its_speed_and_yaw_rate_are():
    ground = sw.Terrain(np.random.default_rng(4).uniform(0.0, 0.2, (30, 30)), 0.5)
    arm = sw.RockerBogie.preset("perseverance")
    stands = arm.settle(ground, [(6.0, 7.0, 0.3), (7.0, 7.0, 1.0), (8.0, 6.0, 2.0)])
    pairs = np.array([(0.1, 0.02), (0.0, 0.1), (-0.1, 0.05)])
    known = arm.inverse(stands, pairs)
    twists = np.insert(pairs, 1, 0.0, axis=1)
    # The twist of a result is a command, too: forward, to the left of the body, about its z axis.
    for same in (twists, known.twist[:, [0, 1, 5]]):
        found = arm.inverse(stands, same)
        for one, other in zip(found, known, strict=True):
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-14)
    assert arm.inverse(stands, twists).scale.tolist() == known.scale.tolist()
    with pytest.raises(ValueError, match=r"command\[0\] must be a twist \(vx, 0, omega\), .* vy = 0.05"):
        arm.inverse(stands, (0.1, 0.05, 0.0))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda arm, at: arm.inverse(at, (math.nan, 0)), "command must be finite, got (nan, 0.0)"),
        (
            lambda arm, at: arm.inverse(at, (1, 2, 3, 4)),
            "command must have shape (..., 2), speed and yaw rate, or (..., 3), a twist, got shape (4,)",
        ),
        (
            lambda arm, at: arm.inverse(at, (1, 2, 3)),
            "command must be a twist (vx, 0, omega), as the steered wheels follow the unsteered ones, "
            "or (speed, yaw rate), got vy = 2.0 m/s",
        ),
        (lambda arm, at: arm.inverse(at, (1, 0), view="top"), "view must be 'body' or 'plan', got \"top\""),
        (
            lambda arm, at: arm.inverse(at, (1, 0), max_wheel_speed=0),
            "max_wheel_speed must be positive, got 0",
        ),
        (
            lambda arm, at: arm.forward(at, None, [1.0] * 5),
            "wheel_speeds must have shape (..., 6), got shape (5,)",
        ),
        (
            lambda arm, at: arm.forward(at, None, [1.0] * 6, weights=[-1.0] * 6),
            "weights must be finite and not negative, got -1",
        ),
        (
            lambda arm, at: arm.forward(at, None, [1.0] * 6, joint_rates=[math.inf, 0, 0]),
            "joint_rates must be finite, or NaN where not measured, got inf",
        ),
        (
            lambda arm, at: arm.traction(0.1, None, (0, 0, 0), (0, 0, 0), (0, 0, 0)),
            "curvature must be given, or yaw_rate, got neither",
        ),
        (
            lambda arm, at: arm.traction(0.1, 0, (0, 0, math.nan), (0, 0, 0), (0, 0, 0)),
            "angular_velocity must be finite, got (0.0, 0.0, nan)",
        ),
        (
            lambda arm, at: sw.body_slip((1, 0), (0, 0), [[1, 2], [2, 1]]),
            "covariance must be symmetric and positive definite, got one that is not",
        ),
        (
            lambda arm, at: sw.body_slip((1, 0), (0, 0), np.eye(2), false_alarm=1.5),
            "false_alarm must be between 0 and 1, got 1.5",
        ),
    ],
)
def test_bad_input_is_named(standing: tuple, call: Any, message: str) -> None:
    """The argument, the rule and the value."""
    arm, _, stands = standing
    with pytest.raises(ValueError, match="must") as caught:
        call(arm, face(stands[0]))
    assert str(caught.value) == message


def test_a_wheel_that_would_steer_past_its_limit_is_named(standing: tuple) -> None:
    """A turn about a point under the rover needs more than 0.2 rad."""
    _, _, stands = standing
    short = sw.RockerBogie(**PERSEVERANCE, steering_limit=0.2)
    with pytest.raises(sw.InfeasibleMotionError, match="let front_left steer within"):
        short.inverse(face(stands[0]), (0.1, 0.1))
