"""Types of the keys of a parameter file, and the keys that every rover may have.

The rules for numbers are the core's own, asked one argument at a time; types and names are here.
"""

from collections.abc import Callable
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import AfterValidator, BaseModel, Discriminator, Field, Strict, Tag
from pydantic.fields import FieldInfo

from six_wheel._core import Encoder, Gyroscope, Noise, Odometry, Rover, Wheel, without_questions

Values: TypeAlias = dict[str, Any]


def asks_core(call: Callable[..., object], argument: str, **others: Any) -> AfterValidator:
    """The core's own rule for one argument of `call`; its message is told with the file's key in front."""

    def check(value: Any) -> Any:
        without_questions(lambda: call(**others | {argument: as_argument(value)}))  # they become findings
        return value

    return AfterValidator(check)


def as_argument(value: Any) -> Any:
    """A value of a parameter file as the core takes it: a pair is a tuple."""
    return tuple(map(as_argument, value)) if isinstance(value, list) else value


def refusal(argument: str, problem: str) -> ValueError:
    """An error with the attributes that those of the core have."""
    error = ValueError(f"{argument} {problem}")
    vars(error).update(argument=argument, place="", problem=problem)
    return error


def check_name(text: str) -> str:
    if not text.strip() or not text.isprintable():
        raise ValueError(f"a name must have visible characters and no others, got {text!r}")
    return text


def _check_factor(value: float) -> float:
    """A factor whose sign says which way a joint counts."""
    Wheel("wheel", 0.0, 0.0, radius=abs(value))
    return value


def by_type(kind: type, tag: str, otherwise: str) -> Discriminator:
    """Discriminator of two forms of a value. Without it pydantic reports a bad value once for each form."""
    return Discriminator(lambda value: tag if isinstance(value, kind) else otherwise)


_WHEEL: Values = {"name": "wheel", "x": 0.0, "y": 0.0, "radius": 1.0}
Number: TypeAlias = Annotated[float, Strict()]
Flag: TypeAlias = Annotated[bool, Strict()]
Finite: TypeAlias = Annotated[Number, asks_core(Wheel, "x", **_WHEEL)]
Length: TypeAlias = Annotated[Number, asks_core(Wheel, "radius", **_WHEEL)]
Positive: TypeAlias = Annotated[float, Strict(), Field(gt=0, allow_inf_nan=False)]
Limit: TypeAlias = Annotated[float, Strict(), Field(gt=0)]

OrNever: TypeAlias = Annotated[
    Annotated[Literal["never"], Tag("<word>")] | Annotated[Positive, Tag("<number>")],
    by_type(str, "<word>", "<number>"),
]

Name: TypeAlias = Annotated[str, Strict(), AfterValidator(check_name)]
Pair: TypeAlias = Annotated[list[Number], Field(min_length=2, max_length=2)]

NumberOrPair: TypeAlias = Annotated[
    Annotated[Number, Tag("<number>")] | Annotated[Pair, Tag("<pair>")],
    by_type(list, "<pair>", "<number>"),
]

SteeringLimit: TypeAlias = Annotated[NumberOrPair, asks_core(Wheel, "steering_limit", **_WHEEL, steered=True)]
Factor: TypeAlias = Annotated[Number, AfterValidator(_check_factor)]

Joints: TypeAlias = Annotated[
    Annotated[list[Name], Tag("<list>")] | Annotated[dict[str, Name], Tag("<map>")],
    by_type(dict, "<map>", "<list>"),
]


def optional(description: str, key: str | None = None) -> Any:
    """A key that may be left out."""
    return Field(default=None, description=description, alias=key)


def required(description: str, key: str | None = None) -> Any:
    """A key that must be given."""
    return Field(description=description, alias=key)


def _any_of(schema: type[BaseModel]) -> str:
    return f"a mapping with any of {', '.join(schema.model_fields)}"


