"""Logs from nowhere: what a rover's sensors report along a path, with the truth, from a seed.

`course` is how the rover is asked to move, `motion` how it really does, slip and all, `sticking` how it does
under a controller whose joint sticks, `readings` what
encoders and gyroscope make of that, `writing` puts it into a file;
`running` joins them. `ground` and `ground_writing` do so for a suspension on a map.
"""

from typing import TYPE_CHECKING

from six_wheel.lazy import attach

if TYPE_CHECKING:
    from six_wheel.simulation.ground import GroundSimulation
    from six_wheel.simulation.ground_writing import write_ground
    from six_wheel.simulation.motion import Motion, Slip
    from six_wheel.simulation.running import Simulation, simulate
    from six_wheel.simulation.sticking import Controlled, Stick
    from six_wheel.simulation.writing import write_log

__all__ = ["Controlled", "GroundSimulation", "Motion", "Simulation", "Slip", "Stick"]
__all__ += ["simulate", "write_ground", "write_log"]

__getattr__, __dir__ = attach(
    __name__,
    {
        "course": (),
        "ground": ("GroundSimulation",),
        "ground_writing": ("write_ground",),
        "motion": ("Motion", "Slip"),
        "readings": (),
        "running": ("Simulation", "simulate"),
        "sticking": ("Controlled", "Stick"),
        "writing": ("write_log",),
    },
)
