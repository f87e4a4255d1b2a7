"""Numbers that cannot be a rover's in metres and radians: questions, with the unit that is likely."""

from collections.abc import Collection

from six_wheel._core import Rover, setting_questions, unit_questions
from six_wheel.robot_description.parameters.key_types import Values
from six_wheel.robot_description.parameters.ros_node_parameters import Section
from six_wheel.robot_description.parameters.ros_yaml import Report


def question_units(section: Section, rover: Rover, missing: Collection[str], warning: Report) -> None:
    """Warn of what `SuspiciousUnitsWarning` warns of in Python, at the key that says so.

    Of a rover made with stand-ins for what is `missing`, too: its range is the file's. Not of the stand-ins.
    """
    for about, says, likely in unit_questions(rover):
        word = about.rpartition("_")[2]
        if any(word in key for key in missing):
            continue
        keys = (key for key in section.data if word in key and "multiplier" not in key)
        at = (about if about in section.data else next(keys, ""),)
        warning(section.line_of(at) if at[0] else section.line, at, says, likely)


def question_settings(section: Section, values: Values, warning: Report) -> None:
    """The same of `limits` and `noise`."""
    for group in ("limits", "noise"):
        for about, says, likely in setting_questions(values.get(group, {})):
            at = (group, about)
            warning(section.line_of(at) if group in section.data else section.line, at, says, likely)
