"""Everything a loop is told: the parameter file as text, changes to it, and options beside it."""

import inspect
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from six_wheel._core import Controller, Encoder, Noise, Odometry, Rover
from six_wheel.control_loop.options import OPTIONS, Options
from six_wheel.kinematics.keywords import checked_class
from six_wheel.kinematics.rover_edit import limits_given
from six_wheel.logs.log_options import corrections, encoders_of
from six_wheel.robot_description.gyroscope_errors import with_readings_apart
from six_wheel.robot_description.parameters import ros_yaml
from six_wheel.robot_description.parameters.detect_format import section_of
from six_wheel.robot_description.parameters.file import Parameters, parse_parameters
from six_wheel.robot_description.parameters.key_types import GROUPS
from six_wheel.robot_description.parameters.ros_node_parameters import PARAMETERS
from six_wheel.robot_description.parameters.writing import dump

LEAST_JUMP = 3.0  # [m/s], 6 cm at 50 Hz: a rover that is pushed, or rolls, may be faster than it drives
NAMES = frozenset(option.name for option in OPTIONS)
# Parameters of ros2_controllers that a node has too.
SHARED = (
    "enable_odom_tf",
    "open_loop",
    "pose_covariance_diagonal",
    "position_feedback",
    "publish_limited_velocity",
    "publish_rate",
    "reference_timeout",
    "twist_covariance_diagonal",
    "use_stamped_vel",
)


@checked_class
@dataclass(frozen=True)
class Settings:
    """Settings of a loop.

    Attributes
    ----------
    text : str
        The parameter file, changes included.
    parameters : Parameters
        Its keys and values.
    options : Options
    node_options : dict
        Other options of a node in the file, unchecked.
    """

    text: str
    parameters: Parameters
    options: Options = field(default_factory=Options)
    node_options: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def of_text(
        cls,
        text: str,
        *,
        node: str | None = None,
        path: Path = Path("rover.yaml"),
        options: Options | None = None,
    ) -> "Settings":
        """From the text of a parameter file, which messages call `path`."""
        return cls(text, parse_parameters(text, node=node, path=path), options or Options())

    @classmethod
    def of_parameters(cls, given: Parameters, options: Options | None = None) -> "Settings":
        """From a parameter file that has been read: its own keys, where they alone tell what it is. Options
        that are not given are those of the file."""
        try:
            file = given.path.read_text(encoding="utf-8-sig")
            text = with_changes(file, given.node, {})
            again = parse_parameters(text, node=given.node, path=given.path)
        except (OSError, ValueError):
            pass  # another language than YAML, or a kind that only the command line told
        else:
            if same(again, given):
                of_node = _options_of_node(file, given)
                options = options or Options.of({name: of_node[name] for name in NAMES & of_node.keys()})
                return cls(text, replace(given, kind_given=None), options, of_node)
        text = own_text(given)
        return cls(text, parse_parameters(text, path=given.path), options or Options())

    @classmethod
    def of_rover(cls, rover: Rover, options: Options | None = None, **others: Any) -> "Settings":
        """Settings of a rover without a parameter file; `others` are the arguments of `dump`."""
        return cls.of_text(dump(rover, **others), options=options)

    @property
    def rover(self) -> Rover:
        """The rover that is driven."""
        return self.parameters.rover

    def changed(self, changes: Mapping[str, Any]) -> "Settings":
        """With other values for some keys of the parameter file or options.

        Raises
        ------
        ValueError
            If a key or value cannot be used, or makes no difference.
        """
        options = {key: value for key, value in changes.items() if key in NAMES}
        keys = {key: value for key, value in changes.items() if key not in NAMES}
        others = Options.of(self.options.values() | options)
        if not keys:
            return replace(self, options=others)
        text = with_changes(self.text, self.parameters.node, keys)
        listed = ", ".join(f"{key}={value}" for key, value in keys.items())
        path = Path(f"{self.parameters.path.name} with {listed}")
        parameters = parse_parameters(text, node=self.parameters.node, path=path)
        for key, value in keys.items():
            without = {other: keys[other] for other in keys if other != key}
            before = self.parameters
            if without:
                before = parse_parameters(with_changes(self.text, before.node, without), node=before.node)
            if same(parameters, before) and not _is_set(self, key, value):
                raise ValueError(f"{key} must be a key that this rover's parameters have, got {key}={value}")
        return Settings(text, replace(parameters, path=self.parameters.path), others)

    def controller(self, **start: Any) -> Controller:
        """A controller as the file says; `start` is where and how it begins."""
        return self.parameters.build_controller(**start)

    def controller_option(self, name: str) -> Any:
        """A keyword of the controller: as the file has it, or else its default."""
        return self.parameters.control.get(name, inspect.signature(Controller).parameters[name].default)

    @property
    def listens(self) -> bool:
        """True if a gyroscope is used: the file states its errors, and the loop is closed."""
        return self.parameters.known_gyroscope is not None and not self.options.open_loop

    def odometry(self, apart: float | None = None, bias: tuple[float, float] | None = None) -> Odometry:
        """Odometry as the file says, of joint states `apart` [s] from each other; `bias` is what has been
        learnt of that of the gyroscope, with its deviation [rad/s]."""
        given, rover = self.parameters, self.rover
        readings = "angles" if self.options.position_feedback else "speeds"
        options: dict[str, Any] = self._jumps() | given.odometry | {"dimensions": given.dimensions}
        if given.wheel_encoders.get("increments"):
            readings, options["increments"] = "angles", True
        if self.listens and (gyroscope := given.known_gyroscope) is not None:
            if bias is not None:
                gyroscope = gyroscope.replace(bias=bias[0], bias_noise=bias[1])
            options["gyroscope"] = with_readings_apart(gyroscope, given.gyroscope.get("period"), apart)
        if given.wheel_encoders:
            _, scale = corrections(rover, given.wheel_encoders)
            known = encoders_of(rover, "wheel", given.wheel_encoders) or dict.fromkeys(
                rover.wheel_names, Encoder()
            )
            options["wheel_encoders"] = {
                wheel: Encoder(
                    each.ticks_per_turn, gear_ratio=each.gear_ratio / scale, wraps_at=each.wraps_at
                )
                for wheel, each in known.items()
            }
        return Odometry(rover, Noise(**given.noise), readings=readings, **options)  # type: ignore[arg-type]

    def _jumps(self) -> dict[str, float]:
        """The rim speed [m/s] beyond which a counter must have started over, where the file gives none: twice
        that of the fastest wheel's limit."""
        fastest = limits_given(self.parameters.limits).get("wheel_speed", math.inf)
        rim = fastest * max(wheel.radius for wheel in self.rover.wheels)
        return {"max_speed": max(2.0 * rim, LEAST_JUMP)} if math.isfinite(rim) else {}

    def steering_factors(self) -> list[tuple[float, float]]:
        """For every steered wheel the factor and the offset that make its reading an angle [rad]."""
        given, rover = self.parameters, self.rover
        known = encoders_of(rover, "steering", given.steering_encoders)
        gains, _ = corrections(rover, given.wheel_encoders)
        factors = []
        for wheel, gain in zip(rover.steered_wheel_names, gains.tolist(), strict=True):
            each = known.get(wheel, Encoder())
            factors.append((gain * each.angle_per_tick, gain * each.offset))
        return factors


