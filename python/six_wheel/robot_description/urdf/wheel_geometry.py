"""One wheel of a tree: where it is, where it rolls, what steers it, measured and as `write` notes it.

A hinge about an upright axis above a wheel steers it. With `a` the axle's direction, a positive speed rolls
the wheel along `a x z`. Where that is backwards the joint is reversed, and where a steering axis points down.

At the height of the wheel's centre the steering axis is at the pivot; from there to the centre it is the
trail backwards and the scrub to the left. Tilted axes move the wheel as an upright one there does, to first
order in the tilt.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from six_wheel.kinematics.poses import Floats
from six_wheel.robot_description.urdf.elements import Notes, number
from six_wheel.robot_description.urdf.shapes import Radius
from six_wheel.robot_description.urdf.tree import TURNING, Joint, Tree

LEVEL = 0.5  # largest upward part of a horizontal axis, 30 degrees: a wheel may have camber
UPRIGHT = 0.7  # least upward part of an upright one, 45 degrees
ROUNDING = 1e-6  # [m or rad] what a file with six decimals does not tell
SWIVEL = 0.1  # share of the radius from which on a wheel trails behind its pivot
ROLLERS = 3  # least number of rollers on a wheel
NUMBERS = ("x", "y", "heading", "scrub", "trail", "roller_angle")
"""Numbers of a wheel that `write` notes: a tree rounds them, and knows no more than half a turn."""


@dataclass(frozen=True)
class FoundWheel:
    """A wheel of a tree; lengths in metres, angles in radians, in the root's frame with z up."""

    joint: Joint  # the one that turns it
    centre: Floats  # (3,)
    radius: float
    radius_from: str  # the element or key that states the radius
    heading: float  # direction in which it rolls, with its steering at 0
    reversed: bool  # a positive speed of the joint rolls it backwards
    steering: Joint | None  # the joint that turns it about an upright axis
    steering_reversed: bool  # that axis points down
    pivot: Floats  # (2,): place of the steering axis at the height of the centre; the centre without one
    scrub: float
    trail: float
    castor: bool  # nothing commands that joint
    driven: bool
    roller_angle: float | None
    noted_name: str | None = None  # of a wheel whose name and numbers `write` noted
    noted_index: int = 0  # its place among the wheels

    @property
    def steering_limit(self) -> tuple[float, float] | None:
        """Of the wheel, infinite if its joint has no limits, None without a joint."""
        if self.steering is None:
            return None
        lower, upper = self.steering.limits or (-math.inf, math.inf)
        return (-upper, -lower) if self.steering_reversed else (lower, upper)


def rollers(tree: Tree, joint: Joint) -> list[Joint]:
    """The rollers on a wheel: free hinges all around its axle, at the same distance, with nothing below."""
    if joint.name not in tree.rollers:
        hinges = [each for each in tree.under(joint) if each.moves] if tree.depth[joint.name] == 1 else []
        tree.rollers[joint.name] = hinges if _are_around(tree, joint, hinges) else []
    return tree.rollers[joint.name]


def _are_around(tree: Tree, joint: Joint, hinges: Sequence[Joint]) -> bool:
    if len(hinges) < ROLLERS or not all(each.endless for each in hinges):
        return False
    origins = np.array([tree.pose(each, joint)[1] for each in hinges])
    across = origins - np.outer(origins @ joint.axis, joint.axis)
    distances = np.linalg.norm(across, axis=1)
    around = np.linalg.norm(across.mean(axis=0)) < 0.2 * distances.mean()
    return bool(around and np.ptp(distances) < 0.2 * distances.mean())


def is_wheel(tree: Tree, joint: Joint) -> bool:
    """True for a hinge that turns endlessly about a horizontal axis with nothing below it but rollers."""
    if not joint.endless or abs(tree.axis(joint)[2]) > LEVEL:
        return False
    if tree.depth[joint.name] > 0 and not rollers(tree, joint):
        return False
    above = tree.moving_above[joint.name]
    return above is None or not (above.endless and rollers(tree, above))


def measured_wheel(
    tree: Tree, joint: Joint, radius: Radius, holds: Mapping[str, int], driven: bool, notes: Notes
) -> FoundWheel:
    """The wheel that a joint turns, `holds` the number of wheels below each joint."""
    wheel = _as_noted(tree, _by_geometry(tree, joint, radius, holds, driven, notes), notes)
    steering = None if wheel.castor else wheel.steering
    if steering is not None and steering.limits is not None and not all(map(math.isfinite, steering.limits)):
        message = f"the range of {steering.name} must have two ends or none, got {{:g}} to {{:g}} rad"
        notes.fail(message.format(*steering.limits), line=steering.line, key=steering.name)
    return wheel


