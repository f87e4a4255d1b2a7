"""Profiles against Ruckig, as values, and with arguments that make no sense."""

import math
import os
import pickle
import time

import numpy as np
import pytest

import six_wheel as sw
from six_wheel import profiles
from tests.core.control.profile_cases import cuts

SOAK = int(os.environ.get("SOAK", "1"))
CASES = 4_000 * SOAK
ruckig_limits = ["velocity", "acceleration", "jerk"]


def random_case(rng: np.random.Generator) -> tuple[dict, dict]:
    """Ends and limits of one to three axes, resting and moving, bounded in jerk or not."""
    axes = rng.integers(1, 4)
    velocity, acceleration, jerk = np.exp(rng.normal(scale=1.2, size=(3, axes)))
    if rng.random() < 0.2:
        jerk[:] = np.inf
    if rng.random() < 0.1:
        velocity[:] = np.inf

    def moving(limit: np.ndarray, share: float) -> np.ndarray:
        limit = np.where(np.isinf(limit), 1.0, limit)
        still = rng.random(axes) < rng.choice([0.0, 0.5, 1.0])
        return np.where(still, 0.0, rng.uniform(-share, share, axes) * limit)

    limits = {"velocity": velocity, "acceleration": acceleration, "jerk": jerk}
    if rng.random() < 0.3:
        limits["min_velocity"] = -velocity * rng.uniform(0.7, 1.5, axes)
        limits["min_acceleration"] = -acceleration * rng.uniform(0.7, 1.5, axes)
    ends = {
        "start": rng.normal(scale=3.0, size=axes),
        "end": rng.normal(scale=3.0, size=axes),
        "start_velocity": moving(velocity, 1.0),
        "end_velocity": moving(velocity, 0.65),
        "start_acceleration": moving(acceleration, 1.0),
        "end_acceleration": moving(acceleration, 0.65),
    }
    return ends, limits


def test_the_published_ruckig_takes_as_long():
    ruckig = pytest.importorskip("ruckig", reason="pip install ruckig: the oracle of time-optimal profiles")
    rng = np.random.default_rng(20210715)
    kinds = {
        "time": ruckig.Synchronization.Time,
        "phase": ruckig.Synchronization.Phase,
        "none": ruckig.Synchronization.No,
    }
    worst, solved, alike, refused, seconds = 0.0, 0, 0, 0, time.perf_counter()
    for case in range(CASES):
        ends, limits = random_case(rng)
        synchronise = ["time", "phase", "none"][case % 3]
        asked = ruckig.InputParameter(len(ends["start"]))
        for name, place in [("start", "current"), ("end", "target")]:
            setattr(asked, f"{place}_position", ends[name])
            setattr(asked, f"{place}_velocity", ends[f"{name}_velocity"])
            setattr(asked, f"{place}_acceleration", ends[f"{name}_acceleration"])
        for name, limit in limits.items():
            prefix = "" if name.startswith("min_") else "max_"
            setattr(asked, prefix + name, limit)
        asked.synchronization = kinds[synchronise]
        theirs = ruckig.Trajectory(len(ends["start"]))
        try:
            found = int(ruckig.Ruckig(len(ends["start"])).calculate(asked, theirs)) >= 0
        except (ruckig.RuckigError, ValueError):
            found = False
        try:
            ours = profiles.time_optimal(**ends, **limits, synchronise=synchronise)
        except ValueError:
            alike += not found
            refused += found
            continue
        if not found:
            continue  # where the published one gives up, ours may still answer: the laws below hold for it
        solved += 1
        worst = max(worst, abs(ours.duration - theirs.duration) / (1e-6 + theirs.duration))
        assert ours.duration == pytest.approx(theirs.duration, rel=1e-9, abs=1e-9), (
            ends,
            limits,
            synchronise,
        )
        assert_within(ours, ends, limits)
    seconds = time.perf_counter() - seconds
    print(
        f"\n{CASES} cases, {solved} solved by both, {alike} by neither, {refused} by theirs alone: "
        f"durations agree to {worst:.1e}, {seconds:.0f} s"
    )
    assert solved > 0.85 * CASES
    assert refused <= CASES // 10_000


