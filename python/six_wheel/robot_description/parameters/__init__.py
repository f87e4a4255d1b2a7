"""A rover from a parameter file, and back: a ROS 2 file as teams have it, or plain keys.

The way down: text to a tree with lines (`ros_yaml`), the parameters of one node (`ros_node_parameters`),
their form (`detect_format`: the `vehicle_types` of this package or the `foreign` keys of ROS 2 and others,
which `schema` checks), the wheel that a joint turns (`joints`), the rover with all findings (`file`).
`writing` is the way back; `edit_in_place` writes other numbers into a file.
"""

from typing import TYPE_CHECKING

from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.robot_description.diagnostics import Finding, ParameterFileError
    from six_wheel.robot_description.parameters.edit_in_place import text_for
    from six_wheel.robot_description.parameters.file import (
        Parameters,
        load,
        parse_parameters,
        read_parameters,
    )
    from six_wheel.robot_description.parameters.writing import dump

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
        "file": (
            "Finding",
            "ParameterFileError",
            "Parameters",
            "load",
            "parse_parameters",
            "read_parameters",
        ),
        "detect_format": (),
        "foreign": (),
        "joints": (),
        "vehicle_types": (),
        "edit_in_place": ("text_for",),
        "ros_node_parameters": (),
        "schema": (),
        "ros_yaml": (),
        "writing": ("dump",),
    },
)
