"""The keys of a parameter file: what each must hold, and what a mistake in one is called.

The rules for numbers are the core's own, asked one argument at a time; types and names are here.
"""

from typing import Annotated, Any, Literal, TypeAlias

from pydantic import AfterValidator, BaseModel, Discriminator, Field, Strict, Tag, ValidationError
from pydantic_core import ErrorDetails

from six_wheel._core import Rover
from six_wheel._nodes import Section, closest
from six_wheel._yaml import Report, one_line, spell

__all__ = ["DIMENSIONS", "KEYS", "TELLING", "check_keys", "check_values"]

DIMENSIONS = ("d1", "d2", "d3", "d4", "wheel_radius")
# Keys by which a rover's node is told from others: these have wheel_radius and frames too.
TELLING = frozenset(
    {"preset", "traction_joints", "steering_joints", "wheel_of_joint", "d1", "d2", "d3", "d4"}
)

# What ROS 2 nodes and the wheeled controllers of ros2_controllers declare, and we do not need.
_WELL_KNOWN = """
    allow_multiple_cmd_vel_publishers angular cmd_timeout cmd_vel_timeout cmd_vel_topic command_interface
    command_interfaces diagnostic_updater enable_odom_tf in_chained_mode interface_name linear odom_topic
    odometry_topic open_loop pose_covariance_diagonal position_feedback publish_cmd publish_limited_velocity
    publish_odom publish_odom_tf publish_rate publish_tf publish_wheel_data qos_overrides reference_timeout
    start_type_description_service state_interface state_interfaces state_publish_rate steering_interface_name
    steering_joints_state_names tf_frame_prefix tf_frame_prefix_enable traction_interface_name
    traction_joints_state_names twist_covariance_diagonal type update_rate use_sim_time use_stamped_vel
    velocity_rolling_window_size wheel_radius_multiplier wheel_separation_multiplier
"""
WELL_KNOWN = frozenset(_WELL_KNOWN.split())


def _as_core(key: str) -> AfterValidator:
    """The core's own rule for one argument of `Rover.six_wheel`, with its own message."""

    def check(value: Any) -> Any:
        arguments: dict[str, Any] = dict.fromkeys(DIMENSIONS, 1.0)
        arguments[key] = tuple(value) if isinstance(value, list) else value
        Rover.six_wheel(**arguments)
        return value

    return AfterValidator(check)


def _check_name(text: str) -> str:
    if not text.strip() or not text.isprintable():
        raise ValueError(f"a name must have visible characters and no others, got {text!r}")
    return text


def _check_preset(name: str) -> str:
    if name not in Rover.presets():
        raise ValueError(f"preset must be one of {', '.join(Rover.presets())}, got {one_line(name)}")
    return name


def _by_type(kind: type, tag: str, otherwise: str) -> Discriminator:
    # Without it pydantic reports a bad value once for every form that it might have had.
    return Discriminator(lambda value: tag if isinstance(value, kind) else otherwise)


_Number: TypeAlias = Annotated[float, Strict()]
_Positive: TypeAlias = Annotated[float, Strict(), Field(gt=0, allow_inf_nan=False)]
_Name: TypeAlias = Annotated[str, Strict(), AfterValidator(_check_name)]
_Pair: TypeAlias = Annotated[list[_Number], Field(min_length=2, max_length=2)]
_Range: TypeAlias = Annotated[
    Annotated[_Number, Tag("<number>")] | Annotated[_Pair, Tag("<pair>")],
    _by_type(list, "<pair>", "<number>"),
]
_Joints: TypeAlias = Annotated[
    Annotated[list[_Name], Tag("<list>")] | Annotated[dict[str, _Name], Tag("<map>")],
    _by_type(dict, "<map>", "<list>"),
]


def _optional(description: str) -> Any:
    return Field(default=None, description=description)


class _Limits(BaseModel):
    speed: _Positive = _optional("a speed in m/s")
    acceleration: _Positive = _optional("an acceleration in m/s^2")
    jerk: _Positive = _optional("a jerk in m/s^3")
    wheel_speed: _Positive = _optional("a rate of turn in rad/s")
    steering_rate: _Positive = _optional("a rate of turn in rad/s")


class _Common(BaseModel):
    kind: Literal["six_wheel"] = _optional("six_wheel, or left out")
    traction_joints: _Joints = _optional(
        "a list with the joint of every wheel, or a mapping of wheel to joint"
    )
    steering_joints: _Joints = _optional(
        "a list with the joint of every steered wheel, or a mapping of wheel to joint"
    )
    wheel_of_joint: dict[str, _Name] = _optional("a mapping of joint to wheel")
    steering_limit: Annotated[_Range, _as_core("steering_limit")] = _optional(
        "an angle or [lower, upper], in radians"
    )
    odom_frame_id: _Name = _optional("the name of a frame, such as odom")
    base_frame_id: _Name = _optional("the name of a frame, such as base_link")
    limits: _Limits = _optional(f"a mapping with any of {', '.join(_Limits.model_fields)}")


class _Preset(_Common):
    preset: Annotated[str, Strict(), AfterValidator(_check_preset)] = Field(
        description="the name of a known rover"
    )


