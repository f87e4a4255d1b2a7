"""Code of the pages as files of Python: what a page types after prompts, and each program."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
BUILT = {"_build", "api"}
PAGES = sorted(page for page in DOCS.rglob("*.md") if not BUILT & set(page.relative_to(DOCS).parts))


def snippets(page: Path) -> dict[str, str]:
    """Code by file name, at the lines where the page has it. Parts of programs are left out."""
    name = "_".join(page.relative_to(ROOT).with_suffix("").parts)
    lines = page.read_text(encoding="utf-8").splitlines()
    session, blocks, kind = [""] * len(lines), {}, ""
    for number, line in enumerate(lines):
        if fence := re.match(r"```(\w*)", line):
            kind = "" if kind else fence[1] or "text"
            start = number
        elif kind == "python":
            blocks.setdefault(f"{name}_{start + 1}.py", [""] * len(lines))[number] = line
        elif kind == "pycon" and (typed := re.match(r"(?:>>>|\.\.\.) ?(.*)", line)):
            session[number] = typed[1]
    found = {f"{name}.py": session} if any(session) else {}
    whole = {file: "\n".join(text).rstrip() + "\n" for file, text in (found | blocks).items()}
    return {file: code for file, code in whole.items() if "import " in code}
