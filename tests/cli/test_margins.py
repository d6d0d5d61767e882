"""Margins do not depend on the levels of a study, and are what fresh episodes at them show."""

import json
import math
import statistics

import pytest

CARTPOLE = """
schema = 1
name = "margins"
seed = 11
plant = { kind = "cartpole", preset = "scg-2022" }

[evaluate]
start = "random"

[[policy]]
name = "lqr"
kind = "lqr"
"""

PUSH = """
[[sweep]]
name = "push"
site = "dynamics"
waveform = { kind = "step", offset = 2 }
levels = LEVELS
"""


def margins(gust, tmp_path, text, out, *settings, code=0):
    """The margins of a study as gust run --json tells them, by policy, sweep and start."""
    (tmp_path / "study.toml").write_text(text)
    sets = [part for setting in settings for part in ("--set", setting)]
    done = gust("run", "study.toml", "--out", out, "--json", *sets, code=code)
    return {(m["policy"], m["sweep"], m["start"]): m for m in json.loads(done.stdout)["margins"]}


def test_seven_grids_give_one_margin(gust, tmp_path):
    """A regulator under a dynamics step had margins of 0.0242 to 0.0516 N by these grids when they were interpolated."""
    grids = [f"{{ from = 0, to = 0.4, count = {count} }}" for count in (5, 11, 21, 41, 161, 801)] + ['"auto"']

    found = []
    for number, levels in enumerate(grids):
        margin = margins(gust, tmp_path, CARTPOLE + PUSH.replace("LEVELS", levels), f"out-{number}")
        found.append(margin["lqr", "push", "random"])

    estimates = [one["margin"] for one in found]
    assert max(estimates) / min(estimates) < 1.02
    for one in found:
        assert one["low"] < min(estimates) and max(estimates) < one["high"]


QUADROTOR = """
schema = 1
name = "quadrotor margins"
seed = 11
plant = { kind = "quadrotor", preset = "scg-2022" }

[evaluate]
start = "random"

[[policy]]
name = "lqr"
kind = "lqr"

[[policy]]
name = "cautious"
kind = "lqr"
r = [5, 5]
"""

SWEEP = """
[[sweep]]
name = "{site} {kind}"
site = "{site}"
waveform = {waveform}
levels = "auto"
"""
SHAPES = {
    "step": '{ kind = "step", offset = 2 }',
    "white": '"white"',
    "sine": '{ kind = "sine", frequency = 1 }',
    "impulse": '{ kind = "impulse", offset = 10, duration = 5 }',
}


def sweeps(sites, kinds):
    return "".join(SWEEP.format(site=site, kind=kind, waveform=SHAPES[kind]) for site in sites for kind in kinds)


CAUTIOUS = '\n[[policy]]\nname = "cautious"\nkind = "lqr"\nr = [5]\n'
CASES = [
    ("cartpole", CARTPOLE + CAUTIOUS + sweeps(("dynamics", "observation"), ("step", "white", "sine", "impulse"))),
    ("quadrotor", QUADROTOR + sweeps(("dynamics", "action"), ("step", "white", "sine"))),
]


@pytest.mark.parametrize("plant, text", CASES, ids=[name for name, _ in CASES])
def test_fresh_episodes_at_the_margin_score_nine_tenths(gust, tmp_path, plant, text):
    found = margins(gust, tmp_path, text, "out")
    episodes = 200
    margins(gust, tmp_path, text, "fresh", "seed=4711", f"evaluate.episodes={episodes}", "evaluate.margin_tolerance=0")

    def scores(policy, *cell):
        done = gust("eval", policy, "--study", "fresh", *cell, "--start", "random", "--json")
        return [episode["anr_h"] for episode in json.loads(done.stdout)]

    deviations = []
    for (policy, sweep, _), margin in found.items():
        if margin["margin"] is None or margin["censored"]:
            continue
        calm = scores(policy)
        left = [s - 0.9 * c for s, c in zip(scores(policy, "--sweep", sweep, "--level", margin["margin"]), calm)]
        spread = statistics.stdev(left)
        # Both the margin, of 25 episodes, and this look at it have a standard error; levels are 2 % apart.
        error = spread * math.sqrt(1 / 25 + 1 / episodes) + 0.002 * statistics.mean(calm)
        deviations.append(statistics.mean(left) / error)
        assert abs(deviations[-1]) < 4, (policy, sweep, margin)

    assert len(deviations) >= 10  # with both plants more than 20
    assert math.sqrt(statistics.mean(d * d for d in deviations)) < 1.7, deviations


