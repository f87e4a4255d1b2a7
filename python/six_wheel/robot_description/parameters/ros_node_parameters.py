"""The parameters of one ROS 2 node, out of a file that may hold many.

A parameter file has ``<node>: ros__parameters: ...`` blocks, possibly inside namespaces; what stands under
``/**`` holds for every node, and where a key is given more than once the later block wins.
"""

import difflib
import itertools
import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, NoReturn

from six_wheel.kinematics.keywords import same_thing
from six_wheel.robot_description.diagnostics import Finding, ParameterFileError, Severity
from six_wheel.robot_description.parameters.ros_yaml import (
    Path,
    Place,
    Report,
    Tree,
    nearest,
    one_line,
    spell,
    value_at,
)

PARAMETERS = "ros__parameters"
ANY_NODE = "/**"
# Groups of parameters that controllers declare, read as ROS 2 does: kinematics: {wheels_radius: 0.1} is the
# parameter kinematics.wheels_radius.
GROUPS = frozenset(
    {"angular", "controller", "kinematics", "linear", "rover_dimensions", "steering", "traction"}
)
# Of a mapping `wheels` that is such a group, and not one of wheels by name.
WHEELS = frozenset({"separation", "radius", "encoder_resolution"})
# Names of the classes of controllers that drive a vehicle, of any author.
_DRIVE = re.compile(
    r"(drive|steering|ackermann|mecanum|swerve|tricycle|bicycle|omni|crab)\w*controller$", re.IGNORECASE
)
# Nodes beside a rover's that people hand in for it.
_FAMILIES = {
    "Nav2's": {"amcl", "bt_navigator", "controller_server", "planner_server", "local_costmap",
               "global_costmap", "behavior_server", "recoveries_server", "velocity_smoother"},
    "a filter's": {"ekf_filter_node", "ekf_node", "ukf_filter_node", "ekf_localization_node"},
}  # fmt: skip


@dataclass
class Section:
    """The parameters to check, with places relative to them; a file without nodes is one section."""

    node: str | None
    line: int | None
    data: dict[str, Any] = field(default_factory=dict)
    places: dict[Path, Place] = field(default_factory=dict)
    type: str | None = None
    """The node's controller, if the file names it: ``diff_drive_controller/DiffDriveController``."""
    node_options: dict[str, Any] = field(default_factory=dict)  # that only `six-wheel node`, `filter` declare

    def line_of(self, path: Path) -> int | None:
        """The line of a part; for what is missing, that of the whole section."""
        return nearest(self.places, path).line if path[:1] in self.places else self.line

    def report(self, report: Report, at: Path, message: str, remedy: str | None) -> None:
        """Report a finding at a part of the section."""
        report(self.line_of(at), at, message, remedy)

    def rename(self, at: Path, meant: str) -> None:
        """Take the value of one key, wherever it stands, for that of another."""
        around, key = at[:-1], at[-1]
        holder: dict[Any, Any] = value_at(self.data, around)
        renamed = {meant if name == key else name: value for name, value in holder.items()}
        holder.clear()
        holder.update(renamed)
        depth = len(at)
        self.places = {
            (*around, meant, *path[depth:]) if path[:depth] == at else path: place
            for path, place in self.places.items()
        }

    def add(self, tree: Tree, block: Path, keys: Collection[str], *, only: str | None = None) -> None:
        """Lay the parameters of a block, or one of them, over those already here, as ROS 2 does."""
        targets: dict[Path, Path] = {}
        for key, value in tree.at(block).items():
            if only is not None and key != only:
                continue
            source = (*block, key)
            head, _, tail = key.partition(".")
            if _is_group(key, value):
                for inner in _leaves(value):
                    flat = ".".join([key, *inner])
                    targets[(*source, *inner)] = (flat,)
                    self._lay((flat,), value_at(value, inner))
                continue
            target: Path = (key,)
            if tail and head in keys and head not in GROUPS and key not in keys:
                # ROS 2's other way of writing limits: {speed: 1.0} is limits.speed: 1.0
                wheel, _, argument = tail.rpartition(".")
                target = (head, wheel, argument) if head == "wheels" and wheel else (head, tail)
                self.places.setdefault((head,), tree.places[source])
            targets[source] = target
            self._lay(target, value)
        for path, place in tree.places.items():
            if path[: len(block)] == block:
                for depth in range(len(block) + 1, len(path) + 1):
                    if path[:depth] in targets:
                        self.places[(*targets[path[:depth]], *path[depth:])] = place
                        break

    def _lay(self, at: Path, value: Any) -> None:
        for part in reversed(at[1:]):
            value = {part: value}
        self.data[str(at[0])] = _merged(self.data.get(str(at[0])), value)


