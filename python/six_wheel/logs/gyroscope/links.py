"""Mounting of a sensor in a rover, by the transforms between their frames."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from six_wheel.kinematics.poses import Floats


class Links:
    """Frames and those they are fixed to; `own` are possible names of the rover's own frame."""

    def __init__(self, own: Sequence[str]) -> None:
        self._own = own
        self._parents: dict[str, tuple[str, Floats]] = {}

    def add(self, transforms: Iterable[Any]) -> None:
        """geometry_msgs/TransformStamped; the first one of a frame counts: a sensor stays where it sits."""
        for each in transforms:
            q = each.transform.rotation
            x, y, z, w = q.x, q.y, q.z, q.w
            rows = np.array(
                (
                    (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
                    (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
                    (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
                )
            )
            child, parent = (str(name).lstrip("/") for name in (each.child_frame_id, each.header.frame_id))
            self._parents.setdefault(child, (parent, rows))

    def owns(self, frame: str) -> bool:
        """True if a frame is the rover's own; a frame without a name counts as that."""
        return not frame or frame in self._own

    def up(self, frame: str) -> Floats | None:
        """The rover's z in the axes of a frame, shape (3,); None where that is not known."""
        turn, seen = np.eye(3), set[str]()
        while not self.owns(frame):
            if frame in seen or frame not in self._parents:
                return None
            seen.add(frame)
            frame, rotation = self._parents[frame]
            turn = rotation @ turn
        up: Floats = turn[2]
        return up
