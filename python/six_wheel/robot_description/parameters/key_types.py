"""Types of the keys of a parameter file, by their words in tables, and the keys that every rover may have.

A line of a table has a word of `TYPES`, with an exclamation mark if the key is required, and a description.
``one|other`` is a choice, ``names(3..64)`` a list of so many names, ``Noise.slip`` a number by the core's own
rule for that argument, ``name:Odometry.method`` another type by such a rule. The rules for numbers are the
core's, asked one argument at a time; types and names are here.
"""

import re
import tomllib
from collections.abc import Mapping
from operator import attrgetter
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    Discriminator,
    Field,
    Strict,
    Tag,
    create_model,
)
from pydantic.fields import FieldInfo

from six_wheel._core import (
    Encoder,
    FourAxle,
    Gyroscope,
    Noise,
    Odometry,
    RockerBogie,
    Rover,
    Wheel,
    without_questions,
)

Values: TypeAlias = dict[str, Any]

_SIDE: Values = {"rocker_pivot": (0.1, 0.2, 0.1), "wheel_radius": 0.1}
ROCKER: Values = _SIDE | {
    "rocker_to_front": (0.3, 0.0, -0.1),
    "rocker_to_bogie": (-0.1, 0.0, -0.1),
    "bogie_to_middle": (0.1, 0.0, 0.0),
    "bogie_to_rear": (-0.1, 0.0, 0.0),
}
IN_FRONT: Values = _SIDE | {
    "rocker_to_rear": (-0.3, 0.0, -0.1),
    "rocker_to_bogie": (0.1, 0.0, -0.1),
    "bogie_to_front": (0.1, 0.0, 0.0),
    "bogie_to_middle": (-0.1, 0.0, 0.0),
}
AXLES: Values = {"pivots": (1.0, 1.0), "axle_length": 1.0, "wheel_radius": 1.0}
CAR: Values = {"wheelbase": 1.0, "track_width": 1.0, "wheel_radius": 1.0}
_SIX = ("front_to_middle", "middle_to_rear", "track_width", "wheel_radius")
_WHEEL: Values = {"name": "wheel", "x": 0.0, "y": 0.0, "radius": 1.0}
# Other arguments of a call of the core that is asked about one; of several the first that have it count.
STAND_INS: Mapping[str, tuple[Values, ...]] = {
    "Wheel": (_WHEEL, _WHEEL | {"steered": True, "steering_limit": 1.0}),
    "Odometry": ({"rover": Rover.differential(1.0, 1.0)},),
    "Rover.six_wheel": (dict.fromkeys(_SIX, 1.0),),
    "Rover.ackermann": (CAR,),
    "Rover.mecanum": (CAR,),
    # Far apart, so that one of them alone is never on the wrong side of the other.
    "Rover.tracked": ({"track_width": 1.0, "wheel_radius": 1.0, "icr_left": 1e50, "icr_right": -1e50},),
    "RockerBogie": (ROCKER, IN_FRONT),
    "FourAxle": (AXLES,),
}
_CORE = SimpleNamespace(
    Encoder=Encoder, FourAxle=FourAxle, Gyroscope=Gyroscope, Noise=Noise, Odometry=Odometry,
    RockerBogie=RockerBogie, Rover=Rover, Wheel=Wheel,
)  # fmt: skip


def rule_of_core(text: str) -> AfterValidator:
    """The core's own rule for an argument of a call; its message is told with the file's key in front."""
    name, _, argument = text.rpartition(".")
    call, given = attrgetter(name)(_CORE), STAND_INS.get(name, ({},))
    others = next((each for each in given if argument in each), given[0])

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


def is_set(value: Any) -> bool:
    """True if a value is neither 0, empty, false nor NaN, the defaults in a dump of the parameters."""
    return bool(value) and value == value


def _check_factor(value: float) -> float:
    """A factor whose sign says which way a joint counts."""
    Wheel("wheel", 0.0, 0.0, radius=abs(value))
    return value


def _check_if_set(value: float) -> float:
    if is_set(value):
        Wheel("wheel", 0.0, 0.0, radius=value)
    return value


def by_type(kind: type, tag: str, otherwise: str) -> Discriminator:
    """Discriminator of two forms of a value. Without it pydantic reports a bad value once for each form."""
    return Discriminator(lambda value: tag if isinstance(value, kind) else otherwise)


