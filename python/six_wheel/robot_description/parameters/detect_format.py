"""Detects the form in which a file describes a rover, and checks that the file has the keys of that form."""

import math
import re
from typing import Any

from six_wheel.robot_description.parameters.foreign.read_tables import FOREIGN, WELL_KNOWN
from six_wheel.robot_description.parameters.foreign.steering import DRIVES, STEERS
from six_wheel.robot_description.parameters.key_types import GROUPS as MAPPINGS
from six_wheel.robot_description.parameters.key_types import Common, Values, keys_of
from six_wheel.robot_description.parameters.ros_node_parameters import (
    GROUPS,
    Section,
    closest,
    drives,
    section,
)
from six_wheel.robot_description.parameters.ros_yaml import Path, Report, Tree, one_line, spell
from six_wheel.robot_description.parameters.schema import NESTED, Form, describe, shown
from six_wheel.robot_description.parameters.vehicle_types import DIMENSIONS, KINDS, OWN_KEYS, PRESET
from six_wheel.robot_description.parameters.vehicle_types import TELLING as OWN_TELLING

TYPES = {type_: form for form in FOREIGN for type_ in (form.controller, *form.more) if type_}
KEYS = OWN_KEYS.union(*(form.keys for form in FOREIGN))
# A node with this package's own keys comes before one that only has those of a controller.
TELLING = (OWN_TELLING, frozenset[str]().union(*(form.telling for form in FOREIGN)))
PLAIN = frozenset[str]().union(*(form.telling for form in FOREIGN if form.ros1))
"""Keys of files without ``ros__parameters``."""

NODE_OPTIONS = frozenset(
    {"autostart", "imu_timeout", "joint_state_timeout", "record", "reset_on_time_jump", "tf_frame_prefix"}
)
"""Parameters that only `six-wheel node` and `filter` declare; they say nothing of the rover."""
NO_LIMIT = 1e6  # value of a limit from which on it is none, in parameters of ROS

_LIMIT = re.compile(
    r"(linear|angular|traction|steering)\.(\w\.)?"
    r"((min|max)_(velocity|acceleration|deceleration|jerk|position)(_reverse)?|has_\w+_limits)"
)


def section_of(tree: Tree, node: str | None, report: Report) -> Section | None:
    """The parameters of the rover in a file; see `ros_node_parameters.section`."""
    found = section(tree, node, KEYS, TELLING, PLAIN, report)
    if found is not None and NODE_OPTIONS & found.data.keys():
        for name in {*NODE_OPTIONS, "rover", "robot_description"} & found.data.keys():
            found.node_options[name] = found.data.pop(name)
        _drop_unset(found.data)
    return found


def _drop_unset(data: Values) -> None:
    """Take out what `ros2 param dump` writes of `six-wheel node` and nobody gave: there 0 stands for none."""
    limits, control = (
        dict(group) if isinstance(group := data.get(key), dict) else {} for key in ("limits", "control")
    )
    limits = {name: math.inf if value == NO_LIMIT else value for name, value in limits.items() if value != 0}
    if control.get("following_error") == 0:
        control["following_error"] = "never"
    if isinstance(timeout := data.get("cmd_vel_timeout"), int | float):
        control["timeout"] = timeout or "never"
    data.update(
        {key: group for key, group in (("limits", limits), ("control", control)) if group or key in data}
    )


def form_of(section: Section, error: Report, warning: Report, asked: str | None = None) -> Form | None:
    """The form, by what is asked for or the file says of it, else by its keys; None, with the reason
    reported, if unclear."""
    data = section.data
    if asked is not None:
        return _asked(section, asked, error)
    if "preset" in data:
        return PRESET
    kind = data.get("kind")
    if isinstance(kind, str) and kind in KINDS:
        return _controller_of(data, [form for form in FOREIGN if form.kind == kind]) or KINDS[kind]
    if "kind" in data:
        guess = closest(kind, KINDS) if isinstance(kind, str) else None
        message = f"kind must be one of {', '.join(KINDS)}, got {shown(kind)}"
        section.report(error, ("kind",), message, f"did you mean {guess}?" if guess else "choose one")
        if guess and KINDS[guess].needed <= data.keys():
            return KINDS[guess]
    by_keys = _controller_of(data, list(FOREIGN))
    known = TYPES.get(section.type or "")
    if known is not None:
        # Some share a type: then it is the one with more of these keys.
        ahead = by_keys is not None and _score(by_keys, data) > _score(known, data)
        return by_keys if ahead and by_keys is not None else known
    own = bool(data.keys() & set(DIMENSIONS[:4]))
    if section.type is not None and drives(section.type) and not own:
        return _of_unknown_type(section, by_keys, error, warning)
    if own:
        return KINDS["six_wheel"]
    others = data.keys() & OWN_KEYS - keys_of(KINDS["six_wheel"].schema).keys()
    if by_keys is None and others and "kind" not in data:
        own_keys = data.keys() & OWN_KEYS
        fitting = [form.kind for form in KINDS.values() if form.needed <= own_keys <= form.keys.keys()]
        names = ", or ".join(f"kind: {kind}" for kind in fitting) or f"kind, one of {', '.join(KINDS)}"
        first = next(key for key in data if key in others)
        message = f"kind is missing, and {first} is no key of {KINDS['six_wheel'].name}"
        error(section.line, ("kind",), message, f"add {names}")
        return None
    telling = {*OWN_TELLING, *DIMENSIONS}
    plain = [key for key, value in data.items() if not isinstance(value, dict)]
    nearly_own = data.keys() & telling or any(closest(key, telling) for key in plain)
    if by_keys is None and data and not nearly_own:
        _report_unknown(section, error)
        return None
    is_unknown = by_keys is None and section.type is not None
    if is_unknown and not any(closest(key, DIMENSIONS[:4]) for key in plain):
        return _of_unknown_type(section, None, error, warning)
    return by_keys or KINDS["six_wheel"]


