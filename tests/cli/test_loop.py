"""A loop that is no plant, through every command: a thermostat that only the program of tests/loop knows."""

import csv
import json
import re
import sqlite3
import sys

import numpy as np
import pytest
from conftest import ROOT

sys.path.insert(0, str(ROOT / "tests/loop"))
from room import Room  # noqa: E402

NOT_APPLICABLE = {"rmse_paper", "rmse_scg", "rmse_sum", "squared_state_sum", "max_abs_x", "max_abs_theta", "ground_contact"}


@pytest.fixture(scope="module")
def room(build, tmp_path_factory):
    """The study, run once."""
    room = Room(build, tmp_path_factory.mktemp("room"))
    room("run", "room.toml")
    return room


def exported(room):
    room("export", "room.gust", "--csv", "room.csv")
    with open(room.folder / "room.csv", newline="") as file:
        return list(csv.DictReader(file))


def test_a_study_of_a_loop_has_margins_and_verdicts(room):
    shown = json.loads(room("show", "room.gust", "--json").stdout)

    margins = {(one["policy"], one["sweep"], one["start"]): one["margin"] for one in shown["margins"]}
    assert margins["linear", "sun", "nominal"] > 3 * margins["half power", "sun", "nominal"]
    assert {one["id"]: one["verdict"] for one in shown["claims"]} == {"feedback": "holds", "survives": "holds", "falls": "fails"}
    text = room("show", "room.gust").stdout
    assert "sun" in text and "survives" in text


def test_what_a_policy_loses_in_the_sun_is_what_the_room_in_balance_says(room):
    """Without noise, at the end of the episode: loss (T - 20) = bias - 200 W/K (T - 20), the sensor having caught up."""
    bias = 300
    rows = json.loads(room("eval", "linear", "--study", "room.gust", "--sweep", "sun", "--level", bias, "--start", "nominal", "--json").stdout)

    error = bias / (25 + 200)
    balance = np.exp(-((error / 2) ** 2))
    mean = rows[0]["anr"]
    assert balance < mean < 1  # it begins at 20 degC and settles
    longer = json.loads(room("eval", "linear.onnx", "--plant", "thermostat", "--set", "steps=20000", "--units", "normalised",
                             "--site", "action", "--waveform", "constant", "--level", bias, "--json").stdout)
    assert longer[0]["anr"] == pytest.approx(balance, abs=0.003)


def test_metrics_that_are_not_applicable_are_absent_and_said(room):
    rows = exported(room)

    assert {row["plant"] for row in rows} == {"thermostat"}
    assert {row["preset"] for row in rows} == {row["readings"] for row in rows} == {"none"}
    assert not {row["metric"] for row in rows} & NOT_APPLICABLE
    assert {"anr_h", "survival", "saturation", "time_to_failure"} <= {row["metric"] for row in rows}
    row = json.loads(room("eval", "zero", "--plant", "thermostat", "--json").stdout)[0]
    assert {name for name in NOT_APPLICABLE if row[name] is None} == NOT_APPLICABLE
    text = room("eval", "zero", "--plant", "thermostat").stdout
    assert "not applicable: " in text and "rmse_scg (no goal)" in text.replace("\n", " ")
    assert "return_sum_commanded" not in text


def test_tables_of_a_loop_are_those_of_its_rows(room):
    rows = exported(room)
    room("export", "room.gust", "--sqlite", "room.sqlite")

    with sqlite3.connect(room.folder / "room.sqlite") as database:
        count = database.execute("SELECT COUNT(*) FROM episodes").fetchone()[0]
    assert count == len(rows) > 1000


def test_a_loop_resumes_and_its_trials_run_one_by_one(room):
    before = exported(room)
    for trial in json.loads(room("plan", "room.toml", "--prepare", "--out", "again.gust", "--json").stdout):
        room("trial", "again.gust", trial["id"])

    room("run", "room.toml", "--out", "again.gust")
    room("export", "again.gust", "--csv", "again.csv")

    assert (room.folder / "again.csv").read_bytes() == (room.folder / "room.csv").read_bytes()
    assert len(before) == len(exported(room))


def test_a_loop_is_listed_described_and_drawn(room):
    assert "thermostat" in room("list", "plants").stdout
    described = room("describe", "plant", "thermostat").stdout
    assert "temperature [degC]" in described and "rmse_scg (no goal)" in " ".join(described.split())
    assert "300 control steps at 1 Hz" in room("preview", "room.toml").stdout


WRONG = {
    "a site that there is not": (
        'site     = "action"\nwaveform = "step"', 'site     = "dynamics"\nwaveform = "step"',
        "the plant has no site 'dynamics'; its sites are observation, action"),
    "a metric that is not applicable": (
        'metrics  = ["anr_h", "survival"]', 'metrics  = ["rmse_scg"]', "the metric 'rmse_scg' is not applicable: the plant tells no goal"),
    "a policy that needs equations": (
        'kind = "zero"', 'kind = "lqr"', "lqr needs the equations of motion of a plant, and 'thermostat' has none; choose a policy that acts on observations alone"),
    "a training": (
        'kind = "zero"', 'kind = "train"\nagent = { kind = "ppo" }', "a training needs the equations of motion of a plant, and 'thermostat' has none"),
    "a start by the state": (
        'start    = ["nominal", "random"]', "start    = { temperature = 19 }", "the plant tells no state that a start could set; name a start"),
    "another start": (
        'start    = ["nominal", "random"]', 'start    = "nominall"', "unknown start 'nominall'; did you mean 'nominal'?; starts are nominal, random"),
    "readings": (
        'seed   = 3', 'seed   = 3\nreadings = { effort = "applied" }', "readings are for plants with equations of motion; 'thermostat' is none"),
    "a preset": (
        'kind = "thermostat"', 'kind = "thermostat", preset = "scg-2022"', "unknown key 'preset' in thermostat"),
    "a parameter": (
        'vary  = "lag"', 'vary  = "mass"', "unknown parameter 'mass'; the plant has capacity, loss, lag"),
    "a metric in a claim": (
        'holds  = "survival >= 0.9"', 'holds  = "rmse_scg <= 1"', "rmse_scg"),
}


