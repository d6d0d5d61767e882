"""gust reproduce FOLDER: a paper that is not the one in the program."""

import csv
import json
import pathlib
import re
import shutil
import subprocess

import pytest
from conftest import PROGRAM, ROOT

SMALL = ROOT / "tests/papers/small"


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """The small paper, reproduced: the folder with it and its results, and what was printed."""
    folder = tmp_path_factory.mktemp("paper")
    shutil.copytree(SMALL, folder / "small")
    ran = subprocess.run([PROGRAM, "reproduce", "small"], cwd=folder, capture_output=True, text=True, timeout=300)
    assert ran.returncode == 0, ran.stderr
    return folder, ran.stdout


@pytest.fixture
def paper(tmp_path):
    """A copy of the paper that a test may change."""
    return pathlib.Path(shutil.copytree(SMALL, tmp_path / "small"))


def change(file, old, new):
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))


def verdicts(folder):
    with open(folder / "claims.csv", newline="") as file:
        return {(row["id"], row["reading"]): row for row in csv.DictReader(file)}


def test_every_claim_is_judged_under_both_readings(done):
    folder, printed = done
    found = verdicts(folder / "small.gust")
    assert {key: row["verdict"] for key, row in found.items()} == {
        (claim, reading): verdict
        for claim, verdict in [("push", "holds"), ("cliff", "fails"), ("short", "undecided")]
        for reading in ["as written", "pushed at the tip"]}
    words = " ".join(printed.split())
    assert words.startswith("push shown 2/2 The regulator keeps more") and "short open (2) 2/2" in words
    assert "Of 3 claims 1 is shown, 1 open, 1 refuted; of their 5 parts 4 are true at the estimate." in words
    assert printed.endswith("Page: small.gust/report.html\n")


def test_a_verdict_is_what_the_tables_give(done):
    """The area under a curve over shares of its grid, by the trapezoidal rule, from the cells that were written."""
    folder, _ = done
    for reading, where in [("as written", "as-written"), ("pushed at the tip", "pushed-at-the-tip")]:
        area = {}
        with open(folder / f"small.gust/{where}/push.csv", newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["sweep"] == "push" and row["start"] == "random"]
        for policy in ["lqr", "none"]:
            curve = [(float(row["level"]), float(row["value"])) for row in rows
                     if (row["policy"], row["metric"]) == (policy, "anr_h")]
            assert [level for level, _ in curve] == [0, 0.2, 0.4, 2]
            area[policy] = sum((b[0] - a[0]) * (a[1] + b[1]) / 2 for a, b in zip(curve, curve[1:])) / 2
        expected = area["lqr"] - area["none"]
        assert float(verdicts(folder / "small.gust")["push", reading]["estimate"]) == pytest.approx(expected, rel=1e-5)


def test_page_and_text_have_its_figures_its_table_and_no_word_of_another_paper(done):
    folder, _ = done
    text = (folder / "small.gust/reproduce.md").read_text()
    assert "## Figure 1: Return under a push" in text and "## Table 1: Heavier carts" in text
    assert re.search(r"\| as built \| 0\.05 ± 0\.01 → 0\.0\d+ ", text)
    assert "Made by `gust reproduce small --profile paper`" in text
    page = (folder / "small.gust/report.html").read_text()
    assert "How hard a cart-pole may be pushed, reproduced" in page and "A linear regulator tolerates a push" in page
    for word in ["RAAC", "RARL", "author's settings", "start of the paper's tests", "scg-2022 "]:
        assert word not in text


def test_results_alone_make_the_page_again(gust, tmp_path, done):
    shutil.copytree(done[0] / "small.gust", tmp_path / "copy", ignore=shutil.ignore_patterns("store"))
    before = {name: (tmp_path / "copy" / name).read_bytes() for name in ["report.html", "reproduce.md"]}
    for name in before:
        (tmp_path / "copy" / name).unlink()

    assert gust("report", "copy").stdout == "copy/report.html\n"

    assert {name: (tmp_path / "copy" / name).read_bytes() for name in before} == before


