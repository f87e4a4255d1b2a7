"""Objects with a state say in the same words that they are in use, whichever class and whichever call."""

import copy
import signal
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

pytest.importorskip("scipy", reason="walks every public name, and calibration needs SciPy")

import six_wheel as sw
from tests.core.door.long_calls import readings
from tests.objects.calls import Call, calls
from tests.objects.samples import ARM, LIMITS, ROVER, TWIST, samples, terrain

WORDS = (
    "a call of this object is at work in this thread: the handler of a signal or the code of an argument "
    "cannot use it"
)
# A call of each class that takes a second or more; others wait for it, and code within it cannot.
LONG: dict[str, Callable[[], tuple[Any, Callable[[], object]]]] = {}


def long(kind: str) -> Callable[[Any], Any]:
    def add(make: Any) -> Any:
        LONG[kind] = make
        return make

    return add


@long("Odometry")
def _odometry() -> tuple[Any, Callable[[], object]]:
    one = sw.Odometry(ROVER)
    return one, partial(one.run, *readings(3_000_000))


@long("Odometry3")
def _in_space() -> tuple[Any, Callable[[], object]]:
    one = sw.Odometry3(ARM, ground=terrain())
    steering, speeds = ARM.planar().inverse((0.001, 0.0, 0.0))
    stamps = 0.01 * np.arange(100_000)
    return one, partial(one.run, np.tile(steering, (len(stamps), 1)), stamps[:, None] * speeds, stamps)


@long("Controller")
def _controller() -> tuple[Any, Callable[[], object]]:
    one = sw.Controller(ROVER, LIMITS)
    return one, partial(one.run, [TWIST], [0.0], 0.02 * np.arange(1, 3_000_000))


@long("Mppi")
def _planner() -> tuple[Any, Callable[[], object]]:
    one = sw.Mppi(ROVER, LIMITS, horizon=200, samples=200_000)
    return one, partial(one.step, (0.0, 0.0, 0.0), goal=(2.0, 0.5, 1.0))


@long("Preintegrated")
def _motion() -> tuple[Any, Callable[[], object]]:
    one = sw.Preintegrated(ROVER)
    return one, partial(one.add, *readings(2_000_000))


def seen(one: Any) -> dict[str, str]:
    """The public attributes of an object, as text."""
    names = [name for name in dir(one) if not name.startswith("_")]
    return {name: repr(value) for name in names if not callable(value := getattr(one, name))}


def changes(call: Call) -> bool:
    """True if a call changes its object, of which it gets a copy."""
    one = getattr(call.function, "__self__", None)
    if type(one).__name__ not in samples():
        return False
    mine = copy.copy(one)
    before = seen(mine)
    given = dict(call.arguments)
    first = [given.pop(name) for name in call.positional]
    try:
        getattr(mine, call.name.rpartition(".")[2])(*first, **given)
    except (ValueError, TypeError):
        return False
    return seen(mine) != before


@pytest.fixture(autouse=True, scope="module")
def fresh_samples() -> None:
    """Walks of all calls change the objects: these are others."""
    samples.cache_clear()


@pytest.mark.filterwarnings("ignore")
def test_every_class_with_a_state_is_known() -> None:
    assert {call.name.partition(".")[0] for call in calls() if changes(call)} == LONG.keys()


@pytest.mark.slow
@pytest.mark.parametrize("kind", LONG)
@pytest.mark.filterwarnings("ignore")
def test_all_classes_say_it_in_the_same_words(kind: str) -> None:
    one, work = LONG[kind]()
    said: list[str] = []
    mine = [call for call in calls() if call.name.startswith(f"{kind}.") and changes(call)]
    assert mine

    def handle(*_: object) -> None:
        for call in mine:
            given = dict(call.arguments)
            first = [given.pop(name) for name in call.positional]
            try:
                getattr(one, call.name.rpartition(".")[2])(*first, **given)
            except RuntimeError as error:
                said.append(str(error))
            except ValueError as error:
                said.append(f"{call.name}: {error}")
            else:
                said.append(f"{call.name} was made")

    before = signal.signal(signal.SIGALRM, handle)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        work()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert said == [WORDS] * len(mine)
