"""Every row of the tables: the core and its peers on the same rover and the same numbers."""

import itertools
import os
from importlib.metadata import version
from importlib.util import find_spec

import numpy as np
from peers.arrays import Arrays, Tuned
from peers.arrays import integrate as numpy_integrate
from peers.arrays import rollout as numpy_rollout
from peers.plain import Plain

import six_wheel as sw
from six_wheel import reference
from six_wheel.cli.benchmark import FEW_ROWS, Comparison, Timing

RADIUS, STEP = 0.15, 0.01
ROVER = sw.Rover.six_wheel(
    front_to_middle=0.5, middle_to_rear=0.5, track_width=0.8, middle_track_width=0.9, wheel_radius=RADIUS
)
WHEELS = [(wheel.x, wheel.y, wheel.steered) for wheel in ROVER.wheels]
TWIST = (0.5, 0.0, 0.3)
LEVELS = sw.simd_levels()
BEST = LEVELS[-1]

HAS_NUMBA = find_spec("numba") is not None
HAS_WPIMATH = find_spec("wpimath") is not None
MISSING = [name for name, there in (("numba", HAS_NUMBA), ("robotpy-wpimath", HAS_WPIMATH)) if not there]

# Times of peers and goals are per item. Goals of batches: with 512 bit registers, with 256.
GOALS = {
    "inverse into two arrays": 80,
    "inverse, two fresh arrays": 190,
    "forward": 90,
    "odometry update": 80,
    "inverse, n = 1e5": (4.5, 8.0),
    "inverse, n = 1e7": (4.5, 8.0),
    "forward, n = 1e5": (4.5, 7.5),
    "integrate, n = 1e5": (2.0, 3.2),
    "rollout, 4096 x 64": (1.7, 2.8),
}


def versions():
    """Peers that took part."""
    there = {"numba": HAS_NUMBA, "robotpy-wpimath": HAS_WPIMATH}
    return {name: version(name) for name, found in there.items() if found}


def goal(job):
    """Largest time of a job on this machine [ns]; None without a goal."""
    given = GOALS.get(job)
    if isinstance(given, tuple):
        return {"avx512": given[0], "avx2": given[1]}.get(BEST)
    return given


def agree(what, got, expected, tolerance=1e-12):
    """Nobody is timed who comes to another result."""
    for one, other in zip(got, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=tolerance, err_msg=what)


# --- one call --------------------------------------------------------------------------------------------


def calls():
    """One call from Python, as a control loop makes it."""
    steering, speeds = ROVER.inverse(TWIST)
    out, back = (np.empty(4), np.empty(6)), np.empty(3)
    plain, arrays, slow = Plain(WHEELS, RADIUS), Arrays(WHEELS, RADIUS), reference.Rover.like(ROVER)
    twist, lists = np.array(TWIST), (steering.tolist(), speeds.tolist())
    into = {
        "core": Timing.of(ROVER.inverse, TWIST, out=out),
        "plain Python": Timing.of(plain.inverse, TWIST),
        "NumPy": Timing.of(arrays.inverse, twist),
        "reference": Timing.of(slow.inverse, TWIST),
    }
    fresh = {"core": Timing.of(ROVER.inverse, TWIST), "NumPy": Timing.of(arrays.inverse, twist)}
    forward = {
        "core": Timing.of(ROVER.forward, steering, speeds),
        "core, out=": Timing.of(ROVER.forward, steering, speeds, out=back),
        "plain Python": Timing.of(plain.forward, *lists),
        "NumPy": Timing.of(arrays.forward, steering, speeds),
        "reference": Timing.of(slow.forward, steering, speeds),
    }
    rows = [speeds * k * STEP for k in range(2)]
    here = {"there": itertools.cycle(rows), "steering": steering}
    moving, kept = "update(steering, next(there))", "next(there)"
    update = {
        "plain Python": Timing(
            "update(steering, next(there))",
            {
                "update": plain.update,
                "steering": lists[0],
                "there": itertools.cycle([row.tolist() for row in rows]),
            },
            baseline=kept,
        ),
        "NumPy": Timing(moving, {"update": arrays.update, **here}, baseline=kept),
    }
    if HAS_NUMBA:
        from peers import compiled

        numba = compiled.build(WHEELS, RADIUS)
        into["numba"] = Timing.of(numba["inverse"], *TWIST, *out)
        fresh["numba"] = Timing.of(numba["inverse_fresh"], *TWIST)
        forward["numba"] = Timing.of(numba["forward"], steering, speeds)
        names = {"update": numba["update"], "state": np.zeros(3), "last": np.zeros(6), **here}
        update["numba"] = Timing("update(state, last, steering, next(there))", names, baseline=kept)
        agree("numba", numba["inverse_fresh"](*TWIST), (steering, speeds))
        agree("numba", [numba["forward"](steering, speeds)], [TWIST])
    if HAS_WPIMATH:
        from peers.first import First, chassis

        first = First(WHEELS, RADIUS)
        states = first.states(*lists)
        into["wpimath, bare"] = Timing.of(first.kinematics.toSwerveModuleStates, chassis(TWIST))
        into["wpimath"] = Timing.of(first.inverse, *TWIST)
        forward["wpimath, bare"] = Timing.of(first.kinematics.toChassisSpeeds, states)
        forward["wpimath"] = Timing.of(first.forward, *lists)
        yaw = states[1].angle * 0
        positions = itertools.cycle([first.positions(lists[0], row.tolist()) for row in rows])
        names = {"update": first.odometry.update, "yaw": yaw, "there": positions}
        update["wpimath, bare"] = Timing("update(yaw, next(there))", names, baseline=kept)
        names = {
            "update": first.update,
            "steering": lists[0],
            "there": itertools.cycle([row.tolist() for row in rows]),
        }
        update["wpimath"] = Timing("update(0.0, steering, next(there))", names, baseline=kept)
        agree("wpimath", first.inverse(*TWIST), (steering, speeds))
        agree("wpimath", [first.forward(*lists)], [TWIST])
    agree("plain Python", plain.inverse(TWIST), (steering, speeds))
    agree("plain Python", [plain.forward(*lists)], [TWIST])
    agree("NumPy", arrays.inverse(twist), (steering, speeds))
    agree("NumPy", [arrays.forward(steering, speeds)], [TWIST])
    jobs = [
        Comparison("inverse into two arrays", into),
        Comparison("inverse, two fresh arrays", fresh),
        Comparison("forward", forward),
    ]
    return [*jobs, *_stateful(update, here)]


