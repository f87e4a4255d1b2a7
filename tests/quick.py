"""The inner loop (`make quick`): checks, and the tests of what has changed, against a build for development.

Changed is what git says has changed since the last commit, or in it. ``CRATE=odometry`` and ``ROOM=logs``
choose instead. Nothing is installed: the package is put together in ``target/quick/python``.
"""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "target/quick/python/six_wheel"
# Folders of Python tests for a crate; those of a room of the package have its name.
TESTS = {
    "numerics": ["core/laws"],
    "kinematics": ["core/laws"],
    "odometry": ["kinematics/odometry"],
    "control": ["core/control"],
    "four_axle": ["core/control"],
    "terrain": ["core/ground"],
    "ground_motion": ["core/ground_motion"],
    "planner": ["core/planner"],
    "python": ["core/boundary"],
}
SMOKE = "core/laws"


def changed() -> list[Path]:
    """Files that differ from the last commit, or that it changed."""
    for command in (["git", "status", "--porcelain", "-uall"], ["git", "show", "--name-only", "--format="]):
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        if lines := done.stdout.splitlines():
            return [Path(line[3:] if command[1] == "status" else line) for line in lines]
    return []


def touched(files: list[Path]) -> tuple[list[str], list[str]]:
    """Crates with changed files, and the folders of Python tests for all of them."""
    crates, folders = set(), {SMOKE}
    for file in files:
        match file.parts:
            case ("rust", crate, *_) if crate in TESTS:
                crates.add(crate)
                folders.update(TESTS[crate])
            case ("python", "six_wheel", room, _, *_) | ("tests", room, _, *_):
                folders.add(str(Path(*file.parts[1:-1])) if file.parts[0] == "tests" else room)
    if "CRATE" in os.environ:
        crates = {os.environ["CRATE"]}
        folders = {SMOKE, *TESTS[os.environ["CRATE"]]}
    if "ROOM" in os.environ:
        folders.add(os.environ["ROOM"])
    there = {folder for folder in folders if (ROOT / "tests" / folder).is_dir()}
    return sorted(crates), sorted(
        there - {"house", "control_loop/ros2"}
    )  # which has an environment of its own


def put_together() -> None:
    """The package with the module just built: links, so that an edit of Python needs no build."""
    shutil.rmtree(PACKAGE, ignore_errors=True)
    PACKAGE.mkdir(parents=True)
    for entry in (ROOT / "python/six_wheel").iterdir():
        if entry.suffix != ".so" and entry.name != "__pycache__":
            (PACKAGE / entry.name).symlink_to(entry)
    [library] = [*(ROOT / "target/quick").glob("lib_core.*[osl]"), *(ROOT / "target/quick").glob("_core.dll")]
    (PACKAGE / ("_core.pyd" if library.suffix == ".dll" else "_core.abi3.so")).symlink_to(library)


def run(name: str, *command: str, **environment: str) -> None:
    """Run a step and print its time; the first that fails ends the program."""
    start = time.monotonic()
    code = subprocess.run(command, cwd=ROOT, env=os.environ | environment, check=False).returncode
    print(f"quick: {name}: {time.monotonic() - start:.0f} s", flush=True)
    if code:
        sys.exit(code)


def main() -> None:
    start = time.monotonic()
    crates, folders = touched(changed())
    cargo = ("--profile", "quick", "--locked", "--quiet")
    packages = [f"--package=six-wheel-{crate.replace('_', '-')}" for crate in crates if crate != "python"]
    run("check", "cargo", "check", "--workspace", "--all-targets", *cargo)
    if packages:
        run(f"tests of {', '.join(crates)}", "cargo", "test", "--lib", *packages, *cargo)
    run("build", "cargo", "build", "--package=six-wheel-py", "--no-default-features", *cargo)
    put_together()
    tests = [f"tests/{folder}" for folder in folders]
    pytest = (sys.executable, "-m", "pytest", "-q", "-n", "2", "-m", "not slow", "-p", "no:cacheprovider")
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    run(" ".join(tests), *pytest, *tests, PYTHONPATH=str(PACKAGE.parent), **threads)
    print(f"quick: {time.monotonic() - start:.0f} s in all")


if __name__ == "__main__":
    main()
