"""The known ground, and the class of an answer about it."""

import re
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import six_wheel as sw

ROWS, COLUMNS, CELL = 24, 30, 0.5
HOLE = (slice(5, 8), slice(20, 24))  # rows from the south, columns
PLACE = (500_000.0, 4_000_000.0)  # of the south-western corner [m]
CLASSES = ("right", "as proposed", "helpful", "unhelpful", "silent", "traceback")


def height(x: Any, y: Any) -> Any:
    """Height of the ground at a place from its south-western corner: a ramp, waves, two boxes [m]."""
    waves = 12.0 + 0.08 * x - 0.05 * y + 0.3 * np.sin(0.7 * x) + 0.2 * np.cos(0.5 * y)
    first = (abs(x - 4.0) < 1.1) & (abs(y - 9.0) < 0.9)
    return waves + 0.6 * first + 0.3 * ((abs(x - 10.0) < 0.8) & (abs(y - 2.0) < 1.1))


def middles() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """x and y of the middles of the cells from the south-western corner [m]."""
    return np.meshgrid(CELL * (np.arange(COLUMNS) + 0.5), CELL * (np.arange(ROWS) + 0.5))


def grid(fill: float | None = np.nan) -> NDArray[np.float64]:
    """Heights, rows to the north; the hole filled with this, or none."""
    heights: NDArray[np.float64] = height(*middles())
    if fill is not None:
        heights[HOLE] = fill
    return heights


@dataclass(frozen=True)
class Form:
    """One form of the ground."""

    group: str
    name: str
    make: Callable[[Path], Callable[..., sw.Terrain]]
    """Writes the form into a folder; reads it with these options."""
    answer: Mapping[str, Any] = field(default_factory=dict)
    """True answers to the questions that a refusal may ask."""
    help: str = ""
    """Words of a refusal from which its reader knows how to go on, where no option settles it."""
    place: tuple[float, float] | None = PLACE
    """South-western corner [m]."""
    hole: bool = True
    close: float = 2e-3
    """Step to which the form itself rounds heights [m]."""
    knowable: bool = True
    """True if the file and one option say where the heights are."""
    turn: float = 0.0


def is_right(ground: sw.Terrain, form: Form) -> bool:
    """True if the ground is the known one: heights, hole, extent."""
    u, v = middles()
    x0, y0 = form.place or (-CELL / 2, -CELL / 2)
    cos, sin = np.cos(form.turn), np.sin(form.turn)
    known = ~np.isnan(grid()) if form.hole else np.ones(u.shape, bool)
    inner = np.zeros(u.shape, bool)
    inner[1:-1, 1:-1] = True
    shift = 1e-3 * CELL  # inside a cell whose corners decide, away from its edges
    x, y = u + np.where(u < u.mean(), shift, -shift), v + np.where(v < v.mean(), shift, -shift)
    told = ground.height_at(np.stack((x0 + cos * x - sin * y, y0 + sin * x + cos * y), -1))
    if ground.shape[0] * ground.shape[1] != ROWS * COLUMNS:
        return False
    steep = 4e-3  # of a wall beside a place moved by a thousandth of a cell
    if form.hole and not np.isnan(told[HOLE]).all():
        return False
    beside = np.array(known)
    for steps in np.ndindex(3, 3):
        beside &= np.roll(known, np.subtract(steps, 1), (0, 1))
    where = beside & inner
    return bool(np.all(np.abs(told - grid(None))[where] < form.close + steep))


def classify(form: Form, folder: Path) -> tuple[str, str]:
    """The class of a form and the words that came of it."""
    read = form.make(folder)
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            ground = read()
    except (ValueError, OSError, ImportError) as error:
        return _refused(form, read, str(error)), str(error)
    except Exception as error:
        return "traceback", f"{type(error).__name__}: {error}"
    words = " ".join(str(warning.message) for warning in caught)
    if is_right(ground, form):
        return "right", words
    if words:
        return _refused(form, read, words), words
    return "silent", ""


def _refused(form: Form, read: Callable[..., sw.Terrain], words: str) -> str:
    """Answers question after question, as long as a refusal asks one that is not answered."""
    given = dict[str, Any]()
    while asked := [key for key in form.answer if key not in given and re.search(rf"\b{key}=", words)]:
        given |= {key: form.answer[key] for key in asked}
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                ground = read(**given)
        except (ValueError, OSError) as error:
            words = str(error)
            continue
        except Exception:
            return "traceback"
        if is_right(ground, form):
            return "as proposed"
        words = " ".join(str(warning.message) for warning in caught)
        if not words:
            return "silent"
    one_line = "\n" not in words
    return "helpful" if form.help and one_line and re.search(form.help, words) else "unhelpful"
