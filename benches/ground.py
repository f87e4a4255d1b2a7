"""The ground: settling, bounds, motion and traction of Perseverance, beside their goals."""

import math

import numpy as np

import six_wheel as sw
from six_wheel.cli.benchmark import Comparison, Grid, Timing, round_robin

SIZE = 40.0
POSES = 10_000

# Nanoseconds per pose with AVX-512, one thread: settling on hills, among rocks at 10 and at 20 % cover.
SETTLE = {0.1: (1_500, 2_600, 3_100), 0.05: (2_100, 4_000, 4_700)}
ONE_CALL = {0.1: 5_000, 0.05: 7_000}
BOUNDS = {0.1: 280, 0.05: 400}
MOTION, TRACTION, TRACTION_CALL = 75, 45, 260


def grounds(spacing):
    """Smooth hills, and yards with rocks."""
    x = spacing * np.arange(round(SIZE / spacing) + 1)
    hills = 0.12 * np.sin(0.55 * x + 0.3) * np.cos(0.43 * x[:, None])
    hills = hills + 0.025 * np.sin(2.9 * x + 1.6 * x[:, None])
    yards = {f"{cover:.0%}": sw.Terrain.yard(SIZE, spacing, cover=cover, seed=11) for cover in (0.1, 0.2)}
    return {"hills": sw.Terrain(hills, spacing)} | yards


def listed(count):
    """Every job with its timing and its goal."""
    random = np.random.default_rng(3)
    arm = sw.RockerBogie.preset("perseverance")
    poses = random.uniform([3, 3, -math.pi], [SIZE - 3, SIZE - 3, math.pi], (count, 3))
    one = tuple(poses[0])
    jobs = []

    def add(name, goal, function, *arguments, items=count):
        jobs.append((name, goal, Timing.of(function, *arguments, items=items)))

    for spacing, goals in SETTLE.items():
        made = grounds(spacing)
        for (name, ground), goal in zip(made.items(), goals, strict=True):
            where = f"{name}, {spacing:g} m"
            add(f"settle, {where}", goal, arm.settle, ground, poses)
            add(f"settle, one call, {where}", ONE_CALL[spacing], arm.settle, ground, one, items=1)
        add(f"bounds, 10%, {spacing:g} m", BOUNDS[spacing], arm.bounds, made["10%"], poses)
    stand = arm.settle(made["10%"], poses)
    motion = np.column_stack([np.full(count, 0.04), random.uniform(-0.02, 0.02, count)])
    steering, speeds = arm.inverse(stand, motion)
    add("inverse on the ground", MOTION, arm.inverse, stand, motion)
    add("forward on the ground", MOTION, arm.forward, stand, steering, speeds)
    rates = random.uniform(-0.15, 0.15, (4, count, 3))
    curvature = motion[:, 1] / motion[:, 0]
    add("traction", TRACTION, arm.traction, motion[:, 0], curvature, *rates[:3])
    row = [tuple(rate[0]) for rate in rates[:3]]
    add("traction, one call", TRACTION_CALL, arm.traction, 0.04, 0.1, *row, items=1)
    return jobs


def measured(rounds=10, progress=None, count=POSES):
    """The table."""
    jobs = listed(count)
    timings = {name: timing for name, _, timing in jobs}
    round_robin([Comparison("ground", timings)], rounds, progress=progress)
    grid = Grid("The ground, Perseverance [ns per item], one thread", ["job", "core", "goal", ""])
    for name, goal, _ in jobs:
        taken = 1e9 * timings[name].best
        grid.rows.append(
            [name, f"{taken:,.0f}", f"{goal:,}", "reached" if taken <= goal else f"{taken / goal:.2g} x"]
        )
    grid.notes.append(
        f"{count:,} poses a batch, objects made as in every call. Goals: 1.3 times hand-written C for one "
        "rover without stops, steering or unknown ground, on an Intel processor with AVX-512."
    )
    return grid
