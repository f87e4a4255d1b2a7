"""Objects from two threads: each call is made whole, or a `RuntimeError` says that the object is in use.

Every call of every public class, on one object: what it answers, and what it refuses, is the same as alone.
"""

import threading
import warnings
from collections.abc import Callable

import pytest

# One of the samples is a calibration, which needs SciPy.
pytest.importorskip("scipy")
calls = pytest.importorskip("tests.objects.calls").calls
samples = pytest.importorskip("tests.objects.samples").samples
WORDS = pytest.importorskip("tests.core.door.test_in_use").WORDS

ROUNDS = 10
# Whatever a call refuses because of its place in time, or of its arguments.
REFUSED = (ValueError, TypeError, MemoryError, NotImplementedError)


def of_class(name: str) -> dict[str, Callable[[], object]]:
    """Calls and attributes of a sample, all on the same object."""
    one = samples()[name]
    found: dict[str, Callable[[], object]] = {}
    for call in calls():
        kind, _, part = call.name.partition(".")
        if kind == name and part and getattr(call.function, "__self__", None) is one:
            given = [call.arguments[each] for each in call.positional]
            rest = {key: value for key, value in call.arguments.items() if key not in call.positional}
            found[part] = lambda part=part, given=given, rest=rest: getattr(one, part)(*given, **rest)
    for part in dir(one):
        if not part.startswith("_") and part not in found and not callable(getattr(one, part)):
            found[part] = lambda part=part: getattr(one, part)
    return found | {"repr": lambda: repr(one)}


@pytest.mark.parametrize("name", samples())
def test_every_call_from_two_threads_is_whole_or_says_that_the_object_is_in_use(name: str) -> None:
    asked = list(of_class(name).items())
    odd: set[str] = set()
    start = threading.Barrier(2)

    def work(order: int) -> None:
        start.wait()
        for _ in range(ROUNDS):
            for part, call in asked[::order]:
                try:
                    call()
                except REFUSED:
                    continue
                except RuntimeError as error:
                    if str(error) != WORDS:
                        odd.add(f"{part}: {error}")
                except BaseException as error:  # a panic is no Exception
                    odd.add(f"{part}: {type(error).__name__}: {error}")

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        threads = [threading.Thread(target=work, args=(order,)) for order in (1, -1)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert odd == set()
