"""Settings of dead reckoning, and its result for one log."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from six_wheel._core import Gyroscope, Noise, Rover
from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.odometry.tracks import OdometryHealth, SlipReport
from six_wheel.kinematics.poses import Floats
from six_wheel.log_odometry.copies import Sketch
from six_wheel.log_odometry.evaluation.paths import AbsoluteError, Evaluation
from six_wheel.log_odometry.evaluation.slip import Stretch
from six_wheel.logs.frames.thinning import Trace
from six_wheel.logs.joint_totals import JointRows
from six_wheel.robot_description.gyroscope_errors import with_readings_apart

FIRST_ROWS = 5  # of every kind of finding, that are named


@checked_class
@dataclass(frozen=True)
class ReckonSettings:
    """Settings of dead reckoning: the noise, other options of `Odometry`, and the first pose [m, m, rad].

    `gyroscope` is what one in the log errs by, of readings `period` [s] apart, if that is known; without it
    none is used.
    """

    noise: Noise = field(default_factory=Noise)
    options: Mapping[str, Any] = field(default_factory=dict)
    start: tuple[float, float, float] = (0.0, 0.0, 0.0)
    gyroscope: Gyroscope | None = None
    period: float | None = None

    def options_for(self, chunk: JointRows) -> dict[str, Any]:
        """Options of `Odometry` for a log that begins so: the longer a row's mean, the less white noise."""
        options, known = dict(self.options), self.gyroscope
        if known is None or chunk.yaw_rate is None:
            return options
        apart = float(np.median(np.diff(chunk.stamps))) if len(chunk.stamps) > 1 else self.period
        return options | {"gyroscope": with_readings_apart(known, self.period, apart)}


@dataclass
class Count:
    """Number of rows, and the first of them."""

    rows: int = 0
    first: list[int] = field(default_factory=list)

    def add(self, rows: Sequence[int]) -> None:
        """Take in more rows."""
        self.rows += len(rows)
        self.first += list(rows[: FIRST_ROWS - len(self.first)])

    def __str__(self) -> str:
        more = ", ..." if self.rows > len(self.first) else ""
        named = f"row{'' if self.rows == 1 else 's'} {', '.join(map(str, self.first))}{more}"
        return f"{self.rows:,} ({named})"


@dataclass
class Reckoned:
    """Result of dead reckoning of a log.

    Attributes
    ----------
    name : str
        The log.
    rover : Rover
    rows : int
        Rows that were read.
    duration, distance : float
        From the first to the last row [s]; along the path [m].
    pose, covariance : ndarray, shape (3,) and (3, 3)
        At the end [m, m, rad].
    left_out : dict of str to Count
        Rows that were not used, by reason.
    flags : dict of OdometryHealth to Count
        Rows that were used and that there is something to say about.
    slip : SlipReport
    lost : tuple of Stretch
        When the wheels did not say what the rover did, if the truth is known.
    evaluation : Evaluation or None
        Against the truth, if it is known with headings.
    placed : AbsoluteError or None
        After the best rigid alignment, of what the truth follows, where that has positions alone.
    estimate, truth : ndarray, shape (n, 3)
        Poses where the truth is known, for `evaluation`.
    gyroscope_bias : tuple of float or None
        Of a gyroscope that was used, at the end, and how sure that is [rad/s].
    warnings : list of str
    elapsed : float
        Time that it took [s].
    noise : Noise or None
        By which the covariances grew.
    """

    name: str
    rover: Rover
    rows: int = 0
    duration: float = 0.0
    distance: float = 0.0
    pose: Floats = field(default_factory=lambda: np.zeros(3))
    covariance: Floats = field(default_factory=lambda: np.zeros((3, 3)))
    left_out: dict[str, Count] = field(default_factory=dict)
    flags: dict[OdometryHealth, Count] = field(default_factory=dict)
    slip: SlipReport = field(default_factory=lambda: SlipReport((), (), 0))
    lost: tuple[Stretch, ...] = ()
    evaluation: Evaluation | None = None
    placed: AbsoluteError | None = None
    estimate: Floats = field(default_factory=lambda: np.empty((0, 3)))
    truth: Floats = field(default_factory=lambda: np.empty((0, 3)))
    gyroscope_bias: tuple[float, float] | None = None
    warnings: list[str] = field(default_factory=list)
    elapsed: float = 0.0
    noise: Noise | None = None
    _trace: Trace = field(default_factory=Trace)
    _sketch: Sketch = field(default_factory=Sketch)

    @property
    def deviations(self) -> Floats:
        """Standard deviations of the last pose, (3,) [m, m, rad]."""
        return np.sqrt(np.diag(self.covariance))

    def trace(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Stamps (n,), poses (n, 3), covariances (n, 3, 3) and residuals (n, wheels), evenly thinned."""
        poses, others = self._trace.path()
        return others[:, 0], poses, others[:, 1:10].reshape(-1, 3, 3), others[:, 10:]
