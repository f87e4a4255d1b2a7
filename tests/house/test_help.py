"""`help` and `dir`: names of types as written, defaults beside the parameters."""

import inspect
import re
from collections.abc import Iterator

import pytest

import six_wheel as sw
from six_wheel import profiles, reference
from six_wheel.kinematics import odometry
from six_wheel.log_odometry import evaluation

PACKAGES = (sw, evaluation, odometry, profiles, reference)


def public() -> Iterator[tuple[str, object]]:
    for package in PACKAGES:
        for name in package.__all__:
            member = getattr(package, name)
            if callable(member):
                yield f"{package.__name__}.{name}", member
            if inspect.isclass(member):
                for key in vars(member):
                    if not key.startswith("_") and callable(getattr(member, key)):
                        yield f"{package.__name__}.{name}.{key}", getattr(member, key)


MEMBERS = dict(public())


def signature(member: object) -> inspect.Signature | None:
    try:
        return inspect.signature(member)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None


def test_signatures_hold_names_of_types():
    drowned = [name for name, member in MEMBERS.items() if "_SupportsArray" in str(signature(member))]
    assert drowned == []


@pytest.mark.parametrize("package", [sw], ids=["six_wheel"])
def test_dir_shows_what_there_is(package):
    shown = set(dir(package))
    assert {"calibrate", "dead_reckon", "WheelLog", "Track", "umbmark", "plot", "load"} <= shown
    assert not {"PathLike", "TYPE_CHECKING", "_LATER", "attach"} & shown
    for name in shown:
        getattr(package, name)


def test_defaults_stand_in_docstrings():
    silent = []
    for name, member in MEMBERS.items():
        found, doc = signature(member), inspect.getdoc(member) or ""
        for parameter in found.parameters.values() if found else ():
            default = parameter.default
            if isinstance(default, bool) or not isinstance(default, (int, float)):
                continue  # words stand in the set of words, None says "optional"
            entry = re.search(rf"^{parameter.name} : (.*(?:\n    .*)*)", doc, re.M)
            if entry and "default" not in entry[1].lower():
                silent.append(f"{name}({parameter.name}={default})")
    assert silent == []


def test_what_is_no_function_says_what_is():
    with pytest.raises(AttributeError, match="demo.; it is a command: six-wheel demo in a shell"):
        sw.demo()
    with pytest.raises(TypeError, match="six_wheel.logs is a module, not a function; call one of .*read_log"):
        sw.logs("log.csv")
    with pytest.raises(TypeError, match="six_wheel is a module, not a function; call one of "):
        sw()
