"""A gyroscope in the loop: what a log says of it, said as it comes; what is silent, late or wrong."""

import math

import numpy as np
import pytest

pytest.importorskip("pydantic", reason='needs pip install "six-wheel[cli]"')

import six_wheel as sw
from six_wheel.control_loop import Loop, Settings
from six_wheel.control_loop.diagnostics import statuses
from six_wheel.logs.gyroscope.rates import Turning, edges_of, upward
from six_wheel.robot_description.gyroscope_errors import with_readings_apart

START = 1_700_000_000_000_000_000  # [ns]
MS = 1_000_000
KNOWN = "noise: 0.002, period: 0.005, bias: 0.0, bias_noise: 0.05, bias_walk: 0.0001"
WHEELS = ["left_wheel_joint", "right_wheel_joint"]


def settings(keys: str = "") -> Settings:
    text = f"kind: differential\ntrack_width: 0.5\nwheel_radius: 0.1\ngyroscope: {{{KNOWN}{keys}}}\n"
    return Settings.of_text(text)


def rate_at(times: np.ndarray) -> np.ndarray:
    """At rest for two seconds, then a way that winds [rad/s]; the wheels see 0.9 of it."""
    return np.where(times > 2.0, np.sin(3.0 * (times - 2.0)), 0.0)


class Drive:
    """Joint states every 20 ms and a gyroscope every 5 ms, whose stamps jitter, for `seconds`."""

    def __init__(self, seconds: float = 6.0, seed: int = 1) -> None:
        random = np.random.default_rng(seed)
        self.rows = np.arange(0, round(seconds * 1000), 20) * MS + random.integers(
            -2 * MS, 2 * MS, round(50 * seconds)
        )
        times = self.rows / 1e9
        turned = 0.9 * np.where(times > 2.0, (1.0 - np.cos(3.0 * (times - 2.0))) / 3.0, 0.0)
        along = np.where(times > 2.0, 0.3 * (times - 2.0), 0.0)
        self.angles = np.stack((along - 0.25 * turned, along + 0.25 * turned), axis=-1) / 0.1
        self.stamps = np.arange(-10, round(seconds * 1000), 5) * MS + random.integers(
            -MS, MS, round(200 * seconds) + 2
        )
        self.rates = rate_at(self.stamps / 1e9) + 0.02 + random.normal(0.0, 0.002, len(self.stamps))

    def run(self, loop: Loop, delay=lambda k: 0, reading=lambda k, rate: (0.0, 0.0, rate)) -> list:
        """Give it all in the order in which it comes, readings of the gyroscope `delay(k)` [ns] late, None
        for never; the steps in which odometry counted."""
        events = [(int(stamp), 1, k) for k, stamp in enumerate(self.rows)]
        late = ((k, int(stamp), delay(k)) for k, stamp in enumerate(self.stamps))
        events += [(stamp + by, 0, k) for k, stamp, by in late if by is not None]
        counted = []
        for now, kind, k in sorted(events):
            if kind:
                stamp = START + int(self.rows[k])
                step = loop.joints(WHEELS, self.angles[k].tolist(), [], stamp, START + now)
            else:
                stamp = START + int(self.stamps[k])
                step = loop.imu(reading(k, float(self.rates[k])), stamp, START + now)
            if step is not None and step.state is not None:
                counted.append(step)
        return counted


def said(loop: Loop) -> str:
    (text,) = [message for _, name, message, _ in statuses(loop, "rover") if name == "rover: odometry"]
    return text


def by_the_file(drive: Drive) -> np.ndarray:
    """Poses as of a log, but for the last row, whose next one never comes."""
    rows, stamps = (each / 1e9 for each in (drive.rows, drive.stamps))
    rates = Turning(iter([(stamps, drive.rates)])).rates(edges_of(rows, None, None))
    # Rows of the first tenth of a second say how far apart they are.
    apart = float(np.median(np.diff(rows[: 1 + np.searchsorted(rows, rows[0] + 0.1)])))
    known = with_readings_apart(settings().parameters.known_gyroscope, 0.005, apart)
    track = sw.dead_reckon(
        settings().rover, None, drive.angles[:-1], rows[:-1], yaw_rate=rates[:-1], gyroscope=known
    )
    return track.poses


