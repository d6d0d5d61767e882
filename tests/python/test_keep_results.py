"""scripts/keep-results takes what a reproduction has found and nothing else, or changes nothing."""

import json
import shutil
import subprocess

import pytest
from conftest import ROOT

README = """# gust
What was found (`gust reproduce paper`):

old

![What became of each claim](docs/reproduction.png)
"""
FOUND = "# Reproduced\n\n**Not the full run: 2 known trials are still to be run.**\n\n- One.\n- Two.\n- Three.\n- Four.\n- Five.\n- Six.\n- Seven.\n\n## Table\n"
FILES = ["claims.csv", "scg-2022/white.csv", "scg-2022/white-1.json"]


@pytest.fixture
def tree(tmp_path):
    """A checkout with results of before, and a new reproduction with files that are none of its own."""
    (tmp_path / "gust/scripts").mkdir(parents=True)
    shutil.copy(ROOT / "scripts/keep-results", tmp_path / "gust/scripts")
    (tmp_path / "gust/README.md").write_text(README)
    written = {name: name for name in FILES}
    written |= {name: "stale" for name in ("scg-2022/gone.csv", "mine.json", "a.onnx", "store/train/x/policy.onnx")}
    written |= {"reproduction.json": json.dumps({"files": {name: "hash" for name in FILES}}), "reproduce.md": FOUND,
                "policies/ppo.onnx": "policy", "../gust/results/paper/old.csv": "old", "../gust/docs/reproduce.md": "old"}
    for name, text in written.items():
        path = tmp_path / "new" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


def keep(tree, code=0):
    """Runs the script; returns what it said."""
    done = subprocess.run([tree / "gust/scripts/keep-results", "new"], cwd=tree, capture_output=True, text=True, timeout=60)
    assert done.returncode == code, done.stderr
    return done.stderr


def files(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_what_the_description_names_is_kept_and_nothing_else(tree):
    keep(tree)

    assert set(files(tree / "gust/results/paper")) == {*FILES, "reproduction.json", "policies/ppo.onnx"}
    assert (tree / "gust/docs/reproduce.md").read_text() == FOUND
    assert (tree / "gust/README.md").read_text() == README.replace(
        "old\n", "One. Not the full run: 2 known trials are still to be run. What is missing counts as not testable.\n\n"
        "- Two.\n- Three.\n- Four.\n- Five.\n- Six.\n")


@pytest.mark.parametrize(("path", "text", "message"), [
    ("gust/README.md", README.replace("![What", "![Which"), "README.md: has no place for the findings"),
    ("gust/README.md", "# gust\n", "README.md: has no place for the findings"),
    ("new/scg-2022/white.csv", None, "new: lacks scg-2022/white.csv"),
    ("new/reproduction.json", None, "new: holds no results of a reproduction: no reproduction.json"),
])
def test_what_cannot_be_kept_leaves_everything_as_it_was(tree, path, text, message):
    (tree / path).unlink()
    if text is not None:
        (tree / path).write_text(text)
    before = files(tree / "gust")

    assert keep(tree, code=2).startswith(f"keep-results: {message}")

    assert files(tree / "gust") == before
