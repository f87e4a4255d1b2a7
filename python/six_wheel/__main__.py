"""`six-wheel`, also as ``python -m six_wheel``: what must come at once, without a command line library."""

import io
import os
import sys
from collections.abc import Sequence
from importlib.util import find_spec

from six_wheel.cli.names import INSTALL, PROGRAM, help_text


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        Without the name of the program; those of the process by default.

    Returns
    -------
    int
        0 if all went well, 1 if nobody reads on, 2 for input that cannot be used, 130 after Ctrl-C.
    """
    open_streams()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a character that a terminal cannot show ends no command
    try:
        code = answer(sys.argv[1:] if arguments is None else list(arguments))
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:  # while the libraries were being loaded
        return 130
    except BrokenPipeError:  # `six-wheel check ... | head`: nobody reads on
        drop_output()
        return 1
    except OSError as error:  # the standard output is a file on a full disk
        drop_output()
        print(f"{PROGRAM}: standard output: {error.strerror}", file=sys.stderr)
        return 2


def open_streams() -> None:
    """Standard streams that were closed lead nowhere; files that are opened later are none of them."""
    while (opened := os.open(os.devnull, os.O_RDWR)) <= 2:
        pass
    os.close(opened)
    for name, number in (("stdout", 1), ("stderr", 2)):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, "w", encoding="utf-8", closefd=False))


def drop_output() -> None:
    """Python has nothing more to write to the standard output at its exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def answer(arguments: list[str]) -> int:
    """Run the command line, or say without it what can be said."""
    if find_spec("typer") is None:
        print(f"{PROGRAM}: the command line needs typer, which is not installed: {INSTALL}", file=sys.stderr)
        return 2
    if not arguments or arguments[0] in ("--help", "-h"):
        print(help_text())
        return 0 if arguments else 2
    if arguments[0] == "--version":
        from six_wheel._core import __version__

        print(f"{PROGRAM} {__version__}")
        return 0
    from six_wheel.cli.app import run

    return run(arguments)


if __name__ == "__main__":
    sys.exit(main())
