"""Settings shared by all tests."""

import os
import signal
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import settings

from tests.cli_runs import COMMANDS, ROVER, Run

if TYPE_CHECKING:
    from six_wheel.robot_description.parameters import Finding, Parameters

    Read = Callable[..., Parameters]

# Children ignore signals that this process ignores: Ctrl-C in the background of a shell, SIGHUP with nohup.
ORDINARY = {"SIGINT": signal.default_int_handler, "SIGHUP": signal.SIG_DFL}
for name in ORDINARY.keys() & dir(signal):
    number = getattr(signal, name)
    if signal.getsignal(number) is signal.SIG_IGN:
        signal.signal(number, ORDINARY[name])

# Runs are repeatable and judged by their answers, not by how busy the machine is.
settings.register_profile("default", derandomize=True, deadline=None, print_blob=True)
settings.register_profile("quick", settings.get_profile("default"), max_examples=10)  # a tenth of the cases
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Files that take long first, where workers share files: none is left alone with one at the end."""
    if hasattr(config, "workerinput"):
        slow = Counter(item.path for item in items if item.get_closest_marker("slow"))
        tests = Counter(item.path for item in items)
        items.sort(key=lambda item: (-slow[item.path], -tests[item.path]))


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run a command in a folder of its own: exit code, stdout, stderr."""
    from six_wheel import __main__

    monkeypatch.chdir(tmp_path)
    Path("rover.yaml").write_text(ROVER)
    Path("commands.csv").write_text(COMMANDS)

    def run(*arguments: str) -> tuple[int, str, str]:
        code = __main__.main(arguments)
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


@pytest.fixture
def refused(run: Run) -> Callable[..., str]:
    """Run a command that must fail: one line on stderr, nothing on stdout, exit code 2, no new files."""

    def refused(*arguments: str) -> str:
        before = sorted(Path().iterdir())
        code, out, err = run(*arguments)
        assert (code, out) == (2, "")
        assert sorted(Path().iterdir()) == before
        assert err.count("\n") == 1
        assert err.startswith("six-wheel: ")
        return err.removeprefix("six-wheel: ").rstrip("\n")

    return refused


@pytest.fixture
def read(tmp_path: Path) -> "Read":
    """Parameters read from a file with this content."""
    from six_wheel.robot_description.parameters import read_parameters

    def read(content: str | bytes, name: str = "rover.yaml", **options: str) -> "Parameters":
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_parameters(path, **options)

    return read


@pytest.fixture
def findings(read: "Read") -> Callable[..., tuple["Finding", ...]]:
    """The mistakes of a parameter file with this content."""
    from six_wheel.robot_description.parameters import ParameterFileError

    def findings(content: str | bytes, **options: str) -> tuple["Finding", ...]:
        with pytest.raises(ParameterFileError) as caught:
            read(content, **options)
        return caught.value.findings

    return findings


@pytest.fixture(scope="module")
def local_cluster() -> Iterator[Any]:
    """A Dask cluster of two processes of this machine."""
    distributed = pytest.importorskip("distributed", reason="needs Dask")
    import dask

    settings = {"distributed.logging.distributed": "critical", "distributed.comm.timeouts.connect": "3s"}
    with (
        dask.config.set(settings),
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as started,
    ):
        yield started
