"""Options for what a log does not state, from the keys of a parameter file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import numpy as np

from six_wheel._core import Encoder, Rover
from six_wheel.kinematics.errors import ArgumentTypeError
from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.poses import Floats, inverse, joined
from six_wheel.logs.bags.bag_files import Topics
from six_wheel.logs.ground_truth import rows_of, transforms
from six_wheel.logs.headers.joint_columns import Reading
from six_wheel.logs.headers.renamed import Columns
from six_wheel.logs.joint_totals import Encoders
from six_wheel.logs.recordings import GroundTruth

# Of the keys of encoders those that hold for angles too, however they were read.
CORRECTIONS = frozenset({"scale", "steering_gain"})
# Encoders, or the keys of a parameter file that describe them.
AnyEncoders: TypeAlias = "Encoders | Mapping[str, Any]"


@checked_class
@dataclass(frozen=True)
class LogOptions:
    """Options for what a log does not state; see `JointLog`. Truth and gyroscope have the keys of a parameter
    file, encoders these or are `Encoder`; `frame` is its base_frame_id."""

    format: str | None = None
    readings: Reading | None = None
    wheel_encoders: AnyEncoders = field(default_factory=dict)
    steering_encoders: AnyEncoders = field(default_factory=dict)
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
    increments: bool | None = None  # wheels count from the row before; None: as `wheel_encoders` say

    @property
    def wheel_keys(self) -> Mapping[str, Any]:
        """The key ``wheel_encoders`` of a parameter file, without encoders that are given themselves."""
        keys = encoders_or_keys("wheel_encoders", self.wheel_encoders)[1]
        return keys if self.increments is None else {**keys, "increments": self.increments}

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
        stamps = truth.stamps - offset
        if truth.has_space:
            x, y, yaw = sensor
            body_from_sensor = transforms(np.array([[x, y, 0.0, 0.0, 0.0, yaw]]))
            of_sensor = transforms(truth.at_in_space(truth.stamps))
            moved = rows_of(of_sensor @ np.linalg.inv(body_from_sensor))
            return replace(truth, stamps=stamps, poses=moved, space=None)
        poses = joined(truth.poses, inverse(sensor)) if truth.has_yaw else truth.poses
        return replace(truth, stamps=stamps, poses=poses)


def encoders_or_keys(argument: str, given: AnyEncoders) -> tuple[Encoders, Mapping[str, Any]]:
    """Encoders where they are given themselves, else None; and the keys of a parameter file, else none."""
    if given is None or isinstance(given, Encoder):
        return given, {}
    if not isinstance(given, Mapping):
        rule = "an Encoder, or a dict of them by the names of joints"
        raise ArgumentTypeError(
            f"{argument} must be {rule}, got {given!r}: give sw.Encoder(ticks_per_turn=...)"
        )
    if given and all(isinstance(each, Encoder) for each in given.values()):
        return given, {}
    return None, given


def encoders_of(rover: Rover, part: str, values: Mapping[str, Any]) -> dict[str, Encoder]:
    """Encoders by wheel, from the keys of a parameter file; none if these say nothing about them."""
    if not values.keys() - CORRECTIONS:
        return {}
    joints = rover.traction_joints if part == "wheel" else rover.steering_joints
    wheels = rover.wheel_names if part == "wheel" else rover.steered_wheel_names
    turned = {joints.get(name, name) for name in values.get("reversed", ())}
    offsets = {joints.get(name, name): offset for name, offset in values.get("offsets", {}).items()}
    ticks, gear, wraps_at = (values.get(key) for key in ("ticks_per_turn", "gear_ratio", "wraps_at"))
    return {
        wheel: Encoder(
            ticks,
            gear_ratio=(1.0 if gear is None else gear) * (-1.0 if wheel in turned else 1.0),
            wraps_at=wraps_at,
            offset=offsets.get(wheel, 0.0),
        )
        for wheel in wheels
    }


def keys_of(argument: str, given: AnyEncoders, names: Sequence[str]) -> dict[str, Any] | None:
    """Keys of a parameter file that make these encoders of the joints of wheels; None where no keys do."""
    encoders, keys = encoders_or_keys(argument, given)
    if encoders is None or not names:
        return dict(keys)
    each = [encoders.get(name) if isinstance(encoders, Mapping) else encoders for name in names]
    known = [one for one in each if one is not None]
    alike = {(one.ticks_per_turn, abs(one.gear_ratio), one.wraps_at) for one in known}
    if len(known) < len(each) or len(alike) != 1:
        return None
    found: dict[str, Any] = dict(zip(("ticks_per_turn", "gear_ratio", "wraps_at"), alike.pop(), strict=True))
    found["reversed"] = [name for name, one in zip(names, known, strict=True) if one.gear_ratio < 0.0] or None
    if argument == "steering_encoders":
        offsets = {name: one.offset for name, one in zip(names, known, strict=True) if one.offset}
        found["offsets"] = offsets or None
    return {key: value for key, value in found.items() if value is not None}


def corrections(rover: Rover, values: Mapping[str, Any]) -> tuple[Floats, float]:
    """Factors for the steering angles (steered wheels,) and for the wheels' angles."""
    gains = values.get("steering_gain", {})
    named = {rover.steering_joints.get(name, name): gain for name, gain in gains.items()}
    return np.array([named.get(wheel, 1.0) for wheel in rover.steered_wheel_names]), values.get("scale", 1.0)
