"""gust reproduce: a paper's studies, its claims, and a page that can be made again from the tables alone."""

import array
import csv
import json
import re
import shutil

import pytest
from conftest import PROGRAM, in_terminal

QUICK = ["reproduce", "paper", "--profile", "quick", "--threads", "2"]


def tables(folder):
    """Everything that a reproduction found, by file name; not when and where."""
    files = [path for path in folder.rglob("*.csv") if "store" not in path.parts]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def without_hash(description):
    """As earlier versions wrote it, which have no hash of it."""
    return json.dumps({key: value for key, value in json.loads(description).items() if key != "hash"})


@pytest.fixture(scope="module")
def small(tmp_path_factory, program):
    """One table under all readings, one seed of each training."""
    import subprocess
    folder = tmp_path_factory.mktemp("small")
    done = subprocess.run([program, *QUICK, "--only", "table-dr", "--seeds", "1"], cwd=folder, capture_output=True,
                          text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return folder, done


def test_answer_names_the_claims_and_says_that_it_is_a_miniature(small):
    _, done = small
    assert done.stdout.startswith("A miniature: ")
    for claim in ["C58", "C59", "C60", "C61"]:
        assert f"\n{claim}  open (1) " in done.stdout
    assert "Of 4 claims 4 are open; of their 19 parts " in " ".join(done.stdout.split())
    assert done.stdout.endswith("Page: paper-quick.gust/report.html\n")


def test_the_answer_counts_the_trainings_that_there_are(small):
    folder, done = small
    trainings = len(list((folder / "paper-quick.gust/store/train").iterdir()))
    with open(folder / "paper-quick.gust/claims.csv", newline="") as file:
        readings = {row["reading"] for row in csv.DictReader(file)} - {"as printed"}
    assert f"\n{trainings} trainings of 1 agent, and the regulators, were tested under {len(readings)} readings of the paper. " \
        in done.stdout.replace("\n", " ").replace("  ", "\n")


def test_verdicts_have_numbers_under_each_reading_that_bears_on_them(small):
    folder, _ = small
    with open(folder / "paper-quick.gust/claims.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["id"] == "C60"]
    assert [row["reading"] for row in rows] == [
        "scg-2022", "scg-default", "fixed start", "ranges added", "five million steps",
        "median of trainings", "rmse of safe-control-gym", "root of the sum", "as printed"]
    for row in rows[:-1]:
        assert row["seeds"] == {"undecided": "1", "not testable": "0"}[row["verdict"]] and float(row["estimate"])
    assert rows[-1]["verdict"] == "holds"
    assert float(rows[-1]["estimate"]) == pytest.approx(0.325 - 0.181)


def test_table_stands_beside_the_papers(small):
    folder, _ = small
    text = (folder / "paper-quick.gust/reproduce.md").read_text()
    assert "## Table S1: Range of domain randomisation" in text
    assert re.search(r"\| params x8 \| 6\.88 ± 0\.639 → \S+( \[[^]]*\])? ± \S+", text)


def test_scores_of_every_training_that_a_claim_asks_for_are_kept(small):
    folder, _ = small
    with open(folder / "paper-quick.gust/scores.csv", newline="") as file:
        curves = list(csv.DictReader(file))
    scores = array.array("f", (folder / "paper-quick.gust/scores.f32").read_bytes())
    first = 0
    for curve in curves:
        assert int(curve["first"]) == first
        first += int(curve["units"]) * int(curve["cells"])
    assert first == len(scores)
    with open(folder / "paper-quick.gust/scg-2022/table-dr.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    names = "policy", "sweep", "start", "metric"
    cells = {tuple(row[name] for name in names): row["value"] for row in rows if row["over"] not in ("training", "deviation")}
    compared = 0
    for curve in curves:
        if curve["study"] != "scg-2022/table-dr" or curve["cells"] != "1":
            continue
        key = tuple(curve[name] for name in names)
        units = scores[int(curve["first"]):int(curve["first"]) + int(curve["units"])]
        assert sum(units) / len(units) == pytest.approx(float(cells[key]), rel=1e-5)
        compared += 1
    assert compared > 10


def test_page_and_text_are_made_again_from_the_tables_alone(gust, tmp_path, small):
    shutil.copytree(small[0] / "paper-quick.gust", tmp_path / "copy", ignore=shutil.ignore_patterns("store"))
    before = {name: (tmp_path / "copy" / name).read_bytes() for name in ["report.html", "reproduce.md"]}
    for name in before:
        (tmp_path / "copy" / name).unlink()

    assert gust("report", "copy").stdout == "copy/report.html\n"

    assert {name: (tmp_path / "copy" / name).read_bytes() for name in before} == before


def test_run_again_does_nothing_and_finds_the_same(gust, tmp_path, small):
    shutil.copytree(small[0], tmp_path / "again")
    done = gust(*QUICK, "--only", "table-dr", "--seeds", "1", "--json", cwd=tmp_path / "again", seconds=60)
    assert done.stderr == ""  # no progress: nothing was missing
    assert tables(tmp_path / "again/paper-quick.gust") == tables(small[0] / "paper-quick.gust")
    answer = json.loads(done.stdout)
    assert answer["profile"] == "quick" and len(answer["claims"]) == 9 + 7 + 9 + 9 and answer["failures"] == []


def test_a_claim_is_told_with_all_its_parts_from_the_trainings_that_are_there(gust, tmp_path, small):
    shutil.copytree(small[0] / "paper-quick.gust", tmp_path / "done")
    before = tables(tmp_path / "done")
    told = gust(*QUICK, "--claim", "C61", "--seeds", "1", "--out", "done", seconds=60).stdout
    assert " ".join(told.split()).startswith(
        "C61: Under observation and action noise every range beats PPO, and high is the best scg-2022: open, ")
    assert told.count("    open, ") == 5 and "  r = low\n" in told
    assert "Other readings\n" in told and "as printed" in told
    parts = json.loads(gust(*QUICK, "--claim", "C61", "--seeds", "1", "--out", "done", "--json", seconds=60).stdout)
    assert {claim["id"] for claim in parts["claims"]} == {"C61"}
    asked = parts["claims"][0]
    assert [part["names"] for part in asked["parts"]] == ["r = low", "r = mid", "r = high", "r = low", "r = mid"]
    assert tables(tmp_path / "done") == before


def test_figure_without_trainings_takes_no_time_and_keeps_its_episodes(gust, tmp_path):
    gust(*QUICK, "--figure", "2", seconds=60)
    assert len(list((tmp_path / "paper-quick.gust/scg-2022").glob("disturbances-*.json"))) == 6
    page = (tmp_path / "paper-quick.gust/report.html").read_text()
    assert "The five disturbances" in page and '"episodes":[{' in page


@pytest.mark.parametrize(("arguments", "message"), [
    (["paperr"], "there is no reproduction 'paperr'; did you mean 'paper'?"),
    (["paper", "--profile", "quik"], "unknown profile 'quik'; did you mean 'quick'?"),
    (["paper", "--only", "wite"], "unknown figure 'wite'; did you mean 'white'?"),
    (["paper", "--claim", "C75"], "there is no claim 'C75'; did you mean"),
    (["paper", "--figure", "40"], "there is no Figure 40; there are Figure 1, "),
    (["paper", "--seeds", "0"], "--seeds"),
    (["paper", "--out", "/proc/x"], "/proc/x"),
    ([], "PAPER is required"),
])
def test_misuse_is_told_before_any_work(gust, tmp_path, arguments, message):
    done = gust("reproduce", *arguments, code=2, seconds=60)
    assert message in done.stderr
    assert not list(tmp_path.glob("paper*.gust"))


def test_tables_that_were_tampered_with_are_errors(gust, tmp_path, small):
    shutil.copytree(small[0] / "paper-quick.gust", tmp_path / "copy", ignore=shutil.ignore_patterns("store"))
    cells = tmp_path / "copy/scg-2022/table-dr.csv"
    good = cells.read_text()
    for bad, message in [(good.replace("\nPPO,", "\nPPI,", 1), "the study has no policy 'PPI'"),
                         (good.replace(",rmse_paper,", ",rmse_papre,", 1), "did you mean 'rmse_paper'?"),
                         (good[:-1].rpartition(",")[0], "cells where the header has"), ("", "the file is empty"),
                         (good + "PPO,,random,,,margin,1,1,1,10,seeds\n", "a margin without levels"),
                         (good.replace(",25,episodes", ",-1,episodes", 1), "'-1' is no whole number")]:
        cells.write_text(bad)
        assert message in gust("report", "copy", code=2).stderr
    claims = tmp_path / "copy/claims.csv"
    was = claims.read_text()
    cells.write_text(good)
    lines = was.splitlines(keepends=True)
    for path, good_one, bad in [(cells, good, good.replace(",0.", ",1.", 1)), (claims, was, was.replace("undecided", "holds", 1)),
                                (claims, was, lines[0]), (claims, was, was + lines[1])]:
        path.write_text(bad)
        assert f"{path.name}: has changed since it was written" in gust("report", "copy", code=2).stderr
        path.write_text(good_one)
    gust("report", "copy")
    cells.unlink()
    assert "table-dr.csv" in gust("report", "copy", code=2).stderr
    (tmp_path / "copy/reproduction.json").write_text("{}")
    assert "reproduction.json: is no description of a reproduction" in gust("report", "copy", code=2).stderr


def test_a_folder_that_holds_something_else_is_left_alone(gust, tmp_path, small):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/thesis.txt").write_text("mine")
    for asked in ([], ["--claim", "C21"]):
        assert "mine: holds something else" in gust(*QUICK, *asked, "--out", "mine", code=2, seconds=60).stderr
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["thesis.txt"]
    shutil.copytree(small[0] / "paper-quick.gust", tmp_path / "done")
    other = gust(*QUICK, "--only", "disturbances", "--out", "done", code=2, seconds=60)
    assert "done: holds what 'gust reproduce paper --only table-dr --seeds 1 --profile quick' found" in other.stderr
    assert tables(tmp_path / "done") == tables(small[0] / "paper-quick.gust")
    (tmp_path / "lqr.toml").write_text(
        'schema = 1\nname = "small"\nseed = 1\nplant = { kind = "cartpole" }\npolicy = [{ name = "lqr", kind = "lqr" }]\n')
    assert "done: holds what 'gust reproduce' found" in gust("run", "lqr.toml", "--out", "done", code=2).stderr
    gust("run", "lqr.toml", "--out", "study")
    assert "study: holds something else" in gust(*QUICK, "--out", "study", code=2, seconds=60).stderr


def test_page_of_agents_is_made_again_too(gust, tmp_path):
    """With learning curves, charts and an adversary's budget."""
    gust(*QUICK, "--only", "table-adversary", "--only", "disturbances", "--seeds", "1")
    names = ["report.html", "reproduce.md"]
    before = {name: (tmp_path / "paper-quick.gust" / name).read_bytes() for name in names}
    gust("report", "paper-quick.gust")
    assert {name: (tmp_path / "paper-quick.gust" / name).read_bytes() for name in names} == before


def test_plan_says_which_options_are_whose(gust):
    assert "gust: " in gust("plan", "paper", "--profile", "quick", "--only", "white").stderr
    assert "--set is for a study" in gust("plan", "paper", "--set", "seed=3", code=2).stderr
    assert "are for a paper" in gust("plan", "study.toml", "--seeds", "3", code=2).stderr


def test_kept_episodes_that_changed_are_errors(gust, tmp_path):
    gust(*QUICK, "--only", "disturbances")
    path = tmp_path / "paper-quick.gust/scg-2022/disturbances-2.json"
    good = path.read_text()
    path.write_text(good.replace('"member":0', '"member":3'))
    assert "disturbances-2.json: has changed since it was written" in gust("report", "paper-quick.gust", code=2).stderr
    path.write_text(good[:-9])
    assert "disturbances-2.json: holds no episodes" in gust("report", "paper-quick.gust", code=2).stderr
    path.write_text(good)
    description = tmp_path / "paper-quick.gust/reproduction.json"
    description.write_text(description.read_text().replace('"seeds": null', '"seeds": 2000000000'))
    assert "reproduction.json: has changed since it was written" in gust("report", "paper-quick.gust", code=2).stderr
    description.write_text(without_hash(description.read_text()))
    assert "1 to 10000 seeds" in gust("report", "paper-quick.gust", code=2).stderr


def test_verdicts_fit_the_terminal(small):
    """Every word of them, in lines as wide as the terminal; in a file or a pipe 80 columns wide."""
    folder, done = small
    assert "PPO over low and mid to high" in " ".join(done.stdout.split())
    assert all(len(line) <= 80 for line in done.stdout.splitlines())
    seen = in_terminal([PROGRAM, *QUICK, "--only", "table-dr", "--seeds", "1"], folder, columns=70)
    assert all(len(line) <= 70 for line in seen.splitlines())
    assert " ".join(seen.split()) == " ".join(done.stdout.split())


def test_so_far_judges_what_is_there_and_runs_nothing(gust, tmp_path, small):
    shutil.copytree(small[0], tmp_path / "some")
    trained = sorted((tmp_path / "some/paper-quick.gust/store/train").iterdir())
    shutil.rmtree(trained[0])
    evaluated = sorted((tmp_path / "some/paper-quick.gust/store/evaluate").iterdir())
    shutil.rmtree(evaluated[0])
    so_far = [*QUICK, "--only", "table-dr", "--seeds", "1", "--so-far"]
    refused = gust(*so_far, cwd=tmp_path / "some", code=2).stderr
    assert "paper-quick.gust: has results that lack 0 trials, this store lacks 2; choose another --out" in refused
    assert tables(tmp_path / "some/paper-quick.gust") == tables(small[0] / "paper-quick.gust")
    (tmp_path / "some/paper-quick.gust/reproduction.json").unlink()  # as if it had been stopped

    done = gust(*so_far, cwd=tmp_path / "some", code=1)
    assert done.stderr == ""
    assert " ".join(done.stdout.split()).startswith(
        "A miniature: 10 % of the training steps, 1 seed of each training, 2 known trials are still to be run.")
    assert len(list((tmp_path / "some/paper-quick.gust/store/train").iterdir())) == len(trained) - 1
    assert "2 known trials are still to be run" in (tmp_path / "some/paper-quick.gust/report.html").read_text()

    reported = gust("report", "some/paper-quick.gust", code=1).stderr
    assert reported.startswith("gust: A miniature: ") and reported.endswith("2 known trials are still to be run.\n")

    gust(*QUICK, "--only", "table-dr", "--seeds", "1", cwd=tmp_path / "some", seconds=120)
    assert tables(tmp_path / "some/paper-quick.gust") == tables(small[0] / "paper-quick.gust")


def test_a_report_of_trials_that_failed_names_them(gust, tmp_path, small):
    shutil.copytree(small[0] / "paper-quick.gust", tmp_path / "copy", ignore=shutil.ignore_patterns("store"))
    description = tmp_path / "copy/reproduction.json"
    text = description.read_text()
    assert '"failures": []' in text
    description.write_text(without_hash(text.replace('"failures": []', '"failures": ["failed: train sac seed 1"]')))

    done = gust("report", "copy", code=1)

    assert (done.stdout, done.stderr) == ("copy/report.html\n", "gust: failed: train sac seed 1\n")


def test_so_far_of_nothing_tests_no_claim(gust, tmp_path):
    done = gust(*QUICK, "--only", "white", "--only", "training-noise", "--only", "step", "--so-far", "--json", code=1,
                seconds=60)
    answer = json.loads(done.stdout)
    assert {claim["verdict"] for claim in answer["claims"] if claim["reading"] != "as printed"} == {"not testable"}
    assert {claim["seeds"] for claim in answer["claims"]} == {0}
    assert answer["missing"] > 100 and "known trials are still to be run" in answer["label"]
    gust("report", "paper-quick.gust", code=1)
    assert "known trials are still to be run" in (tmp_path / "paper-quick.gust/reproduce.md").read_text()


@pytest.mark.parametrize("command", [("show", "r"), ("export", "r", "--csv", "x.csv"), ("eval", "lqr", "--study", "r")])
def test_what_reads_a_study_says_what_would_be_right_for_a_reproduction(gust, tmp_path, command):
    (tmp_path / "r").mkdir()
    (tmp_path / "r/reproduction.json").write_text("{}")

    assert gust(*command, code=2).stderr == (
        "gust: r: holds what 'gust reproduce' found, and no single study; 'gust report r' writes its page, its tables "
        "are the files READING/STUDY.csv\n")


def test_a_part_that_is_asked_for_twice_counts_once(gust):
    only = (*QUICK, "--json", "--only", "disturbances")
    assert gust(*only, "--only", "disturbances").stdout == gust(*only).stdout  # in the folder of the first


@pytest.mark.parametrize("command", ["plan", "reproduce"])
def test_help_names_the_profiles_and_the_folder(gust, command):
    text = gust(command, "--help").stdout
    assert "--profile paper|quick" in text and "--out DIR" in text
