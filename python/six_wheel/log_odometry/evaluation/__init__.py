"""Errors of an estimated path against the true one, and the square-path test UMBmark."""

from typing import TYPE_CHECKING

from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.log_odometry.evaluation.paths import (
        AbsoluteError,
        Alignment,
        Evaluation,
        absolute_error,
        align,
        at_same_times,
        evaluate,
    )
    from six_wheel.log_odometry.evaluation.relative import (
        ErrorGrowth,
        RelativeError,
        error_growth,
        path_distance,
        relative_error,
        segments,
    )
    from six_wheel.log_odometry.evaluation.slip import Stretch, slip_against
    from six_wheel.log_odometry.evaluation.square_path import SquareTest, umbmark

__all__ = [
    "AbsoluteError",
    "Alignment",
    "ErrorGrowth",
    "Evaluation",
    "RelativeError",
    "SquareTest",
    "Stretch",
    "absolute_error",
    "align",
    "at_same_times",
    "error_growth",
    "evaluate",
    "path_distance",
    "relative_error",
    "segments",
    "slip_against",
    "umbmark",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "paths": (
            "AbsoluteError",
            "Alignment",
            "Evaluation",
            "absolute_error",
            "align",
            "at_same_times",
            "evaluate",
        ),
        "relative": (
            "ErrorGrowth",
            "RelativeError",
            "error_growth",
            "path_distance",
            "relative_error",
            "segments",
        ),
        "slip": ("Stretch", "slip_against"),
        "square_path": ("SquareTest", "umbmark"),
    },
)
