"""Types and rules of the keys of a parameter file, and the messages for mistakes in them.

The rules for numbers are the core's own, asked one argument at a time; types and names are here. Which keys
there are is in `vehicle_types` (this package's own) and `foreign` (those of others).
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from six_wheel._core import Rover
from six_wheel.robot_description.parameters.joints import JointList
from six_wheel.robot_description.parameters.key_types import GROUPS, Values, keys_of
from six_wheel.robot_description.parameters.ros_node_parameters import Section
from six_wheel.robot_description.parameters.ros_yaml import Path, Report, one_line, spell


@dataclass(frozen=True)
class Form:
    """One way in which a parameter file can describe a rover: a kind of this package, or a controller."""

    name: str
    kind: str
    schema: type[BaseModel]
    layout: Callable[[Values], Rover]
    """Builds the wheels from values that are right by themselves. Raises ValueError for the rest."""
    joint_lists: Callable[[Values, Rover], list[JointList]]
    telling: frozenset[str] = frozenset()  # keys that only this form has
    stand_in: Values = field(default_factory=dict)
    """Values for what does not decide which wheels there are, to check joints although a number is wrong."""
    check: Callable[[Section, Values, Report, Report], None] = lambda *_: None
    """Reports errors and warnings about keys together, and what the file says beyond our model."""
    complete: Callable[[Section, Values], Values] = lambda section, values: values
    """Adds what follows from the values."""
    controller: str | None = None  # the type a controller manager knows it by
    ros1: bool = False  # its files have no `ros__parameters`
    more: tuple[str, ...] = ()  # further types that have the same keys
    kind_of: Callable[[Values], str] | None = None  # the kind by its values, of a form that describes several
    ignored: frozenset[str] = frozenset()  # keys beside those of every node that are no matter of kinematics

    @property
    def keys(self) -> dict[str, FieldInfo]:
        return keys_of(self.schema)

    @property
    def needed(self) -> set[str]:
        return {key for key, field in self.keys.items() if field.is_required()}


def check_values(section: Section, form: Form, report: Report) -> Values:
    """The values that are right by themselves; what is wrong with the others is reported."""
    given = {key: value for key, value in section.data.items() if key in form.keys}
    try:
        return form.schema.model_validate(given).model_dump(by_alias=True, exclude_unset=True)
    except ValidationError as error:
        details = error.errors(include_url=False)
    for detail in details:
        _explain(detail, section, form, report)
    failed = {detail["loc"][0] for detail in details}
    return {key: value for key, value in given.items() if key not in failed}


_RULES = {
    "float_type": "a number",
    "int_type": "a whole number",
    "bool_type": "true or false",
    "string_type": "text",
    "list_type": "a list",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "too_short": "a number or two numbers",
    "too_long": "a number or two numbers",
    "greater_than": "finite and positive",
    "greater_than_equal": "at least {ge}",
    "less_than_equal": "at most {le}",
    "finite_number": "finite and positive",
    "literal_error": "one of {expected}",
}


def describe(form: Form, at: Path) -> str:
    """Description of the value that the file should have at a key."""
    nested = NESTED[str(at[0])].model_fields if at[0] in NESTED else {}
    inner = next((nested[str(part)] for part in reversed(at[1:]) if part in nested), None)
    return str((inner or form.keys[str(at[0])]).description)


PLAIN = ("odom_frame_id", "base_frame_id", "columns", "topics", "stamp_unit", "plausibility")
"""Keys of every rover that hold no keys of their own."""
NESTED: dict[str, type[BaseModel]] = {**GROUPS}  # keys that hold mappings with keys of their own


def _explain(detail: ErrorDetails, section: Section, form: Form, report: Report) -> None:
    """One of pydantic's errors in our words."""
    at = tuple(part for part in detail["loc"] if not str(part).startswith("<"))
    key, kind, value = spell(at), detail["type"], detail["input"]
    if kind == "value_error":
        message, at = _in_words_of_file(detail["ctx"]["error"], at)
    description = describe(form, at)
    remedy = f"it is {description}"
    if kind == "missing":
        message, remedy = f"{key} is missing", f"add {key}, {description}"
    elif kind != "value_error":
        text = section.places[at].text if at in section.places else ""
        rule = _RULES[kind].format_map(detail.get("ctx", {})) if kind in _RULES else detail["msg"]
        if kind == "list_type" and "joint" in description:
            rule = "a list of joint names"
        elif kind.startswith("too_") and at[0] == "positions":
            rule = "two numbers, x and y"
        message = f"{key} must be {rule}, got {shown(value, text)}"
    if kind == "string_type" and isinstance(value, bool | int | float):
        remedy = "put it in quotes"
    elif kind == "float_type" and isinstance(value, str):
        remedy = _number_in(value) or remedy
    section.report(report, at, message, remedy)


def _in_words_of_file(error: ValueError, at: Path) -> tuple[str, Path]:
    """The core's message with the file's key for its argument, and where that key stands."""
    argument = getattr(error, "argument", None)
    if argument is None:
        return f"{spell(at)}: {error}", at
    if at[0] == "wheels" and len(at) == 2:  # the rule is about a wheel as a whole
        at = (*at, argument)
    return f"{spell(at)}{getattr(error, 'place', '')} {getattr(error, 'problem', '')}", at


def _number_in(text: str) -> str | None:
    """Remedy for a number that YAML reads as text; None if the text is no number."""
    try:
        number = float(text.replace(",", "."))
    except ValueError:
        return None
    return f"write {number}, without quotes, comma or leading zero"


def shown(value: Any, text: str = "") -> str:
    """A value in a message."""
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