class _Dimensions(_Common):
    d1: Annotated[_Number, _as_core("d1")] = Field(
        description="half the distance between left and right corner wheels, in metres"
    )
    d2: Annotated[_Number, _as_core("d2")] = Field(
        description="the distance from middle to rear axle, in metres"
    )
    d3: Annotated[_Number, _as_core("d3")] = Field(
        description="the distance from middle to front axle, in metres"
    )
    d4: Annotated[_Number, _as_core("d4")] = Field(
        description="half the distance between middle wheels, in metres"
    )
    wheel_radius: Annotated[_Number, _as_core("wheel_radius")] = Field(
        description="the wheels' radius, in metres"
    )


_FIELDS = _Dimensions.model_fields | _Preset.model_fields
KEYS = frozenset(_FIELDS)


def check_keys(section: Section, error: Report, warning: Report) -> None:
    """Report keys that are unknown, or missing, or at odds with another. A misspelt one is renamed.

    So a mistake in the value of a misspelt key shows at once, not one run later.
    """
    known = KEYS | WELL_KNOWN
    wanted = (_Preset if "preset" in section.data else _Dimensions).model_fields.keys()
    for key in [key for key in section.data if key.split(".")[0] not in known]:
        # Half of a short word is much: d5 is d4 if that is missing.
        likeness = 0.5 if len(key) < 3 else 0.75
        line, guess = section.line_of((key,)), closest(key, wanted - section.data.keys(), likeness=likeness)
        if guess:
            error(line, (key,), f"unknown key {one_line(key)}", f"did you mean {guess}?")
            section.rename(key, guess)
        else:
            like = closest(key, KEYS)
            message = f"unknown key {one_line(key)} is ignored"
            warning(line, (key,), message, f"{like} is given besides" if like else None)
    data = section.data
    limits = data.get("limits")
    for key in limits if isinstance(limits, dict) else ():
        if key not in _Limits.model_fields:
            at, guess = ("limits", key), closest(key, _Limits.model_fields)
            report, remedy = (error, f"did you mean {guess}?") if guess else (warning, None)
            message = f"unknown key {spell(at)}" + ("" if guess else " is ignored")
            report(section.line_of(at), at, message, remedy)
    if "preset" in data:
        for key in [key for key in DIMENSIONS if key in data]:
            message = f"{key} is given besides a preset, which has its own"
            error(section.line_of((key,)), (key,), message, f"remove {key}, or the preset")
    elif section.node is not None:
        # A ROS 2 controller needs the lists; without a node there are the joint names of Rover.six_wheel.
        for key in ("traction_joints", "steering_joints"):
            if key not in data:
                error(section.line, (key,), f"{key} is missing", f"add {key}, {_FIELDS[key].description}")
    for key in DIMENSIONS:
        if section.node is not None and type(data.get(key)) is int:
            message = f"{key} is an integer, which ROS 2 refuses where it expects a floating-point number"
            warning(section.line_of((key,)), (key,), message, f"write {data[key]}.0")


def check_values(section: Section, report: Report) -> dict[str, Any]:
    """The values that are right by themselves; what is wrong with the others is reported."""
    schema = _Preset if "preset" in section.data else _Dimensions
    given = {key: value for key, value in section.data.items() if key in KEYS}
    try:
        return schema.model_validate(given).model_dump(exclude_unset=True)
    except ValidationError as error:
        details = error.errors(include_url=False)
    for detail in details:
        _explain(detail, section, report)
    failed = {detail["loc"][0] for detail in details}
    return {key: value for key, value in given.items() if key not in failed}


_RULES = {
    "float_type": "a number",
    "string_type": "text",
    "list_type": "a list of joint names",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "too_short": "a number or two numbers",
    "too_long": "a number or two numbers",
    "greater_than": "finite and positive",
    "finite_number": "finite and positive",
    "literal_error": "six_wheel",
}


def _explain(detail: ErrorDetails, section: Section, report: Report) -> None:
    """One of pydantic's errors in our words."""
    at = tuple(part for part in detail["loc"] if not str(part).startswith("<"))
    field = _Limits.model_fields[str(at[1])] if at[0] == "limits" and len(at) == 2 else _FIELDS[str(at[0])]
    key, kind, value = spell(at), detail["type"], detail["input"]
    remedy = f"it is {field.description}"
    if kind == "missing":
        message, remedy = f"{key} is missing", f"add {key}, {field.description}"
    elif kind == "value_error":
        message = str(detail["ctx"]["error"])
        message = message if message.startswith(str(at[0])) else f"{key}: {message}"
    else:
        text = section.places[at].text if at in section.places else ""
        message = f"{key} must be {_RULES.get(kind, detail['msg'])}, got {_shown(value, text)}"
    if kind == "string_type" and isinstance(value, bool | int | float):
        remedy = "put it in quotes"
    elif kind == "float_type" and isinstance(value, str):
        remedy = _number_in(value) or remedy
    report(section.line_of(at), at, message, remedy)


def _number_in(text: str) -> str | None:
    """What to do with a number that YAML reads as text."""
    try:
        number = float(text.replace(",", "."))
    except ValueError:
        return None
    return f"write {number}, without quotes, comma or leading zero"


def _shown(value: Any, text: str) -> str:
    match value:
        case None:
            return "nothing"
        case dict():
            return "a mapping"
        case list():
            return f"a list of {len(value)}"
        case str():
            return repr(value if len(value) <= 40 else value[:37] + "...")
    return one_line(text or str(value))
