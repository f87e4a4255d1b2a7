"""Tutorials of logs: what they type in Python and then in a shell, in order, prints what they say."""

import doctest
import re
from pathlib import Path

import pytest

pytest.importorskip("pyarrow")
pytest.importorskip("scipy")
pytest.importorskip("rich")

from tests.cli_runs import Run

TUTORIALS = Path(__file__).parents[2] / "docs" / "tutorials"
COMMANDS = {"own_log": 6, "log": 3}  # blocks of commands


def joined(text: str) -> list[str]:
    """Lines with those that go on in the next one put together, every space once."""
    whole = re.sub(r"\\\n\s*", "", text)
    return [" ".join(line.split()) for line in whole.splitlines() if line.strip()]


@pytest.mark.parametrize("name", COMMANDS)
def test_what_the_page_types_prints_what_it_says(
    name: str, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Commands of a tutorial named a file that nobody had written, and left out what the encoders count."""
    path = TUTORIALS / f"{name}.md"
    page = path.read_text(encoding="utf-8")
    known: dict = {}
    snippet = doctest.DocTestParser().get_doctest(page, known, str(path), None, 0)
    flags = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
    doctest.DocTestRunner(optionflags=flags).run(snippet, clear_globs=False)
    monkeypatch.chdir(snippet.globs["folder"])
    monkeypatch.setenv("COLUMNS", "120")
    blocks = re.findall(r"```console\n(.*?)```", page, re.DOTALL)
    assert len(blocks) == COMMANDS[name]
    following = ""
    for block in blocks:
        command, *expected = joined(block)
        typed = command.removeprefix("$ six-wheel ")
        pasted = re.sub("COUNTS", "4096", following)
        assert not following or typed == pasted or "calibrate" in typed or "true.yaml" in typed
        words = re.findall(r'"[^"]*"|\S+', typed)
        code, out, said = run(*(word.strip('"') for word in words))
        assert (code, said) == (0, "")
        printed = joined(out)
        assert [line for line in expected if line not in printed] == []
        following = next((each.removeprefix("next: six-wheel ") for each in printed if "next:" in each), "")
