"""Logs in forms drawn at random, with known truth, counted by how they are read.

A form is a drive, a rover, readings, stamps, headers, rows and a container, each drawn by itself. What a
refusal proposes is pasted as a user would: its Python words, with the counts of a turn for COUNTS.
`python -m tests.logs.unseen 400 --seed 1` prints whatever was wrong in silence, a traceback or of no help,
and the number of each class.
"""

import argparse
import re
import sys
import tempfile
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

import six_wheel as sw
from six_wheel.log_odometry import ReckonSettings, reckon
from six_wheel.logs import LogOptions
from tests.logs.unseen.containers import CONTAINERS, DATA_SETS, bag
from tests.logs.unseen.drawn import COUNTS, ROVERS, Form, drive, readings, rows, stamps

FAR = 0.1  # [m], [rad] at the end of some 10 m
PASTED = re.compile(r"parameter file, or (.+?) in Python")
CLASSES = ("right", "pasted", "helpful", "unhelpful", "silent", "traceback")


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


def attempt(form: Form, source: Any, options: dict[str, Any]) -> tuple[str, str]:
    """Read the log: right, doubted, refused, silent or traceback; and what was said."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            if isinstance(source, Path):
                bound = {"max_speed": options["max_speed"]} if "max_speed" in options else {}
                settings = ReckonSettings(options=bound)
                given = {"wheel_encoders": options["wheel_encoders"]} if "wheel_encoders" in options else {}
                if options.get("increments"):
                    given = {"wheel_encoders": {"ticks_per_turn": COUNTS, "increments": True}}
                log = LogOptions(
                    **{key: value for key, value in options.items() if key != "increments"} | given
                )
                result = reckon(form.rover, source, log_options=log, settings=settings)
                pose, lines = result.pose, list(result.warnings)
            else:
                pose, lines = sw.dead_reckon(form.rover, source, **options).poses[-1], []
        except ValueError as error:
            return "refused", str(error)
        except Exception as error:
            return "traceback", repr(error)
    said = "; ".join([*lines, *(str(each.message) for each in caught)])
    off = np.asarray(pose) - form.pose
    off[2] = np.angle(np.exp(1j * off[2]))
    if np.hypot(*off[:2]) < FAR and abs(off[2]) < FAR:
        return "right", said
    return (
        "doubted" if PASTED.search(said) or "?" in said or "the path misses" in said else "silent"
    ), f"{said} {off.round(2)}"


def paste(form: Form, said: str, options: dict[str, Any]) -> dict[str, Any] | None:
    """Options a message proposes, or the one it names, filled in by its owner; None if nothing is new."""
    found: dict[str, Any] = {}
    for proposal in PASTED.findall(said)[:1]:
        words = proposal.replace("COUNTS", str(form.owner.get("COUNTS", 0)))
        found = eval(f"dict({words})", {"Encoder": sw.Encoder, "dict": dict})  # as a user would run it
    for name in ("columns", "topics", "stamp_unit", "increments"):
        if (
            name not in found
            and name in form.owner
            and re.search(rf"\b{name}\b|--{name.replace('_', '-')}", said)
        ):
            found[name] = form.owner[name]
    if "columns" in found and isinstance(form.owner.get("columns"), list):
        found["columns"] = form.owner["columns"]  # names for NAME
    elif isinstance(found.get("columns"), dict) and isinstance(form.owner.get("columns"), dict):
        columns = {**options.get("columns", {}), **found["columns"], **form.owner["columns"]}
        found["columns"] = {head: meaning for head, meaning in columns.items() if head in form.columns}
    merged = {**options, **found}
    return None if not found or repr(merged) == repr(options) else merged


def judge(form: Form, source: Any) -> tuple[str, str]:
    """The class of a form, and what was said."""
    options: dict[str, Any] = {}
    told = ""
    for step in range(5):
        verdict, said = attempt(form, source, options)
        told = f"{told} THEN {said}" if told else said
        if verdict == "right":
            return ("pasted" if step else "right"), told
        if verdict in ("silent", "traceback"):
            return verdict, f"{told} ({options})"
        more = paste(form, said, options)
        if more is None:
            break
        options = more
    return ("helpful" if not form.knowable or verdict == "doubted" else "unhelpful"), f"{told} ({options})"


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
            verdict, said = judge(form, source)
        found[verdict] += 1
        if verdict in CLASSES[3:] or (given.all and verdict != "right"):
            print(f"{verdict:10} {seed} {', '.join(form.drawn)}: {said[:700]}")
    print(", ".join(f"{name} {found[name]}" for name in CLASSES), f"of {given.forms}")
    knowable = given.forms - found["helpful"]
    print(f"right or pasted of those that can be known: {(found['right'] + found['pasted']) / knowable:.1%}")
    return int(bool(found["silent"] or found["traceback"]))


if __name__ == "__main__":
    sys.exit(main())
