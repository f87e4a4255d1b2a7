"""Messages for keywords and names that are not there, with the nearest one and all there are."""

import difflib
import inspect
import re
from collections.abc import Callable, Collection, Iterable
from functools import wraps
from typing import Any, TypeVar

from six_wheel.kinematics.errors import ArgumentTypeError

__all__ = ["checked", "checked_class", "did_you_mean", "explained", "same_thing", "unknown_keyword"]

_F = TypeVar("_F", bound=Callable[..., Any])
_C = TypeVar("_C", bound=type[Any])

# What a keyword of others, or of old, is here; the first that the call has counts.
NAMES = {
    "arm": ("suspension",),
    "center": ("centre",),
    "d1": ("track_width",),
    "d2": ("middle_to_rear",),
    "d3": ("front_to_middle",),
    "d4": ("middle_track_width",),
    "encoder": ("wheel_encoders",),
    "encoders": ("wheel_encoders",),
    "gear": ("gear_ratio",),
    "half_track": ("track_width",),
    "half_wheelbase": ("wheelbase",),
    "hinges": ("pivots",),
    "modulus": ("wraps_at",),
    "orientation": ("yaw",),
    "reading": ("readings",),
    "resolution": ("ticks_per_turn", "spacing"),
    "speeds": ("wheel_speeds",),
    "time_unit": ("stamp_unit",),
}
# What means the same by another number.
_OF_ENCODERS = ("wheel_encoders", "give wheel_encoders=Encoder(ticks_per_turn=..., wraps_at=...)")
SENTENCES = {
    "bits": ("wraps_at", "bits=16 is wraps_at=65536"),
    "cell_size": ("spacing", "cell_size is spacing"),
    "d1": ("track_width", "d1 is half of track_width"),
    "d4": ("middle_track_width", "d4 is half of middle_track_width"),
    "half_track": ("track_width", "half_track is half of track_width"),
    "half_wheelbase": ("wheelbase", "half_wheelbase is half of wheelbase"),
    "frequency": ("period", "give period = 1 / frequency"),
    "rate": ("period", "give period = 1 / rate"),
    **dict.fromkeys(("modulus", "resolution", "ticks_per_turn", "wraps_at"), _OF_ENCODERS),
}


def same_thing(name: str, known: Collection[str]) -> str | None:
    """The known name of what others call `name`; None if there is none, or its number is another."""
    if SENTENCES.get(name, ("", ""))[0] in known:
        return None
    return next((new for new in NAMES.get(name, ()) if new in known), None)


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """`; did you mean ...?` with the nearest known name, or nothing where none is near."""
    names = list(known)
    meant = [new for new in NAMES.get(name, ()) if new in names] or difflib.get_close_matches(name, names, 1)
    return f"; did you mean {meant[0]}?" if meant else ""


def unknown_keyword(call: str, name: str, signature: str | Iterable[str]) -> str:
    """The message for a keyword that a call does not have.

    Parameters
    ----------
    call : str
        As it is called, without parentheses.
    name : str
        The keyword that was given.
    signature : str or iterable of str
        The parameters of the call as `inspect.signature` shows them, or their names.
    """
    if isinstance(signature, str):
        found = re.findall(r"[(,]\s*(\w+)\s*(?=[=,)])", re.sub(r"\([^()]*\)(?!$)", "0", signature))
        names = [each for each in found if not each.isdigit()]
    else:
        names = list(signature)
    needed, sentence = SENTENCES.get(name, ("", ""))
    hint = f": {sentence}." if needed in names else did_you_mean(name, names) or ";"
    hint = hint if hint.endswith((".", "?", ";")) else f"{hint}."
    return f"{call}() has no {name}{hint} {'It' if hint[-1] != ';' else 'it'} takes {', '.join(names)}"


def explained(text: str, method: Callable[..., Any]) -> str | None:
    """The message for a keyword that a method of the core does not have, of its error; None for others."""
    found = re.match(r"(\S+)\(\) got an unexpected keyword argument '(\w+)'", text)
    if found is None:
        return None
    names = [name for name in inspect.signature(method).parameters if name != "self"]
    return unknown_keyword(found[1], found[2], names)


def checked(*others: Callable[..., Any], call: str = "") -> Callable[[_F], _F]:
    """Decorator of a public function: a keyword that it does not have is refused with the nearest one, and an
    argument of another type than its annotation states is named where the call fails.

    Parameters
    ----------
    others : callables
        Those that its ``**options`` go to: their keywords are its own.
    call : str, optional
        Its public name, default that of the function.
    """

    def decorate(function: _F) -> _F:
        name = call or function.__name__
        together: tuple[Callable[..., Any], ...] = (function, *others)
        signatures = {each: inspect.signature(each) for each in together}
        named = {
            parameter.name
            for signature in signatures.values()
            for parameter in signature.parameters.values()
            if parameter.kind in (parameter.POSITIONAL_OR_KEYWORD, parameter.KEYWORD_ONLY)
        }
        shown = [each for signature in signatures.values() for each in signature.parameters if each in named]
        shown = [each for each in shown if each not in ("self", "cls", "_cls")]

        # What takes any keyword says itself which it does not have.
        parameters = signatures[function].parameters.values()
        takes_any = not others and any(each.kind is each.VAR_KEYWORD for each in parameters)

        @wraps(function)
        def call_checked(*arguments: Any, **keywords: Any) -> Any:
            if not (takes_any or keywords.keys() <= named):
                wrong = next(each for each in keywords if each not in named)
                raise TypeError(unknown_keyword(name, wrong, dict.fromkeys(shown)))
            try:
                return function(*arguments, **keywords)
            except (AttributeError, TypeError, ValueError) as error:
                from six_wheel.kinematics.mistyped import mistyped

                if (message := mistyped(signatures, arguments, keywords, error)) is None:
                    raise
                raise ArgumentTypeError(message) from error

        return call_checked  # type: ignore[return-value]

    return decorate


def checked_class(kind: _C) -> _C:
    """Decorator of a public class: its constructor and its own public methods are `checked`."""
    for name, member in list(vars(kind).items()):
        inner = member.__func__ if isinstance(member, classmethod | staticmethod) else member
        makes = name in ("__init__", "__new__")
        if not inspect.isfunction(inner) or not (makes or not name.startswith("_")):
            continue
        call = kind.__name__ if makes else f"{kind.__name__}.{name}"
        wrapped = checked(call=call)(inner)
        made = wrapped if inner is member else type(member)(wrapped)
        setattr(kind, name, made)
    return kind
