"""Arguments that are not of the type their annotation states, told once a call has failed."""

import inspect
import os
import re
from collections.abc import Callable, Mapping
from numbers import Real
from typing import Any, get_origin

from six_wheel.kinematics.errors import FileError

__all__ = ["mistyped"]


def _is_array(value: object) -> bool:
    import numpy as np

    try:
        np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        return False
    return True


# What an annotation calls for, in words, and the test of it.
KINDS: Mapping[str, tuple[str, Callable[[Any], bool]]] = {
    "ArrayLike": ("real numbers", _is_array),
    "Callable": ("callable", callable),
    "Floats": ("real numbers", _is_array),
    "None": ("None", lambda value: value is None),
    "Path": ("a path", lambda value: isinstance(value, str | os.PathLike)),
    "PathLike": ("a path", lambda value: isinstance(value, str | os.PathLike)),
    "bool": ("True or False", lambda value: value in (True, False)),
    "float": ("a number", lambda value: isinstance(value, Real)),
    "int": ("a whole number", lambda value: hasattr(value, "__index__")),
    "str": ("a str", lambda value: isinstance(value, str)),
}


def mistyped(
    signatures: Mapping[Callable[..., Any], inspect.Signature],
    arguments: tuple[Any, ...],
    keywords: Mapping[str, Any],
    error: Exception,
) -> str | None:
    """The message for the first argument of a failed call that is not what its annotation states.

    None if every argument is, if the annotations do not tell, or if the error names an argument itself.

    Parameters
    ----------
    signatures : mapping of callable to Signature
        The function that was called, then those that its ``**options`` go to.
    arguments, keywords
        What was given.
    error : Exception
        What came of it.
    """
    named = {name for signature in signatures.values() for name in signature.parameters}
    if isinstance(error, FileError) or re.match(r"\w*", str(error))[0] in named:  # type: ignore[index]
        return None
    given = dict(keywords)
    for function, signature in signatures.items():
        given |= dict(zip(signature.parameters, arguments, strict=False))
        arguments = ()
        for name, parameter in signature.parameters.items():
            if name not in given or (stated := _stated(function, parameter)) is None:
                continue
            if not any(fits(given[name]) for _, fits in stated.values()):
                words = dict.fromkeys(text for text, _ in stated.values() if text != "None")
                got = " ".join(repr(given[name]).split())[:100]
                hint = f": give sw.load({got})" if "Rover" in stated and isinstance(given[name], str) else ""
                return f"{name} must be {' or '.join(words)}, got {got}{hint}"
    return None


def _stated(
    function: Callable[..., Any], parameter: inspect.Parameter
) -> dict[str, tuple[str, Callable[[Any], bool]]] | None:
    """What an annotation calls for, by its words; None where a word tells nothing."""
    text = parameter.annotation
    if text is parameter.empty or parameter.kind in (parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL):
        return None
    text = text if isinstance(text, str) else inspect.formatannotation(text)
    while (inner := re.sub(r"\[[^\[\]]*\]", "", text)) != text:
        text = inner
    stated = {}
    for word in text.replace(" ", "").strip("\"'").split("|"):
        name = word.rpartition(".")[2]
        kind = getattr(function, "__globals__", {}).get(name)
        name = "Callable" if get_origin(kind) is Callable else name
        if name in KINDS:
            stated[name] = KINDS[name]
        elif inspect.isclass(kind) and kind.__module__.startswith("six_wheel"):
            stated[name] = f"a {name}", lambda value, kind=kind: isinstance(value, kind)  # type: ignore[misc]
        else:
            return None
    return stated
