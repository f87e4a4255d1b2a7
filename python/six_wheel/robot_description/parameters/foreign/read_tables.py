"""Forms of files of others, from the TOML tables beside this file, one for each robot or vendor.

Entries of a file hold for all its forms, ``[groups.NAME]`` are keys that several share, ``[[forms]]`` has

- `name`, `kind`, `controller`, `ros1`, `ignored`, `stand_in`: as in `Form`; `telling` is by default every key
  that is not in `shared_keys`;
- ``[forms.keys]``: a line for each key, as `key_types` reads them;
- `layout`: a function of `LAYOUTS`, or constructors of `Rover` of which the first counts that `when` fits,
  with an amount for each argument. An amount is a product of keys and numbers (a key that is not given is 1),
  ``|key|`` is the absolute value, ``#key`` the length, ``/`` divides by what follows, `or` separates what
  counts if the first key before it is not given;
- `joints`: a function of `JOINTS`, or arguments of `JointList`. `wheels` are names, ``*`` all of them,
  ``*left`` those that end so; `for` makes a list for each wheel, `given` leaves it out where its key
  (``each``) or one of these keys (``all``) is not given; `axles` are the file's words for axles;
- `check` and `complete`: functions of `CHECKS` and `COMPLETIONS`; `notes` are warnings, `unless` a key is
  given, if `when` fits and there are `several` joints;
- `states` and `reversed_by`: see `names`; `traction_joints`, `steering_joints`, `reversed_joints`: those of a
  robot whose files do not have them; `limits`: amounts; `names`: keys under another name.
"""

import tomllib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, TypeAlias

from six_wheel._core import Rover
from six_wheel.robot_description.parameters.foreign import layouts, limits, names, steering
from six_wheel.robot_description.parameters.joints import JointList
from six_wheel.robot_description.parameters.key_types import Common, Values, schema
from six_wheel.robot_description.parameters.ros_node_parameters import Section
from six_wheel.robot_description.parameters.ros_yaml import Report
from six_wheel.robot_description.parameters.schema import Form

# In the order of the page of keys; of two forms with as many of a file's keys the first counts.
FILES = """
    ros2_controllers open_source_rover curio leo turtlebot3 rover_robotics husarion ros1 pathplanner yagsl
"""
CORNERS = ("front_left", "front_right", "rear_left", "rear_right")
WHEELS = {
    "corners": CORNERS,
    "six": ("front_left", "front_right", "middle_left", "middle_right", "rear_left", "rear_right"),
}
Table: TypeAlias = dict[str, Any]
Check: TypeAlias = Callable[[Section, Values, Report, Report], None]


# Layouts.


def _fits(values: Values, when: Table) -> bool:
    for key, expected in when.items():
        value = values.get(key)
        match expected:
            case {"contains": part}:
                fits = part in (value or "")
            case {"not": other}:
                fits = value != other
            case {"other_than": other}:
                fits = key in values and value != other
            case _:
                fits = value == expected
        if not fits:
            return False
    return True


def _amount(values: Values, text: str) -> float:
    *others, product = text.split(" or ")
    for other in others:
        if other.split()[0] in values:
            product = other
            break
    amount, divides = 1.0, False
    for word in product.split():
        if word == "/":
            divides = True
            continue
        if word.startswith("#"):
            return len(values[word[1:]])
        if word[0].isdigit():
            factor = float(word)
        else:
            key = word.strip("|")
            factor = values.get(key, 1.0)
            factor = abs(factor) if key != word else factor
        amount, divides = amount / factor if divides else amount * factor, False
    return amount


def _argument(values: Values, given: Any) -> Any:
    match given:
        case {"are": constants}:
            return constants
        case list():
            return tuple(_argument(values, part) for part in given)
        case str():
            return _amount(values, given)
    return given


def _chosen(layouts: list[Table], values: Values) -> Table:
    return next(one for one in layouts if _fits(values, one.get("when", {})))


def _layout(given: str | list[Table]) -> Callable[[Values], Rover]:
    if isinstance(given, str):
        return LAYOUTS[given]

    def layout(values: Values) -> Rover:
        chosen = _chosen(given, values)
        arguments = {key: _argument(values, of) for key, of in chosen.items() if key not in ("make", "when")}
        rover: Rover = getattr(Rover, chosen["make"])(**arguments)
        return rover

    return layout


# Joints.


def _keys_by_wheel(one: Table, axles: Mapping[str, str], values: Mapping[str, Any]) -> dict[str, str]:
    """The key of each wheel of `for`: of several names the first that is given, or else the last."""
    found = {}
    for wheel in WHEELS[one["for"]]:
        axle, side = wheel.split("_")
        patterns = [one["key"]] if isinstance(one["key"], str) else one["key"]
        keys = [each.format(wheel=wheel, axle=axles.get(axle, axle), side=side) for each in patterns]
        found[wheel] = next((key for key in keys if key in values), keys[-1])
    return found


def _expanded(form: Table, values: Values) -> Iterator[Table]:
    for one in form["joints"]:
        if "for" not in one:
            yield one
            continue
        keys = _keys_by_wheel(one, form.get("axles", {}), values)
        if one.get("given") == "all" and not all(key in values for key in keys.values()):
            continue
        for wheel, key in keys.items():
            elsewhere = [other for other in keys if other != wheel] if "elsewhere" in one else []
            if one.get("given") != "each" or key in values:
                yield one | {"key": key, "wheels": [wheel], "elsewhere": elsewhere}


