"""Settled poses against their bounds, as many as asked for.

python -m tests.core.ground.holding 1e8 [--seconds 900]

Yards of four covers of rocks in turn, each with a seed of its own; totals per cover, or the first yard on
which a pose is outside.
"""

import argparse
import time

import numpy as np

import six_wheel as sw

from .test_bounds import outside, rovers, some

COVERS = (0.05, 0.1, 0.15, 0.2)
YARD = 20_000  # poses on each


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("poses", type=float, help="settled poses with known bounds to compare")
    parser.add_argument("--rover", default="perseverance", choices=rovers())
    parser.add_argument("--seconds", type=float, default=float("inf"), help="to stop after")
    parser.add_argument("--seed", type=int, default=1000, help="of the first yard")
    options = parser.parse_args()
    rover, began, seed = rovers()[options.rover], time.monotonic(), options.seed
    tried, compared = np.zeros(len(COVERS), int), np.zeros(len(COVERS), int)
    while compared.sum() < options.poses and time.monotonic() - began < options.seconds:
        which = (seed - options.seed) % len(COVERS)
        ground = sw.Terrain.yard(40, 0.1, COVERS[which], seed=seed)
        wrong, known, _ = outside(rover, ground, some(ground, YARD, seed))
        if wrong:
            print(f"{wrong} outside: {options.rover}, Terrain.yard(40, 0.1, {COVERS[which]}, seed={seed})")
            return 1
        tried[which] += YARD
        compared[which] += known
        seed += 1
        print(f"\r{compared.sum():,} of {options.poses:,.0f}", end="", flush=True)
    print(f"\n{options.rover}: {compared.sum():,} compared, 0 outside, {time.monotonic() - began:,.0f} s")
    for cover, poses, known in zip(COVERS, tried, compared, strict=True):
        print(f"{cover:.0%}: {poses:,} poses, {known:,} compared")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
