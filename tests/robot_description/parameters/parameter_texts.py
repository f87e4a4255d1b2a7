"""Texts of parameter files of one rover, as teams write them."""

from pathlib import Path

from tests.rovers import SIX_WHEELS as ROVER

DATA = Path(__file__).parent / "data"
WHEELS = ROVER.wheel_names
STEERED = ROVER.steered_wheel_names


def ros(traction: object = None, steering: object = None, *, extra: str = "", **changes: object) -> str:
    """A parameter file: the node on line 1, the joints on 3 and 4, d1 .. d4 on 5 .. 8, wheel_radius on 9."""
    values: dict[str, object] = {
        "traction_joints": traction or [f"{wheel}_wheel" for wheel in WHEELS],
        "steering_joints": steering or [f"{wheel}_steer" for wheel in STEERED],
    }
    values |= {"d1": 0.4, "d2": 0.5, "d3": 0.5, "d4": 0.45, "wheel_radius": 0.15} | changes
    lines = [f"    {key}: {value}" for key, value in values.items() if value is not ...]
    return "\n".join(["rover:", "  ros__parameters:", *lines, extra])
