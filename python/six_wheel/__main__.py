"""`six-wheel`, also as ``python -m six_wheel``: what must come at once, without a command line library."""

import sys
from collections.abc import Sequence
from importlib.util import find_spec

PROGRAM = "six-wheel"
PURPOSE = "Kinematics of wheeled rovers: what their wheels must do, and what they did."
INSTALL = 'pip install "six-wheel[cli]"'
COMMANDS = {
    "demo": "What it can do: two rovers along a real recording, with pictures.",
    "check": "Every mistake in a parameter file at once; then what the rover can do.",
    "drive": "Drive a table of commands, within limits: joint commands, odometry, reasons, pictures.",
    "odometry": "Dead-reckon a log: the path with its covariance, bad rows, slip, errors against the truth.",
    "calibrate": "The rover's true dimensions from its logs and where it really was.",
    "show": "A rover from above: its wheels, their axes meeting in the centre of rotation.",
    "bench": "How fast the compiled core is on this machine, beside plain Python.",
}


def help_text() -> str:
    """The overview: all commands, a line each."""
    lines = [f"Usage: {PROGRAM} COMMAND [OPTIONS] [ARGUMENTS]", "", PURPOSE, "", "Commands:"]
    lines += [f"  {name:<9} {summary}" for name, summary in COMMANDS.items()]
    return "\n".join(
        [*lines, "", f"{PROGRAM} COMMAND --help explains a command, {PROGRAM} --version says which this is."]
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        Without the name of the program; those of the process by default.

    Returns
    -------
    int
        0 if all went well, 2 for input that cannot be used, 130 after Ctrl-C.
    """
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    if find_spec("typer") is None:
        print(f"{PROGRAM}: the command line needs typer, which is not installed: {INSTALL}", file=sys.stderr)
        return 2
    if not arguments or arguments[0] in ("--help", "-h"):
        print(help_text())
        return 0 if arguments else 2
    if arguments[0] == "--version":
        from six_wheel import __version__

        print(f"{PROGRAM} {__version__}")
        return 0
    try:
        from six_wheel.cli.app import run

        return run(arguments)
    except KeyboardInterrupt:  # while the libraries were being loaded
        return 130


if __name__ == "__main__":
    sys.exit(main())
