"""The parameters of one ROS 2 node, out of a file that may hold many.

A parameter file has ``<node>: ros__parameters: ...`` blocks, possibly inside namespaces; what stands under
``/**`` holds for every node, and where a key is given more than once the later block wins.
"""

import difflib
import re
from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Any

from six_wheel._yaml import Path, Place, Report, Tree, nearest, one_line

__all__ = ["PARAMETERS", "Section", "closest", "section"]

PARAMETERS = "ros__parameters"
ANY_NODE = "/**"


@dataclass
class Section:
    """The parameters to check, with places relative to them; a file without nodes is one section."""

    node: str | None
    line: int | None
    data: dict[str, Any] = field(default_factory=dict)
    places: dict[Path, Place] = field(default_factory=dict)

    def line_of(self, path: Path) -> int | None:
        """The line of a part; for what is missing, that of the whole section."""
        return nearest(self.places, path).line if path[:1] in self.places else self.line

    def rename(self, key: str, meant: str) -> None:
        """Take the value of one key for that of another."""
        self.data = {meant if name == key else name: value for name, value in self.data.items()}
        self.places = {
            (meant, *at[1:]) if at[:1] == (key,) else at: place for at, place in self.places.items()
        }

    def add(self, tree: Tree, block: Path, keys: Collection[str], *, only: str | None = None) -> None:
        """Lay the parameters of a block, or one of them, over those already here, as ROS 2 does."""
        names: dict[str, Path] = {}
        for key, value in _at(tree, block).items():
            if only is not None and key != only:
                continue
            head, _, tail = key.partition(".")
            if (
                tail and head in keys
            ):  # ROS 2's other way of writing limits: {speed: 1.0} is limits.speed: 1.0
                value, names[key] = {tail: value}, (head, tail)
                self.places.setdefault((head,), tree.places[(*block, key)])
            else:
                head, names[key] = key, (key,)
            below = self.data.get(head)
            self.data[head] = below | value if isinstance(below, dict) and isinstance(value, dict) else value
        depth = len(block)
        for at, place in tree.places.items():
            if len(at) > depth and at[:depth] == block and at[depth] in names:
                self.places[(*names[str(at[depth])], *at[depth + 1 :])] = place


def closest(word: str, choices: Collection[str], *, likeness: float = 0.75) -> str | None:
    """The choice that `word` may be a slip of, for a "did you mean"."""
    lower = {choice.lower(): choice for choice in choices}
    matches = difflib.get_close_matches(word.lower()[:100], lower, n=1, cutoff=likeness)
    return lower[matches[0]] if matches else None


def section(
    tree: Tree, node: str | None, keys: Collection[str], telling: Collection[str], report: Report
) -> Section | None:
    """The parameters of a rover in a file; None, with the reason reported, if that is none or several.

    Parameters
    ----------
    tree : Tree
        The file, a mapping.
    node : str, optional
        The node asked for: its name with or without namespace.
    keys, telling : collection of str
        The keys of a rover, and those of them that no other kind of node has.
    report : callable
        Called for every mistake in the nesting.
    """
    blocks, outside = _blocks(tree, keys)
    if not blocks and not any(key in telling for key in tree.data):
        # `rover: {d1: ...}` lacks a level.
        blocks = [(key,) for key, value in tree.data.items() if key not in keys and _tells(value, telling)]
    if not blocks:
        if node is not None:
            report(None, (), f"the file has no nodes, so none is named {one_line(node)}", "leave out node")
            return None
        found = Section(None, 1)
        found.add(tree, (), keys)
        return found

    chosen = _choose(tree, blocks, node, telling, report)
    if chosen is None or not _check_nesting(tree, chosen, report):
        return None
    found = Section(_node_name(chosen), tree.places[chosen].line)
    for path in outside:
        if path[: len(chosen)] != chosen:
            message = f"{path[-1]} stands outside {PARAMETERS}, where ROS 2 does not read it"
            report(tree.places[path].line, path, message, f"move it under {PARAMETERS}:")
            # Read all the same: what else is wrong with it is to be reported too, and not that it is missing.
            found.add(tree, path[:-1], keys, only=str(path[-1]))
    for path in blocks:
        if path == chosen or (_node_name(path) == ANY_NODE and isinstance(_at(tree, path), dict)):
            found.add(tree, path, keys)
    return found


