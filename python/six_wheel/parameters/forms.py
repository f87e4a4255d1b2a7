"""Which of the forms a rover is given in, and whether the file has the keys of that form."""

import re
from typing import Any

from six_wheel.parameters.controller_keys import DRIVES, STEERS, WELL_KNOWN
from six_wheel.parameters.controllers import CONTROLLERS
from six_wheel.parameters.kinds import DIMENSIONS, KINDS, OWN_KEYS, PRESET
from six_wheel.parameters.kinds import TELLING as OWN_TELLING
from six_wheel.parameters.nodes import GROUPS, Section, closest
from six_wheel.parameters.schema import GROUPS as MAPPINGS
from six_wheel.parameters.schema import NESTED, Common, Form, describe, keys_of, shown
from six_wheel.parameters.syntax import Path, Report, one_line, spell

__all__ = ["CONTROLLER_TYPES", "KEYS", "TELLING", "check_keys", "form_of"]

CONTROLLER_TYPES = {form.controller: form for form in CONTROLLERS if form.controller}
KEYS = OWN_KEYS.union(*(form.keys for form in CONTROLLERS))
# A node with this package's own keys comes before one that only has those of a controller.
TELLING = (OWN_TELLING, frozenset[str]().union(*(form.telling for form in CONTROLLERS)))

_LIMIT = re.compile(
    r"(linear|angular|traction|steering)\.(\w\.)?"
    r"((min|max)_(velocity|acceleration|deceleration|jerk|position)(_reverse)?|has_\w+_limits)"
)


def form_of(section: Section, error: Report) -> Form | None:
    """The form, by what the file says of it, else by its keys; None, with the reason reported, if unclear."""
    data = section.data
    if "preset" in data:
        return PRESET
    kind = data.get("kind")
    if isinstance(kind, str) and kind in KINDS:
        return _controller_of(data, [form for form in CONTROLLERS if form.kind == kind]) or KINDS[kind]
    if "kind" in data:
        guess = closest(kind, KINDS) if isinstance(kind, str) else None
        message = f"kind must be one of {', '.join(KINDS)}, got {shown(kind)}"
        error(
            section.line_of(("kind",)),
            ("kind",),
            message,
            f"did you mean {guess}?" if guess else "choose one",
        )
        if guess and KINDS[guess].needed <= data.keys():
            return KINDS[guess]
    types = (section.type, data.get("type"))
    by_type = next(
        (CONTROLLER_TYPES[type_] for type_ in types if isinstance(type_, str) and type_ in CONTROLLER_TYPES),
        None,
    )
    if by_type is not None:
        return by_type
    if data.keys() & set(DIMENSIONS[:4]):
        return KINDS["six_wheel"]
    controller = _controller_of(data, list(CONTROLLERS))
    others = data.keys() & OWN_KEYS - keys_of(KINDS["six_wheel"].schema).keys()
    if controller is None and others and "kind" not in data:
        own = data.keys() & OWN_KEYS
        fitting = [form.kind for form in KINDS.values() if form.needed <= own <= form.keys.keys()]
        names = ", or ".join(f"kind: {kind}" for kind in fitting) or f"kind, one of {', '.join(KINDS)}"
        first = next(key for key in data if key in others)
        message = f"kind is missing, and {first} is no key of {KINDS['six_wheel'].name}"
        error(section.line, ("kind",), message, f"add {names}")
        return None
    return controller or KINDS["six_wheel"]


def _controller_of(data: dict[str, Any], forms: list[Form]) -> Form | None:
    """The controller that has most of these keys."""

    def score(form: Form) -> tuple[int, bool]:
        return len(data.keys() & form.telling), _fits(data, form)

    best = max(forms, key=score, default=None)
    return best if best is not None and score(best)[0] else None


def _fits(data: dict[str, Any], form: Form) -> bool:
    """Whether the steering controllers' lists are as long as this one needs; it tells them apart."""
    counts = {
        "ackermann_steering_controller": [(2, 2)],
        "tricycle_steering_controller": [(2, 1), (1, 1)],
        "bicycle_steering_controller": [(1, 1)],
    }
    lists = ([data[key] for key in keys if isinstance(data.get(key), list)] for keys in (DRIVES, STEERS))
    return tuple(max(map(len, found), default=0) for found in lists) in counts.get(form.name, ())


