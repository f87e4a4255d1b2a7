"""Perseverance over a yard of rocks: where its wheels stand, and how fast they have to turn there."""

from six_wheel._core import RockerBogie, Terrain
from six_wheel.simulation.on_terrain import GroundSimulation
from six_wheel.simulation.run_simulation import simulate

SIDE, SPACING = 30.0, 0.05  # [m]
COVER, SEED = 0.1, 3  # a tenth of the yard is rock
COMMANDS = ((0.0, 0.2, 0.0, 0.0), (20.0, 0.2, 0.0, 0.06), (50.0, 0.2, 0.0, -0.06), (80.0, 0.2, 0.0, 0.0))
START = (6.0, 12.0, 0.0)


def drive_yard() -> tuple[RockerBogie, Terrain, GroundSimulation]:
    """The rover, the yard and the drive over it; the same every time."""
    suspension = RockerBogie.preset("perseverance")
    yard = Terrain.yard((SIDE, SIDE), SPACING, cover=COVER, seed=SEED)
    run = simulate(suspension, COMMANDS, ground=yard, rate=5.0, start=START)
    assert isinstance(run, GroundSimulation)
    return suspension, yard, run
