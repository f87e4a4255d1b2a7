"""The picture of the architecture: floors of the crates and of the package, as their manifests say."""

import tomllib
from graphlib import TopologicalSorter
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from six_wheel.plotting.drawing import AXLE, INK, MOTION, SOFT, new_figure

ROOT = Path(__file__).parents[1]
# One line for every box: crates first, then rooms of the package.
WORDS = {
    "numerics": "lanes, polynomials, small matrices, errors",
    "kinematics": "wheel equation, inverse, forward, projection",
    "odometry": "steps, noise, late poses",
    "control": "limits, controller, profiles",
    "four_axle": "brakes, sequences",
    "terrain": "heights, settled poses",
    "ground_motion": "rates, traction, odometry in space",
    "planner": "rollouts, costs",
    "python": "arrays, names, errors: six_wheel._core",
    "kinematics ": "what users import",
    "reference": "the oracle, plain NumPy",
    "robot_description": "parameter files, URDF",
    "parallel": "many items",
    "logs": "readers, records",
    "maps": "ground from files",
    "log_odometry": "logs to tracks",
    "simulation": "commands to logs",
    "calibration": "dimensions and noise from logs",
    "control_loop": "the loop on a rover, ROS 2",
    "plotting": "a picture of any result",
    "view": "a rover in the browser",
    "cli": "six-wheel",
}


def crates() -> list[list[str]]:
    """Crates floor by floor, the lowest first: each above all that it depends on."""
    above: dict[str, set[str]] = {}
    manifests = {path.parent.name: path for path in (ROOT / "rust").glob("*/Cargo.toml")}
    del manifests["fuzz"]
    for crate, manifest in manifests.items():
        needs = tomllib.loads(manifest.read_text(encoding="utf-8"))["dependencies"]
        above[crate] = {
            name.removeprefix("six-wheel-").replace("-", "_") for name in needs
        } & manifests.keys()
    sorter = TopologicalSorter(above)
    sorter.prepare()
    floors = []
    while sorter.is_active():
        floors.append(sorted(sorter.get_ready()))
        sorter.done(*floors[-1])
    return floors


def rooms() -> list[list[str]]:
    """Rooms of the package floor by floor, the lowest first."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    [layers] = (one["layers"] for one in project["tool"]["importlinter"]["contracts"] if "layers" in one)
    return [floor.split(" | ") for floor in reversed(layers) if floor != "__main__"]


def figure() -> Figure:
    """Every crate and every room as a box; imports go down, from floor to floor."""
    low, high = crates(), rooms()
    high[0] = [
        "kinematics " if name == "kinematics" else name for name in high[0]
    ]  # a crate has that name too
    drawn = new_figure(7.2, 6.0)
    axis = drawn.subplots()
    axis.axis("off")
    axis.set(xlim=(0.0, 7.2), ylim=(-0.1, 6.0))
    height = 5.7 / (len(low) + len(high))
    for level, floor in enumerate([*low, *high]):
        bottom = level * height + (0.12 if level >= len(low) else 0.0)
        width = 6.1 / len(floor)
        for k, name in enumerate(floor):
            colour = AXLE if level < len(low) else MOTION
            left = 1.0 + k * width
            box = FancyBboxPatch((left + 0.06, bottom + 0.06), width - 0.12, height - 0.12)
            box.set(boxstyle="round,pad=0,rounding_size=0.05", facecolor=colour, edgecolor=colour, alpha=0.18)
            axis.add_patch(box)
            middle = left + width / 2.0
            title = {"size": 8.5, "color": INK, "weight": "bold", "ha": "center"}
            axis.text(middle, bottom + 0.56 * height, name.strip(), **title)
            axis.text(middle, bottom + 0.24 * height, WORDS[name], size=6.3, color=SOFT, ha="center")
    for text, floors, first in (("Rust\ncrates", low, 0), ("Python\nrooms", high, len(low))):
        centre = (first + len(floors) / 2.0) * height
        axis.text(0.5, centre, text, size=9, color=INK, ha="center", va="center")
    return drawn
