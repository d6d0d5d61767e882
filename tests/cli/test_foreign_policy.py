"""Policies that other programs made: what they observe, the unit of their actions, and those that give NaN."""

import csv
import json
import math
import sqlite3
import sys
from collections import Counter

import numpy as np
import onnx
import pytest
from conftest import ROOT

sys.path.insert(0, str(ROOT / "tests/python"))
from onnx_graphs import Graph  # noqa: E402

GAIN = np.array([0.1, 0.25, 2.5, 0.6], dtype=np.float32)  # per m, m/s, rad, rad/s: force / 10 N, cart-pole of scg-2022
DEGREES = 180 / math.pi
RANDOM = ("--plant", "cartpole", "--start", "random", "--episodes", "5")


def save(folder, name, gain, transform=None):
    """A gain as a network: action = gain . observation, and what `transform` makes of it."""
    gain = np.asarray(gain, dtype=np.float32)
    g = Graph(inputs=len(gain))
    value = g.op("MatMul", "obs", g.const(gain.reshape(-1, 1)))
    onnx.save(g.model(transform(g, value) if transform else value), folder / name)
    return name


def score(gust, *arguments):
    rows = json.loads(gust("eval", *arguments, "--json").stdout)
    return sum(row["anr_h"] for row in rows) / len(rows)


FOREIGN = {
    "other order": ([2.5, 0.6, 0.1, 0.25], "theta,theta_dot,x,x_dot"),
    "angle to the left": ([0.1, 0.25, -2.5, -0.6], "x,x_dot,-theta,-theta_dot"),
    "degrees": ([0.1, 0.25, 2.5 / DEGREES, 0.6 / DEGREES], '["x", "x_dot", { theta = "deg" }, { theta_dot = "deg/s" }]'),
    "scales": ([0.001, 0.25, 2.5, 0.3], '["x=cm", "x_dot", "theta", { theta_dot = 2 }]'),
    "a constant beside it": ([0.1, 0.25, 2.5, 0.6, 9], "x,x_dot,theta,theta_dot,0"),
}


@pytest.mark.parametrize("kind", FOREIGN)
def test_policy_of_another_interface_scores_like_the_same_gain_in_gusts(gust, tmp_path, kind):
    gain, observe = FOREIGN[kind]
    own = score(gust, save(tmp_path, "own.onnx", GAIN), *RANDOM, "--units", "normalised")
    foreign = save(tmp_path, "foreign.onnx", gain)

    assert own > 0.85
    if len(gain) == 4:
        assert score(gust, foreign, *RANDOM, "--units", "normalised") < own - 1e-3
    assert score(gust, foreign, *RANDOM, "--units", "normalised", "--observe", observe) == pytest.approx(own, abs=1e-5)


def test_policy_may_observe_a_part_of_the_state(gust, tmp_path):
    whole = score(gust, save(tmp_path, "whole.onnx", [0, 0, 2.5, 0.6]), *RANDOM, "--units", "normalised")
    save(tmp_path, "part.onnx", [2.5, 0.6])

    assert score(gust, "part.onnx", *RANDOM, "--units", "normalised", "--observe=theta,theta_dot") == whole
    error = gust("eval", "part.onnx", *RANDOM, code=2).stderr
    assert "the policy takes 2 numbers; the plant cartpole is observed by 4" in error and "'observe'" in error


def test_unit_and_sign_of_actions_are_said_in_one_of_two_ways(gust, tmp_path):
    own = score(gust, save(tmp_path, "own.onnx", GAIN), *RANDOM, "--units", "normalised")
    save(tmp_path, "newton.onnx", 10 * GAIN)
    save(tmp_path, "left.onnx", -10 * GAIN)

    assert score(gust, "newton.onnx", *RANDOM, "--units", "N") == pytest.approx(own, abs=1e-6)
    assert score(gust, "left.onnx", *RANDOM, "--act", '{ unit = "N", scale = -1 }') == pytest.approx(own, abs=1e-6)
    assert score(gust, "newton.onnx", *RANDOM, "--act", "{ scale = 0.1 }") == pytest.approx(own, abs=1e-6)
    assert "say the same" in gust("eval", "newton.onnx", *RANDOM, "--units", "N", "--act", "N", code=2).stderr


def test_unit_that_nobody_says_is_told_with_what_speaks_against_it(gust, tmp_path):
    save(tmp_path, "own.onnx", GAIN)
    save(tmp_path, "newton.onnx", 10 * GAIN)

    silent = gust("eval", "own.onnx", *RANDOM).stderr
    newton = gust("eval", "newton.onnx", *RANDOM, "--json")

    assert silent.count("own.onnx does not say the unit of its actions: they are taken as normalised (force = 10 N") == 1
    assert "lie beyond" not in silent
    assert "lie beyond -1 to 1 (up to " in newton.stderr and 'units = "N"' in newton.stderr
    assert len(json.loads(newton.stdout)) == 5
    for known in (["own.onnx", "--units", "normalised"], ["newton.onnx", "--units", "N"], ["newton.onnx", "--act", "N"],
                  ["newton.onnx", "--preset", "scg-default"]):
        assert "does not say the unit" not in gust("eval", known[0], *RANDOM, *known[1:]).stderr


def test_foreign_policy_that_fails_at_once_gets_a_hint(gust, tmp_path):
    save(tmp_path, "wrong.onnx", [0.1, 0.25, -2.5, -0.6])

    done = gust("eval", "wrong.onnx", *RANDOM, "--units", "normalised")

    assert done.stderr.count("fails within a second in 5 of 5 undisturbed episodes") == 1
    assert "x [m], x_dot [m/s], theta [rad], theta_dot [rad/s]" in done.stderr
    assert gust("eval", "zero", "--plant", "cartpole", "--start", "0,0,0.19,5").stderr == ""  # gust's own


