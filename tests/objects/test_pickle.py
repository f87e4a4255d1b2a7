"""Every public object pickles and copies, with all that can be read of it; streams copy only."""

import copy
import inspect
import pickle

import numpy as np
import pytest

pytest.importorskip("scipy", reason="walks every public name, and calibration needs SciPy")

from tests.objects.samples import ARM, ROVER, public_classes, samples, terrain

STREAMS = ("Controller", "Odometry", "Odometry3")
# A planner keeps the rollouts of its last cycle beside its state.
LAST_CYCLE = {"Mppi": ("costs", "wishes")}


def attributes(thing: object) -> dict[str, object]:
    names = [name for name in dir(thing) if not name.startswith("_")]
    names = [name for name in names if name not in LAST_CYCLE.get(type(thing).__name__, ())]
    values = {name: getattr(thing, name) for name in names}
    return {name: value for name, value in values.items() if not callable(value)}


def assert_same(one: object, other: object, depth: int = 3) -> None:
    assert type(one) is type(other)
    if isinstance(one, np.ndarray):
        np.testing.assert_array_equal(one, other)
    elif isinstance(one, dict):
        assert list(one) == list(other)
        for name, value in one.items():
            assert_same(value, other[name], depth)
    elif isinstance(one, tuple | list):
        assert len(one) == len(other)
        for a, b in zip(one, other, strict=True):
            assert_same(a, b, depth)
    elif type(one).__module__.startswith("six_wheel") and depth > 0:
        assert repr(one) == repr(other)
        for name, value in attributes(one).items():
            assert_same(value, attributes(other)[name], depth - 1)
    elif isinstance(one, float):
        assert one == other or (one != one and other != other)


def test_a_sample_of_every_public_class_is_there():
    assert [kind.__name__ for kind in public_classes() if kind.__name__ not in samples()] == []


@pytest.mark.parametrize("name", sorted(kind.__name__ for kind in public_classes()))
def test_copies_are_the_same(name):
    one = samples()[name]
    for other in (copy.copy(one), copy.deepcopy(one)):
        assert_same(one, other)


@pytest.mark.parametrize("name", sorted(kind.__name__ for kind in public_classes()))
def test_pickles_are_the_same(name):
    one = samples()[name]
    if name in STREAMS:
        with pytest.raises(TypeError, match=f"{name} takes in samples and does not pickle: keep its `"):
            pickle.dumps(one)
        return
    for protocol in (2, pickle.HIGHEST_PROTOCOL):
        assert_same(one, pickle.loads(pickle.dumps(one, protocol)))


def test_batches_pickle_as_single_rows_do():
    poses = np.random.default_rng(0).uniform(-1.0, 1.0, (2, 5, 3))
    stand = ARM.settle(terrain(), poses, derivatives=True)
    commands = ARM.inverse(stand, np.full((2, 5, 2), 0.05))
    for one in (
        stand,
        commands,
        ARM.bounds(terrain(), poses),
        ROVER.fit(*ROVER.inverse(np.tile((0.04, 0.0, 0.02), (4, 1)))),
    ):
        assert_same(one, pickle.loads(pickle.dumps(one)))


def test_a_copied_stream_goes_on_by_itself():
    log = samples()["Simulation" if "Simulation" in samples() else "WheelLog"]
    one = samples()["Odometry"]
    other = copy.copy(one)
    before = one.state.pose
    other.update(log.steering[30], log.wheel_angles[30], log.stamps[30])
    np.testing.assert_array_equal(one.state.pose, before)
    again = copy.deepcopy(one)
    again.update(log.steering[30], log.wheel_angles[30], log.stamps[30])
    np.testing.assert_array_equal(again.state.pose, other.state.pose)


def test_parts_of_a_motion_pickle():
    motion = samples()["Preintegrated"]
    for part in motion.split((motion.begin + motion.end) / 2 + 0.013):
        assert_same(part, pickle.loads(pickle.dumps(part)))
        assert part.merge is not None


@pytest.mark.parametrize("name", ["SettledPose", "PoseBounds", "TwistFit"])
def test_a_restored_result_refuses_other_fields(name):
    kind = next(kind for kind in public_classes() if kind.__name__ == name)
    with pytest.raises(TypeError):
        kind._restore()
    assert "_restore" not in [entry for entry, _ in inspect.getmembers(kind) if not entry.startswith("_")]
