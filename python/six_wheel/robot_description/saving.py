"""Rovers into files that `load` reads."""

from os import PathLike
from typing import Any

from six_wheel._core import Rover
from six_wheel.kinematics.errors import as_path, needed
from six_wheel.kinematics.objects.whole_files import replacing


def save_rover(rover: Rover, path: str | PathLike[str], **others: Any) -> None:
    """See `Rover.save`."""
    target = as_path("path", path)
    ending = target.suffix.lower()
    if ending == ".urdf":
        if others:
            raise ValueError(f"{next(iter(others))} must be left out for a URDF, which has no place for it")
        text = rover.urdf()
    elif ending in (".yaml", ".yml"):
        with needed("six-wheel[cli]", "parameter files need"):
            from six_wheel.robot_description.parameters.writing import dump
        text = dump(rover, **others)
    else:
        raise ValueError(f"path must end in .yaml, .yml or .urdf, got {str(path)!r}")
    with replacing(target) as temporary:
        temporary.write_text(text, encoding="utf-8")
