"""Code of the pages: every page as one Python file."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
BUILT = {"_build", "api"}
PAGES = sorted(page for page in DOCS.rglob("*.md") if not BUILT & set(page.relative_to(DOCS).parts))


def code(page: Path) -> str:
    """Blocks of Python and what is typed after prompts, at the lines where the page has them."""
    lines, kind = [], ""
    for line in page.read_text(encoding="utf-8").splitlines():
        if fence := re.match(r"```(\w*)", line):
            kind = "" if kind else fence[1] or "text"
            lines.append("")
        elif kind in ("pycon", "console"):
            typed = re.match(r"(?:>>>|\.\.\.) ?(.*)", line)
            lines.append(typed[1] if typed else "")
        else:
            lines.append(line if kind == "python" else "")
    return "\n".join(lines).rstrip() + "\n"
