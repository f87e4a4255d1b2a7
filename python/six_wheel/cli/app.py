"""The commands of `six-wheel`: arguments in, files and tables out, one line for whatever is wrong.

Only typer is imported here: ``six-wheel drive --help`` need not wait for NumPy, Arrow or matplotlib.
"""

import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from six_wheel.cli.commands.calibrate import calibrate
from six_wheel.cli.commands.check import check
from six_wheel.cli.commands.control_loop import PASSING, command_filter, node, replay
from six_wheel.cli.commands.convert import convert
from six_wheel.cli.commands.drive import drive
from six_wheel.cli.commands.example import example
from six_wheel.cli.commands.inspect import inspect
from six_wheel.cli.commands.odometry import odometry
from six_wheel.cli.commands.show import show
from six_wheel.cli.commands.simulate import simulate
from six_wheel.cli.commands.traverse import traverse
from six_wheel.cli.commands.view import view
from six_wheel.cli.names import COMMANDS, INSTALL, PROGRAM, PURPOSE
from six_wheel.cli.shared import new_console, progress_bar, with_options
from six_wheel.cli.signals import ended_by_signals
from six_wheel.kinematics.errors import printable
from six_wheel.robot_description.doubts import DoubtError

EXTRA_MODULES = ("matplotlib", "pyarrow", "pydantic", "rich", "yaml")
HELP_OPTIONS = ["-h", "--help"]

app = typer.Typer(
    help=PURPOSE,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": HELP_OPTIONS},
)


def demo(
    output: Annotated[
        Path, typer.Option("-o", "--output", help="Folder for the pictures and tables.")
    ] = Path("six_wheel_demo"),
) -> None:
    from six_wheel.cli.demo.running import run

    run(output, console=new_console())


ORDER = (
    demo,
    check,
    drive,
    simulate,
    inspect,
    odometry,
    calibrate,
    traverse,
    show,
    view,
    convert,
    example,
    replay,
)
for command in ORDER:
    app.command(help=COMMANDS[command.__name__])(with_options(command))
app.command("node", help=COMMANDS["node"], context_settings=PASSING)(with_options(node))
app.command("filter", help=COMMANDS["filter"], context_settings=PASSING)(with_options(command_filter))


@app.command(help=COMMANDS["bench"])
def bench() -> None:
    from six_wheel.cli import benchmark

    with progress_bar("timing") as progress:
        results = benchmark.measure(progress=progress)
    new_console().print(benchmark.table(results))


def with_pictures(arguments: Sequence[str]) -> list[str]:
    """The arguments, with ``ROVER_COMMAND.png`` for a ``--plot`` that has no value."""
    given, named = list(arguments), [each for each in arguments if not each.startswith("-")]
    for place in range(len(given), 0, -1):
        if given[place - 1] == "--plot" and (place == len(given) or given[place].startswith("-")):
            rover = Path(named[1]).stem if len(named) > 1 else PROGRAM
            given.insert(place, f"{rover}_{named[0]}.png")
    return given


def before_ros(arguments: Sequence[str]) -> list[str]:
    """The arguments, of a node with ``--`` before ``--ros-args``: from there on they are for ROS to read."""
    given = list(arguments)
    if given and given[0] in ("node", "filter") and "--ros-args" in given and "--" not in given:
        given.insert(given.index("--ros-args"), "--")
    return given


def run(arguments: Sequence[str]) -> int:
    """Run a command; whatever is wrong with its input becomes one line on stderr. Returns the exit code.

    Raises
    ------
    BrokenPipeError
        If nobody reads the standard output.
    """
    try:
        if len(arguments) == 2 and arguments[0] in COMMANDS and arguments[1] in HELP_OPTIONS:
            # To read arguments typer loads pydantic, which takes longer than all of this.
            group: Any = typer.main.get_command(app)
            command = group.commands[arguments[0]]
            parent = typer.Context(group, info_name=PROGRAM, **group.context_settings)
            print(command.get_help(typer.Context(command, parent=parent, info_name=arguments[0])))
            return 0
        if "" in arguments or any(re.fullmatch(r"--[a-z-]+=", argument) for argument in arguments):
            raise ValueError("an argument must not be empty, got one that is")
        arguments = before_ros(with_pictures(arguments))
        with ended_by_signals():
            # The core would load NumPy by itself, and panic at a Ctrl-C meanwhile: here it is one.
            import numpy  # noqa: F401

            code = app(list(arguments), prog_name=PROGRAM, standalone_mode=False)
    except (KeyboardInterrupt, typer.Abort):
        return 130
    except BrokenPipeError:
        raise
    except Exception as error:
        if isinstance(error, OSError):
            sys.stdout.flush()  # fails where it is the standard output that cannot be written: `main` says so
        message = _explain(error)
        if message is None:
            raise
        print(f"{PROGRAM}: {printable(' '.join(message.split()))}", file=sys.stderr)
        return 2
    return code if isinstance(code, int) else 0


def _odd_value(error: Exception) -> str | None:
    """The option, its rule and what came, of a value that typer could not read."""
    options = getattr(getattr(error, "param", None), "opts", None)
    read = getattr(error.__cause__, "errors", None)
    if not options or read is None:
        return None
    found = read()[0]
    rule = str(found["msg"]).removeprefix("Input should be ").split(",")[0]
    return f"{options[-1]} must be {rule}, got {str(found['input'])!r}"


def _explain(error: Exception) -> str | None:
    """Message for the user about an error; None if the error is in this program and not in the input."""
    if findings := getattr(error, "findings", None):  # of a parameter file
        others = len(findings) - 1
        return f"{findings[0]}" + (f"; and {others} more: {PROGRAM} check shows all" if others else "")
    if hasattr(error, "format_message"):  # typer's own, whichever class it has in this version
        context = getattr(error, "ctx", None)
        usage = f"; see {context.command_path} --help" if context else ""
        if context and context.info_name in ("node", "filter"):
            usage = f"; arguments of ROS must follow --ros-args{usage}"
        return (_odd_value(error) or str(error.format_message()).rstrip(".")) + usage
    if isinstance(error, ModuleNotFoundError) and (error.name or "").split(".")[0] in EXTRA_MODULES:
        return f"this needs {error.name}, which is not installed: {INSTALL}"
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    if isinstance(error, MemoryError):
        return "not enough memory"
    if isinstance(error, DoubtError):
        return error.told("option")
    return str(error) if isinstance(error, ValueError | OSError | ImportError) else None
