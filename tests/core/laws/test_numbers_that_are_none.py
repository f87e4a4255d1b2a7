"""No NaN or infinity leaves a call that got finite numbers, unless its docstring and its status say why.

Every public call that numbers go into, and every row of the benchmark's table of batches: each number and
each array is replaced by extreme ones.
"""

import inspect
import re
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from six_wheel.cli import benchmark
from tests.objects.calls import Call, calls, functions

BENCHES = Path(__file__).parents[3] / "benches"
EXTREMES = (0.0, -0.0, 5e-324, 1e-300, 1e8, 1e16, 1e150, -1e154, 1e200, 1e300, 1.7e308, -1.7e308)
# Calls that take files, tables and objects of other libraries, or numbers only within a mapping.
NO_NUMBERS = re.compile(
    r".*\.(to_\w+|from_\w+|save|read|rows|in_radians|restore|readings|corrected|factor|of|covers|merge)|"
    r"(drive|load|read_log|replay|traverse|calibrate|plot|set_default_threads|dead_reckon|WheelLog)"
)
FLAGS = ("status", "health")


def numbers(result: Any, name: str = "") -> Iterator[tuple[str, Any, np.ndarray]]:
    """All floating numbers of a result: how one gets at them, whose they are, and their values."""
    if isinstance(result, float | np.ndarray | np.floating):
        if np.asarray(result).dtype.kind == "f":
            yield name, None, np.asarray(result)
    elif isinstance(result, dict):
        for key, part in result.items():
            yield from numbers(part, f"{name}[{key!r}]")
    elif type(result).__module__.startswith("six_wheel"):
        for part in dir(result):
            member = inspect.getattr_static(type(result), part, None)
            if not part.startswith("_") and (inspect.isdatadescriptor(member) or part in vars_of(result)):
                value = getattr(result, part)
                if isinstance(value, float | np.ndarray) and np.asarray(value).dtype.kind == "f":
                    yield f"{name}.{part}", result, np.asarray(value)
    elif isinstance(result, tuple | list):
        for place, part in enumerate(result):
            yield from numbers(part, f"{name}[{place}]")


def vars_of(result: Any) -> Any:
    return getattr(result, "__dict__", ())


SAYS = re.compile(r"\b(nan|inf|infinite|infinity)\b", re.IGNORECASE)


def is_said(call: Callable[..., Any], name: str, owner: Any, ordinary: Any) -> bool:
    """True if a docstring or a status says why a number is none.

    That of an attribute is enough. That of a call or of a class is, where there is no status, or one that is
    another than with ordinary arguments.
    """
    if owner is None:
        text = inspect.getdoc(call) or ""
        return bool(SAYS.search(text.partition("Returns\n")[2] or text))
    attribute = inspect.getattr_static(type(owner), name.rpartition(".")[2], None)
    if attribute is not None and SAYS.search(inspect.getdoc(attribute) or ""):
        return True
    if not SAYS.search((inspect.getdoc(type(owner)) or "") + (inspect.getdoc(call) or "")):
        return False
    flags = [flag for flag in FLAGS if hasattr(owner, flag)]
    return any(
        np.any(np.asarray(getattr(owner, flag)) != np.asarray(getattr(ordinary, flag, None)))
        for flag in flags
    )


class Open:
    """Stands for a number that is none with ordinary arguments."""


def unsaid(function: Callable[[], Any], call: Callable[..., Any], usual: dict[str, Any]) -> list[str]:
    """Numbers of a result that are none without a word; none where the call refuses its arguments."""
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            found = list(numbers(function()))
    except (ValueError, MemoryError):
        return []
    return [
        name
        for name, owner, values in found
        if not np.isfinite(values).all()
        and usual.get(name) is not Open
        and not is_said(call, name, owner, usual.get(name))
    ]


def extreme(value: Any) -> Iterator[Any]:
    """A number, an array or a tuple with one number, and with all, replaced by extreme ones."""
    for number in EXTREMES:
        if isinstance(value, float):
            yield number
        elif isinstance(value, tuple) and value and all(isinstance(each, float) for each in value):
            yield (number,) * len(value)
            yield (number, *value[1:])
        elif isinstance(value, np.ndarray) and value.dtype.kind == "f" and value.size:
            yield np.full_like(value, number)
            if value.ndim == 0:
                continue
            for column in range(value.shape[-1] if value.ndim > 1 else 1):
                changed = np.array(value)
                changed[(-1,) if value.ndim == 1 else (0, ..., column)] = number
                yield changed


def usual_of(function: Callable[[], Any]) -> dict[str, Any]:
    """Of ordinary arguments: whose a number is, by its name; `Open` where it is none even then."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = numbers(function())
        return {name: owner if np.isfinite(values).all() else Open for name, owner, values in found}


CALLS = {call.name: call for call in calls() if not NO_NUMBERS.fullmatch(call.name)}


def test_every_call_with_numbers_is_walked() -> None:
    names = {name for name, _, _ in functions() if not NO_NUMBERS.fullmatch(name)}
    assert names - CALLS.keys() == set()


@pytest.mark.parametrize("name", CALLS)
def test_no_call_gives_numbers_that_are_none(name: str) -> None:
    call: Call = CALLS[name]
    usual, wrong = usual_of(call), set()
    for argument, value in (call.arguments | call.optional).items():
        for given in extreme(value):
            changed = {argument: given}
            for each in unsaid(lambda changed=changed: call(**changed), call.function, usual):
                wrong.add(f"{argument}: {each}")
    assert wrong == set()


def test_no_batch_gives_numbers_that_are_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(benchmark, "SPAN", 1e-5)
    monkeypatch.syspath_prepend(BENCHES)
    import every_call

    wrong = set()
    for row in every_call.listed(4):
        keywords = {key: value for key, value in row.keywords.items() if key != "out"}
        kind, _, method = row.call.rpartition(".")
        documented = getattr(getattr(every_call.sw, kind), method) if kind else row.function
        usual = usual_of(lambda row=row, keywords=keywords: row.function(*row.arguments, **keywords))
        for place, value in [*enumerate(row.arguments), *keywords.items()]:
            for given in extreme(value):
                arguments = [given if place == k else each for k, each in enumerate(row.arguments)]
                named = {key: given if place == key else each for key, each in keywords.items()}

                def run(row: Any = row, arguments: Any = arguments, named: Any = named) -> Any:
                    return row.function(*arguments, **named)

                wrong |= {f"{row.call}: {place}: {each}" for each in unsaid(run, documented, usual)}
    assert wrong == set()
