"""Files of a cart in the folder of a run."""

import shutil
from pathlib import Path

import pytest

from tests.cli.calibrate_drives import NOMINAL, write
from tests.cli.command_lines import write_files
from tests.cli.odometry_tables import CART, table
from tests.cli_runs import Run


@pytest.fixture
def cart(run: Run) -> None:
    Path("cart.yaml").write_text(CART)
    Path("log.csv").write_text(table())


@pytest.fixture
def drives(run: Run) -> None:
    Path("cart.yaml").write_text(NOMINAL)
    for seed in (1, 2, 3):
        write(f"run{seed}.csv", seed=seed)


@pytest.fixture(scope="session")
def good_files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Files of every kind that commands read, once."""
    pytest.importorskip("rasterio", reason="maps need rasterio")
    pytest.importorskip("mcap", reason="records need mcap")
    folder = tmp_path_factory.mktemp("files")
    write_files(folder)
    return folder


@pytest.fixture
def files(run: Run, good_files: Path) -> None:
    """The same files in the folder of a run."""
    run("--version")
    shutil.copytree(good_files, Path(), dirs_exist_ok=True)
