"""Counts of the source, run by `make lint`: circles of files, long files and functions, full folders.

``python -m tests.house.structure`` prints what is beyond a bound and fails. Circles of Python files are the
business of import-linter, whose contracts are in `pyproject.toml`. Rust is read as text, without comments,
strings and unit tests: an import is a path in a `use` or an expression, followed through re-exports to the
file that defines the name.
"""

import ast
import re
import sys
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).parents[2]
LONGEST_FILE = 400  # lines
LONGEST_FUNCTION = 100  # lines, docstrings left out
LONG_FUNCTION, LONG_FUNCTIONS = 60, 20  # so many may be longer than this
FILES_IN_FOLDER = 12

Module = tuple[str, ...]


def code(text: str) -> str:
    """Rust without comments, strings and unit tests; lines stay where they are."""

    def blank(found: re.Match[str]) -> str:
        return re.sub(r"[^\n]", " ", found[0])

    literal = r'//[^\n]*|/\*.*?\*/|b?r(#*)".*?"\1|b?"(?:\\.|[^"\\])*"|\'(?:\\[^\n]+?|[^\\\'\n])\''
    text = re.sub(literal, blank, text, flags=re.DOTALL)
    while found := re.search(r"#\[cfg\((?:all\()?test\b[^\]]*\]", text):
        end = end_of_block(text, found.end())
        text = text[: found.start()] + re.sub(r"[^\n]", " ", text[found.start() : end]) + text[end:]
    return text


def end_of_block(text: str, start: int) -> int:
    """The place behind the closing brace of the first block from `start`, or behind a semicolon before it."""
    depth = 0
    for found in re.finditer(r"[][(){};]", text[start:]):
        depth += (found[0] in "[({") - (found[0] in "])}")
        if depth == 0 and found[0] in "};":
            return start + found.end()
    return len(text)


def names(tree: str) -> Iterator[tuple[list[str], str]]:
    """Paths of a `use` with the names they go by: `a::{b, c as d}` is `a::b` as b and `a::c` as d."""
    if found := re.fullmatch(r"\s*([\w:]*?)(?:::)?\{(.*)\}\s*", tree, re.DOTALL):
        for part in re.findall(r"(?:[^,{}]|\{(?:[^{}]|\{[^{}]*\})*\})+", found[2]):
            for path, name in names(part):
                yield [step for step in found[1].split("::") if step] + path, name
    elif tree.strip():
        written, _, name = tree.strip().partition(" as ")
        steps = [step for step in written.strip().split("::") if step != "self" or written.startswith("self")]
        yield steps, name.strip() or steps[-1]


