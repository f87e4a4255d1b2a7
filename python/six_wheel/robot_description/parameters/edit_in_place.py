"""A parameter file with the numbers of another rover: comments, keys and order stay as they were.

Which number belongs to which key is found by asking the form: its layout is a function from keys to wheels,
and the keys are those for which it gives the wheels that are wanted. So every form can be mended.
"""

import itertools
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import yaml

from six_wheel._core import Rover
from six_wheel.kinematics.poses import Floats
from six_wheel.robot_description.diagnostics import ParameterFileError
from six_wheel.robot_description.parameters import ros_yaml
from six_wheel.robot_description.parameters.detect_format import form_of, section_of
from six_wheel.robot_description.parameters.file import Parameters, parse_parameters
from six_wheel.robot_description.parameters.key_types import GROUPS, Values
from six_wheel.robot_description.parameters.ros_node_parameters import PARAMETERS, Section
from six_wheel.robot_description.parameters.ros_yaml import Path, Tree, value_at
from six_wheel.robot_description.parameters.schema import Form, check_values
from six_wheel.robot_description.parameters.writing import dump
from six_wheel.robot_description.wheels_of_rover import joints_as_given

QUANTITIES = ("x", "y", "heading", "radius", "scrub", "trail", "roller_angle")
SAME = 1e-12  # [m or rad], and of the value: what rounding leaves of a key that is a product of two
STEPS = 8  # of Newton's method; keys enter linearly or in products of two, for which three are enough
# Groups of values that a calibration finds beside the rover.
KEPT = ("wheel_encoders", "noise", "odometry", "gyroscope", "truth", "calibration")
COUNTS = frozenset({"wheels_per_side"})


def text_for(
    rover: Rover,
    parameters: Parameters | None = None,
    beside: Mapping[str, Values | None] | None = None,
    remarks: Sequence[str] = (),
) -> str:
    """The text of a parameter file for a rover.

    Parameters
    ----------
    rover : Rover
        Of the same wheels and joints as the file's.
    parameters : Parameters, optional
        The file to mend. If its keys cannot say what the rover is, the result has ``kind: custom``, and the
        frames, limits and so on of the file.
    beside : mapping, optional
        New values of keys of every rover, such as ``{"wheel_encoders": {...}, "noise": {...}}``; what they
        hold now where nothing, or None, is given.
    remarks : sequence of str
        Comments for the top of the file.

    Raises
    ------
    ValueError
        If no parameter file can say what the rover is.
    """
    head = "".join(f"# {remark}\n" for remark in remarks)
    wanted = {
        name: values if values is not None else ({} if parameters is None else getattr(parameters, name))
        for name, values in (dict.fromkeys(KEPT) | dict(beside or {})).items()
    }
    mended = None if parameters is None else _mended(parameters, rover, wanted)
    return head + (mended or _plain(rover, parameters, wanted))


def _same(rover: Rover, other: Rover) -> bool:
    """Equal but for rounding."""
    if rover == other:
        return True
    named = rover.wheel_names == other.wheel_names and joints_as_given(rover) == joints_as_given(other)
    numbers = np.allclose(_quantities(rover), _quantities(other), rtol=SAME, atol=SAME)
    turned = {*rover.reversed_joints} == {*other.reversed_joints}
    return named and turned and numbers


def _quantities(rover: Rover) -> Floats:
    return np.array(
        [getattr(wheel, name) or 0.0 for wheel in rover.wheels for name in QUANTITIES], dtype=float
    )


def _plain(rover: Rover, parameters: Parameters | None, beside: Values) -> str:
    """A file of our own keys, with what the old file says beside the rover."""
    said: Values = {}
    groups: Values = {name: values for name, values in beside.items() if values or values is False}
    if parameters is not None:
        kept = ("odom_frame_id", "base_frame_id", "limits", "control")
        said = {name: getattr(parameters, name) for name in kept}
        groups = {name: getattr(parameters, name) for name in ("steering_encoders", "odometry")} | groups
    for node in (parameters.node, None) if parameters is not None and parameters.node else (None,):
        data = ros_yaml.parse(dump(rover, node=node, **said), _unheard).data
        values = data if node is None else data[node][PARAMETERS]
        values |= {name: value for name, value in groups.items() if value or value is False}
        text = ros_yaml.write(values if node is None else {node: {PARAMETERS: values}})
        found = parse_parameters(text, node=node)
        if found.rover == rover and _holds(found, beside):
            return text
    raise ValueError(f"rover must be one that a parameter file can describe, got {rover}")


