"""Description of the readings of a log, as the checks of their plausibility have to know them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from six_wheel._core import Rover
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.plausibility.proposals import Column


@dataclass(frozen=True)
class Readings:
    """Description of the readings of a log, and which of it somebody said."""

    rover: Rover
    kind: str = "angles"  # or "ticks", "speeds", "increments"
    wheels: Sequence[Column] = ()  # in the rover's order, with an empty header for a wheel without one
    steering: Sequence[Column] = ()
    time: str = "stamps"  # header of the stamps
    named: bool = False  # columns have headers that can be mapped
    clock_stated: bool = False  # the log or its owner says in which unit they are
    wheels_stated: bool = False
    steering_stated: bool = False
    wraps: bool = False  # encoders say where counters start over
    steering_wraps: bool = False
    # (wheels,): count at which they start over, inf for a counter that does not.
    wraps_at: Floats | None = None
    counts_unknown: bool = False  # readings are counts and nobody says of how many a turn has
    turn: float | None = None  # counts of a turn
    increments_stated: bool = False  # it is said that rows are totals, or that they are not
    scale: Floats | None = None  # (wheels,): radians of one of the readings
    max_speed: float | None = None  # bounds of the owner [m/s], [s]
    max_gap: float | None = None
    first_row: int = 1  # number of the first row
    # Wheel to the header of a column that says which way it turns, and is not read.
    directions: Mapping[str, str] = field(default_factory=dict)
