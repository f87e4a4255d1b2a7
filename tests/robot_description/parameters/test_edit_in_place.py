"""Parameter files with the numbers of another rover: the keys that can say it, comments and order kept."""

import re
from pathlib import Path

import pytest

pytest.importorskip("yaml")
pytest.importorskip("pydantic")

import six_wheel as sw
from six_wheel.robot_description.parameters import ParameterFileError, parse_parameters, read_parameters
from six_wheel.robot_description.parameters.edit_in_place import text_for
from six_wheel.robot_description.wheels_of_rover import with_wheels

ROOT = Path(__file__).parents[3]
MISTAKEN = ("five_mistakes",)
FILES = sorted(
    path
    for folder in (ROOT / "examples", Path(__file__).parent / "data")
    for path in folder.glob("*.yaml")
    if path.stem not in MISTAKEN
)
TWO = "kind: differential\n"
HALVES = "wheelbase: 1.0\ntrack_width: 0.5\n"
CHANGES = {
    "radius": lambda wheel: {"radius": 1.01 * wheel.radius},
    "track": lambda wheel: {"y": 1.02 * wheel.y},
    "wheelbase": lambda wheel: {"x": 0.97 * wheel.x},
    "sides": lambda wheel: {"radius": wheel.radius * (1.01 if wheel.y > 0 else 0.98)},
    "heading": lambda wheel: {"heading": wheel.heading + 0.01},
    "icr": lambda wheel: {"scrub": wheel.scrub + (0.02 if wheel.y > 0 else -0.02)},
    "rollers": lambda wheel: {"roller_angle": wheel.roller_angle and wheel.roller_angle + 0.01},
}


def numbers(rover: sw.Rover) -> list[float]:
    names = ("x", "y", "radius", "heading", "scrub", "trail", "roller_angle")
    return [getattr(wheel, name) or 0.0 for wheel in rover.wheels for name in names]


def skeleton(text: str) -> str:
    """A file without its numbers, without keys that were added, and one radius for a pair of them."""
    text = re.sub(r"[-+]?(\d+\.?\d*|\.\d+)(e-?\d+)?", "0", text)
    return re.sub(r"\n.*icr_\w+: 0.*", "", text.replace("[0, 0]", "0"))


