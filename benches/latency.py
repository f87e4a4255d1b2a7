"""Longest time of one call: back to back, in a loop of 1 kHz, and with nothing of it in any cache."""

import gc
import re
import time
from pathlib import Path

import numpy as np
from contenders import ROVER, TWIST

PERIOD = 1e-3  # [s]
SHARES = {"p50": 0.5, "p99": 0.99, "p99.9": 0.999, "max": 1.0}
UNKNOWN_CACHE = 64 << 20


def last_cache():
    """Size of the largest cache [byte]; 64 MiB if the system does not say."""
    sizes = [UNKNOWN_CACHE // 2]
    for path in Path("/sys/devices/system/cpu/cpu0/cache").glob("index*/size"):
        number, unit = re.fullmatch(r"(\d+)([KM]?)", path.read_text().strip()).groups()
        sizes.append(int(number) << {"": 0, "K": 10, "M": 20}[unit])
    return max(sizes)


def latencies(call, ticks, *, period=0.0, flush=None):
    """Nanoseconds of each of `ticks` calls, without the cost of looking at the clock."""
    clock = time.perf_counter_ns
    empty = min(-clock() + clock() for _ in range(1000))
    taken = np.empty(ticks, dtype=np.int64)
    enabled = gc.isenabled()
    gc.disable()
    try:
        for _ in range(100):
            call()
        for tick in range(ticks):
            if flush is not None:
                flush()
            if period:
                time.sleep(period)
            begin = clock()
            call()
            taken[tick] = clock() - begin
    finally:
        if enabled:
            gc.enable()
    return np.maximum(taken - empty, 0)


def walk():
    """A function that reads one word of every line of memory larger than the last cache."""
    lines = np.ones(last_cache() * 5 // 4 // 8)[::8]
    return lines.sum


def distributions(ticks):
    """Job and manner to its percentiles [ns]."""
    steering, speeds = ROVER.inverse(TWIST)
    joints, back = (np.empty(4), np.empty(6)), np.empty(3)
    jobs = {
        "inverse, out=": lambda: ROVER.inverse(TWIST, out=joints),
        "forward, out=": lambda: ROVER.forward(steering, speeds, out=back),
        "nothing": lambda: None,
    }
    manners = {
        "back to back": {},
        "1 kHz": {"period": PERIOD},
        "1 kHz, caches flushed": {"period": PERIOD, "flush": walk()},
    }
    return {
        (job, manner): {
            share: float(np.quantile(taken, part, method="higher")) for share, part in SHARES.items()
        }
        for manner, options in manners.items()
        for job, call in jobs.items()
        for taken in [latencies(call, 10 * ticks if not options else ticks, **options)]
    }
