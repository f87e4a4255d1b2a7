"""The poses of a bag."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from six_wheel.logs.bags.messages import OWN_FRAMES, POSES, Bag
from six_wheel.logs.skip_bad_rows import Batch

MAX_FRAMES = 16  # between a rover and the top of its chain, which might be a circle


class TruthBag(Bag):
    """Poses in a bag: odometry, stamped poses or transforms of one topic.

    `topic` is the one to read. Transforms of many frames (``/tf``) have to be asked for, and may name the
    frame of the rover behind a colon: ``/tf:base_link``. Its pose is that in the frame at the top of its
    chain.
    """

    def __init__(self, path: Path, topic: str | None = None) -> None:
        super().__init__(path)
        name, _, frame = (topic or "").partition(":")
        self._frames = (frame.lstrip("/"),) if frame else OWN_FRAMES
        self._tree: dict[str, tuple[str, Any]] = {}
        self._choose(POSES, None if topic is None else [name], usual="truth")

    def batches(self, chunk_rows: int) -> Iterator[Batch]:
        """A row for every message."""
        rows = (
            (number, when, pose)
            for number, stamp, message in self.messages()
            for when, pose in (
                self._moved(message) if hasattr(message, "transforms") else [(stamp, _pose(message))]
            )
        )
        return self.batched(rows, ("x", "y", "z", "qx", "qy", "qz", "qw"), chunk_rows)

    def _moved(self, message: Any) -> Iterator[tuple[int, tuple[float, ...]]]:
        """Stamps and poses of the rover that transforms tell, through the frames known so far."""
        for each in message.transforms:
            frame, parent = (str(name).lstrip("/") for name in (each.child_frame_id, each.header.frame_id))
            self._tree[frame] = (parent, each.transform)
            if frame not in self._frames:
                continue
            poses = list[tuple[float, ...]]()
            while frame in self._tree and len(poses) < MAX_FRAMES:
                frame, transform = self._tree[frame]
                poses.append(_row(transform.translation, transform.rotation))
            stamp = each.header.stamp
            yield stamp.sec * 1_000_000_000 + stamp.nanosec, _composed(poses)


def _row(p: Any, q: Any) -> tuple[float, ...]:
    """Position and quaternion of a transform, a row of the batch."""
    return p.x, p.y, p.z, q.x, q.y, q.z, q.w


def _composed(poses: Sequence[tuple[float, ...]]) -> tuple[float, ...]:
    """A pose through several frames, the innermost first."""
    point, turned = np.zeros(3), np.array((0.0, 0.0, 0.0, 1.0))
    for x, y, z, *rotation in poses:
        axis, w = np.array(rotation[:3]), rotation[3]
        # v + 2 q x (q x v + w v), with q the vector of the quaternion and w its scalar
        point = point + 2.0 * np.cross(axis, np.cross(axis, point) + w * point) + (x, y, z)
        vector = w * turned[:3] + turned[3] * axis + np.cross(axis, turned[:3])
        turned = np.append(vector, w * turned[3] - axis @ turned[:3])
    return (*point.tolist(), *turned.tolist())


def _pose(message: Any) -> tuple[float, ...]:
    if hasattr(message, "transform"):
        return _row(message.transform.translation, message.transform.rotation)
    pose = getattr(message.pose, "pose", message.pose)  # inside a covariance
    return _row(pose.position, pose.orientation)
