"""Finds the rocker-bogie of a tree: on either side one horizontal hinge with three wheels below it, and below
that another with two of them. The bogie may carry the rear or the front two.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from six_wheel._core import RockerBogie
from six_wheel.kinematics.poses import Floats
from six_wheel.robot_description.urdf.elements import Notes
from six_wheel.robot_description.urdf.tree import Joint, Tree
from six_wheel.robot_description.urdf.wheel_geometry import LEVEL, ROUNDING, FoundWheel

UNEVEN = 5e-3  # [m] by which the sides of a symmetric suspension may differ without a word
ALONG = 0.97  # cosine of the angle up to which a hinge lies along y: 14 degrees
SAME_PLACE = 1e-3  # [m] between hinges that are one in the robot
SIDES = ("left", "right")
PLACES = ("front", "middle", "rear")


@dataclass(frozen=True)
class Suspension:
    """A rocker-bogie in a tree: the model of it, and its joints by name."""

    model: RockerBogie
    joints: dict[str, str]  # "rocker_left" and so on to the joint in the file
    reversed: tuple[str, ...]  # those joints whose axis points to the right, so that they count the other way


@dataclass(frozen=True)
class _Side:
    """One side of a suspension, mirrored to the left [m]; limits [rad] about +y."""

    rocker: Joint
    bogie: Joint
    alone: str
    half: Joint
    """That above the wheel which the bogie does not carry, where the file has two joints on one axis."""
    vectors: dict[str, Floats]
    limits: dict[str, tuple[float, float] | None]


def find_suspension(tree: Tree, wheels: Mapping[str, FoundWheel], notes: Notes) -> Suspension | None:
    """The rocker-bogie of a tree whose wheels have these names; None, with a word where it nearly is one."""
    if {*wheels} != {f"{place}_{side}" for place in PLACES for side in SIDES}:
        return None
    sides = [_side(tree, wheels, side, notes) for side in SIDES]
    if None in sides:
        return None
    left, right = (side for side in sides if side is not None)
    if left.alone != right.alone:
        notes.warn(
            "the bogies carry other wheels on the left than on the right: no rocker-bogie is made of it"
        )
        return None
    uneven = max(float(np.abs(left.vectors[key] - right.vectors[key]).max()) for key in left.vectors)
    if uneven > UNEVEN:
        notes.warn(f"the sides of the suspension differ by {1e3 * uneven:.1f} mm: its model has their mean")
    arguments: dict[str, Any] = {
        key: tuple(((left.vectors[key] + right.vectors[key]) / 2.0).tolist()) for key in left.vectors
    }
    for key, limit in left.limits.items():
        if limit is not None and limit == right.limits[key]:
            arguments[key] = limit
    radii = {wheel.radius for wheel in wheels.values()}
    arguments["wheel_radius"] = radii.pop() if len(radii) == 1 else float(np.mean([*radii]))
    steered = {name for name, wheel in wheels.items() if wheel.steering is not None}
    ways = {"corners": ("front", "rear"), "front": ("front",), "all": PLACES}
    way = next(
        (way for way, axles in ways.items() if steered == {f"{a}_{s}" for a in axles for s in SIDES}), None
    )
    if way is None:
        listed = ", ".join(sorted(steered)) or "none"
        notes.warn(f"a rocker-bogie steers its front wheels, its corners or all; here it is {listed}")
        return None
    arguments["steered"] = way
    limits = {wheels[name].steering_limit for name in steered}
    if len(limits) == 1 and (limit := limits.pop()) is not None:
        arguments["steering_limit"] = limit
    noted = tree.parameters.get(left.rocker.name, {})  # as `write` notes them
    try:
        for key in ("differential_bar", *left.vectors):
            if key in noted:
                said = tuple(map(float, str(noted[key].text).split()))
                measured = arguments.get(key)
                if measured is None or (len(said) == 3 and np.allclose(said, measured, 0.0, ROUNDING)):
                    arguments[key] = said
        model = RockerBogie(**arguments)
    except ValueError as error:
        notes.warn(f"the tree is no rocker-bogie: {error}")
        return None
    joints = {
        f"{part}_{side}": getattr(found, part).name
        for side, found in zip(SIDES, (left, right), strict=True)
        for part in ("rocker", "bogie")
    }
    turned = tuple(name for name in joints.values() if tree.axis(tree.joints[name])[1] < 0.0)
    return Suspension(model, joints, turned)


def _side(tree: Tree, wheels: Mapping[str, FoundWheel], side: str, notes: Notes) -> _Side | None:
    own = {place: wheels[f"{place}_{side}"] for place in PLACES}
    held: dict[str, list[str]] = {}
    for place, wheel in own.items():
        for joint in tree.chain(wheel.joint)[:-1]:
            if joint is not wheel.steering and (joint.turns or joint.locked):
                held.setdefault(joint.name, []).append(place)
    flat = [name for name in held if abs(tree.axis(tree.joints[name])[2]) < LEVEL]
    others = {wheel.joint.name for name, wheel in wheels.items() if not name.endswith(side)}
    flat = [name for name in flat if not others & {each.name for each in tree.under(tree.joints[name])}]
    rockers = [tree.joints[name] for name in flat if len(held[name]) == len(PLACES)]
    pairs = [tree.joints[name] for name in flat if len(held[name]) == 2]
    singles = [tree.joints[name] for name in flat if len(held[name]) == 1]
    found = [joint for joint in rockers if joint.turns] or rockers
    whole, parts = (found[-1], None) if found else _halves(tree, singles, pairs)
    bogies = [joint for joint in pairs if joint is not whole and joint.turns]
    if whole is None and not bogies:
        return None
    if whole is None or len(bogies) != 1:
        have = ", ".join(joint.name for joint in [*rockers, *pairs]) or "none"
        notes.warn(f"no rocker-bogie on the {side}: a rocker and one bogie below it are needed, got {have}")
        return None
    rocker, bogie = whole, bogies[0]
    if rocker.locked:
        message = f"{rocker.name} is fixed, but its axis and limits are those of a rocker: taken as one"
        notes.warn(message, "make it revolute", line=rocker.line, key=rocker.name)
    for joint in (rocker, bogie):
        if abs(tree.axis(joint)[1]) < ALONG:
            notes.warn(
                f"the axis of {joint.name} is not across the rover: no rocker-bogie is made of the tree"
            )
            return None
    (alone,) = set(PLACES) - {*held[bogie.name]}
    if alone == "middle":
        notes.warn(f"{bogie.name} carries the front and the rear wheel: no rocker-bogie is made of the tree")
        return None
    ways = (rocker, rocker if parts is None else parts, bogie)
    vectors, limits = _measured(tree, own, ways, alone, mirrored=side == "right")
    return _Side(rocker, bogie, alone, rocker if parts is None else parts, vectors, limits)


def _halves(
    tree: Tree, singles: Sequence[Joint], pairs: Sequence[Joint]
) -> tuple[Joint | None, Joint | None]:
    """A rocker whose halves turn about one axis, each by a joint of its own: the bogie's, and the other."""
    for pair in pairs:
        for single in singles:
            apart = tree.pose(single)[1] - tree.pose(pair)[1]
            axis = tree.axis(pair)
            across = float(np.linalg.norm(apart - axis * (apart @ axis)))
            if across < SAME_PLACE and abs(float(tree.axis(single) @ axis)) > ALONG:
                return pair, single
    return None, None


