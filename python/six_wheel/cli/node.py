"""`six-wheel node` and `six-wheel filter`: nodes of ROS 2, which take its arguments."""

from typing import TYPE_CHECKING, Literal

import typer

from six_wheel.cli.shared import AsOption, Chosen, NodeOption, RadiusOption, Reading, RoverArgument, choose

if TYPE_CHECKING:
    from six_wheel.onboard import Settings

PASSING = {"allow_extra_args": True, "ignore_unknown_options": True}


def node(
    context: typer.Context,
    rover: RoverArgument,
    node: NodeOption = None,
    as_: AsOption = None,
    wheel_radius: RadiusOption = None,
) -> None:
    raise typer.Exit(_run("node", context, choose(rover, Reading(node, as_, wheel_radius))))


def command_filter(
    context: typer.Context,
    rover: RoverArgument,
    node: NodeOption = None,
    as_: AsOption = None,
    wheel_radius: RadiusOption = None,
) -> None:
    raise typer.Exit(_run("filter", context, choose(rover, Reading(node, as_, wheel_radius))))


def _run(kind: Literal["node", "filter"], context: typer.Context, chosen: Chosen) -> int:
    arguments = list(context.args)
    if arguments and arguments[0] != "--ros-args":
        raise ValueError(f"arguments of ROS must follow --ros-args, got {arguments[0]}")
    from six_wheel.ros.loading import rclpy

    rclpy()  # what is missing should be said before anything else
    from six_wheel.ros.running import run

    return run(kind, settings_of(chosen), arguments)


def settings_of(chosen: Chosen) -> "Settings":
    """What a loop is told, from a parameter file or a preset."""
    from six_wheel.onboard import Settings

    if chosen.parameters is None:
        return Settings.of_rover(chosen.rover)
    return Settings.of_parameters(chosen.parameters)