@pytest.mark.parametrize("mistake", WRONG)
def test_a_mistake_is_one_sentence_before_any_work(room, mistake):
    old, new, said = WRONG[mistake]
    text = (room.folder / "room.toml").read_text()
    assert old in text
    (room.folder / "wrong.toml").write_text(text.replace(old, new, 1).replace('name   = "room"', 'name   = "wrong"'))

    done = room("run", "wrong.toml", code=2)

    assert said in done.stderr
    assert done.stderr.count("\n") == 1 and done.stderr.startswith("gust: wrong.toml:")
    assert not (room.folder / "wrong.gust").exists()


def test_the_program_without_the_loop_names_the_kinds_that_it_has(gust, room):
    done = gust("run", room.folder / "room.toml", code=2)

    assert "unknown plant 'thermostat'" in done.stderr and "gust list plants" in done.stderr


def test_commands_for_plants_say_that_a_loop_is_none(room):
    assert "needs the equations of motion" in room("eval", "lqr", "--plant", "thermostat", code=2).stderr
    assert "needs the equations of motion" in room("eval", "pd", "--plant", "thermostat", code=2).stderr
    assert "needs the equations of motion" in room("train", "ppo", "--plant", "thermostat", "--out", "p.onnx", code=2).stderr
    assert "unknown key 'preset'" in room("eval", "zero", "--plant", "thermostat", "--preset", "scg-default", code=2).stderr


DRIFT = """
schema = 1
name   = "drift"
plant  = { kind = "drift" }
policy = [{ name = "nothing", kind = "zero" }]
claim  = [{ id = "return", where = { policy = "nothing", sweep = "bias", level = 0.2 }, holds = "anr_h >= -4" }]

[evaluate]
episodes = 30

[[sweep]]
name     = "bias"
site     = "action"
waveform = "constant"
levels   = [0, 0.1, 0.2]

[report]
keep_traces = "worst 1, median 1"
"""


def test_a_loop_that_tells_rewards_alone_is_measured_with_what_they_say(room):
    """Its rewards are negative and without bounds, and its episodes cannot fail."""
    (room.folder / "drift.toml").write_text(DRIFT)
    room("run", "drift.toml")
    room("export", "drift.gust", "--csv", "drift.csv")

    with open(room.folder / "drift.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["metric"] for row in rows} == {"return_sum", "length", "anr", "anr_h"}
    values = [float(row["value"]) for row in rows if row["metric"] == "anr_h" and row["sweep"] == "bias" and row["level"] == "0.2"]
    rise = 0.3 * np.arange(1, 21).mean()  # from a start between 0 and 1
    assert min(values) > -rise - 1 and max(values) < -rise and abs(np.mean(values) + rise + 0.5) < 0.2
    shown = room("show", "drift.gust").stdout
    assert "holds" in shown and "not positive" in " ".join(shown.split())
    text = room("eval", "zero", "--plant", "drift").stdout
    assert "25 episodes, 0 failed" in text  # it has random starts alone
    assert "survival (no failure)" in " ".join(text.split()) and "saturation (nothing of the actuator)" in " ".join(text.split())
    for old, new, said in [
        ('levels   = [0, 0.1, 0.2]', 'levels   = "auto"', "an episode of 'drift' cannot fail; give the levels"),
        ("episodes = 30", "terminate = false", "'terminate' must be true: the plant tells nothing after a failure"),
        ("episodes = 30", 'start = "nominal"', "unknown start 'nominal'; starts are random"),
        ("anr_h >= -4", "survival >= 1", "survival"),
    ]:
        (room.folder / "wrong.toml").write_text(DRIFT.replace(old, new))
        assert said in room("run", "wrong.toml", code=2).stderr


def test_a_loop_that_breaks_fails_its_trial_and_the_study_goes_on(room):
    text = DRIFT.replace('kind = "drift"', 'kind = "drift", breaks_at = 50').replace("[0, 0.1, 0.2]", "[0, 0.1, 0.2, 100]")
    text += '[[sweep]]\nname = "noise"\nsite = "observation"\nwaveform = "white"\nlevels = [0, 1]\n'
    (room.folder / "breaks.toml").write_text(text.replace('name   = "drift"', 'name   = "breaks"'))

    done = room("run", "breaks.toml", code=1)

    assert "the drift has broken" in done.stderr and "nothing · bias" in done.stderr
    shown = room("show", "breaks.gust", code=1)
    assert "noise" in shown.stdout and "nothing · bias" in shown.stdout + shown.stderr
    assert (room.folder / "breaks.gust/report.html").exists()


def test_the_worked_example_of_the_documents_is_this_thermostat():
    blocks = re.findall(r"^```cpp\n// gust/control/loops/thermostat.cpp\n(.*?)^```$", (ROOT / "docs/extending.md").read_text(), re.M | re.S)

    assert blocks == [(ROOT / "tests/loop/thermostat.cpp").read_text()]