# --- mending ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _File:
    """A parameter file, taken apart."""

    text: str
    tree: Tree
    section: Section
    form: Form
    values: Values


def _mended(parameters: Parameters, rover: Rover, beside: Values) -> str | None:
    """The file's own text with other numbers; None if that cannot say what the rover is."""
    file = _take_apart(parameters)
    if file is None:
        return None
    for candidate in _variants(file, rover):
        paths = list(_leaves(candidate.values))
        factors = {path for path in paths if "multiplier" in str(path[0])}
        few = [path for path in paths if path not in factors]
        values = _solve(candidate, few, rover) or (_solve(candidate, paths, rover) if factors else None)
        if values is None:
            continue
        for name, wanted in beside.items():
            if wanted != getattr(parameters, name):
                values[name] = wanted
        text = _edit(file, values)
        try:
            node, kind = parameters.node, parameters.kind_given
            found = None if text is None else parse_parameters(text, node=node, kind=kind)
            if found is not None and _same(found.rover, rover) and _holds(found, beside):
                return text
        except ParameterFileError:
            continue
    return None


def _holds(found: Parameters, beside: Values) -> bool:
    """True if a file holds these values beside the rover."""
    return all(getattr(found, name) == values for name, values in beside.items())


def _unheard(*_: Any) -> None:
    """Mistakes were reported when the file was read."""


def _take_apart(parameters: Parameters) -> _File | None:
    text = parameters.path.read_text(encoding="utf-8-sig")
    tree = ros_yaml.parse(text, _unheard)
    found = section_of(tree, parameters.node, _unheard)
    form = None if found is None else form_of(found, _unheard, _unheard, parameters.kind_given)
    if found is None or form is None:
        return None
    return _File(text, tree, found, form, check_values(found, form, _unheard))


def _variants(file: _File, rover: Rover) -> Iterator[_File]:
    """The file as it is; then with what says more: two radii for one, centres of rotation of its own, where
    the wheels are along the rover, a factor for each side."""
    radius = file.values.get("wheel_radius")
    sides: Values = {"wheel_radius": [radius, radius]}
    y = [wheel.y + wheel.scrub for wheel in rover.wheels]
    centres: Values = {"icr_left": max(y), "icr_right": min(y), "icr_forward": 0.0}
    two_sided = file.form.kind in ("differential", "tracked") and file.form.controller is None
    more: list[Values] = [{}]
    if two_sided:
        more += [centres] if isinstance(radius, list) else [sides, centres, sides | centres]
    x = [wheel.x for wheel in rover.wheels]
    placed = {"wheelbase": max(x) - min(x), "half_wheelbase": max(x)}
    keys = file.form.keys
    if file.form.controller and file.form.kind in ("differential", "mecanum"):
        along = {key: value for key, value in placed.items() if key in keys and key not in file.values}
        factors = {key: 1.0 for key in keys if key.endswith("_wheel_radius_multiplier")}
        more += [each for each in (along, factors, along | factors) if each]
    for added in more:
        yield replace(file, values=added | file.values | {key: added[key] for key in sides if key in added})


def _leaves(values: Any, path: Path = ()) -> Iterator[Path]:
    """Paths of the numbers among the values that may be other ones."""
    if isinstance(values, dict | list):
        for key, value in values.items() if isinstance(values, dict) else enumerate(values):
            if path or key not in {*GROUPS, *COUNTS}:
                yield from _leaves(value, (*path, key))
    elif isinstance(values, int | float) and not isinstance(values, bool) and math.isfinite(values):
        yield path


def _with(values: Any, path: Path, value: float) -> Any:
    """A copy of nested values with another number at `path`."""
    if not path:
        return value
    copy = values.copy()
    copy[path[0]] = _with(values[path[0]], path[1:], value)
    return copy


