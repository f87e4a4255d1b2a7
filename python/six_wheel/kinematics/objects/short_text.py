"""Short text of results: one line for `repr`."""

from __future__ import annotations  # NumPy is not loaded for its names

from collections.abc import Mapping
from typing import Any, TypeVar

_C = TypeVar("_C", bound=type[Any])

LONGEST = 120  # characters of a representation
FEW = 6  # numbers of an array that are shown


def short_repr(name: str, values: Mapping[str, Any]) -> str:
    """``name(key=value, ...)`` in one line of at most `LONGEST` characters; what does not fit is `...`."""
    parts: list[str] = []
    room = LONGEST - len(name) - len("(, ...)")
    for key, value in values.items():
        part = f"{key}={short(value)}"
        if len(part) > room and parts:
            parts.append("...")
            break
        parts.append(part[:room])
        room -= len(part) + 2
    return f"{name}({', '.join(parts)})"


def of_arrays(kind: _C) -> _C:
    """Decorator of a named tuple of arrays: its text is one line; it equals a tuple of the same numbers."""

    def equals(self: Any, other: object) -> bool:
        if not isinstance(other, tuple) or len(other) != len(self):
            return False
        import numpy as np

        return all(np.array_equal(mine, its, equal_nan=True) for mine, its in zip(self, other, strict=True))

    def text(self: Any) -> str:
        if any(getattr(value, "shape", ()) for value in self):
            return short_repr(kind.__name__, self._asdict())
        return str(numbers(self))  # with all digits

    def differs(self: Any, other: object) -> bool:
        return not equals(self, other)

    made: Any = kind
    numbers = made.__repr__
    made.__repr__, made.__eq__, made.__ne__ = text, equals, differs
    return kind


def short(value: Any) -> str:
    """A value in a few characters: numbers to four digits, arrays of many numbers by their shape."""
    if isinstance(value, str):
        return repr(value)
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, tuple | list):
        if len(value) > FEW:
            return f"<{len(value)}>"
        return f"({', '.join(map(short, value))})"
    shape = getattr(value, "shape", None)
    if shape is not None and shape != ():
        if len(shape) == 1 and shape[0] <= FEW:
            return f"[{', '.join(short(item) for item in value.tolist())}]"
        return f"<{' x '.join(map(str, shape))}>"
    if shape == ():
        return short(value.item())
    return repr(value)


def described(kind: str, stamps: Any, poses: Any) -> str:
    """One line on a track: its rows, its duration, and where it ends."""
    if not len(stamps):
        return f"{kind}(0 rows)"
    end = ", ".join(f"{number:.4f}" for number in poses[-1][:3])
    return f"{kind}({len(stamps)} rows, {stamps[-1] - stamps[0]:.6g} s, ends at ({end}))"


def few(lines: list[str], most: int = 5) -> list[str]:
    """At most so many lines, the last of which counts the others."""
    return lines if len(lines) <= most else [*lines[: most - 1], f"and {len(lines) - most + 1} kinds more"]
