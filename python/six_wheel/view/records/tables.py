"""Tables with poses, as `drive` and `odometry` write them."""

from __future__ import annotations  # pyarrow is loaded for a table

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Rover
from six_wheel.kinematics.errors import TableError
from six_wheel.kinematics.poses import Floats
from six_wheel.view.records.record import Record

POSE, TWIST = ("x", "y", "yaw"), ("vx", "vy", "omega")
COVARIANCE = ("covariance_x_x", "covariance_x_y", "covariance_y_y")
TIMES = {"time": 1.0, "time_ms": 1e-3, "time_us": 1e-6, "time_ns": 1e-9}


@dataclass(frozen=True)
class PoseTable:
    """A table on disk, of which only the headers have been read: as they are written, and as `names` without
    units."""

    path: Path
    names: tuple[str, ...]
    headers: tuple[str, ...]

    @property
    def has_poses(self) -> bool:
        """True if it has times, poses and the twists of a drive."""
        return {*POSE, *TWIST} <= {*self.names} and any(name in self.names for name in TIMES)

    def record(self, rover: Rover) -> Record:
        """The record of a rover. Raises `TableError` if a column does not hold numbers, or time does not go
        on."""
        (time,) = (name for name in TIMES if name in self.names)
        joints = {joint: self._joint(joint) for joint in rover.joint_names}
        there = all(column is not None for column in joints.values())
        slips = [f"residual_{wheel}" for wheel in rover.wheel_names]
        commanded = [f"commanded_{name}" for name in TWIST]
        wanted = [time, *POSE, *TWIST]
        for names in (COVARIANCE, slips, commanded, ["reasons"]):
            wanted += names if set(names) <= {*self.names} else []
        wanted += [column for column in joints.values() if column is not None and there]
        read = self._read(wanted)
        first = read[time][0] if len(read[time]) else 0
        times = (read[time] - first) * TIMES[time]
        later = np.isfinite(times[1:]) & (np.diff(times) >= 0.0)
        if not later.all():
            row = int(np.argmin(later)) + 2
            raise TableError(
                f"{self.path}: time must not run backwards, got {times[row - 1]:g} s in row {row}"
            )

        def block(names: Any) -> Floats | None:
            if not set(names) <= read.keys():
                return None
            return np.stack([np.asarray(read[name], dtype=np.float64) for name in names], axis=1)

        steering = speeds = None
        if there:
            values = {joint: np.asarray(read[str(column)], float) for joint, column in joints.items()}
            steering, speeds = rover.readings(values)
            steering = steering if rover.steered_wheel_names else None
        covariances = block(COVARIANCE)
        if covariances is not None:
            covariances = covariances[:, [0, 1, 1, 2]].reshape(-1, 2, 2)
        reasons = read["reasons"].astype(np.uint32) if "reasons" in read else None
        poses, twists = block(POSE), block(TWIST)
        assert poses is not None
        return Record(
            rover, self.path.name, times, poses, steering, speeds, block(slips), twists, block(commanded),
            covariances, reasons,
        )  # fmt: skip

    def _joint(self, joint: str) -> str | None:
        for name in (joint, f"{joint}/position", f"{joint}/velocity"):
            if name in self.names:
                return name
        return None

    def _read(self, names: list[str]) -> dict[str, NDArray[Any]]:
        import pyarrow as pa

        headers = [self.headers[self.names.index(name)] for name in names]
        try:
            if self.path.suffix.lower() == ".parquet":
                import pyarrow.parquet as pq

                table = pq.read_table(self.path, columns=headers)
            else:
                from pyarrow import csv

                table = csv.read_csv(self.path, convert_options=csv.ConvertOptions(include_columns=headers))
            columns = [table[header].to_numpy() for header in headers]
        except pa.ArrowException as error:
            raise TableError(f"{self.path}: {str(error).splitlines()[0]}") from None
        for name, column in zip(names, columns, strict=True):
            if column.dtype.kind not in "iuf":
                raise TableError(f"{self.path}: the column {name} must hold numbers, got {column.dtype}")
        return dict(zip(names, columns, strict=True))


def read_table(path: Path) -> PoseTable:
    """The headers of a table. Raises `TableError` if the file cannot be read."""
    try:
        if path.suffix.lower() == ".parquet":
            import pyarrow as pa
            import pyarrow.parquet as pq

            try:
                headers = tuple(pq.read_schema(path).names)
            except pa.ArrowException as error:
                raise TableError(f"{path}: not a Parquet file: {str(error).splitlines()[0]}") from None
        else:
            with path.open(encoding="utf-8", errors="replace") as file:
                headers = tuple(cell.strip().strip('"') for cell in file.readline(1 << 16).split(","))
    except OSError as error:
        raise TableError(f"{path}: {error.strerror}") from None
    names = tuple(header.partition("[")[0].strip() for header in headers)
    return PoseTable(path, names, headers)
