"""The worked examples typed again, in an empty folder."""

import doctest
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "tutorials" / "worked_examples.md"
LOOSE = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@dataclass
class Typed:
    """A line, or lines of Python, at a line of the page, and the answer."""

    line: int
    text: str
    answer: list[str] = field(default_factory=list)


def typed() -> Iterator[Typed]:
    """Input of the page: shell lines, and each block of Python as one."""
    inside, one = False, None
    for number, line in enumerate(PAGE.read_text(encoding="utf-8").splitlines(), 1):
        if line.startswith("```"):
            inside, one = line == "```console", (yield from _done(one))
        elif not inside:
            continue
        elif line.startswith("$ "):
            yield from _done(one)
            one = Typed(number, line[2:])
        elif one is None:
            one = Typed(number, line + "\n")
        elif one.text.startswith(">>>"):
            one.text += line + "\n"
        else:
            one.answer.append(line)


def _done(one: Typed | None) -> Iterator[Typed]:
    if one is not None:
        yield one


SESSION = list(typed())


def test_the_page_has_five_examples():
    heads = re.findall(r"^## (.*)$", PAGE.read_text(encoding="utf-8"), re.M)
    assert len(heads) == 5
    assert len(SESSION) > 15


def shell(one: Typed, folder: Path, python: str) -> None:
    words = shlex.split(one.text)
    assert words[0] == "six-wheel", f"line {one.line} of {PAGE.name}"
    done = subprocess.run(
        [python, "-m", "six_wheel", *words[1:]], cwd=folder, capture_output=True, text=True, timeout=120,
        env={**os.environ, "COLUMNS": "160"},
    )  # fmt: skip
    assert done.returncode == 0, f"line {one.line} of {PAGE.name}: {done.stderr}"
    want = "\n".join(one.answer) + "\n"
    got = done.stdout or "\n"
    assert doctest.OutputChecker().check_output(want, got, LOOSE), f"line {one.line} of {PAGE.name}:\n{got}"


def test_the_examples_in_an_empty_folder(tmp_path, monkeypatch):
    for needed in ("typer", "yaml", "matplotlib", "scipy", "rich", "pyarrow", "pydantic"):
        pytest.importorskip(needed)
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for one in SESSION[3:]:  # packages that install others come first
        if not one.text.startswith(">>>"):
            shell(one, tmp_path, sys.executable)
            continue
        test = doctest.DocTestParser().get_doctest(one.text, names, PAGE.name, str(PAGE), one.line - 1)
        report: list[str] = []
        runner = doctest.DocTestRunner(verbose=False, optionflags=LOOSE)
        result = runner.run(test, out=report.append, clear_globs=False)
        names = test.globs
        assert result.failed == 0, "".join(report)
