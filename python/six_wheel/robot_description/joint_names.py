"""Place of a wheel from the name of its joint: front or rear, left or right.

Teams abbreviate as they like. What a name does not tell is not guessed.
"""

import re
from collections.abc import Iterable
from typing import TypeAlias

Said: TypeAlias = tuple[str | None, str | None]  # axle and side; None for one that is left out

_AXLES = {
    "front": "front forward fore fwd",
    "middle": "middle mid center centre central ctr",
    "rear": "rear back hind aft",
}
_SIDES = {"left": "left lft", "right": "right rgt rght"}
# Words that say nothing about the wheel, so that "wheelfl" and "frontleftmotor" come apart.
_OTHER = """
    wheel wheels joint jnt motor drive driver driving traction steer steering steered steerer turn rotation
    corner link hub axle servo actuator rocker bogie suspension pivot knuckle rover
"""

_AXLE_OF = {word: axle for axle, words in _AXLES.items() for word in words.split()}
_SIDE_OF = {word: side for side, words in _SIDES.items() for word in words.split()}
_AXLE_LETTERS = {"f": "front", "m": "middle", "c": "middle", "b": "rear", "r": "rear"}
_SIDE_LETTERS = {"l": "left", "r": "right"}
# An r beside an l, or beside another r, is the rear axle; beside an axle's letter it is the right side.
_PAIR_OF = {
    pair: (axle, side)
    for letter, axle in _AXLE_LETTERS.items()
    for initial, side in _SIDE_LETTERS.items()
    for pair in (letter + initial, initial + letter)
}

_WORDS = sorted([*_AXLE_OF, *_SIDE_OF, *_OTHER.split(), *_PAIR_OF], key=len, reverse=True)
_WORD = re.compile("|".join(_WORDS))
_ONLY_WORDS = re.compile(f"(?:{_WORD.pattern})+")
_CAMEL_CASE = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")


def wheel_said_by(name: str, wheels: Iterable[str], places: Iterable[str] = ()) -> str | None:
    """The one of `wheels` that `name` says; None if it does not say, or says two.

    The wheels of `places` are known besides: what says one of them exactly says none of `wheels` by halves.
    """
    wheels = tuple(wheels)
    known = (*wheels, *places)
    if name in known:
        return name
    said = said_by(name)
    if said is not None:
        same = [wheel for wheel in known if said_by(wheel) == said]
        if len(same) > 1:
            same = [wheel for wheel in same if _numbers(wheel) == _numbers(name)]
        if len(same) == 1:
            return same[0]
        agreeing = [wheel for wheel in wheels if said_by(wheel) and agree(said_by(wheel), said)]
        if not same and len(agreeing) == 1:  # "left_wheel" of a car that drives two wheels, both at the rear
            return agreeing[0]
    placeless = [wheel for wheel in known if said_by(wheel) is None]
    named = [w for w in placeless if re.search(rf"(?<![A-Za-z0-9]){re.escape(w)}(?![A-Za-z0-9])", name)]
    numbered = [wheel for wheel in placeless if _numbers(wheel) and _numbers(wheel) == _numbers(name)]
    for matching in (named, numbered):
        longest = [wheel for wheel in matching if len(wheel) == max(map(len, matching))]
        if len(longest) == 1:
            return longest[0]
    return None


def said_by(name: str) -> Said | None:
    """The place a name tells; None if it tells nothing or contradicts itself.

    Words and pairs ("fl") count first and must agree; letters only fill what they leave open ("front_l").
    """
    words = list(_words(name))
    pairs = [_PAIR_OF[word] for word in words if word in _PAIR_OF]
    axles = {_AXLE_OF[word] for word in words if word in _AXLE_OF} | {axle for axle, _ in pairs}
    sides = {_SIDE_OF[word] for word in words if word in _SIDE_OF} | {side for _, side in pairs}
    letters = [word for word in words if word in _AXLE_LETTERS or word in _SIDE_LETTERS]
    if not axles and not sides:
        return _PAIR_OF.get("".join(letters))
    if not sides:
        sides = {_SIDE_LETTERS[letter] for letter in letters if letter in _SIDE_LETTERS}
    elif not axles:
        axles = {_AXLE_LETTERS[letter] for letter in letters if letter in _AXLE_LETTERS}
    if len(axles) > 1 or len(sides) > 1:
        return None
    return next(iter(axles), None), next(iter(sides), None)


def agree(one: Said | None, other: Said | None) -> bool:
    """True if two names can mean the same place."""
    return (
        one is None
        or other is None
        or all(a in (b, None) or b is None for a, b in zip(one, other, strict=True))
    )


def _numbers(name: str) -> list[str]:
    return [number.lstrip("0") or "0" for number in re.findall(r"[0-9]+", name)]


def _words(name: str) -> Iterable[str]:
    for part in re.findall(r"[A-Za-z]+", name):
        if _ONLY_WORDS.fullmatch(part.lower()):
            yield from _WORD.findall(part.lower())
        else:
            yield from (word.lower() for word in _CAMEL_CASE.findall(part))
