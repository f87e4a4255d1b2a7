"""The counts of the source name what is beyond them, and nothing else."""

from pathlib import Path

import pytest

from tests.house import structure

PASS = "    pass\n"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A tree of one crate and one package, within every bound."""
    files = {
        "rust/small/Cargo.toml": "",
        "rust/small/src/lib.rs": "pub mod low;\nmod high;\npub use high::Top; // crate::low in a comment\n",
        "rust/small/src/low.rs": "pub struct Base;\n#[cfg(test)]\nmod tests { use crate::high::Top; }\n",
        "rust/small/src/high.rs": "use crate::low::{self as floor, Base};\npub struct Top(Base);\n",
        "python/six_wheel/__init__.py": "",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def test_a_tree_within_every_bound(root: Path) -> None:
    assert structure.beyond(root) == []


@pytest.mark.parametrize(
    "line",
    [
        "use crate::high::Top;\n",
        "use super::{high::{Top}};\n",
        "use crate::Top;\n",  # through a re-export
        "use crate::Top as Above;\n",
        "fn make() { crate::high::make(); }\n",
    ],
)
def test_a_circle_of_files(root: Path, line: str) -> None:
    with (root / "rust/small/src/low.rs").open("a", encoding="utf-8") as file:
        file.write(line)
    [found] = structure.beyond(root)
    assert found.startswith("rust/small: a circle of files: ")
    assert "low" in found
    assert "high" in found


@pytest.mark.parametrize(
    ("name", "text", "found"),
    [
        ("rust/small/src/long.rs", "// \n" * 401, "rust/small/src/long.rs: 401 lines (at most 400)"),
        ("tests/core/test_long.py", "# \n" * 401, "tests/core/test_long.py: 401 lines (at most 400)"),
        (
            "rust/small/src/low.rs",
            "fn all(rows: [f64; 3]) {" + "\n" * 100 + "}\n",
            "rust/small/src/low.rs: all has 101 lines (at most 100)",
        ),
        (
            "python/six_wheel/one.py",
            f'def one() -> None:\n    """Two\n\n    lines."""\n{PASS * 100}',
            "python/six_wheel/one.py: one has 101 lines (at most 100)",
        ),
        (
            "python/six_wheel/many.py",
            "".join(f"def f{k}() -> None:\n{PASS * 60}" for k in range(3)),
            None,  # at most twenty
        ),
    ],
)
def test_a_long_file_or_function(root: Path, name: str, text: str, found: str | None) -> None:
    (root / name).parent.mkdir(parents=True, exist_ok=True)
    (root / name).write_text(text, encoding="utf-8")
    assert structure.beyond(root) == ([] if found is None else [found])


def test_too_many_files_and_long_functions(root: Path) -> None:
    for k in range(21):
        body = f"def f() -> None:\n{PASS * 60}"
        (root / f"python/six_wheel/file{k}.py").write_text(body, encoding="utf-8")
    functions, folder = structure.beyond(root)
    assert functions.startswith(
        "21 functions over 60 lines (at most 20): python/six_wheel/file0.py: f, 61 lines"
    )
    assert folder == "python/six_wheel: 21 files (at most 12)"
