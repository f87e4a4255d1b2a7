"""The elements of a robot description, each with the line it starts on, and numbers of their attributes."""

import math
import re
from pathlib import Path
from typing import NoReturn
from xml.etree import ElementTree
from xml.parsers import expat

import numpy as np

from six_wheel.kinematics.poses import Floats
from six_wheel.robot_description.diagnostics import Finding, ParameterFileError

# Parts that no kinematics needs, in the order in which they are given up where the text is no XML.
SIDE_PARTS = ("gazebo", "transmission", "ros2_control")


class Notes:
    """Collects what is wrong with a file, and what a reader should know of it."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.warnings: list[Finding] = []

    def warn(
        self, message: str, remedy: str | None = None, *, line: int | None = None, key: str = ""
    ) -> None:
        """Keep what may be a mistake, or had to be decided."""
        self.warnings.append(Finding(line, key, message, remedy, "warning", str(self.path)))

    def fail(
        self, message: str, remedy: str | None = None, *, line: int | None = None, key: str = ""
    ) -> NoReturn:
        """Refuse the file."""
        raise ParameterFileError([Finding(line, key, message, remedy, "error", str(self.path))])


def parse(text: str, notes: Notes) -> ElementTree.Element:
    """The root element; parts that kinematics does not need are passed over where they are no XML."""
    try:
        return _elements(text)
    except expat.ExpatError as error:
        first = error
    reduced = text
    for count, tag in enumerate(SIDE_PARTS, 1):
        reduced = _without(tag, reduced)
        try:
            robot = _elements(reduced)
        except expat.ExpatError:
            continue
        gone = " and ".join(f"<{tag}>" for tag in SIDE_PARTS[:count])
        message = f"not valid XML ({expat.ErrorString(first.code)}) in a part that is not needed"
        notes.warn(f"{message}; {gone} is passed over", "viewers will refuse the file", line=first.lineno)
        return robot
    notes.fail(
        f"not valid XML: {expat.ErrorString(first.code)}",
        "check that tags are closed here and just above",
        line=first.lineno,
    )


def _without(tag: str, text: str) -> str:
    """A text without the elements of a tag. Line ends stay, so that lines keep their numbers."""
    begin, end = re.compile(rf"<{tag}\b"), re.compile(rf"</{tag}\s*>")
    kept, place = [], 0
    while (first := begin.search(text, place)) and (last := end.search(text, first.end())):
        kept += [text[place : first.start()], "\n" * text.count("\n", first.start(), last.end())]
        place = last.end()
    return "".join([*kept, text[place:]])


def _elements(text: str) -> ElementTree.Element:
    """The elements, each with the line it starts on."""
    builder = ElementTree.TreeBuilder()
    parser = expat.ParserCreate()
    parser.buffer_text = True

    def start(tag: str, attributes: dict[str, str]) -> None:
        builder.start(tag, attributes | {"line": str(parser.CurrentLineNumber)})

    parser.StartElementHandler = start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.data
    parser.Parse(text.encode(), True)
    root: ElementTree.Element = builder.close()
    return root


def line_of(element: ElementTree.Element) -> int | None:
    line = element.get("line")
    return int(line) if line else None


def name_of(element: ElementTree.Element, notes: Notes) -> str:
    name = element.get("name", "")
    if not name.strip() or not name.isprintable():
        message = f"a {element.tag} must have a name of visible characters, got {name!r}"
        notes.fail(message, "name it", line=line_of(element))
    return name


def number(text: str, what: str, element: ElementTree.Element, notes: Notes) -> float:
    """A number of an attribute; infinity is one, as some tools write for no limit."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if math.isnan(value):
        hint = "expand the file with xacro first" if "$" in text else "write a number"
        notes.fail(f"{what} must be a number, got {text!r}", hint, line=line_of(element))
    return value


def vector(
    element: ElementTree.Element | None,
    key: str,
    name: str,
    notes: Notes,
    default: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Floats:
    """Three finite numbers of an attribute, or the default."""
    text = None if element is None else element.get(key)
    if element is None or text is None:
        return np.array(default)
    values = [number(part, f"{key} of {name}", element, notes) for part in text.split()]
    if len(values) != 3 or not all(map(math.isfinite, values)):
        message = f"{key} of {name} must be three finite numbers, got {text!r}"
        notes.fail(message, line=line_of(element))
    return np.array(values)