def assert_within(profile: profiles.Profile, ends: dict, limits: dict) -> None:
    """Arrives as asked and stays within the limits from where the start is within them."""
    last = profile.at(profile.durations)
    at_end = [np.diagonal(np.atleast_2d(part)) for part in last]
    names = ["end", "end_velocity", "end_acceleration"]
    count = 3 if np.all(np.isfinite(limits["jerk"])) else 2
    for name, part in list(zip(names, at_end, strict=False))[:count]:
        np.testing.assert_array_equal(part, ends[name])
    # Just before the end: what is left of the way in a nanosecond, and the library's own tolerance.
    before = profile.at(np.maximum(profile.durations - 1e-9, 0.0))
    near = [np.diagonal(np.atleast_2d(part)) for part in before]
    state = profile.at(np.linspace(0.0, profile.duration, 41))
    extent = 1 + np.abs(state.value).max(axis=0)
    assert np.all(np.abs(near[0] - ends["end"]) <= 2e-7 * extent)
    swing = np.abs(ends["start_acceleration"]) ** 2 / limits["jerk"] / 2
    for name, part in [("velocity", state.velocity), ("acceleration", state.acceleration)]:
        lower, upper = limits.get(f"min_{name}", -limits[name]), limits[name]
        start = ends[f"start_{name}"]
        room = swing if name == "velocity" else 0.0
        # A start that cannot but pass a limit does so by what its acceleration still carries it.
        assert np.all(part <= np.maximum(upper, start + room) * (1 + 1e-9) + 1e-9), name
        assert np.all(part >= np.minimum(lower, start - room) * (1 + 1e-9) - 1e-9), name
    assert np.all(np.abs(state.jerk) <= limits["jerk"] * (1 + 1e-9))


PROFILES = [
    profiles.linear(0, 1, 2),
    profiles.linear([0, 1], 3, 2.5),
    profiles.trapezoid(0.0, [1.0, -1.0], 2.0, ramp=0.3),
    profiles.s_curve((0.0, 1.0), (2.0, 1.0), 1.0),
    profiles.time_optimal(0, 1, velocity=1),
    profiles.time_optimal([0, 1], 2, velocity=1, acceleration=[1, 2], jerk=3, end_velocity=0.1, duration=9),
    profiles.time_optimal(0, 1, velocity=1, min_velocity=-2, acceleration=1, synchronise="phase"),
]


@pytest.mark.parametrize("profile", PROFILES, ids=repr)
def test_profiles_are_values(profile):
    copy = pickle.loads(pickle.dumps(profile))
    assert copy == profile
    assert hash(copy) == hash(profile)
    assert eval(repr(profile), {"profiles": profiles}) == profile
    assert profile != profiles.linear(0, 1, 3)
    assert profile != "profile"
    with pytest.raises(AttributeError):
        profile.duration = 1.0


@pytest.mark.parametrize("profile", PROFILES, ids=repr)
def test_shapes_of_what_comes_out(profile):
    axes = np.shape(profile.at(0.0).value)
    for times in [0.5, [0.1, 0.2], np.zeros((2, 3)), np.zeros(0), np.arange(4, dtype=np.float32)[::2]]:
        for part in profile.at(times):
            assert np.shape(part) == np.shape(times) + axes
    for part in (profile.durations, *profile.peaks):
        assert np.shape(part) == axes
    one_by_one = [profile.at(float(t)).value for t in (0.0, 0.3, 0.9)]
    np.testing.assert_array_equal(profile.at([0.0, 0.3, 0.9]).value, one_by_one)


