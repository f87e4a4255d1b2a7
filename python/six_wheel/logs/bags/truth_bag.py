"""The poses of a bag."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from six_wheel.logs.bags.messages import LINE, OWN_FRAMES, POSES, Bag
from six_wheel.logs.skip_bad_rows import Batch

MAX_FRAMES = 16  # between a rover and the top of its chain, which might be a circle


class TruthBag(Bag):
    """Poses in a bag: odometry, stamped poses or transforms of one topic.

    Parameters
    ----------
    path : Path
    topic : str, optional
        Which. Transforms of many frames (``/tf``) have to be asked for, and may name the frame of the rover
        behind a colon: ``/tf:base_link``. Its pose is that in the frame at the top of its chain.
    """

    def __init__(self, path: Path, topic: str | None = None) -> None:
        super().__init__(path)
        name, _, frame = (topic or "").partition(":")
        self._frames = (frame.lstrip("/"),) if frame else OWN_FRAMES
        self._tree: dict[str, tuple[str, Any]] = {}
        self._choose(POSES, None if topic is None else [name], usual="truth")

    def batches(self, chunk_rows: int) -> Iterator[Batch]:
        """A row for every message."""
        names = ("x", "y", "qx", "qy", "qz", "qw")
        numbers: list[int] = []
        stamps: list[int] = []
        rows: list[tuple[float, ...]] = []

        def batch() -> Batch:
            columns = np.array(rows, dtype=float).reshape(-1, len(names)).T
            values = dict(zip(names, columns, strict=True))
            made = Batch(
                np.array(numbers), np.full(len(rows), LINE), np.array(stamps, dtype=np.int64), values
            )
            for each in (numbers, stamps, rows):
                each.clear()
            return made

        for number, stamp, message in self.messages():
            self.position = number
            found = [(stamp, _pose(message))] if not hasattr(message, "transforms") else self._moved(message)
            for when, pose in found:
                numbers.append(number)
                stamps.append(when)
                rows.append(pose)
            if len(rows) >= chunk_rows:
                yield batch()
        if rows:
            yield batch()

    def _moved(self, message: Any) -> list[tuple[int, tuple[float, ...]]]:
        """Stamps and poses of the rover that transforms tell, through the frames known so far."""
        found = []
        for each in message.transforms:
            frame, parent = (str(name).lstrip("/") for name in (each.child_frame_id, each.header.frame_id))
            self._tree[frame] = (parent, each.transform)
            if frame not in self._frames:
                continue
            poses = list[tuple[float, float, float]]()
            while frame in self._tree and len(poses) < MAX_FRAMES:
                frame, transform = self._tree[frame]
                poses.append(_planar(transform.translation, transform.rotation))
            stamp = each.header.stamp
            found.append((stamp.sec * 1_000_000_000 + stamp.nanosec, _composed(poses)))
        return found


def _planar(p: Any, q: Any) -> tuple[float, float, float]:
    """x, y and yaw of a transform."""
    return p.x, p.y, math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))


def _composed(poses: Sequence[tuple[float, float, float]]) -> tuple[float, ...]:
    """A pose through frames that lie level, the innermost first, as x, y and a quaternion."""
    x = y = yaw = 0.0
    for ahead, aside, turned in poses:
        cos, sin = math.cos(turned), math.sin(turned)
        x, y, yaw = ahead + cos * x - sin * y, aside + sin * x + cos * y, turned + yaw
    return x, y, 0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)


def _pose(message: Any) -> tuple[float, ...]:
    if hasattr(message, "transform"):
        p, q = message.transform.translation, message.transform.rotation
    else:
        pose = getattr(message.pose, "pose", message.pose)  # inside a covariance
        p, q = pose.position, pose.orientation
    return p.x, p.y, q.x, q.y, q.z, q.w
