"""Shapes of a robot description, each below the frame that moves it."""

from __future__ import annotations  # trimesh is loaded for a mesh

from typing import TypeAlias

from six_wheel.view.motion import Motion
from six_wheel.view.scene.shapes import Mesh
from six_wheel.view.subject import Subject

__all__ = ["robot_meshes"]

Drawn: TypeAlias = dict[str, list[tuple[Mesh, tuple[int, int, int]]]]


def robot_meshes(subject: Subject, motion: Motion) -> tuple[Drawn, list[str]]:
    """Meshes and colours by frame, and a line for each that is missing; none without a description."""
    return {}, []
