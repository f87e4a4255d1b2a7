"""The kinds of vehicle a parameter file can describe with this package's own keys: a table, one entry each.

A kind has the keys of one constructor of `Rover`, under the same names. To add one: a table of its keys in
``own_keys.toml``, and an entry in `KINDS`.
"""

from collections.abc import Callable
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import AfterValidator, BaseModel, Discriminator, Field, Strict, Tag, model_validator

from six_wheel._core import FourAxle, RockerBogie, Rover, Wheel
from six_wheel.robot_description.joint_names import said_by
from six_wheel.robot_description.parameters.joints import JointList
from six_wheel.robot_description.parameters.key_types import (
    AXLES,
    CAR,
    OWN,
    ROCKER,
    Common,
    Finite,
    Name,
    Values,
    as_argument,
    by_type,
    check_name,
    refusal,
    schema,
)
from six_wheel.robot_description.parameters.ros_node_parameters import Section
from six_wheel.robot_description.parameters.ros_yaml import Report, one_line
from six_wheel.robot_description.parameters.schema import NESTED, Form

DIMENSIONS = ("d1", "d2", "d3", "d4", "wheel_radius")
# Keys by which a rover's node is told from others: these have wheel_radius and frames too.
TELLING = frozenset(
    ("kind", "preset", "traction_joints", "steering_joints", "wheel_of_joint", "reversed_joints")
) | {*DIMENSIONS[:4]}
MAX_AXLES = 32  # of two wheels each; a rover has at most 64


def _check_preset(name: str) -> str:
    if name not in Rover.presets():
        raise refusal("preset", f"must be one of {', '.join(Rover.presets())}, got {one_line(name)}")
    return name


def _six_wheel(d1: float, d2: float, d3: float, d4: float, **others: Any) -> Rover:
    """The rover whose corner and middle wheels are `d1` and `d4` to either side of the middle."""
    return Rover.six_wheel(
        front_to_middle=d3, middle_to_rear=d2, track_width=2 * d1, middle_track_width=2 * d4, **others
    )


def _on_flat_ground(**arguments: Any) -> Rover:
    """A rocker-bogie rover: its wheels where its suspension puts them with all joints at zero."""
    arm = RockerBogie(**arguments)
    return Rover(arm.planar().wheels, suspension=arm)


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


class _WheelRules(BaseModel):
    @model_validator(mode="after")
    def _check_together(self) -> "_WheelRules":
        _wheel({"name": "wheel"} | self.model_dump(exclude_unset=True))
        return self


def _wheel(values: Values) -> Wheel:
    """A wheel; keys that it has not are reported elsewhere."""
    known = NESTED["wheels"].model_fields
    return Wheel(**{key: as_argument(value) for key, value in values.items() if key in known})


def _check_names(wheels: dict[str, BaseModel]) -> dict[str, BaseModel]:
    for name in wheels:
        check_name(name)
    return wheels


_AnyWheel = schema("Wheel", OWN["wheel"], _WheelRules)
_NamedWheel = NESTED["wheels"] = schema("NamedWheel", {"name": "name! the wheel's name"}, _AnyWheel)
_Row: TypeAlias = Annotated[list[Finite], Field(min_length=2, max_length=2)]
_Positions: TypeAlias = Annotated[
    Annotated[list[_Row], Tag("<pairs>")] | Annotated[list[Finite], Tag("<flat>")], Discriminator(_is_flat)
]
TYPES: Values = {
    "preset": Annotated[str, Strict(), AfterValidator(_check_preset)],
    "positions": Annotated[_Positions, _for_each(1)],
    "two_positions": Annotated[_Positions, _for_each(2)],
    "wheel_names": Annotated[list[Name], AfterValidator(_check_differ)],
    "axles": Annotated[int, Strict(), Field(ge=1, le=MAX_AXLES)],
    "wheels": Annotated[
        Annotated[list[_NamedWheel], Tag("<list>")]  # type: ignore[valid-type]
        | Annotated[dict[str, _AnyWheel], AfterValidator(_check_names), Tag("<map>")],  # type: ignore[valid-type]
        by_type(dict, "<map>", "<list>"),
    ],
}


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
        description = KINDS["differential"].keys["wheelbase"].description
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


