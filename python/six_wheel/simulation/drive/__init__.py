"""A table of commands to joint commands, in chunks: directly or through the controller.

`engine` is what both share, `direct` and `controlled` are the two, `course` keeps a thinned record for
pictures, `running` goes from file to file.
"""

from typing import TYPE_CHECKING

from six_wheel.lazy import attach

if TYPE_CHECKING:
    from six_wheel.drive.controlled import ControlledDrive, Loop
    from six_wheel.drive.direct import Drive
    from six_wheel.drive.engine import Engine, Peak, Summary
    from six_wheel.drive.running import drive

__all__ = [
    "ControlledDrive",
    "Drive",
    "Engine",
    "Loop",
    "Peak",
    "Summary",
    "drive",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "abilities": (),
        "controlled": ("ControlledDrive", "Loop"),
        "course": (),
        "direct": ("Drive",),
        "engine": ("Engine", "Peak", "Summary"),
        "running": ("drive",),
    },
)