def test_results_keep_the_paper_and_notice_a_change_of_it(gust, tmp_path, done):
    shutil.copytree(done[0] / "small.gust", tmp_path / "copy", ignore=shutil.ignore_patterns("store"))
    kept = tmp_path / "copy/inputs"
    assert {file.name: file.read_bytes() for file in kept.iterdir()} == {file.name: file.read_bytes() for file in SMALL.iterdir()}
    for file in kept.iterdir():
        good = file.read_bytes()
        file.write_bytes(good.replace(b"e", b"a", 1))
        assert f"copy/inputs/{file.name}: has changed since it was written" in gust("report", "copy", code=2).stderr
        file.write_bytes(good)
    gust("report", "copy")
    (kept / "push.toml").unlink()
    assert "copy/inputs/push.toml" in gust("report", "copy", code=2).stderr


def test_what_results_keep_is_a_paper_itself(gust, tmp_path, done):
    shutil.copytree(done[0], tmp_path / "again")
    answer = json.loads(gust("reproduce", "small.gust/inputs", "--json", cwd=tmp_path / "again").stdout)
    assert answer["paper"] == "small" and answer["missing"] == 0 and len(answer["claims"]) == 6


def test_an_edited_claim_is_judged_anew_without_a_new_trial(gust, tmp_path, done):
    shutil.copytree(done[0], tmp_path / "again")
    change(tmp_path / "again/small/claims.toml", "> 0.99 * score('lqr')", "< 0.99 * score('lqr')")
    asked = gust("reproduce", "small", cwd=tmp_path / "again")
    assert asked.stderr == ""  # no progress: nothing was missing
    assert verdicts(tmp_path / "again/small.gust")["cliff", "as written"]["verdict"] == "holds"
    gust("report", "small.gust", cwd=tmp_path / "again")


def test_parts_of_it_can_be_asked_for(gust, paper):
    claim = " ".join(gust("reproduce", "small", "--claim", "short").stdout.split())
    assert claim.startswith("short: A short training") and claim.count("open, true") == 3
    figure = gust("reproduce", "small", "--figure", "1", "--out", "one").stdout
    assert "Not asked: short needs mass (--only)." in " ".join(figure.split())
    only = gust("reproduce", "small", "--only", "push", "--only", "push", "--out", "one")  # the same choice
    assert only.stderr == "" and not list((paper.parent / "one").glob("*/mass.csv"))


def test_so_far_and_the_plan_know_what_is_missing(gust, paper):
    planned = json.loads(gust("plan", "small", "--json").stdout)
    assert {trial["what"].rsplit(", ", 1)[1] for trial in planned} == {"as written", "pushed at the tip"}
    assert sum(trial["kind"] == "train" for trial in planned) == 2 and not any(trial["done"] for trial in planned)
    before = gust("reproduce", "small", "--so-far", code=1).stdout
    assert "known trials are still to be run" in before
    gust("reproduce", "small")
    assert all(trial["done"] for trial in json.loads(gust("plan", "small", "--json").stdout))


def test_a_miniature_has_a_folder_of_its_own(gust, paper):
    assert gust("reproduce", "small", "--profile", "quick").stdout.startswith("A miniature: 10 % of the training steps.")
    assert (paper.parent / "small-quick.gust/report.html").exists()


def test_a_study_may_ask_for_policies_in_the_folder(gust, tmp_path, paper, done):
    policy = next((done[0] / "small.gust/policies").iterdir())
    (paper / "nets").mkdir()
    shutil.copy(policy, paper / "nets/ours.onnx")
    change(paper / "push.toml", '{ name = "none"', '{ name = "net", kind = "onnx", file = "nets/*.onnx" }, { name = "none"')
    gust("reproduce", "small")
    shutil.rmtree(paper)
    page = (tmp_path / "small.gust/report.html").read_bytes()
    assert (tmp_path / "small.gust/inputs/nets/ours.onnx").read_bytes() == policy.read_bytes()
    shutil.copy(policy, tmp_path / "small.gust/inputs/nets/another.onnx")  # not of the paper as it was run
    gust("report", "small.gust")
    assert (tmp_path / "small.gust/report.html").read_bytes() == page


def test_another_paper_of_the_name_does_not_replace_the_results(gust, tmp_path, paper):
    change(paper / "paper.toml", 'name   = "small"', 'name   = "paper"')
    gust("reproduce", "small", "--only", "push")
    told = gust("reproduce", "paper", "--only", "white", code=2).stderr
    assert "paper.gust: holds what 'gust reproduce small --only push --profile paper' found" in told


