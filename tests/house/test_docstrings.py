"""Public calls state their parameters, with units or shapes, and their errors, where they are documented."""

import enum
import inspect
import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest

pytest.importorskip("scipy", reason="walks every public name, and calibration needs SciPy")

import six_wheel as sw
from six_wheel import profiles

# Forms in which a number is stated: a unit in brackets, a shape, or what it counts.
STATED = re.compile(
    r"\[[^\]]+\]|shape|[Ss]hare|factor|[Nn]umber|[Pp]robability|[Cc]ost|seed|unit|rows|count|threads"
    r"|[Tt]urns|times\b|[Pp]er second|[Pp]er turn|True"
)
NUMBERS = re.compile(r"float|array_like|ndarray")


def calls() -> Iterator[tuple[str, Callable[..., Any], bool]]:
    """Public functions, classes and methods of the first page, `profiles` and `se2`; True of the core's."""
    seen: set[int] = set()
    for module in (sw, profiles, sw.se2):
        for name in module.__all__:
            one = getattr(module, name)
            if id(one) in seen or not callable(one) or inspect.ismodule(one):
                continue
            seen.add(id(one))
            core = getattr(one, "__module__", "") in ("six_wheel", "six_wheel._core")
            core = core and not inspect.isfunction(one)
            if not inspect.isclass(one):
                yield name, one, core
                continue
            if issubclass(one, BaseException | enum.Enum):
                continue
            yield name, one, core
            for part, member in vars(one).items():
                inner = member.__func__ if isinstance(member, staticmethod | classmethod) else member
                if not part.startswith("_") and callable(inner):
                    yield f"{name}.{part}", inner, core


def parameters(call: Callable[..., Any]) -> list[str]:
    try:
        signature = inspect.signature(call)
    except ValueError:
        return []
    kinds = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    return [
        each.name
        for each in signature.parameters.values()
        if each.kind not in kinds and each.name not in ("self", "cls")
    ]


CALLS = {name: (call, core) for name, call, core in calls()}
# Records are documented field by field: their text is below the fields, in the source.
RECORDS = {
    name
    for name, (call, _) in CALLS.items()
    if inspect.isclass(call)
    and (issubclass(call, tuple) or hasattr(call, "__dataclass_fields__"))
    and "Parameters\n" not in (call.__doc__ or "")
}


def entries(text: str) -> Iterator[str]:
    """Entries of the section of parameters: the line of a name and its text."""
    section = re.search(r"^Parameters\n-+\n(.*?)(?=^\w[\w ]*\n-{3,}\n|\Z)", text, re.M | re.S)
    if section:
        yield from (part for part in re.split(r"\n(?=\S)", section[1]) if part.strip())


def test_there_are_many() -> None:
    assert len(CALLS) > 250
    assert len([core for _, core in CALLS.values() if not core]) > 60


@pytest.mark.parametrize("name", [name for name in CALLS if name not in RECORDS])
def test_every_parameter_is_in_the_text(name: str) -> None:
    call, _ = CALLS[name]
    text = inspect.getdoc(call) or ""
    assert text.strip(), f"{name} has no text"
    assert [each for each in parameters(call) if not re.search(rf"\b{each}\b", text)] == []


def test_numbers_have_units_or_shapes() -> None:
    without = {
        name
        for name, (call, _) in CALLS.items()
        for entry in entries(inspect.getdoc(call) or "")
        if NUMBERS.search(entry.partition("\n")[0]) and not STATED.search(entry)
    }
    assert without == set()


@pytest.mark.parametrize(
    "name", [name for name, (call, core) in CALLS.items() if not core and inspect.isfunction(call)]
)
def test_functions_with_a_section_of_parameters_state_their_errors(name: str) -> None:
    text = inspect.getdoc(CALLS[name][0]) or ""
    if "Parameters\n---" in text:
        assert re.search(r"^(Raises|Warns)\n---", text, re.M), f"{name} does not state its errors"