def check_keys(section: Section, form: Form, error: Report, warning: Report) -> None:
    """Report keys that are unknown, or missing, or at odds with another. A misspelt one is renamed.

    So a mistake in the value of a misspelt key shows at once, not one run later.
    """
    keys, data = form.keys, section.data
    for key in [key for key in data if key not in keys and not _is_well_known(key, form)]:
        at = (key,)
        line = section.line_of(at)
        # Half of a short word is much: d5 is d4 if that is missing.
        likeness = 0.5 if len(key) < 3 else 0.75
        wanted = [known for known in keys if known not in section.data]
        guess = closest(key, wanted, likeness=likeness)
        if form is PRESET and key in OWN_KEYS:
            message = f"{key} is given besides a preset, which has its own"
            error(line, at, message, f"remove {key}, or the preset")
        elif key in OWN_KEYS and "kind" in data:
            arguments = ", ".join(key for key in keys if key not in Common.model_fields)
            error(line, at, f"{key} is no key of {form.name}", f"remove it; its keys are {arguments}")
        elif guess:
            error(line, at, f"unknown key {one_line(key)}", f"did you mean {guess}?")
            section.rename(at, guess)
        elif key in GROUPS and any(known.startswith(f"{key}.") for known in keys):
            error(line, at, f"{key} must be a mapping, got {shown(data[key])}", "indent its keys below it")
        else:
            like = closest(key, keys)
            message = f"unknown key {one_line(key)} is ignored"
            warning(line, at, message, f"{like} is given besides" if like else None)
    _check_groups(section, error, warning)
    _check_wheels(section, error)
    if form is KINDS["six_wheel"] and section.node is not None:
        # A ROS 2 controller needs the lists; without a node there are the joint names of Rover.six_wheel.
        for key in ("traction_joints", "steering_joints"):
            if key not in section.data:
                error(section.line, (key,), f"{key} is missing", f"add {key}, {describe(form, (key,))}")
    for key, field in keys.items():
        declared = field.annotation is float and (field.is_required() or form.controller)
        if declared and section.node is not None and type(section.data.get(key)) is int:
            message = f"{key} is an integer, which ROS 2 refuses where it expects a floating-point number"
            warning(section.line_of((key,)), (key,), message, f"write {section.data[key]}.0")


def _is_well_known(key: str, form: Form) -> bool:
    head = key.split(".")[0]
    if form.controller and head in GROUPS:
        return _LIMIT.fullmatch(key) is not None
    return head in WELL_KNOWN


def _check_groups(section: Section, error: Report, warning: Report) -> None:
    """The keys of `limits` and the other mappings that every rover may have."""
    for group, schema in MAPPINGS.items():
        given, known = section.data.get(group), schema.model_fields
        for key in given if isinstance(given, dict) else ():
            if key not in known:
                at, guess = (group, key), closest(key, known)
                report, remedy = (error, f"did you mean {guess}?") if guess else (warning, None)
                message = f"unknown key {spell(at)}" + ("" if guess else " is ignored")
                report(section.line_of(at), at, message, remedy)


def _check_wheels(section: Section, error: Report) -> None:
    """A wheel has no keys but its own, so that every other one is an error."""
    wheels = section.data.get("wheels")
    named = (
        wheels.items() if isinstance(wheels, dict) else enumerate(wheels) if isinstance(wheels, list) else ()
    )
    known = NESTED["wheels"].model_fields.keys() - ({"name"} if isinstance(wheels, dict) else set())
    for name, wheel in named:
        for key in [key for key in wheel if key not in known] if isinstance(wheel, dict) else ():
            at: Path = ("wheels", name, key)
            guess = closest(key, known - wheel.keys())
            remedy = (
                f"did you mean {guess}?" if guess else f"remove it; a wheel has {', '.join(sorted(known))}"
            )
            error(section.line_of(at), at, f"unknown key {spell(at)}", remedy)
            if guess:
                section.rename(at, guess)