def _options_of_node(text: str, given: Parameters) -> dict[str, Any]:
    """Options of a node in its parameter file; of a controller's file those that mean the same there."""
    found = _section(text, given.node)
    data: dict[str, Any] = found.data | found.node_options
    if given.controller is None:
        return data
    if data.get("tf_frame_prefix_enable") is False:
        data.pop("tf_frame_prefix", None)
    return {name: data[name] for name in (*SHARED, *found.node_options) if name in data}


def same(one: Parameters, other: Parameters) -> bool:
    """True if two files hold the same parameters; their paths and warnings do not count."""
    whatever: dict[str, Any] = {"path": Path(), "warnings": (), "kind_given": None}
    return replace(one, **whatever) == replace(other, **whatever)


def _is_set(settings: Settings, key: str, value: Any) -> bool:
    """True if the file has this value under `key` already."""
    data: Any = _section(settings.text, settings.parameters.node).data
    if key in data:
        return bool(data[key] == value)
    head, _, tail = key.partition(".")
    inner = data.get(head)
    return isinstance(inner, dict) and tail in inner and inner[tail] == value


def with_changes(text: str, node: str | None, changes: Mapping[str, Any]) -> str:
    """The text of a parameter file of the one node, with other values; None takes a key away."""
    found = _section(text, node)
    data: dict[str, Any] = dict(found.data)
    for key, value in changes.items():
        head, _, tail = key.partition(".")
        if tail and head in GROUPS:
            inner = dict(data.get(head) or {})
            data[head] = _with(inner, tail, value)
        else:
            data = _with(data, key, value)
    data = {key: value for key, value in data.items() if value != {}}
    name = found.node
    return ros_yaml.write(data if name is None else {name: {PARAMETERS: data}})


def _with(data: dict[str, Any], key: str, value: Any) -> dict[str, Any]:
    if value is None:
        return {name: each for name, each in data.items() if name != key}
    return data | {key: value}


def rover_keys(settings: Settings) -> dict[str, Any]:
    """The keys of the rover itself by the names of ROS parameters, as far as those can hold them."""
    keys: dict[str, Any] = {}

    def lay(prefix: str, data: Mapping[str, Any]) -> None:
        for key, value in data.items():
            name = f"{prefix}{key}"
            if isinstance(value, dict):
                lay(f"{name}.", value)
            elif isinstance(value, list):
                kinds = {type(each) for each in value}
                if len(kinds) == 1 and kinds <= {bool, int, float, str}:
                    keys[name] = value
            elif isinstance(value, bool | int | float | str):
                keys[name] = value

    data: dict[str, Any] = _section(settings.text, settings.parameters.node).data
    lay("", {key: value for key, value in data.items() if key not in ("limits", "control", "noise")})
    control = data.get("control") or {}  # its timeout is cmd_vel_timeout
    lay("control.", {key: value for key, value in control.items() if key != "timeout"})
    return keys


def read_value(text: str) -> Any:
    """A value as a parameter file would have it."""
    tree = ros_yaml.parse(f"value: {text}", lambda *_: None)
    return tree.data["value"]


def _section(text: str, node: str | None) -> Any:
    """The parameters of the node; the text is known to have them."""
    found = section_of(ros_yaml.parse(text, lambda *_: None), node, lambda *_: None)
    if found is None:
        raise ValueError(f"the parameter file must have the node, got {node}")
    return found


def own_text(given: Parameters) -> str:
    """A parameter file with this package's own keys that says the same."""
    frames = {"odom_frame_id": given.odom_frame_id, "base_frame_id": given.base_frame_id}
    text = dump(given.rover, limits=given.limits, control=given.control, **frames)
    groups = ("noise", "wheel_encoders", "steering_encoders", "odometry", "gyroscope", "truth", "calibration")
    return with_changes(text, None, {key: dict(getattr(given, key)) for key in groups if getattr(given, key)})
