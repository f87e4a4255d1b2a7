"""Representations fit one line, or can be pasted back; text is short; members of enumerations have theirs."""

import enum
import inspect
import pickle

import pytest

pytest.importorskip("scipy", reason="walks every public name, and calibration needs SciPy")

import six_wheel as sw
from six_wheel import profiles
from tests.objects.samples import public_classes, samples

# Values whose representation is the call that makes them, whatever its length.
CALLS = {
    "BodyTransition",
    "Controller",
    "FeasibilityLimits",
    "FourAxleStep",
    "IcrTransition",
    "Limits",
    "ModuleTransition",
    "Profile",
    "RockerBogie",
    "Rover",
    "Suspension",
    "Wheel",
}


# Every preset, as the Rover or as its suspension.
PRESETS = [
    *((sw.Rover.preset(name), f"Rover.preset('{name}')") for name in sw.Rover.presets()),
    *((sw.RockerBogie.preset(name), f"RockerBogie.preset('{name}')") for name in sw.RockerBogie.presets()),
]


@pytest.mark.parametrize(("one", "call"), PRESETS)
def test_a_preset_is_told_by_its_name(one, call):
    assert repr(one) == call
    assert eval(repr(one), vars(sw)) == one


def test_a_preset_is_told_with_its_steering_limit():
    rover = sw.Rover.preset("perseverance", steering_limit=0.5)
    assert repr(rover) == "Rover.preset('perseverance', steering_limit=0.5)"
    assert eval(repr(rover), vars(sw)) == rover


@pytest.mark.parametrize("name", sorted(kind.__name__ for kind in public_classes()))
def test_representations_fit_one_line(name):
    one = samples()[name]
    assert "\n" not in repr(one)
    assert len(repr(one)) <= 120 or name in CALLS
    assert len(str(one).splitlines()) <= 6
    assert repr(one).startswith((name, "<", "profiles.", f"{name}.", "Suspension."))


def test_members_of_enumerations_have_their_meaning():
    kinds = [kind for kind in vars(sw).values() if inspect.isclass(kind) and issubclass(kind, enum.Enum)]
    kinds += [sw.Reason, sw.OdometryHealth, sw.SettleStatus, sw.BoundsStatus, sw.FeasibilityReason]
    for kind in set(kinds):
        for member in kind:
            assert member.__doc__ == member.help != "", f"{kind.__name__}.{member.name}"
            assert member.help != kind.__doc__
        assert str(kind).splitlines() == [f"{member.name}: {member.help}" for member in kind]
        assert pickle.loads(pickle.dumps(list(kind))) == list(kind)


def test_no_reason_is_none():
    assert str(sw.Reason(0)) == "none"
    assert sw.Reason.SPEED.__doc__ == sw.Reason.SPEED.help


@pytest.mark.parametrize("name", ["RolloutCost", "State", "TransitionState"])
def test_results_of_arrays_compare_and_stay_short(name):
    """`==` of two of them raised "the truth value of an array is ambiguous"."""
    one = samples()[name]
    same = pickle.loads(pickle.dumps(one))
    assert same == one
    assert (same != one) is False
    assert one != one._replace(**{one._fields[0]: one[0] + 1.0})
    assert one != 3
    many = profiles.trapezoid([0, 0], [1.0, 2.0], 2.0).at([0.1, 0.2])
    assert repr(many) == "State(value=<2 x 2>, velocity=<2 x 2>, acceleration=<2 x 2>, jerk=<2 x 2>)"
