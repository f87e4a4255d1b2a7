"""Times that a record cannot hold are refused with their row, before anything is written."""

from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw
from six_wheel.kinematics.errors import TableError
from six_wheel.log_odometry.run_log import reckon

ROVER = sw.Rover.preset("perseverance")


@pytest.mark.parametrize("first", [-5.0, 3e9])
def test_times_that_a_record_cannot_hold(tmp_path: Path, first: float) -> None:
    """A log of negative times once ended in a traceback of `struct`."""
    pytest.importorskip("mcap")
    joints = [*ROVER.steering_joints, *ROVER.traction_joints]
    rows = np.column_stack([first + 0.1 * np.arange(20), np.zeros((20, len(joints)))])
    log, record = tmp_path / "log.csv", tmp_path / "track.mcap"
    np.savetxt(
        log,
        rows,
        delimiter=",",
        header=",".join(["time", *(f"{joint} [rad]" for joint in joints)]),
        comments="",
        fmt="%.17g",
    )
    with pytest.raises(
        TableError, match=r"log\.csv: row 1: a time in a bag must be from 0 to 2\^31 seconds, got "
    ):
        reckon(ROVER, log, record)
    assert list(tmp_path.iterdir()) == [log]
