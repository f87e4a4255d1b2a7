"""Radius of a wheel from its cylinders and spheres, its meshes, or other entries of the file."""

from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from six_wheel.kinematics.poses import Floats, rotations
from six_wheel.robot_description.urdf.elements import Notes, number, vector
from six_wheel.robot_description.urdf.tree import Joint, Tree

ALONG = 0.9  # cosine of the angle up to which a cylinder lies along the axle
Radius = tuple[float, str]  # a radius [m], and where it comes from


def radius_of(tree: Tree, joint: Joint, notes: Notes) -> Radius | None:
    """Of the wheel that a joint turns: its largest cylinder or sphere, those of the collision first, else its
    largest mesh. Links fixed to the wheel count, a tyre on a rim for one.
    """
    links, waiting = [], [joint.child]
    while waiting:
        links.append(link := waiting.pop())
        waiting += [each.child for each in tree.below.get(link, []) if each.type == "fixed"]
    for look in (_of_round, _of_mesh):
        for part in ("collision", "visual"):
            found = [
                radius
                for link in links
                for shape in tree.links[link].element.findall(part)
                for where in [part if link == joint.child else f"{part} of {link}"]
                if (radius := look(shape, tree, joint, link, where, notes)) is not None
            ]
            if found:
                return max(found)
    return None


def _of_round(
    shape: ElementTree.Element, tree: Tree, joint: Joint, link: str, where: str, notes: Notes
) -> Radius | None:
    for tag in ("cylinder", "sphere"):
        if (element := shape.find(f"geometry/{tag}")) is None:
            continue
        radius = number(element.get("radius", ""), f"the radius in the {where}", element, notes)
        turned = rotations(vector(shape.find("origin"), "rpy", link, notes))
        along = abs(float(turned[:, 2] @ _axle(tree, joint, link)))
        if radius > 0.0 and (tag == "sphere" or along >= ALONG):
            return radius, f"{tag} in the {where}"
    return None


def _axle(tree: Tree, joint: Joint, link: str) -> Floats:
    """The axle in the axes of a link that is fixed to the wheel."""
    if link == joint.child:
        return joint.axis
    return tree.pose(tree.above[link], joint)[0].T @ joint.axis


def _of_mesh(
    shape: ElementTree.Element, tree: Tree, joint: Joint, link: str, where: str, notes: Notes
) -> Radius | None:
    mesh = shape.find("geometry/mesh")
    file = None if mesh is None else mesh_file(mesh.get("filename", ""), tree.path)
    if mesh is None or file is None:
        return None
    try:
        from trimesh import load_mesh
    except ModuleNotFoundError as error:
        message = f"the mesh {file.name} needs {error.name} to tell a wheel's radius"
        notes.warn(message, 'pip install "six-wheel[urdf]"')
        return None
    try:
        points = np.array(load_mesh(file).vertices, dtype=np.float64)
    except Exception as error:  # every format has its own
        notes.warn(f"the mesh {file.name} cannot be read: {error}")
        return None
    if not points.size:
        return None
    scale = vector(mesh, "scale", link, notes, default=(1.0, 1.0, 1.0))
    origin = shape.find("origin")
    points = points * scale @ rotations(vector(origin, "rpy", link, notes)).T
    points = points + vector(origin, "xyz", link, notes)
    if link != joint.child:
        rotation, offset = tree.pose(tree.above[link], joint)
        points = points @ rotation.T + offset
    across = points - np.outer(points @ joint.axis, joint.axis)
    return float(np.linalg.norm(across, axis=1).max()), f"mesh {file.name} in the {where}"


def mesh_file(name: str, urdf: Path) -> Path | None:
    """The file that a mesh's name means, as far as it lies beside the description."""
    scheme, found, rest = name.rpartition("://")
    package, _, inner = rest.partition("/")
    if not found or scheme == "file":
        paths = [urdf.parent / rest, Path(rest)]
    else:
        above = [urdf.resolve().parent, *urdf.resolve().parents]
        paths = [each / inner for each in above if each.name == package]
        paths += [each / package / inner for each in above] + [urdf.parent / inner]
    for path in paths:
        try:
            if path.is_file():
                return path
        except OSError:  # a name that no file can have
            continue
    return None


def plugin_radius(tree: Tree) -> Radius | None:
    """Radius of the wheels [m] that a plugin for the simulation gives, and its source; None without one."""
    for plugin in tree.robot.iter("plugin"):
        for tag, factor in (("wheel_radius", 1.0), ("wheel_diameter", 0.5), ("wheelDiameter", 0.5)):
            for element in plugin.iter(tag):
                try:
                    radius = factor * float(element.text or "")
                except ValueError:
                    continue
                if 0.0 < radius < 1e3:
                    return radius, f"{tag} of the plugin {plugin.get('filename', '')}"
    return None


def mass_centre(tree: Tree, links: Iterator[str], notes: Notes) -> tuple[float, float]:
    """Mass of some links [kg], and its height in the root as the file has it [m]; 0 where nothing is said."""
    masses, heights = [], []
    for link in links:
        inertial = tree.links[link].element.find("inertial")
        mass = None if inertial is None else inertial.find("mass")
        if inertial is None or mass is None:
            continue
        centre = vector(inertial.find("origin"), "xyz", link, notes)
        if link in tree.above:
            rotation, origin = tree.pose(tree.above[link])
            centre = rotation @ centre + origin
        masses.append(number(mass.get("value", "0"), f"the mass of {link}", mass, notes))
        heights.append(float(centre[2]))
    total = float(np.sum(masses))
    return (total, float(np.dot(masses, heights)) / total) if total > 0.0 else (0.0, 0.0)
