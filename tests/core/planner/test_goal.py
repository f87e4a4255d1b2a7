"""The yaw of a goal, and the reason for which a rover stays."""

import math

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.reference.control import planner as plain

ROVER = sw.Rover.preset("perseverance")
LIMITS = sw.Limits(speed=0.5, yaw_rate=0.5, steering_rate=2.0)


def drive(planner, goal, cycles=160):
    pose, twist = sw.Pose(), (0.0, 0.0, 0.0)
    for _ in range(cycles):
        plan = planner.step(pose, twist=twist, goal=goal)
        twist = plan.twist
        pose = pose @ sw.exp(twist, planner.dt)
        if plan.reason:
            break
    return pose, plan


@pytest.mark.parametrize("yaw", [1.2, -0.8])
def test_a_rover_comes_to_its_goal_with_its_yaw(yaw):
    pose, _ = drive(sw.Mppi(ROVER, LIMITS, samples=300, seed=1), (1.0, 0.0, yaw))
    assert math.hypot(pose.x - 1.0, pose.y) < 0.3
    assert abs(math.remainder(pose.yaw - yaw, 2 * math.pi)) < 0.3
    free, _ = drive(sw.Mppi(ROVER, LIMITS, samples=300, seed=1), (1.0, 0.0))
    assert abs(free.yaw) < 0.4


def test_costs_of_a_yaw_are_those_of_the_equation():
    planner = sw.Mppi(ROVER, LIMITS, samples=64, horizon=20)
    without = planner.step((0.0, 0.0, 0.3), goal=(1.0, 0.5), extra_cost=lambda poses, twists: np.zeros(64))
    costs = planner.costs.copy()
    planner.reset()
    ends = []

    def look(poses, twists):
        ends.append(poses[:, -1])
        return np.zeros(64)

    planner.step((0.0, 0.0, 0.3), goal=(1.0, 0.5, 2.0), extra_cost=look)
    x, y, yaw = ends[0].T
    added = plain.goal_yaw_cost(ends[0], (1.0, 0.5, 2.0), planner.cost_weights)
    np.testing.assert_allclose(
        added, 10 * (1 - np.cos(yaw - 2.0)) / (1 + np.hypot(x - 1.0, y - 0.5)), rtol=1e-14
    )
    np.testing.assert_allclose(planner.costs - costs, added, atol=1e-9)  # differences of costs of about 20
    assert without.reason == ""


def test_the_plan_says_why_the_rover_stays():
    planner = sw.Mppi(ROVER, LIMITS, samples=64)
    assert planner.step((0.0, 0.0, 0.0), goal=(0.001, 0.0)).reason == "the rover is at its goal"
    assert planner.step((0.0, 0.0, 0.0), goal=(0.001, 0.0, 1.0)).reason == ""
    walls = sw.Costmap(np.ones((20, 20)), 1.0, (-10.0, -10.0), lethal=0.9)
    blocked = planner.step((0.0, 0.0, 0.0), goal=(5.0, 0.0), costmap=walls)
    assert blocked.reason == "every rollout and the plan come to a lethal place of the costmap"
    far = planner.step((0.0, 0.0, 0.0), goal=(500.0, 0.0), costmap=walls.replace(values=np.zeros((20, 20))))
    assert far.reason == ""


def test_a_yaw_that_is_no_number_is_refused():
    with pytest.raises(ValueError, match="goal must be finite, got nan"):
        sw.Mppi(ROVER, LIMITS, samples=8).step((0.0, 0.0, 0.0), goal=(1.0, 0.0, math.nan))