def _stateful(update, here):
    """Odometry and controller, where this version has them: every call needs a later stamp."""
    stamps = {"stamps": itertools.count(1.0, STEP)}
    if hasattr(sw, "Odometry"):
        names = {"update": sw.Odometry(ROVER).update, **here, **stamps}
        statement, kept = "update(steering, next(there), next(stamps))", "next(there), next(stamps)"
        update["core"] = Timing(statement, names, baseline=kept)
    jobs = [Comparison("odometry update", update)]
    if hasattr(sw, "Controller"):
        limits = sw.Limits(speed=1.0, acceleration=0.5, jerk=2.0, wheel_speed=8.0, steering_rate=1.0)
        controller = sw.Controller(ROVER, limits, timeout=1e9)
        controller.command(TWIST, 0.0)
        names = {"step": controller.step, **stamps}
        jobs.append(
            Comparison(
                "controller step", {"core": Timing("step(next(stamps))", names, baseline="next(stamps)")}
            )
        )
        # A planner's noise of 1 %: every step turns on towards another direction.
        noise = np.random.default_rng(0).uniform(-0.01, 0.01, 64)
        noisy = itertools.cycle([(TWIST[0], TWIST[1], TWIST[2] * (1.0 + part)) for part in noise])
        fresh = sw.Controller(ROVER, limits, timeout=1e9)
        names = {"command": fresh.command, "step": fresh.step, "noisy": noisy, **stamps}
        statement = "(command(next(noisy), (now := next(stamps))), step(now))"
        kept = "(next(noisy), next(stamps))"
        jobs.append(
            Comparison(
                "controller, a new command every step", {"core": Timing(statement, names, baseline=kept)}
            )
        )
    return jobs


# --- batches ---------------------------------------------------------------------------------------------


class Batch:
    """Twists that the rover can make, and arrays for what becomes of them."""

    def __init__(self, rows):
        self.rows = rows
        self.twists = np.zeros((rows, 3))  # vy = 0 and steering over +-90 degrees
        generator = np.random.default_rng(1)
        for axis in (0, 2):
            self.twists[:, axis] = generator.uniform(-1.0, 1.0, rows)
        self.steering, self.wheel_speeds = np.zeros((rows, 4)), np.zeros((rows, 6))
        ROVER.inverse(self.twists, out=(self.steering, self.wheel_speeds))
        self.back = np.zeros((rows, 3))

    def of(self, rows):
        """The first rows, as a batch."""
        part = object.__new__(Batch)
        part.rows = rows
        for name in ("twists", "steering", "wheel_speeds", "back"):
            setattr(part, name, getattr(self, name)[:rows])
        return part

    @property
    def joints(self):
        return self.steering, self.wheel_speeds


