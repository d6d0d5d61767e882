"""gust import: rows that another program measured give margins, claims and a page, without a trial of gust."""

import csv
import json
import pathlib
import random

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent

# The rig: a leaky tank, level x, held at 1 by a valve. It is no plant of gust, and nothing of it is run by gust.
STUDY = """
schema   = 1
name     = "rig"
seed     = 5
question = "How much leak do two valves tolerate?"
plant    = { kind = "cartpole", preset = "scg-default" }
policy   = [{ name = "stiff", kind = "zero" }, { name = "soft", kind = "zero" }]

[evaluate]
episodes = 30
start    = "nominal"
metrics  = ["anr_h"]

[[sweep]]
name     = "leak"
site     = "action"
waveform = "step"
levels   = { from = 0, to = 1, count = 6 }

[[claim]]
id    = "stiffer"
text  = "The stiff valve tolerates more"
holds = "margin(score('stiff', 'leak')) > margin(score('soft', 'leak'))"

[[claim]]
id    = "soft-falls"
where = { policy = "soft", sweep = "leak", level = 1.0 }
holds = "anr_h >= 0.9"
"""
LEVELS = [0, 0.2, 0.4, 0.6, 0.8, 1.0]
SLOPE = {"stiff": 0.2, "soft": 0.5}  # of the score against the leak


def score(policy, level, episode):
    """What the rig scored: falls straight with the leak; the noise of an episode is the same at every level."""
    noise = random.Random(episode).gauss(0, 0.001)
    return 0.8 + noise - SLOPE[policy] * level


@pytest.fixture
def rig(tmp_path):
    """The study and the rows of the rig, in the order in which it measured."""
    (tmp_path / "rig.toml").write_text(STUDY)
    rows = []
    for policy in SLOPE:
        for sweep, levels in (("none", [0]), ("leak", LEVELS)):
            for level in levels:
                for episode in range(30):
                    value = score(policy, level, episode)
                    rows.append([policy, sweep, level, episode, "anr_h", repr(value)])
                    rows.append([policy, sweep, level, episode, "survival", 1])
    with open(tmp_path / "rows.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["policy", "sweep", "level", "episode", "metric", "value"])
        writer.writerows(rows)
    return tmp_path


def test_rows_of_another_program_give_margins_claims_and_a_page(gust, rig):
    answer = json.loads(gust("import", "rig.toml", "rows.csv", "--out", "out.gust", "--json").stdout)

    for margin in answer["margins"]:  # where the straight line has lost a tenth
        mean = sum(score(margin["policy"], 0, episode) for episode in range(30)) / 30
        assert margin["margin"] == pytest.approx(0.1 * mean / SLOPE[margin["policy"]], rel=1e-9)
        assert margin["low"] <= margin["margin"] <= margin["high"]
        assert margin["unit"] == "episodes" and margin["n"] == 30
    verdicts = {claim["id"]: claim["verdict"] for claim in answer["claims"]}
    assert verdicts == {"stiffer": "holds", "soft-falls": "fails"}
    assert answer["missing"] == []

    page = (rig / "out.gust/report.html").read_text()
    assert "gust import rig.toml rows.csv --out out.gust" in page
    assert "measured elsewhere" in page
    assert json.loads(gust("show", "out.gust", "--json").stdout) == answer
    compared = gust("compare", "stiff", "soft", "out.gust").stdout
    assert "stiff is ahead" in compared
    assert gust("report", "out.gust").returncode == 0


def test_what_gust_exported_comes_back_as_it_was(gust, tmp_path):
    text = (ROOT / "studies/demo.toml").read_text()
    small = text.replace("steps = 300_000", "steps = 1_200").replace("[1, 2, 3, 4, 5]", "[1, 2]")
    assert small != text
    (tmp_path / "small.toml").write_text(small)
    fewer = ["--set", "evaluate.episodes=5"]
    run = json.loads(gust("run", "small.toml", *fewer, "--out", "run.gust", "--json").stdout)
    gust("export", "run.gust", "--csv", "rows.csv")
    back = json.loads(gust("import", "small.toml", "rows.csv", *fewer, "--out", "back.gust", "--json").stdout)
    assert back == run
    assert len(run["margins"]) > 4


def test_foreign_rows_are_no_trials(gust, rig):
    gust("import", "rig.toml", "rows.csv", "--out", "out.gust")
    assert "measured elsewhere" in gust("export", "out.gust", "--csv", "x.csv", code=2).stderr
    assert "holds rows that 'gust import' took" in gust("run", "rig.toml", "--out", "out.gust", code=2).stderr
    (rig / "out.gust/rows.csv").write_text("policy,metric,value\nstiff,anr_h,1\n")
    assert "is not what was imported" in gust("show", "out.gust", code=2).stderr


def test_a_table_that_lacks_a_sweep_is_told(gust, rig):
    lines = (rig / "rows.csv").read_text().splitlines()
    (rig / "rows.csv").write_text("\n".join(line for line in lines if not line.startswith("soft,leak")) + "\n")
    result = gust("import", "rig.toml", "rows.csv", code=1)
    assert "soft · leak" in result.stderr
    assert "stiff" in result.stdout


@pytest.mark.parametrize(
    "old, new, told",
    [
        ("stiff,leak,0.2,0,anr_h", "stif,leak,0.2,0,anr_h", "no policy 'stif'; did you mean 'stiff'?"),
        ("stiff,leak,0.2,0,anr_h", "stiff,leek,0.2,0,anr_h", "no sweep 'leek'"),
        ("stiff,leak,0.2,0,anr_h", "stiff,leak,0.25,0,anr_h", "episode 0 has no 'anr_h'"),
        ("stiff,leak,0.2,0,anr_h", "stiff,leak,0.2,1,anr_h", "once more"),
        ("stiff,leak,0.2,0,anr_h", "stiff,leak,0.2,0,0,anr_h", "7 cells where the header has 6"),
        ("metric,value", "metric,values", "no column 'value'; did you mean 'values'?"),
    ],
)
def test_a_wrong_row_is_told_with_its_line_before_anything_is_written(gust, rig, old, new, told):
    text = (rig / "rows.csv").read_text()
    assert old in text
    (rig / "rows.csv").write_text(text.replace(old, new, 1))
    result = gust("import", "rig.toml", "rows.csv", code=2)
    assert told in result.stderr
    assert not (rig / "rig.gust").exists()
