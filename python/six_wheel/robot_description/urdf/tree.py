"""The tree of links and joints in a robot description, with every transform composed at joint angles 0."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from six_wheel.kinematics.poses import Floats, rotations
from six_wheel.robot_description.urdf.elements import (
    Notes,
    line_of,
    name_of,
    number,
    parse,
    vector,
)

ENDINGS = (".urdf", ".xacro")
MAX_BYTES = 1 << 25  # a description has kilobytes; its meshes are files of their own
NO_LIMIT = 1e3  # [rad or rad/s] what no joint reaches is a way to write that it has no limit
TURNING = frozenset({"revolute", "continuous"})
TYPES = TURNING | {"fixed", "prismatic", "floating", "planar"}


@dataclass(frozen=True)
class Link:
    """A rigid part: its shapes, and its mass."""

    name: str
    element: ElementTree.Element


@dataclass(frozen=True)
class Joint:
    """A joint between two links, with `parent_from_child` at joint angle 0."""

    name: str
    type: str
    parent: str
    child: str
    rotation: Floats  # (3, 3), of the child in the parent
    origin: Floats  # (3,), likewise [m]
    axis: Floats  # (3,), of unit length, in the child
    limits: tuple[float, float] | None = None  # smallest and largest angle [rad]; None without any
    velocity: float | None = None  # largest rate [rad/s]
    locked: bool = False  # fixed, with axis and limits as one that turned
    mimic: str | None = None
    line: int | None = None

    @property
    def moves(self) -> bool:
        """True unless the joint is fixed."""
        return self.type != "fixed"

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
    above: dict[str, Joint] = field(default_factory=dict)  # link to the joint that holds it
    below: dict[str, list[Joint]] = field(default_factory=dict)  # link to the joints it holds
    order: list[Joint] = field(default_factory=list)  # the joints, each after that above it
    up: float = 1.0  # sign of the root's z axis in the world: -1 for down
    rollers: dict[str, list[Joint]] = field(default_factory=dict, repr=False)
    """Joint to the rollers around it, as far as somebody has asked."""
    _poses: dict[str, tuple[Floats, Floats]] = field(default_factory=dict, repr=False)
    """Joint to rotation and origin of its child in the root as the file has it."""

    @cached_property
    def depth(self) -> dict[str, int]:
        """Joint to the most joints that move on one way down from its child."""
        depth: dict[str, int] = {}
        for joint in reversed(self.order):
            below = self.below.get(joint.child, [])
            depth[joint.name] = max((depth[each.name] + each.moves for each in below), default=0)
        return depth

    @cached_property
    def moving_above(self) -> dict[str, Joint | None]:
        """Joint to the next one above it that moves."""
        found: dict[str, Joint | None] = {}
        for joint in self.order:
            above = self.above.get(joint.parent)
            found[joint.name] = above if above is None or above.moves else found[above.name]
        return found

    @cached_property
    def commanded(self) -> dict[str, bool]:
        """Joints that the file's ros2_control and transmissions name, and whether they are commanded."""
        entries = {
            joint.get("name", ""): joint.find("command_interface") is not None
            for joint in self.robot.findall(".//ros2_control//joint")
        }
        transmitted = (joint.get("name", "") for joint in self.robot.findall("transmission/joint"))
        return dict.fromkeys(transmitted, True) | entries

    @cached_property
    def parameters(self) -> dict[str, dict[str, ElementTree.Element]]:
        """Joint to the parameters of its entry in ros2_control."""
        return {
            joint.get("name", ""): {each.get("name", ""): each for each in joint.findall("param")}
            for joint in self.robot.findall(".//ros2_control//joint")
        }

    def number_below(self, joints: Iterable[Joint]) -> dict[str, int]:
        """Joint to the number of these joints that are below it."""
        counted = {joint.name for joint in joints}
        number: dict[str, int] = {}
        for joint in reversed(self.order):
            below = self.below.get(joint.child, [])
            number[joint.name] = sum(number[each.name] + (each.name in counted) for each in below)
        return number

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
        if start is None:
            rotation, origin = self._in_root(joint)
            turned = np.array([1.0, self.up, self.up])
            return turned[:, None] * rotation, turned * origin
        rotation, origin = np.eye(3), np.zeros(3)
        chain = self.chain(joint)
        for each in chain[chain.index(start) + 1 :]:
            origin = origin + rotation @ each.origin
            rotation = rotation @ each.rotation
        return rotation, origin

    def _in_root(self, joint: Joint) -> tuple[Floats, Floats]:
        """Pose of a joint's child in the root, composed once for every joint above it."""
        waiting, above = [], joint
        while above.name not in self._poses:
            waiting.append(above)
            if (holder := self.above.get(above.parent)) is None:
                break
            above = holder
        for each in reversed(waiting):
            holder = self.above.get(each.parent)
            rotation, origin = (np.eye(3), np.zeros(3)) if holder is None else self._poses[holder.name]
            self._poses[each.name] = rotation @ each.rotation, origin + rotation @ each.origin
        return self._poses[joint.name]

    def axis(self, joint: Joint) -> Floats:
        """Direction of a joint's axis in the root."""
        return self.pose(joint)[0] @ joint.axis


