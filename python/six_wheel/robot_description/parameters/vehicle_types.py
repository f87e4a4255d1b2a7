"""The kinds of vehicle a parameter file can describe with this package's own keys: a table, one entry each.

A kind has the keys of one constructor of `Rover`, under the same names. To add one: a schema with its
arguments, and an entry in `KINDS`.
"""

from collections.abc import Callable
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import AfterValidator, BaseModel, Discriminator, Field, Strict, Tag, model_validator

from six_wheel._core import Rover, Wheel
from six_wheel.robot_description.joint_names import said_by
from six_wheel.robot_description.parameters.joints import JointList
from six_wheel.robot_description.parameters.key_types import (
    Common,
    Finite,
    Flag,
    Length,
    Name,
    Number,
    NumberOrPair,
    SteeringLimit,
    Values,
    as_argument,
    asks_core,
    by_type,
    check_name,
    keys_of,
    optional,
    refusal,
    required,
)
from six_wheel.robot_description.parameters.ros_node_parameters import Section
from six_wheel.robot_description.parameters.ros_yaml import Report, one_line
from six_wheel.robot_description.parameters.schema import NESTED, Form
from six_wheel.robot_description.parameters.suspended_types import (
    AXLES,
    ROCKER,
    STEERING_LIMIT,
    WHEEL_RADIUS,
    FourAxleKeys,
    OwnKeys,
    RockerBogieKeys,
    SteeredKeys,
    SteeringKeys,
    check_bogies,
    on_flat_ground,
    with_axles_locked,
)

DIMENSIONS = ("d1", "d2", "d3", "d4", "wheel_radius")
# Keys by which a rover's node is told from others: these have wheel_radius and frames too.
TELLING = frozenset(
    ("kind", "preset", "traction_joints", "steering_joints", "wheel_of_joint", "reversed_joints")
) | {*DIMENSIONS[:4]}
MAX_AXLES = 32  # of two wheels each; a rover has at most 64

_SIX: Values = dict.fromkeys(DIMENSIONS, 1.0)
_AXLES: Values = dict.fromkeys(("front_to_middle", "middle_to_rear", "track_width", "wheel_radius"), 1.0)
_CAR: Values = {"wheelbase": 1.0, "track_width": 1.0, "wheel_radius": 1.0}
# Far apart, so that one of them alone is never on the wrong side of the other.
_PAIR: Values = {"track_width": 1.0, "wheel_radius": 1.0, "icr_left": 1e50, "icr_right": -1e50}
_MECANUM = _CAR
_ROLLER: Values = {"name": "wheel", "x": 0.0, "y": 0.0, "radius": 1.0}

_DRIVEN = "the wheels that have motors: front, rear or all"
_WHEELBASE = "the distance from rear to front axle, in metres"
_ROLLER_ANGLE = "the angle between the axes of rollers and wheel, in radians"
_RollerAngle: TypeAlias = Annotated[Number, asks_core(Rover.mecanum, "roller_angle", **_MECANUM)]
_TRACK_WIDTH = "the distance from left to right wheel, in metres"


def _check_preset(name: str) -> str:
    if name not in Rover.presets():
        raise refusal("preset", f"must be one of {', '.join(Rover.presets())}, got {one_line(name)}")
    return name


class _Preset(SteeredKeys):
    preset: Annotated[str, Strict(), AfterValidator(_check_preset)] = required("the name of a known rover")


class _SixWheel(SteeredKeys):
    d1: Annotated[Number, asks_core(Rover.six_wheel, "track_width", **_AXLES)] = required(
        "half the distance between left and right corner wheels, in metres"
    )
    d2: Annotated[Number, asks_core(Rover.six_wheel, "middle_to_rear", **_AXLES)] = required(
        "the distance from middle to rear axle, in metres"
    )
    d3: Annotated[Number, asks_core(Rover.six_wheel, "front_to_middle", **_AXLES)] = required(
        "the distance from middle to front axle, in metres"
    )
    d4: Annotated[Number, asks_core(Rover.six_wheel, "middle_track_width", **_AXLES)] = required(
        "half the distance between middle wheels, in metres"
    )
    wheel_radius: Length = required(WHEEL_RADIUS)