@pytest.mark.parametrize("delay", [0, 3 * MS, 60 * MS])
def test_it_counts_what_a_log_of_it_says(delay: int) -> None:
    """However late readings come: to the rounding of sums that begin elsewhere, and of a start in 1970."""
    drive, loop = Drive(), Loop(settings())
    counted = drive.run(loop, delay=lambda k: delay)
    poses = by_the_file(drive)
    behind = 1 + math.ceil(delay / (20 * MS))
    stamps = [step.stamp - START for step in counted]
    places = np.searchsorted(drive.rows, stamps)
    np.testing.assert_array_equal(drive.rows[places], stamps)
    found = np.array([step.state.pose for step in counted])
    np.testing.assert_allclose(found, poses[places], atol=1e-7)
    assert places[-1] >= len(drive.rows) - 1 - behind
    assert said(loop) == "good"
    bias, deviation = loop.gyroscope_bias
    assert bias == pytest.approx(0.02, abs=4.0 * deviation)


def test_what_never_speaks_leaves_the_wheels_to_the_bit() -> None:
    drive = Drive()
    loop, alone = (
        Loop(settings()),
        Loop(Settings.of_text("kind: differential\ntrack_width: 0.5\nwheel_radius: 0.1\n")),
    )
    silent = {step.stamp: step.state.pose.tolist() for step in drive.run(loop, delay=lambda k: None)}
    wheels = {step.stamp: step.state.pose.tolist() for step in drive.run(alone)}
    last = START + int(drive.rows[-2])
    assert silent[last] == wheels[last]
    assert "a gyroscope must speak in time: odometry goes by the wheels alone, got nothing" in said(loop)


def test_what_falls_silent_is_done_without_and_taken_up_again() -> None:
    drive, loop = Drive(), Loop(settings())
    gap = (drive.stamps > 3000 * MS) & (drive.stamps < 4000 * MS)
    counted = drive.run(loop, delay=lambda k: None if gap[k] else 0)
    assert "by the wheels alone, got the last one" in said(loop)
    delays = np.diff([step.now - step.stamp for step in counted])
    assert np.abs(delays).max() < 140 * MS  # it waited for a tenth of a second, and a row
    times, yaws = (
        np.array([(step.stamp - START) / 1e9 for step in counted]),
        [s.state.pose[2] for s in counted],
    )
    known = (times > 4.2) & (times < 5.9)
    turned = (1.0 - np.cos(3.0 * (times[known] - 2.0))) / 3.0
    error = np.array(yaws)[known] - turned
    assert np.ptp(error) < 0.02  # where the wheels err by a tenth of what is turned, 0.067
    alone = np.interp(times[known], drive.rows / 1e9, drive.angles @ (-0.2, 0.2)) - turned
    assert np.ptp(alone) > 0.05


def test_what_is_always_late_is_said_and_holds_up_nothing_for_longer() -> None:
    drive, loop = Drive(), Loop(settings())
    counted = drive.run(loop, delay=lambda k: 300 * MS)
    assert "a gyroscope must speak in time" in said(loop)
    assert max(step.now - step.stamp for step in counted) < 150 * MS