class LimitKeys(BaseModel):
    """The keys of `limits`: the keywords of `six_wheel.Limits`; `.inf` is none."""

    speed: Limit = optional("a speed in m/s")
    yaw_rate: Limit = optional("a rate of turn in rad/s")
    acceleration: Limit = optional("an acceleration in m/s^2")
    deceleration: Limit = optional("an acceleration in m/s^2")
    jerk: Limit = optional("a jerk in m/s^3")
    angular_acceleration: Limit = optional("an angular acceleration in rad/s^2")
    angular_deceleration: Limit = optional("an angular acceleration in rad/s^2")
    angular_jerk: Limit = optional("an angular jerk in rad/s^3")
    lateral_acceleration: Limit = optional("an acceleration in m/s^2")
    wheel_speed: Limit = optional("a rate of turn in rad/s")
    wheel_acceleration: Limit = optional("an angular acceleration in rad/s^2")
    steering_limit: Limit = optional("an angle in radians")
    steering_rate: Limit = optional("a rate of turn in rad/s")
    steering_acceleration: Limit = optional("an angular acceleration in rad/s^2")
    halt_deceleration: Limit = optional("an acceleration in m/s^2")


class ControlKeys(BaseModel):
    """The keys of `control`: the keywords of `six_wheel.Controller`."""

    timeout: OrNever = optional("a time in s, or never")
    period: Positive = optional("a time in s")
    max_step: Positive = optional("a time in s")
    mode: Literal["free", "crab", "front_only", "spin"] = optional("free, crab, front_only or spin")
    align: Literal["cosine", "hold", "none"] = optional("cosine, hold or none")
    align_tolerance: Positive = optional("an angle in radians")
    discretise: Flag = optional("true or false")
    following_error: OrNever = optional("an angle in radians, or never")
    following_time: Positive = optional("a time in s")


NONE_WORDS = {"align": "none", "timeout": "never", "following_error": "never"}
"""Words of `control` for a keyword that is None."""


_AXLE: Values = {"rover": Rover.differential(1.0, 1.0)}


class NoiseKeys(BaseModel):
    """Keys of `Parameters.noise`: the arguments of `Noise`."""

    speed: Annotated[Number, asks_core(Noise, "speed")] = optional("a standard deviation in m/s")
    steering: Annotated[Number, asks_core(Noise, "steering")] = optional("a standard deviation in rad")
    slip: Annotated[Number, asks_core(Noise, "slip")] = optional("a standard deviation in m per root m")
    side_slip: Annotated[Number, asks_core(Noise, "side_slip")] = optional(
        "a standard deviation in m per root m"
    )


class _Counting(BaseModel):
    ticks_per_turn: Annotated[Number, asks_core(Encoder, "ticks_per_turn")] = optional(
        "the ticks of one turn of the shaft it sits on"
    )
    gear_ratio: Annotated[Number, asks_core(Encoder, "gear_ratio")] = optional(
        "the turns of that shaft for one of the joint"
    )
    wraps_at: Annotated[Number, asks_core(Encoder, "wraps_at")] = optional(
        "where a reading begins again at 0, such as 65536"
    )
    reversed: list[Name] = optional("a list of the wheels whose readings run the other way")


class EncoderKeys(_Counting):
    """Keys of `Parameters.wheel_encoders`, by which the readings of the wheels become angles."""

    increments: Flag = optional("whether a row counts from the row before")
    scale: Positive = optional("a factor for the angles of all wheels")
    steering_gain: dict[str, Positive] = optional("a mapping of steered wheel to a factor for its angle")


class SteeringEncoderKeys(_Counting):
    """Keys of `Parameters.steering_encoders`, by which their readings become steering angles."""

    offsets: dict[str, Finite] = optional("a mapping of steered wheel to its angle where the reading is 0")


class OdometryKeys(BaseModel):
    """Keys of `Parameters.odometry`: options of `Odometry`."""

    method: Annotated[Name, asks_core(Odometry, "method", **_AXLE)] = optional(
        "least_squares, middle_wheels or robust"
    )
    wheel_noise: dict[str, Annotated[Number, asks_core(Noise, "slip")]] = optional(
        "a mapping of wheel to how many times the noise it slips by"
    )
    inflate: Flag = optional("whether wheels that disagree widen the covariance")
    slip_threshold: Annotated[Number, asks_core(Odometry, "slip_threshold", **_AXLE)] = optional(
        "a residual in m/s"
    )
    max_gap: Annotated[Number, asks_core(Odometry, "max_gap", **_AXLE)] = optional("a time in s")
    max_speed: Annotated[Number, asks_core(Odometry, "max_speed", **_AXLE)] = optional("a speed in m/s")
    max_steering_rate: Annotated[Number, asks_core(Odometry, "max_steering_rate", **_AXLE)] = optional(
        "a rate of turn in rad/s"
    )


