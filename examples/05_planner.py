"""Drive narrow places with a sampling planner: a slalom, a gate behind a turn on the spot, a dead end.

Every cycle rolls 1000 samples out within the rover's limits; the rover does what the plan says, and the next
cycle starts from there.
"""

import time
from typing import NamedTuple

import numpy as np

import six_wheel as sw

DT = 0.1
CELL, MARGIN = 0.05, 0.3  # of the maps, and from obstacles on, where they begin to cost [m]
HALF_LENGTH, HALF_WIDTH = 0.65, 0.55  # of the rover with its wheels [m]

rover = sw.Rover.six_wheel(
    front_to_middle=0.5,
    middle_to_rear=0.5,
    track_width=0.8,
    middle_track_width=0.9,
    wheel_radius=0.15,
    steering_limit=1.3,
)
limits = sw.Limits(
    speed=0.8, yaw_rate=0.8, acceleration=1.0, angular_acceleration=2.0, wheel_speed=8.0, steering_rate=1.5
)
sides = np.linspace(-1.0, 1.0, 5)
footprint = np.concatenate(
    [[(HALF_LENGTH * s, side * HALF_WIDTH) for s in sides] for side in (-1, 1)]
    + [[(end * HALF_LENGTH, 0.0)] for end in (-1, 1)]
)


class World(NamedTuple):
    """Walls as rectangles ``x0, y0, x1, y1`` and the corners of a path [m]; the rover begins at `start`."""

    walls: list[tuple[float, float, float, float]]
    path: list[tuple[float, float]]
    start: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def costmap(self) -> sw.Costmap:
        """1 in a wall, falling to 0 within the margin around it."""
        low = np.minimum(np.min(self.path, axis=0), np.array(self.walls)[:, :2].min(axis=0)) - 1.5
        high = np.maximum(np.max(self.path, axis=0), np.array(self.walls)[:, 2:].max(axis=0)) + 1.5
        x, y = np.meshgrid(*(np.arange(a, b, CELL) for a, b in zip(low, high, strict=True)))
        distance = np.full(x.shape, np.inf)
        for x0, y0, x1, y1 in self.walls:
            away = np.hypot(
                np.maximum(np.maximum(x0 - x, x - x1), 0), np.maximum(np.maximum(y0 - y, y - y1), 0)
            )
            distance = np.minimum(distance, away)
        return sw.Costmap(np.clip(1 - distance / MARGIN, 0, 1), CELL, low, lethal=0.99)


WORLDS = {
    "slalom": World(
        walls=[(x - 0.1, -0.1, x + 0.1, 0.1) for x in (2.5, 5.0, 7.5)],
        path=[(0, 0), (1, 0.4), (2.5, 0.9), (5, -0.9), (7.5, 0.9), (9, 0.4), (10, 0)],
    ),
    "gate": World(
        walls=[(-1.2, -1.3, 1.2, -1.1), (1.2, -1.3, 1.4, 1.4), (-1.4, -1.3, -1.2, 1.4),
               (-1.4, 1.1, -0.75, 1.4), (0.75, 1.1, 1.4, 1.4)],
        path=[(0, 0), (0, 4)],
    ),
    "dead end": World(
        walls=[(0, 0.9, 5, 1.1), (0, -1.1, 5, -0.9), (4.9, -1.1, 5.1, 1.1)],
        path=[(4, 0), (-1.5, 0), (-1.5, 2.5), (3, 2.5)],
        start=(4.0, 0.0, 0.0),
    ),
}  # fmt: skip


class Driven(NamedTuple):
    """Record of a drive: a row a cycle."""

    poses: np.ndarray
    steering: np.ndarray
    twists: np.ndarray
    arrived: bool
    seconds: float  # for a cycle, in the mean


def drive(world: World, seed: int = 0, cycles: int = 600) -> Driven:
    """Follow the plan until the end of the path is reached."""
    planner = sw.Mppi(
        rover, limits, horizon=40, dt=DT, samples=1000, seed=seed, footprint=footprint, temperature=0.3,
        dtype="float32",
        cost_weights={"map": 5.0, "path": 4.0, "heading": 2.0, "progress": 6.0, "goal": 0.2, "terminal": 0},
    )  # fmt: skip
    costmap = world.costmap()
    pose, twist, steering = np.array(world.start), np.zeros(3), np.zeros(4)
    poses, angles, twists = [pose], [steering], [twist]
    begun = time.perf_counter()
    arrived = False
    while len(poses) <= cycles and not arrived:
        plan = planner.step(pose, twist=twist, steering=steering, path=world.path, costmap=costmap)
        pose, twist, steering = plan.poses[1], plan.twist, plan.steering
        poses.append(pose)
        angles.append(steering)
        twists.append(twist)
        arrived = bool(np.hypot(*(pose[:2] - world.path[-1])) < 0.3)
    seconds = (time.perf_counter() - begun) / (len(poses) - 1)
    return Driven(np.array(poses), np.array(angles), np.array(twists), arrived, seconds)


if __name__ == "__main__":
    for name, world in WORLDS.items():
        run = drive(world)
        spun = np.abs(run.twists[:, 0]) < rover.spin_radius * np.abs(run.twists[:, 2])
        backwards = run.twists[:, 0] < -0.05
        print(
            f"{name}: {'arrived' if run.arrived else 'not there'} after {DT * (len(run.poses) - 1):.1f} s, "
            f"{DT * spun.sum():.1f} s of it turning on the spot, {DT * backwards.sum():.1f} s backwards; "
            f"a cycle of 1000 x 40 took {1e3 * run.seconds:.2f} ms"
        )
