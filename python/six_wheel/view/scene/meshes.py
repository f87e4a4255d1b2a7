"""Shapes of a robot description, each below the frame that moves it."""

from __future__ import annotations  # trimesh is loaded for a mesh

from typing import TypeAlias
from xml.etree import ElementTree

import numpy as np

from six_wheel.kinematics.poses import Floats, rotations
from six_wheel.robot_description.urdf.elements import Notes, number, vector
from six_wheel.robot_description.urdf.shapes import mesh_file
from six_wheel.robot_description.urdf.tree import Tree
from six_wheel.view.motion import Motion
from six_wheel.view.scene import shapes
from six_wheel.view.scene.shapes import Mesh
from six_wheel.view.subject import Subject

Color: TypeAlias = tuple[int, int, int]
Drawn: TypeAlias = dict[str, list[tuple[Mesh, Color]]]
GREY: Color = (150, 148, 156)
RING = 24  # sides of a cylinder
MOST = 400_000  # vertices that a browser draws at ease


def robot_meshes(subject: Subject, motion: Motion) -> tuple[Drawn, list[str]]:
    """Meshes and colours by the frame that moves them, and a line for every one that is missing.

    Nothing is drawn where the description has no shapes: then the rover is drawn as any other.
    """
    robot = subject.robot
    if robot is None or robot.tree is None:
        return {}, []
    tree, notes = robot.tree, Notes(robot.path)
    frames = _frames_at_zero(subject, motion)
    owners = _owners(subject)
    centres = np.stack([found.centre for found in robot.wheels.values()])
    wheels = np.stack([frames[f"wheel_{k}"][:3, 3] for k in range(len(centres))])
    offset = (wheels - centres).mean(axis=0)
    drawn: Drawn = {}
    count = 0
    for link in tree.links.values():
        frame, rotation, origin = "body", np.diag([1.0, tree.up, tree.up]), np.zeros(3)
        if (joint := tree.above.get(link.name)) is not None:
            rotation, origin = tree.pose(joint)
            frame = next(
                (owners[each.name] for each in tree.chain(joint)[::-1] if each.name in owners), "body"
            )
        inside: Floats = np.linalg.inv(frames[frame]).astype(np.float64)
        for mesh, color in _shapes_of(tree, link.name, notes):
            placed = shapes.move(shapes.move(mesh, rotation, origin + offset), inside[:3, :3], inside[:3, 3])
            count += len(placed.vertices)
            if count <= MOST:
                drawn.setdefault(frame, []).append((placed, color))
    messages = list(dict.fromkeys(finding.message for finding in notes.warnings))
    others = f"; and {len(messages) - 1} more" if len(messages) > 1 else ""
    remarks = [f"{messages[0]}{others}"] if messages else []
    if count > MOST:
        remarks.append(f"{count:,} vertices: what is more than {MOST:,} is left out")
    return drawn, remarks


def _frames_at_zero(subject: Subject, motion: Motion) -> dict[str, Floats]:
    """Frames in the body with every joint at 0, as the description has them."""
    frames: dict[str, Floats] = {"body": np.eye(4)}
    straight = motion.straight
    if subject.suspension is not None:
        found = subject.suspension.frames((0.0, 0.0, 0.0))
        frames |= found
        straight = np.stack([found[f"A{k + 1}"] for k in range(len(straight))])
    for k, frame in enumerate(straight):
        frames[f"wheel_{k}"] = frames[f"knuckle_{k}"] = frame
    return frames


def _owners(subject: Subject) -> dict[str, str]:
    """Joint to the frame of what it moves."""
    robot, suspension = subject.robot, subject.suspension
    assert robot is not None
    owners: dict[str, str] = {}
    if robot.suspension is not None and suspension is not None:
        for place, joint in robot.suspension.joints.items():
            left = place.endswith("left")
            name = "rho" if place.startswith("rocker") else ("beta_1" if left else "beta_2")
            sign = 1.0 if left or name != "rho" else -1.0
            found = [link.frame for link in suspension.links if link.joint == name and link.sign == sign]
            owners |= {joint: found[0]} if found else {}
    for k, wheel in enumerate(robot.wheels.values()):
        owners[wheel.joint.name] = f"wheel_{k}"
        if wheel.steering is not None and not wheel.castor:
            owners[wheel.steering.name] = f"knuckle_{k}"
    return owners


def _shapes_of(tree: Tree, link: str, notes: Notes) -> list[tuple[Mesh, Color]]:
    """The visual meshes of a link, or its shapes for collisions where they are missing."""
    element = tree.links[link].element
    found: list[tuple[Mesh, Color]] = []
    for part in ("visual", "collision"):
        for shape in element.findall(part):
            mesh = _shape(shape, tree, link, notes)
            if mesh is not None and len(mesh.faces):
                turned = rotations(vector(shape.find("origin"), "rpy", link, notes))
                placed = shapes.move(mesh, turned, vector(shape.find("origin"), "xyz", link, notes))
                found.append((placed, _color(shape, tree)))
        if found or element.find("visual") is None:
            break  # a link that is not seen stays so
    return found


def _shape(shape: ElementTree.Element, tree: Tree, link: str, notes: Notes) -> Mesh | None:
    geometry = shape.find("geometry")
    for element in () if geometry is None else geometry:
        if element.tag == "box":
            return shapes.box(vector(element, "size", link, notes).tolist())
        if element.tag == "cylinder":
            half = number(element.get("length", ""), f"the length in {link}", element, notes) / 2.0
            radius = number(element.get("radius", ""), f"the radius in {link}", element, notes)
            return shapes.cylinder((0.0, 0.0, -half), (0.0, 0.0, half), radius, RING) if half > 0.0 else None
        if element.tag == "sphere":
            import trimesh

            radius = number(element.get("radius", ""), f"the radius in {link}", element, notes)
            ball = trimesh.creation.uv_sphere(radius, count=[RING // 2, RING])
            return Mesh(np.array(ball.vertices), np.array(ball.faces))
        if element.tag == "mesh":
            return _mesh(element, tree, link, notes)
    return None


def _mesh(element: ElementTree.Element, tree: Tree, link: str, notes: Notes) -> Mesh | None:
    name = element.get("filename", "")
    file = mesh_file(name, tree.path)
    if file is None:
        notes.warn(f"the mesh {name} is missing: its shape for collisions is drawn, if it has one")
        return None
    import trimesh

    try:
        loaded = trimesh.load_mesh(file)
        vertices, faces = np.array(loaded.vertices, dtype=np.float64), np.array(loaded.faces)
    except Exception as error:  # every format has its own
        notes.warn(f"the mesh {file.name} cannot be read: {error}")
        return None
    scale = vector(element, "scale", link, notes, default=(1.0, 1.0, 1.0))
    return Mesh(vertices * scale, faces)


def _color(shape: ElementTree.Element, tree: Tree) -> Color:
    """The colour of its material, by itself or by the name of one of the robot."""
    material = shape.find("material")
    if material is None:
        return GREY
    named = tree.robot.findall(f"material[@name='{material.get('name', '')}']")
    for each in (material, *named):
        color = each.find("color")
        text = "" if color is None else color.get("rgba", "")
        try:
            red, green, blue = (round(255 * min(max(float(part), 0.0), 1.0)) for part in text.split()[:3])
        except ValueError:
            continue
        return red, green, blue
    return GREY
