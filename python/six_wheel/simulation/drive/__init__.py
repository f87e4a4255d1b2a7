"""A table of commands to joint commands, in chunks: directly or through the controller.

`run_commands` is what both share, `feedforward` and `closed_loop` are the two, `min_max_thinning` keeps a
bounded record for pictures, `run_file` goes from file to file; `performance` says what a rover can do within
limits.
"""

from typing import TYPE_CHECKING

from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.simulation.drive.closed_loop import ControlledDrive, DriveLoop
    from six_wheel.simulation.drive.feedforward import Drive
    from six_wheel.simulation.drive.run_commands import Engine, Peak, Summary
    from six_wheel.simulation.drive.run_file import drive

__all__ = [
    "ControlledDrive",
    "Drive",
    "DriveLoop",
    "Engine",
    "Peak",
    "Summary",
    "drive",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "performance": (),
        "closed_loop": ("ControlledDrive", "DriveLoop"),
        "min_max_thinning": (),
        "feedforward": ("Drive",),
        "run_commands": ("Engine", "Peak", "Summary"),
        "run_file": ("drive",),
    },
)
