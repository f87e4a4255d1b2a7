"""Options for what a log does not state, from the keys of a parameter file."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from six_wheel._core import Encoder, Rover
from six_wheel.kinematics.odometry.headers.joint_columns import Reading
from six_wheel.kinematics.odometry.headers.renamed import Columns
from six_wheel.kinematics.poses import Floats, inverse, joined
from six_wheel.logs.bags.bag_files import Topics
from six_wheel.logs.joint_totals import Encoders
from six_wheel.logs.recordings import GroundTruth

__all__ = ["CORRECTIONS", "LogOptions", "corrections", "encoders_of", "log_options"]

# Of the keys of encoders those that hold for angles too, however they were read.
CORRECTIONS = frozenset({"scale", "steering_gain"})


@dataclass(frozen=True)
class LogOptions:
    """Options for what a log does not state; see `JointLog`. Encoders, truth and gyroscope have a parameter
    file's keys; `frame` is its base_frame_id."""

    format: str | None = None
    reading: Reading | None = None
    encoders: Mapping[str, Any] = field(default_factory=dict)
    steering_encoders: Mapping[str, Any] = field(default_factory=dict)
    columns: Columns = field(default_factory=dict)
    topics: Topics = ()
    truth_topic: str | None = None
    truth: Mapping[str, float] = field(default_factory=dict)
    gyroscope: Mapping[str, Any] = field(default_factory=dict)
    frame: str = ""
    stamp_unit: str | None = None
    plausibility: bool = True
    max_speed: float | None = None
    max_gap: float | None = None
    wheel_encoders: Encoders = None
    joint_encoders: Encoders = None

    @property
    def sensor(self) -> Floats:
        """Pose in the body of the point that the truth follows: x, y, yaw (3,) [m, m, rad]."""
        return np.array([self.truth.get(axis, 0.0) for axis in ("x", "y", "yaw")])

    def of_body(self, truth: GroundTruth) -> GroundTruth:
        """The truth of the body itself, in the clock of the log, by the key ``truth`` of a parameter file.

        Positions alone stay those of the sensor: without a heading none tells where the body is.
        """
        sensor = self.sensor
        offset = self.truth.get("time_offset", 0.0)
        if not (sensor.any() or offset):
            return truth
        poses = joined(truth.poses, inverse(sensor)) if truth.has_headings else truth.poses
        return replace(truth, stamps=truth.stamps - offset, poses=poses)


def log_options(how: Mapping[str, Any]) -> LogOptions:
    """Options by the names that Python's functions give them.

    Raises
    ------
    TypeError
        If there is no such option.
    """
    names = {"wheel_encoders", "steering_encoders", "columns", "topics", "stamp_unit", "plausibility"}
    names |= {"max_speed", "max_gap", "reading", "truth_topic", "gyroscope"}
    if strangers := [name for name in how if name not in names]:
        raise TypeError(f"there is no option {strangers[0]!r}; there are {', '.join(sorted(names))}")
    given = dict(how)
    if "steering_encoders" in given:
        given["joint_encoders"] = given.pop("steering_encoders")
    return LogOptions(**given)


def encoders_of(rover: Rover, part: str, values: Mapping[str, Any]) -> dict[str, Encoder]:
    """Encoders by wheel, from the keys of a parameter file; none if these say nothing about them."""
    if not values.keys() - CORRECTIONS:
        return {}
    joints = rover.traction_joints if part == "wheel" else rover.steering_joints
    wheels = rover.wheel_names if part == "wheel" else rover.steered_names
    turned = {joints.get(name, name) for name in values.get("reversed", ())}
    offsets = {joints.get(name, name): offset for name, offset in values.get("offsets", {}).items()}
    resolution, gear, modulus = (values.get(key) for key in ("resolution", "gear", "modulus"))
    return {
        wheel: Encoder(
            resolution,
            gear=(1.0 if gear is None else gear) * (-1.0 if wheel in turned else 1.0),
            modulus=modulus,
            offset=offsets.get(wheel, 0.0),
        )
        for wheel in wheels
    }


def corrections(rover: Rover, values: Mapping[str, Any]) -> tuple[Floats, float]:
    """Factors for the steering angles (steered wheels,) and for the wheels' angles."""
    gains = values.get("steering_gain", {})
    named = {rover.steering_joints.get(name, name): gain for name, gain in gains.items()}
    return np.array([named.get(wheel, 1.0) for wheel in rover.steered_names]), values.get("scale", 1.0)
