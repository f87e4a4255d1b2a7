"""Katwijk beach planetary rover data set: six wheels, four steered, positions by satellite.

A part of a traverse is a folder with ``odometry.txt``: rows of numbers between spaces, a stamp such as
``2015_11_26_12_59_59_950`` in local time, the angles of six wheels (front, middle, rear, left before
right) and of four steering joints (front, rear) [rad], rocker and bogies, and columns that are not described.
Beside it ``gps-utm31.txt`` has stamps and positions, in spite of its name as latitude and longitude [deg],
and ``imu.txt`` stamps, acceleration along three axes [m/s²], rates about them [rad/s], and inclinations.

Source: layout as in katwijk_tools (``dataset.py``); R. Hewitt et al., The Katwijk beach planetary rover
dataset, Int. J. of Robotics Research, 2018.
"""

import math
import warnings
from pathlib import Path

import numpy as np

from six_wheel._core import Rover
from six_wheel.kinematics.errors import SuspiciousReadingsWarning, TableError
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.gyroscope.rates import Turning, edges_of
from six_wheel.logs.headers.clock_times import ClockTimes, is_clock_time
from six_wheel.logs.recordings import GroundTruth, WheelLog

ODOMETRY, PLACES, IMU = "odometry.txt", "gps-utm31.txt", "imu.txt"
WHEELS, JOINTS, LINKS = 6, 4, 3  # columns behind the stamp
GRAVITY = (8.0, 12.0)  # [m/s²] that an accelerometer shows in the mean
FASTEST = 2.0  # [rad/s] that this rover turns at; more are degrees
EQUATOR, FLATTENING = 6_378_137.0, 1.0 / 298.257223563  # [m], of WGS 84


def claims(path: Path) -> bool:
    """True for the odometry of a part, by its name and its first stamp, and for the folder of the part."""
    file = path / ODOMETRY if path.is_dir() else path
    if file.name != ODOMETRY or not file.is_file():
        return False
    with open(file, encoding="utf-8", errors="replace") as handle:
        cells = handle.readline(4096).split()
    return len(cells) > WHEELS + JOINTS and is_clock_time(cells[0])


def belongs(path: Path) -> bool:
    """True for a file beside the odometry of a part, which is no log by itself."""
    return path.name != ODOMETRY and claims(path.with_name(ODOMETRY))


def read(path: Path, rover: Rover) -> WheelLog:
    """A part of a traverse, with the positions if they are there. Raises `ValueError` if the rover has other
    wheels, or the file other columns."""
    if (len(rover.wheel_names), len(rover.steered_wheel_names)) != (WHEELS, JOINTS):
        rule = f"the rover must have {WHEELS} wheels, {JOINTS} of them steered, front to rear"
        raise ValueError(f"{rule}, got {', '.join(rover.wheel_names)}")
    file = path / ODOMETRY if path.is_dir() else path
    stamps, numbers = _rows(file, WHEELS + JOINTS)
    described = WHEELS + JOINTS + LINKS
    if numbers.shape[1] > described:
        more = f"{numbers.shape[1] + 1} columns, of which {described + 1} are described: the rest is not read"
        warnings.warn(f"{file} has {more}", SuspiciousReadingsWarning, stacklevel=2)
    origin = stamps[0]
    places = file.with_name(PLACES)
    truth = _truth(places, origin) if places.is_file() else None
    seconds = (stamps - origin) * 1e-9
    name = "_".join(file.parent.parts[-2:])
    sensor = file.with_name(IMU)
    rates = _yaw_rates(sensor, seconds, origin) if sensor.is_file() else None
    joints = numbers[:, WHEELS : WHEELS + JOINTS]
    return WheelLog(seconds, joints, numbers[:, :WHEELS], truth, name, yaw_rate=rates)


def _yaw_rates(file: Path, seconds: Floats, origin: int) -> Floats | None:
    """Rates about the vertical at the rows of the odometry [rad/s]; None in other units."""
    stamps, numbers = _rows(file, 6)
    forces, rates = numbers[:, :3], numbers[:, 3:6]
    up = forces.mean(axis=0)
    gravity, fastest = float(np.linalg.norm(up)), float(np.abs(rates).max(initial=0.0))
    if len(stamps) < 2:
        return None
    if not GRAVITY[0] <= gravity <= GRAVITY[1] or fastest > FASTEST:
        shown = f"{gravity:.3g} of acceleration and rates up to {fastest:.3g}"
        what = f"holds {shown}, which are not m/s² and rad/s of a rover: it is not read"
        warnings.warn(f"{file} {what}", SuspiciousReadingsWarning, stacklevel=3)
        return None
    what = "holds acceleration and rates: taken in rad/s, about the mean acceleration, which is up"
    warnings.warn(f"{file} {what}", SuspiciousReadingsWarning, stacklevel=3)
    turning = Turning(iter([((stamps - origin) * 1e-9, rates @ up / gravity)]))
    return turning.rates(edges_of(seconds, None, None))


def _rows(file: Path, least: int) -> tuple[np.ndarray, Floats]:
    """Stamps (n,) [ns] and the numbers behind them (n, columns), times that do not go on left out."""
    rows = [line.split() for line in file.read_text(encoding="utf-8", errors="replace").splitlines()]
    rows = [row for row in rows if row and not row[0].startswith(("#", "%"))]
    if not rows or len(rows[0]) <= least:
        raise TableError(f"{file}: rows must have a stamp and at least {least} numbers")
    rows = [row for row in rows if len(row) == len(rows[0])]
    stamps, good = ClockTimes().read([row[0] for row in rows])
    later = good & (np.maximum.accumulate(np.where(good, stamps, 0)) == stamps)
    later[1:] &= np.diff(np.maximum.accumulate(stamps)) > 0
    numbers = np.array([row[1:] for row, kept in zip(rows, later, strict=True) if kept], dtype=np.float64)
    return stamps[later], numbers


def _truth(file: Path, origin: int) -> GroundTruth:
    """Positions in metres east and north of the first one."""
    stamps, numbers = _rows(file, 2)
    places = numbers[:, :2]
    if (np.abs(places) <= (90.0, 180.0)).all():
        places = _metres(np.radians(places))
        what = "holds latitudes and longitudes: taken in metres east and north of the first"
        warnings.warn(f"{file} {what}", SuspiciousReadingsWarning, stacklevel=3)
    return GroundTruth((stamps - origin) * 1e-9, places - places[0])


def _metres(places: Floats) -> Floats:
    """East and north (n, 2) [m] of latitudes and longitudes (n, 2) [rad], near the first one."""
    latitude = float(places[0, 0])
    square = FLATTENING * (2.0 - FLATTENING)  # of the eccentricity
    root = math.sqrt(1.0 - square * math.sin(latitude) ** 2)
    across, along = EQUATOR / root * math.cos(latitude), EQUATOR * (1.0 - square) / root**3
    turned = places - places[0]
    return np.column_stack((across * turned[:, 1], along * turned[:, 0]))
