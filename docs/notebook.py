"""Writes tutorials/first.ipynb, the notebook of tutorials/wheels.md: its text, and its snippets to run."""

import json
import re
from pathlib import Path

TUTORIALS = Path(__file__).parent / "tutorials"


def cells(page: str) -> list[tuple[str, str]]:
    """Kind and text of each cell, in order."""
    found = []
    for number, part in enumerate(re.split(r"^```pycon\n(.*?)^```\n", page, flags=re.M | re.S)):
        if number % 2:
            # A cell shows its last line only: it ends where the page has an answer.
            code = re.sub(r"(?:^(?!>>>|\.\.\.).*\n)+", "\n\n", part, flags=re.M)
            pieces = [piece for piece in code.split("\n\n") if piece.strip()]
            found += [("code", re.sub(r"^(?:>>>|\.\.\.) ?", "", one, flags=re.M).strip()) for one in pieces]
        elif part.strip():
            found.append(("markdown", part.strip()))
    return found


def notebook(page: str) -> str:
    """The notebook of a page, as JSON of nbformat 4."""
    content = []
    for number, (kind, text) in enumerate(cells(page)):
        lines = text.splitlines(keepends=True)
        cell = {"cell_type": kind, "id": f"cell-{number}", "metadata": {}, "source": lines}
        content.append(cell | ({"execution_count": None, "outputs": []} if kind == "code" else {}))
    about = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}}
    whole = {"cells": content, "metadata": about, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    text = notebook((TUTORIALS / "wheels.md").read_text(encoding="utf-8"))
    (TUTORIALS / "first.ipynb").write_text(text, encoding="utf-8")
