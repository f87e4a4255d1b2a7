"""The whole library on one real recording and one yard of rocks: `six-wheel demo`.

`motion` turns the recording into twists and drives rovers along them, `control` gives them to a controller as
commands, `ground` drives a rover over rocks, `figures` draws and tabulates, `running` joins them.
"""

from typing import TYPE_CHECKING

from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.cli.demo.control import ControlResult, drive_controlled
    from six_wheel.cli.demo.ground import drive_yard
    from six_wheel.cli.demo.motion import DemoMotion, DemoResult, drive_path, load_path, recorded_motion
    from six_wheel.cli.demo.running import run

__all__ = [
    "ControlResult",
    "DemoMotion",
    "DemoResult",
    "drive_controlled",
    "drive_path",
    "drive_yard",
    "load_path",
    "recorded_motion",
    "run",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "control": ("ControlResult", "drive_controlled"),
        "ground": ("drive_yard",),
        "motion": ("DemoResult", "DemoMotion", "drive_path", "load_path", "recorded_motion"),
        "running": ("run",),
        "figures": (),
    },
)
