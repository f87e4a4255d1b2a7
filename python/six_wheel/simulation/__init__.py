"""Logs from nowhere: what a rover's sensors report along a path, with the truth, from a seed.

`course` is how the rover is asked to move, `planar` how it really does, slip and all, `sticking` how it does
under a controller whose joint sticks, `sensor_model` the readings of encoders and gyroscope, `writing` puts
them into a file; `on_terrain` and `ground_writing` do so for a suspension on a map; `run_simulation` chooses
between the two. `drive` makes joint commands of commands.
"""

from typing import TYPE_CHECKING

from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.simulation.controlled import Controlled
    from six_wheel.simulation.ground_writing import write_ground
    from six_wheel.simulation.on_terrain import GroundSimulation
    from six_wheel.simulation.planar import Motion, Simulation, Slip
    from six_wheel.simulation.run_simulation import simulate
    from six_wheel.simulation.sticking import Stick
    from six_wheel.simulation.writing import write_log

__all__ = ["Controlled", "GroundSimulation", "Motion", "Simulation", "Slip", "Stick"]
__all__ += ["simulate", "write_ground", "write_log"]

__getattr__, __dir__ = attach(
    __name__,
    {
        "controlled": ("Controlled",),
        "course": (),
        "drive": (),
        "on_terrain": ("GroundSimulation",),
        "ground_writing": ("write_ground",),
        "planar": ("Motion", "Simulation", "Slip"),
        "sensor_model": (),
        "run_simulation": ("simulate",),
        "sticking": ("Stick",),
        "writing": ("write_log",),
    },
)