def _measured(
    tree: Tree,
    own: Mapping[str, FoundWheel],
    ways: tuple[Joint, Joint, Joint],
    alone: str,
    *,
    mirrored: bool,
) -> tuple[dict[str, Floats], dict[str, tuple[float, float] | None]]:
    """The vectors of one side, and the limits of its hinges: rocker, its other half, bogie."""
    rocker, half, bogie = ways

    def vector(start: Joint | None, end: Joint) -> Floats:
        # Each part composed by itself, so that what was written comes back digit by digit.
        reach = tree.pose(end, start)[1]
        reach = reach if start is None else tree.pose(start)[0] @ reach
        return reach * (1.0, -1.0, 1.0) if mirrored else reach

    def limit(joint: Joint) -> tuple[float, float] | None:
        if joint.limits is None:
            return None
        lower, upper = joint.limits
        # The left rocker's angle is rho and the right one's is -rho; bogies count alike.
        turned = (tree.axis(joint)[1] < 0.0) != (mirrored and joint is rocker)
        return (-upper, -lower) if turned else (lower, upper)

    carried: Sequence[str] = [place for place in PLACES if place != alone]
    vectors = {
        "rocker_pivot": vector(None, rocker),
        f"rocker_to_{alone}": vector(half, own[alone].joint),
        "rocker_to_bogie": vector(rocker, bogie),
        **{f"bogie_to_{place}": vector(bogie, own[place].joint) for place in carried},
    }
    return vectors, {"rocker_limit": limit(rocker), "bogie_limit": limit(bogie)}
