"""A rover from a parameter file, and back: a ROS 2 file as teams have it, or plain keys.

The way down: text to a tree with lines (`syntax`), the parameters of one node (`nodes`), which form they have
(`forms`: the `kinds` of this package or the `controllers` of ROS 2, whose keys `schema` checks), which wheel
a joint turns (`joints`), the rover with all findings (`file`). `writing` is the way back; `mending` writes
other numbers into a file.
"""

from typing import TYPE_CHECKING

from six_wheel.lazy import attach

if TYPE_CHECKING:
    from six_wheel.parameters.file import (
        Finding,
        ParameterFileError,
        Parameters,
        load,
        parse_parameters,
        read_parameters,
    )
    from six_wheel.parameters.mending import text_for
    from six_wheel.parameters.writing import dump

__all__ = [
    "Finding",
    "ParameterFileError",
    "Parameters",
    "dump",
    "load",
    "parse_parameters",
    "read_parameters",
    "text_for",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "controller_keys": (),
        "controllers": (),
        "file": (
            "Finding",
            "ParameterFileError",
            "Parameters",
            "load",
            "parse_parameters",
            "read_parameters",
        ),
        "forms": (),
        "joints": (),
        "kinds": (),
        "mending": ("text_for",),
        "nodes": (),
        "schema": (),
        "syntax": (),
        "writing": ("dump",),
    },
)
