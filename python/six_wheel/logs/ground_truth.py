"""Ground truth: columns and messages of poses or positions, in a log or in a file of their own."""

import contextlib
from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from six_wheel.kinematics.errors import TableError
from six_wheel.kinematics.keywords import checked
from six_wheel.kinematics.poses import Floats, rotations
from six_wheel.logs.bags.bag_files import is_bag
from six_wheel.logs.headers.columns import TIME, Column, find_columns
from six_wheel.logs.headers.time_columns import in_seconds
from six_wheel.logs.headers.truth_columns import columns_in_space, position_columns, truth_columns
from six_wheel.logs.plausibility.findings import Findings
from six_wheel.logs.skip_bad_rows import Sieve, Source, TolerantTable

TRUTH = ("x", "y", "yaw", "qx", "qy", "qz", "qw")
TILTED = ("z", "roll", "pitch")
# Columns of a file without a header line, as the TUM benchmark has them and evo writes them.
TUM = ("time [s]", "x", "y", "z", "qx", "qy", "qz", "qw")


@checked()
def read_truth(
    path: str | PathLike[str],
    *,
    origin: int = 0,
    columns: Mapping[str, str] | None = None,
    topic: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Floats, Floats, Findings]:
    """Read where a rover was from a file of its own.

    Parameters
    ----------
    path : str or PathLike
        A table with time, x, y and yaw or a quaternion, or without a heading; one without a header line in
        the columns of the TUM benchmark, ``time x y z qx qy qz qw``; a bag.
    origin : int
        The second from which stamps are counted: that of the log.
    columns : mapping, optional
        Header to the header it should be read as.
    topic : str, optional
        Topic of a bag: odometry, poses or transforms. Needed where there are several.
    progress : callable, optional
        Called now and then with how far it is and how far it will go.

    Returns
    -------
    stamps : array, shape (n,)
        Seconds, increasing.
    poses : array, shape (n, 3) or (n, 6)
        x, y, yaw [m, m, rad]; NaN for yaw where the file has positions alone. In space x, y, z, roll, pitch,
        yaw, where every row has z and a quaternion, or z, roll, pitch and yaw.
    findings : Findings
        Rows that were left out.

    Raises
    ------
    TableError
        If there is no such thing in the file.
    """
    path = Path(path)
    stated = True
    source: Source
    if is_bag(path):
        from six_wheel.logs.bags.truth_bag import TruthBag

        source = TruthBag(path, topic)
    else:
        source = table = TolerantTable(path, _find_truth, columns, unnamed=TUM)
        stated = table.stated
    parts: list[tuple[Floats, Floats]] = []
    with contextlib.closing(source):
        for batch in Sieve(source.findings, TILTED, stated).pass_on(source.batches(200_000)):
            poses = poses_of(batch.values)
            wanted = poses[:, [0, 1, -1] if has_yaw(batch.values) else [0, 1]]
            good = np.isfinite(wanted).all(axis=1)
            for k in np.flatnonzero(~good):  # numbers that are none together
                flaw = "the quaternion of a pose must not be zero"
                source.findings.add(int(batch.rows[k]), flaw, line=int(batch.lines[k]))
            seconds = in_seconds(batch.time[good], source.time_unit.scale, origin)
            parts.append((seconds, poses[good]))
            if progress is not None:
                progress(source.position, source.size)
    if not parts:
        raise TableError(f"{path}: the truth must have at least one row that can be used, got none")
    stamps, poses = (np.concatenate(part) for part in zip(*parts, strict=True))
    if len(stamps) < 2:
        raise TableError(f"{path}: the truth must have at least two rows that can be used, got {len(stamps)}")
    if not np.isfinite(poses[:, 2:-1]).all():  # heights that are not known everywhere
        poses = poses[:, [0, 1, -1]]
    return stamps, poses, source.findings


def _find_truth(headers: Sequence[str], field_units: Mapping[int, str]) -> dict[str, Column]:
    columns = find_columns(headers, (TIME,)) | (truth_columns(headers) or position_columns(headers))
    if "yaw" in columns or "qw" in columns:
        columns |= columns_in_space(headers)
    if "x" not in columns:
        listed = ", ".join(f'"{header}"' for header in headers)
        rule = "have columns x, y and yaw (or qx, qy, qz, qw), or x and y alone"
        raise TableError(f"the truth must {rule}, got {listed}")
    return columns


def has_yaw(values: Mapping[str, Any]) -> bool:
    """True if columns of a pose hold a heading: a yaw or a quaternion."""
    return "yaw" in values or "qw" in values


def poses_of(values: Mapping[str, Floats]) -> Floats:
    """Poses (n, 3) from x, y and yaw, or from a quaternion of any length but zero, which gives NaN; with z
    and the tilt of a file poses in space, (n, 6).

    Positions alone have NaN for yaw.
    """
    if "qw" in values:
        # Angles do not depend on the length of a quaternion; that of length zero has none.
        x, y, z, w = (values[f"q{axis}"] for axis in "xyzw")
        square = x * x + y * y + z * z + w * w
        roll = np.arctan2(2 * (w * x + y * z), w * w - x * x - y * y + z * z)
        with np.errstate(invalid="ignore"):
            pitch = np.arcsin(np.clip(2 * (w * y - z * x) / square, -1.0, 1.0))
        yaw = np.where(square > 0, np.arctan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z), np.nan)
    if "yaw" in values:
        yaw = values["yaw"]
    elif "qw" not in values:
        yaw = np.full(len(values["x"]), np.nan)
    if "roll" in values:
        roll, pitch = values["roll"], values["pitch"]
    if "z" in values:
        return np.stack([*(values[axis] for axis in "xyz"), roll, pitch, yaw], axis=1)
    return np.stack([values["x"], values["y"], yaw], axis=1)


def transforms(poses: Floats) -> Floats:
    """Transforms ``world_from_body`` (n, 4, 4) of rows x, y, z, roll, pitch, yaw; see `rotations`."""
    path = np.zeros((len(poses), 4, 4))
    path[:, :3, :3], path[:, :3, 3], path[:, 3, 3] = rotations(poses[:, 3:]), poses[:, :3], 1.0
    return path


def rows_of(path: Floats) -> Floats:
    """Rows x, y, z, roll, pitch, yaw of transforms (n, 4, 4)."""
    turned = path[:, :3, :3]
    roll = np.arctan2(turned[:, 2, 1], turned[:, 2, 2])
    pitch = np.arctan2(-turned[:, 2, 0], np.hypot(turned[:, 2, 1], turned[:, 2, 2]))
    yaw = np.arctan2(turned[:, 1, 0], turned[:, 0, 0])
    return np.column_stack((path[:, :3, 3], roll, pitch, yaw))
