"""How far an estimated path is from the true one, and the square-path test UMBmark."""

from typing import TYPE_CHECKING

from six_wheel.lazy import attach

if TYPE_CHECKING:
    from six_wheel.evaluation.paths import (
        AbsoluteError,
        Alignment,
        ErrorGrowth,
        Evaluation,
        RelativeError,
        absolute_error,
        align,
        error_growth,
        evaluate,
        path_distance,
        relative_error,
        segments,
    )
    from six_wheel.evaluation.square import SquareTest, umbmark

__all__ = [
    "AbsoluteError",
    "Alignment",
    "ErrorGrowth",
    "Evaluation",
    "RelativeError",
    "SquareTest",
    "absolute_error",
    "align",
    "error_growth",
    "evaluate",
    "path_distance",
    "relative_error",
    "segments",
    "umbmark",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "paths": (
            "AbsoluteError",
            "Alignment",
            "ErrorGrowth",
            "Evaluation",
            "RelativeError",
            "absolute_error",
            "align",
            "error_growth",
            "evaluate",
            "path_distance",
            "relative_error",
            "segments",
        ),
        "square": ("SquareTest", "umbmark"),
    },
)
