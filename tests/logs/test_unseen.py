"""Logs in forms drawn at random are read right or doubted; `python -m tests.logs.unseen` draws more."""

import tempfile
from pathlib import Path

import pytest

pytest.importorskip("pyarrow")
pytest.importorskip("pandas")
pytest.importorskip("rosbags.rosbag2")

from tests.logs.judging import judge
from tests.logs.unseen.__main__ import FAR, make


@pytest.mark.parametrize("seed", range(5000, 5040))
def test_no_form_is_wrong_in_silence_or_refused_without_help(seed: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        form, source = make(seed, Path(folder))
        verdict, said = judge(form, source, FAR)
    assert verdict in ("right", "pasted", "helpful"), f"{form.drawn}: {said}"