class Crate:
    """The files of a crate, by the path of their module, and the names each has imported."""

    def __init__(self, root: Path) -> None:
        self.root, self.text, self.scope = root, {}, {}
        for file in sorted((root / "src").rglob("*.rs")):
            steps = file.relative_to(root / "src").with_suffix("").parts
            if steps[-1] != "tests":
                module = steps[:-1] if steps[-1] in ("mod", "lib") else steps
                self.text[module] = code(file.read_text(encoding="utf-8"))
        for module, text in self.text.items():
            uses = re.findall(r"\b(pub(?:\([^)]*\))? )?use\s+([^;]+);", text)
            self.scope[module] = {
                name: (path, bool(public)) for public, tree in uses for path, name in names(tree)
            }

    def steps(self, module: Module, path: list[str]) -> list[str] | None:
        """A path as it is written in a module, from the root of the crate; nothing if it leads out of it."""
        here = list(module)
        if path[0] == "crate":
            return path[1:]
        while path and path[0] in ("self", "super"):
            here, path = (here[:-1] if path[0] == "super" else here), path[1:]
            if not path or path[0] not in ("self", "super"):
                return here + path
        return here + path if (*module, path[0]) in self.text else None

    def file_of(self, steps: list[str], depth: int = 8) -> Module | None:
        """The file that defines what the steps lead to."""
        size = max(k for k in range(len(steps) + 1) if tuple(steps[:k]) in self.text)
        module, rest = tuple(steps[:size]), steps[size:]
        if not rest or not depth or rest[0] not in self.scope[module]:
            return module
        further = self.steps(module, self.scope[module][rest[0]][0])
        return None if further is None else self.file_of(further + rest[1:], depth - 1)

    def imports(self, module: Module) -> set[Module]:
        """Files of the crate that a file imports; a re-export that it does not use itself is no import."""
        body = re.sub(r"\buse\s+[^;]+;", "", self.text[module])
        paths = [
            path
            for name, (path, public) in self.scope[module].items()
            if not public or re.search(rf"\b{re.escape(name)}\b", body)
        ]
        for path in re.findall(r"(?<![\w:.])[a-z_]\w*(?:::\w+)+", body):
            first, *rest = path.split("::")
            paths.append([*self.scope[module].get(first, ([first], False))[0], *rest])
        steps = [
            self.steps(module, path[:-1] if path[-1] == "*" else path) for path in paths if path != ["*"]
        ]
        found = {self.file_of(path) for path in steps if path is not None}
        return {file for file in found if file is not None} - {module}

    def circle(self) -> list[str]:
        """One circle of files, or none."""
        try:
            TopologicalSorter({module: self.imports(module) for module in self.text}).prepare()
        except CycleError as error:
            return ["::".join(module) or "lib" for module in error.args[1]]
        return []


def functions(file: Path) -> Iterator[tuple[int, str]]:
    """Lines and name of every function of a file."""
    text = file.read_text(encoding="utf-8")
    if file.suffix == ".rs":
        text = code(text)
        for found in re.finditer(r"\bfn\s+(\w+)", text):
            block = text[found.start() : end_of_block(text, found.end())]
            yield block.count("\n") + 1, found[1]
        return
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            documented = ast.get_docstring(node) is not None
            docstring = (node.body[0].end_lineno or 0) - node.body[0].lineno + 1 if documented else 0
            yield (node.end_lineno or 0) - node.lineno + 1 - docstring, node.name


def beyond(root: Path) -> list[str]:
    """One line for every count that is beyond its bound."""
    crates = [path.parent for path in sorted(root.glob("rust/*/Cargo.toml")) if path.parent.name != "fuzz"]
    found = []
    for crate in crates:
        if circle := Crate(crate).circle():
            found.append(f"rust/{crate.name}: a circle of files: {' -> '.join(circle)}")
    sources = [file for crate in crates for file in crate.glob("src/**/*.rs")]
    sources += (root / "python/six_wheel").rglob("*.py")
    for file in sorted([*sources, *root.glob("tests/**/*.py")]):
        lines = file.read_text(encoding="utf-8").count("\n")
        if lines > LONGEST_FILE:
            found.append(f"{file.relative_to(root)}: {lines} lines (at most {LONGEST_FILE})")
    long = []
    for file in sorted(sources):
        name = file.relative_to(root)
        for length, function in functions(file):
            if length > LONGEST_FUNCTION:
                found.append(f"{name}: {function} has {length} lines (at most {LONGEST_FUNCTION})")
            if length > LONG_FUNCTION:
                long.append(f"{name}: {function}, {length} lines")
    if len(long) > LONG_FUNCTIONS:
        rule = f"{len(long)} functions over {LONG_FUNCTION} lines (at most {LONG_FUNCTIONS})"
        found.append(f"{rule}: {'; '.join(long)}")
    for folder in sorted({file.parent for file in sources}):
        inside = [file.stem for file in sources if file.parent == folder]
        count = sum(stem not in ("lib", "mod", "tests", "__init__") for stem in inside)
        if count > FILES_IN_FOLDER:
            found.append(f"{folder.relative_to(root)}: {count} files (at most {FILES_IN_FOLDER})")
    return found


if __name__ == "__main__":
    lines = beyond(ROOT)
    print("\n".join(lines))
    sys.exit(bool(lines))
