"""The tree of links and joints in a robot description, with every transform composed at joint angles 0."""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn
from xml.etree import ElementTree
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from six_wheel.robot_description.diagnostics import Finding, ParameterFileError

__all__ = ["ENDINGS", "Joint", "Link", "Notes", "Tree", "read_tree"]

ENDINGS = (".urdf", ".xacro")
MAX_BYTES = 1 << 25  # a description has kilobytes; its meshes are files of their own
# Parts that no kinematics needs, in the order in which they are given up where the text is no XML.
SIDE_PARTS = ("gazebo", "transmission", "ros2_control")
NO_LIMIT = 1e3  # [rad or rad/s] what no joint reaches is a way to write that it has no limit
TURNING = frozenset({"revolute", "continuous"})
TYPES = TURNING | {"fixed", "prismatic", "floating", "planar"}

Floats = NDArray[np.float64]


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


@dataclass(frozen=True)
class Link:
    """A rigid part: its shapes, and its mass."""

    name: str
    element: ElementTree.Element


@dataclass(frozen=True)
class Joint:
    """A joint between two links, with `parent_from_child` at joint angle 0.

    Attributes
    ----------
    rotation, origin : array, shapes (3, 3) and (3,)
        Of the child in the parent [m].
    axis : array, shape (3,)
        Of unit length, in the child.
    limits : (float, float) or None
        Smallest and largest angle [rad]; None without any.
    velocity : float or None
        Largest rate [rad/s].
    has_axis, locked : bool
        Whether the file states an axis; whether a fixed joint has axis and limits, as one that turned.
    """

    name: str
    type: str
    parent: str
    child: str
    rotation: Floats
    origin: Floats
    axis: Floats
    limits: tuple[float, float] | None = None
    velocity: float | None = None
    locked: bool = False
    mimic: str | None = None
    line: int | None = None

    @property
    def turns(self) -> bool:
        """True if the joint is a hinge that can move."""
        return self.type in TURNING and (self.limits is None or self.limits[0] < self.limits[1])

    @property
    def endless(self) -> bool:
        """True if the joint is a hinge without limits."""
        return self.turns and (self.type == "continuous" or self.limits is None)


@dataclass
class Tree:
    """All links and joints, and where everything is in the root's frame, z up."""

    name: str
    path: Path
    root: str
    links: dict[str, Link]
    joints: dict[str, Joint]
    robot: ElementTree.Element
    above: dict[str, Joint] = field(default_factory=dict)
    """Link to the joint that holds it."""
    below: dict[str, list[Joint]] = field(default_factory=dict)
    """Link to the joints it holds."""
    up: float = 1.0
    """Sign of the root's z axis in the world: -1 for down."""

    def chain(self, joint: Joint) -> list[Joint]:
        """The joint and those above it, the root's first."""
        chain = [joint]
        while (holder := self.above.get(chain[-1].parent)) is not None:
            chain.append(holder)
        return chain[::-1]

    def under(self, joint: Joint) -> Iterator[Joint]:
        """Every joint below one."""
        waiting = [joint]
        while waiting:
            further = self.below.get(waiting.pop().child, [])
            yield from further
            waiting += further

    def pose(self, joint: Joint, start: Joint | None = None) -> tuple[Floats, Floats]:
        """Rotation and origin of a joint's child; in the child of `start`, by default in the root, z up.

        A part of the chain is composed by itself, so that no digits are lost to what is above it.
        """
        rotation, origin = np.eye(3), np.zeros(3)
        chain = self.chain(joint)
        if start is None:
            rotation = np.diag([1.0, self.up, self.up])
        else:
            chain = chain[chain.index(start) + 1 :]
        for each in chain:
            origin = origin + rotation @ each.origin
            rotation = rotation @ each.rotation
        return rotation, origin

    def axis(self, joint: Joint) -> Floats:
        """Direction of a joint's axis in the root."""
        return self.pose(joint)[0] @ joint.axis


def read_tree(path: Path, text: str, notes: Notes) -> Tree:
    """The tree that the text of a URDF describes.

    Raises
    ------
    ParameterFileError
        If it is no tree of links and joints.
    """
    robot = _parse(text, notes)
    if robot.tag != "robot":
        known = {"sdf": "an SDF", "mujoco": "a MuJoCo model", "launch": "a launch file"}
        what = known.get(robot.tag, f"<{robot.tag}>")
        notes.fail(f"the file must hold a <robot>, got {what}", "give the robot's URDF or xacro")
    links: dict[str, Link] = {}
    for element in robot.findall("link"):
        name = _name(element, notes)
        if name in links:
            notes.fail(f"the link {name} is given twice", "rename one", line=_line(element))
        links[name] = Link(name, element)
    joints: dict[str, Joint] = {}
    for element in robot.findall("joint"):
        joint = _joint(element, notes)
        if joint.name in joints:
            notes.fail(f"the joint {joint.name} is given twice", "rename one", line=joint.line)
        for end in (joint.parent, joint.child):
            if end not in links:
                message = f"the joint {joint.name} has the link {end}, which is not there"
                notes.fail(message, "add the link, or correct its name", line=joint.line)
        joints[joint.name] = joint
    return _arrange(Tree(robot.get("name", path.stem), path, "", links, joints, robot), notes)


