"""Doubts about a map: the words of each, with the options that settle it."""

import json
import math
import shlex
from collections.abc import Iterable, Sequence
from typing import Any

from six_wheel.robot_description.doubts import Proposal

Words = tuple[str | Proposal, ...]


def answer(name: str, value: Any) -> Proposal:
    """An option of `Terrain.read` with its value."""
    option = f"--{name.replace('_', '-')}"
    if isinstance(value, bool):
        return Proposal(f"{name}: {str(value).lower()}", option if value else "--south-up", f"{name}={value}")
    if isinstance(value, tuple):
        numbers = [f"{part:.12g}" for part in value]
        joined = ", ".join(numbers)
        return Proposal(f"{name}: [{joined}]", f"{option} {','.join(numbers)}", f"{name}=({joined})")
    if isinstance(value, float) and math.isnan(value):
        return Proposal(f"{name}: .nan", f"{option} nan", f'{name}=float("nan")')
    if isinstance(value, (int, float)):
        number = f"{value:.9g}"
        return Proposal(f"{name}: {number}", f"{option} {number}", f"{name}={number}")
    quoted = json.dumps(value, ensure_ascii=False)
    key = value if value.isidentifier() and value.lower() not in YAML_WORDS else quoted
    return Proposal(f"{name}: {key}", f"{option} {shlex.quote(value)}", f"{name}={quoted}")


YAML_WORDS = ("y", "n", "yes", "no", "on", "off", "true", "false", "null")  # that are no text there


def named(names: Iterable[str]) -> Words:
    """Names of options, with commas between them."""
    words: list[str | Proposal] = []
    for name in names:
        words += [", ", Proposal(name, f"--{name.replace('_', '-')}", name)]
    return tuple(words[1:])


def listed(names: Sequence[object], most: int = 8) -> str:
    """Names with commas between them, the first few of many."""
    shown = ", ".join(map(str, names[:most]))
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"


def flagged_heights(count: int, value: float, place: tuple[int, int]) -> Words:
    """Heights that look like a mark of unknown ones."""
    settled = answer("nodata", value), " if they are unknown, ", answer("nodata", math.nan), " if not"
    return (f"{_counted(count, value, place)}: ", *settled)


def all_marked(count: int, value: float) -> Words:
    """One number that is a mark of unknown heights, and no other."""
    told = f"no height is known, all {count} numbers are {value:.9g}, below or above any ground: "
    return told, answer("nodata", math.nan), " if they are heights"


def another_mark(count: int, value: float, place: tuple[int, int], known: tuple[float, ...]) -> Words:
    """Heights that look like a mark beside those that were given."""
    told = ", ".join(f"{mark:g}" for mark in known)
    both = answer("nodata", (*known, value))
    return (f"{_counted(count, value, place)}, beside the mark {told}: ", both, " if they are unknown too")


def _counted(count: int, value: float, place: tuple[int, int]) -> str:
    subject = f"{count} heights are" if count > 1 else "1 height is"
    return f"{subject} {value:.9g}, the first at row {place[0]}, column {place[1]}"


def _units(*units: str) -> Words:
    """Units of heights to choose from, metres at last."""
    words: list[str | Proposal] = []
    for unit in units:
        words += [", ", answer("unit", unit)]
    if len(units) > 1:
        words[-2] = " or "
    return (*words[1:], " if they are, ", answer("unit", "m"), " if not")


def steep_heights(degrees: float, units: Sequence[str]) -> Words:
    """Slopes of cliffs nearly everywhere: heights in a smaller unit than metres."""
    told = f"half the slopes are above {degrees:.0f} degrees, heights not in metres? "
    return (told, *_units(*units))


def whole_heights(cell: float) -> Words:
    """Whole numbers on cells that are too fine for whole metres."""
    told = f"heights are whole numbers on cells of {cell:g} m, not metres? "
    return (told, *_units("cm", "mm", "ft"))


def named_unit(name: str, unit: str) -> Words:
    """A file or band that is called by a unit, and says none."""
    return f"has no unit, and {name} is called by one: ", *_units(unit)


def cells_of_bits() -> Words:
    """Cells of 8 bits without a unit."""
    settled = "cells of 8 bits without a unit (", answer("unit", "m"), " takes them as metres)"
    return ("is a picture, not heights: ", *settled)


def picture_bands(count: int) -> Words:
    """Colours of a picture."""
    return f"is a picture, not heights: {count} bands of 8 bits (", answer("band", 1), " takes one)"


def counts_without_unit() -> Words:
    """Counts of a picture of 16 bits."""
    return (
        "has no unit: ",
        answer("unit", "mm"),
        ", or the height of one count in metres, ",
        answer("unit", 0.01),
    )


def unknown_unit(unit: str) -> Words:
    """A unit by a name that is not known."""
    return f"has heights in {unit!r}: ", answer("unit", "m"), ", or its length in metres"


def two_units(unit: str, other: float) -> Words:
    """A unit of the band against another one of the vertical system."""
    told = f"has heights in {unit} by its band, in units of {other:g} m by its vertical system: "
    return told, answer("unit", unit), " or ", answer("unit", other)


def no_place(subject: str = "has no place (no transform)", north_up: bool = True) -> Words:
    """Rows and columns alone; `north_up` as the form has it."""
    end = "southern" if north_up else "northern"
    return (
        f"{subject}: ",
        answer("spacing", 0.1),
        ", the size of its cells in metres, ",
        answer("origin", (0, 0)),
        ", the middle of its south-western cell, if it matters, and ",
        answer("north_up", not north_up),
        f" if its first row is the {end} one",
    )


def own_place(options: Any) -> Words:
    """Options of a map without a place, given for one that has its own."""
    given = [name for name in ("spacing", "origin", "north_up") if getattr(options, name) is not None]
    return "has a place of its own: leave ", *named(given), " out"


def no_spacing() -> Words:
    """An array without coordinates."""
    return (
        "spacing must be given where heights have no coordinates: ",
        answer("spacing", 0.1),
        ", between cells in metres",
    )


def no_corners() -> Words:
    """An ESRI grid that does not say where it is."""
    origin = answer("origin", (0, 0))
    return "has no xllcorner and yllcorner: ", origin, ", the middle of its south-western cell"


def several(kinds: str, names: Sequence[str], option: str, choice: int | str) -> Words:
    """Bands, variables, layers or topics of which any may hold the heights."""
    proposed = answer(option, choice)
    return f"has several {kinds}, {listed(names)}: ", proposed, ", or whichever has the heights"


def band_by_name(kind: str, name: str, option: str, choice: int | str) -> Words:
    """One band or layer, whose name is no word for heights."""
    return f"has one {kind}, {name}, no heights (", answer(option, choice), " takes it)"


def no_name_of_that(kind: str, wanted: object, names: Sequence[str], option: str, choice: int | str) -> Words:
    """A band, variable, layer or topic that is not there."""
    return f"has no {kind} {wanted}, it has {listed(names)}: ", answer(option, choice)