def copy_of(items, per_item):
    """A copy that moves as many bytes: half of them are read and half of them written."""
    source, target = np.ones((2, items * per_item // 16))
    return Timing.of(np.copyto, target, source, items=items)


def levels(function, *arguments, items, names=LEVELS, **keywords):
    """The core at every level of vectors; the best is called ``"core"``."""
    return {
        "core" if level == BEST else level: Timing.of(
            function, *arguments, level=level, items=items, **keywords
        )
        for level in reversed(names)
    }


def batches(rows=100_000, rollouts=(4096, 64)):
    """Whole arrays, one thread, outputs reused."""
    batch = Batch(rows)
    twists, joints, back = batch.twists, batch.joints, batch.back
    arrays, tuned, slow = Arrays(WHEELS, RADIUS), Tuned(WHEELS, RADIUS), reference.Rover.like(ROVER)
    poses = np.zeros((rows + 1, 3))
    k, t = rollouts
    controls = np.random.default_rng(2).uniform(-1.0, 1.0, (k, t, 3))
    fans = np.zeros((k, t + 1, 3))
    few = min(FEW_ROWS, rows)
    timings = {
        "inverse": {
            "copy": copy_of(rows, 104),
            **levels(ROVER.inverse, twists, out=joints, items=rows),
            "NumPy, tuned": Timing.of(tuned.inverse, twists, joints, items=rows),
            "NumPy": Timing.of(arrays.inverse, twists, items=rows),
            "reference": Timing.of(slow.inverse, twists[:few], items=few),
        },
        "forward": {
            "copy": copy_of(rows, 104),
            **levels(ROVER.forward, *joints, out=back, items=rows),
            "NumPy, tuned": Timing.of(tuned.forward, *joints, back, items=rows),
            "NumPy": Timing.of(arrays.forward, *joints, items=rows),
            "reference": Timing.of(slow.forward, *(each[:few] for each in joints), items=few),
        },
        "integrate": {
            "copy": copy_of(rows, 48),
            **levels(sw.integrate, twists, STEP, out=poses, items=rows),
            "NumPy": Timing.of(numpy_integrate, twists, STEP, items=rows),
            "reference": Timing.of(reference.integrate, twists[:few], STEP, items=few),
        },
        "rollout": {
            "copy": copy_of(k * t, 48),
            **levels(sw.rollout, controls, STEP, out=fans, items=k * t),
            "NumPy": Timing.of(numpy_rollout, controls, STEP, items=k * t),
        },
    }
    if HAS_NUMBA:
        from peers import compiled

        numba = compiled.build(WHEELS, RADIUS)
        for kind, suffix in (("numba, blocked", "_blocked"), ("numba", "_batch")):
            inverse, forward = numba["inverse" + suffix], numba["forward" + suffix]
            timings["inverse"][kind] = Timing.of(inverse, twists, *joints, items=rows)
            timings["forward"][kind] = Timing.of(forward, *joints, back, items=rows)
        for kind, suffix in (("numba, blocked", "_blocked"), ("numba", "")):
            integrate, rollout = (getattr(compiled, name + suffix) for name in ("integrate", "rollout"))
            timings["integrate"][kind] = Timing.of(integrate, twists, STEP, poses, items=rows)
            timings["rollout"][kind] = Timing.of(rollout, controls, STEP, fans, items=k * t)
    _check_batches(timings, batch, poses, fans, sw.integrate(twists, STEP), sw.rollout(controls, STEP))
    shown = "n = 1e5" if rows == 100_000 else f"n = {rows:,}"
    names = {"rollout": f"rollout, {k} x {t}"}
    return [Comparison(names.get(name, f"{name}, {shown}"), each) for name, each in timings.items()]


def _check_batches(timings, batch, poses, fans, expected_poses, expected_fans):
    """Everybody fills the same arrays with the same numbers."""
    steering, speeds = (each.copy() for each in batch.joints)
    results = {
        "inverse": (batch.joints, (steering, speeds)),
        "forward": ([batch.back], [batch.twists]),
        "integrate": ([poses], [expected_poses]),
        "rollout": ([fans], [expected_fans]),
    }
    for job, contenders in timings.items():
        got, expected = results[job]
        for name, timing in contenders.items():
            if name in ("copy", "reference"):
                continue
            for array in got:
                array[:] = np.nan
            value = timing.once()
            # Sums of 1e5 steps in another order differ by more than one of them.
            agree(f"{name}, {job}", got if name != "NumPy" else _listed(value), expected, 1e-10)
        for array, values in zip(got, expected, strict=True):
            array[:] = values  # state that the next job starts from


def _listed(value):
    return value if isinstance(value, tuple) else [value]


def growth(most):
    """The same job for ever more rows, on one thread and on two; and numba where no cache holds it."""
    batch = Batch(most)
    jobs = []
    for rows in (10**power for power in range(3, 8) if 10**power <= most):
        part = batch.of(rows)
        timings = {
            "copy": copy_of(rows, 104),
            **levels(ROVER.inverse, part.twists, out=part.joints, items=rows, names=LEVELS[1:] or LEVELS),
        }
        if (os.cpu_count() or 1) > 1:
            timings["core, 2 threads"] = Timing.of(
                ROVER.inverse, part.twists, out=part.joints, threads=2, items=rows
            )
        if HAS_NUMBA and rows == 10**7:
            from peers import compiled

            numba = compiled.build(WHEELS, RADIUS)
            timings["numba, blocked"] = Timing.of(
                numba["inverse_blocked"], part.twists, *part.joints, items=rows
            )
            timings["numba"] = Timing.of(numba["inverse_batch"], part.twists, *part.joints, items=rows)
        jobs.append(Comparison(f"inverse, n = 1e{len(str(rows)) - 1}", timings))
    return jobs