def _arrange(tree: Tree, notes: Notes) -> Tree:
    """Finds the root, and who holds whom."""
    for joint in tree.joints.values():
        if joint.child in tree.above:
            message = f"the link {joint.child} hangs on {tree.above[joint.child].name} and on {joint.name}"
            notes.fail(message, "a link has one joint above it", line=joint.line)
        tree.above[joint.child] = joint
        tree.below.setdefault(joint.parent, []).append(joint)
    roots = [name for name in tree.links if name not in tree.above]
    if not tree.links:
        remedy = "it has parts for other files: give that of the whole robot"
        notes.fail("the file has no links", remedy if tree.path.suffix == ".xacro" else None)
    if not roots:
        notes.fail("the links form a circle", "one link, such as base_link, has no joint above it")

    def size(root: str) -> int:
        return 1 + sum(size(joint.child) for joint in tree.below.get(root, []))

    sizes = {root: size(root) for root in roots}
    tree.root = max(roots, key=lambda root: sizes[root])
    if sum(sizes.values()) < len(tree.links):
        notes.fail("some links form a circle", "every link but the root has one joint above it")
    strays = [root for root in roots if root != tree.root]
    if strays:
        message = f"the links {', '.join(strays)} do not hang on {tree.root} and are not read"
        notes.warn(message, "add the joint that holds them")
        for name in strays:
            _prune(tree, name)
    return tree


def _prune(tree: Tree, link: str) -> None:
    for joint in tree.below.pop(link, []):
        del tree.joints[joint.name]
        _prune(tree, joint.child)


def _parse(text: str, notes: Notes) -> ElementTree.Element:
    """The root element; parts that kinematics does not need are passed over where they are no XML."""
    try:
        return _elements(text)
    except expat.ExpatError as error:
        first = error
    reduced = text
    for count, tag in enumerate(SIDE_PARTS, 1):
        # Line ends stay, so that lines keep their numbers.
        pattern = re.compile(rf"<{tag}\b.*?</{tag}\s*>", re.DOTALL)
        reduced = pattern.sub(lambda found: "\n" * found[0].count("\n"), reduced)
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


def _line(element: ElementTree.Element) -> int | None:
    line = element.get("line")
    return int(line) if line else None


def _name(element: ElementTree.Element, notes: Notes) -> str:
    name = element.get("name", "")
    if not name.strip() or not name.isprintable():
        message = f"a {element.tag} must have a name of visible characters, got {name!r}"
        notes.fail(message, "name it", line=_line(element))
    return name


def _joint(element: ElementTree.Element, notes: Notes) -> Joint:
    name, kind = _name(element, notes), element.get("type", "")
    line = _line(element)
    if kind not in TYPES:
        notes.fail(f"the joint {name} must be one of {', '.join(sorted(TYPES))}, got {kind!r}", line=line)

    def end(tag: str) -> str:
        found = element.find(tag)
        if found is None or not found.get("link"):
            notes.fail(f"the joint {name} has no {tag} link", f'add <{tag} link="..."/>', line=line)
        return str(found.get("link"))

    origin, axis = element.find("origin"), element.find("axis")
    rpy = vector(origin, "rpy", name, notes)
    direction = vector(axis, "xyz", name, notes, default=(1.0, 0.0, 0.0))
    length = float(np.linalg.norm(direction))
    if length < 1e-9 and kind in TURNING:
        notes.fail(f"the axis of the joint {name} must not be 0", "give it a direction", line=line)
    limit = element.find("limit")
    mimic = element.find("mimic")
    return Joint(
        name,
        kind,
        end("parent"),
        end("child"),
        rotation_of(*rpy),
        vector(origin, "xyz", name, notes),
        direction / length if length >= 1e-9 else np.array([1.0, 0.0, 0.0]),
        _limits(limit, kind, name, notes),
        _velocity(limit, name, notes),
        locked=kind == "fixed" and axis is not None and limit is not None,
        mimic=None if mimic is None else mimic.get("joint"),
        line=line,
    )


def _limits(
    limit: ElementTree.Element | None, kind: str, name: str, notes: Notes
) -> tuple[float, float] | None:
    """The limits of a hinge, if it has some; a continuous one has none, whatever is written beside it."""
    if limit is None or kind == "continuous":
        return None
    lower, upper = (
        number(limit.get(key, "0"), f"{key} of {name}", limit, notes) for key in ("lower", "upper")
    )
    if min(abs(lower), abs(upper)) >= NO_LIMIT:
        return None
    if lower > upper:
        message = f"the limits of {name} must be in order, got {lower:g} to {upper:g} rad"
        notes.fail(message, "exchange lower and upper", line=_line(limit))
    return max(lower, -NO_LIMIT), min(upper, NO_LIMIT)


def _velocity(limit: ElementTree.Element | None, name: str, notes: Notes) -> float | None:
    if limit is None or limit.get("velocity") is None:
        return None
    velocity = number(limit.get("velocity", ""), f"velocity of {name}", limit, notes)
    return velocity if 0.0 < velocity < NO_LIMIT else None


def number(text: str, what: str, element: ElementTree.Element, notes: Notes) -> float:
    """A number of an attribute; infinity is one, as some tools write for no limit."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if math.isnan(value):
        hint = "expand the file with xacro first" if "$" in text else "write a number"
        notes.fail(f"{what} must be a number, got {text!r}", hint, line=_line(element))
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
        notes.fail(message, line=_line(element))
    return np.array(values)


def rotation_of(roll: float, pitch: float, yaw: float) -> Floats:
    """The rotation of fixed-axis angles: Rz(yaw) Ry(pitch) Rx(roll)."""
    (sr, sp, sy), (cr, cp, cy) = np.sin([roll, pitch, yaw]), np.cos([roll, pitch, yaw])
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
