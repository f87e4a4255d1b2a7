"""Commands of the control loop: `six-wheel node` and `filter`, which take arguments of ROS, and `replay`."""

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from six_wheel.cli.shared import (
    Reading,
    choose,
    grid,
    new_console,
    progress_bar,
    several,
    text_table,
    warn,
)
from six_wheel.robot_description.missing_files import no_file
from six_wheel.robot_description.named_rover import NamedRover

if TYPE_CHECKING:
    from six_wheel.control_loop import Settings
    from six_wheel.control_loop.replay import Difference

OptionalRover = Annotated[
    str | None,
    typer.Argument(
        metavar="[ROVER]",
        help="Parameter file, URDF or xacro file, or the name of a preset. Without it the parameter rover or "
        "robot_description says it, or the topic robot_description. --ros-args and what follows is for ROS.",
    ),
]
PASSING = {"allow_extra_args": True}  # those after --ros-args


def node(
    context: typer.Context,
    rover: OptionalRover = None,
    *,
    reading: Reading,
) -> None:
    raise typer.Exit(_run("node", context, rover, reading))


def command_filter(
    context: typer.Context,
    rover: OptionalRover = None,
    *,
    reading: Reading,
) -> None:
    raise typer.Exit(_run("filter", context, rover, reading))


def _run(kind: Literal["node", "filter"], context: typer.Context, rover: str | None, reading: Reading) -> int:
    arguments = list(context.args)
    if rover == "--ros-args":  # there is no ROVER
        rover, arguments = None, ["--ros-args", *arguments]
    chosen = None if rover is None else choose(rover, reading)
    if arguments and arguments[0] != "--ros-args":
        raise ValueError(f"arguments of ROS must follow --ros-args, got {arguments[0]}")
    from six_wheel.control_loop.ros2.loading import rclpy

    rclpy()  # a missing package is reported before anything else
    from six_wheel.control_loop.ros2.running import run

    def load(given: str, is_description: bool) -> "Settings":
        if not is_description:
            return settings_of(choose(given, reading))
        from six_wheel.robot_description.urdf.read import parse_urdf

        path = Path("robot_description")
        robot = parse_urdf(given, path, wheel_radius=reading.wheel_radius)
        return settings_of(NamedRover(robot.rover, robot.name, path, robot=robot))

    return run(kind, None if chosen is None else settings_of(chosen), arguments, load)


def settings_of(chosen: NamedRover) -> "Settings":
    """Settings of a loop, from a parameter file or a preset."""
    from six_wheel.control_loop import Settings

    if chosen.parameters is not None:
        return Settings.of_parameters(chosen.parameters)
    frame = "base_link" if chosen.robot is None else chosen.robot.base_frame_id
    return Settings.of_rover(chosen.rover, limits=chosen.limits, base_frame_id=frame)


def replay(
    record: Annotated[Path, typer.Argument(metavar="RECORD", help="Record of a node, .mcap.")],
    change: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=VALUE", help="Another value for a key of the parameter file: limits.speed=0.3."
        ),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Record of the new run, .mcap.")
    ] = None,
    plot: Annotated[Path | None, typer.Option(help="Picture of both runs: .png, .svg or .pdf.")] = None,
) -> None:
    changes = _changes(several(change, "="))
    from six_wheel.control_loop.replay import compare
    from six_wheel.control_loop.replay import replay as run_again
    from six_wheel.kinematics.objects.whole_files import replacing

    if not record.is_file():
        raise ValueError(no_file(record))
    if output is not None and output.suffix.lower() != ".mcap":
        raise ValueError(f'{output}: the ending of a record must be .mcap, got "{output.suffix}"')
    with contextlib.ExitStack() as stack:
        progress = stack.enter_context(progress_bar(f"replaying {record.name}"))
        picture = None
        if plot is not None:
            from six_wheel.plotting.saving import picture_path

            picture = stack.enter_context(replacing(picture_path(plot), [record]))
        target = None if output is None else stack.enter_context(replacing(output, [record]))
        result = run_again(record, changes, target, progress=progress)
        if picture is not None:
            from six_wheel.plotting.replay import replay_figure
            from six_wheel.plotting.saving import render

            render(replay_figure(result, title=record.name), picture)
    warn(result.warnings)
    difference = compare(result)
    console = new_console()
    console.print(text_table(("", "recorded", "again"), difference.rows))
    written = [("record", output), ("picture", plot)]
    console.print(grid([*_verdict(difference, bool(changes)), *written]))


def _changes(given: list[str]) -> dict[str, Any]:
    changes: dict[str, Any] = {}
    for text in given:
        key, equals, value = text.partition("=")
        if not (key.strip() and equals and value.strip()):
            raise ValueError(f'change must be KEY=VALUE, such as "limits.speed=0.3", got "{text}"')
        from six_wheel.control_loop.settings import read_value

        changes[key.strip()] = read_value(value.strip())
    return changes


def _verdict(difference: "Difference", changed: bool) -> list[tuple[str, object]]:
    """Differences between the runs, as rows for `grid`."""
    if difference.same_bits:
        meant = ", in spite of the changes" if changed else ""
        return [("commands", f"the same bits in all {difference.common:,} steps{meant}")]
    if difference.first is None:
        return [("commands", f"the same in all {difference.common:,} steps that both have")]
    return [
        ("commands", f"differ in {difference.differing:,} of {difference.common:,} steps"),
        ("for the first time", f"{difference.first:.3f} s after the first command"),
        ("speed", f"by up to {difference.twist:.4g} m/s"),
        ("steering angles", f"by up to {difference.steering:.4g} rad"),
        ("wheel speeds", f"by up to {difference.wheel_speeds:.4g} rad/s"),
    ]
