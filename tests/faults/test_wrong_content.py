"""Files that are whole and wrong: what is missing is told by every command, what is wrong is found, named and mended."""

import json
import os
import shutil
import sqlite3
import subprocess

import pytest
from conftest import PROGRAM
from manifests import hash64, rehash
from runs import Runs

STEPS = 20_000

AUTO = """
[[sweep]]
name     = "step"
site     = "action"
waveform = { kind = "step" }
levels   = "auto"
"""


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    runs = Runs(tmp_path_factory.mktemp("finished"), STEPS)
    text = runs.study.read_text().replace("episodes = 10", "episodes = 3") + AUTO
    runs.study.write_text(text + '\n[[claim]]\nid = "c"\ntext = "t"\nwhere = { policy = "lqr" }\nholds = "survival >= 0.5"\n')
    runs.finish("out")
    return runs, runs.results("out")


@pytest.fixture
def runs(tmp_path, finished):
    copy = Runs(tmp_path, STEPS)
    copy.study.write_text(finished[0].study.read_text())
    shutil.copytree(finished[0].folder / "out", tmp_path / "out")
    return copy


def stored(runs, kind, name):
    return sorted((runs.folder / "out/store" / kind).glob(f"*/{name}"))


@pytest.mark.parametrize(
    ("kind", "name"), [("search", "level.txt"), ("train", "curve.csv"), ("evaluate", "rows.bin"), ("margin", "levels.txt")]
)
def test_every_command_lists_what_is_missing_and_exits_with_1(runs, kind, name):
    damaged = stored(runs, kind, name)[0]
    damaged.write_bytes(damaged.read_bytes() + b" ")

    for command in (["show", "out"], ["show", "out", "--json"], ["report", "out"], ["export", "out", "--csv", "a.csv"],
                    ["export", "out", "--sqlite", "a.db"], ["export", "out", "--csv", "b.csv", "--sqlite", "b.db"],
                    ["compare", "lqr", "ppo", "out"], ["store", "pack", "out", "a.pack"], ["store", "check", "out"]):  # fmt: skip
        said = runs.gust(*command, code=1)
        assert command[1] in ("pack", "check") or "not in the store: " in said, command
    with sqlite3.connect(runs.folder / "b.db") as database:
        assert database.execute("SELECT count(*) FROM missing").fetchone()[0] > 0

    runs.finish("out")
    runs.gust("show", "out")


def test_json_names_what_is_missing(runs):
    stored(runs, "search", "level.txt")[0].write_bytes(b"1.25 ")

    shown = subprocess.run([PROGRAM, "show", "out", "--json"], cwd=runs.folder, capture_output=True)

    missing = json.loads(shown.stdout)["missing"]
    assert any(trial.startswith("search ") for trial in missing)
    assert "what needs automatic levels that were not found" in missing


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("study.toml", ">= 0.5", "<= 0.5"),
        ("study.toml", 'name = "lqr"', 'name = "ppo2"'),
        ("inputs.json", '"settings": []', '"settings": ["evaluate.episodes=2"]'),
        ("inputs.json", "study.toml", "other.toml"),
    ],
)
def test_a_touched_study_is_told_by_its_file_and_run_again_by_gust_run(runs, finished, name, old, new):
    path = runs.folder / "out" / name
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))

    for command in (["show", "out"], ["report", "out"], ["export", "out", "--csv", "a.csv"], ["compare", "lqr", "ppo", "out"]):
        said = runs.gust(*command, code=2)
        assert said.startswith(f"gust: out/{name}: is not what the run wrote") and said.count("\n") == 1
    assert not (runs.folder / "a.csv").exists()

    runs.finish("out")
    assert runs.results("out") == finished[1]


def test_a_folder_of_an_earlier_version_has_no_hashes_and_is_read(runs):
    path = runs.folder / "out/inputs.json"
    inputs = json.loads(path.read_text())
    for name in ("hash", "text", "readings"):
        inputs.pop(name)
    path.write_text(json.dumps(inputs))

    said = runs.gust("show", "out")

    assert said.count("\n") == 1 and "without hashes" in said


def cut_rows(folder):
    rows = (folder / "rows.bin").read_bytes()
    (folder / "rows.bin").write_bytes(rows[:-7])


def change_header(old, new):
    """Another header in the rows; their own hash is of 64 bits, so the header is made as the program would refuse it too."""

    def change(folder):
        rows = (folder / "rows.bin").read_bytes()
        magic = b"gust rows 1\n"
        size = int.from_bytes(rows[len(magic) : len(magic) + 4], "little")
        header = rows[len(magic) + 4 : len(magic) + 4 + size]
        assert old in header
        header = header.replace(old, new)
        rest = rows[len(magic) + 4 + size + 8 :]
        head = magic + len(header).to_bytes(4, "little") + header + hash64(header).to_bytes(8, "little")
        (folder / "rows.bin").write_bytes(head + rest)

    return change


def exit_code(wrong, command):
    """Wrong traces are found when they are read, by what shows them; all else is missing."""
    return (0 if command == "export" else 2) if wrong.startswith("traces") else 1