@pytest.mark.parametrize("options, wanted", [
    (["--observe", "thata,x"], "unknown component 'thata'; did you mean 'theta'?"),
    (["--observe", "theta=dg"], "did you mean 'deg'?"),
    (["--units", "Nm"], "'Nm' is no unit of the action force [N]"),
    (["--observe", "theta,x"], "the policy takes 4 numbers; 'observe' gives 2"),
])
def test_mistake_in_an_interface_is_an_error(gust, tmp_path, options, wanted):
    save(tmp_path, "own.onnx", GAIN)
    assert wanted in gust("eval", "own.onnx", *RANDOM, *options, code=2).stderr
    assert "is for a policy from a file" in gust("eval", "lqr", *RANDOM, *options, code=2).stderr


STUDY = """schema = 1
name = "foreign"
plant = { kind = "cartpole" }
[evaluate]
episodes = 5
start = ["random"]
[[policy]]
name = "own"
kind = "onnx"
file = "own.onnx"
units = "normalised"
[[policy]]
name = "other"
kind = "onnx"
file = "other.onnx"
{keys}
[[sweep]]
name = "action step"
site = "action"
waveform = { kind = "step" }
levels = [0, 1, 2]
"""


def test_study_says_how_a_policy_observes_and_acts(gust, tmp_path):
    save(tmp_path, "own.onnx", GAIN)
    save(tmp_path, "other.onnx", 10 * GAIN[[2, 3, 0, 1]] * [1, 1, -0.01, -1])
    keys = 'observe = ["theta", "theta_dot", { "-x" = "cm" }, "-x_dot"]\nunits = "N"'
    (tmp_path / "s.toml").write_text(STUDY.replace("{keys}", keys))

    done = gust("run", "s.toml", "--json")
    gust("export", "foreign.gust", "--csv", "rows.csv")

    margins = {entry["policy"]: entry for entry in json.loads(done.stdout)["margins"]}
    assert done.stderr.count("warning") == 0
    assert margins["other"]["undisturbed"] == pytest.approx(margins["own"]["undisturbed"], abs=1e-5)


def test_study_tells_of_a_policy_that_fails_at_once_and_of_a_unit_that_nobody_says(gust, tmp_path):
    save(tmp_path, "own.onnx", GAIN)
    save(tmp_path, "other.onnx", [0.1, 0.25, -2.5, -0.6])
    (tmp_path / "s.toml").write_text(STUDY.replace("{keys}", ""))

    done = gust("run", "s.toml")
    page = (tmp_path / "foreign.gust/report.html").read_text()

    assert done.stderr.count("policy 'other': it fails within a second in 5 of 5 undisturbed episodes") == 1
    assert done.stderr.count("other.onnx does not say the unit of its actions") == 1
    assert "fails within a second in 5 of 5" in page and "does not say the unit" in page
    assert "fails within" not in gust("eval", "own", "--study", "foreign.gust").stderr


BROKEN = {
    "NaN": lambda g, value: g.op("Div", g.op("Mul", value, g.const(np.float32([0]))), g.const(np.float32([0]))),
    "an infinite action": lambda g, value: g.op("Div", g.const(np.float32([1])), g.op("Mul", value, g.const(np.float32([0])))),
}


@pytest.mark.parametrize("kind", BROKEN)
def test_policy_that_gives_no_number_is_told_once_with_step_and_state(gust, tmp_path, kind):
    save(tmp_path, "other.onnx", GAIN, BROKEN[kind])
    start = ("--plant", "cartpole", "--start", "0.25,0,0.125,0", "--units", "normalised")

    table = gust("eval", "other.onnx", *start, "--episodes", "3", code=1)
    rows = gust("eval", "other.onnx", *start, "--json", code=1)

    said = f"the policy gave {kind} at step 0, state x = 0.25 m, x_dot = 0 m/s, theta = 0.125 rad, theta_dot = 0 rad/s"
    assert table.stderr.count(said) == rows.stderr.count(said) == 1
    assert "-nan" not in table.stdout + rows.stdout
    json.loads(rows.stdout, parse_constant=lambda word: pytest.fail(word))


@pytest.mark.parametrize("kind", BROKEN)
def test_study_goes_on_with_a_policy_that_gives_no_number(gust, tmp_path, kind):
    save(tmp_path, "own.onnx", GAIN)
    save(tmp_path, "other.onnx", GAIN, BROKEN[kind])
    study = STUDY.replace("{keys}", 'units = "normalised"')
    (tmp_path / "s.toml").write_text(study)

    done = gust("run", "s.toml")
    again = gust("run", "s.toml", "--json")
    gust("export", "foreign.gust", "--csv", "rows.csv", "--sqlite", "rows.db")
    printed = done.stdout + done.stderr + again.stdout + (tmp_path / "rows.csv").read_text()

    assert done.stderr.count(f"policy 'other': the policy gave {kind} at step 0, state x = ") == 1
    assert again.stderr.count(f"the policy gave {kind} at step 0") == 1
    assert f"the policy gave {kind} at step 0" in (tmp_path / "foreign.gust/report.html").read_text()
    assert "-nan" not in printed
    json.loads(again.stdout, parse_constant=lambda word: pytest.fail(word))
    with open(tmp_path / "rows.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if (row["policy"], row["metric"]) == ("own", "anr_h")]
    episodes = Counter(row["level"] for row in rows)
    assert {"0", "1", "2"} <= set(episodes) and set(episodes.values()) <= {5, 10}
    assert min(float(row["value"]) for row in rows) >= 0
    texts = sqlite3.connect(tmp_path / "rows.db").execute("SELECT count(*) FROM episodes WHERE typeof(value) = 'text'")
    assert texts.fetchone() == (0,)
