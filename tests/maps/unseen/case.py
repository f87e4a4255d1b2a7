"""The known ground of these forms, and the class of an answer about it."""

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from six_wheel.robot_description.doubts import Proposal

ROWS, COLUMNS = 21, 34
STEP = 0.4  # [m]
NODE = (431_200.2, 5_320_400.2)  # middle of the south-western cell [m]
HOLE = (slice(12, 15), slice(4, 9))  # rows from the south, columns
LEVEL = 212.0  # [m]
CLASSES = ("right", "as proposed", "helpful", "unhelpful", "silent", "traceback")


def heights(dx: float = STEP, dy: float = STEP, hole: bool = True) -> Any:
    """Heights of the ground at nodes, rows northwards [m]."""
    u, v = np.meshgrid(np.arange(COLUMNS) / COLUMNS, np.arange(ROWS) / ROWS)
    made = LEVEL + 3.0 * u - 1.3 * v + 0.5 * np.sin(7.0 * u + 2.0 * v) + 0.8 * np.exp(-40 * (u - 0.7) ** 2)
    if hole:
        made[HOLE] = np.nan
    return made


@dataclass(frozen=True)
class Case:
    """A form of the ground."""

    name: str
    make: Callable[[Path], Callable[..., sw.Terrain]]
    """Writes the form into a folder; reads it with options."""
    truth: Mapping[str, Any] = field(default_factory=dict)
    """Answers that the owner of the form has, by option."""
    remedy: str = ""
    """Words of which a refusal has one, of a form without a place of heights or an option for it."""
    node: tuple[float, float] = NODE
    steps: tuple[float, float] = (STEP, STEP)
    yaw: float = 0.0
    hole: bool = True
    close: float = 3e-3
    """Step to which the form rounds heights [m]."""

    @property
    def knowable(self) -> bool:
        """True if the form and its owner's answers say where the heights are."""
        return not self.remedy


def is_right(ground: sw.Terrain, case: Case) -> bool:
    """True if heights, hole and extent of a ground are the known ones."""
    (dx, dy), node = case.steps, case.node
    cos, sin = np.cos(case.yaw), np.sin(case.yaw)

    def at(columns: Any, rows: Any) -> Any:
        u, v = columns * dx, rows * dy
        return ground.height_at(np.stack((node[0] + cos * u - sin * v, node[1] + sin * u + cos * v), -1))

    columns, rows = np.meshgrid(np.arange(COLUMNS, dtype=float), np.arange(ROWS, dtype=float))
    inwards = 1e-4
    columns += np.where(columns < COLUMNS / 2, inwards, -inwards)
    rows += np.where(rows < ROWS / 2, inwards, -inwards)
    told, known = at(columns, rows), heights(hole=case.hole)
    beside = ~np.isnan(known)
    for shift in np.ndindex(3, 3):
        beside &= np.roll(~np.isnan(known), np.subtract(shift, 1), (0, 1))
    beside[[0, -1]] = beside[:, [0, -1]] = False
    corners = ~np.isnan(at(columns, rows)[[0, 0, -1, -1], [0, -1, 0, -1]])
    off = np.array([at(-0.6, 5.0), at(COLUMNS - 0.4, 5.0), at(5.0, -0.6), at(5.0, ROWS - 0.4)])
    if not corners.all() or not np.isnan(off).all():
        return False
    if case.hole and not np.isnan(told[HOLE]).all():
        return False
    return bool((np.abs(told - known)[beside] < case.close + 2e-3).all())


def classify(case: Case, folder: Path) -> tuple[str, str]:
    """The class of a form, and the words that came of it."""
    read = case.make(folder)
    given = dict[str, Any]()
    words = ""
    for _ in range(8):
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                ground = read(**given)
        except (ValueError, OSError, ImportError) as error:
            words = str(error)
            proposed = [part for part in getattr(error, "parts", ()) if isinstance(part, Proposal)]
            asked = " ".join(part.argument for part in proposed) or words
            answers = _answers(asked, case, given)
            if not answers:
                return _helpful(case, words), words
            given |= answers
            continue
        except Exception as error:
            return "traceback", f"{type(error).__name__}: {error}"
        if is_right(ground, case):
            return ("as proposed" if given else "right"), words
        words = " ".join(str(warning.message) for warning in caught)
        answers = _answers(words, case, given)
        if not answers:
            return (_helpful(case, words) if words else "silent"), words or repr(ground)
        given |= answers
    return "unhelpful", words


def _answers(words: str, case: Case, given: Mapping[str, Any]) -> dict[str, Any]:
    """The owner's answers to options that are proposed."""
    return {name: value for name, value in case.truth.items() if f"{name}=" in words and name not in given}


def _helpful(case: Case, words: str) -> str:
    one_line = words and "\n" not in words and len(words) < 600
    helps = any(word in words for word in case.remedy.split("|")) if case.remedy else False
    return "helpful" if one_line and helps else "unhelpful"
