"""Page of the keys that are read, ignored or refused in each form of file, from the tables that read them."""

import math
from collections.abc import Iterable
from typing import Any

from pydantic import BaseModel, ValidationError

from six_wheel.robot_description.parameters.foreign.limits import LIMITS, SLOWING, TIMEOUTS
from six_wheel.robot_description.parameters.foreign.read_tables import FOREIGN, WELL_KNOWN
from six_wheel.robot_description.parameters.key_types import Common, keys_of
from six_wheel.robot_description.parameters.schema import Form
from six_wheel.robot_description.parameters.vehicle_types import OWN_KEYS

HEAD = """# Keys of ros2_controllers, PathPlanner, YAGSL and others

Keys of the parameter files of other packages that `six-wheel` reads. This page is made by
`python docs/keys.py` from the tables by which files are read, and a test keeps the two equal.

- *Read*: changes the rover, its limits or its joints.
- *Refused*: with such a value the file is refused, as it is without a required key, with two names for one
  quantity that differ, or with joints that do not fit the wheels.
- *Ignored*: known, and without meaning for kinematics; there is no message.
- *Any other key* is ignored with a warning that names it, or refused with a guess where it is like one that
  is missing. Limits that are not read (`min_velocity` unlike `-max_velocity`, those of `linear.y`) are
  warned about one by one.
- Beside these, every file may have this package's own keys for every kind: {own}.
"""


def page() -> str:
    """The whole page, in Markdown."""
    common = keys_of(Common)
    own = ", ".join(f"`{key}`" for key in common if key in OWN_KEYS)
    parts = [HEAD.format(own=own), _ignored_by_all()]
    parts += [_form(form) for form in FOREIGN]
    return "\n".join(parts)


def _ignored_by_all() -> str:
    limits = ", ".join(f"`{key}`" for key in (*LIMITS, *SLOWING))
    timeouts = ", ".join(f"`{key}`" for key in TIMEOUTS)
    return f"""## Every controller

Read as limits: {limits}. Read as the time after which a command is too old: {timeouts}; of the first two 0
means never.

Ignored: {_listed(WELL_KNOWN - {*TIMEOUTS})}.
"""


def _form(form: Form) -> str:
    common = keys_of(Common)
    rows = []
    for name, info in form.schema.model_fields.items():
        key, needed = info.alias or name, "required" if info.is_required() else ""
        if key not in common and key not in LIMITS and key not in SLOWING:
            rows.append(f"| `{key}` | {needed} | {info.description} | {_refused(form.schema, name)} |")
    types = [type_ for type_ in (form.controller, *form.more) if type_]
    said = [f"A `{form.kind}`" + (f", by the type {_listed(types)}" if types else ", by its keys")]
    said += ["; the keys stand without `ros__parameters`"] if form.ros1 else []
    lines = [
        f"## {form.name}",
        "",
        "".join(said) + ".",
        "",
        "| key | | read as | refused |",
        "|---|---|---|---|",
        *rows,
    ]
    if form.ignored:
        lines += ["", f"Ignored besides: {_listed(form.ignored)}."]
    return "\n".join(lines) + "\n"


# Samples by type: the value, the words if its like is refused, and more values of its type, tried one by one.
_KINDS: tuple[tuple[Any, str, dict[str, Any]], ...] = (
    (1.5, "no number", {"zero": 0.0, "negative": -1.0, "NaN": math.nan, "infinite": math.inf}),
    (True, "not true or false", {}),
    ("a", "no text", {"blank": " "}),
    (2, "no whole number", {"negative": -1}),
    (["a"], "no list of names", {"empty": [], "a blank name": [" "]}),
    (["a", "b", "c"], "no list of three names or more", {"a blank name": ["a", "b", " "]}),
    ({"a": "b"}, "no mapping", {}),
)


def _refused(schema: type[BaseModel], name: str) -> str:
    """Kinds of values that a key refuses, found by trying a sample of each."""

    def taken(value: Any) -> bool:
        try:
            schema.__pydantic_validator__.validate_assignment(schema.model_construct(), name, value)
        except ValidationError:
            return False
        return True

    kinds = [(kind, others) for value, kind, others in _KINDS if taken(value)]
    if not kinds:
        return ""
    wrong, others = kinds[0]
    if any(kind == "no list of names" for kind, _ in kinds[1:]):
        wrong = "neither a name nor a list of them"
    return ", ".join([wrong, *(what for what, value in others.items() if not taken(value))])


def _listed(keys: Iterable[str]) -> str:
    return ", ".join(f"`{key}`" for key in sorted(keys))
