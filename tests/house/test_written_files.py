"""One function opens everything that is written, `replacing`: nothing else opens a file for writing."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import six_wheel

PACKAGE = Path(six_wheel.__file__).parent
# Calls that write a file: methods of a path, functions that a path is given to, and where it stands.
METHODS = {"write_text", "write_bytes", "symlink_to", "hardlink_to"}
FUNCTIONS = {
    **dict.fromkeys(("savez", "savez_compressed", "savetxt", "write_table", "write_csv", "tofile"), -1),
    **dict.fromkeys(("savefig", "imsave", "to_parquet", "copyfile", "copy2", "copytree"), -1),
    "ParquetWriter": 0,
    "CSVWriter": 0,
}
# Others that open one, with the reason.
ALONE = {
    "kinematics/objects/whole_files.py": "is that function",
    "logs/mcap/writer.py RecordWriter.__init__": "a record grows: what it has is there when the power goes",
    "parallel/journal.py Journal.write": "fills what `_write` has opened",
    "parallel/journal.py _write": "items of a journal outlive the run, each replaced at once",
    "logs/bags/bag_files.py whole_part": "a copy to read, in a temporary folder",
}


def is_writing(mode: ast.expr | None) -> bool:
    return (
        isinstance(mode, ast.Constant) and isinstance(mode.value, str) and bool(set("wax+") & set(mode.value))
    )


def written(call: ast.Call) -> ast.expr | None:
    """The path that a call writes to; None if it writes none."""
    name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
    owner = call.func.value if isinstance(call.func, ast.Attribute) else None
    named = {each.arg: each.value for each in call.keywords}
    if name == "open":
        of_path = owner is not None and not (
            isinstance(owner, ast.Name) and owner.id in ("gzip", "io", "library")
        )
        place = 0 if of_path else 1
        mode = named.get("mode", call.args[place] if len(call.args) > place else None)
        return (owner if of_path else call.args[0]) if is_writing(mode) else None
    if name in ("rename", "replace", "move") and ast.unparse(owner or call.func) in ("os", "shutil"):
        return call.args[1]
    if name in METHODS and owner is not None:
        return owner
    if name in FUNCTIONS and call.args:
        return call.args[0] if FUNCTIONS[name] == 0 or name.startswith("save") else call.args[-1]
    return None


def is_replacing(value: ast.expr) -> bool:
    """True for ``replacing(...)``, also entered by a stack, also where a condition holds."""
    if isinstance(value, ast.IfExp):
        return is_replacing(value.body) or is_replacing(value.orelse)
    if not isinstance(value, ast.Call):
        return False
    name = value.func.attr if isinstance(value.func, ast.Attribute) else getattr(value.func, "id", "")
    return name == "replacing" or (name == "enter_context" and is_replacing(value.args[0]))


def temporaries(function: ast.AST) -> set[str]:
    """Names of a function that `replacing` gave, and of what is opened there."""
    found = set()
    for node in ast.walk(function):
        if isinstance(node, ast.withitem) and is_replacing(node.context_expr):
            found.add(getattr(node.optional_vars, "id", ""))
        if isinstance(node, ast.Assign) and is_replacing(node.value):
            found |= {each.id for each in node.targets if isinstance(each, ast.Name)}
    return found


def functions(tree: ast.AST, outer: str = "") -> Iterator[tuple[str, ast.AST]]:
    """Functions and methods of a module, those within others included in them."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef):
            yield f"{outer}{node.name}", node
        elif isinstance(node, ast.ClassDef):
            yield from functions(node, f"{outer}{node.name}.")
        else:
            yield from functions(node, outer)


def openings(tree: ast.AST) -> Iterator[tuple[str, str]]:
    """Functions that write a file which `replacing` did not give, and what they write."""
    for name, function in functions(tree):
        known = temporaries(function)
        memory = {
            each.id
            for node in ast.walk(function)
            if isinstance(node, ast.Assign) and "BytesIO" in ast.dump(node.value)
            for each in node.targets
            if isinstance(each, ast.Name)
        }
        for node in ast.walk(function):
            if isinstance(node, ast.Call) and (target := written(node)) is not None:
                text = ast.unparse(target)
                if text not in known | memory and not text.startswith("self._handle"):
                    yield name, text


def test_only_replacing_opens_files_for_writing() -> None:
    found = set()
    for path in sorted(PACKAGE.rglob("*.py")):
        where = path.relative_to(PACKAGE).as_posix()
        if where not in ALONE:
            found |= {(f"{where} {name}", target) for name, target in openings(ast.parse(path.read_text()))}
    assert {each for each in found if each[0] not in ALONE} == set()
    assert {name for name in ALONE if " " in name} <= {name for name, _ in found}


@pytest.mark.parametrize(
    ("code", "is_found"),
    [
        ("def f(path):\n path.write_text('')", True),
        ("def f(path):\n with open(path, 'w') as file: pass", True),
        ("def f(path):\n with path.open(mode='xb') as file: pass", True),
        ("def f(path):\n figure.savefig(path)", True),
        ("def f(path):\n with open(path) as file, path.open('rb') as other: pass", False),
        ("def f(path):\n with replacing(path) as target: target.write_text('')", False),
        ("def f(path):\n with replacing(path) as target: path.write_text('')", True),
        ("class A:\n def f(self, path):\n  np.savez(path, a=1)", True),
    ],
)
def test_the_walk_sees_openings(code: str, is_found: bool) -> None:
    assert bool(list(openings(ast.parse(code)))) == is_found