def test_a_margin_under_standing_disturbances_is_a_fall_from_the_undisturbed_score(gust, tmp_path):
    wind = 'disturb = [{ site = "dynamics", waveform = "constant", level = 0.3 }]\n'
    text = CARTPOLE + PUSH.replace("LEVELS", "[0, 1]") + wind
    text += PUSH.replace("LEVELS", "[0, 1]").replace('"push"', '"heavy"') + 'params = { pole_mass = "x1.5" }\n'

    found = margins(gust, tmp_path, text, "out")

    assert found["lqr", "push", "random"]["margin"] == 0
    assert "beside the level" in found["lqr", "push", "random"]["reason"]
    assert 0 < found["lqr", "heavy", "random"]["margin"] < 0.2


def test_levels_below_zero_have_no_margin_and_say_why(gust, tmp_path):
    text = CARTPOLE + PUSH.replace("LEVELS", "{ from = -0.02, to = 0.02, count = 5 }")

    margin = margins(gust, tmp_path, text, "out")["lqr", "push", "random"]

    assert margin["margin"] is None and "both sides of 0" in margin["reason"]
    shown = gust("show", "out").stdout
    assert "–" in shown and "both sides of 0" in shown and "≥" not in shown


def test_levels_that_begin_above_zero_have_the_margin_of_those_from_zero(gust, tmp_path):
    above = margins(gust, tmp_path, CARTPOLE + PUSH.replace("LEVELS", "[0.2, 0.4]"), "above")
    whole = margins(gust, tmp_path, CARTPOLE + PUSH.replace("LEVELS", "[0, 0.4]"), "whole")

    ratio = above["lqr", "push", "random"]["margin"] / whole["lqr", "push", "random"]["margin"]
    assert abs(ratio - 1) < 0.02


def test_a_policy_that_fails_undisturbed_has_no_margin(gust, tmp_path):
    text = CARTPOLE + '\n[[policy]]\nname = "nothing"\nkind = "zero"\n' + PUSH.replace("LEVELS", "[0, 0.4]")

    margin = margins(gust, tmp_path, text, "out")["nothing", "push", "random"]

    assert margin["margin"] is None
    assert margin["reason"].startswith("it fails undisturbed: ")
    assert "– for nothing: it fails undisturbed: " in gust("show", "out").stdout
    page = (tmp_path / "out" / "report.html").read_text()
    assert "it fails undisturbed: " in page


def test_a_start_outside_the_safe_set_is_an_error_before_any_work(gust, tmp_path):
    (tmp_path / "study.toml").write_text(CARTPOLE.replace('"random"', "{ x = 3 }"))
    done = gust("run", "study.toml", code=2)
    assert "study.toml:8:" in done.stderr and "x = 3 lies outside the safe set, -2.4 to 2.4 m" in done.stderr
    assert not list(tmp_path.glob("*.gust"))
    done = gust("eval", "lqr", "--plant", "cartpole", "--start", "0,0,3,0", code=2)
    assert "--start: theta = 3 lies outside the safe set" in done.stderr


def test_added_levels_are_in_the_store_and_give_equal_bits_on_any_thread_count(gust, tmp_path):
    text = CARTPOLE + CAUTIOUS + PUSH.replace("LEVELS", "[0, 0.4]") + PUSH.replace("LEVELS", '"auto"').replace("push", "auto")
    for threads in (1, 3):
        margins(gust, tmp_path, text, f"out-{threads}", code=0)
        (tmp_path / "study.toml").write_text(text)
        gust("run", "study.toml", "--out", f"by-{threads}", "--threads", threads)

    def stored(folder):
        files = sorted((tmp_path / folder / "store" / "margin").rglob("*.*"))
        return {path.relative_to(tmp_path / folder): path.read_bytes() for path in files if path.name != "manifest.json"}

    assert stored("by-1") and stored("by-1") == stored("by-3")


@pytest.mark.parametrize("tolerance", ["-0.1", "0.6", '"narrow"'])
def test_a_tolerance_that_is_none_is_refused(gust, tmp_path, tolerance):
    (tmp_path / "study.toml").write_text(CARTPOLE + PUSH.replace("LEVELS", "[0, 1]"))
    done = gust("run", "study.toml", "--set", f"evaluate.margin_tolerance={tolerance}", code=2)
    assert "margin_tolerance" in done.stderr


def test_a_margin_in_a_claim_is_that_of_the_table_from_any_grid(gust, tmp_path):
    claim = '\n[[claim]]\nid = "c"\ntext = "t"\nholds = "margin(score(\'lqr\', \'push\')) >= 0.02"\n'
    for number, levels in enumerate(("[0, 0.4]", "{ from = 0, to = 0.4, count = 81 }")):
        (tmp_path / "study.toml").write_text(CARTPOLE + PUSH.replace("LEVELS", levels) + claim)
        told = json.loads(gust("run", "study.toml", "--out", f"out-{number}", "--json").stdout)
        estimate = told["claims"][0]["estimate"]
        assert abs(estimate - told["margins"][0]["margin"]) < 0.001, levels
        assert told["claims"][0]["verdict"] == "holds"
