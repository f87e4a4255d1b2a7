"""Random numbers from counters, the same wherever they are asked for."""

import math
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from six_wheel.reference.planar.geometry import Floats

Words: TypeAlias = NDArray[np.uint64]


def philox(seed: int, counters: Words, rounds: int = 7) -> Words:
    """Philox4x32 of counters (..., 4), Salmon et al., SC 2011: four words of 32 bits each, as uint64."""
    x0, x1, x2, x3 = (counters[..., k].astype(np.uint64) for k in range(4))
    low, half = np.uint64(0xFFFFFFFF), np.uint64(32)
    keys = [seed & 0xFFFFFFFF, seed >> 32]
    for _ in range(rounds):
        a, b = x0 * np.uint64(0xD2511F53), x2 * np.uint64(0xCD9E8D57)
        x0, x1, x2, x3 = (
            (b >> half) ^ x1 ^ np.uint64(keys[0]),
            b & low,
            (a >> half) ^ x3 ^ np.uint64(keys[1]),
            a & low,
        )
        keys = [(keys[0] + 0x9E3779B9) & 0xFFFFFFFF, (keys[1] + 0xBB67AE85) & 0xFFFFFFFF]
    return np.stack([x0, x1, x2, x3], axis=-1)


def normals(seed: int, cycle: int, rollouts: int, steps: int, components: int) -> Floats:
    """Normal noise (rollouts, steps, components), by Box and Muller from the words of counters."""
    quads = -(-steps * components // 4)
    counters = np.zeros((rollouts, quads, 4), np.uint64)
    counters[..., 0] = np.arange(rollouts)[:, None]
    counters[..., 1] = np.arange(quads)
    counters[..., 2] = cycle
    words = philox(seed, counters).reshape(rollouts, -1)
    a, b = words[:, 0::2], words[:, 1::2]
    uniform = (a >> np.uint64(9)).astype(float) * 2.0**-23 + 2.0**-24
    radius = np.sqrt(-2.0 * np.log(uniform))
    # Within an eighth of a turn of an axis; one bit says which axis, one which side of it.
    angle = (((b << np.uint64(2)) & np.uint64(0xFFFFFFFF)) >> np.uint64(9)).astype(float) * 2.0**-23 - 0.5
    sine, cosine = np.sin(angle * math.pi / 2), np.cos(angle * math.pi / 2)
    swap, side = (b >> np.uint64(30)) & np.uint64(1), np.where(b >> np.uint64(31), -1.0, 1.0)
    first, second = np.where(swap, cosine, sine), np.where(swap, sine, cosine)
    pairs = np.stack([side * radius * first, side * radius * second], axis=-1)
    return pairs.reshape(rollouts, -1)[:, : steps * components].reshape(rollouts, steps, components)
