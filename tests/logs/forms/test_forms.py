"""Logs as they come: each form is read right, or refused with what settles it; none is wrong in silence."""

from collections import Counter
from pathlib import Path

import pytest

pytest.importorskip("pyarrow")
pytest.importorskip("rosbags.rosbag2")

from tests.logs.forms import bags, counts, memory, recorders, text
from tests.logs.forms.form import judge

GROUPS = (
    text.stamps,
    text.layout,
    text.units,
    counts.counts,
    counts.rows,
    counts.vehicles,
    counts.containers,
    memory.memory,
    bags.bags,
    recorders.clocks,
    recorders.names,
    recorders.readings,
    recorders.frames,
)
FORMS = [form for group in GROUPS for form in group()]


@pytest.fixture(scope="module")
def verdicts(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[str, str]]:
    return {f"{f.group}: {f.name}": judge(f, tmp_path_factory.mktemp("form")) for f in FORMS}


def test_there_are_150_forms_with_names_of_their_own() -> None:
    assert len({(form.group, form.name) for form in FORMS}) == len(FORMS) >= 150


@pytest.mark.parametrize("bad", ["silent", "traceback"])
def test_no_form_is_wrong_in_silence(verdicts: dict[str, tuple[str, str]], bad: str) -> None:
    assert {name: said for name, (verdict, said) in verdicts.items() if verdict == bad} == {}


def test_most_forms_are_read_right_at_first_or_as_proposed(verdicts: dict[str, tuple[str, str]]) -> None:
    found = Counter(verdict for verdict, _ in verdicts.values())
    unhelpful = {name: said for name, (verdict, said) in verdicts.items() if verdict == "unhelpful"}
    assert len(unhelpful) <= 0.05 * len(verdicts), unhelpful
    assert found["right"] + found["proposed"] >= 0.8 * len(verdicts), found


def test_what_is_said_is_one_line(verdicts: dict[str, tuple[str, str]]) -> None:
    assert not any("\n" in said for _, said in verdicts.values())


def run(folder: Path) -> Counter[str]:
    """The classes of all forms, printed with what is wrong."""
    found: Counter[str] = Counter()
    for number, form in enumerate(FORMS):
        place = folder / str(number)
        place.mkdir(parents=True)
        verdict, said = judge(form, place)
        found[verdict] += 1
        if verdict not in ("right", "proposed"):
            print(f"{verdict:10} {form.group}: {form.name}: {said[:400]}")
    return found
