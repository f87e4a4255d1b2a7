"""The commands of `six-wheel`: arguments in, files and tables out, one line for whatever is wrong.

Only typer is imported here: ``six-wheel drive --help`` need not wait for NumPy, Arrow or matplotlib.
"""

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from six_wheel.cli.calibrate import calibrate
from six_wheel.cli.check import abilities, derived_table, draw_limits, plan, wheels_table
from six_wheel.cli.drive import drive
from six_wheel.cli.node import PASSING, command_filter, node
from six_wheel.cli.odometry import odometry
from six_wheel.cli.replay import replay
from six_wheel.cli.shared import (
    AsOption,
    NodeOption,
    RadiusOption,
    Reading,
    RoverArgument,
    choose,
    choose_suspension,
    grid,
    new_console,
    progress_bar,
)
from six_wheel.cli.words import COMMANDS, INSTALL, PROGRAM, PURPOSE

if TYPE_CHECKING:
    from six_wheel._core import Rover

EXTRA_MODULES = ("matplotlib", "pyarrow", "pydantic", "rich", "yaml")
HELP_OPTIONS = ["-h", "--help"]

app = typer.Typer(
    help=PURPOSE,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": HELP_OPTIONS},
)


@app.command(help=COMMANDS["demo"])
def demo(
    output: Annotated[
        Path, typer.Option("-o", "--output", help="Folder for the pictures and tables.")
    ] = Path("six_wheel_demo"),
) -> None:
    from six_wheel.demo import run

    run(output, console=new_console())


@app.command(help=COMMANDS["check"])
def check(
    rover: RoverArgument,
    node: NodeOption = None,
    as_: AsOption = None,
    wheel_radius: RadiusOption = None,
    plot: Annotated[
        Path | None,
        typer.Option(help="Picture of what the limits leave, and which one binds where: .png, .svg or .pdf."),
    ] = None,
) -> None:
    try:
        chosen = choose(rover, Reading(node, as_, wheel_radius))
    except ValueError as error:
        findings = getattr(error, "findings", None)
        if not findings:
            raise
        print(*findings, sep="\n", file=sys.stderr)
        raise typer.Exit(2) from None
    console = new_console()
    if chosen.warnings:
        print(*chosen.warnings, sep="\n", file=sys.stderr)
    if plot is not None:
        draw_limits(chosen, plot)
    console.print(plan(chosen.rover))
    console.print(wheels_table(chosen))
    if chosen.robot is not None:
        console.print(derived_table(chosen.robot))
    console.print(grid([*abilities(chosen), ("picture", plot)]))


app.command(help=COMMANDS["drive"])(drive)
app.command(help=COMMANDS["odometry"])(odometry)
app.command(help=COMMANDS["calibrate"])(calibrate)
app.command(help=COMMANDS["replay"])(replay)
# What follows --ros-args is for ROS to read.
app.command("node", help=COMMANDS["node"], context_settings=PASSING)(node)
app.command("filter", help=COMMANDS["filter"], context_settings=PASSING)(command_filter)