def _six_wheel(d1: float, d2: float, d3: float, d4: float, **others: Any) -> Rover:
    """The rover whose corner and middle wheels are `d1` and `d4` to either side of the middle."""
    return Rover.six_wheel(
        front_to_middle=d3, middle_to_rear=d2, track_width=2 * d1, middle_track_width=2 * d4, **others
    )


def _pairs(positions: list[Any]) -> list[Any]:
    """Rows x, y, whether they were written so or one after the other as ROS 2 needs it."""
    flat = not any(isinstance(row, list) for row in positions)
    return [list(row) for row in zip(positions[::2], positions[1::2], strict=True)] if flat else positions


def _is_flat(positions: Any) -> str:
    rows = positions if isinstance(positions, list) else []
    return "<pairs>" if any(isinstance(row, list) for row in rows) else "<flat>"


def _for_each(least: int) -> AfterValidator:
    def check(positions: list[Any]) -> list[Any]:
        if len(positions) % 2 and _is_flat(positions) == "<flat>":
            raise refusal("positions", f"must hold x and y of every wheel, got {len(positions)} numbers")
        if len(_pairs(positions)) < least:
            rule = f"hold x and y of at least {least} wheel{'s' if least > 1 else ''}"
            raise refusal("positions", f"must {rule}, got {len(_pairs(positions))}")
        return positions

    return AfterValidator(check)


def _check_differ(names: list[str]) -> list[str]:
    twice = [name for index, name in enumerate(names) if name in names[:index]]
    if twice:
        raise refusal("names", f"must differ, got {one_line(twice[0])} twice")
    return names


_Row: TypeAlias = Annotated[list[Finite], Field(min_length=2, max_length=2)]
_Positions: TypeAlias = Annotated[
    Annotated[list[_Row], Tag("<pairs>")] | Annotated[list[Finite], Tag("<flat>")], Discriminator(_is_flat)
]
_Names: TypeAlias = Annotated[list[Name], AfterValidator(_check_differ)]
_POSITIONS = "x and y of every wheel in metres, as [[x, y], ...] or [x, y, x, y, ...]"
_NAMES = "a list of the wheels' names in the order of positions"


class _Swerve(SteeredKeys):
    positions: Annotated[_Positions, _for_each(2)] = required(_POSITIONS)
    wheel_radius: Length = required(WHEEL_RADIUS)
    names: _Names = optional(_NAMES)


class _Omni(OwnKeys):
    positions: Annotated[_Positions, _for_each(1)] = required(_POSITIONS)
    headings: list[Finite] = required("a list of the directions in which the wheels drive, in radians")
    wheel_radius: Length = required(WHEEL_RADIUS)
    roller_angle: _RollerAngle = optional(_ROLLER_ANGLE)
    names: _Names = optional(_NAMES)


class _Mecanum(OwnKeys):
    wheelbase: Length = required(_WHEELBASE)
    track_width: Length = required(_TRACK_WIDTH)
    wheel_radius: Length = required(WHEEL_RADIUS)
    roller_angle: _RollerAngle = optional(_ROLLER_ANGLE)


class _Tracked(OwnKeys):
    track_width: Length = required(_TRACK_WIDTH)
    wheel_radius: Annotated[NumberOrPair, asks_core(Rover.tracked, "wheel_radius", **_PAIR)] = required(
        "the radius of the wheels or sprockets, or [left, right], in metres"
    )
    icr_left: Annotated[Number, asks_core(Rover.tracked, "icr_left", **_PAIR)] = optional(
        "how far to the left the left side has its centre of rotation, in metres"
    )
    icr_right: Annotated[Number, asks_core(Rover.tracked, "icr_right", **_PAIR)] = optional(
        "how far to the left the right side has its centre of rotation, in metres; negative to the right"
    )
    icr_forward: Annotated[Number, asks_core(Rover.tracked, "icr_forward", **_PAIR)] = optional(
        "how far forward the centres of rotation lie, in metres"
    )


