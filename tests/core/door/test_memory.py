"""No memory is a `MemoryError`: no panic, no abort. In processes of their own, under a limit."""

import json
import os
import subprocess
import sys
import textwrap

import pytest

resource = pytest.importorskip("resource", reason="no limits of memory to set here")

# Each of these asks for more than there is: as big copies, as results, or as both.
CALLS = {
    "inverse": "ROVER.inverse(np.zeros((3 * 10**7, 3)))",
    "inverse, broadcast": "ROVER.inverse(HUGE(10**12, 3))",
    "inverse, centre": "ROVER.inverse((0.1, 0.0, 0.0), centre=HUGE(10**12, 2))",
    "inverse, previous": "ROVER.inverse((0.1, 0.0, 0.0), previous=HUGE(10**12, 4))",
    "inverse, float32": "ROVER.inverse(np.zeros((6 * 10**7, 3), np.float32), level='scalar')",
    "forward": "ROVER.forward(HUGE(10**12, 4), HUGE(10**12, 6))",
    "fit": "ROVER.fit(HUGE(10**12, 4), HUGE(10**12, 6))",
    "fit, names": "ROVER.fit([0.0] * 4, HUGE(3 * 10**7, 6))",
    "sensitivity": "ROVER.sensitivity(HUGE(10**12, 4), HUGE(10**12, 6))",
    "admissible": "ROVER.admissible(HUGE(10**12, 3))",
    "project": "ROVER.project(HUGE(10**12, 3))",
    "icr": "ROVER.icr(HUGE(10**12, 3))",
    "commands": "ROVER.commands(HUGE(10**12, 3))",
    "exp": "sw.exp(HUGE(10**12, 3))",
    "exp, dt": "sw.exp((0.1, 0.0, 0.0), HUGE(10**12, 1)[:, 0])",
    "log": "sw.log(HUGE(10**12, 3))",
    "compose": "sw.compose((0.1, 0.0, 0.0), HUGE(10**12, 3))",
    "wrap_angle": "sw.wrap_angle(HUGE(10**12, 3))",
    "integrate": "sw.integrate(HUGE(10**12, 3), 0.1)",
    "integrate, starts": "sw.integrate(np.zeros((5, 3)), 0.1, HUGE(10**12, 3))",
    "differentiate": "sw.differentiate(HUGE(10**12, 3), 0.1)",
    "rollout": "sw.rollout(HUGE(10**10 * 50, 3).reshape(10**10, 50, 3), 0.1)",
    "rollout_cost": "ROVER.rollout_cost(HUGE(10**10 * 50, 3).reshape(10**10, 50, 3), 0.1)",
    "dead_reckon": "sw.dead_reckon(ROVER, HUGE(10**12, 4), HUGE(10**12, 6), HUGE(10**12, 1)[:, 0])",
    "Odometry.run": "sw.Odometry(ROVER).run(HUGE(10**7, 4), HUGE(10**7, 6), np.arange(1e7))",
    "Controller.run": "sw.Controller(ROVER).run([(0.1, 0.0, 0.0)], [0.0], HUGE(10**12, 1)[:, 0])",
    "Controller.run, steps": "sw.Controller(ROVER).run([(0.1, 0.0, 0.0)], [0.0], np.arange(1.0, 2e7))",
    "Profile.at": "sw.profiles.linear(0.0, 1.0, 2.0).at(HUGE(10**12, 1))",
    "Profile.at, axes": "sw.profiles.linear([0.0] * 50, [1.0] * 50, 2.0).at(np.zeros(10**7))",
    "Profile": "sw.profiles.linear(HUGE(10**12, 1)[:, 0], 1.0, 2.0)",
    "frames": "ROCKY.frames(HUGE(10**7, 3))",
    "icr_offset": "ROCKY.icr_offset(HUGE(10**12, 3))",
    "steer": "ROCKY.steer(HUGE(10**12, 1)[:, 0], 0.0, (0.0, 0.0, 0.0))",
    "settle": "ARM.settle(GROUND, HUGE(10**12, 3))",
    "settle, stands": "ARM.settle(GROUND, HUGE(3 * 10**6, 3))",
    "settle, steering": "ARM.settle(GROUND, (5.0, 5.0, 0.0), HUGE(10**12, 4))",
    "bounds": "ARM.bounds(GROUND, HUGE(10**12, 3))",
    "bounds, intervals": "ARM.bounds(GROUND, HUGE(6 * 10**6, 3))",
    "bounds, pyramid": "ARM.bounds(sw.Terrain(np.zeros((5000, 5000), np.float32), 0.1), (200.0, 200.0, 0.0))",
    "feasible": "ARM.feasible(GROUND, HUGE(10**12, 3))",
    "feasible, pyramid": "ARM.feasible(sw.Terrain(np.zeros((5000, 5000), np.float32), 0.1), (9.0, 9.0, 0.0))",
    "Terrain": "sw.Terrain(HUGE(10**12, 4), 0.1)",
    "Terrain, single": "sw.Terrain(np.broadcast_to(np.float32(0.0), (17_000, 17_000)), 0.1)",
    "height": "GROUND.height_at(HUGE(10**12, 2))",
    "normal": "GROUND.normal_at(HUGE(10**12, 2))",
    "contains": "GROUND.contains(HUGE(10**12, 2))",
    "traction": "ARM.traction(0.1, 0.1, *[HUGE(10**12, 3)] * 3)",
    "inverse on the ground": "ARM.inverse(STAND, HUGE(10**12, 2))",
    "forward on the ground": "ARM.forward(STAND, None, HUGE(10**12, 6))",
    "Preintegrated": "sw.Preintegrated(ROVER).add(HUGE(3 * 10**7, 4), HUGE(3 * 10**7, 6), np.arange(3e7))",
    "simulate": "sw.simulate(ROVER, [(0.0, 0.1, 0.0, 0.0), (1e12, 0.1, 0.0, 0.0)])",
    "swerve": "sw.Rover.swerve(HUGE(10**12, 2), 0.1)",
    "encoders": "sw.Odometry(ROVER, wheel_encoders=itertools.repeat(sw.Encoder(100.0)))",
    "wheels": "sw.Rover(itertools.repeat(ROVER.wheels[0]))",
    "overflow": "ROVER.icr(HUGE(2**58, 3))",
    "overflow of frames": "ROCKY.frames(HUGE(2**57, 3))",
}

