"""Tutorial and worked examples, typed into a fresh environment with the built wheel."""

import itertools
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from tests.house import test_worked_examples as examples

ROOT = Path(__file__).parents[2]
START = ROOT / "docs" / "start.md"
# The index cannot be reached: no finding about the wheel.
OFFLINE = re.compile(r"NewConnectionError|NameResolutionError|ConnectTimeout|ProxyError|Connection refused")


def built_wheel() -> Path:
    """The wheel that WHEEL names, or that `make` has built for this environment."""
    if named := os.environ.get("WHEEL"):
        return Path(named).resolve()
    wheels = sorted((Path(sys.prefix) / "wheels").glob("six_wheel-*.whl"))
    if not wheels:
        pytest.skip("no wheel was built: make test-python does, or WHEEL=PATH names one")
    sources = [*(ROOT / "python").rglob("*.py"), *(ROOT / "rust").rglob("*.rs")]
    if max(path.stat().st_mtime for path in sources) > wheels[-1].stat().st_mtime:
        pytest.skip(f"{wheels[-1].name} is older than its sources: make test-python builds it anew")
    return wheels[-1]


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Python of a fresh environment that holds the wheel with its command line, and nothing else."""
    wheel, home = built_wheel(), tmp_path_factory.mktemp("environment") / "fresh"
    subprocess.run([sys.executable, "-m", "venv", str(home)], check=True, timeout=300)
    python = str(home / ("Scripts" if os.name == "nt" else "bin") / "python")
    install = [python, "-m", "pip", "install", "-q", f"six-wheel[cli] @ {wheel.as_uri()}"]
    done = subprocess.run(install, capture_output=True, text=True, timeout=900)
    if done.returncode and OFFLINE.search(done.stderr):
        pytest.skip(f"the package index cannot be reached: {done.stderr.strip().splitlines()[-1]}")
    assert done.returncode == 0, done.stderr
    return python


def typed_into_python(python: str, session: str, folder: Path) -> None:
    """Runs a session and compares what it prints with what the page shows."""
    (folder / "session.txt").write_text(session, encoding="utf-8")
    run = f"doctest.testfile('session.txt', False, optionflags={examples.LOOSE}, encoding='utf-8')"
    code = f"import doctest, sys; found = {run}; sys.exit(found.failed or not found.attempted)"
    done = subprocess.run([python, "-I", "-c", code], cwd=folder, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
def test_the_first_ten_minutes(python: str, tmp_path: Path) -> None:
    """Every line of the shell ends well and leaves the files it names; Python answers as the page shows."""
    text = START.read_text(encoding="utf-8")
    shell = [
        line.split("  #")[0]
        for block in re.findall(r"```sh\n(.*?)```", text, re.S)
        for line in block.splitlines()
    ]
    assert len([line for line in shell if line.startswith("pip install")]) == 2  # as the fixture does
    commands = [shlex.split(line) for line in shell if not line.startswith("pip install")]
    assert len(commands) >= 6
    for words in commands:
        assert words[0] == "six-wheel", words
        program = str(Path(python).with_name("six-wheel"))
        done = subprocess.run(
            [program, *words[1:]], cwd=tmp_path, capture_output=True, text=True, timeout=600
        )
        assert done.returncode == 0, f"{shlex.join(words)}: {done.stdout}{done.stderr}"
        for option, path in itertools.pairwise(words):
            assert option not in ("-o", "--plot") or (tmp_path / path).stat().st_size > 0, (words, path)
    assert len(list((tmp_path / "six_wheel_demo").glob("*.png"))) >= 2
    typed_into_python(python, "\n".join(re.findall(r"```pycon\n(.*?)```", text, re.S)), tmp_path)


@pytest.mark.slow
def test_the_worked_examples(python: str, tmp_path: Path) -> None:
    for one in examples.SESSION[3:]:  # packages that install others come first
        if not one.text.startswith(">>>"):
            examples.shell(one, tmp_path, python)
    session = "\n".join(one.text for one in examples.SESSION[3:] if one.text.startswith(">>>"))
    typed_into_python(python, session, tmp_path)
