"""Settling with margins and at the stops of joints, off the map, with arguments of any form."""

import math
import pickle

import numpy as np
import pytest

import six_wheel as sw
from tests.core.ground.settling import CLOSED, ground_for, poses_for

from .grounds import ROVERS, balance, dense_gaps, hills, holes, numbers_of, rocks

# Margins in any direction, and their computation from the stand.
MARGINS = ("tip_over_angle", "clearance", "joint_margins", "tilt")


def margins_of(rover, ground, poses, belly, centre, **how):
    stand = rover.settle(ground, poses, **how)
    return rover.stability(stand, mass=1.0, belly=belly, centre_of_mass=centre)


@pytest.mark.parametrize("shape", [hills, rocks])
@pytest.mark.parametrize("name", ["perseverance", "open_source_rover"])
def test_derivatives_of_margins_are_differences(name, shape):
    rover = limited(ROVERS[name], (-0.5, 0.6), (-0.9, 0.8))
    ground, *_ = ground_for(rover, shape)
    size = rover.dimensions["wheel_radius"] / 0.26288
    belly, centre = tuple(size * v for v in (-0.7, 0.7, 0.6, 0.55)), (0.05 * size, 0.02 * size, 0.6 * size)
    poses = poses_for(rover, 60)
    told = margins_of(rover, ground, poses, belly, centre, derivatives=True)
    step = 1e-5 * size

    def compare(ahead, behind, slopes, column):
        for margin in MARGINS:
            sides = (np.asarray(getattr(side, margin)) for side in (ahead, behind))
            difference = np.subtract(*sides) / (2 * step)
            found = getattr(slopes, margin)[..., column]
            scale = np.maximum(np.abs(found), 1)
            error = (np.abs(difference - found) / scale).reshape(len(poses), -1).max(-1)
            # Gaps closed to 2e-12 m; where a contact moves over a crease within the step derivatives jump.
            assert np.median(error) < 1e-6, (margin, column)
            assert np.mean(error < 1e-5) > 0.8, (margin, column)

    for k in range(3):
        shift = step * np.eye(3)[k]
        sides = (margins_of(rover, ground, poses + s * shift, belly, centre) for s in (1, -1))
        compare(*sides, told.by_pose, k)
    column = 0
    for argument, value in list(rover.dimensions.items())[:6]:
        for k in range(np.size(value)):
            sides = []
            for sign in (1, -1):
                changed = np.atleast_1d(value).astype(float)
                changed[k] += sign * step
                changed = float(changed[0]) if argument == "wheel_radius" else tuple(changed)
                other = sw.RockerBogie(**rover.dimensions | {argument: changed})
                sides.append(margins_of(other, ground, poses, belly, centre))
            compare(*sides, told.by_dimension, column)
            column += 1
    assert told.by_dimension.clearance.shape == (60, column)
    assert margins_of(rover, ground, poses, belly, centre).by_pose is None
    assert repr(told.by_pose).startswith("MarginJacobian(tip_over_angle=<60 x ")


# Stops


def limited(rover, rocker, bogie):
    return sw.RockerBogie(**rover.dimensions | {"rocker_limit": rocker, "bogie_limit": bogie})


@pytest.mark.parametrize("name", ["perseverance", "open_source_rover"])
def test_at_a_stop_a_wheel_hangs_that_the_joint_would_lower(name):
    free = ROVERS[name]
    rover = limited(free, (-0.08, 0.1), (-0.15, 0.12))
    ground, heights, spacing = ground_for(rover)
    poses = poses_for(rover, 300)
    stand, without = rover.settle(ground, poses), free.settle(ground, poses)
    inside = (np.abs(without.joints - [-0.0 + 0.01, -0.015, -0.015]) <= [0.09, 0.135, 0.135]).all(-1)
    # A rover that is inside its stops does not notice them.
    np.testing.assert_array_equal(numbers_of(stand)[inside], numbers_of(without)[inside])
    stopped = stand.status == "at_stop"
    lost = stand.status == "not_converged"
    np.testing.assert_array_equal(stopped | inside | lost, True)
    assert lost.mean() < 0.01  # three joints at once at stops this narrow
    assert stopped.sum() > 30
    assert (stand.joints[~lost] >= np.array([-0.08, -0.15, -0.15]) - 1e-11).all()
    assert (stand.joints[~lost] <= np.array([0.1, 0.12, 0.12]) + 1e-11).all()
    hanging = stand.gap > 1e-9
    assert stand.gap[~lost].min() > -1e-9
    np.testing.assert_array_equal((stand.stops != 0).sum(-1)[stopped] >= hanging.sum(-1)[stopped], True)
    for k in np.nonzero(stopped)[0][:12]:
        gaps = dense_gaps(rover, heights, spacing, poses[k], numbers_of(stand)[k])
        np.testing.assert_allclose(gaps, stand.gap[k], atol=CLOSED)
    bogies = (2, 4) if name == "perseverance" else (0, 2)  # left wheels, front first
    only_left = stopped & (stand.stops[:, 0] == 0) & (stand.stops[:, 2] == 0)
    for k in np.nonzero(only_left)[0]:
        # Upper stop: the wheel ahead of the joint; lower: the one behind.
        wheel = bogies[0] if stand.stops[k, 1] > 0 else bogies[1]
        assert set(np.nonzero(hanging[k])[0]) <= {wheel}