def _solve(file: _File, paths: Sequence[Path], rover: Rover) -> Values | None:
    """Values of these keys for which the form's layout gives the wheels of the rover, or None."""
    wanted = _quantities(rover)
    known = sorted({*wanted.tolist(), *(2.0 * wanted).tolist()})

    def filled(numbers: Floats) -> Values:
        values = file.values
        for path, number in zip(paths, numbers.tolist(), strict=True):
            values = _with(values, path, number)
        return values

    def wheels(numbers: Floats) -> Floats:
        return _quantities(file.form.layout(file.form.complete(file.section, filled(numbers))))

    numbers = np.array([value_at(file.values, path) for path in paths], dtype=float)
    try:
        for _ in range(STEPS):
            now = wheels(numbers)
            if now.shape != wanted.shape:
                return None
            if np.allclose(now, wanted, rtol=SAME, atol=SAME):
                break
            # Differences of functions that are linear in every key: any step is as good.
            steps = 1e-3 * np.maximum(np.abs(numbers), 1e-3)
            slopes = [(wheels(numbers + step) - now) / step.sum() for step in np.diag(steps)]
            numbers = numbers + np.linalg.lstsq(np.transpose(slopes), wanted - now, rcond=1e-9)[0]
        # A key that is a wheel's number, or twice that, is exactly that.
        for i, number in enumerate(numbers.tolist()):
            nearest = min(known, key=lambda each: abs(each - number))
            if abs(nearest - number) <= SAME * max(abs(number), 1.0):
                numbers[i] = nearest
        return filled(numbers) if np.allclose(wheels(numbers), wanted, rtol=SAME, atol=SAME) else None
    except ValueError:  # numbers that no such rover has
        return None


# --- writing ---------------------------------------------------------------------------------------------


def _edit(file: _File, values: Values) -> str | None:
    """The text with the numbers that differ; None if one of them has no place in it."""
    before = check_values(file.section, file.form, _unheard)
    nodes = dict(_nodes(yaml.compose(file.text, Loader=ros_yaml.Loader), ()))
    absolute = {id(place): path for path, place in file.tree.places.items()}
    edits: list[tuple[int, int, str]] = []
    for key, value in values.items():
        if key not in before:
            edit = _insertion(file, nodes, absolute, key, value)
            if edit is None:
                return None
            edits.append(edit)
            continue
        if key in GROUPS and value != before[key]:
            node = nodes.get(absolute.get(id(file.section.places.get((key,))), ()))
            if not isinstance(node, yaml.MappingNode):
                return None
            start, end = node.start_mark.index, node.end_mark.index
            # A mapping in block style reaches to where the next key begins.
            rest = file.text[start:end]
            edits.append((start, start + len(rest.rstrip()), _written(value)))
            continue
        if isinstance(value, list) != isinstance(before[key], list):
            places: list[tuple[Path, Any]] = [((key,), value)]
        else:
            paths = list(_leaves(value, (key,)))
            places = [
                (path, value_at(values, path))
                for path in paths
                if value_at(values, path) != value_at(before, path)
            ]
        for path, number in places:
            node = nodes.get(absolute.get(id(file.section.places.get(path)), ()))
            if not isinstance(node, yaml.ScalarNode):
                return None
            edits.append((node.start_mark.index, node.end_mark.index, _written(number)))
    text = file.text
    for start, end, new in sorted(edits, reverse=True):
        text = text[:start] + new + text[end:]
    return text


def _written(value: Any) -> str:
    match value:
        case dict():
            return f"{{{', '.join(f'{json.dumps(key)}: {_written(each)}' for key, each in value.items())}}}"
        case list():
            return f"[{', '.join(map(_written, value))}]"
        case bool() | str():
            return json.dumps(value)
    return repr(float(value))


def _nodes(node: Any, path: Path) -> Iterator[tuple[Path, yaml.Node]]:
    yield path, node
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            yield from _nodes(value, (*path, key.value))
    elif isinstance(node, yaml.SequenceNode):
        yield from itertools.chain(*(_nodes(item, (*path, i)) for i, item in enumerate(node.value)))


def _insertion(
    file: _File, nodes: dict[Path, yaml.Node], absolute: dict[int, Path], key: str, value: Any
) -> tuple[int, int, str] | None:
    """A line for a new key, below the first number of the rover and as far in."""
    alone = [path for path in _leaves(file.values) if len(path) == 1 and path in file.section.places]
    # A dotted key may stand in a mapping of its own, where a new one would be part of that.
    first = min(alone, key=lambda path: "." in str(path[0]), default=None)
    if first is None:
        return None
    beside = nodes[absolute[id(file.section.places[first])]]
    line = file.text.rfind("\n", 0, beside.start_mark.index) + 1
    indent = file.text[line : len(file.text) - len(file.text[line:].lstrip())]
    end = file.text.find("\n", beside.end_mark.index)
    end = len(file.text) if end < 0 else end
    return end, end, f"\n{indent}{key}: {_written(value)}"