def _by_geometry(
    tree: Tree, joint: Joint, radius: Radius, holds: Mapping[str, int], driven: bool, notes: Notes
) -> FoundWheel:
    axle, centre = tree.axis(joint), tree.pose(joint)[1]
    heading = math.atan2(-axle[0], axle[1])
    backwards = not -math.pi / 2 + ROUNDING < heading <= math.pi / 2 + ROUNDING
    if backwards:
        heading -= math.copysign(math.pi, heading)
    if abs(heading) < ROUNDING / 1e3:
        heading = 0.0
    steering = _steering(tree, joint, holds, notes)
    if steering is None:
        return FoundWheel(
            joint, centre, *radius, heading, backwards, None, False, centre[:2], 0.0, 0.0, False,
            driven, _roller_angle(tree, joint, heading),
        )  # fmt: skip
    axis, origin = tree.axis(steering), tree.pose(steering)[1]
    # In the frame of the steering joint, so that the distance keeps its digits whatever is above.
    rotation = tree.pose(steering)[0]
    offset = rotation @ tree.pose(joint, steering)[1]
    meeting = axis * (offset[2] / axis[2])
    away = offset - meeting
    forward = np.array([math.cos(heading), math.sin(heading)])
    left = np.array([-forward[1], forward[0]])
    trail, scrub = (0.0 - float(away[:2] @ forward)), float(away[:2] @ left)
    trail, scrub = (0.0 if abs(value) < ROUNDING else value for value in (trail, scrub))
    castor = _is_castor(tree, steering, math.hypot(trail, scrub) > SWIVEL * radius[0])
    return FoundWheel(
        joint, centre, *radius, heading, backwards, steering, bool(axis[2] < 0.0), (origin + meeting)[:2],
        scrub, trail, castor and trail != 0.0, not castor and driven, None,
    )  # fmt: skip


def _steering(tree: Tree, joint: Joint, holds: Mapping[str, int], notes: Notes) -> Joint | None:
    """The lowest upright hinge above a wheel that holds no other wheel."""
    for above in reversed(tree.chain(joint)[:-1]):
        lower, upper = above.limits or (0.0, 0.0)
        if above.type in TURNING and lower == upper != 0.0:
            message = f"{above.name}, above a wheel, must have a range or none, got {lower:g} rad alone"
            remedy = "make it fixed, with the angle in its origin"
            notes.fail(message, remedy, line=above.line, key=above.name)
        if not above.turns or abs(tree.axis(above)[2]) < UPRIGHT:
            continue
        if holds[above.name] == 1:
            return above
        message = f"{above.name} bends the body with {holds[above.name]} wheels below it: it is held at 0"
        if not any(finding.key == above.name for finding in notes.warnings):
            notes.warn(
                message, "articulated bodies are no part of the model", line=above.line, key=above.name
            )
    return None


def _is_castor(tree: Tree, steering: Joint, trails: bool) -> bool:
    """True if no command moves a steering joint; in a silent file, if it trails and turns endlessly."""
    if steering.mimic is not None:
        return False
    if steering.name in tree.commanded:
        return not tree.commanded[steering.name]
    return trails and steering.endless


def _roller_angle(tree: Tree, joint: Joint, heading: float) -> float | None:
    """The angle from the axle to the axis of the lowest roller, which stands on the ground."""
    lowest_of = rollers(tree, joint)
    if not lowest_of:
        return None
    lowest = min(lowest_of, key=lambda roller: float(tree.pose(roller)[1][2]))
    axis = tree.axis(lowest)
    forward = np.array([math.cos(heading), math.sin(heading)])
    left = np.array([-forward[1], forward[0]])
    angle = math.atan2(float(axis[:2] @ forward), float(axis[:2] @ left))
    return angle - math.pi * (angle > math.pi / 2) + math.pi * (angle <= -math.pi / 2)


def _as_noted(tree: Tree, wheel: FoundWheel, notes: Notes) -> FoundWheel:
    """The wheel with the numbers that `write` noted, where the geometry says the same but for rounding."""
    entries = tree.parameters.get(wheel.joint.name, {})
    if "wheel" not in entries:
        return wheel
    said: dict[str, Any] = {
        key: number(str(entries[key].text), f"{key} of {wheel.joint.name}", entries[key], notes)
        for key in NUMBERS
        if key in entries
    }
    if wheel.steering is None:
        # The two places of a wheel that is mounted beside its pivot are one in the tree.
        scrub, trail = said.get("scrub", 0.0), said.get("trail", 0.0)
        sin, cos = math.sin(said.get("heading", wheel.heading)), math.cos(said.get("heading", wheel.heading))
        pivot = wheel.pivot - (-trail * cos - scrub * sin, -trail * sin + scrub * cos)
        wheel = replace(wheel, pivot=pivot, scrub=scrub, trail=trail)
    elif "heading" in said and math.cos(said["heading"] - wheel.heading) < 0.0:
        wheel = replace(wheel, trail=-wheel.trail, scrub=-wheel.scrub)
    if "heading" in said and math.cos(said["heading"] - wheel.heading) < 0.0:
        wheel = replace(wheel, reversed=not wheel.reversed)
    half_turns = {"heading": math.pi, "roller_angle": math.pi}
    measured = dict(zip(("x", "y"), wheel.pivot.tolist(), strict=True))
    for key, value in said.items():
        was = measured.get(key, getattr(wheel, key, None))
        off = math.inf if was is None else value - was
        off = math.remainder(off, half_turns[key]) if key in half_turns and was is not None else off
        if not abs(off) <= ROUNDING * max(1.0, abs(value)):
            message = f"{key} of {wheel.joint.name} is noted as {value!r}, and measures {was!r}"
            notes.warn(message, "the geometry decides", line=wheel.joint.line, key=wheel.joint.name)
        elif key in measured:
            measured[key] = value
        else:
            wheel = replace(wheel, **{key: value})
    castor = wheel.steering is not None and tree.commanded.get(wheel.steering.name) is False
    pivot = np.array([*measured.values()])
    index = (
        int(number(str(entries["index"].text), "index", entries["index"], notes)) if "index" in entries else 0
    )
    return replace(
        wheel, pivot=pivot, castor=castor, noted_name=str(entries["wheel"].text), noted_index=index
    )
