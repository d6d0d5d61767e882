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


def noise_counts(reading, start):
    """Levels at which a policy that was trained with the noise of the test has more return than one without, and all; the means
    of the undisturbed returns, with noise and without."""
    levels, scores = {}, {}
    with open(RESULTS / reading / "training-noise.csv", newline="") as file:
        for row in csv.DictReader(file):
            if row["start"] != start or row["metric"] != "anr_h" or not row["level"]:
                continue
            scores[row["policy"], row["sweep"], float(row["level"])] = float(row["value"])
            levels.setdefault(row["sweep"], set()).add(float(row["level"]))
    better = asked = 0
    noisy, clean = [], []
    for agent in ("ppo", "rap"):
        for site in ("dynamics", "action", "observation"):
            sweep = f"{site} white"
            without = f"{agent} {site} 0"
            if site == "dynamics":  # the same training at all three sites
                clean.append(scores[without, sweep, 0])
            for level in sorted(levels[sweep])[1:]:
                trained = f"{agent} {site} {level:g}"
                better += scores[trained, sweep, level] > scores[without, sweep, level]
                asked += 1
                noisy.append(scores[trained, sweep, 0])
    return better, asked, sum(noisy) / len(noisy), sum(clean) / len(clean)


def test_what_the_readme_says_of_training_with_noise_follows_from_the_tables():
    readme = " ".join((ROOT / "README.md").read_text().split())
    tested, near = (noise_counts("authors-scripts", start) for start in ("x=0.55 theta=0.3", "random"))
    other = noise_counts("scg-2022", "random")
    counts = [f"at {better} of {asked} levels" for better, asked, *_ in (tested, near, other)]
    sentence = readme[readme.index("Trained with the noise of the test"):]
    assert [sentence.find(count) for count in counts] == sorted(sentence.find(count) for count in counts)
    assert all(count in sentence[:700] for count in counts)
    assert (f"Undisturbed they average {tested[2]:.2f} from the one start and {near[2]:.2f} from the others, those trained without "
            f"noise {tested[3]:.2f} and {near[3]:.2f}.") in sentence[:900]


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