PROGRAM = """
import itertools, json, resource, sys
import numpy as np
import six_wheel as sw

def HUGE(rows, width):
    return np.broadcast_to(np.float64(0.5), (rows, width))

ROVER = sw.Rover.preset("perseverance")
ROCKY, ARM = (sw.RockerBogie.preset(name) for name in ("rocky7", "perseverance"))
GROUND = sw.Terrain(np.zeros((100, 100)), 0.1)
STAND = ARM.settle(GROUND, (5.0, 5.0, 0.0))
limit = int(sys.argv[1])
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
for name, call in json.loads(sys.stdin.read()).items():
    try:
        eval(call)
        print(json.dumps([name, "answered", ""]), flush=True)
    except Exception as error:
        print(json.dumps([name, type(error).__name__, str(error)]), flush=True)
"""


def limited(
    program: str, *arguments: str, given: str = "", **environment: str
) -> subprocess.CompletedProcess[str]:
    """A program in a process of its own, which may take long on a loaded machine but not for ever."""
    command = [sys.executable, "-W", "error", "-c", textwrap.dedent(program), *arguments]
    return subprocess.run(
        command, input=given, capture_output=True, text=True, timeout=300, env={**os.environ, **environment}
    )


# More than the rovers can have, or than a simulation makes: refused without being gone through.
ENDLESS = {"wheels", "encoders", "simulate"}
# Sizes that fit into the larger limit, and take their time.
SMALLER = {
    *("fit, names", "Odometry.run", "inverse, float32", "frames", "Controller.run, steps", "settle, stands"),
    *("bounds, intervals", "bounds, pyramid", "feasible, pyramid", "Terrain, single", "Preintegrated"),
}


@pytest.mark.parametrize("gibibytes", [1, 3])
def test_what_does_not_fit_is_a_memory_error(gibibytes):
    calls = {name: call for name, call in CALLS.items() if gibibytes == 1 or name not in SMALLER}
    result = limited(PROGRAM, str(gibibytes * 2**30), given=json.dumps(calls))
    outcomes = {name: (kind, text) for name, kind, text in map(json.loads, result.stdout.splitlines())}
    assert result.returncode == 0, (result.stderr, list(outcomes)[-1:])
    assert list(outcomes) == list(calls)
    for name, (kind, text) in outcomes.items():
        expected = {"ValueError"} if name in ENDLESS else {"MemoryError", "_ArrayMemoryError"}
        assert kind in expected, (name, kind, text)


