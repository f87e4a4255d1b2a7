"""Forms of logs as ten kinds of loggers write them are read right or doubted; what cannot be told is so."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pyarrow")
pytest.importorskip("pandas")

import six_wheel as sw
from tests.logs.judging import read_and_compare
from tests.logs.loggers.__main__ import FAR, forms, verdict
from tests.logs.loggers.memory import impossible

FORMS = forms()


@pytest.fixture(scope="module")
def verdicts() -> dict[str, tuple[str, str]]:
    return {form.name: verdict(form) for form in FORMS}


def test_there_are_340_forms_with_names_of_their_own() -> None:
    assert len({form.name for form in FORMS}) == len(FORMS) >= 340


@pytest.mark.slow
@pytest.mark.parametrize("bad", ["silent", "traceback"])
def test_no_form_is_wrong_in_silence(verdicts: dict[str, tuple[str, str]], bad: str) -> None:
    assert {name: said for name, (found, said) in verdicts.items() if found == bad} == {}


@pytest.mark.slow
def test_four_of_five_that_can_be_known_are_read_right_at_first_or_as_proposed(
    verdicts: dict[str, tuple[str, str]],
) -> None:
    found = Counter(verdict for verdict, _ in verdicts.values())
    unhelpful = {name: said for name, (verdict, said) in verdicts.items() if verdict == "unhelpful"}
    assert len(unhelpful) <= 0.05 * len(FORMS), unhelpful
    assert found["right"] + found["pasted"] >= 0.8 * sum(form.knowable for form in FORMS), found


@pytest.mark.parametrize(("form", "other"), list(impossible()), ids=lambda each: getattr(each, "name", ""))
def test_what_cannot_be_told_is_the_log_of_another_drive(form, other, tmp_path: Path) -> None:
    """No reader can doubt it without doubting that drive; `docs/howto/logs.md` names these forms."""
    source = form.write(tmp_path)

    def read() -> tuple[np.ndarray, list[str]]:
        if isinstance(source, Path):
            from six_wheel.log_odometry import reckon

            result = reckon(form.rover, source)
            return result.pose, result.warnings
        given = source if isinstance(source, tuple) else (source,)
        return sw.dead_reckon(form.rover, *given).poses[-1], []

    assert read_and_compare(read, other.pose, FAR) == ("right", "")