Number: TypeAlias = Annotated[float, Strict()]
Finite: TypeAlias = Annotated[Number, rule_of_core("Wheel.x")]
Length: TypeAlias = Annotated[Number, rule_of_core("Wheel.radius")]
Positive: TypeAlias = Annotated[float, Strict(), Field(gt=0, allow_inf_nan=False)]
Name: TypeAlias = Annotated[str, Strict(), AfterValidator(check_name)]
_Never: TypeAlias = Annotated[
    Annotated[Literal["never"], Tag("<word>")] | Annotated[Positive, Tag("<number>")],
    by_type(str, "<word>", "<number>"),
]
_Pair: TypeAlias = Annotated[list[Number], Field(min_length=2, max_length=2)]
NumberOrPair: TypeAlias = Annotated[
    Annotated[Number, Tag("<number>")] | Annotated[_Pair, Tag("<pair>")],
    by_type(list, "<pair>", "<number>"),
]
_WheelJoints: TypeAlias = Annotated[
    Annotated[list[Name], Tag("<list>")] | Annotated[dict[str, Name], Tag("<map>")],
    by_type(dict, "<map>", "<list>"),
]
TYPES: dict[str, Any] = {
    "anything": Any,
    "number": Number,
    "finite": Finite,
    "length": Length,
    "length_or_unset": Annotated[Number, AfterValidator(_check_if_set)],
    "positive": Positive,
    "limit": Annotated[float, Strict(), Field(gt=0)],
    "count": Annotated[float, Strict(), Field(ge=0, allow_inf_nan=False)],
    "factor": Annotated[Number, AfterValidator(_check_factor)],
    "integer": Annotated[int, Strict()],
    "flag": Annotated[bool, Strict()],
    "or_never": _Never,
    "number_or_pair": NumberOrPair,
    "two": Annotated[list[Finite], Field(min_length=2, max_length=2)],
    "vector": Annotated[list[Finite], Field(min_length=3, max_length=3)],
    "finites": list[Finite],
    "matrix": list[list[Finite]],
    "steering": Annotated[NumberOrPair, rule_of_core("Wheel.steering_limit")],
    "name": Name,
    "names": list[Name],
    "joints": Annotated[
        list[Name],
        Field(min_length=1, max_length=32),
        BeforeValidator(lambda value: [value] if isinstance(value, str) else value),
    ],
    "wheel_joints": _WheelJoints,
    "wheel_of_joint": dict[str, Name],
    "factors": dict[str, Positive],
    "angles": dict[str, Finite],
    "places": dict[str, tuple[float, float]],
    "columns": dict[str, str] | list[str],
    "topics": dict[str, str] | list[Name],
}


def type_of(word: str, others: Mapping[str, Any] | None = None) -> Any:
    """The type that a word stands for: of `TYPES`, or of `others`."""
    types = {**TYPES, **(others or {}), "": Number}
    base, _, rule = word.rpartition(":")
    if rule[:1].isupper():
        if base == "by_wheel":
            return dict[str, Annotated[Number, rule_of_core(rule)]]
        return Annotated[types[base], rule_of_core(rule)]
    if "|" in word:
        return Literal[tuple(word.split("|"))]
    if (count := re.fullmatch(r"names\((\d+)\.\.(\d+)\)", word)) is None:
        return types[word]
    least, most = map(int, count.groups())

    def check(joints: list[str]) -> list[str]:
        if not least <= len(joints) <= most:
            many = f"{least}" if least == most else f"{least} to {most}"
            raise refusal("joints", f"must name {many} joints, got {len(joints)}")
        return joints

    return Annotated[list[Name], AfterValidator(check)]


def schema(
    name: str,
    keys: Mapping[str, str],
    base: type[BaseModel] = BaseModel,
    others: Mapping[str, Any] | None = None,
) -> type[BaseModel]:
    """The schema of a table of keys, beside those of `base`; `others` are further types by their words."""
    fields: dict[str, Any] = {}
    for key, text in keys.items():
        word, _, description = text.partition(" ")
        field = key.replace(".", "_")
        default: Any = ... if word.endswith("!") else None
        alias = None if field == key else key
        kind = type_of(word.rstrip("!"), others)
        fields[field] = kind, Field(default, description=description, alias=alias)
    return create_model(name, __base__=base, **fields)


def keys_of(schema: type[BaseModel]) -> dict[str, FieldInfo]:
    """The keys of a schema as a file writes them."""
    return {field.alias or name: field for name, field in schema.model_fields.items()}


OWN = tomllib.loads(Path(__file__).with_name("own_keys.toml").read_text(encoding="utf-8"))
GROUPS = {name: schema(name, keys) for name, keys in OWN["groups"].items()}
"""Keys of every rover that hold mappings with keys of their own."""
Common = schema(
    "Common",
    {
        key: f"{key} a mapping with any of {', '.join(GROUPS[key].model_fields)}" if text == "group" else text
        for key, text in OWN["common"].items()
    },
    others=GROUPS,
)
NONE_WORDS = {"align": "none", "timeout": "never", "following_error": "never"}
"""Words of `control` for a keyword that is None."""
