"""Profiles: laws of the derivatives, the published Ruckig, shapes by plain integration, abuse.

`SOAK` in the environment multiplies the number of random cases: 250 makes the million (`make soak`).
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from six_wheel import profiles, reference
from tests.core.control.profile_cases import cuts

# In whole micrometres: a way that is next to nothing beside the limits is refused.
values = st.floats(-10.0, 10.0).map(lambda value: round(value, 6))
durations = st.floats(0.1, 20.0)


@st.composite
def shaped(draw: st.DrawFn) -> profiles.Profile:
    """A profile of a given shape."""
    ends = [draw(values), draw(values), draw(durations)]
    maker = draw(st.sampled_from([profiles.linear, profiles.trapezoid, profiles.s_curve]))
    if maker is profiles.linear:
        return maker(*ends)
    return maker(*ends, ramp=ends[2] * draw(st.floats(0.05, 0.5)))


@st.composite
def fastest(draw: st.DrawFn) -> profiles.Profile:
    """A time-optimal profile between moving ends."""
    velocity, acceleration, jerk = (draw(st.floats(0.2, 5.0)) for _ in range(3))
    share = st.floats(-0.5, 0.5).map(lambda value: round(value, 6))
    return profiles.time_optimal(
        draw(values),
        draw(values),
        velocity=velocity,
        acceleration=acceleration,
        jerk=jerk,
        start_velocity=draw(share) * velocity,
        end_velocity=draw(share) * velocity,
    )


@given(st.one_of(shaped(), fastest()))
def test_each_derivative_is_that_of_the_one_before(profile):
    assume(profile.duration > 0)
    step = 1e-5 * profile.duration
    times = cuts(profile)[1:-1]
    before, now, after = (profile.at(times + shift) for shift in (-step, 0.0, step))
    # Inside a piece: neither jerk nor acceleration jumps within the step.
    size = 1 + profile.peaks.acceleration
    gap = np.abs(after.acceleration - before.acceleration - 2 * step * now.jerk)
    inside = (before.jerk == after.jerk) & (gap < 1e-9 * size)
    assert inside.sum() > len(times) // 2
    for order in (0, 1, 2):
        slope = (after[order] - before[order]) / (2 * step)
        # Rounding of the values, and of a cubic the jerk times the step squared over six.
        rounding = 1e-15 * (1 + np.abs(now[order]).max()) / step
        error = rounding + profile.peaks.jerk * step**2 / 6
        np.testing.assert_allclose(slope[inside], now[order + 1][inside], rtol=1e-12, atol=2 * error)


@given(st.one_of(shaped(), fastest()))
def test_the_velocity_integrates_to_the_way(profile):
    times = cuts(profile, 4001)
    state = profile.at(times)
    way = np.trapezoid(state.velocity, times)
    # The trapezoid rule errs by jerk times step cubed / 12 in every step, and by a jump of the acceleration
    # times step squared / 8 where it has one: at most four times, and then the jerk between them is 0.
    peaks, step = profile.peaks, times[1]
    error = step**2 * (
        peaks.acceleration / 2 + (peaks.jerk if np.isfinite(peaks.jerk) else 0.0) * times[-1] / 12
    )
    assert way == pytest.approx(state.value[-1] - state.value[0], abs=error + 1e-7)


def call_of(profile):
    """The function that made a profile, by name, and its arguments."""
    make, arguments = profile.__reduce__()
    return make.func.__name__, arguments, make.keywords


@given(shaped())
def test_both_ends_are_exact_and_beyond_them_it_rests(profile):
    maker, (start, end, duration), _ = call_of(profile)
    assert profile.duration == duration
    assert profile.at(0.0).value == start
    assert profile.at(duration).value == end
    for time_, value in [(-1.0, start), (math.nextafter(duration, math.inf), end), (1e9, end)]:
        assert profile.at(time_) == (value, 0.0, 0.0, 0.0)
    if maker != "linear":
        assert profile.at(duration).velocity == 0.0
    if maker == "s_curve":
        assert profile.at(duration).acceleration == 0.0


@given(shaped())
def test_backwards_it_is_its_own_mirror_image(profile):
    _, (start, end, duration), _ = call_of(profile)
    back = profile.replace(start=end, end=start)
    times = cuts(profile)
    scale = 1 + abs(start) + abs(end)
    np.testing.assert_allclose(
        profile.at(times).value, back.at(duration - times).value, rtol=0, atol=4e-15 * scale
    )
    np.testing.assert_allclose(
        profile.at(times).velocity,
        -back.at(duration - times).velocity,
        rtol=0,
        atol=1e-13 * (1 + profile.peaks.velocity),
    )


@given(shaped())
def test_shapes_by_plain_integration(profile):
    maker, (start, end, duration), keywords = call_of(profile)
    plain = reference.profiles.shape(maker, start, end, duration, **keywords)
    for time_ in cuts(profile, 23):
        state = profile.at(time_)
        assert state.value == pytest.approx(plain.value(time_), abs=1e-13 * (1 + abs(start) + abs(end)))
        assert state.velocity == pytest.approx(
            plain.velocity(time_), abs=1e-12 * (1 + profile.peaks.velocity)
        )


@given(st.one_of(shaped(), fastest()))
def test_peaks_are_reached_and_never_passed(profile):
    times = cuts(profile, 2001)
    largest = [np.abs(part).max() for part in profile.at(times)[1:]]
    velocity, acceleration, jerk = profile.peaks
    assert np.all(largest <= np.multiply(profile.peaks, 1 + 1e-12))
    # Between two samples a part changes at most by its derivative times the step.
    assert largest[0] >= (velocity - acceleration * times[1]) * (1 - 1e-12) - 1e-12
    assert jerk == 0 or largest[1] >= (acceleration - jerk * times[1]) * (1 - 1e-12) - 1e-12


def test_the_least_jerk_of_a_double_s():
    # 32 d / T^3, the jerk of acceleration and deceleration without cruising; any ramp takes more.
    peaks = profiles.s_curve(0.0, 3.0, 2.0).peaks
    np.testing.assert_allclose(peaks, (2 * 3 / 2, 8 * 3 / 4, 32 * 3 / 8), rtol=1e-15)
    assert profiles.s_curve(0.0, 3.0, 2.0, ramp=0.7).peaks.jerk > peaks.jerk
    assert profiles.s_curve(0.0, 3.0, 2.0, ramp=0.7).peaks.velocity < peaks.velocity


def test_without_a_limit_of_jerk_the_fastest_is_a_trapezoid():
    # 1 m at 0.5 m/s and 1 m/s^2: 2.5 s, of which half a second each way speeds up and slows down.
    fast = profiles.time_optimal(0.0, 1.0, velocity=0.5, acceleration=1.0)
    assert fast.duration == pytest.approx(2.5, abs=1e-14)
    same = profiles.trapezoid(0.0, 1.0, 2.5, ramp=0.5)
    times = np.linspace(0.0, 2.5, 101)
    np.testing.assert_allclose(fast.at(times).value, same.at(times).value, atol=1e-14)
    assert profiles.time_optimal(0.0, 1.0, velocity=0.5).duration == pytest.approx(2.0, abs=1e-14)


@pytest.mark.parametrize("size", [1e-12, 1e-9, 1e-3, 1.0, 1e6])
def test_small_and_large_motions_alike(size):
    unit = profiles.time_optimal(0.0, 1.0, velocity=0.4, acceleration=1.0, jerk=3.0)
    scaled = profiles.time_optimal(0.0, size, velocity=0.4 * size, acceleration=size, jerk=3.0 * size)
    assert scaled.duration == pytest.approx(unit.duration, rel=1e-12)
    times = cuts(unit)
    np.testing.assert_allclose(scaled.at(times).value / size, unit.at(times).value, atol=1e-11)


def test_synchronised_axes():
    start, end = [0.0, 0.0, 1.0], [1.0, 0.2, 0.5]
    limits = {"velocity": [1.0, 1.0, 0.5], "acceleration": 2.0, "jerk": [10.0, 5.0, 20.0]}
    alone = profiles.time_optimal(start, end, **limits, synchronise="none")
    together = profiles.time_optimal(start, end, **limits)
    assert together.duration == pytest.approx(alone.durations.max(), rel=1e-15)
    assert np.ptp(together.durations) == 0.0
    straight = profiles.time_optimal(start, end, **limits, synchronise="phase")
    share = (straight.at(cuts(straight)).value - start) / np.subtract(end, start)
    np.testing.assert_allclose(share, share[:, :1] * np.ones(3), atol=1e-9)
    for synchronise in ["time", "phase", "none"]:
        slow = profiles.time_optimal(start, end, **limits, duration=5.0, synchronise=synchronise)
        np.testing.assert_allclose(slow.durations, 5.0, rtol=1e-12)


def test_a_wish_that_is_too_short_is_told_the_least():
    least = profiles.time_optimal(0.0, 1.0, velocity=1.0, acceleration=1.0, jerk=1.0).duration
    with pytest.raises(ValueError, match=rf"^duration must be at least {least!r} s, got 1.0$"):
        profiles.time_optimal(0.0, 1.0, velocity=1.0, acceleration=1.0, jerk=1.0, duration=1.0)
    same = profiles.time_optimal(0.0, 1.0, velocity=1.0, acceleration=1.0, jerk=1.0, duration=least)
    assert same.duration == least


def test_a_time_no_course_takes_is_told_the_next_one():
    # Flying past: either straight on, or after a stop and a second run-up.
    ends = {"start_velocity": 1.0, "end_velocity": 1.0, "velocity": 1.0, "acceleration": 0.5, "jerk": 1.0}
    with pytest.raises(ValueError, match=r"^duration must be .* s or at least .* s: no course"):
        profiles.time_optimal(0.0, 0.5, **ends, duration=0.9)
