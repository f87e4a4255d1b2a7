"""The classes of all forms: `python -m tests.logs.loggers` prints what is not right at first or pasted."""

import sys
import tempfile
from collections import Counter
from pathlib import Path

from tests.logs.judging import CLASSES, judge
from tests.logs.loggers import boards, clocks, memory, middleware, motors, office, published
from tests.logs.loggers.logged import Logged

FAR = 0.15  # [m], [rad] at the end of some 14 m: counts, and rows that were left out
GROUPS = (
    boards.prints,
    boards.counters,
    boards.pulses,
    middleware.ros1,
    middleware.ros2,
    middleware.wide,
    office.spreadsheets,
    office.matlab,
    office.labview,
    motors.controllers,
    motors.rates,
    motors.vehicles,
    clocks.stamps,
    clocks.satellites,
    clocks.zones,
    clocks.orders,
    published.layouts,
    published.languages,
    published.containers,
    memory.frames,
    memory.arrays,
    memory.units,
)


def forms() -> list[Logged]:
    """All forms, each with a name of its own."""
    return [form for group in GROUPS for form in group()]


def verdict(form: Logged) -> tuple[str, str]:
    """The class of a form, and what was said."""
    with tempfile.TemporaryDirectory() as folder:
        return judge(form, form.write(Path(folder)), FAR)


def main() -> int:
    """Count the classes; 1 if a form was wrong in silence or ended in a traceback."""
    found: Counter[str] = Counter()
    made = [form for form in forms() if not sys.argv[1:] or any(word in form.name for word in sys.argv[1:])]
    for form in made:
        name, said = verdict(form)
        found[name] += 1
        if name in CLASSES[2:] or sys.argv[1:]:
            print(f"{name:10} {form.name}: {said[:900]}")
    print(", ".join(f"{name} {found[name]}" for name in CLASSES), f"of {len(made)}")
    knowable = len(made) - sum(not form.knowable for form in made)
    print(f"right or pasted of those that can be known: {(found['right'] + found['pasted']) / knowable:.1%}")
    return int(bool(found["silent"] or found["traceback"]))


if __name__ == "__main__":
    sys.exit(main())
