"""What a study prints when it is done: every line fits, on a terminal and elsewhere."""

import subprocess

import pytest
from conftest import PROGRAM, in_terminal

STUDY = """
schema = 1
name   = "summary"
plant  = { kind = "cartpole" }

[evaluate]
episodes = 3

POLICIES

[[sweep]]
name     = "observation triangle"
site     = "observation"
waveform = "triangle"
levels   = [0, 0.1, 0.3]
"""
POLICIES = "\n".join(f'[[policy]]\nname = "weight {r} on effort"\nkind = "lqr"\nr = [{r}]' for r in range(1, 9))


def printed_at(folder, columns):
    """What `gust show` prints on a terminal of so many columns, or into a pipe."""
    command = [PROGRAM, "show", "summary.gust"]
    if columns is None:
        return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout
    return in_terminal(command, folder, columns)


def test_a_study_without_levels_says_so(gust, tmp_path):
    (tmp_path / "study.toml").write_text(STUDY.replace("POLICIES", POLICIES).partition("[[sweep]]")[0])

    assert gust("run", "study.toml").stdout == (
        "No margins: nothing grows level by level. The page shows what was measured.\n\nPage: summary.gust/report.html\n")


@pytest.mark.parametrize("columns", [80, 120, None, 400])
def test_margins_of_many_policies_fit_in_blocks(gust, tmp_path, columns):
    (tmp_path / "study.toml").write_text(STUDY.replace("POLICIES", POLICIES))
    gust("run", "study.toml")

    lines = printed_at(tmp_path, columns).splitlines()

    assert max(map(len, lines)) <= (columns or 100)
    tables = sum(line.startswith("sweep") for line in lines)
    assert tables == 2 if columns == 400 else tables > 2  # there are two starts
    assert all(sum(f"weight {r} on effort" in line for line in lines) == 2 for r in range(1, 9))