class _Differential(_Tracked):
    wheels_per_side: Annotated[int, Strict(), Field(ge=1, le=MAX_AXLES)] = optional(
        "the number of wheels on each side"
    )
    wheelbase: Length = optional("the distance from the last to the first axle, in metres")


class _Bicycle(SteeredKeys):
    wheelbase: Length = required(_WHEELBASE)
    wheel_radius: Length = required(WHEEL_RADIUS)
    driven: Annotated[Name, asks_core(Rover.ackermann, "driven", **_CAR)] = optional(_DRIVEN)


class _Car(_Bicycle):
    track_width: Length = required(_TRACK_WIDTH)


class _Wheel(BaseModel):
    x: Finite = required("how far forward of the origin the wheel's pivot is, in metres")
    y: Finite = required("how far to the left of the origin the wheel's pivot is, in metres")
    radius: Length = required("the wheel's radius, in metres")
    steered: Flag = optional("whether it steers")
    heading: Finite = optional("the direction in which it rolls at steering angle 0, in radians")
    steering_limit: SteeringLimit = optional(STEERING_LIMIT)
    scrub: Finite = optional("how far the contact is to the left of the steering axis, in metres")
    trail: Finite = optional("how far the contact is behind the steering axis, in metres")
    roller_angle: Annotated[Number, asks_core(Wheel, "roller_angle", **_ROLLER)] = optional(_ROLLER_ANGLE)
    driven: Flag = optional("whether it has a motor")
    castor: Flag = optional("whether it swivels freely")

    @model_validator(mode="after")
    def _check_together(self) -> "_Wheel":
        _wheel({"name": "wheel"} | self.model_dump(exclude_unset=True))
        return self


class _NamedWheel(_Wheel):
    name: Name = required("the wheel's name")


def _wheel(values: Values) -> Wheel:
    """A wheel; keys that it has not are reported elsewhere."""
    known = NESTED["wheels"].model_fields
    return Wheel(**{key: as_argument(value) for key, value in values.items() if key in known})


def _check_names(wheels: dict[str, _Wheel]) -> dict[str, _Wheel]:
    for name in wheels:
        check_name(name)
    return wheels


class _Custom(SteeringKeys):
    wheels: Annotated[
        Annotated[list[_NamedWheel], Tag("<list>")]
        | Annotated[dict[str, _Wheel], AfterValidator(_check_names), Tag("<map>")],
        by_type(dict, "<map>", "<list>"),
    ] = required("a mapping of each wheel's name to its keys, or a list of mappings with a name each")


NESTED["wheels"] = _NamedWheel


def _custom(values: Values) -> Rover:
    wheels = values["wheels"]
    if isinstance(wheels, dict):
        wheels = [{"name": name} | wheel for name, wheel in wheels.items()]
    return Rover([_wheel(wheel) for wheel in wheels])


def _preset(values: Values) -> Rover:
    rover = Rover.preset(values["preset"])
    limit = as_argument(values.get("steering_limit"))
    if limit is None:
        return rover
    if not rover.steered_wheel_names:
        raise refusal("steering_limit", f"is given, but no wheel of the preset {values['preset']} steers")
    return Rover.preset(values["preset"], steering_limit=limit)


def _check_preset_kind(section: Section, values: Values, error: Report, warning: Report) -> None:
    kind, name = values.get("kind"), values.get("preset")
    steered = {"front_left", "front_right", "rear_left", "rear_right"}
    six = name is not None and {*Rover.preset(name).steered_wheel_names} == steered
    if kind is not None and name is not None and not (kind == "six_wheel" and six):
        message = f"kind {one_line(str(kind))} does not fit the preset {name}"
        section.report(error, ("kind",), message, "leave out kind")


def _check_axles(section: Section, values: Values, error: Report, warning: Report) -> None:
    if values.get("wheels_per_side", 1) > 1 and "wheelbase" not in section.data:
        description = _Differential.model_fields["wheelbase"].description
        message = "wheelbase is missing, which more than one wheel per side needs"
        error(section.line_of(("wheels_per_side",)), ("wheelbase",), message, f"add wheelbase, {description}")


