"""Leading axes go together by one rule on the ground too; what does not fit is named with its partner."""

import itertools
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import six_wheel as sw

ARM = sw.RockerBogie.preset("open_source_rover")
RANDOM = np.random.default_rng(1)
GROUND = sw.Terrain(RANDOM.uniform(0.0, 0.05, (64, 64)), 0.1)
SHAPES = [(), (1,), (3,), (2, 3), (1, 3), (2, 1)]
NAMES = ("contact_angles", "roll", "pitch", "transform", "joints", "steering", "normals", "gap")


def pose(*shape: int) -> np.ndarray:
    return np.concatenate(
        [RANDOM.uniform(2.0, 4.0, (*shape, 2)), RANDOM.uniform(-3.0, 3.0, (*shape, 1))], axis=-1
    )


def numbers(width: int) -> Callable[..., np.ndarray]:
    return lambda *shape: RANDOM.uniform(0.01, 0.05, (*shape, width) if width else shape)


def stand(*shape: int) -> sw.SettledPose:
    return ARM.settle(GROUND, pose(*shape))


def alike(*shape: int) -> SimpleNamespace:
    """An object like a settled pose."""
    settled = stand(*shape)
    return SimpleNamespace(**{name: getattr(settled, name) for name in NAMES})


CALLS: dict[str, tuple[list[Callable[..., Any]], Callable[..., Any]]] = {
    "settle": ([pose, numbers(4)], lambda poses, steering: [ARM.settle(GROUND, poses, steering).z]),
    "inverse": ([stand, numbers(2)], lambda *given: [np.asarray(ARM.inverse(*given).scale)]),
    "inverse, steering": (
        [stand, numbers(2), numbers(4)],
        lambda stands, command, steering: [ARM.inverse(stands, command, steering=steering).scale],
    ),
    "forward": ([stand, numbers(4), numbers(6)], lambda *given: [ARM.forward(*given).twist[..., 0]]),
    "forward, alike": ([alike, numbers(4), numbers(6)], lambda *given: [ARM.forward(*given).twist[..., 0]]),
    "slip": (
        [stand, numbers(6), numbers(6), numbers(3)],
        lambda *given: [ARM.slip(*given).ratio[..., 0], ARM.slip(*given).angle[..., 5]],
    ),
    "traction": (
        [numbers(0), numbers(0), numbers(3), numbers(3), numbers(3)],
        lambda *given: [ARM.traction(*given).vertical_speed],
    ),
    "bounds": (
        [pose, numbers(0)],
        lambda poses, margin: [ARM.bounds(GROUND, poses, margin).z[..., 0]],
    ),
}


def row(value: Any, shape: tuple[int, ...], common: tuple[int, ...], place: tuple[int, ...]) -> Any:
    """The row that an argument has at a place of the common axes."""
    own = place[len(common) - len(shape) :]
    index = tuple(0 if length == 1 else k for k, length in zip(own, shape, strict=True))
    if isinstance(value, sw.SettledPose):
        return ARM.settle(GROUND, value.poses[index])
    if isinstance(value, SimpleNamespace):
        return SimpleNamespace(**{name: np.asarray(part)[index] for name, part in vars(value).items()})
    return value[index]


@pytest.mark.parametrize("name", CALLS)
def test_arguments_of_any_leading_axes(name: str) -> None:
    makers, call = CALLS[name]
    for shapes in itertools.product(SHAPES, repeat=min(len(makers), 3)):
        shapes += shapes[: len(makers) - len(shapes)]
        given = [make(*shape) for make, shape in zip(makers, shapes, strict=True)]
        try:
            common = np.broadcast_shapes(*shapes)
        except ValueError:
            with pytest.raises(ValueError, match="must .*got shape .* beside "):
                call(*given)
            continue
        found = call(*given)
        place = tuple(length - 1 for length in common)
        alone = call(*(row(value, shape, common, place) for value, shape in zip(given, shapes, strict=True)))
        for batch, one in zip(found, alone, strict=True):
            assert np.shape(batch) == common, (name, shapes)
            assert np.asarray(batch)[place].tobytes() == np.asarray(one).tobytes(), (name, shapes)
