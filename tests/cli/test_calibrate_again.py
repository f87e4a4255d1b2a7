"""A calibration that was stopped goes on."""

from pathlib import Path

import numpy as np
import pytest

from six_wheel.calibration import cross_validation
from tests.cli_runs import Run


def test_a_calibration_that_was_stopped_goes_on(
    run: Run, drives: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Finished logs are not run again, and no journal is left in the end."""
    logs = ("run1.csv", "run2.csv", "run3.csv")
    told = cross_validation.errors_left_out
    tried: list[tuple[str, ...]] = []

    def stopping(trial: cross_validation.Trial) -> np.ndarray:
        if len(tried) == 3:
            raise KeyboardInterrupt
        return once(trial)

    def once(trial: cross_validation.Trial) -> np.ndarray:
        tried.append(trial.problem.model.names)
        return told(trial)

    def calibrated(output: str) -> str:
        assert run("calibrate", "cart.yaml", *logs, "-o", output)[0] == 0
        return Path(output).read_text()

    wanted = calibrated("whole.yaml")
    monkeypatch.setattr(cross_validation, "errors_left_out", stopping)
    run("calibrate", "cart.yaml", *logs, "-o", "true.yaml")
    assert not Path("true.yaml").exists()
    first = list(tried)
    monkeypatch.setattr(cross_validation, "errors_left_out", once)
    assert calibrated("true.yaml") == wanted
    assert len(first) == 3
    assert len(tried) == len(set(tried))  # none of them twice
    assert not Path(".true.yaml.done").exists()


def test_what_a_stopped_calibration_of_other_logs_did_is_not_taken(run: Run, drives: None) -> None:
    Path(".true.yaml.done").mkdir()
    Path(".true.yaml.done/journal.json").write_text('{"version": "another"}')
    np.savez(".true.yaml.done/00000000.npz", value=np.frombuffer(b"1.0", np.uint8))
    code, _, err = run("calibrate", "cart.yaml", "run1.csv", "run2.csv", "-o", "true.yaml")
    assert (code, err) == (0, "")
    assert not Path(".true.yaml.done").exists()
