"""Every level against the scalar one over many rows: ``python -m tests.core.oracles.compare --rows 1e9``.

A row is a row of one call at one level, compared number by number with that of the scalar level.
Errors are shares of what is allowed, as in `test_batch`: 5 ulp of the number or of what was summed, or 1e-14;
for `forward` times the condition number of the wheels' rows where more is needed, for rollouts an ulp of the
way for every step. The report names the worst row of each call.
"""

import argparse
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

import six_wheel as sw
from tests.core.oracles.test_batch import KERNELS, ROVERS, possible, random_twists

BLOCK, STEPS = 100_000, 50
Array = np.ndarray


@dataclass
class Worst:
    """Rows compared by one call, and the row with the largest error."""

    rows: int = 0
    share: float = 0.0
    error: float = 0.0
    where: str = "nowhere"
    different: int = 0
    kernels: set[str] = field(default_factory=set)

    def __str__(self) -> str:
        said = f"{self.rows:.3g} rows, worst {self.share:.3f} of the allowed ({self.error:.2e})"
        return f"{said} {self.where}; {self.different} beyond" if self.rows else "no rows"


def shares(
    found: Array, expected: Array, scale: Array | float = 0.0, condition: Array | float = 1.0
) -> Array:
    """Error of every row as a share of what is allowed; infinite where only one of both is NaN."""
    with np.errstate(invalid="ignore", over="ignore"):
        allowed = np.maximum(5 * np.spacing(np.maximum(np.abs(expected), scale)), 1e-14) * condition
        share = np.abs(found - expected) / allowed
    same = (found == expected) | (np.isnan(found) & np.isnan(expected))
    return np.where(same, 0.0, np.where(np.isfinite(share), share, np.inf)).max(axis=1, initial=0.0)


def readings(generator: np.random.Generator, rover: sw.Rover) -> tuple[Array, Array]:
    """Steering angles and speeds: mostly ordinary, some of any size there is."""
    steering = generator.normal(size=(BLOCK, len(rover.steered_wheel_names))) * 2
    speeds = generator.normal(size=(BLOCK, len(rover.wheels))) * 10
    odd = generator.random(BLOCK) < 0.1
    speeds[odd] *= 10.0 ** generator.uniform(-320, 300, (int(odd.sum()), 1))
    steering[odd] *= 10.0 ** generator.uniform(-320, 300, (int(odd.sum()), 1))
    speeds[generator.random(speeds.shape) < 0.05] = 0.0
    return steering, speeds


def condition(rover: sw.Rover, steering: Array, speeds: Array) -> Array:
    """Largest singular value that such rows can have over the smallest that these have."""
    largest = math.sqrt(sum(2.0 * (1.0 + wheel.x**2 + wheel.y**2) for wheel in rover.wheels))
    return np.maximum(largest / rover.fit(steering, speeds).sigma_min, 1.0)


def compared(generator: np.random.Generator, name: str) -> Iterator[tuple[str, str, Array, Array, Array]]:
    """Call, kernel, shares, errors and inputs of a block of rows of one rover."""
    rover = ROVERS[name]
    twists = possible(rover, random_twists(generator, BLOCK))
    steering, speeds = readings(generator, rover)
    previous = generator.normal(size=(len(twists), len(rover.steered_wheel_names)))
    controls = np.clip(random_twists(generator, BLOCK), -1e3, 1e3).reshape(-1, STEPS, 3)
    each = {
        "inverse": (twists, lambda kernel: np.hstack(rover.inverse(twists, level=kernel))),
        "inverse, previous": (
            np.hstack([twists, previous]),
            lambda kernel: np.hstack(rover.inverse(twists, previous=previous, level=kernel)),
        ),
        "forward": (
            np.hstack([steering, speeds]),
            lambda kernel: rover.forward(steering, speeds, level=kernel),
        ),
        "rollout": (
            controls.reshape(-1, 3),
            lambda kernel: sw.rollout(controls, 0.1, level=kernel)[:, 1:].reshape(-1, 3),
        ),
    }
    fastest = np.abs(speeds).max(axis=1, keepdims=True) * max(wheel.radius for wheel in rover.wheels)
    # Both round at every step: as many ulp of the way.
    way = 0.1 * np.cumsum(np.abs(controls).max(axis=2), axis=1) * np.maximum(np.arange(1, STEPS + 1) / 5, 1.0)
    scales = {"forward": fastest * len(rover.wheels), "rollout": way.reshape(-1, 1)}
    for call, (inputs, ask) in each.items():
        expected, scale = ask("scalar"), scales.get(call, np.zeros((len(inputs), 1)))
        for kernel in KERNELS:
            found = ask(kernel)
            share = shares(found, expected, scale)
            far = share > 1.0
            if call == "forward" and far.any():  # only there what the condition allows is asked for
                allowed = condition(rover, steering[far], speeds[far])[:, None]
                share[far] = shares(found[far], expected[far], scale[far], allowed)
            yield call, kernel, share, np.abs(found - expected).max(axis=1, initial=0.0), inputs


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=float, default=1e7, help="so many rows in all")
    parser.add_argument("--seconds", type=float, default=math.inf, help="but no longer than this")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    worst: dict[str, Worst] = {}
    done, block, start = 0, 0, time.monotonic()
    names = list(ROVERS)
    while done < options.rows and time.monotonic() - start < options.seconds:
        name = names[block % len(names)]
        for call, kernel, share, error, inputs in compared(
            np.random.default_rng([options.seed, block]), name
        ):
            one = worst.setdefault(call, Worst())
            one.rows += len(share)
            one.kernels.add(kernel)
            one.different += int((share > 1.0).sum())
            done += len(share)
            if len(share) and share.max() > one.share:
                k = int(share.argmax())
                one.share, one.error = float(share[k]), float(error[k])
                one.where = f"by {kernel} on {name!r} for {inputs[k].tolist()}"
        block += 1
    took = f"in {time.monotonic() - start:.0f} s, {', '.join(KERNELS)}, seed {options.seed}"
    print(f"{done:.4g} of {options.rows:.3g} rows {took}")
    for call, one in worst.items():
        print(f"{call}: {one}")
    if any(one.different for one in worst.values()):
        raise SystemExit(1)


if __name__ == "__main__":
    main()