def _blocks(tree: Tree, keys: Collection[str]) -> tuple[list[Path], list[Path]]:
    """Paths of all parameter blocks, and of a rover's keys that stand outside of them."""
    blocks: list[Path] = []
    outside: list[Path] = []

    def walk(data: dict[str, Any], path: Path) -> None:
        for key, value in data.items():
            here = (*path, key)
            if key in keys:
                outside.append(here)
            elif key == PARAMETERS or (isinstance(value, dict) and closest(key, [PARAMETERS])):
                blocks.append(here)
            elif isinstance(value, dict):
                walk(value, here)

    walk(tree.data, ())
    return blocks, outside


def _check_nesting(tree: Tree, block: Path, report: Report) -> bool:
    """Whether there is something to read; what is wrong with the levels around it is reported."""
    key, line = str(block[-1]), tree.places[block].line
    if not isinstance(_at(tree, block), dict):
        report(line, block, f"{key} must hold parameters, got none", "indent the parameters below it")
        return False
    if key != PARAMETERS and closest(key, [PARAMETERS]):
        report(line, block, f"unknown key {one_line(key)}", f"did you mean {PARAMETERS}?")
    elif key != PARAMETERS:
        message = f"{one_line(key)} has its keys without {PARAMETERS}, so ROS 2 does not read them"
        report(line, block, message, f"indent them under a line {PARAMETERS}:")
    elif len(block) == 1:
        report(line, block, f"{key} has no node above it", f"write {ANY_NODE}: above it and indent it")
    return True


def _choose(
    tree: Tree, blocks: list[Path], node: str | None, telling: Collection[str], report: Report
) -> Path | None:
    names = {path: _node_name(path) for path in blocks}
    filled = [path for path in blocks if isinstance(_at(tree, path), dict)]
    candidates = [path for path in filled if any(key in telling for key in _at(tree, path))]
    candidates = candidates or [path for path in filled if _tells(_at(tree, path), telling)]
    if node is not None:
        wanted = node.strip("/")
        chosen = [path for path in blocks if names[path].strip("/") == wanted]
        chosen = chosen or [path for path in blocks if names[path].rsplit("/", 1)[-1] == wanted]
        # What stands under /** holds for a node of any name.
        chosen = chosen or [path for path in candidates if names[path] == ANY_NODE]
    else:
        chosen = [path for path in candidates if names[path] != ANY_NODE] or candidates
        chosen = chosen or (blocks if len(blocks) == 1 else [])
    if len(chosen) == 1:
        return chosen[0]
    listed = ", ".join(one_line(names[path]) for path in chosen or blocks)
    if chosen:
        line = tree.places[chosen[1]].line
        report(line, (), f"several nodes describe a rover: {listed}", "choose one with node=")
        return None
    asked = "has the parameters of a rover" if node is None else f"is named {one_line(node)}"
    guess = closest(node or "", names.values())
    remedy = f"did you mean {guess}?" if guess else "give one of them the keys d1, d2, d3, d4, ..."
    report(None, (), f"no node {asked}; the file has {listed}", remedy)
    return None


def _tells(data: Any, telling: Collection[str]) -> bool:
    return isinstance(data, dict) and any(key in telling or closest(key, telling) for key in data)


def _node_name(block: Path) -> str:
    parts = [str(part) for part in block]
    if len(parts) > 1:
        parts.pop()  # the ros__parameters
    return re.sub("/+", "/", "/".join(parts)) if block[0] != PARAMETERS else ANY_NODE


def _at(tree: Tree, path: Path) -> Any:
    data = tree.data
    for part in path:
        data = data[part]
    return data
