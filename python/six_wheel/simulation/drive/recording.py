"""A drive as a record: what was wanted, what the joints were told and why, and where that leads."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Odometry
from six_wheel.kinematics.objects.closing import Closing
from six_wheel.logs.mcap import RoverRecord
from six_wheel.logs.mcap.writer import LATEST, record_stamps
from six_wheel.logs.tables import Chunk
from six_wheel.simulation.drive.run_commands import Engine

POSE, TWIST = ("x", "y", "yaw"), ("vx", "vy", "omega")


class DriveRecord(Closing):
    """Writes the rows of a drive into an MCAP file of `logs.mcap`, chunk by chunk, as the columns of an
    engine come to `write`; `parameters` is the parameter file of the rover, as text.

    Poses and twists are those of the drive; their covariances are those of odometry that reads the commanded
    speeds, with its usual noise.
    """

    def __init__(self, path: Path, engine: Engine, parameters: str) -> None:
        self._columns = list(engine.units)
        self._joints = [joint for joints in engine.joints for joint in joints]
        self._steered = len(engine.joints[0])
        self._rover = engine.rover
        self._nanoseconds = round(1e9 * engine.time_unit.scale)
        self._odometry = Odometry(engine.rover, readings="speeds")
        self._origin: int | None = None
        self._rows = 0
        self._wanted: list[float] | None = None
        told: dict[str, Any] = {"unit": engine.time_unit.symbol, "rate": engine.summary.rate}
        told |= {"keep": engine.keep, "block_rows": engine.block_rows, "halt": engine.halt}
        self._record = RoverRecord(path, engine.rover, "drive", parameters, {"drive": told})

    def given(self, chunk: Chunk) -> None:
        """Append a chunk of the table, exactly, before what comes of it: so the drive can be done again."""
        stamps = self._nearest(chunk.stamps).tolist()
        rows = zip(stamps, chunk.stamps.tolist(), chunk.twists.tolist(), strict=True)
        for stamp, time, twist in rows:
            self._record.given(stamp, [time, *twist])
        # The ends of chunks decide the order in which poses are summed up, and with it their last bit.
        self._record.given(stamps[-1], [])

    def write(self, columns: Sequence[NDArray[Any]]) -> None:
        """Append rows. Raises `RowError` if a time is one that a message cannot have."""
        named = dict(zip(self._columns, columns, strict=True))
        stamps = self._stamps(columns[0])
        joints = np.stack(columns[1 : 1 + len(self._joints)], axis=1)
        poses, twists, slips = (
            np.stack([named[name] for name in names], axis=1).tolist()
            for names in (POSE, TWIST, [f"residual_{wheel}" for wheel in self._rover.wheel_names])
        )
        wanted, limited, reasons = self._controlled(named, twists)
        steering, speeds = self._rover.readings(dict(zip(self._joints, joints.T, strict=True)))
        commands, record = joints.tolist(), self._record
        for row, stamp in enumerate(stamps.tolist()):
            if wanted is not None and wanted[row] != self._wanted:
                self._wanted = wanted[row]
                record.wanted(stamp, stamp, wanted[row])
            record.commands(stamp, commands[row][: self._steered], commands[row][self._steered :])
            record.limited(stamp, limited[row])
            if reasons is not None:
                record.reasons(stamp, reasons[row])
            self._origin = stamp if self._origin is None else self._origin
            seconds = (stamp - self._origin) / 1e9
            state = self._odometry.update(steering[row] if self._steered else None, speeds[row], seconds)
            covariances = (state.covariance_6x6().ravel(), state.twist_covariance_6x6().ravel())
            record.odometry(stamp, stamp, poses[row], twists[row], *(each.tolist() for each in covariances))
            record.slip(stamp, slips[row])

    def _stamps(self, time: NDArray[Any]) -> NDArray[np.int64]:
        rows = np.arange(self._rows + 1, self._rows + 1 + len(time))
        self._rows += len(time)
        return record_stamps(time, rows, nanoseconds=self._nanoseconds)

    def _nearest(self, time: NDArray[Any]) -> NDArray[np.int64]:
        stamps: NDArray[Any] = np.clip(time * self._nanoseconds, 0, LATEST - 1)
        return np.rint(stamps).astype(np.int64) if stamps.dtype != np.int64 else stamps

    @staticmethod
    def _controlled(named: Mapping[str, Any], twists: Any) -> tuple[Any, Any, Any]:
        """Wanted and limited twists and the reasons; without a controller `twists` alone."""
        if "reasons" not in named:
            return None, twists, None
        wanted, limited = (
            np.stack([named[f"{which}_{name}"] for name in TWIST], axis=1).tolist()
            for which in ("commanded", "limited")
        )
        return wanted, limited, named["reasons"].tolist()

    def close(self) -> None:
        self._record.close()
