"""The rover that a name or the path of a file means."""

import difflib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from six_wheel._core import Limits, Rover

if TYPE_CHECKING:
    from six_wheel.robot_description.diagnostics import Finding
    from six_wheel.robot_description.parameters.file import Parameters
    from six_wheel.robot_description.urdf import Robot


class NamedRover(NamedTuple):
    """A rover, what to call it, and the file it comes from unless it is a preset."""

    rover: Rover
    name: str
    path: Path | None = None
    parameters: "Parameters | None" = None
    robot: "Robot | None" = None

    @property
    def limits(self) -> Limits:
        """Limits of the file; in a robot description those are the rates of its joints."""
        source = self.parameters or self.robot
        return source.limits if source else Limits()

    @property
    def warnings(self) -> "Sequence[Finding]":
        """Warnings about possible mistakes in the file."""
        source = self.parameters or self.robot
        return source.warnings if source else ()


def find_rover(
    given: str,
    rule: str,
    *,
    node: str | None = None,
    kind: str | None = None,
    wheel_radius: float | None = None,
) -> NamedRover:
    """The rover of a parameter file or a robot description, or a preset if there is no such file.

    Raises `ValueError` if there is no such rover, or the file does not describe one; `rule` begins the
    message if a path or name is neither: "x must be a file or a preset".
    """
    path = Path(given)
    if path.suffix.lower() in (".urdf", ".xacro"):
        from six_wheel.robot_description.urdf import read_urdf

        robot = read_urdf(path, wheel_radius=wheel_radius)
        return NamedRover(robot.rover, path.name.partition(".")[0], path, robot=robot)
    if wheel_radius is not None:
        raise ValueError(f"--wheel-radius is for a URDF or xacro file, got {given}")
    if path.is_file() or path.suffix:
        from six_wheel.robot_description.parameters.file import read_parameters

        parameters = read_parameters(path, node=node, kind=kind)
        return NamedRover(parameters.rover, path.stem, path, parameters)
    presets = list(Rover.presets())
    if given not in presets:
        raise ValueError(f'{rule}, got "{given}"; {closest(given, presets)}')
    return NamedRover(Rover.preset(given), given)


def closest(name: str, known: Sequence[str]) -> str:
    """Hint for a name that is not known: the closest known name, and all of them."""
    close = difflib.get_close_matches(name, known, 1)
    hint = f'did you mean "{close[0]}"? ' if close else ""
    return f"{hint}there are {', '.join(known)}"
