"""Rover mobility data set of the RoSE Lab: four driven wheels, motion capture.

A trial is a folder with ``Processed_Data.csv``: ``time_s``, ``pos_x`` and so on [m], ``quat_x`` and so on,
``enc1`` to ``enc4`` [rad], which are the wheels front left, front right, rear left, rear right, again as
``enc1_rad``, and their rates. The pose is that of the centre of mass.

Source: layout as in the README of Rover-Mobility-Dataset.
"""

from pathlib import Path

from six_wheel._core import Rover
from six_wheel.logs.joints import JointLog
from six_wheel.logs.recordings import WheelLog

TABLE, RAW = "Processed_Data.csv", "Raw_Data"
WHEELS = 4
TRUTH = {"pos_x": "x", "pos_y": "y"} | {f"quat_{axis}": f"q{axis}" for axis in "xyzw"}


def claims(path: Path) -> bool:
    """True for the table of a trial, by its name and its headers."""
    if path.name != TABLE or not path.is_file():
        return False
    return {f"enc{number}" for number in range(1, WHEELS + 1)} <= _headers(path)


def _headers(path: Path) -> set[str]:
    with open(path, encoding="utf-8-sig", errors="replace") as handle:
        return {header.strip() for header in handle.readline(65_536).split(",")}


def belongs(path: Path) -> bool:
    """True for the raw recordings of a trial, from which its table was made."""
    return path.parent.name == RAW and claims(path.parent.with_name(TABLE))


def read(path: Path, rover: Rover) -> WheelLog:
    """A trial with its truth. Raises `ValueError` if the rover has another number of wheels, or the table
    cannot be used."""
    if len(rover.wheel_names) != WHEELS or rover.steered_wheel_names:
        rule = f"the rover must have {WHEELS} wheels that do not steer, front to rear"
        raise ValueError(f"{rule}, got {', '.join(rover.wheel_names)}")
    wheels = {f"enc{number}": f"{wheel} [rad]" for number, wheel in enumerate(rover.wheel_names, start=1)}
    headers = _headers(path)
    known = {header: meaning for header, meaning in TRUTH.items() if header in headers}
    with JointLog(path, rover, columns=wheels | known) as log:
        return log.read(session=str(path.parent))