def test_readings_that_cannot_be_are_said_and_left_out() -> None:
    drive = Drive()
    for reading, text in (
        (lambda k, rate: (0.0, 0.0, math.nan if k % 10 == 5 else rate), "must read finite rates"),
        (lambda k, rate: (0.0, 0.0, math.inf if k % 10 == 5 else rate), "must read finite rates"),
    ):
        loop = Loop(settings())
        counted = drive.run(loop, reading=reading)
        assert text in said(loop)
        places = np.searchsorted(drive.rows, [step.stamp - START for step in counted])
        # A reading of twenty is of a twentieth's noise, and of what the rate bends by in 5 ms.
        found = np.array([step.state.pose for step in counted])
        np.testing.assert_allclose(found, by_the_file(drive)[places], atol=5e-3)
    loop = Loop(settings())
    loop.imu((0.0, 0.0, 0.1), START + MS, START + MS)
    loop.imu((0.0, 0.0, 0.1), START, START + 2 * MS)
    assert "stamps that increase" in said(loop)
    loop.imu((0.0, 0.0, 0.1), START - 2000 * MS, START + 3 * MS)
    assert "stamps of the gyroscope must be within 0.5 s of the clock, got 2 s" in said(loop)


def test_how_it_sits_its_scale_and_its_clock_are_taken_off() -> None:
    drive, up = Drive(), upward(0.3, -0.4)
    poses = by_the_file(drive)[-1]
    plain = drive.run(Loop(settings()))[-1].state.pose
    np.testing.assert_allclose(plain, poses, atol=1e-7)
    mounted, stated = (
        Loop(settings()),
        Loop(settings(", roll: 0.3, pitch: -0.4, scale: 1.25, time_offset: 0.05")),
    )
    mounted.mount(up.tolist(), START)
    stated.mount([0.0, 0.0, 1.0], START)  # the file has the last word
    end = drive.run(mounted, reading=lambda k, rate: (up * rate).tolist())[-1].state.pose
    np.testing.assert_allclose(end, poses, atol=1e-7)
    drive.stamps = drive.stamps + 50 * MS
    end = drive.run(stated, reading=lambda k, rate: (up * rate / 1.25).tolist())[-1].state.pose
    np.testing.assert_allclose(end, poses, atol=1e-7)


def test_joint_states_that_stop_come_again_or_go_back() -> None:
    """Nothing waits for ever, and nothing of before is mixed with what comes after."""
    drive, loop = Drive(2.0), Loop(settings())
    drive.run(loop)
    end = START + int(drive.rows[-1])
    assert loop.state.stamp == pytest.approx((drive.rows[-2] - drive.rows[0]) / 1e9, abs=1e-6)
    loop.tick(end + 700 * MS)
    assert loop.state.stamp == pytest.approx((drive.rows[-1] - drive.rows[0]) / 1e9, abs=1e-6)
    loop.joints(WHEELS, [0.0, 0.0], [], end + 710 * MS, end + 710 * MS)
    loop.joints(WHEELS, [0.0, 0.0], [], end + 710 * MS, end + 711 * MS)
    assert "DUPLICATE" in said(loop)
    loop.joints(WHEELS, [0.0, 0.0], [], end + 690 * MS, end + 720 * MS)
    assert "BACKWARDS" in said(loop)
    before = loop.state.pose
    loop.joints(WHEELS, [0.0, 0.0], [], end - 10**12, end - 10**12)  # time itself is set back
    drive.rows, drive.stamps = drive.rows - 10**12, drive.stamps - 10**12
    counted = drive.run(loop)
    assert np.isfinite(counted[-1].state.pose).all()
    np.testing.assert_allclose(counted[-1].state.pose, before, atol=0.01)
    loop.set_pose([1.0, 2.0, 0.5], None, int(START + drive.rows[-1]))
    np.testing.assert_array_equal(loop.state.pose, [1.0, 2.0, 0.5])


def test_another_gyroscope_is_refused_while_the_rover_drives():
    """It was taken without a word, and odometry went on with the one before."""
    loop = Loop(settings())
    before = loop.settings
    with pytest.raises(ValueError, match="the gyroscope must stay what it is"):
        loop.change(before.changed({"gyroscope.noise": 0.1}), START)
    assert loop.settings is before
