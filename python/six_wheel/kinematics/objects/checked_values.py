"""Values that are checked when they are made: numbers of named tuples, rows of tables."""

from __future__ import annotations  # NumPy is not loaded for its names

import re
from collections.abc import Mapping
from functools import wraps
from typing import Any, TypeVar

from six_wheel.kinematics.errors import ArgumentTypeError, shown

_C = TypeVar("_C", bound=type[Any])


def is_number(value: object) -> bool:
    """True of what `float` takes for one number, an array of no axes too; not of True, False and text."""
    if isinstance(value, bool | str | type) or not hasattr(value, "__float__"):
        return False
    return not hasattr(value, "__len__") or getattr(value, "shape", None) == ()


def of_numbers(kind: _C) -> _C:
    """Decorator of a `checked_class` of numbers: what is no number is refused by its name when one is made.

    ``_make``, by which methods make their results, checks nothing.
    """
    careful: Any = kind.__new__
    plain = careful.__wrapped__  # the checks of keywords are left to calls that fail: twice as fast

    @wraps(careful)
    def new(cls: type[Any], /, *given: Any, **named: Any) -> Any:
        try:
            made = plain(cls, *given, **named)
        except TypeError:
            return careful(cls, *given, **named)  # raises, with the nearest keyword
        for value in made:
            if type(value) is not float and not is_number(value):
                raise ArgumentTypeError(_no_number(kind, made))
        return made

    kind.__new__ = new
    return kind


def _no_number(kind: type[Any], made: tuple[Any, ...]) -> str:
    pairs = zip(kind._fields, made, strict=True)
    name, value = next((name, value) for name, value in pairs if not is_number(value))
    try:
        apart = not isinstance(value, str) and name == kind._fields[0] and len(value) == len(made)
    except TypeError:
        apart = False
    hint = f"; {kind.__name__}(*values) takes {len(made)} numbers of a sequence" if apart else ""
    return f"{name} must be a number, got {shown(value)}{hint}"


def check_columns(table: object, shapes: Mapping[str, str], optional: tuple[str, ...]) -> None:
    """Refuse a field of a table that is no array, or has another number of rows than the first one.

    `shapes` are such as ``(n, 3)``, with n rows; other words stand for any number. Fields of `optional` may
    be None. Raises `ArgumentTypeError`.
    """
    rows: int | None = None
    for name, words in shapes.items():
        value = getattr(table, name)
        if value is None and name in optional:
            continue
        shape: Any = getattr(value, "shape", None)
        if isinstance(shape, tuple) and rows is None and shape:
            rows = shape[0]
        sizes = [str(rows) if word == "n" else word for word in re.findall(r"\w+", words)]
        wanted = [
            size if size.isdigit() else str(given) for size, given in zip(sizes, shape or (), strict=False)
        ]
        if not isinstance(shape, tuple) or [str(size) for size in shape] != wanted[: len(sizes)]:
            got = f"shape {shape}" if isinstance(shape, tuple) else shown(value)
            count = "" if rows is None else f", n = {rows}"
            raise ArgumentTypeError(f"{name} must be an array of shape {words}{count}, got {got}")