def write(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "rover.yaml"
    path.write_text(text)
    return path


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_what_is_written_is_read_as_the_rover(path: Path, change: str) -> None:
    parameters = read_parameters(path)
    rover = with_wheels(parameters.rover, map(CHANGES[change], parameters.rover.wheels))
    text = text_for(rover, parameters)
    again = parse_parameters(text, node=parameters.node)
    assert again.rover.traction_joints == rover.traction_joints
    assert again.rover.steering_joints == rover.steering_joints
    # A key that is a product of two may come back one rounding off.
    assert numbers(again.rover) == pytest.approx(numbers(rover), rel=1e-12, abs=1e-12)
    for name in (
        "odom_frame_id",
        "base_frame_id",
        "limits",
        "control",
        "noise",
        "wheel_encoders",
        "odometry",
    ):
        assert getattr(again, name) == getattr(parameters, name)
    if again.kind == parameters.kind != "custom":  # then it is the same text but for numbers
        assert skeleton(text) == skeleton(path.read_text())


@pytest.mark.parametrize(
    ("keys", "change", "line"),
    [
        (f"{TWO}track_width: 0.4 # tape\nwheel_radius: 0.1\n", "track", "track_width: 0.408 # tape"),
        (f"{TWO}track_width: 0.4\nwheel_radius: 0.1\n", "sides", "wheel_radius: [0.101, 0.098]"),
        (f"{TWO}wheel_radius: 0.1\ntrack_width: 0.4\n", "icr", "icr_left: 0.22"),
        ("kind: bicycle\nwheelbase: 2\nwheel_radius: 0.1\n", "wheelbase", "wheelbase: 1.94"),
        ("{d1: 0.5, d2: 0.5, d3: 0.5, d4: 0.5, wheel_radius: 0.1}\n", "radius", "wheel_radius: 0.101}"),
        (f"kind: mecanum\n{HALVES}wheel_radius: 0.1\n", "track", "track_width: 0.51"),
    ],
)  # fmt: skip
def test_the_key_that_says_it_is_changed(tmp_path: Path, keys: str, change: str, line: str) -> None:
    parameters = read_parameters(write(tmp_path, f"# ours\n{keys}"))
    text = text_for(with_wheels(parameters.rover, map(CHANGES[change], parameters.rover.wheels)), parameters)
    assert text.startswith("# ours\n")
    assert line in re.sub(r"(\.\d*?[1-9])0{6,}\d*|(\.\d+?)9{6,}\d*", lambda m: m[1] or m[2], text)


def test_a_multiplier_is_left_alone_where_a_length_can_say_it(tmp_path: Path) -> None:
    path = Path(__file__).parent / "data" / "diff_drive_controller.yaml"
    parameters = read_parameters(path)
    rover = with_wheels(parameters.rover, map(CHANGES["radius"], parameters.rover.wheels))
    pairs = zip(path.read_text().splitlines(), text_for(rover, parameters).splitlines(), strict=True)
    assert [old.split(":")[0].strip() for old, new in pairs if old != new] == ["wheel_radius"]


def test_what_the_keys_cannot_say_becomes_custom_with_the_rest_of_the_file(tmp_path: Path) -> None:
    text = """\
base:
  ros__parameters:
    kind: ackermann
    wheelbase: 1.0
    track_width: 0.6
    wheel_radius: 0.1
    odom_frame_id: world
    limits: {speed: 1.5}
    noise: {slip: 0.02}
"""
    parameters = read_parameters(write(tmp_path, text))
    rover = with_wheels(parameters.rover, map(CHANGES["heading"], parameters.rover.wheels))
    again = parse_parameters(text_for(rover, parameters))
    assert (again.rover, again.kind, again.node) == (rover, "custom", "base")
    assert again.odom_frame_id == "world"
    assert (again.limits, again.noise) == (sw.Limits(speed=1.5), {"slip": 0.02})


@pytest.mark.parametrize("given", ["", "wheel_encoders: {gear_ratio: 2.0}\n"])
def test_factors_of_the_readings_are_written(tmp_path: Path, given: str) -> None:
    keys = f"kind: bicycle\nwheelbase: 1.0 # m\nwheel_radius: 0.1\n{given}"
    parameters = read_parameters(write(tmp_path, keys))
    factors = parameters.wheel_encoders | {"scale": 1.02, "steering_gain": {"front": 0.97}}
    text = text_for(parameters.rover, parameters, {"wheel_encoders": factors})
    again = parse_parameters(text)
    assert (again.rover, again.wheel_encoders) == (parameters.rover, factors)
    assert "# m" in text


def test_remarks_are_comments_and_a_preset_needs_no_file() -> None:
    rover = sw.Rover.preset("perseverance")
    text = text_for(rover, remarks=["made by hand", "twice"])
    assert text.startswith("# made by hand\n# twice\n")
    assert parse_parameters(text).rover == rover


def test_an_unchanged_rover_leaves_the_file_as_it_is(tmp_path: Path) -> None:
    for path in FILES:
        try:
            parameters = read_parameters(path)
        except ParameterFileError:
            continue
        assert text_for(parameters.rover, parameters) == path.read_text(encoding="utf-8-sig"), path.name


@pytest.mark.parametrize("where", ["flat", "nested"])
def test_four_wheels_without_a_wheelbase_stay_the_file_of_their_controller(tmp_path, where):
    limit = {
        "flat": "    linear.x.max_velocity: 1.0\n",
        "nested": "    linear:\n      x:\n        max_velocity: 1.0\n",
    }
    path = tmp_path / "skid.yaml"
    path.write_text(
        "base: # ours\n  ros__parameters:\n" + limit[where] + "    left_wheel_names: [fl, rl]\n"
        "    right_wheel_names: [fr, rr]\n    wheel_separation: 0.5 # measured\n    wheel_radius: 0.1\n"
    )
    parameters = read_parameters(path)
    wider = with_wheels(parameters.rover, [{"y": 1.1 * wheel.y} for wheel in parameters.rover.wheels])
    text = text_for(wider, parameters)
    assert "wheel_separation: 0.55" in text
    assert "wheelbase: 0.5" in text
    assert "# ours" in text
    assert "# measured" in text
    assert "kind" not in text
