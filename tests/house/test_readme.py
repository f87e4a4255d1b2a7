"""The README's commands and snippets run."""

import re
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
SNIPPETS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


def test_the_two_commands_come_first():
    first = README.split("```")[0]
    assert first.index("make demo") < first.index("make test")


@pytest.mark.parametrize("snippet", SNIPPETS)
def test_snippets_run(snippet, capsys):
    exec(compile(snippet, "README.md", "exec"), {})


def test_the_first_snippet_says_what_it_does():
    names: dict[str, object] = {}
    exec(compile(SNIPPETS[0], "README.md", "exec"), names)
    np.testing.assert_allclose(names["twist"], (0.04, 0.0, 0.02), rtol=0, atol=1e-15)
    np.testing.assert_array_equal(names["nearest"], (0.04, 0.0, 0.0))


def test_what_it_links_to_is_there():
    links = re.findall(r"\]\(([^)#]+)\)", README)
    assert links
    for link in links:
        assert (ROOT / link).exists(), link


def test_figures_are_those_of_the_page_they_link_to():
    """The page has the goals beside them, met or missed."""
    page = (ROOT / "docs/explanation/performance.md").read_text(encoding="utf-8")
    times = re.findall(r"^\| .* \| ([\d.]+) ns \|$", README, re.MULTILINE)
    assert len(times) == 5
    for time in times:
        assert re.search(rf"^\|.* {time}[ ,].*\|", page, re.MULTILINE), time