def read_tree(path: Path, text: str, notes: Notes) -> Tree:
    """The tree that the text of a URDF describes. Raises `ParameterFileError` if it is no tree of links and
    joints."""
    robot = parse(text, notes)
    if robot.tag != "robot":
        known = {"sdf": "an SDF", "mujoco": "a MuJoCo model", "launch": "a launch file"}
        what = known.get(robot.tag, f"<{robot.tag}>")
        notes.fail(f"the file must hold a <robot>, got {what}", "give the robot's URDF or xacro")
    links: dict[str, Link] = {}
    for element in robot.findall("link"):
        name = name_of(element, notes)
        if name in links:
            notes.fail(f"the link {name} is given twice", "rename one", line=line_of(element))
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
    trees = {root: _joints_below(tree, root) for root in roots}
    reached = {*roots, *(joint.child for joints in trees.values() for joint in joints)}
    if others := [name for name in tree.links if name not in reached]:
        joint = _of_circle(tree, others[0])
        message = f"some links form a circle, which the joint {joint.name} closes"
        notes.fail(
            message, "every link but the root, such as base_link, has one joint above it", line=joint.line
        )
    tree.root = max(roots, key=lambda root: len(trees[root]))
    strays = [root for root in roots if root != tree.root]
    if strays:
        message = f"the links {', '.join(strays)} do not hang on {tree.root} and are not read"
        notes.warn(message, "add the joint that holds them")
    for joint in (joint for stray in strays for joint in trees[stray]):
        tree.below.pop(joint.parent, None)
        del tree.joints[joint.name]
    tree.order = trees[tree.root]
    return tree


def _of_circle(tree: Tree, link: str) -> Joint:
    """A joint of the circle above a link."""
    passed = set[str]()
    while link not in passed:
        passed.add(link)
        link = tree.above[link].parent
    return tree.above[link]


def _joints_below(tree: Tree, root: str) -> list[Joint]:
    """Every joint below a root, each after that above it."""
    joints = list(tree.below.get(root, []))
    for joint in joints:
        joints += tree.below.get(joint.child, [])
    return joints


def _joint(element: ElementTree.Element, notes: Notes) -> Joint:
    name, kind = name_of(element, notes), element.get("type", "")
    line = line_of(element)
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
        rotations(rpy),
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
        notes.fail(message, "exchange lower and upper", line=line_of(limit))
    return lower, upper


def _velocity(limit: ElementTree.Element | None, name: str, notes: Notes) -> float | None:
    if limit is None or limit.get("velocity") is None:
        return None
    velocity = number(limit.get("velocity", ""), f"velocity of {name}", limit, notes)
    if velocity < 0.0:
        message = f"velocity of {name} must be positive, got {velocity:g} rad/s"
        notes.fail(message, "write the largest rate of the joint", line=line_of(limit))
    if velocity == 0.0:
        message = f"velocity of {name} is 0, as where nobody filled it in: no limit is made of it"
        notes.warn(message, "write the largest rate of the joint", line=line_of(limit), key=name)
    return velocity if 0.0 < velocity < NO_LIMIT else None