BAD = [
    (lambda: profiles.linear(math.nan, 1, 1), r"^start must be finite, got nan$"),
    (lambda: profiles.linear(0, math.inf, 1), r"^end must be finite, got inf$"),
    (lambda: profiles.linear(0, 1, 0), r"^duration must be finite and positive, got 0.0$"),
    (lambda: profiles.linear(0, 1, math.inf), r"^duration must be finite and positive, got inf$"),
    (lambda: profiles.linear([0, 1], [1, 2, 3], 1), r"^end must be one number or have shape \(2,\), got"),
    (lambda: profiles.linear([], [], 1), r"^start must be one number or have shape \(axes,\), got"),
    (lambda: profiles.linear([[0.0]], 1, 1), r"^start must be one number or have shape \(axes,\), got"),
    (lambda: profiles.linear(-1e308, 1e308, 1), r"^duration must be long enough for finite derivatives"),
    (lambda: profiles.s_curve(0, 1, 1e-200), r"^duration must be long enough for finite derivatives"),
    (lambda: profiles.trapezoid(0, 1, 1, ramp=0.6), r"^ramp must be positive and at most half"),
    (lambda: profiles.trapezoid(0, 1, 1, ramp=math.nan), r"^ramp must be positive and at most half"),
    (lambda: profiles.s_curve(0, 1, 1, ramp=0), r"^ramp must be positive and at most half"),
    (lambda: profiles.linear(0, 1, 1).at(math.nan), r"^times must be finite, got nan$"),
    (lambda: profiles.linear(0, 1, 1).at([0.0, math.inf]), r"^times\[1\] must be finite, got inf$"),
    (lambda: profiles.time_optimal(0, 1, velocity=0), r"^velocity must be positive, got 0.0$"),
    (lambda: profiles.time_optimal(0, 1, velocity=math.nan), r"^velocity must be positive, got nan$"),
    (lambda: profiles.time_optimal(0, 1, velocity=math.inf), r"^velocity must be finite where"),
    (lambda: profiles.time_optimal(0, 1, velocity=1, jerk=-1), r"^jerk must be positive, got -1.0$"),
    (
        lambda: profiles.time_optimal(0, 1, velocity=1, min_velocity=1),
        r"^min_velocity must be negative",
    ),
    (
        lambda: profiles.time_optimal(0, 1, velocity=1, min_velocity=math.nan),
        r"^min_velocity must be",
    ),
    (lambda: profiles.time_optimal(0, 1, velocity=1, end_velocity=2), r"^end_velocity must lie within"),
    (
        lambda: profiles.time_optimal(0, 1, velocity=1, start_velocity=math.nan),
        r"^start_velocity must be finite",
    ),
    (
        lambda: profiles.time_optimal(
            0, 1, velocity=1, acceleration=1, jerk=1, end_velocity=1, end_acceleration=-1
        ),
        r"^end_acceleration must leave the velocity within",
    ),
    (lambda: profiles.time_optimal(0, 1, velocity=1, synchronise="never"), r"^synchronise must be 'time'"),
    (lambda: profiles.time_optimal(0, 1, velocity=1, duration=-1), r"^duration must be finite and positive"),
]


@pytest.mark.parametrize(("call", "message"), BAD)
def test_what_makes_no_sense_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_what_is_no_number_is_refused():
    with pytest.raises(sw.ArgumentTypeError, match=r"^start must be real numbers"):
        profiles.linear("a", 1, 1)
    with pytest.raises(sw.ArgumentTypeError, match=r"^duration must be a number, got True"):
        profiles.linear(0, 1, True)


@pytest.mark.parametrize("spread", [1.0, 5.0, 100.0])
def test_any_numbers_give_an_answer_or_a_plain_refusal(spread):
    rng = np.random.default_rng(5)
    answers = 0
    for _ in range(500):
        sizes = 10.0 ** rng.uniform(-spread, spread, 9)
        signs = rng.choice([-1.0, 0.0, 1.0], 9)
        sized = dict(zip(("start", "end", "start_velocity", "end_velocity"), sizes * signs, strict=False))
        limits = dict(zip(ruckig_limits, sizes[4:7], strict=True))
        try:
            found = profiles.time_optimal(**sized, **limits)
        except ValueError:
            continue
        answers += 1
        assert np.all(np.isfinite(found.at(cuts(found, 9))))
    assert answers > (20 if spread > 5 else 200)
