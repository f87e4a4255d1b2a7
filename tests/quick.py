"""The inner loop (`make quick`): checks, and the tests of what has changed, against a build for development.

Changed is what git says has changed since the last commit, or in it. ``CRATE=odometry`` and ``ROOM=logs``
choose instead. Nothing is installed: the package is put together in ``target/quick/python``.

Of the Python tests it runs `SMOKE` and those of what has changed, without tests marked ``slow`` and with a
tenth of the cases of random laws; those in Rust take a tenth as well. The rest is left to ``make test``,
as the last line says.
"""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "target/quick/python/six_wheel"
# Python tests for a crate; those of a room of the package have its name.
TESTS = {
    "numerics": ["core/laws"],
    "kinematics": ["core/laws"],
    "odometry": ["kinematics/odometry"],
    "control": ["core/control"],
    "four_axle": ["core/control/test_four_axle.py", "core/control/test_four_axle_turns.py"],
    "terrain": [
        f"core/ground/test_{name}.py" for name in ("bounds", "offsets", "rows", "settle", "settle_stops")
    ],
    "ground_motion": ["core/ground_motion"],
    "planner": ["core/planner"],
    "python": ["core/boundary"],
}
# Laws and exact cases of the compiled core, which every change runs.
SMOKE = [
    f"core/laws/test_{name}.py"
    for name in (
        "corners",
        "geometry",
        "project",
        "rover",
        "rows_alone",
        "steering",
        "suspension",
        "vehicle_parts",
    )
]


# Parts of every kernel: after an edit of them the scalar level alone is built and tested.
EVERYWHERE = {"numerics", "kinematics"}


def changed() -> list[Path]:
    """Files that differ from the last commit, or that it changed."""
    for command in (["git", "status", "--porcelain", "-uall"], ["git", "show", "--name-only", "--format="]):
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        if lines := done.stdout.splitlines():
            return [Path(line[3:] if command[1] == "status" else line) for line in lines]
    return []


def touched(files: list[Path]) -> tuple[list[str], list[str]]:
    """Crates with changed files, and the folders and files of Python tests for all of them."""
    crates, tests = set(), set(SMOKE)
    for file in files:
        match file.parts:
            case ("rust", crate, *_) if crate in TESTS:
                crates.add(crate)
                tests.update(TESTS[crate])
            case ("python", "six_wheel", room, _, *_):
                tests.add(room)
            case ("tests", *folders, name) if folders:
                tests.add("/".join([*folders, *([name] if name.startswith("test_") else [])]))
    if "CRATE" in os.environ:
        crates = {os.environ["CRATE"]}
        tests = {*SMOKE, *TESTS[os.environ["CRATE"]]}
    if "ROOM" in os.environ:
        tests.add(os.environ["ROOM"])
    # A folder has its files. The nodes have an environment of their own, and `house` takes minutes.
    there = {
        test
        for test in tests
        if (ROOT / "tests" / test).exists()
        and not {str(over) for over in Path(test).parents} & tests
        and test != "house"
        and not test.startswith("control_loop/ros2")
    }
    return sorted(crates), sorted(there)


def put_together() -> None:
    """The package with the module just built: links, so that an edit of Python needs no build."""
    shutil.rmtree(PACKAGE, ignore_errors=True)
    PACKAGE.mkdir(parents=True)
    for entry in (ROOT / "python/six_wheel").iterdir():
        if entry.suffix != ".so" and entry.name != "__pycache__":
            (PACKAGE / entry.name).symlink_to(entry)
    [library] = [*(ROOT / "target/quick").glob("lib_core.*[osl]"), *(ROOT / "target/quick").glob("_core.dll")]
    (PACKAGE / ("_core.pyd" if library.suffix == ".dll" else "_core.abi3.so")).symlink_to(library)


def processor_time() -> float:
    """Of all programs run so far [s]."""
    used = os.times()
    return used.children_user + used.children_system


def run(name: str, *command: str, **environment: str) -> None:
    """Run a step and print its time; the first that fails ends the program."""
    start, before = time.monotonic(), processor_time()
    code = subprocess.run(command, cwd=ROOT, env=os.environ | environment, check=False).returncode
    taken, used = time.monotonic() - start, processor_time() - before
    print(f"quick: {name}: {taken:.0f} s, {used:.0f} s of processors", flush=True)
    if code:
        sys.exit(code)


def main() -> None:
    start = time.monotonic()
    crates, tests = touched(changed())
    cargo = ("--profile", "quick", "--locked", "--quiet")
    tested = [crate for crate in crates if crate != "python"]
    only: tuple[str, ...] = ()
    if below := EVERYWHERE.intersection(crates):
        print(f"quick: {', '.join(sorted(below))}: every kernel is compiled anew, for the scalar level alone")
        only = ("--features=six-wheel-numerics/scalar-only",)
    run("check", "cargo", "check", "--workspace", "--all-targets", *cargo)
    if tested:
        packages = [f"--package=six-wheel-{crate.replace('_', '-')}" for crate in tested]
        fewer = {"PROPTEST_CASES": "26", "SOAK": "0.1"}  # a tenth, as of Python's random laws
        run(f"tests of {', '.join(tested)}", "cargo", "test", "--tests", *packages, *only, *cargo, **fewer)
    run("build", "cargo", "build", "--package=six-wheel-py", "--no-default-features", *only, *cargo)
    put_together()
    pytest = (sys.executable, "-m", "pytest", "-q", "-n", "2", "-m", "not slow", "-p", "no:cacheprovider")
    environment = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    environment |= {"PYTHONPATH": str(PACKAGE.parent), "HYPOTHESIS_PROFILE": "quick"}
    chosen = [test for test in tests if test not in SMOKE]
    run(" ".join(["smoke", *chosen]), *pytest, *(f"tests/{test}" for test in tests), **environment)
    taken, used = time.monotonic() - start, processor_time()
    print(f"quick: {taken:.0f} s in all, {used:.0f} s of processors; tests left to make test: ", end="")
    print("marked slow, nine tenths of the cases of random laws, and every folder not named above")


if __name__ == "__main__":
    main()