def _is_group(key: str, value: Any) -> bool:
    """True if a mapping holds parameters whose names begin with the key."""
    if not isinstance(value, dict):
        return False
    return key.partition(".")[0] in GROUPS or (key == "wheels" and bool(WHEELS & value.keys()))


def flat_keys(data: Any) -> set[str]:
    """The keys of a block as a form has them."""
    keys: set[str] = set()
    for key, value in data.items() if isinstance(data, dict) else ():
        keys |= {".".join([key, *inner]) for inner in _leaves(value)} if _is_group(key, value) else {key}
    return keys


def declares(data: dict[str, Any]) -> str | None:
    """A parameter that a file declares, as the source of a controller does, and gives no value."""
    for group in data.values():
        for name, value in group.items() if isinstance(group, dict) else ():
            if (
                isinstance(value, dict)
                and "type" in value
                and {"default_value", "description"} & value.keys()
            ):
                return str(name)
    return None


def _merged(below: Any, above: Any) -> Any:
    """A copy of `above` over `below`; mappings are merged, everything else replaced."""
    if isinstance(above, dict):
        below = below if isinstance(below, dict) else {}
        return below | {key: _merged(below.get(key), value) for key, value in above.items()}
    return above


def _leaves(data: dict[str, Any]) -> Iterator[tuple[str, ...]]:
    """Paths of what is no mapping."""
    for key, value in data.items():
        if isinstance(value, dict):
            yield from ((key, *inner) for inner in _leaves(value))
        else:
            yield (key,)


def closest(word: str, choices: Collection[str], *, likeness: float = 0.75) -> str | None:
    """The choice that `word` may be a slip of, or another name for, for a "did you mean"."""
    if meant := same_thing(word, choices):
        return meant
    lower = {choice.lower(): choice for choice in choices}
    matches = difflib.get_close_matches(word.lower()[:100], lower, n=1, cutoff=likeness)
    return lower[matches[0]] if matches else None


def section(
    tree: Tree,
    node: str | None,
    keys: Collection[str],
    telling: Sequence[Collection[str]],
    plain: Collection[str],
    report: Report,
) -> Section | None:
    """The parameters of a rover in a file; None, with the reason reported, if that is none or several.

    The node may be asked for with or without its namespace. Of the `keys` of a rover those that are `telling`
    are of no other kind of node: the first collection that any node has decides. The `plain` ones stand under
    a node's name without ``ros__parameters``, as in ROS 1.
    """
    blocks, outside = _blocks(tree, keys)
    told = frozenset[str]().union(*telling)
    if not blocks and not flat_keys(tree.data) & told:
        # `rover: {d1: ...}` lacks a level, except in ROS 1.
        blocks = [(key,) for key, value in tree.data.items() if key not in keys and _tells(value, told)]
    if not blocks:
        if node is not None:
            report(None, (), f"the file has no nodes, so none is named {one_line(node)}", "leave out node")
            return None
        found = Section(None, 1)
        found.add(tree, (), keys)
        return found

    types = _types(tree, blocks)
    chosen = _choose(tree, blocks, node, telling, types, report)
    if chosen is None or not _check_nesting(tree, chosen, plain, report):
        return None
    found = Section(_node_name(chosen), tree.places[chosen].line, type=types.get(chosen))
    for path in outside:
        if path[: len(chosen)] != chosen:
            message = f"{path[-1]} stands outside {PARAMETERS}, where ROS 2 does not read it"
            report(tree.places[path].line, path, message, f"move it under {PARAMETERS}:")
            # Read all the same: what else is wrong with it is to be reported too, and not that it is missing.
            found.add(tree, path[:-1], keys, only=str(path[-1]))
    for path in blocks:
        if path == chosen or (_node_name(path) == ANY_NODE and isinstance(tree.at(path), dict)):
            found.add(tree, path, keys)
    return found


