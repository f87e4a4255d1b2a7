"""Writes the notebooks of tutorials/: the text of a page, and its snippets to run."""

import json
import re
from pathlib import Path

TUTORIALS = Path(__file__).parent / "tutorials"
NOTEBOOKS = {"first": "wheels", "log": "log", "rocks": "rocks"}  # and the page that each is made of


def cells(page: str) -> list[tuple[str, str]]:
    """Kind and text of each cell, in order."""
    page = re.sub(r"^The same \[as a notebook\].*\n\n", "", page, flags=re.M)
    found = []
    for number, part in enumerate(re.split(r"^```pycon\n(.*?)^```\n", page, flags=re.M | re.S)):
        if number % 2:
            # A cell shows its last line only: it ends where the page has an answer.
            code = re.sub(r"(?:^(?!>>>|\.\.\.).*\n)+", "\n\n", part, flags=re.M)
            pieces = [piece for piece in code.split("\n\n") if piece.strip()]
            codes = [re.sub(r"^(?:>>>|\.\.\.) ?", "", one, flags=re.M).strip() for one in pieces]
            # A picture that is the last line of a snippet is shown.
            shown = re.compile(r"^picture = (sw\.plot\(.*\))\Z", re.M)
            found += [("code", shown.sub(r"\1", code)) for code in codes]
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
    for name, page in NOTEBOOKS.items():
        text = notebook((TUTORIALS / f"{page}.md").read_text(encoding="utf-8"))
        (TUTORIALS / f"{name}.ipynb").write_text(text, encoding="utf-8")
