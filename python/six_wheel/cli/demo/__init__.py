"""The whole library on one real recording and one yard of rocks: `six-wheel demo`.

`motion` turns the recording into twists and drives rovers along them, `ground` drives one over rocks,
`figures` draws and tabulates, `running` joins them.
"""

from typing import TYPE_CHECKING

from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.cli.demo.ground import drive_yard
    from six_wheel.cli.demo.motion import DemoResult, Motion, drive_path, load_path, recorded_motion
    from six_wheel.cli.demo.running import run

__all__ = [
    "DemoResult",
    "Motion",
    "drive_path",
    "drive_yard",
    "load_path",
    "recorded_motion",
    "run",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "ground": ("drive_yard",),
        "motion": ("DemoResult", "Motion", "drive_path", "load_path", "recorded_motion"),
        "running": ("run",),
        "figures": (),
    },
)
