"""Single calls with arguments that cannot be."""

import inspect
import math
import pickle
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from tests.core.oracles.fast_calls import QUICK, ROVER, TWIST, outputs

MISUSE: list[tuple[str, tuple[Any, ...], dict[str, Any]]] = [
    ("inverse", (), {}),
    ("inverse", (TWIST, None), {}),
    ("inverse", (TWIST,), {"twist": TWIST}),
    ("inverse", (TWIST,), {"outs": None}),
    ("inverse", (TWIST,), {"": None}),
    ("forward", (), {}),
    ("forward", ([0.0] * 4,), {}),
    ("forward", ([0.0] * 4, [1.0] * 6, np.empty(3)), {}),
    ("forward", ([0.0] * 4, [1.0] * 6), {"steering": None}),
    ("forward", ([0.0] * 4,), {"out": np.empty(3)}),
    ("project", (), {"keep": "curvature"}),
    ("project", (TWIST, "nothing"), {}),
    ("project", (TWIST, "speed", None), {}),
    ("admissible", (), {}),
    ("admissible", (TWIST, 1), {}),
    ("admissible", (TWIST,), {"twist": TWIST}),
]


@pytest.mark.parametrize(("method", "arguments", "keywords"), MISUSE)
def test_misuse_is_answered_as_by_any_method(method, arguments, keywords):
    with pytest.raises((TypeError, ValueError)) as raised:
        getattr(ROVER, method)(*arguments, **keywords)
    if raised.type is TypeError:
        assert str(raised.value).startswith(f"Rover.{method}() ")


def test_every_way_of_naming_arguments():
    expected = [array.tolist() for array in ROVER.inverse(TWIST)]
    out = outputs(ROVER)
    made_up = {"".join(["t", "wist"]): TWIST}  # a string that is equal to the name, and not the same
    for call in (
        lambda: ROVER.inverse(twist=TWIST),
        lambda: ROVER.inverse(**made_up),
        lambda: ROVER.inverse(out=out, twist=TWIST),
        lambda: ROVER.inverse(TWIST, out=None, previous=None, centre=None),
        lambda: sw.Rover.inverse(ROVER, TWIST),
    ):
        assert [array.tolist() for array in call()] == expected
    twist = ROVER.forward(*out).tolist()
    assert ROVER.forward(wheel_speeds=out[1], steering=out[0]).tolist() == twist
    assert ROVER.forward(out[0], wheel_speeds=out[1], out=None).tolist() == twist
    with pytest.raises(TypeError, match="doesn't apply to a 'int' object"):
        sw.Rover.inverse(3, TWIST)


@pytest.mark.parametrize("name", QUICK)
def test_the_method_in_front_looks_like_the_one_behind(name):
    method = getattr(sw.Rover, name)
    assert list(inspect.signature(method).parameters)[:2] in (["self", "twist"], ["self", "steering"])
    assert inspect.getdoc(method).count("Parameters\n----------") == 1
    assert method.__qualname__ == f"Rover.{name}"
    bound = pickle.loads(pickle.dumps(getattr(ROVER, name)))
    assert (bound.__self__, bound.__name__) == (ROVER, name)


def test_failures_write_nothing():
    for bad in ((0.0, 1.0, 0.0), (math.nan, 0.0, 0.0), (1e308, 0.0, 1e308)):
        out = outputs(ROVER)
        with pytest.raises(ValueError, match="^twist must"):
            ROVER.inverse(bad, out=out)
        assert all((array == 7.0).all() for array in out)
    for bad in (math.nan, math.inf):
        out = outputs(ROVER)
        with pytest.raises(ValueError, match="^previous must be finite"):
            ROVER.inverse(TWIST, previous=np.array([0.0, bad, 0.0, 0.0]), out=out)
        assert all((array == 7.0).all() for array in out)
        target = np.full(3, 7.0)
        with pytest.raises(ValueError, match="^wheel_speeds must be finite"):
            ROVER.forward(np.zeros(4), np.array([1.0, bad, 1, 1, 1, 1]), out=target)
        assert (target == 7.0).all()
