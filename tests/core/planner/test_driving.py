"""Driving by the planner: narrow places, and nothing on the way that the rover could not do."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw

EXAMPLE = runpy.run_path(str(Path(__file__).parents[3] / "examples" / "05_planner.py"), run_name="worlds")
ROVER, LIMITS, DT, WORLDS = (EXAMPLE[name] for name in ("rover", "limits", "DT", "WORLDS"))


@pytest.fixture(scope="module", params=WORLDS)
def driven(request):
    return request.param, EXAMPLE["drive"](WORLDS[request.param])


def test_the_end_of_the_path_is_reached_without_touching_a_wall(driven):
    name, run = driven
    assert run.arrived
    costmap = WORLDS[name].costmap()
    low, values = np.array(costmap.origin), costmap.values
    c, s = np.cos(run.poses[:, 2:]), np.sin(run.poses[:, 2:])
    px, py = EXAMPLE["footprint"].T
    x, y = run.poses[:, :1] + c * px - s * py, run.poses[:, 1:2] + s * px + c * py
    columns, rows = np.rint((np.stack([x, y]) - low[:, None, None]) / costmap.spacing[0]).astype(int)
    # A cell of the map may be a wall whose rim is half a cell away.
    assert values[rows, columns].max() < 1.0


def test_nothing_slides_and_no_limit_is_passed(driven):
    _, run = driven
    asked = ROVER.rollout_cost(run.twists[None], DT, run.poses[0])
    # Single precision.
    assert asked.max_side_slip[0] < 1e-6
    assert asked.max_wheel_speed[0] <= LIMITS.wheel_speed * (1 + 1e-6)
    assert np.abs(np.diff(run.steering, axis=0)).max() <= LIMITS.steering_rate * DT * (1 + 1e-5)
    assert np.abs(run.steering).max() <= 1.3 + 1e-6
    assert np.abs(np.diff(run.twists[:, 0])).max() <= 1.5 * LIMITS.acceleration * DT


def test_the_gate_needs_a_turn_on_the_spot(driven):
    name, run = driven
    turns = np.abs(run.twists[:, 0]) < ROVER.spin_radius * np.abs(run.twists[:, 2])
    angle = np.abs(run.twists[turns, 2]).sum() * DT
    if name == "gate":
        assert angle > np.radians(60)
    if name == "dead end":
        assert (run.twists[:, 0] < -0.05).any()


def test_the_same_seed_drives_the_same_way():
    one, other = (EXAMPLE["drive"](WORLDS["slalom"], seed=3, cycles=10) for _ in range(2))
    np.testing.assert_array_equal(one.poses, other.poses)
    assert isinstance(WORLDS["slalom"].costmap(), sw.Costmap)


def test_a_drive_is_a_picture(driven):
    plot = pytest.importorskip("six_wheel.plotting")
    name, run = driven
    world = WORLDS[name]
    figure = plot.plan_figure(ROVER, world.costmap(), run.poses, run.steering, path=world.path, title=name)
    assert len(figure.axes[0].images) == 2
