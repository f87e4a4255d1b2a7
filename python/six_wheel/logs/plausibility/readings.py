"""Description of the readings of a log, as the checks of their plausibility have to know them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from six_wheel._core import Rover
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.plausibility.proposals import Column


@dataclass(frozen=True)
class Readings:
    """Description of the readings of a log, and which of it somebody said.

    Attributes
    ----------
    rover : Rover
    kind : str
        ``"angles"``, ``"ticks"``, ``"speeds"`` or ``"increments"``.
    wheels, steering : sequence of Column
        In the rover's order, with an empty header for a wheel without one.
    time : str
        Header of the stamps.
    named : bool
        True if columns have headers that can be mapped.
    clock_stated, wheels_stated, steering_stated : bool
        True if the log or its owner says in which unit they are.
    wraps, steering_wraps : bool
        True if encoders say where counters start over.
    wraps_at : array, shape (wheels,), or None
        Count at which they start over, inf for a counter that does not.
    counts_unknown : bool
        True if readings are counts and nobody says of how many a turn has.
    turn : float or None
        Counts of a turn.
    increments_stated : bool
        True if it is said that rows are totals, or that they are not.
    scale : array, shape (wheels,), or None
        Radians of one of the readings.
    max_speed, max_gap : float or None
        Bounds of the owner [m/s], [s].
    first_row : int
        Number of the first row.
    directions : mapping
        Wheel to the header of a column that says which way it turns, and is not read.
    """

    rover: Rover
    kind: str = "angles"
    wheels: Sequence[Column] = ()
    steering: Sequence[Column] = ()
    time: str = "stamps"
    named: bool = False
    clock_stated: bool = False
    wheels_stated: bool = False
    steering_stated: bool = False
    wraps: bool = False
    steering_wraps: bool = False
    wraps_at: Floats | None = None
    counts_unknown: bool = False
    turn: float | None = None
    increments_stated: bool = False
    scale: Floats | None = None
    max_speed: float | None = None
    max_gap: float | None = None
    first_row: int = 1
    directions: Mapping[str, str] = field(default_factory=dict)