def test_history_is_taken_as_it_is_needed():
    result = limited(
        """
        import resource
        import numpy as np
        import six_wheel as sw
        rover = sw.Rover.preset("perseverance")
        resource.setrlimit(resource.RLIMIT_AS, (2 * 2**30,) * 2)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        many = [sw.Odometry(rover, lag=1.0, history=2**40), sw.Odometry(rover, lag=1.0, history=10**6)]
        assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 20_000  # [kB]
        # Ten thousand samples within the lag: more than there is room for at first.
        steering, turned, stamps = np.zeros((10_000, 4)), np.zeros((10_000, 6)), np.arange(10_000) / 20_000
        turned[:] = stamps[:, None]
        for odometry in many:
            odometry.run(steering, turned, stamps)
            odometry.correct((0.2, 0.0, 0.0), 0.05, (0.0, 0.0, 0.0))
            print(odometry.state.pose[0])
        # What there is no memory for is not taken in, and nothing has changed.
        odometry = many[0]
        pose = odometry.state.pose
        big = 40_000_000
        try:
            row = np.zeros(6)
            for k in range(big):
                odometry.update((0.0,) * 4, row, 1.0 + k * 1e-9)
                if k == 300_000:
                    resource.setrlimit(resource.RLIMIT_AS, (700 * 2**20,) * 2)
        except MemoryError as error:
            print(error)
            print(odometry.state.stamp < 2.0)
        """
    )
    assert result.returncode == 0, result.stderr
    lines = result.stdout.splitlines()
    assert lines[0] == lines[1]
    assert lines[2].startswith("history must fit into memory, got ")
    assert lines[3] == "True"


@pytest.mark.parametrize("threads", [2, 64, 4000, 2**62])
def test_threads_that_cannot_start_are_done_without(threads):
    """A stack of each that does not fit: the calling thread does what there is to do."""
    result = limited(
        f"""
        import resource
        import numpy as np
        import six_wheel as sw
        rover = sw.Rover.preset("perseverance")
        twists = np.tile([0.1, 0.0, 0.02], (60_000, 1))
        expected = rover.inverse(twists, threads=1)
        logs = sw.integrate(twists.reshape(600, 100, 3), 0.1, threads=1)
        resource.setrlimit(resource.RLIMIT_AS, (3 * 2**30,) * 2)
        for one, other in zip(rover.inverse(twists, threads={threads}), expected):
            assert np.array_equal(one, other)
        assert np.array_equal(sw.integrate(twists.reshape(600, 100, 3), 0.1, threads={threads}), logs)
        arm, ground = sw.RockerBogie.preset("perseverance"), sw.Terrain(np.zeros((50, 50)), 0.1)
        poses = np.tile([2.5, 2.5, 0.1], (400, 1))
        assert arm.settle(ground, poses, threads={threads}).status[-1] == sw.SettleStatus.settled
        assert arm.feasible(ground, poses, threads={threads}).ok.all()
        bad = twists.copy()
        bad[30_000:] = np.nan
        try:
            rover.inverse(bad, threads={threads})
        except ValueError as error:
            print(error)
        """,
        RUST_MIN_STACK=str(2**40),
    )
    assert result.returncode == 0, result.stderr
    assert result.stdout.startswith("twist[30000] must be finite")


def test_four_thousand_threads_under_a_limit():
    result = limited(
        """
        import resource
        import numpy as np
        import six_wheel as sw
        rover = sw.Rover.preset("perseverance")
        resource.setrlimit(resource.RLIMIT_AS, (3 * 2**30,) * 2)
        print(rover.inverse(np.zeros((10**6, 3)), threads=4000)[0].shape)
        """
    )
    assert result.returncode == 0, result.stderr
    assert result.stdout == "(1000000, 4)\n"


def test_a_simulation_that_does_not_fit():
    result = limited(
        """
        import resource
        import six_wheel as sw
        car = sw.FourAxle((0.4, 0.3), 0.2, 0.1)
        plan = car.turn_sequence(sw.FourAxleState(), 0.1) if hasattr(car, "turn_sequence") else []
        step = sw.FourAxleStep("drive", 9.9e6, "locked", "locked", (0.0,) * 4, sw.FourAxleState())
        resource.setrlimit(resource.RLIMIT_AS, (2**30,) * 2)
        try:
            car.simulate([step], 1.0)
        except MemoryError as error:
            print(error)
        """
    )
    assert result.returncode == 0, result.stderr
    assert result.stdout.startswith("dt must leave few enough samples for the memory, got ")
