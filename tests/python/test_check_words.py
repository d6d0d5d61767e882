"""scripts/check-words finds the phrases that documents must not have, and nothing in plain sentences."""

import subprocess

import pytest
from conftest import ROOT


def check(tmp_path, text):
    (tmp_path / "text.md").write_text(text)
    done = subprocess.run([ROOT / "scripts/check-words", tmp_path / "text.md"], capture_output=True, text=True, timeout=60)
    assert done.returncode == (1 if done.stdout.strip() else 0), done.stderr
    return done.stdout.strip()


@pytest.mark.parametrize("text", [
    "Its numbers are none.", "A state that is no\nnumber.", "The slow copies follow.", "A Lesson ends.", "An episode that is none of the study's.",
    "A push is stood up to 0.029 N.", "The LQR stands 0.05 N.", "RARL stands a push better.", "Parameters are drawn anew.",
    "The debt of updates.", "On transitions from the memory.", "A policy that holds the pole.", "Three of five forget it.", "Strangers are refused.",
])
def test_a_riddle_is_named_with_its_line(tmp_path, text):
    said = check(tmp_path, f"# Title\n\n{text}\n")
    assert "text.md:3: '" in said and ": write " in said and "\n" not in said


@pytest.mark.parametrize("text", [
    "No number depends on it.", "The lesson of that.", "A claim stands on the page.", "The pole stays upright.", "Memory is the peak.",
    "The page draws the mean against both.", "`nudge` is an argument.", "A process holds a lock.",
])
def test_plain_sentences_pass(tmp_path, text):
    assert check(tmp_path, text) == ""