@app.command(help=COMMANDS["show"])
def show(
    rover: Annotated[
        str,
        typer.Argument(metavar="ROVER", help="Parameter file, name of a preset, or with --layout a record."),
    ],
    twist: Annotated[
        tuple[float, float, float] | None,
        typer.Option(metavar="VX VY OMEGA", help="Motion to draw [m/s, m/s, rad/s]. Default: a left turn."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="Picture: .png, .svg or .pdf. Default: ROVER_from_above.png or ROVER_from_the_side.png",
        ),
    ] = None,
    layout: Annotated[
        Path | None,
        typer.Option(
            help="No picture, but how viewers show records of this rover: .json (Foxglove), .rbl (Rerun), "
            "or of a record .rrd (the record for Rerun, with its layout)."
        ),
    ] = None,
    side: Annotated[
        bool, typer.Option("--side", help="The suspension from the side instead, of a rocker-bogie preset.")
    ] = False,
    node: NodeOption = None,
    as_: AsOption = None,
    wheel_radius: RadiusOption = None,
) -> None:
    if layout is not None:
        from six_wheel.cli.layout import write_layout

        print(write_layout(rover, Reading(node, as_, wheel_radius), layout))
        return
    from six_wheel.logs.writing import replacing
    from six_wheel.plot.saving import picture_path, save

    if side:
        from six_wheel.plot.side import side_figure

        target = picture_path(output or Path(f"{rover}_from_the_side.png"))
        figure = side_figure(choose_suspension(rover), title=rover)
        with replacing(target, []) as temporary:
            save(figure, temporary)
        print(target.resolve())
        return
    chosen = choose(rover, Reading(node, as_, wheel_radius))
    from six_wheel.plot.twist import show_figure

    target = picture_path(output or Path(f"{chosen.name}_from_above.png"))
    figure = show_figure(chosen.rover, twist or _left_turn(chosen.rover), title=chosen.name)
    with replacing(target, [chosen.path] if chosen.path else []) as temporary:
        save(figure, temporary)
    print(target.resolve())


@app.command(help=COMMANDS["bench"])
def bench() -> None:
    from six_wheel import benchmark

    with progress_bar("timing") as progress:
        results = benchmark.measure(progress=progress)
    new_console().print(benchmark.table(results))


# --- what a command says ---------------------------------------------------------------------------------


def _left_turn(rover: "Rover") -> tuple[float, float, float]:
    """Half a metre a second forward, around a centre to the left that this rover can turn about."""
    size = max(max(abs(wheel.x), abs(wheel.y)) for wheel in rover.wheels)
    speed = 0.5
    # Unsteered wheels may hold the centre on a line beside the origin: the projection puts it there.
    vx, vy, omega = rover.project((speed, 0.0, speed / max(2.0 * size, 1.2 * rover.min_radius))).tolist()
    return vx, vy, omega


def run(arguments: Sequence[str]) -> int:
    """Run a command; whatever is wrong with its input becomes one line on stderr. Returns the exit code."""
    try:
        if len(arguments) == 2 and arguments[0] in COMMANDS and arguments[1] in HELP_OPTIONS:
            # To read arguments typer loads pydantic, which takes longer than all of this.
            group: Any = typer.main.get_command(app)
            command = group.commands[arguments[0]]
            parent = typer.Context(group, info_name=PROGRAM, **group.context_settings)
            print(command.get_help(typer.Context(command, parent=parent, info_name=arguments[0])))
            return 0
        code = app(list(arguments), prog_name=PROGRAM, standalone_mode=False)
    except (KeyboardInterrupt, typer.Abort):
        return 130
    except (
        BrokenPipeError
    ):  # `six-wheel check ... | head`: nobody reads on, and Python must not flush at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except Exception as error:
        message = _explain(error)
        if message is None:
            raise
        print(f"{PROGRAM}: {' '.join(message.split())}", file=sys.stderr)
        return 2
    return code if isinstance(code, int) else 0


def _explain(error: Exception) -> str | None:
    """What to tell the user about an error; None if it is not their input but this program that is wrong."""
    if findings := getattr(error, "findings", None):  # of a parameter file
        others = len(findings) - 1
        return f"{findings[0]}" + (f"; and {others} more: {PROGRAM} check shows all" if others else "")
    if hasattr(error, "format_message"):  # typer's own, whichever class it has in this version
        context = getattr(error, "ctx", None)
        usage = f"; see {context.command_path} --help" if context else ""
        return str(error.format_message()).rstrip(".") + usage
    if isinstance(error, ModuleNotFoundError) and (error.name or "").split(".")[0] in EXTRA_MODULES:
        return f"this needs {error.name}, which is not installed: {INSTALL}"
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    if isinstance(error, MemoryError):
        return "not enough memory"
    return str(error) if isinstance(error, ValueError | OSError | ImportError) else None