def _blocks(tree: Tree, keys: Collection[str]) -> tuple[list[Path], list[Path]]:
    """Paths of all parameter blocks, and of a rover's keys that stand outside of them."""
    blocks: list[Path] = []
    outside: list[Path] = []

    def walk(data: dict[str, Any], path: Path) -> None:
        for key, value in data.items():
            here = (*path, key)
            if key in keys and not _holds_parameters(value):
                outside.append(here)
            elif key == PARAMETERS or (isinstance(value, dict) and closest(key, [PARAMETERS])):
                blocks.append(here)
            elif isinstance(value, dict):
                walk(value, here)

    walk(tree.data, ())
    return blocks, outside


def _holds_parameters(data: Any) -> bool:
    """True if the mapping is a namespace: it, or one below it, holds parameters of a node."""
    return isinstance(data, dict) and (PARAMETERS in data or any(map(_holds_parameters, data.values())))


def _types(tree: Tree, blocks: list[Path]) -> dict[Path, str]:
    """Types of the nodes, from the controller manager of the file or from the nodes themselves."""
    said: dict[str, str] = {}
    own: dict[Path, str] = {}
    for path in blocks:
        data = tree.at(path)
        for key, value in data.items() if isinstance(data, dict) else ():
            type_ = value.get("type") if isinstance(value, dict) else value if key.endswith(".type") else None
            if isinstance(type_, str):
                said[key.removesuffix(".type")] = type_
            if key == "type" and isinstance(value, str):
                own[path] = value
    names = {path: _node_name(path).rsplit("/", 1)[-1] for path in blocks}
    return {path: said[name] for path, name in names.items() if name in said} | own


def drives(type_: str) -> bool:
    """True if the class of a controller has a name like one that drives a vehicle."""
    return _DRIVE.search(type_) is not None


def _check_nesting(tree: Tree, block: Path, plain: Collection[str], report: Report) -> bool:
    """True if the block holds parameters; mistakes in the levels around them are reported."""
    key, line = str(block[-1]), tree.places[block].line
    if not isinstance(tree.at(block), dict):
        report(line, block, f"{key} must hold parameters, got none", "indent the parameters below it")
        return False
    if key != PARAMETERS and closest(key, [PARAMETERS]):
        report(line, block, f"unknown key {one_line(key)}", f"did you mean {PARAMETERS}?")
    elif key != PARAMETERS and not flat_keys(tree.at(block)) & set(plain):
        message = f"{one_line(key)} has its keys without {PARAMETERS}, so ROS 2 does not read them"
        report(line, block, message, f"indent them under a line {PARAMETERS}:")
    elif len(block) == 1 and key == PARAMETERS:
        report(line, block, f"{key} has no node above it", f"write {ANY_NODE}: above it and indent it")
    return True


