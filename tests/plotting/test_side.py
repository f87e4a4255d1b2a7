"""The rover from the side."""

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.plotting import side_figure

ROVERS = ("perseverance", "curiosity", "rocky7", "open_source_rover")


@pytest.mark.parametrize("name", ROVERS)
def test_wheels_are_drawn_where_they_stand(name):
    rover = sw.RockerBogie.preset(name)
    figure = side_figure(rover, title=name)
    axes = figure.axes[0]
    radius = rover.dimensions["wheel_radius"]
    wheels = [patch for patch in axes.patches if patch.radius == radius]
    assert len(wheels) == 6
    np.testing.assert_allclose([wheel.center[1] for wheel in wheels], radius, atol=1e-9)
    assert axes.get_title(loc="left") == name


def test_a_stand_on_ground_is_drawn_on_it():
    rover = sw.RockerBogie.preset("perseverance")
    x = np.arange(0, 10, 0.1)
    ground = sw.Terrain(0.3 * np.sin(x)[None] + 0.2 * np.cos(x)[:, None], 0.1)
    stand = rover.settle(ground, (5.0, 5.0, 0.7))
    contacts = [line for line in side_figure(rover, stand).axes[0].lines if line.get_marker() == "o"]
    heights = np.concatenate([line.get_ydata() for line in contacts])
    np.testing.assert_allclose(np.sort(heights), np.sort(stand.contacts[:, 2]))


def test_one_pose_at_which_the_rover_stands_is_needed():
    rover, ground = sw.RockerBogie.preset("perseverance"), sw.Terrain(np.zeros((9, 9)), 0.1)
    for pose in ((0, 0, 0), [(0, 0, 0)]):
        with pytest.raises(
            ValueError, match="stand must be one pose at which the rover stands, got SettledPose"
        ):
            side_figure(rover, rover.settle(ground, pose))
