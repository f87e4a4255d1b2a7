"""The lowest floor of the package imports the standard library, NumPy and the core, and nothing else."""

import subprocess
import sys
from pathlib import Path

import pytest

import six_wheel

PACKAGE = Path(six_wheel.__file__).parent
FLOOR = ("kinematics", "reference")

# Run in a process of its own: everything else is refused as if it were not there, other rooms too.
HOOK = """
import sys
from importlib import import_module

ROOMS = ("_core", *{rooms!r})


class Refuse:
    def find_spec(self, name, path=None, target=None):
        top, _, rest = name.partition(".")
        room = rest.partition(".")[0]
        if top not in (*sys.stdlib_module_names, "numpy", "six_wheel") or (
            top == "six_wheel" and room and room not in ROOMS
        ):
            raise ModuleNotFoundError(f"{{name}} is not allowed here", name=name)


for name in [name for name in sys.modules if name.partition(".")[0] not in sys.stdlib_module_names]:
    del sys.modules[name]
sys.meta_path.insert(0, Refuse())
for name in {names!r}:
    import_module(name)
print(len({names!r}))
"""


def modules(room: str) -> list[str]:
    """The full names of a room's modules."""
    files = sorted((PACKAGE / room).rglob("*.py"))
    names = [".".join(("six_wheel", *file.relative_to(PACKAGE).with_suffix("").parts)) for file in files]
    return [name.removesuffix(".__init__") for name in names]


def imported(names: list[str], rooms: tuple[str, ...] = FLOOR) -> subprocess.CompletedProcess[str]:
    """A process that imports these modules and may import nothing beyond NumPy and these rooms."""
    code = HOOK.format(rooms=rooms, names=names)
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)


@pytest.mark.parametrize("room", FLOOR)
def test_every_module_of_the_floor_imports_with_numpy_alone(room: str) -> None:
    names = modules(room)
    assert len(names) > 15
    done = imported(names)
    assert done.stderr == ""
    assert done.stdout == f"{len(names)}\n"


def test_dead_reckoning_needs_numpy_alone() -> None:
    done = imported(
        ["six_wheel.log_odometry.dead_reckoning"], (*FLOOR, "robot_description", "logs", "log_odometry")
    )
    assert (done.stderr, done.stdout) == ("", "1\n")


@pytest.mark.parametrize("name", ["six_wheel.maps", "matplotlib"])
def test_other_rooms_and_packages_are_refused(name: str) -> None:
    done = imported([name])
    assert done.returncode != 0
    assert done.stderr.splitlines()[-1] == f"ModuleNotFoundError: {name} is not allowed here"
