"""Recording of the inputs and outputs of a loop, from which it can be run again."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from six_wheel.control_loop.settings import Settings
from six_wheel.control_loop.steps import Step
from six_wheel.logs.mcap import RoverRecord
from six_wheel.logs.mcap.rover_record import Frames

__all__ = ["Recorder"]


class Recorder:
    """A record of one loop: what comes in is written as it came, in that order, and then the step.

    Parameters
    ----------
    path : Path
        A .mcap file; what is there is replaced.
    settings : Settings
        Those that the loop begins with.
    made_by : {"node", "simulate"}
    """

    def __init__(self, path: Path, settings: Settings, made_by: str = "node") -> None:
        said = settings.parameters
        frames = Frames(said.odom_frame_id, said.base_frame_id)
        others = {"options": settings.options.values(), "node": said.node}
        self.record = RoverRecord(path, settings.rover, made_by, settings.text, others, frames)

    def command(self, twist: Sequence[float], stamp: int, now: int) -> None:
        """As `Loop.command`."""
        self.record.wanted(now, stamp, twist)

    def joints(self, message: bytes, stamp: int, now: int) -> None:
        """As `Loop.joints`: the message as it came."""
        self.record.joint_message(now, stamp, message)

    def imu(self, message: bytes, stamp: int, now: int) -> None:
        """As `Loop.imu`: the message as it came."""
        self.record.imu_message(now, stamp, message)

    def tick(self, now: int) -> None:
        """As `Loop.tick`."""
        self.record.tick(now)

    def change(self, what: Mapping[str, Any], now: int) -> None:
        """Record a change: ``{"set": {...}}``, ``{"pose": ..., "covariance": ...}``, ``{"active": ...}``,
        ``{"halt": True}``, ``{"release": True}``, ``{"end": True}``, ..."""
        self.record.change(now, what)

    def step(self, step: Step) -> None:
        """Record the outputs of a step."""
        record, now = self.record, step.now
        if step.steering is not None and step.wheel_speeds is not None:
            record.commands(now, step.steering, step.wheel_speeds)
            record.limited(now, step.twist)
            record.reasons(now, step.reasons)
        if step.state is not None and step.stamp is not None:
            state = step.state
            record.odometry(
                now,
                step.stamp,
                state.pose.tolist(),
                state.twist.tolist(),
                state.covariance_6x6().ravel().tolist(),
                state.twist_covariance_6x6().ravel().tolist(),
            )
            record.slip(now, state.residuals.tolist())

    def diagnostics(self, now: int, statuses: Sequence[tuple[int, str, str, Mapping[str, str]]]) -> None:
        """A report."""
        self.record.diagnostics(now, statuses)

    def close(self) -> None:
        """End the file."""
        self.record.close()
