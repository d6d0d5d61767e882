"""scripts/check-words finds the phrases that documents must not have, and nothing in plain sentences."""

import subprocess

import pytest
from conftest import ROOT


def check(tmp_path, text, name="text.md"):
    (tmp_path / name).write_text(text)
    done = subprocess.run([ROOT / "scripts/check-words", tmp_path / name], capture_output=True, text=True, timeout=60)
    assert done.returncode == (1 if done.stdout.strip() else 0), done.stderr
    return done.stdout.strip()


@pytest.mark.parametrize("text", [
    "Its numbers are none.", "A state that is no\nnumber.", "The slow copies follow.", "A Lesson ends.", "An episode that is none of the study's.",
    "A push is stood up to 0.029 N.", "The LQR stands 0.05 N.", "RARL stands a push better.", "Parameters are drawn anew.",
    "The debt of updates.", "On transitions from the memory.", "A policy that holds the pole.", "Three of five forget it.", "Strangers are refused.",
    "A shape that is none.", "An episode is none of this study's.", "It draws a transition's level anew.", "Updates owed wait.", "A follower follows.",
])
def test_a_riddle_is_named_with_its_line(tmp_path, text):
    said = check(tmp_path, f"# Title\n\n{text}\n")
    assert "text.md:3: '" in said and ": write " in said and "\n" not in said


@pytest.mark.parametrize("text", [
    "No number depends on it.", "The lesson of that.", "A claim stands on the page.", "The pole stays upright.", "Memory is the peak.",
    "The page draws the mean against both.", "`nudge` is an argument.", "A process holds a lock.",
    "An Error if there is none.", "A unit that is none of these.", "Those that draw; others begin anew.",
])
def test_plain_sentences_pass(tmp_path, text):
    assert check(tmp_path, text) == ""


@pytest.mark.parametrize(("name", "text"), [
    ("one.cpp", "\n\nthrow Error(cat(at, \": the slow copy is damaged\"));\n"),
    ("one.cpp", "#include \"a.h\"\n\nf(1'000, '\"', \"a memory \"\n      \"of transitions\");\n"),
    ("one.cpp", "\n\nconst char* kText = R\"(a \"slow\n copy\")\";\n"),
    ("one.h", "\n\n/// A memory\n/// of transitions.\nint f();\n"),
    ("one.h", "\n\nint f();  ///< the slow copy\n"),
    ("one.h", "\n/* one\n   slow copy */\n"),
    ("one.h", "\n\nconstexpr const char* kText = \"the slow copy\";  // https://example.org\n"),
])
def test_what_a_program_says_and_what_a_header_tells_are_read(tmp_path, name, text):
    said = check(tmp_path, text, name)
    assert f"{name}:3: '" in said and ": write " in said and "\n" not in said


@pytest.mark.parametrize(("name", "text"), [
    ("one.cpp", "// the slow copy\nint f();  /* a memory of transitions */\n"),
    ("one.cpp", "f(\"a memory\", \"of transitions\"); g(\"a slow\" + copy);\n"),
    ("one.cpp", "#include \"gust/follower.h\"\nint nudge = follower(stranger);\n"),
    ("one.h", "int nudge = 1'000;  ///< `nudge` is added to \"that\"\n// is no\nint number = f(\"// a slow\");  // copy\n"),
])
def test_code_and_comments_of_bodies_are_not(tmp_path, name, text):
    assert check(tmp_path, text, name) == ""