def _asked(section: Section, asked: str, error: Report) -> Form | None:
    """The form of that name: a kind, a controller or its type."""
    forms = {form.name: form for form in FOREIGN} | TYPES | KINDS
    if asked in forms:
        return forms[asked]
    guess = closest(asked, forms)
    names = ", ".join([*KINDS, *(form.name for form in FOREIGN)])
    remedy = f"did you mean {guess}?" if guess else f"known are {names}"
    error(section.line, (), f"--kind must name a kind or a controller, got {one_line(asked)}", remedy)
    return None


def _of_unknown_type(section: Section, by_keys: Form | None, error: Report, warning: Report) -> Form | None:
    """Form of a controller of unknown type: the form whose keys it has, with a warning, else an error."""
    at = ("type",)
    line = section.line_of(at)
    node, type_ = one_line(section.node or "the file"), one_line(str(section.type))
    what = f"{node} has the type {type_}, which is not known"
    if by_keys is not None and by_keys.needed <= section.data.keys():
        remedy = "say with --kind what it is, if that is wrong"
        warning(line, at, f"{what}: read as {by_keys.name}, whose keys it has", remedy)
        return by_keys
    names = ", ".join(sorted({form.name for form in FOREIGN if form.controller}))
    remedy = f"known are {names}; describe the vehicle with a kind, or read its keys as another's with --kind"
    error(line, at, what, remedy)
    return None


def _report_unknown(section: Section, error: Report) -> None:
    """One line for a file in which nothing is a rover's."""
    keys = [one_line(key) for key in section.data]
    listed = f"{', '.join(keys[:6])}{', ...' if len(keys) > 6 else ''}"
    message = f"nothing here says where the wheels are; the keys are {listed}"
    remedy = (
        "give the file of the drive controller or the URDF, or add a kind and its keys; "
        "--kind reads the keys as a controller's"
    )
    error(section.line, (), message, remedy)


def _controller_of(data: dict[str, Any], forms: list[Form]) -> Form | None:
    """The controller that has most of these keys."""

    best = max(forms, key=lambda form: _score(form, data), default=None)
    return best if best is not None and _score(best, data)[0] else None


def _score(form: Form, data: dict[str, Any]) -> tuple[int, bool]:
    return len(data.keys() & form.telling), _fits(data, form)


def _fits(data: dict[str, Any], form: Form) -> bool:
    """True if the lists of joints are as long as the form, a steering controller, needs."""
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
    for key in [key for key in data if key not in keys and not is_ignored(key, form)]:
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
        declared = field.annotation is float and (field.is_required() or form.controller) and not form.ros1
        if declared and section.node is not None and type(section.data.get(key)) is int:
            message = f"{key} is an integer, which ROS 2 refuses where it expects a floating-point number"
            section.report(warning, (key,), message, f"write {section.data[key]}.0")


def is_ignored(key: str, form: Form) -> bool:
    """True if a key that a form does not read is no mistake either."""
    head = key.split(".")[0]
    if form in FOREIGN and head in ("linear", "angular", "traction", "steering"):
        return _LIMIT.fullmatch(key) is not None
    return head in WELL_KNOWN or key in form.ignored or head in form.ignored


def _check_groups(section: Section, error: Report, warning: Report) -> None:
    """The keys of `limits` and the other mappings that every rover may have."""
    for group, schema in MAPPINGS.items():
        given, known = section.data.get(group), schema.model_fields
        for key in given if isinstance(given, dict) else ():
            if key not in known:
                at, guess = (group, key), closest(key, known)
                report, remedy = (error, f"did you mean {guess}?") if guess else (warning, None)
                message = f"unknown key {spell(at)}" + ("" if guess else " is ignored")
                section.report(report, at, message, remedy)


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
            section.report(error, at, f"unknown key {spell(at)}", remedy)
            if guess:
                section.rename(at, guess)