def _check_counts(section: Section, values: Values, error: Report, warning: Report) -> None:
    """Lists beside positions are as long; and ROS 2 has no lists of lists."""
    if "positions" not in values:
        return
    count = len(_pairs(values["positions"]))
    for key, what in (("headings", "number"), ("names", "name")):
        if key in values and len(values[key]) != count:
            rule = f"must hold {count} {what}{'s' if count > 1 else ''}, one per position"
            message = f"{key} {rule}, got {len(values[key])}"
            section.report(error, (key,), message, "as many as positions has")
    if section.node is not None and _is_flat(values["positions"]) != "<flat>":
        message = "positions is a list of lists, which ROS 2 does not read"
        section.report(warning, ("positions",), message, "write [x, y, x, y, ...] in one list")


def _check_wheels(section: Section, values: Values, error: Report, warning: Report) -> None:
    if section.node is not None and isinstance(values.get("wheels"), list):
        message = "wheels is a list of mappings, which ROS 2 does not read"
        remedy = "write a mapping of each wheel's name to its keys"
        section.report(warning, ("wheels",), message, remedy)


def _own_lists(values: Values, rover: Rover) -> list[JointList]:
    """Both lists of joints. Only where no wheel's name tells its place may their order count."""
    said = [said_by(name) for name in rover.wheel_names]
    silent = all(place is None or said.count(place) > 1 for place in said)
    order: Literal["names", "silent"] = "silent" if silent else "names"
    driven = tuple(wheel.name for wheel in rover.wheels if wheel.driven)
    steered = rover.steered_wheel_names
    rest = {
        wheels: tuple(name for name in rover.wheel_names if name not in wheels)
        for wheels in (driven, steered)
    }
    return [
        JointList("traction_joints", driven, rest[driven], "has no motor", order),
        JointList("steering_joints", steered, rest[steered], order=order, steers=True),
    ]


_NO_ARGUMENTS = frozenset(keys_of(SteeringKeys))


def _calls(constructor: Callable[..., Rover], schema: type[Common]) -> Callable[[Values], Rover]:
    """The layout from a constructor whose arguments are the keys."""

    def layout(values: Values) -> Rover:
        known = [key for key in keys_of(schema) if key in values and key not in _NO_ARGUMENTS]
        arguments = {key: as_argument(values[key]) for key in known}
        if "positions" in arguments:
            arguments["positions"] = _pairs(values["positions"])
        return constructor(**arguments)

    return layout


def _kind(name: str, schema: type[Common], layout: Callable[..., Rover] | None = None, **others: Any) -> Form:
    layout = layout or _calls(getattr(Rover, name), schema)
    return Form(f"kind {name}", name, schema, layout, _own_lists, **others)


_RADIUS = {"wheel_radius": 1.0}
KINDS: dict[str, Form] = {
    form.kind: form
    for form in (
        _kind("six_wheel", _SixWheel, _calls(_six_wheel, _SixWheel), stand_in=_SIX),
        _kind("swerve", _Swerve, stand_in=_RADIUS, check=_check_counts),
        _kind("differential", _Differential, stand_in=_CAR, check=_check_axles),
        _kind("tracked", _Tracked, stand_in=_CAR),
        _kind("ackermann", _Car, stand_in=_CAR),
        _kind("tricycle", _Car, stand_in=_CAR),
        _kind("bicycle", _Bicycle, stand_in=_CAR),
        _kind("mecanum", _Mecanum, stand_in=_MECANUM),
        _kind("omni", _Omni, stand_in=_RADIUS, check=_check_counts),
        _kind(
            "rocker_bogie",
            RockerBogieKeys,
            _calls(on_flat_ground, RockerBogieKeys),
            stand_in={key: ROCKER[key] for key in ("rocker_pivot", "rocker_to_bogie", "wheel_radius")},
            check=check_bogies,
        ),
        _kind("four_axle", FourAxleKeys, _calls(with_axles_locked, FourAxleKeys), stand_in=AXLES),
        _kind("custom", _Custom, _custom, check=_check_wheels),
    )
}
PRESET = Form("preset", "preset", _Preset, _preset, _own_lists, check=_check_preset_kind)
OWN_KEYS = frozenset(key for form in (*KINDS.values(), PRESET) for key in form.keys)
