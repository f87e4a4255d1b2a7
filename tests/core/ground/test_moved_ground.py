"""Every call on ground, found by its arguments, tells the same of a map moved anywhere and turned."""

import inspect
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import six_wheel as sw
from tests.core.ground.test_chains import EXOMARS
from tests.core.ground.test_offsets import COMMANDS, HEIGHTS, SPACING, SUSPENSION

CHAIN = sw.Suspension.triple_bogie(**EXOMARS)
START = (8.0, 9.0, 0.3)
ARGUMENTS = {"ground", "stand"}
# A place of 1e8 m has digits of 1.5e-8 m, and slopes of this ground are below 1.
CLOSE = 1e-6
OFF = int(sw.OdometryHealth.OFF_GROUND | sw.OdometryHealth.UNSETTLED)


@dataclass(frozen=True)
class World:
    """The ground at a place of the plane [m], turned about it [rad]."""

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0

    @property
    def ground(self) -> sw.Terrain:
        return sw.Terrain(HEIGHTS, SPACING, (self.x, self.y), self.yaw)

    @property
    def axes(self) -> np.ndarray:
        """Columns are the axes of the ground in the plane."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return np.array([[cos, -sin], [sin, cos]])

    def there(self, poses: Any) -> np.ndarray:
        """Poses x, y, yaw on the ground in the plane."""
        poses = np.asarray(poses, np.float64)
        places = poses[..., :2] @ self.axes.T + (self.x, self.y)
        return np.concatenate((places, poses[..., 2:] + self.yaw), -1)

    def here(self, points: Any) -> np.ndarray:
        """Points (..., 2 or 3) of the plane on the ground."""
        return self.turned_back(
            np.asarray(points, np.float64) - np.array([self.x, self.y, 0.0])[: np.shape(points)[-1]]
        )

    def turned_back(self, vectors: Any) -> np.ndarray:
        """Vectors (..., 2 or 3) in the axes of the ground."""
        vectors = np.array(vectors, np.float64)
        vectors[..., :2] = vectors[..., :2] @ self.axes
        return vectors

    def poses(self, count: int = 12) -> np.ndarray:
        random = np.random.default_rng(5)
        return self.there(np.c_[random.uniform((6, 6), (34, 24), (count, 2)), random.uniform(-3, 3, count)])


HOME = World()
Numbers = Iterator[Any]


def settled(suspension: Any, world: World) -> Numbers:
    stand = suspension.settle(world.ground, world.poses())
    yield np.asarray(stand.stands, float)
    yield from (stand.z, stand.roll, stand.pitch, stand.joints, stand.gap, stand.contact_angles)
    yield from (world.here(stand.contacts), world.here(stand.wheel_centres), world.turned_back(stand.normals))


def moving(suspension: Any, world: World, call: str) -> Numbers:
    stand = suspension.settle(world.ground, world.poses())
    command = suspension.inverse(stand, (0.1, 0.03))
    motion = suspension.forward(stand, command.steering, command.wheel_speeds)
    if call == "inverse":
        yield from (command.steering, command.wheel_speeds, command.twist, command.joint_rates)
    elif call == "forward":
        yield from (motion.twist, motion.joint_rates, motion.residuals)
    elif call == "slip":
        slip = suspension.slip(stand, command.wheel_speeds, motion.twist, motion.joint_rates)
        yield from (slip.ratio, slip.angle)
    else:
        margins = suspension.stability(stand, mass=1.0, belly=(-1.0, 1.0, 0.8, 0.4))
        yield from (
            margins.loads,
            margins.tip_over_angle,
            margins.clearance,
            margins.joint_margins,
            margins.tilt,
        )


def bounded(world: World) -> Numbers:
    bounds = SUSPENSION.bounds(world.ground, world.poses(), yaw_margin=0.02, position_margin=0.05)
    yield from (
        getattr(bounds, name) for name in ("z", "tilt", "rocker", "bogies", "clearance", "wheel_drop")
    )


def feasible(world: World) -> Numbers:
    found = SUSPENSION.feasible(world.ground, world.poses())
    yield from (np.asarray(found.reason_codes, float), found.margin, found.clearance)


def driven(world: World) -> Any:
    return sw.simulate(SUSPENSION, COMMANDS[1:], ground=world.ground, start=world.there(START), rate=10.0)


def simulated(world: World) -> Numbers:
    log = driven(world)
    yield from (world.here(log.truth.poses[:, :2]), log.wheel_angles / 10.0, log.steering / 10.0)


LOG = driven(HOME)


def reckoned(world: World) -> Numbers:
    track = sw.dead_reckon(SUSPENSION, LOG, ground=world.ground, start=world.there(START))
    assert not (np.asarray(track.health) & OFF).any()
    yield from (np.asarray(track.health, float), world.here(track.positions))


def odometry(world: World) -> Numbers:
    odometry = sw.Odometry3(SUSPENSION, ground=world.ground)
    x, y, yaw = world.there(START)
    odometry.reset((x, y, 0.0, 0.0, 0.0, yaw))
    for k in range(0, len(LOG), 2):
        state = odometry.update(LOG.steering[k], LOG.wheel_angles[k], LOG.stamps[k])
        assert not int(state.health) & OFF
        yield world.here(state.position)


CALLS: dict[str, Callable[[World], Numbers]] = {
    "RockerBogie.bounds": bounded,
    "RockerBogie.feasible": feasible,
    "dead_reckon": reckoned,
    "simulate": simulated,
    "Odometry3": odometry,
}
for owner, chain in (("RockerBogie", SUSPENSION), ("Suspension", CHAIN)):
    CALLS[f"{owner}.settle"] = partial(settled, chain)
    for name in ("inverse", "forward", "slip", "stability"):
        CALLS[f"{owner}.{name}"] = partial(moving, chain, call=name)


def calls_on_ground() -> set[str]:
    """Public functions, classes and methods that take ground or a pose on it."""
    found = set[str]()
    for name in dir(sw):
        public = getattr(sw, name)
        inner = (
            {f"{name}.{key}": getattr(public, key) for key in dir(public)} if isinstance(public, type) else {}
        )
        for full, call in ({name: public} | inner).items():
            if callable(call) and "._" not in full and not name.startswith("_"):
                try:
                    parameters = set(inspect.signature(call).parameters)
                except (TypeError, ValueError):
                    continue
                if parameters & ARGUMENTS:
                    found.add(full)
    return found


def test_no_call_is_left_out() -> None:
    # The view draws relative to where the rover is: `tests/view`.
    assert calls_on_ground() - {"view"} == set(CALLS)


FAR = st.builds(World, st.floats(-1e8, 1e8), st.floats(-1e8, 1e8), st.floats(-math.pi, math.pi))


@settings(max_examples=3, deadline=None)
@given(FAR)
@example(World(1e8, -1e8, 0.7))
@example(World(433_012.3, 5_427_000.7))
@pytest.mark.parametrize("call", sorted(CALLS))
def test_moved_ground_tells_the_same(call: str, world: World) -> None:
    for here, there in zip(CALLS[call](HOME), CALLS[call](world), strict=True):
        np.testing.assert_allclose(there, here, rtol=0, atol=CLOSE)
