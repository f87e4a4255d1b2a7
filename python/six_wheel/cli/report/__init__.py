"""Written reports of results, for the console and as Markdown with pictures beside it."""

from typing import TYPE_CHECKING

from six_wheel.lazy import attach

if TYPE_CHECKING:
    from six_wheel.report.calibration import before_and_after, write_calibration
    from six_wheel.report.ground import ground_facts
    from six_wheel.report.pages import Pages, reporting
    from six_wheel.report.reckoning import facts, judged, slipped, written

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
        "pages": ("Pages", "reporting"),
        "reckoning": ("facts", "judged", "slipped", "written"),
    },
)
