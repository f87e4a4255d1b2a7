"""``python -m tests.maps.unseen [SEED]`` counts the classes of all forms and prints those not right."""

import itertools
import sys
import tempfile
import warnings
from pathlib import Path

from tests.maps.unseen import arrays, damaged, grids, images, labelled, lists, oddities
from tests.maps.unseen.case import CLASSES, Case, classify


def every(seed: int) -> list[Case]:
    """All forms; those that are drawn by this seed."""
    written = [each.every() for each in (grids, lists, damaged, arrays, labelled, oddities)]
    return [*images.containers(), *images.drawn(150, seed), *itertools.chain(*written)]


def count(cases: list[Case], folder: Path) -> dict[str, list[str]]:
    """Names and words of the cases in each class."""
    found: dict[str, list[str]] = {kind: [] for kind in CLASSES}
    for number, case in enumerate(cases):
        place = folder / str(number)
        place.mkdir()
        kind, words = classify(case, place)
        found[kind].append(f"{case.name}: {words[:600]}" + ("" if case.knowable else " (not knowable)"))
    return found


if __name__ == "__main__":
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        cases = every(seed)
        found = count(cases, Path(folder))
    for kind in CLASSES[2:]:
        for line in found[kind]:
            print(f"{kind:12}{line}")
    known = sum(case.knowable for case in cases)
    print({kind: len(names) for kind, names in found.items()}, len(cases), "forms,", known, "knowable")