@pytest.mark.parametrize("name", ["perseverance", "rocky7", "open_source_rover"])
@pytest.mark.parametrize("limits", [(0.3, 0.5), (0.05, None)])
@pytest.mark.parametrize("make", [rocks, holes])
def test_no_stop_pulls_its_joint(name, limits, make):
    rover = limited(ROVERS[name], *limits)
    ground, *_ = ground_for(rover, make)
    poses, centre = poses_for(rover, 150), (0.05, 0.02, rover.dimensions["rocker_pivot"][2])
    stand = rover.settle(ground, poses, centre_of_mass=centre)
    stopped = np.nonzero(stand.status == "at_stop")[0]
    assert len(stopped) > 3
    for k in stopped:
        _, moments = balance(rover, stand, k, poses[k], centre)
        assert moments.min() > -1e-7  # of the weight [m]: rounding of differences


def test_at_the_stop_of_the_rockers_the_centre_of_mass_decides():
    rover = limited(ROVERS["perseverance"], (-0.02, 0.02), 0.5)
    # A hole under the left front wheel: the left rocker wants its nose down.
    heights = np.zeros((101, 101))
    heights[55:75, 55:] = -0.15
    ground = sw.Terrain(heights, 0.1, (-5.0, -5.0))
    pose = (0.0, 0.0, 0.0)
    ahead = rover.settle(ground, pose, centre_of_mass=(0.6, 0.3, 0.6))
    behind = rover.settle(ground, pose, centre_of_mass=(-0.3, -0.2, 0.6))
    assert ahead.status == behind.status == "at_stop"
    assert ahead.joints[0] == behind.joints[0] == 0.02
    # With the weight ahead and to the left the left front wheel goes down and the right bogie comes up.
    assert ahead.gap[0] < 1e-9
    assert max(ahead.gap[3], ahead.gap[5]) > 0.01
    assert behind.gap[0] > 0.01
    assert ahead.roll < behind.roll
    assert rover.settle(ground, pose).gap[0] > 0.01


# Reasons


def test_every_pose_has_its_status():
    rover = ROVERS["perseverance"]
    heights = np.zeros((121, 121))
    heights[60, 60] = np.nan
    ground = sw.Terrain(heights, 0.1)
    poses = [(3, 3, 0), (3, 3, 1e9), (0.5, 5, 0), (30, 30, 0), (2.5, 2.5, 0.3)]
    stand = rover.settle(ground, poses)
    names = ["settled", "settled", "off_map", "off_map", "settled"]
    assert [str(status) for status in stand.status] == names
    assert str(stand.status) == f"[{' '.join(names)}]"
    # As many as are settled in lanes.
    assert [str(status) for status in rover.settle(ground, 2 * poses).status] == 2 * names
    # A front wheel over the hole in the map; then the hole between the wheels.
    under_front = rover.settle(ground, (6.0 + 1.185, 6.0 - 1.0625, math.pi))
    assert under_front.status == "unknown_cells"
    assert rover.settle(ground, (6.0, 6.0, 1.0)).status == "settled"
    assert math.isnan(under_front.z)
    assert np.isnan(under_front.gap).all()
    assert np.isnan(under_front.transform).all()
    assert not under_front.stands
    assert stand.stands.tolist() == [True, True, False, False, True]


@pytest.mark.parametrize("name", ROVERS)
def test_a_batch_has_the_statuses_of_its_poses_one_by_one(name):
    """Batches once settled poses of which the upper half of a rim lay over unknown cells or off the map."""
    random = np.random.default_rng(12)
    heights = np.array(sw.Terrain.yard((9.0, 9.0), spacing=0.1, cover=0.05, seed=3).heights)
    heights[random.integers(0, 90, 25), random.integers(0, 90, 25)] = np.nan
    ground, rover = sw.Terrain(heights, 0.1), ROVERS[name]
    poses = random.uniform((-0.5, -0.5, -4.0), (9.5, 9.5, 4.0), (2500, 3))
    together = rover.settle(ground, poses).status
    alone = [rover.settle(ground, pose).status for pose in poses]
    assert {str(status) for status in alone} >= {"settled", "off_map", "unknown_cells"}
    assert [str(status) for status in together] == [str(status) for status in alone]