class GyroscopeKeys(BaseModel):
    """Keys of `Parameters.gyroscope`: arguments of `Gyroscope`, and conversions of its readings."""

    noise: Annotated[Number, asks_core(Gyroscope, "noise")] = optional("a standard deviation in rad/s")
    period: Positive = optional("the time between the readings whose noise that is in s")
    bias: Annotated[Number, asks_core(Gyroscope, "bias")] = optional("a reading at rest in rad/s")
    bias_noise: Annotated[Number, asks_core(Gyroscope, "bias_noise")] = optional(
        "a standard deviation in rad/s"
    )
    bias_walk: Annotated[Number, asks_core(Gyroscope, "bias_walk")] = optional(
        "a standard deviation in rad/s per root s"
    )
    scale: Positive = optional("a factor for the readings")
    scale_noise: Annotated[Number, asks_core(Gyroscope, "scale_noise")] = optional(
        "a standard deviation of that factor, as a share"
    )
    roll: Finite = optional("an angle in rad by which the sensor is turned about the rover's x")
    pitch: Finite = optional("an angle in rad by which the sensor is turned about the rover's y")
    time_offset: Finite = optional("a stamp of the gyroscope less that of the log in s")
    topic: Name = optional("the name of a topic of a bag, such as imu/data")


class TruthKeys(BaseModel):
    """Keys of `Parameters.truth`: the pose of the tracked point in the body, and the offset of the clock."""

    x: Finite = optional("a length in m, forward")
    y: Finite = optional("a length in m, to the left")
    yaw: Finite = optional("an angle in rad")
    time_offset: Finite = optional("a stamp of the truth less that of the log in s")


class CalibrationKeys(BaseModel):
    """Keys of `Parameters.calibration`: the covariance of the dimensions."""

    parameters: list[Name] = optional("a list of names, such as wheel_radius")
    covariance: list[list[Finite]] = optional("a list of rows of numbers, one for each of the parameters")


class Common(BaseModel):
    """The keys of every rover, in whatever form it is given."""

    kind: Any = optional("a kind of vehicle")
    wheel_of_joint: dict[str, Name] = optional("a mapping of joint to wheel")
    reversed_joints: list[Name] = optional("a list of the joints that count the other way")
    odom_frame_id: Name = optional("the name of a frame, such as odom")
    base_frame_id: Name = optional("the name of a frame, such as base_link")
    limits: LimitKeys = optional(_any_of(LimitKeys))
    control: ControlKeys = optional(_any_of(ControlKeys))
    noise: NoiseKeys = optional(_any_of(NoiseKeys))
    wheel_encoders: EncoderKeys = optional(_any_of(EncoderKeys))
    steering_encoders: SteeringEncoderKeys = optional(_any_of(SteeringEncoderKeys))
    columns: dict[str, str] | list[str] = optional(
        'a mapping of header to what it is read as, such as {encL: "left [ticks]"}, or a list of names'
    )
    topics: dict[str, str] | list[Name] = optional(
        'a mapping of topic to what it is read as, such as {/enc/left: "left [ticks]"}, or a list of topics'
    )
    stamp_unit: Literal["s", "ms", "us", "ns", "min", "h", "d"] = optional("the unit of the times of logs")
    plausibility: Flag = optional("whether readings that no rover has are refused")
    odometry: OdometryKeys = optional(_any_of(OdometryKeys))
    gyroscope: GyroscopeKeys = optional(_any_of(GyroscopeKeys))
    truth: TruthKeys = optional(_any_of(TruthKeys))
    calibration: CalibrationKeys = optional(_any_of(CalibrationKeys))


def keys_of(schema: type[BaseModel]) -> dict[str, FieldInfo]:
    """The keys of a schema as a file writes them."""
    return {field.alias or name: field for name, field in schema.model_fields.items()}