def _joint_lists(form: Table) -> Callable[[Values, Rover], list[JointList]]:
    if isinstance(form["joints"], str):
        return JOINTS[form["joints"]]

    def lists(values: Values, rover: Rover) -> list[JointList]:
        def wheels(given: str | list[str]) -> tuple[str, ...]:
            if isinstance(given, str):
                return tuple(name for name in rover.wheel_names if name.endswith(given[1:]))
            return tuple(given)

        return [
            JointList(
                one["key"],
                wheels(one["wheels"]),
                wheels(one.get("elsewhere", [])),
                **{key: one[key] for key in ("lack", "order", "steers") if key in one},
            )
            for one in _expanded(form, values)
        ]

    return lists


# Checks of several keys together, and of keys beyond the model.


def _checks(form: Table, keys: Mapping[str, str]) -> Check:
    checks = [CHECKS[name] for name in form.get("check", ()) if name != "steering"]
    if "steering" in form.get("check", ()):
        descriptions = {key: text.partition(" ")[2] for key, text in keys.items()}
        checks.append(steering.check_steering(form, descriptions))
    notes = form.get("notes", ())

    def check(section: Section, values: Values, error: Report, warning: Report) -> None:
        for each in checks:
            each(section, values, error, warning)
        for one in form["joints"] if isinstance(form["joints"], list) else ():
            if one.get("given") == "each":
                _check_all_given(_keys_by_wheel(one, form["axles"], values), section, error)
        for note in notes:
            count = len(values.get(note.get("several"), ()))
            given = note.get("unless") in section.data or ("several" in note and count < 2)
            if not given and _fits(values, note.get("when", {})):
                at = (note["at"],)
                section.report(warning, at, note["message"].format(count=count), note["remedy"].strip())

    return check


def _check_all_given(keys: dict[str, str], section: Section, error: Report) -> None:
    """A file that names the joint of one wheel names those of all."""
    missing = [wheel for wheel, key in keys.items() if key not in section.data]
    for wheel in missing if len(missing) < len(keys) else ():
        key = keys[wheel]
        error(section.line, (key,), f"{key} is missing", f"add {key}, the joint of the {wheel} wheel")


# Values that follow from the keys.


def _completion(form: Table) -> Callable[[Section, Values], Values]:
    complete = COMPLETIONS[form["complete"]] if "complete" in form else lambda section, values: values
    said = {
        key: form[key] for key in ("traction_joints", "steering_joints", "reversed_joints") if key in form
    }

    def completed(section: Section, values: Values) -> Values:
        values = values | names.by_states(form.get("states", {}), section, values)
        values |= names.reversed_by_sign(form.get("reversed_by", {}), values)
        values = complete(section, values)
        data = section.data
        known = said | {name: data[key] for name, key in form.get("names", {}).items() if key in data}
        values = known | values
        amounts = {
            name: _amount(values, of)
            for name, of in form.get("limits", {}).items()
            if all(key in values for key in of.replace("/", "").split())
        }
        if amounts:
            values["limits"] = amounts | values.get("limits", {})
        timeout = values.get(form.get("timeout_in_milliseconds", ""))
        if timeout is not None:
            values["control"] = {"timeout": timeout / 1000 if timeout else "never"} | values.get(
                "control", {}
            )
        return values

    return completed


LAYOUTS = {
    "mecanum": layouts.mecanum,
    "omni": layouts.omni,
    "curio": layouts.curio,
    "yagsl": layouts.yagsl,
    "ackermann_steering": steering.ackermann_steering,
    "tricycle_steering": steering.tricycle_steering,
    "tricycle": steering.tricycle,
    "bicycle_steering": steering.bicycle_steering,
}
JOINTS = {
    "stated_joints": names.stated_joints,
    "right_before_left": steering.right_before_left,
    "steered_wheel": steering.steered_wheel,
}
CHECKS: dict[str, Check] = {
    "limits": limits.check_limits,
    "wheels_per_side": layouts.check_wheels_per_side,
    "half_wheelbase": layouts.check_half_wheelbase,
    "places_of_modules": layouts.check_places_of_modules,
    "tricycle": steering.check_tricycle,
}
COMPLETIONS: dict[str, Callable[[Section, Values], Values]] = {
    "limits": limits.with_limits,
    "axle_behind": steering.with_axle_behind,
    "steering_range": steering.with_steering_range,
}


def _form(form: Table, file: Table) -> Form:
    form = {key: file[key] for key in ("check", "complete") if key in file} | form
    keys: dict[str, str] = {}
    for group in form.get("groups", ()):
        keys |= file["groups"][group]
    keys |= form.get("keys", {})
    shared = {*file.get("shared_keys", ()), *limits.LIMITS, *limits.STEERING_RANGE}
    stand_in = file.get("stand_in", {}) | form.get("stand_in", {})
    kinds = form["layout"] if form.get("kind_by_layout") else None
    return Form(
        form["name"],
        form["kind"],
        schema(form["name"], keys, Common),
        _layout(form["layout"]),
        _joint_lists(form),
        telling=frozenset(form.get("telling", keys.keys() - shared)),
        stand_in={key: value for key, value in stand_in.items() if key in keys},
        check=_checks(form, keys),
        complete=_completion(form),
        controller=form.get("controller"),
        ros1=form.get("ros1", False),
        kind_of=None if kinds is None else lambda values: str(_chosen(kinds, values)["make"]),
        ignored=frozenset(form.get("ignored", ())),
    )


def _tables() -> Iterator[Table]:
    for file in FILES.split():
        yield tomllib.loads(Path(__file__).with_name(f"{file}.toml").read_text(encoding="utf-8"))


FOREIGN = tuple(_form(form, file) for file in _tables() for form in file["forms"])
"""The forms in which files of others describe a rover."""
WELL_KNOWN = frozenset(key for file in _tables() for key in file.get("well_known", "").split())
"""Parameters of controllers, their manager and ROS 2 nodes that do not concern kinematics."""
