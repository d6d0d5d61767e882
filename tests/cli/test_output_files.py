"""Output goes over nothing that gust did not write as that kind of output."""

import shutil
import subprocess

import pytest
from conftest import PROGRAM

STUDY = """
schema = 1
name   = "small"
plant  = { kind = "cartpole", steps = 10 }

[evaluate]
episodes = 2

[[policy]]
name = "zero"
kind = "zero"
"""

TRAIN = ["train", "ppo", "--plant", "cartpole", "--steps", "400", "--out"]


def gust(folder, *command, code=0):
    done = subprocess.run([PROGRAM, *map(str, command)], cwd=folder, capture_output=True, text=True, timeout=120)
    assert done.returncode == code, done.stderr
    return done.stderr


def contents(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("finished")
    (folder / "study.toml").write_text(STUDY)
    gust(folder, "run", "study.toml", "--out", "out")
    gust(folder, *TRAIN, "a.onnx")
    gust(folder, "export", "out", "--csv", "a.csv", "--sqlite", "a.db")
    gust(folder, "store", "pack", "out", "a.pack")
    return folder


@pytest.fixture
def folder(tmp_path, finished):
    shutil.copytree(finished, tmp_path / "w")
    return tmp_path / "w"


OUTPUTS = {
    "csv": ["export", "out", "--csv"],
    "db": ["export", "out", "--sqlite"],
    "onnx": TRAIN,
    "pack": ["store", "pack", "out"],
}
OTHERS = [
    "out/study.toml",
    "out/inputs.json",
    "out/report.html",
    "out/store/store.json",
    "out/store/new.onnx",
    "out/store/evaluate/new.onnx",
    "a.csv",
    "a.db",
    "a.onnx",
    "a.pack",
    "study.toml",
]


@pytest.mark.parametrize("kind", OUTPUTS)
@pytest.mark.parametrize("target", OTHERS)
@pytest.mark.parametrize("through", ["path", "link"])
def test_only_its_own_kind_is_replaced_and_nothing_in_a_store(folder, kind, target, through):
    if target == f"a.{kind}":
        gust(folder, *OUTPUTS[kind], target)
        return
    path = target
    if through == "link":
        path = f"link.{kind}"
        (folder / path).symlink_to(target)
    before = contents(folder)

    said = gust(folder, *OUTPUTS[kind], path, code=2)

    assert said.count("\n") == 1
    assert contents(folder) == before


@pytest.mark.parametrize("kind", ["csv", "db", "onnx"])
def test_force_replaces_a_file_but_no_part_of_results(folder, kind):
    (folder / f"mine.{kind}").write_text("my own notes\n")

    assert "--force" in gust(folder, *OUTPUTS[kind], f"mine.{kind}", code=2)
    gust(folder, *OUTPUTS[kind], f"mine.{kind}", "--force")

    for target in ("out/study.toml", "out/inputs.json", "out/store/store.json", "out/store/new.onnx"):
        before = contents(folder)
        gust(folder, *OUTPUTS[kind], target, "--force", code=2)
        assert contents(folder) == before


def test_an_empty_file_is_replaced(folder):
    (folder / "empty.csv").touch()
    gust(folder, "export", "out", "--csv", "empty.csv")


def test_two_tables_under_two_names_of_one_file_are_refused(folder):
    assert "name two files" in gust(folder, "export", "out", "--csv", "b", "--sqlite", "./b", code=2)


def test_files_beside_an_sqlite_file_stay(folder):
    (folder / "a.db.part").write_text("mine")
    (folder / "a.db-journal").write_text("mine")

    gust(folder, "export", "out", "--sqlite", "a.db")

    assert (folder / "a.db.part").read_text() == "mine" and (folder / "a.db-journal").read_text() == "mine"


def test_no_run_goes_into_a_store_or_over_a_page_of_somebody_else(folder):
    assert "lies in the store" in gust(folder, "run", "study.toml", "--out", "out/store/new", code=2)
    (folder / "out/report.html").write_text("my own page")
    assert "no page of gust" in gust(folder, "run", "study.toml", "--out", "out", code=2)
    assert (folder / "out/report.html").read_text() == "my own page"


def test_a_page_goes_where_it_is_asked_and_leaves_the_results_alone(folder):
    before = contents(folder / "out")
    gust(folder, "report", "out", "--out", "page/there")

    assert contents(folder / "out") == before
    assert (folder / "page/there/report.html").exists()
    (folder / "page/report.html").write_text("my own page")
    assert "is no page of gust" in gust(folder, "report", "out", "--out", "page", code=2)
    assert "lies in the store" in gust(folder, "report", "out", "--out", "out/store/new", code=2)
    assert not (folder / "out/store/new").exists()
