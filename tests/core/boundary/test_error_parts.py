"""Errors of the core have the parts of their text as attributes, so that nobody parses the text."""

import copy
import pickle
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import six_wheel as sw
from tests.rovers import SIX_WHEELS

CAR = sw.Rover.ackermann(0.8, 0.5, 0.1)
ODOMETRY = sw.Odometry(SIX_WHEELS)
WRONG: dict[str, tuple[Callable[[], object], str, str, tuple[int, ...]]] = {
    "a value": (lambda: sw.Wheel("a", 0, 0, radius=-1), "radius", "", ()),
    "a type": (lambda: sw.Wheel("a", 0, 0, radius="x"), "radius", "", ()),
    "a dtype": (lambda: CAR.inverse("a"), "twist", "", ()),
    "a class": (lambda: sw.Odometry("husky"), "rover", "", ()),
    "a shape": (lambda: SIX_WHEELS.forward([0] * 3, [0] * 6), "steering", "", ()),
    "a row": (lambda: CAR.inverse([(1, 0, 0), (np.nan, 0, 0)]), "twist", "[1]", (1,)),
    "a row of two axes": (lambda: CAR.inverse([[(1, 0, 0), (np.nan, 0, 0)]]), "twist", "[0, 1]", (0, 1)),
    "a place": (lambda: sw.Terrain([[0, 1], [np.inf, 2]], 1.0), "heights", "[1, 0]", ()),
    "a motion": (lambda: CAR.inverse((0, 1, 0)), "twist", "", ()),
    "a motion of a row": (lambda: CAR.inverse([(1, 0, 0), (0, 1, 0)]), "twist", "[1]", (1,)),
    "readings": (lambda: ODOMETRY.update([0] * 4, [np.nan] * 6, 0.0), "wheel_angles", "", ()),
    "arguments together": (lambda: sw.RockerBogie(wheel_radius=0.1), "rocker_pivot", "", ()),
}


@pytest.mark.parametrize(("call", "argument", "place", "row"), WRONG.values(), ids=WRONG)
def test_errors_have_their_parts(
    call: Callable[[], object], argument: str, place: str, row: tuple[int, ...]
) -> None:
    """Readers of parameter files and logs parsed texts of errors for the argument and the row."""
    with pytest.raises((ValueError, TypeError)) as caught:
        call()
    for error in (caught.value, copy.copy(caught.value), pickle.loads(pickle.dumps(caught.value))):
        assert type(error) is type(caught.value)
        assert error.argument == argument
        assert error.row == row
        if argument != "rocker_pivot":  # several are missing there
            assert error.place == place
        assert error.problem.startswith("must ")
        assert str(error) == f"{argument}{error.place} {error.problem}"


def test_no_reader_parses_the_text_of_an_error() -> None:
    """Texts are for people: a dispatch on them breaks where a word of them is changed."""
    parsing = re.compile(
        r"re\.\w+\([^()]*str\((?:\w*error|refused|refusal)\)"
        r"|str\((?:\w*error|refused|refusal)\)\.(?:r?partition|startswith|endswith|find|split\([^)])"
        r"|in str\((?:\w*error|refused|refusal)\)"
    )
    package = Path(sw.__file__).resolve().parent  # `make quick` puts the package together from links
    files = [path for path in package.rglob("*.py") if "_core" not in path.name]
    found = [
        f"{path}: {line}" for path in files for line in path.read_text().splitlines() if parsing.search(line)
    ]
    assert len(files) > 100
    assert found == []