def _choose(
    tree: Tree,
    blocks: list[Path],
    node: str | None,
    telling: Sequence[Collection[str]],
    types: dict[Path, str],
    report: Report,
) -> Path | None:
    names = {path: _node_name(path) for path in blocks}
    filled = [path for path in blocks if isinstance(tree.at(path), dict)]
    own, *others = ([path for path in filled if flat_keys(tree.at(path)) & set(told)] for told in telling)
    vehicles = {*itertools.chain(*others), *(path for path in filled if drives(types.get(path, "")))}
    alike = ([path for path in filled if _tells(tree.at(path), told)] for told in telling)
    tiers = itertools.chain([own, [path for path in filled if path in vehicles]], alike)
    candidates = next(filter(None, tiers), [])
    if node is not None:
        wanted = node.strip("/")
        chosen = [path for path in blocks if names[path].strip("/") == wanted]
        chosen = chosen or [path for path in blocks if names[path].rsplit("/", 1)[-1] == wanted]
        # Parameters under /** hold for a node of any name.
        chosen = chosen or [path for path in candidates if names[path] == ANY_NODE]
    else:
        chosen = [path for path in candidates if names[path] != ANY_NODE] or candidates
        chosen = chosen or (blocks if len(blocks) == 1 else [])
    if len(chosen) == 1:
        return chosen[0]
    if chosen:
        shown = (one_line(names[path]) + (f" ({types[path]})" if path in types else "") for path in chosen)
        line = tree.places[chosen[1]].line
        message = f"several nodes describe a rover: {', '.join(shown)}"
        report(line, (), message, "choose one with --parameters-node, in Python with node=")
        return None
    _report_none(blocks, names, node, report)
    return None


def _report_none(blocks: list[Path], names: dict[Path, str], node: str | None, report: Report) -> None:
    """That no node is the rover's, and what to do about it."""
    listed = ", ".join(one_line(names[path]) for path in blocks[:8]) + (", ..." if len(blocks) > 8 else "")
    asked = "has the parameters of a rover" if node is None else f"is named {one_line(node)}"
    guess = closest(node or "", names.values())
    parts = {part for name in names.values() for part in name.split("/")}
    family = next((family for family, known in _FAMILIES.items() if known & parts), None)
    remedy = "give one of them a kind and its keys, or say with --kind what it is"
    if guess:
        remedy = f"did you mean {guess}?"
    elif family is not None and node is None:
        remedy = (
            f"these are {family}; where the wheels are is in the file of the drive controller, or the URDF"
        )
    report(None, (), f"no node {asked}; the file has {listed}", remedy)


def _tells(data: Any, telling: Collection[str]) -> bool:
    return any(key in telling or closest(key, telling) for key in flat_keys(data))


def _node_name(block: Path) -> str:
    parts = [str(part) for part in block]
    if len(parts) > 1:
        parts.pop()  # the ros__parameters
    return re.sub("/+", "/", "/".join(parts)) if block[0] != PARAMETERS else ANY_NODE


class FileFindings:
    """Collects findings about one file."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.findings: list[Finding] = []

    def error(self, line: int | None, at: Path, message: str, remedy: str | None) -> None:
        self._add(line, at, message, remedy, "error")

    def warning(self, line: int | None, at: Path, message: str, remedy: str | None) -> None:
        self._add(line, at, message, remedy, "warning")

    def fail(self, line: int | None, message: str, remedy: str) -> NoReturn:
        """Report what leaves nothing more to read."""
        self.error(line, (), message, remedy)
        raise self.failure()

    def failure(self, *, warnings: bool = True) -> ParameterFileError:
        found = self.in_order()
        return ParameterFileError(each for each in found if warnings or each.severity == "error")

    def in_order(self) -> tuple[Finding, ...]:
        return tuple(sorted(self.findings, key=lambda finding: finding.line or 0))

    def has_error_at(self, key: str) -> bool:
        return any(finding.severity == "error" and finding.key == key for finding in self.findings)

    @property
    def has_errors(self) -> bool:
        return any(finding.severity == "error" for finding in self.findings)

    def _add(self, line: int | None, at: Path, message: str, remedy: str | None, severity: Severity) -> None:
        if PARAMETERS in at[:-1]:
            at = at[at.index(PARAMETERS) + 1 :]
        self.findings.append(Finding(line, spell(at), message, remedy, severity, self.path))
