"""A bare installation: its calls work, and those that need an extra name it."""

import subprocess
import sys
from importlib.metadata import PackageNotFoundError, requires
from importlib.util import find_spec
from pathlib import Path

import pytest


@pytest.fixture
def bare(tmp_path):
    """Runs code where nothing but Python, NumPy and this package can be imported."""
    for package in ("numpy", "six_wheel"):
        spec = find_spec(package)
        assert spec is not None
        assert spec.origin is not None
        found = Path(spec.origin).parent
        (tmp_path / package).symlink_to(found)
        if (libraries := found.with_name(f"{package}.libs")).exists():
            (tmp_path / libraries.name).symlink_to(libraries)

    def run(code: str) -> subprocess.CompletedProcess[str]:
        code = f"import sys; sys.path.append({str(tmp_path)!r})\n{code}"
        command = [sys.executable, "-I", "-S", "-c", code]
        return subprocess.run(command, capture_output=True, text=True, timeout=60)

    return run


def test_numpy_is_the_only_dependency():
    try:
        needed = requires("six-wheel") or []
    except PackageNotFoundError:
        pytest.skip("six_wheel runs from its sources, not from an installed wheel")
    assert [line for line in needed if "extra ==" not in line] == ["numpy>=1.26"]


def test_the_bare_package_computes(bare):
    done = bare(
        "import six_wheel as sw\n"
        "rover = sw.Rover.preset('perseverance')\n"
        "print(rover.forward(*rover.inverse((0.5, 0.0, 0.0))).round(12).tolist())\n"
        "print(sw.integrate([(1, 0, 0)], 0.5).tolist())\n"
        "from six_wheel import reference\n"
        "reference.Rover.like(rover)\n"
    )
    assert done.stderr == ""
    assert done.stdout == "[0.5, 0.0, 0.0]\n[[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]]\n"


@pytest.mark.parametrize(
    "code",
    [
        "import six_wheel as sw\nsw.load('rover.yaml')",
        "from six_wheel.__main__ import main\nsys.exit(main(['check', 'rover.yaml']))",
        "import six_wheel.plotting as plot, six_wheel as sw\n"
        "plot.show_figure(sw.Rover.preset('perseverance'), (0.5, 0, 0))",
    ],
    ids=["load", "command line", "plot"],
)
def test_what_is_missing_is_named_with_the_line_that_installs_it(bare, code):
    done = bare(code)
    assert done.returncode != 0
    assert 'pip install "six-wheel[' in done.stderr.splitlines()[-1]


def test_importing_is_light(bare):
    done = bare("import six_wheel\nprint([name for name in ('numpy', 'asyncio') if name in sys.modules])")
    assert done.stdout == "[]\n"
