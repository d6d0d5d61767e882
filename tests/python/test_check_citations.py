"""scripts/check-citations finds what points nowhere, in every form, and lets pass what is right."""

import subprocess

import pytest
from conftest import ROOT

PLANTS = "# Plants\n\n## 1. Cart-pole\n\n### 1.3 The `rail`\n\n| oracle | answer |\n| --- | --- |\n| 8.6.6 | 1 |\n"


@pytest.fixture
def tree(tmp_path):
    for name, text in {
        "docs/plants.md": PLANTS, "docs/algorithms.md": PLANTS, "docs/decisions/0004-margins.md": "# 4. Margins\n",
        "docs/catalog.md": "Source: spec: tasks 1.3\n", "README.md": "[plants](docs/plants.md#13-the-rail), [top](#here)\n\n## Here\n",
    }.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    (tmp_path / "gust").mkdir()
    return tmp_path


def check(tree, name, text):
    """What the script says when a file has this text."""
    (tree / name).write_text(text)
    done = subprocess.run([ROOT / "scripts/check-citations", tree], capture_output=True, text=True, timeout=60)
    assert done.returncode == (1 if done.stdout.strip() else 0), done.stderr
    return done.stdout.strip()


@pytest.mark.parametrize("text", [
    "// see docs/plants.md 1.3.", "/// the rail (docs/plants.md\n/// 1.3)", '"PyBullet; docs/plants.md 1"', "// docs/plants.md has it",
    "// decision 4", "// oracle 8.6.6", 'TEST_CASE("8.6.6 a bandit") {', "for (auto task : tasks) 1.3;", "tasks.row(2)",
])
def test_what_points_somewhere_passes(tree, text):
    assert check(tree, "gust/one.cpp", text) == ""


@pytest.mark.parametrize(("text", "line", "what"), [
    ("\n// see docs/plants.md 1.4", 2, "docs/plants.md has no section 1.4"),
    ("/// the rail (docs/plants.md\n/// 2)", 1, "docs/plants.md has no section 2"),
    ("// docs/plant.md 1.3", 1, "there is no docs/plant.md"),
    ("// decision 5", 1, "there is no decision 5"),
    ("// oracle 8.6.7", 1, "docs/algorithms.md has no oracle 8.6.7"),
    ("// oracles 8.6.6 to 8.6.8", 1, "docs/algorithms.md has no oracle 8.6.8"),
    ('\n\nTEST_CASE("8.6.9 a bandit") {', 3, "docs/algorithms.md has no oracle 8.6.9"),
    ("// (tasks 1.3)", 1, "is no document of this project"),
    ("// (algorithms\n// 4.2)", 1, "is no document of this project"),
    ('"spec: tasks A11"', 1, "is no document of this project"),
])
def test_what_points_nowhere_is_named_with_its_line(tree, text, line, what):
    said = check(tree, "gust/one.cpp", text)
    assert said.startswith(f"gust/one.cpp:{line}: ") and what in said and "\n" not in said


@pytest.mark.parametrize(("text", "what"), [
    ("[a](plant.md)", "there is no plant.md"), ("[a](plants.md#14-the-rail)", "plants.md has no heading #14-the-rail"),
    ("\n[a](#nowhere)\n", "agents.md has no heading #nowhere"), ("![a](../picture.png)", "there is no ../picture.png"),
])
def test_a_link_that_leads_nowhere_is_named(tree, text, what):
    assert what in check(tree, "docs/agents.md", text)


def test_links_of_the_web_and_in_code_are_left_alone(tree):
    assert check(tree, "docs/agents.md", "[a](https://example.org/x.md) `[b](c.md)`\n```\n[d](e.md)\n```\n") == ""
