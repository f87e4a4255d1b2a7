"""Instructions of a dozen calls, counted by callgrind, beside the figures that stand in `instructions.csv`.

``python benches/instructions.py`` fails where one takes 3 % more than it did, ``--write`` makes the figures
anew. They belong to one compiler: with another, or without valgrind, it says so and compares nothing.
"""

import argparse
import csv
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

FIGURES = Path(__file__).with_suffix(".csv")
ROOT = FIGURES.parents[1]
SOURCE = ROOT / "rust/planner/benches/instructions.rs"
MORE = 0.03  # of instructions: what a change of the compiler's mind may take


def compiler() -> str:
    """Version of the compiler and the machine it compiles for."""
    said = subprocess.run(["rustc", "-vV"], capture_output=True, text=True, check=True).stdout
    lines = dict(line.split(": ", 1) for line in said.splitlines() if ": " in line)
    return f"rustc {lines['release']} {lines['host']}"


def build() -> Path:
    """The program to count in."""
    command = [
        "cargo",
        "bench",
        "--package",
        "six-wheel-planner",
        "--bench",
        "instructions",
        "--package",
        "six-wheel-py",  # with its features the crates are those of the wheel, and not built again
        "--locked",
        "--no-run",
    ]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    found = re.search(r"\((\S*/instructions-\w+)\)", done.stderr)
    if done.returncode or found is None:
        raise SystemExit(done.stderr)
    return ROOT / found[1]


def count(program: Path) -> dict[str, int]:
    """Instructions of one run of every job, what it calls included."""
    text = SOURCE.read_text(encoding="utf-8")
    runs = int(re.search(r"const RUNS: usize = (\d+)", text)[1])  # type: ignore[index]
    jobs = re.findall(r"#\[inline\(never\)\]\nfn (\w+)", text)
    with tempfile.TemporaryDirectory() as folder:
        counted = Path(folder) / "counted"
        subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={counted}", "-q", program], check=True
        )
        command = ["callgrind_annotate", "--inclusive=yes", "--threshold=100", counted]
        table = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    figures = {}
    for job in jobs:
        found = re.search(rf"^\s*([\d,]+) \(.*\binstructions::{job}\b", table, re.MULTILINE)
        if found is None:
            raise SystemExit(f"{job} is not among what callgrind counted")
        figures[job] = round(int(found[1].replace(",", "")) / runs)
    return figures


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="make the figures anew")
    write = parser.parse_args().write
    if shutil.which("valgrind") is None:
        print("instructions: skipped, there is no valgrind here")
        return 0
    with FIGURES.open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    which = compiler()
    if not write and rows[0][1] != which:
        print(f"instructions: skipped, the figures are those of {rows[0][1]}, this is {which}")
        return 0
    now = count(build())
    before = {job: int(figure) for job, figure in rows[1:]}
    grown = []
    for job, figure in now.items():
        share = figure / before[job] - 1.0 if job in before else 0.0
        print(f"{job:<18}{figure:>10,}  {share:+.1%}")
        if share > MORE:
            grown.append(job)
    if write:
        with FIGURES.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows([("instructions", which), *now.items()])
    elif grown or before.keys() != now.keys():
        print(f"more than {MORE:.0%} more, or other jobs: {', '.join(grown or before.keys() ^ now.keys())}")
        print("say why in the changelog, and write the figures with --write")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
