"""Xacro files, and the packages around them that they are made of."""

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import NoReturn

from six_wheel.kinematics.errors import needed, one_line
from six_wheel.robot_description.urdf.elements import Notes

ENDING = ".xacro"
_NAME = re.compile(r"<name>\s*([^\s<]+)\s*</name>")
# Stands for the folder of a package that is not here: a plugin's setting may name it, an include may not.
_ABSENT = re.compile(r"\S*<package ([^>]+)>/?(\S*?)(?=[\s'\"]|$)")
UPWARDS = 4  # folders above the package in which its neighbours are looked for
DOWNWARDS = 4  # and how deep
MOST_FOLDERS = 5_000  # that are looked into: a file in somebody's home must not take minutes


def has_macros(path: Path, text: str) -> bool:
    """True if a robot description has xacro macros, which have to be expanded first."""
    uncommented = (part.partition("<!--")[0] for part in text.split("-->"))
    return path.suffix == ENDING or any("<xacro:" in part for part in uncommented)


def expanded(path: Path, arguments: Mapping[str, str] | None, notes: Notes) -> str:
    """The URDF that a xacro file makes.

    ``$(find PACKAGE)`` is looked for in what of ROS is installed, and in the folders around the file.
    """
    with needed("six-wheel[urdf]", "xacro files need"):
        import xacro
        from xacrodoc import packages
    packages.reset()  # it keeps what it once found, of another robot perhaps
    packages.update_package_cache(_neighbours(path.resolve()))
    absent: set[str] = set()
    while True:
        try:
            return str(xacro.process_file(str(path), mappings=dict(arguments or {})).toxml())
        except Exception as error:  # xacro has many, and the XML parser's
            cause, reason = _cause(error), one_line(error)
        if not isinstance(cause, packages.PackageNotFoundError) or cause.args[0] in absent:
            _refuse(cause, reason, notes)
        name = cause.args[0]
        absent.add(name)
        packages.update_package_cache({name: path.parent / f"<package {name}>"})


def _cause(error: BaseException) -> BaseException:
    """The error inside those in which xacro wraps it."""
    inner = getattr(error, "exc", None)
    return error if inner is None else _cause(inner)


def _refuse(cause: BaseException, reason: str, notes: Notes) -> NoReturn:
    from xacro.substitution_args import ArgException

    part = _ABSENT.search(reason)
    if part is not None:
        message = f"the xacro needs {part[2] or 'a file'} of the package {part[1]}, which is not here"
        notes.fail(message, "expand it where its packages are, and give that")
    if isinstance(cause, ArgException):
        name = cause.args[0]
        remedy = f"it is a part of another, or give one: xacro FILE {name}:=VALUE > robot.urdf"
        notes.fail(f"the xacro has no value for its argument {name}", remedy)
    notes.fail(f"the xacro cannot be expanded: {reason}", "expand it where its packages are, and give that")


def _neighbours(path: Path) -> dict[str, Path]:
    """Packages near a file by their names, the nearest of each."""
    above = [folder for folder in path.parents if (folder / "package.xml").is_file()]
    start = above[0] if above else path.parent
    found: dict[str, Path] = {}
    left = MOST_FOLDERS
    for top in [start, *start.parents][: UPWARDS + 1]:
        if top == top.parent:
            break
        for place, folders, files in os.walk(top):
            left -= 1
            depth = len(Path(place).relative_to(top).parts)
            if "package.xml" in files:
                name = _NAME.search((Path(place) / "package.xml").read_text(errors="replace"))
                if name is not None:
                    found.setdefault(name[1], Path(place))
            # Packages hold no packages, and hidden folders none that are meant.
            done = left <= 0 or depth >= DOWNWARDS or "package.xml" in files
            folders[:] = [] if done else sorted(each for each in folders if not each.startswith("."))
        if left <= 0 or (top / ".git").exists():
            break
    return found
