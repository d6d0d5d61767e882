"""Memory of large studies: what is kept of a cell is small, and does not grow with its episodes."""

import subprocess

import pytest
from conftest import PROGRAM, ROOT


@pytest.mark.parametrize("levels", [1_000, 10_000])
def test_a_study_keeps_little_of_a_cell(levels):
    command = [ROOT / "scripts/measure-cells", "--program", PROGRAM, "--cells", "1000", "10000", "--levels", str(levels)]
    # Small lists double as they grow, and a block of the rows that margins were measured from stays with its thread's heap:
    # 2.1 kB from 10^3 to 10^4 cells (without margins 1.3 kB; 6 once).
    command += ["--most", "2.6"]

    done = subprocess.run(command, capture_output=True, text=True, timeout=500)

    assert done.returncode == 0, done.stdout + done.stderr