WRONG = {
    "cut rows": cut_rows,
    "rows of a huge number of cells": change_header(b'"cells":8', b'"cells":9223372036854775807'),
    "rows from other starts": change_header(b'"starts":["nominal","random"]', b'"starts":["elsewhere","random"]'),
    "rows from fewer starts": change_header(b'"starts":["nominal","random"]', b'"starts":["nominal"]'),
    "rows of other episodes": change_header(b'"episodes":3', b'"episodes":2'),
    "traces that are none": lambda folder: (folder / "traces.json").write_text("[1]"),
    "no rows": None,
}
WRONG_FOR_THE_STUDY = ("rows from other starts", "rows from fewer starts", "rows of other episodes")  # a pack has no study


@pytest.mark.parametrize("wrong", WRONG)
def test_right_hashes_and_wrong_content_are_found_named_and_healed(runs, finished, wrong):
    folder = next(path.parent for path in stored(runs, "evaluate", "rows.bin") if path.parent.name.startswith("action-white"))
    if WRONG[wrong] is not None:
        WRONG[wrong](folder)
    rehash(folder, drop=("rows.bin",) if wrong == "no rows" else ())
    before = {path: path.read_bytes() for path in (runs.folder / "out").rglob("*") if path.is_file()}

    for command in (["show", "out"], ["export", "out", "--csv", "a.csv"], ["report", "out"]):
        said = runs.gust(*command, code=exit_code(wrong, command[0]))
        if wrong.startswith("traces") and command[0] == "export":
            continue
        assert str(folder.relative_to(runs.folder)) in said and "gust store repair" in said, said
        assert "internal error" not in said
    runs.gust("store", "check", "out", code=1)
    if wrong not in WRONG_FOR_THE_STUDY:
        assert str(folder.relative_to(runs.folder)) in runs.gust("store", "pack", "out", "a.pack", code=1)
    before.pop(runs.folder / "out/report.html")
    assert {path: path.read_bytes() for path in before} == before

    shutil.copytree(runs.folder / "out", runs.folder / "repaired")
    said = runs.finish("out")
    assert "damaged: " in said and "computed again" in said
    assert runs.results("out") == finished[1]

    runs.gust("store", "repair", "repaired")
    runs.gust("store", "check", "repaired")
    runs.finish("repaired")
    assert runs.results("repaired")[0] == finished[1][0]


@pytest.mark.parametrize("text", [None, "", "{", '{"format":"x"}'])
def test_repair_writes_the_description_of_a_store_again(runs, finished, text):
    path = runs.folder / "out/store/store.json"
    whole = path.read_bytes()
    path.unlink() if text is None else path.write_text(text)
    assert runs.gust("store", "check", "out", code=1) == ""
    assert "'gust store repair out/store'" in runs.gust("show", "out", code=2)

    runs.gust("store", "repair", "out")

    assert path.read_bytes() == whole
    runs.gust("store", "check", "out")
    assert runs.results("out") == finished[1]


def test_repair_refuses_a_store_of_another_version_and_a_folder_that_is_none(runs):
    (runs.folder / "out/store/store.json").write_text('{"format":7,"gust":"9.1.0"}\n')
    assert "format 7" in runs.gust("store", "repair", "out", code=2)
    (runs.folder / "empty").mkdir()
    assert "no store lies here" in runs.gust("store", "repair", "empty", code=2)
    assert list((runs.folder / "empty").iterdir()) == []


def test_check_is_clean_after_a_run_and_names_leftovers_which_repair_removes(runs):
    store = runs.folder / "out/store"
    assert runs.gust("store", "check", "out") == ""
    (store / ".timings.json.aside").write_text("x")
    (store / "aside/99999-0").mkdir(parents=True)

    checked = subprocess.run([PROGRAM, "store", "check", "out", "--json"], cwd=runs.folder, capture_output=True)

    assert checked.returncode == 1
    found = json.loads(checked.stdout)
    assert found["damaged"] == []
    assert [os.path.basename(item["path"]) for item in found["leftover"]] == [".timings.json.aside", "99999-0"]
    runs.gust("store", "repair", "out")
    assert runs.gust("store", "check", store) == ""


def test_two_results_for_one_trial_raise_an_alarm(runs, finished):
    runs.gust("store", "pack", "out", "first.pack")
    folder = stored(runs, "train", "curve.csv")[0].parent
    curve = folder / "curve.csv"
    curve.write_text(curve.read_text().replace("1", "2"))
    rehash(folder)

    said = runs.gust("store", "unpack", "first.pack", "out", code=1)

    assert said.startswith("gust: two results for one trial: ")
    assert str(folder.relative_to(runs.folder)) in said and "first.pack: train/" in said and "curve.csv" in said


def test_doctored_timings_are_not_believed(runs):
    path = runs.folder / "out/store/timings.json"
    times = json.loads(path.read_text())
    path.write_text(json.dumps({kind: {"predicted": 1e-308, "seconds": -1e308} for kind in times}))

    said = runs.gust("plan", "study.toml", "--out", "new")

    assert "inf" not in said and "-" not in said.split("about")[1]


def test_hashes_of_this_test_are_those_of_the_program(runs):
    folder = stored(runs, "evaluate", "rows.bin")[0].parent
    before = (folder / "manifest.json").read_bytes()
    rehash(folder)
    assert (folder / "manifest.json").read_bytes() == before
