"""results/paper is what the code of today produces: page and text are made again, trainings and measurements repeated."""

import csv
import filecmp
import shutil
import subprocess

import onnx
import pytest
from conftest import ROOT

RESULTS = ROOT / "results/paper"
STUDY = "table-adversary"
PACK = ROOT / f"results/trainings/{STUDY}.pack"


@pytest.fixture(scope="module")
def folder(tmp_path_factory, program):
    """A result folder with the trainings of the study, and nothing measured."""
    folder = tmp_path_factory.mktemp("paper") / "paper.gust"
    subprocess.run([program, "store", "unpack", PACK, folder], check=True, timeout=300)
    return folder


def test_the_text_is_made_of_the_tables(gust, tmp_path):
    shutil.copytree(RESULTS, tmp_path / "paper")
    gust("report", "paper")
    assert filecmp.cmp(tmp_path / "paper/reproduce.md", ROOT / "docs/reproduce.md", shallow=False)


def test_the_readme_leads_with_what_was_found():
    opening = (ROOT / "docs/reproduce.md").read_text().partition("\n## ")[0]
    findings = [line[2:] for line in opening.splitlines() if line.startswith("- ")]
    readme = " ".join((ROOT / "README.md").read_text().split())
    assert len(findings) > 2
    for sentence in findings[:6]:
        assert sentence in readme


def test_measurements_of_the_committed_policies_give_the_committed_tables_and_verdicts(gust, folder):
    trained = {path.name for path in (folder / "store/train").iterdir()}

    gust("reproduce", "paper", "--only", STUDY, "--out", folder, seconds=600)

    assert {path.name for path in (folder / "store/train").iterdir()} == trained
    for reading in ("scg-2022", "scg-default"):
        assert filecmp.cmp(folder / reading / f"{STUDY}.csv", RESULTS / reading / f"{STUDY}.csv", shallow=False)
    ours, committed = [list(csv.DictReader(open(path / "claims.csv", newline=""))) for path in (folder, RESULTS)]
    assert ours and ours == [row for row in committed if row["id"] in {row["id"] for row in ours}]


@pytest.mark.parametrize("agent", ["ppo", "rarl"])
def test_a_training_of_full_length_gives_the_committed_policy(gust, tmp_path, agent):
    gust("train", agent, "--plant", "cartpole", "--preset", "scg-2022", "--steps", "1000000", "--seed", "1", "--out",
         "policy.onnx", seconds=300)
    ours = onnx.load(tmp_path / "policy.onnx").graph
    assert ours == onnx.load(RESULTS / f"policies/cartpole-{agent}-s1.onnx").graph
