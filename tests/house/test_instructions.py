"""The guard of instruction counts: which jobs it has, and what it says of more and of less."""

import csv
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

BENCHES = Path(__file__).parents[2] / "benches"
Run = Callable[..., tuple[int, str]]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Run:
    """The guard with counts that are given instead of counted."""
    monkeypatch.syspath_prepend(BENCHES)
    import instructions

    figures = tmp_path / "instructions.csv"
    figures.write_text("instructions,one\ninverse,1000\nforward,500\n", encoding="utf-8")
    monkeypatch.setattr(instructions, "FIGURES", figures)
    monkeypatch.setattr(instructions, "build", lambda: Path())
    monkeypatch.setattr(instructions.shutil, "which", lambda _: "valgrind")

    def go(counts: dict[str, int], *arguments: str, compiler: str = "one") -> tuple[int, str]:
        monkeypatch.setattr(instructions, "compiler", lambda: compiler)
        monkeypatch.setattr(instructions, "count", lambda _: counts)
        monkeypatch.setattr(sys, "argv", ["instructions.py", *arguments])
        code = instructions.main()
        return code, capsys.readouterr().out

    return go


def test_every_job_has_its_figure() -> None:
    source = (BENCHES.parent / "rust/planner/benches/instructions.rs").read_text(encoding="utf-8")
    with (BENCHES / "instructions.csv").open(newline="", encoding="utf-8") as file:
        figures = list(csv.reader(file))[1:]
    jobs = source.split("#[inline(never)]\nfn ")[1:]
    assert [job.partition("(")[0] for job in jobs] == [name for name, _ in figures]
    assert len(figures) >= 12


def test_three_percent_more_fails_and_less_does_not(run: Run) -> None:
    assert run({"inverse": 1029, "forward": 100})[0] == 0
    code, said = run({"inverse": 1031, "forward": 500})
    assert code == 1
    assert "inverse" in said
    assert "changelog" in said


def test_a_job_without_a_figure_fails_until_it_has_one(run: Run) -> None:
    counts = {"inverse": 1000, "forward": 500, "fit": 7}
    assert run(counts)[0] == 1
    assert run(counts, "--write")[0] == 0
    assert run(counts)[0] == 0


def test_another_compiler_compares_nothing(run: Run) -> None:
    code, said = run({"inverse": 9999, "forward": 9999}, compiler="another")
    assert code == 0
    assert "skipped" in said
