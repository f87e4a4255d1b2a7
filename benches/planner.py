"""Cost of a step of a rollout in a planner's cycle: noise, limits, steering, map, goal, weights, mean."""

import numpy as np

import six_wheel as sw
from six_wheel.cli.benchmark import Comparison, Grid, Timing, nanoseconds, round_robin

SIZES = ((2000, 56), (4096, 64))


def cycles():
    """A job for every size and precision, one contender a kernel, and one with two threads."""
    rover = sw.Rover.six_wheel(
        front_to_middle=0.5,
        middle_to_rear=0.5,
        track_width=0.8,
        middle_track_width=0.9,
        wheel_radius=0.15,
        steering_limit=1.2,
    )
    limits = sw.Limits(
        speed=1.5,
        yaw_rate=1.0,
        acceleration=2.0,
        angular_acceleration=3.0,
        wheel_speed=8.0,
        steering_rate=1.0,
    )
    hills = sw.Costmap(np.random.default_rng(9).random((500, 500)), 0.05)
    twist, goal = (0.5, 0.0, 0.1), (20.0, 14.0)
    now = {"twist": twist, "steering": rover.inverse(twist)[0], "costmap": hills, "goal": goal}
    jobs = []
    for samples, horizon in SIZES:
        for dtype in ("float64", "float32"):
            timings = {}
            for kernel, threads in (*((name, 1) for name in sw.simd_levels()[1:]), (sw.simd_levels()[-1], 2)):
                plan = sw.Mppi(rover, limits, horizon=horizon, samples=samples, dtype=dtype, correlation=0.0)
                how = {"level": kernel, "threads": threads}
                name = kernel if threads == 1 else "2 threads"
                steps = samples * horizon
                timings[name] = Timing.of(plan.step, (12.0, 11.0, 0.3), items=steps, **now, **how)
            jobs.append(Comparison(f"{samples} x {horizon}, {dtype}", timings))
    return jobs


def measured(rounds, progress=None):
    """The table."""
    jobs = cycles()
    round_robin(jobs, rounds, progress=progress)
    kernels = list(reversed(sw.simd_levels()[1:]))
    grid = Grid("A planner's cycle [ns per step of a rollout]", ["job", *kernels, "2 threads", "of one"])
    for job in jobs:
        shares = job.timings["2 threads"].best / job.timings[kernels[0]].best
        names = (*kernels, "2 threads")
        grid.rows.append(
            [job.name, *(nanoseconds(job.timings[name].best) for name in names), f"{shares:.2g}"]
        )
    grid.notes.append("Six wheels with a range of 1.2 rad and 1 rad/s, a map of 500 x 500 cells, a goal.")
    return grid
