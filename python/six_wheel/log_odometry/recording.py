"""Dead reckoning as a record: the readings, where the rover is by them, how sure that is, and the slip."""

from collections.abc import Sequence
from pathlib import Path

from six_wheel._core import Rover
from six_wheel.kinematics.objects.closing import Closing
from six_wheel.kinematics.odometry.tracks import OdometryHealth, Track
from six_wheel.kinematics.poses import Floats
from six_wheel.logs.joint_totals import JointRows
from six_wheel.logs.mcap import RoverRecord
from six_wheel.logs.mcap.writer import record_stamps
from six_wheel.robot_description.wheels_of_rover import reading_joints


class TrackRecord(Closing):
    """Writes tracks into an MCAP file of `logs.mcap`, chunk by chunk, beside a parameter file as text.

    Stamps are counted from the second `origin`.
    """

    def __init__(self, path: Path, rover: Rover, parameters: str, origin: int) -> None:
        self._origin = origin
        self._names, self._signs = reading_joints(rover)
        self._record = RoverRecord(path, rover, "odometry", parameters)

    def write(self, chunk: JointRows, track: Track, covariances: Sequence[tuple[Floats, Floats]]) -> None:
        """Append rows, with the 6 x 6 covariances of pose and twist of each. Raises `RowError` if a time is
        one that a message cannot have."""
        record, residuals = self._record, track.residuals
        assert residuals is not None
        stamps = record_stamps(chunk.stamps, chunk.rows, origin=self._origin)
        for row, stamp in enumerate(stamps.tolist()):
            steering = [] if chunk.steering is None else chunk.steering[row].tolist()
            readings = [*steering, *chunk.wheel_angles[row].tolist()]
            joints = [sign * value for sign, value in zip(self._signs, readings, strict=True)]
            record.joints(stamp, stamp, self._names, joints)
            if track.health[row] & int(OdometryHealth.LEFT_OUT):
                continue
            pose, twist = track.poses[row].tolist(), track.twists[row].tolist()
            of_pose, of_twist = (each.ravel().tolist() for each in covariances[row])
            record.odometry(stamp, stamp, pose, twist, of_pose, of_twist)
            record.slip(stamp, residuals[row].tolist())

    def close(self) -> None:
        self._record.close()
