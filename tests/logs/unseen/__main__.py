"""Logs in forms drawn at random, with known truth, counted by how they are read.

A form is a drive, a rover, readings, stamps, headers, rows and a container, each drawn by itself. What a
refusal proposes is pasted as a user would: its Python words, with the counts of a turn for COUNTS.
`python -m tests.logs.unseen 400 --seed 1` prints whatever was wrong in silence, a traceback or of no help,
and the number of each class.
"""

import argparse
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from tests.logs.judging import CLASSES, judge
from tests.logs.unseen.containers import CONTAINERS, DATA_SETS, bag
from tests.logs.unseen.drawn import ROVERS, Form, drive, readings, rows, stamps

FAR = 0.1  # [m], [rad] at the end of some 10 m


def make(seed: int, folder: Path) -> tuple[Form, Any]:
    """A form and the log in it."""
    random = np.random.default_rng(seed)
    vehicle = str(random.choice(list(ROVERS), p=[0.45, 0.2, 0.15, 0.2]))
    rover = ROVERS[vehicle]
    form = Form(random, rover, *drive(random, rover), drawn=[vehicle])
    if random.random() < 0.12:
        return form, bag(form, folder)
    if vehicle in DATA_SETS and random.random() < 0.15:
        return form, DATA_SETS[vehicle](form, folder)
    readings(form)
    stamps(form)
    rows(form)
    return form, CONTAINERS[form.choose(*CONTAINERS)](form, folder)


def is_slower_drive(form: Form) -> bool:
    """True for turns under bare names in memory: to the last digit the log of a slower drive in radians."""
    return {"rev", "bare"} <= {*form.drawn} and not {"pandas", "arrow", "dict"}.isdisjoint(form.drawn)


def main(arguments: list[str] | None = None) -> int:
    """Count the classes of many forms; 1 if one was wrong in silence or ended in a traceback."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("forms", type=int, nargs="?", default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--all", action="store_true", help="print every form that was not right at first")
    given = parser.parse_args(arguments)
    found: Counter[str] = Counter()
    for seed in range(1000 * given.seed, 1000 * given.seed + given.forms):
        with tempfile.TemporaryDirectory() as folder:
            form, source = make(seed, Path(folder))
            verdict, said = judge(form, source, FAR)
        if verdict == "silent" and is_slower_drive(form):
            verdict = "as a slower drive"
        found[verdict] += 1
        if verdict in CLASSES[3:] or (given.all and verdict != "right"):
            print(f"{verdict:10} {seed} {', '.join(form.drawn)}: {said[:700]}")
    print(", ".join(f"{name} {found[name]}" for name in (*CLASSES, "as a slower drive")), f"of {given.forms}")
    knowable = given.forms - found["helpful"]
    print(f"right or pasted of those that can be known: {(found['right'] + found['pasted']) / knowable:.1%}")
    return int(bool(found["silent"] or found["traceback"]))


if __name__ == "__main__":
    sys.exit(main())
