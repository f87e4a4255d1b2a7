"""The drive of a YAGSL file, whose modules stand in files beside it."""

import json
from pathlib import Path
from typing import Any

from six_wheel.robot_description.joint_names import said_by
from six_wheel.robot_description.parameters.ros_yaml import Place, Report, Tree

MAX_BYTES = 1 << 18


def gather_modules(tree: Tree, path: Path, report: Report) -> Tree:
    """The drive of a YAGSL file with what stands in the files beside it; any other tree as it is.

    A file of one module is reported: where the others are it does not say.
    """
    data = tree.data
    if _is_module(data):
        place = tree.places.get(("location",), Place(1, ""))
        message = "this is one module of a YAGSL swerve drive, and where the others are it does not say"
        report(place.line, ("location",), message, "give its swervedrive.json")
        return tree
    named = data.get("modules") if isinstance(data, dict) else None
    if not (isinstance(named, list) and named and all(str(name).endswith(".json") for name in named)):
        return tree
    line = tree.places[("modules",)].line
    modules: dict[str, tuple[float, float]] = {}  # places, forward and to the left [inches]
    for index, name in enumerate(map(str, named)):
        file = path.parent / "modules" / name
        module = _json(file)
        if not _is_module(module):
            lacks = "has no location with front and left, or x and y"
            what = "is not beside this file" if module is None else lacks
            message = f"modules/{name} {what}"
            at = ("modules", index)
            place = tree.places.get(at, Place(line, ""))
            report(place.line, at, message, "give swervedrive.json in the folder it belongs to")
            return tree
        axle, side = said_by(Path(name).stem) or (None, None)
        called = f"{axle}_{side}" if axle and side else Path(name).stem
        location = module["location"]
        ahead, aside = next(keys for keys in _LOCATIONS if keys[0] in location)
        modules[called] = float(location[ahead]), float(location[aside])
    properties = _json(path.parent / "modules" / "physicalproperties.json")
    known = _number_in(properties, "conversionFactors", "drive", "diameter")
    known = _number_in(properties, "wheelDiameter") if known is None else known
    gathered = {key: value for key, value in data.items() if key != "modules"} | {"modules": modules}
    if known is not None:
        gathered["conversionFactors.drive.diameter"] = known
    return Tree(gathered, tree.places)


def _is_module(data: Any) -> bool:
    location = data.get("location") if isinstance(data, dict) else None
    return isinstance(location, dict) and any(
        all(isinstance(location.get(key), int | float) for key in keys) for keys in _LOCATIONS
    )


# The older files say x and y for it, x forward and y to the left as everywhere at FIRST.
_LOCATIONS = (("front", "left"), ("x", "y"))


def _number_in(data: Any, *keys: str) -> float | None:
    for key in keys:
        data = data.get(key) if isinstance(data, dict) else None
    return float(data) if isinstance(data, int | float) else None


def _json(path: Path) -> Any:
    """The content of a file beside another; None if there is none that can be read."""
    try:
        if path.stat().st_size > MAX_BYTES:
            return None
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
