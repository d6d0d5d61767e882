"""Memory of large studies: what is kept of a cell is small, and does not grow with its episodes."""

import subprocess

import pytest
from conftest import PROGRAM, ROOT


@pytest.mark.parametrize("levels", [1_000, 30_000])
def test_a_study_grows_by_less_than_a_kilobyte_a_cell(levels):
    command = [ROOT / "scripts/measure-cells", "--program", PROGRAM, "--cells", "1000", "30000", "--levels", str(levels)]

    done = subprocess.run(command, capture_output=True, text=True, timeout=500)

    assert done.returncode == 0, done.stdout + done.stderr
