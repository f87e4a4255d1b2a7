"""Files of a cart in the folder of a run."""

from pathlib import Path

import pytest

from tests.cli.calibrate_drives import NOMINAL, write
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
