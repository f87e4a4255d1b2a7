"""Ground truth: columns and messages of poses or positions, in a log or in a file of their own."""

import contextlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.keywords import checked
from six_wheel.logs.bags.bag_files import is_bag
from six_wheel.logs.headers.columns import TIME, Column, TableError, find_columns
from six_wheel.logs.headers.joint_columns import position_columns, truth_columns
from six_wheel.logs.headers.time_columns import seconds_since
from six_wheel.logs.skip_bad_rows import Findings, Sieve, Source, TolerantTable

__all__ = ["TRUTH", "has_yaw", "poses_of", "read_truth"]

TRUTH = ("x", "y", "yaw", "qx", "qy", "qz", "qw")
Floats = NDArray[np.float64]


@checked()
def read_truth(
    path: Path | str,
    *,
    origin: int = 0,
    columns: Mapping[str, str] | None = None,
    topic: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Floats, Floats, Findings]:
    """Read where a rover was from a file of its own.

    Parameters
    ----------
    path : Path
        A table with time, x, y and yaw or a quaternion, or without a heading; a bag.
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
    poses : array, shape (n, 3)
        x, y, yaw [m, m, rad]; NaN for yaw where the file has positions alone.
    findings : Findings
        What was left out.

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
        source = TolerantTable(path, _find_truth, columns)
        stated = source.stated
    parts: list[tuple[Floats, Floats]] = []
    with contextlib.closing(source):
        for batch in Sieve(source.findings, (), stated).pass_on(source.batches(200_000)):
            poses = poses_of(batch.values)
            wanted = poses if has_yaw(batch.values) else poses[:, :2]
            good = np.isfinite(wanted).all(axis=1)
            for k in np.flatnonzero(~good):  # numbers that are none together
                flaw = "the quaternion of a pose must not be zero"
                source.findings.add(int(batch.rows[k]), flaw, line=int(batch.lines[k]) or None)
            parts.append((seconds_since(origin, batch.time[good], source.time_unit), poses[good]))
            if progress is not None:
                progress(source.position, source.size)
    if not parts:
        raise TableError(f"{path}: the truth must have at least one row that can be used, got none")
    stamps, poses = (np.concatenate(part) for part in zip(*parts, strict=True))
    return stamps, poses, source.findings


def _find_truth(headers: Sequence[str], field_units: Mapping[int, str]) -> dict[str, Column]:
    columns = find_columns(headers, (TIME,)) | (truth_columns(headers) or position_columns(headers))
    if "x" not in columns:
        listed = ", ".join(f'"{header}"' for header in headers)
        rule = "have columns x, y and yaw (or qx, qy, qz, qw), or x and y alone"
        raise TableError(f"the truth must {rule}, got {listed}")
    return columns


def has_yaw(values: Mapping[str, Any]) -> bool:
    """True if columns of a pose hold a heading: a yaw or a quaternion."""
    return "yaw" in values or "qw" in values


def poses_of(values: Mapping[str, Floats]) -> Floats:
    """Poses (n, 3) from x, y and yaw, or from a quaternion of any length but zero, which gives NaN.

    Positions alone have NaN for yaw.
    """
    if "yaw" in values:
        yaw = values["yaw"]
    elif not has_yaw(values):
        yaw = np.full(len(values["x"]), np.nan)
    else:
        x, y, z, w = (values[f"q{axis}"] for axis in "xyzw")
        yaw = np.arctan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)
        yaw = np.where(x * x + y * y + z * z + w * w > 0, yaw, np.nan)
    return np.stack([values["x"], values["y"], yaw], axis=1)
