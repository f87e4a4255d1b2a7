"""Recording of the inputs and outputs of a loop, from which it can be run again."""

from pathlib import Path

from six_wheel.control_loop.settings import Settings
from six_wheel.control_loop.steps import Step
from six_wheel.logs.mcap import RoverRecord
from six_wheel.logs.mcap.rover_record import Frames


class Recorder(RoverRecord):
    """A record of one loop: what comes in is written as it came, in that order, and then the step.

    A file that is there is replaced. The loop begins with these settings.
    """

    def __init__(self, path: Path, settings: Settings, made_by: str = "node") -> None:
        said = settings.parameters
        frames = Frames(said.odom_frame_id, said.base_frame_id)
        others = {"options": settings.options.values(), "node": said.node}
        super().__init__(path, settings.rover, made_by, settings.text, others, frames)

    def step(self, step: Step) -> None:
        """Record the outputs of a step."""
        now = step.now
        if step.steering is not None and step.wheel_speeds is not None:
            self.commands(now, step.steering, step.wheel_speeds)
            self.limited(now, step.twist)
            self.reasons(now, step.reasons)
        if step.state is not None and step.stamp is not None:
            state = step.state
            covariances = state.covariance_6x6().ravel(), state.twist_covariance_6x6().ravel()
            motion = state.pose.tolist(), state.twist.tolist(), *(each.tolist() for each in covariances)
            self.odometry(now, step.stamp, *motion)
            self.slip(now, state.residuals.tolist())