@pytest.mark.parametrize(
    ("heights", "status"),
    [
        (np.full((50, 50), np.nan), "unknown_cells"),
        (np.zeros((5, 5)), "off_map"),  # the rover is larger than the map
        (np.zeros((2, 400)), "off_map"),
    ],
)
def test_where_nothing_can_stand_nothing_does(heights, status):
    ground = sw.Terrain(heights, 0.1)
    middle = np.array(heights.shape[::-1]) * 0.05
    stand = ROVERS["perseverance"].settle(ground, [(*middle, yaw) for yaw in (0, 0.7, 2.0)])
    assert (stand.status == status).all()
    assert np.isnan(numbers_of(stand)).all()
    many = ROVERS["perseverance"].settle(ground, [(*middle, yaw) for yaw in range(20)])
    assert (many.status == status).all()


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.2, 0.6, 3.0, 30.0])
def test_walls_and_holes_have_an_answer_or_a_reason(step):
    rover = limited(ROVERS["perseverance"], 0.4, 0.5)
    heights = np.zeros((121, 121))
    heights[:, 60:] = step
    heights[30:40, 20:30] = -step
    ground = sw.Terrain(heights, 0.1)
    poses = np.stack(np.meshgrid(np.linspace(3, 9, 7), np.linspace(3, 9, 5), [0, 0.4, 1.6, 3.0]), -1)
    stand = rover.settle(ground, poses.reshape(-1, 3))
    assert not (stand.status == "off_map").any()
    standing = stand.stands
    assert stand.gap[standing].min() > -1e-9
    for k in np.nonzero(standing)[0][::10]:
        gaps = dense_gaps(rover, heights, 0.1, poses.reshape(-1, 3)[k], numbers_of(stand)[k])
        np.testing.assert_allclose(gaps, stand.gap[k], atol=1e-8)  # on a wall gaps have steep slopes


# The boundary


def test_any_numbers_will_do():
    rover = ROVERS["perseverance"]
    ground, heights, spacing = ground_for(rover)
    expected = numbers_of(rover.settle(ground, (6.0, 7.0, 1.0)))
    for pose in ([6, 7, 1], np.array([6, 7, 1], np.float32), np.array([1, 7, 6], ">f8")[::-1]):
        np.testing.assert_array_equal(numbers_of(rover.settle(ground, pose)), expected)
    single = heights.astype(np.float32)
    same = rover.settle(sw.Terrain(single.astype(float), spacing), (6.0, 7.0, 1.0))
    np.testing.assert_array_equal(
        numbers_of(rover.settle(sw.Terrain(single, spacing), (6.0, 7.0, 1.0))), numbers_of(same)
    )


def test_one_pose_is_what_the_general_way_says():
    for rover in ROVERS.values():
        ground, *_ = ground_for(rover)
        for pose in (*map(tuple, poses_for(rover, 20, seed=4).tolist()), (-9.0, 0.0, 0.0), (0.2, 0.2, 0.0)):
            quick, general = rover.settle(ground, pose), rover.settle(ground, pose, threads=1)
            for name in ("status", "reason", "z", "joints", "gap", "contacts", "next_contacts", "steering"):
                np.testing.assert_array_equal(getattr(quick, name), getattr(general, name), err_msg=name)
            assert quick.suspension is rover
            assert quick.by_pose is None


def test_shapes_follow_the_poses():
    rover = ROVERS["perseverance"]
    ground, *_ = ground_for(rover)
    stand = rover.settle(ground, np.zeros((2, 0, 3)), derivatives=True)
    shapes = {
        "z": (),
        "joints": (3,),
        "gap": (6,),
        "contacts": (6, 3),
        "normals": (6, 3),
        "transform": (4, 4),
    }
    shapes |= {"by_pose": (6, 3), "by_dimension": (6, 16), "contact_angles": (6,), "status": ()}
    for name, last in shapes.items():
        assert getattr(stand, name).shape == (2, 0, *last)
    one = rover.settle(ground, (6.0, 7.0, 1.0))
    assert isinstance(one.z, float)
    assert repr(one).startswith("SettledPose(status=settled, z=")
    assert repr(rover.settle(ground, [(6.0, 7.0, 1.0), (-9, 0, 0)])) == "SettledPose(<1 settled, 1 off_map>)"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (((0, 0),), r"poses must have shape \(\.\.\., 3\), got shape \(2,\)"),
        (((0, 0, math.nan),), r"poses must be finite, got \(0\.0, 0\.0, nan\)"),
        (([(0, 0, 0), (math.inf, 0, 0)],), r"poses\[1\] must be finite, got \(inf, 0\.0, 0\.0\)"),
        (((0, 0, 0), (0.1, 0.2)), r"steering must have shape \(\.\.\., 4\), got shape \(2,\)"),
        (((0, 0, 0), (0.1, 0.2, math.nan, 0)), r"steering must be finite"),
        (([(0, 0, 0)] * 2, [(0, 0, 0, 0)] * 3), r"steering must have shape \(2, 4\), got shape \(3, 4\)"),
        (("here",), r"poses must be real numbers"),
    ],
)
def test_wrong_arguments_are_named(arguments, message):
    ground, *_ = ground_for(ROVERS["perseverance"])
    with pytest.raises(ValueError, match=message):
        ROVERS["perseverance"].settle(ground, *arguments)


def test_statuses_are_names():
    assert [str(status) for status in sw.SettleStatus] == [
        "settled",
        "at_stop",
        "off_map",
        "unknown_cells",
        "not_converged",
    ]
    assert pickle.loads(pickle.dumps(sw.SettleStatus.at_stop)) is sw.SettleStatus.at_stop
