"""The whole library on one real recording: `six-wheel demo`.

`motion` turns the recording into twists and drives rovers along them, `showing` draws and tabulates,
`running` joins the two.
"""

from typing import TYPE_CHECKING

from six_wheel.lazy import attach

if TYPE_CHECKING:
    from six_wheel.demo.motion import DemoResult, Motion, drive_path, load_path, recorded_motion
    from six_wheel.demo.running import run

__all__ = [
    "DemoResult",
    "Motion",
    "drive_path",
    "load_path",
    "recorded_motion",
    "run",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "motion": ("DemoResult", "Motion", "drive_path", "load_path", "recorded_motion"),
        "running": ("run",),
        "showing": (),
    },
)