@pytest.mark.parametrize(("file", "old", "new", "message"), [
    ("paper.toml", 'study = "push"', 'study = "pull"', "small/paper.toml:19:9: there is no small/pull.toml"),
    ("paper.toml", 'study = "push"', 'study = "../push"', "small/paper.toml:19:9: 'study' becomes a file's name"),
    ("paper.toml", "schema = 1", "schema = 2", "small/paper.toml:2:10: a paper begins with 'schema = 1'"),
    ("paper.toml", "shows = [\"curves\"", "shows = [\"curve\"",
     "small/paper.toml:23:10: unknown part of a page 'curve'; did you mean 'curves'?"),
    ("paper.toml", "title  =", "titel  =", "small/paper.toml:4:10: unknown key 'titel' in a paper; did you mean 'title'?"),
    ("paper.toml", '["push"]', '["push", "puhs"]', "unknown study 'puhs'; did you mean 'push'?"),
    ("paper.toml", '"pushed at the tip"', '"As written!"', "the readings 'as written' and 'As written!' have one folder"),
    ("paper.toml", '"pushed at the tip"', '"Store"', "results have a folder 'store' of another kind"),
    ("paper.toml", '"pushed at the tip"', '"—"', "the name of a reading needs a letter or a digit"),
    ("paper.toml", '"as written"', '"as written"\nstart = "nominl"',
     "small/paper.toml:8:1: the study 'mass' has no start 'nominl'"),
    ("paper.toml", "tap_point=tip", "tap_point=tap",
     "small/paper.toml:12:1: in push.toml under 'pushed at the tip': readings.tap_point=tap: 'tap_point' must be one of"),
    ("paper.toml", 'table  = "mass"', 'table  = "masses"', "small/tables.csv has no table 'masses'; did you mean 'mass'?"),
    ("paper.toml", 'metric = "rmse_scg"', "", "a figure with a table needs a 'metric'"),
    ("paper.toml", 'metric = "rmse_scg"', 'metric = "anr"', "the study 'mass' has no metric 'anr'"),
    ("paper.toml", 'says  = "A linear', 'heat = [{ name = "m", policies = "lqr {level}", sweep = "push" }]\nsays  = "A linear',
     "the study 'push' has no policy 'lqr 0'"),
    ("claims.toml", 'figure   = "push"', 'figure   = "posh"',
     "small/claims.toml:8:12: unknown study 'posh'; did you mean 'push'?"),
    ("claims.toml", '["mass", "push"]', '["mass", "pusj"]', "small/claims.toml:24:19: unknown study 'pusj'"),
    ("claims.toml", "primary", "primry", "small/claims.toml:9:11: unknown key 'primry' in a claim; did you mean 'primary'?"),
    ("claims.toml", "score('none', 'push')", "score('non', 'push')", "small/claims.toml:12:12: "),
    ("claims.toml", "for c in carts", "for c in cart", "small/claims.toml:26:10: "),
    ("claims.toml", 'id       = "push"', 'id       = "cliff"', "small/claims.toml:14:1: duplicate claim cliff"),
    ("push.toml", 'kind = "lqr"', 'kind = "lqrr"', "small/push.toml:6:"),
    ("push.toml", 'kind = "zero" }', 'kind = "onnx", file = "../net.onnx" }', "small/push.toml:6:"),
    ("paper.toml", 'metric = "rmse_scg"', 'metric = "rmse_scg"\nspread = "seeds"', "unknown spread 'seeds'; known are episodes"),
    ("tables.csv", "0.4,0.1", "0.4x,0.1", "small/tables.csv:3"),
])
def test_what_is_wrong_in_the_folder_is_told_with_its_place_before_any_work(gust, tmp_path, paper, file, old, new, message):
    change(paper / file, old, new)
    done = gust("reproduce", "small", code=2, seconds=60)
    assert message in done.stderr and done.stderr.count("\n") == 1 and done.stdout == ""
    assert not list(tmp_path.glob("*.gust"))


def test_the_paper_may_have_words_of_its_own(gust, tmp_path, paper, done):
    assert "2 trainings of 1 agent were tested under 2 readings of the paper." in " ".join(done[1].split())
    words = paper / "findings.toml"
    words.write_text('[[finding]]\nmeasure = "trainings"\nsays = "We trained {trainings} ({agents}), for {readings}."\n')
    assert "We trained 2 trainings (1 agent), for 2 readings." in " ".join(gust("reproduce", "small").stdout.split())
    shutil.rmtree(paper)
    gust("report", "small.gust")
    assert "We trained 2 trainings (1 agent), for 2 readings." in (tmp_path / "small.gust/reproduce.md").read_text()


