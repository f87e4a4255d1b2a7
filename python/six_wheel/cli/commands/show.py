"""`six-wheel show`: a rover from above, as it makes one motion; a map, its relief and slope."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from six_wheel.cli.map_options import MapReading
from six_wheel.cli.shared import (
    Reading,
    choose,
    choose_suspension,
    grid,
    new_console,
    warn,
)
from six_wheel.robot_description.named_rover import NamedRover

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from six_wheel._core import RockerBogie

Motion = tuple[float, float, float]
ROVERS = (".urdf", ".xacro", ".xml", ".json", ".toml", "")  # files that are no maps unless an option says so
SPEED = 0.5  # [m/s] of the motion that is drawn where none is given and no limit is lower


def show(
    rover: Annotated[
        str,
        typer.Argument(metavar="ROVER", help="Parameter file, URDF, name of a preset, or a map."),
    ],
    twist: Annotated[
        Motion | None,
        typer.Option(metavar="VX VY OMEGA", help="Motion to draw [m/s, m/s, rad/s]. Default: a left turn."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="Picture: .png, .svg or .pdf. Default: ROVER_from_above.png, ROVER_from_the_side.png, "
            "MAP_map.png",
        ),
    ] = None,
    side: Annotated[
        bool, typer.Option("--side", help="The suspension from the side instead, of a rocker-bogie.")
    ] = False,
    *,
    map_reading: MapReading,
    reading: Reading,
) -> None:
    is_drawn, path = not side and twist is None, Path(rover)
    if any(option is not None for option in map_reading) or (is_drawn and _is_map(path)):
        default, draw = f"{path.name.partition('.')[0]}_map.png", partial(_draw_map, path, map_reading)
    elif side:
        suspension, name = choose_suspension(rover, reading)
        default, draw = f"{name}_from_the_side.png", partial(_draw_side, suspension, name)
    else:
        chosen = choose(rover, reading)
        default, draw = f"{chosen.name}_from_above.png", partial(_draw_above, chosen, twist)
    from six_wheel.plotting.saving import picture_path, save

    target = picture_path(output or Path(default))
    save(draw(), target)
    print(target.resolve())


def _is_map(path: Path) -> bool:
    """True for files that are no descriptions of a rover: by their suffix, a YAML file by its first key."""
    if not path.exists():
        return path.suffix.lower() not in (*ROVERS, ".yaml", ".yml")
    if path.suffix.lower() in (".yaml", ".yml"):
        with path.open(encoding="utf-8", errors="replace") as file:
            return any(line.startswith(("map:", "image:")) for line in file)
    if path.suffix.lower() == ".xml":  # of PDS 4
        return "Product_Observational" in path.read_text(errors="replace")
    return path.is_dir() or path.suffix.lower() not in ROVERS


def _draw_map(path: Path, reading: MapReading) -> "Figure":
    """A map, with what it seems to be on the console."""
    import warnings

    from six_wheel.cli.report.map import map_facts
    from six_wheel.maps.reading import describe, read_with
    from six_wheel.plotting.ground.map import map_figure

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ground = read_with(path, reading.options())
    warn([warning.message for warning in caught])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        facts = map_facts(ground, describe(path, reading.options()))
    new_console().print(grid(facts))
    return map_figure(ground, title=path.name, facts=facts)


def _draw_side(suspension: "RockerBogie", name: str) -> "Figure":
    from six_wheel.plotting.ground.side import side_figure

    return side_figure(suspension, title=name)


def _draw_above(chosen: NamedRover, twist: Motion | None) -> "Figure":
    """A rover as it makes a motion, with a warning of each limit of its file that the motion exceeds."""
    from six_wheel.plotting.twist import show_figure

    if twist is not None:
        warn(
            [
                f"{name} is {value:.4g} {unit}, {limit:g} allowed"
                for name, value, limit, unit in _demands(chosen, twist)
                if value > limit * (1.0 + 1e-9)
            ]
        )
    return show_figure(chosen.rover, twist or left_turn(chosen), title=chosen.name)


def left_turn(chosen: NamedRover) -> Motion:
    """Forward around a centre to the left that this rover can turn about, within the limits of its file."""
    rover = chosen.rover
    size = max(max(abs(wheel.x), abs(wheel.y)) for wheel in rover.wheels)
    # Unsteered wheels may hold the centre on a line beside the origin: the projection puts it there.
    turn = rover.project((SPEED, 0.0, SPEED / max(2.0 * size, 1.2 * rover.min_radius)))
    demands = _demands(chosen, tuple(turn))
    share = min([1.0, *(limit / value for _, value, limit, _ in demands if value > 0.0)])
    vx, vy, omega = (share * turn).tolist()
    return vx, vy, omega


def _demands(chosen: NamedRover, motion: tuple[float, ...]) -> list[tuple[str, float, float, str]]:
    """Name, value, limit and unit of what a motion asks; nothing for a rover without limits."""
    limits = chosen.limits
    vx, vy, omega = motion
    _, speeds = chosen.rover.inverse(motion)
    return [
        ("wheel_speed", float(abs(speeds).max()), limits.wheel_speed, "rad/s"),
        ("speed", float((vx**2 + vy**2) ** 0.5), limits.speed, "m/s"),
        ("yaw_rate", abs(omega), limits.yaw_rate, "rad/s"),
    ]
