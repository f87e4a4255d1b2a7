"""Written reports of results, for the console and as Markdown with pictures beside it."""

from typing import TYPE_CHECKING

from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.cli.report.calibration import before_and_after, write_calibration
    from six_wheel.cli.report.ground import ground_facts
    from six_wheel.cli.report.log_odometry import facts, judged, slipped, written
    from six_wheel.cli.report.markdown import Pages, reporting

__all__ = [
    "Pages",
    "before_and_after",
    "facts",
    "ground_facts",
    "judged",
    "reporting",
    "slipped",
    "write_calibration",
    "written",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "calibration": ("before_and_after", "write_calibration"),
        "ground": ("ground_facts",),
        "markdown": ("Pages", "reporting"),
        "log_odometry": ("facts", "judged", "slipped", "written"),
    },
)