def _check_bogies(section: Section, values: Values, error: Report, warning: Report) -> None:
    """The bogie carries two wheels and the rocker the third: the rear ones and the front one, or the other
    way round."""
    data = section.data
    in_front = bool({"rocker_to_rear", "bogie_to_front"} & data.keys())
    wanted = ("rocker_to_rear", "bogie_to_front") if in_front else ("rocker_to_front", "bogie_to_rear")
    unwanted = ("rocker_to_front", "bogie_to_rear") if in_front else ()
    for key in wanted:
        if key not in data:
            description = KINDS["rocker_bogie"].keys[key].description
            error(section.line, (key,), f"{key} is missing", f"add {key}, {description}")
    for key in unwanted:
        if key in data:
            message = f"{key} is given beside keys for a bogie in front"
            section.report(error, (key,), message, f"remove {key}, or rocker_to_rear and bogie_to_front")


def _own_lists(values: Values, rover: Rover) -> list[JointList]:
    """Both lists of joints. Only where no wheel's name tells its place may their order count."""
    said = [said_by(name) for name in rover.wheel_names]
    silent = all(place is None or said.count(place) > 1 for place in said)
    order: Literal["names", "silent"] = "silent" if silent else "names"
    driven = tuple(wheel.name for wheel in rover.wheels if wheel.driven)
    return [
        JointList.of(rover, "traction_joints", driven, lack="has no motor", order=order),
        JointList.of(rover, "steering_joints", rover.steered_wheel_names, order=order, steers=True),
    ]


def _kind(
    name: str,
    joints: int,
    layout: Callable[..., Rover] | None = None,
    *,
    tables: tuple[str, ...] = (),
    takes_values: bool = False,
    **others: Any,
) -> Form:
    """A kind whose keys are those of `tables`, by default its own, behind the first `joints` keys of joints.

    Its layout takes all values, or is a constructor whose arguments are the keys, by default that of `Rover`.
    """
    keys = dict(list(OWN["joints"].items())[:joints])
    for table in tables or (name,):
        keys |= OWN["kinds"][table]
    form, constructor = schema(name, keys, Common, TYPES), layout or getattr(Rover, name)

    def call(values: Values) -> Rover:
        known = [key for key in keys if key in values and key not in ("traction_joints", "steering_joints")]
        arguments = {key: as_argument(values[key]) for key in known}
        if "positions" in arguments:
            arguments["positions"] = _pairs(values["positions"])
        return constructor(**arguments)

    title = "preset" if name == "preset" else f"kind {name}"
    return Form(title, name, form, constructor if takes_values else call, _own_lists, **others)


_RADIUS = {"wheel_radius": 1.0}
_ROCKER = {key: ROCKER[key] for key in ("rocker_pivot", "rocker_to_bogie", "wheel_radius")}
KINDS: dict[str, Form] = {
    form.kind: form
    for form in (
        _kind("six_wheel", 3, _six_wheel, stand_in=dict.fromkeys(DIMENSIONS, 1.0)),
        _kind("swerve", 3, stand_in=_RADIUS, check=_check_counts),
        _kind("differential", 1, tables=("tracked", "differential"), stand_in=CAR, check=_check_axles),
        _kind("tracked", 1, stand_in=CAR),
        _kind("ackermann", 3, tables=("bicycle", "ackermann"), stand_in=CAR),
        _kind("tricycle", 3, tables=("bicycle", "ackermann"), stand_in=CAR),
        _kind("bicycle", 3, stand_in=CAR),
        _kind("mecanum", 1, stand_in=CAR),
        _kind("omni", 1, stand_in=_RADIUS, check=_check_counts),
        _kind("rocker_bogie", 3, _on_flat_ground, stand_in=_ROCKER, check=_check_bogies),
        _kind("four_axle", 3, lambda **given: FourAxle(**given).rover, stand_in=AXLES),
        _kind("custom", 2, _custom, takes_values=True, check=_check_wheels),
    )
}
PRESET = _kind("preset", 3, _preset, takes_values=True, check=_check_preset_kind)
OWN_KEYS = frozenset(key for form in (*KINDS.values(), PRESET) for key in form.keys)
