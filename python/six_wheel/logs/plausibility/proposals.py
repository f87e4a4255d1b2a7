"""The error for readings that cannot be meant as they are read, and the options that settle it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from six_wheel.kinematics.errors import FileError
from six_wheel.robot_description.doubts import Proposal

FIRST = 3  # rows that are named
AS_READ = "--no-plausibility"  # for readings that are what they seem to be, however odd
TAKEN = f"; {AS_READ} (plausibility=False) takes them as they are"


class ImplausibleReadingError(FileError):
    """Readings that cannot be meant as they are read. Its text is one line that proposes what settles it."""


@dataclass(frozen=True)
class Column:
    """A column of readings: what the log calls it, and the wheel or joint it belongs to."""

    header: str
    wheel: str


def stamp_unit(symbol: str) -> Proposal:
    """The unit of stamps."""
    return Proposal(f"stamp_unit: {symbol}", f"--stamp-unit {symbol}", f'stamp_unit="{symbol}"')


def encoders(
    *,
    counts: bool = False,
    turn: float | None = None,
    wraps_at: float | None = None,
    increments: bool = False,
    steering: bool = False,
) -> Proposal:
    """The unit of a counter and the number at which it starts over; the owner alone knows COUNTS."""
    name = "steering_encoders" if steering else "wheel_encoders"
    given: dict[str, str] = {}
    if wraps_at is not None:
        given["wraps_at"] = number(wraps_at)
    if counts or turn is not None:
        given["ticks_per_turn"] = "COUNTS" if turn is None else number(turn)
    keys = [f"{key}: {value}" for key, value in given.items()]
    options = [f"--{key.replace('_', '-')} {value}" for key, value in given.items()]
    arguments = ", ".join(f"{key}={value}" for key, value in given.items())
    python = [f"{name}=Encoder({arguments})"] if given else []
    if increments:
        keys.append("increments: true")
        options.append("--increments")
        python.append("increments=True")
    key = f"{name}: {{{', '.join(keys)}}}"
    return Proposal(key, "" if steering else " ".join(options), ", ".join(python))


def columns(meanings: Mapping[str, str]) -> Proposal:
    """Other meanings of headers."""
    pairs = ", ".join(f'"{header}": "{meaning}"' for header, meaning in meanings.items())
    options = " ".join(f'--column "{header}={meaning}"' for header, meaning in meanings.items())
    return Proposal(f"columns: {{{pairs}}}", options, f"columns={{{pairs}}}")


def max_speed(speed: float) -> Proposal:
    """The fastest rim of the rover [m/s]."""
    text = number(speed)
    return Proposal(f"odometry: {{max_speed: {text}}}", f"--max-speed {text}", f"max_speed={text}")


def number(value: float) -> str:
    """A number as short as it can be said."""
    return f"{value:.0f}" if float(value).is_integer() else f"{value:.9g}"


def rows(found: Sequence[int]) -> str:
    """The first of some rows, in words."""
    named = ", ".join(str(row) for row in found[:FIRST])
    return f"row{'' if len(found) == 1 else 's'} {named}{', ...' if len(found) > FIRST else ''}"
