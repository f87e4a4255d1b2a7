"""Values that users make refuse what is no such number or array, by the name of the argument, in one line.

``sw.Twist("a")`` and ``sw.Pose(None, 0, 0)`` were made, and failed in a later call that named something else.
"""

import dataclasses
import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

pytest.importorskip("scipy", reason="walks every public name, and calibration needs SciPy")

import six_wheel as sw
from tests.objects.samples import samples

NUMBERS = ("Twist", "Pose", "FeasibilityLimits")
COLUMNS = ("Track", "Track3", "GroundTruth", "FourAxleState", "FourAxleStep")
# Fields whose values are checked where they are used, or may be anything that has a text.
ANYTHING = {"action", "rover", "suspension", "noise", "max_gap", "duration"}


def fields(name: str) -> list[str]:
    kind: Any = type(samples()[name])
    if hasattr(kind, "_fields"):
        return list(kind._fields)
    return [each.name for each in dataclasses.fields(kind) if each.init and each.name not in ANYTHING]


@pytest.mark.parametrize("wrong", ["a", None, object, [0.1, 0.2], {"x": 1}, True], ids=str)
@pytest.mark.parametrize(("name", "field"), [(name, field) for name in NUMBERS for field in fields(name)])
def test_what_is_no_number_is_refused(name: str, field: str, wrong: Any) -> None:
    with pytest.raises(TypeError, match=rf"^{field} must be a number, got ") as caught:
        type(samples()[name])(**{field: wrong})
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("wrong", ["a", object, 3])
@pytest.mark.parametrize(("name", "field"), [(name, field) for name in COLUMNS for field in fields(name)])
def test_what_is_no_such_column_is_refused(name: str, field: str, wrong: Any) -> None:
    with pytest.raises(ValueError, match=rf"^{field} (must|are|is)\b") as caught:
        dataclasses.replace(samples()[name], **{field: wrong})
    assert "\n" not in str(caught.value)


def test_rows_of_a_track_agree() -> None:
    track = samples()["Track"]
    with pytest.raises(
        ValueError, match=rf"^poses must be an array of shape \(n, 3\), n = {len(track)}, got"
    ):
        dataclasses.replace(track, poses=track.poses[:-1])
    with pytest.raises(ValueError, match=r"^twists must be an array of shape \(n, 3\)"):
        dataclasses.replace(track, twists=track.twists[:, :2])
    assert len(dataclasses.replace(track, covariances=None, residuals=None, weights=None)) == len(track)


def test_three_numbers_in_one_are_told_apart() -> None:
    with pytest.raises(ValueError, match=r"Twist\(\*values\) takes 3 numbers of a sequence"):
        sw.Twist((0.1, 0.0, 0.2))  # type: ignore[arg-type]


def test_numbers_of_any_kind_are_taken() -> None:
    kinds = (1, 1.0, np.float32(1.0), np.int8(1), np.array(1.0), Fraction(1, 1))
    assert all(sw.Twist(one, 0.0, one) == (1.0, 0.0, 1.0) for one in kinds)  # type: ignore[arg-type]
    assert math.isnan(sw.Pose(math.nan).x)
