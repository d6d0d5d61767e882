"""Memory of large studies: what is kept of a cell is small, and does not grow with its episodes."""

import subprocess

import pytest
from conftest import PROGRAM, ROOT


@pytest.mark.parametrize("levels", [1_000, 10_000])
def test_a_study_keeps_little_of_a_cell(levels):
    command = [ROOT / "scripts/measure-cells", "--program", PROGRAM, "--cells", "1000", "10000", "--levels", str(levels)]
    command += ["--most", "1.4"]  # small lists double as they grow; from 10^3 to 10^5 cells it is 0.8 kB, and was 6 once

    done = subprocess.run(command, capture_output=True, text=True, timeout=500)

    assert done.returncode == 0, done.stdout + done.stderr
