"""Time and size of what a notebook shows of a result: `python benches/notebooks.py`.

A line for each class that shows itself: the median of the processor time of some bundles after a first one,
and the bytes of text and picture.
"""

import argparse
import statistics
import sys
import time
from pathlib import Path

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))  # the samples of the tests


def measured(rounds: int) -> list[tuple[str, float, int]]:
    """Class, median processor time of a bundle [ms] and its size [bytes]."""
    from tests.objects.samples import samples

    rows = []
    for name, one in sorted(samples().items()):
        if not hasattr(one, "_repr_mimebundle_"):
            continue
        times = []
        for _ in range(rounds + 1):
            begin = time.process_time()
            bundle = one._repr_mimebundle_()
            times.append(1e3 * (time.process_time() - begin))
        rows.append((name, statistics.median(times[1:]), sum(map(len, bundle.values()))))
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=9, help="bundles of each, after the first")
    rounds = parser.parse_args().rounds
    for name, milliseconds, size in measured(rounds):
        print(f"{name:<20} {milliseconds:7.1f} ms {size:8,} bytes")


if __name__ == "__main__":
    main()
