"""Light, sky, floor and cameras."""

from __future__ import annotations  # viser is loaded when a scene is made

from typing import TYPE_CHECKING, Any

import numpy as np

from six_wheel.kinematics.poses import Floats
from six_wheel.view.scene.shapes import about_z, nice_step

if TYPE_CHECKING:
    import viser

# Places of a camera and of what it looks at, in the axes of the rover and in sizes of it.
CAMERAS = {
    "Free": ((1.6, -1.12, 1.1), (0.1, 0.33, 0.12)),
    "Chase": ((-1.7, 0.05, 1.0), (0.5, -0.1, 0.1)),
    "Above": ((-0.02, -0.15, 3.0), (0.0, -0.15, 0.0)),
    "Side": ((-0.1, -2.0, 0.45), (-0.1, 0.0, 0.25)),
}
FARTHER, LOWER = 1.5, 1.5  # of a telephone, whose lower part is covered: distance; sizes below the rover


def set_stage(server: viser.ViserServer, size: float, dark: bool) -> dict[str, Any]:
    """Light the scene by a sun with a shadow and by the sky; returns the nodes that are there."""
    scene = server.scene
    scene.configure_default_lights(enabled=False)
    # until one is decoded the canvas is dark: seconds with software rendering
    scene.configure_environment_map(None)
    scene.add_light_directional(
        "/light/sun", color=(255, 244, 230), intensity=3.2, cast_shadow=True,
        position=(2.0 * size, 1.7 * size, 3.0 * size),
    )  # fmt: skip
    scene.add_light_hemisphere(
        "/light/sky", sky_color=(205, 215, 255), ground_color=(110, 84, 70), intensity=1.9 if dark else 2.3
    )
    server.gui.configure_theme(
        dark_mode=dark,
        show_logo=False,
        show_share_button=False,
        brand_color=(190, 85, 52),
        control_width="medium",
    )
    step = nice_step(size / 2.0)
    world = scene.add_frame("/world", show_axes=False)
    grid = scene.add_grid(
        "/world/floor", width=40.0 * size, height=40.0 * size, infinite_grid=True, cell_size=step / 5.0,
        section_size=step, cell_color=(70, 70, 74) if dark else (214, 214, 218),
        section_color=(110, 110, 116) if dark else (170, 170, 176), fade_distance=14.0 * size,
        shadow_opacity=0.35, plane_color=(58, 58, 62) if dark else (238, 236, 232), plane_opacity=1.0,
    )  # fmt: skip
    return {"floor": grid, "world": world}


def camera_of(name: str, size: float, transform: Floats, narrow: bool = False) -> tuple[Floats, Floats]:
    """Place of a camera and the point it looks at (3,) [m]; narrow screens have the rover on top."""
    offset, target = (np.array(each) * size for each in CAMERAS[name])
    yaw = np.arctan2(transform[1, 0], transform[0, 0])
    turn = about_z(float(yaw))
    if narrow:
        offset, target = FARTHER * offset, target - np.array([0.0, 0.0, LOWER * size])
    return transform[:3, 3] + turn @ offset, transform[:3, 3] + turn @ target
