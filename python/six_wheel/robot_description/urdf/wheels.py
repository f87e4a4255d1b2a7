"""Finds the wheels of a tree, their steering joints and the signs of both, from the geometry.

A wheel is a hinge that turns endlessly about a horizontal axis, near the ground, with nothing driven below
it; `wheel_geometry` measures it.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from six_wheel.robot_description.joint_names import said_by
from six_wheel.robot_description.urdf.elements import Notes
from six_wheel.robot_description.urdf.shapes import Radius, mass_centre, plugin_radius, radius_of
from six_wheel.robot_description.urdf.tree import Joint, Tree
from six_wheel.robot_description.urdf.wheel_geometry import ROUNDING, FoundWheel, is_wheel, measured_wheel

MAX_WHEELS = 64  # of a rover of the core
PARALLEL = 5e-3  # [rad] headings of axles that are meant to be parallel, in files that write 1.57
FLAT = 0.02  # share of the wheels' spread up to which a height says nothing
ON_GROUND = ("footprint", "ground")  # in the name of a root that lies there
LOW = 0.15  # share of the wheels' spread by which a wheel may be above the lowest


def find_wheels(tree: Tree, notes: Notes, wheel_radius: float | None = None) -> list[FoundWheel]:
    """The wheels, front to rear and left before right, or in the order that `write` noted.

    `wheel_radius` goes before what the file says.

    Raises `ParameterFileError` if there is none, or nothing tells how large one is.
    """
    candidates = [joint for joint in tree.joints.values() if is_wheel(tree, joint)]
    if not candidates:
        _refuse(tree, notes)
    all_wheels = candidates
    if len(candidates) > MAX_WHEELS:
        hint = "give the description of a rover"
        notes.fail(f"a rover has 1 to {MAX_WHEELS} wheels, got {len(candidates)}", hint)
    tree.up = _up(tree, candidates, notes)
    radii = {joint.name: radius_of(tree, joint, notes) for joint in candidates}
    candidates = _on_ground(tree, candidates, radii, notes)
    known = _with_radii(tree, candidates, radii, wheel_radius, notes)
    holds = tree.number_below(all_wheels)
    # Those that the file commands have motors, or all where it commands none.
    silent = not any(joint.name in tree.commanded for joint in all_wheels)
    wheels = [
        measured_wheel(tree, joint, known[joint.name], holds, tree.commanded.get(joint.name, silent), notes)
        for joint in candidates
    ]
    if all(wheel.noted_name is not None for wheel in wheels):
        return sorted(wheels, key=lambda wheel: wheel.noted_index)
    return sorted(_aligned(wheels, notes), key=lambda wheel: (-round(wheel.pivot[0], 2), -wheel.pivot[1]))


def _refuse(tree: Tree, notes: Notes) -> None:
    hinges = [joint for joint in tree.joints.values() if joint.moves]
    listed = ", ".join(f"{joint.name} ({joint.type})" for joint in hinges[:8]) or "none but fixed ones"
    notes.fail(
        "no wheel found: no continuous joint has a horizontal axis and nothing that moves below it",
        f"the joints are {listed}{', ...' if len(hinges) > 8 else ''}",
    )


def _up(tree: Tree, wheels: Sequence[Joint], notes: Notes) -> float:
    """Sign of the root's z axis, 1 up or -1 down: the hinges that hold wheels are above these, a root on the
    ground is below them, and the masses are no lower than the ground."""
    centres = [tree.pose(joint)[1] for joint in wheels]
    height = float(np.mean([centre[2] for centre in centres]))
    spread = float(np.ptp([centre[:2] for centre in centres], axis=0).max())
    above = [
        tree.pose(each)[1][2] - centre[2]
        for joint, centre in zip(wheels, centres, strict=True)
        for each in tree.chain(joint)[:-1]
        if each.moves
    ]
    lift, why = (float(np.mean(above)) if above else 0.0), "the joints that hold the wheels are below them"
    if abs(lift) < FLAT * spread and any(word in tree.root for word in ON_GROUND):
        lift, why = height, f"the wheels are below {tree.root}"
    if abs(lift) < FLAT * spread:
        turned = {joint.child for joint in wheels}
        mass, middle = mass_centre(tree, (link for link in tree.links if link not in turned), notes)
        radii = [radius[0] for joint in wheels if (radius := radius_of(tree, joint, notes)) is not None]
        deep = max(radii, default=math.inf)
        lift = min(middle - height + deep, 0.0) if mass > 0.0 else 0.0
        why = "the masses are below the ground otherwise"
    if lift < -FLAT * spread:
        message = f"the file is z down, as {why}: turned about x, so that y is left"
        notes.warn(message, f"the rover's frame is {tree.root}, turned the same way")
        return -1.0
    return 1.0


def _on_ground(tree: Tree, wheels: list[Joint], radii: dict[str, Radius | None], notes: Notes) -> list[Joint]:
    """Those that can touch one ground; a camera that tilts endlessly is none."""
    places = [tree.pose(joint)[1] for joint in wheels]
    sizes = [radius[0] for radius in radii.values() if radius is not None]
    usual = float(np.median(sizes)) if sizes else 0.0
    bottoms = [
        place[2] - (usual if (radius := radii[joint.name]) is None else radius[0])
        for joint, place in zip(wheels, places, strict=True)
    ]
    spread = float(np.ptp([place[:2] for place in places], axis=0).max())
    most = min(bottoms) + max(usual, LOW * spread, ROUNDING)
    kept = [joint for joint, bottom in zip(wheels, bottoms, strict=True) if bottom <= most]
    for joint in wheels:
        if joint not in kept:
            message = f"{joint.name} turns endlessly about a horizontal axis, but is far above the ground"
            notes.warn(message, "it is taken for no wheel", line=joint.line, key=joint.name)
    return kept


def _with_radii(
    tree: Tree,
    wheels: Sequence[Joint],
    radii: dict[str, Radius | None],
    given: float | None,
    notes: Notes,
) -> dict[str, Radius]:
    """The radius of every wheel, or the line that says how to give it."""
    if given is not None:
        return {joint.name: (given, "as given") for joint in wheels}
    lacking = [joint for joint in wheels if radii[joint.name] is None]
    known: dict[str, Radius] = {name: radius for name, radius in radii.items() if radius is not None}
    if not lacking:
        return known
    names = ", ".join(joint.name for joint in lacking)
    source = plugin_radius(tree)
    sizes = {known[joint.name][0] for joint in wheels if joint not in lacking}
    if source is None and len(sizes) == 1:
        source = sizes.pop(), "that of the other wheels"
        notes.warn(f"no shape tells the radius of {names}: taken as {source[0]:g} m, as the others'")
    footprint = [joint for joint in wheels if tree.pose(joint)[1][2] > 0.0]
    if source is None and any(word in tree.root for word in ON_GROUND) and len(footprint) == len(wheels):
        height = float(np.mean([tree.pose(joint)[1][2] for joint in wheels]))
        source = height, f"the height over {tree.root}"
        message = (
            f"no shape tells the radius of {names}: taken as {height:.4g} m, the height over {tree.root}"
        )
        notes.warn(message, "give wheel_radius, on the command line --wheel-radius, if that is wrong")
    if source is None:
        meshes = sorted(
            {
                str(mesh.get("filename"))
                for joint in lacking
                for mesh in tree.links[joint.child].element.iter("mesh")
            }
        )
        what = f"only meshes that are not beside the file ({meshes[0]})" if meshes else "no round shape"
        notes.fail(
            f"nothing tells the radius of {names}: {what}",
            "give wheel_radius, on the command line --wheel-radius",
            line=lacking[0].line,
            key=lacking[0].name,
        )
    return known | {joint.name: source for joint in lacking}


def _aligned(wheels: list[FoundWheel], notes: Notes) -> list[FoundWheel]:
    """Fixed axles that are parallel but for the rounding of the file, exactly so; others need rollers.

    Wheels whose numbers are noted are as they are noted.
    """
    fixed = [
        wheel
        for wheel in wheels
        if wheel.steering is None and wheel.roller_angle is None and wheel.noted_name is None
    ]
    banks: list[list[FoundWheel]] = []
    for wheel in fixed:
        bank = next((bank for bank in banks if abs(bank[0].heading - wheel.heading) < PARALLEL), None)
        banks.append([wheel]) if bank is None else bank.append(wheel)
    changed: dict[str, FoundWheel] = {}
    for bank in banks:
        headings = [wheel.heading for wheel in bank]
        if len(bank) > 1 and np.ptp(headings) > 0.0:
            mean = float(np.mean(headings))
            if np.ptp(headings) > ROUNDING:
                names = ", ".join(wheel.joint.name for wheel in bank)
                notes.warn(f"the axles of {names} differ by {np.ptp(headings):.2g} rad: taken as parallel")
            changed |= {wheel.joint.name: replace(wheel, heading=mean) for wheel in bank}
    if len(banks) > 2 or (len(banks) == 2 and len(fixed) > 3):
        names = ", ".join(wheel.joint.name for wheel in fixed)
        message = f"the fixed axles of {names} point in {len(banks)} directions: taken as omni wheels"
        notes.warn(message, "for others give a parameter file of kind: custom")
        changed |= {
            wheel.joint.name: replace(wheel, roller_angle=math.pi / 2)
            for bank in banks
            for wheel in (changed.get(each.joint.name, each) for each in bank)
        }
    return [changed.get(wheel.joint.name, wheel) for wheel in wheels]


def names_of(wheels: Sequence[FoundWheel], notes: Notes) -> list[str]:
    """A name for each: as the file notes them, by their places in rows of two, else those of the joints."""
    noted = [wheel.noted_name for wheel in wheels if wheel.noted_name is not None]
    if len({*noted}) == len(wheels):
        return noted
    rollers = {wheel.joint.name for wheel in wheels if wheel.castor}
    main = [wheel for wheel in wheels if wheel.joint.name not in rollers]
    axles = {2: [""], 4: ["front_", "rear_"], 6: ["front_", "middle_", "rear_"]}.get(len(main), [])
    lefts = sorted((wheel for wheel in main if wheel.centre[1] > 0.0), key=lambda wheel: -wheel.centre[0])
    rights = sorted((wheel for wheel in main if wheel.centre[1] < 0.0), key=lambda wheel: -wheel.centre[0])
    places: dict[str, str] = {}
    if axles and len(lefts) == len(rights) == len(axles):
        for axle, left, right in zip(axles, lefts, rights, strict=True):
            places |= {left.joint.name: f"{axle}left", right.joint.name: f"{axle}right"}
    for wheel in wheels:
        for joint in filter(None, (wheel.joint, wheel.steering)):
            _doubt(joint, wheel, places.get(wheel.joint.name), notes)
    return [places.get(wheel.joint.name, wheel.joint.name) for wheel in wheels]


def _doubt(joint: Joint, wheel: FoundWheel, place: str | None, notes: Notes) -> None:
    """A warning where a joint's name says another place than the geometry."""
    said = said_by(joint.name)
    if said is None:
        return
    axle, side = said
    x, y = wheel.centre[:2]
    if side is not None and ((side == "left") != (y > 0.0)) and abs(y) > ROUNDING:
        word, there = side, f"at y = {y:.4g} m, on the {'left' if y > 0 else 'right'}"
    elif axle is not None and place is not None and "_" in place and axle not in place:
        word, there = axle, f"the {place.replace('_', ' ')} one, at x = {x:.4g} m"
    else:
        return
    message = f"{joint.name} says {word}, but its wheel is {there}"
    notes.warn(message, "the geometry decides", line=joint.line, key=joint.name)