@pytest.mark.parametrize(("words", "message"), [
    ('measure = "noise"\nsays = "x"', "small/findings.toml:2:11: unknown measurement 'noise'"),
    ('measure = "trainings"\nsays = "{agent}"', "small/findings.toml:3:8: unknown number of the measurement 'agent'; did you mean"),
    ('measure = "trainings"', "small/findings.toml:1:1: a finding needs a 'says'"),
    ('measure = "trainings"\nsays = "x"\n[[finding]]\nmeasure = "trainings"\nsays = "y"',
     "small/findings.toml:4:1: two findings measure 'trainings'"),
])
def test_words_that_nothing_fills_are_told_with_their_place(gust, paper, words, message):
    (paper / "findings.toml").write_text(f"[[finding]]\n{words}\n")
    assert message in gust("reproduce", "small", code=2).stderr


def test_deviations_are_compared_where_they_are_of_the_same_thing(gust, paper, done):
    """What a paper prints as ± may be over seeds; ours is over episodes, and told only where the paper's is, too."""
    ours = re.compile(r"\| as built \| 0\.05 ± 0\.01 → 0\.0\d+ \[[^]]+\] ± 0\.")
    assert not ours.search((done[0] / "small.gust/reproduce.md").read_text())
    change(paper / "paper.toml", 'metric = "rmse_scg"', 'metric = "rmse_scg"\nspread = "episodes"')
    gust("reproduce", "small")
    assert ours.search((paper.parent / "small.gust/reproduce.md").read_text())


@pytest.mark.parametrize("file", ["paper.toml", "claims.toml", "push.toml", "tables.csv"])
def test_a_missing_file_is_named(gust, paper, file):
    (paper / file).unlink()
    assert f"there is no small/{file}" in gust("reproduce", "small", code=2).stderr
    assert f"there is no small/{file}" in gust("plan", "small", code=2).stderr


@pytest.mark.parametrize(("arguments", "message"), [
    (["smal"], "there is no reproduction 'smal'; it is 'paper', or a folder with a paper.toml"),
    (["small/paper.toml"], "there is no reproduction 'small/paper.toml'"),
    (["."], ".: is no paper: there is no ./paper.toml"),
    (["small", "--profile", "quik"], "unknown profile 'quik'; did you mean 'quick'?"),
    (["small", "--only", "wite"], "unknown figure 'wite'; there are push, mass"),
    (["small", "--claim", "C1"], "there is no claim 'C1'; they are push to short"),
    (["small", "--figure", "2"], "there is no Figure 2; there are Figure 1, Table 1"),
    (["small", "--out", "small"], "small: holds something else; choose another --out"),
])
def test_misuse_is_told(gust, tmp_path, paper, arguments, message):
    assert message in gust("reproduce", *arguments, code=2, seconds=60).stderr
    assert not list(tmp_path.glob("*.gust"))
    assert sorted(path.name for path in paper.iterdir()) == sorted(path.name for path in SMALL.iterdir())


def test_the_worked_example_of_the_documents_runs(gust, tmp_path):
    text = (ROOT / "docs/extending.md").read_text()
    blocks = re.findall(r"^```toml\n# (my-paper/\S+)\n(.*?)^```$", text, re.M | re.S)
    assert [name for name, _ in blocks] == ["my-paper/paper.toml", "my-paper/claims.toml", "my-paper/push.toml"]
    (tmp_path / "my-paper").mkdir()
    for name, content in blocks:
        (tmp_path / name).write_text(content)
    gust("reproduce", "my-paper")
    assert {key: row["verdict"] for key, row in verdicts(tmp_path / "my-paper.gust").items()} == {
        ("push", "as written"): "holds", ("push", "pushed at the tip"): "holds"}


def test_the_documents_name_every_key(gust):
    """What parse_paper takes, as its own errors tell it."""
    described = (ROOT / "docs/formats.md").read_text()
    source = (ROOT / "gust/paper/paper.cpp").read_text()
    lists = re.findall(r"check_keys\(\w+,\s*\{(.*?)\}", source, re.S) + re.findall(r"known = \{(.*?)\};", source, re.S)
    keys = {key for names in lists for key in re.findall(r'"(\w+)"', names)}
    assert len(keys) > 30
    assert {key for key in keys if f"`{key}" not in described and f"[{key}]" not in described} == set()
