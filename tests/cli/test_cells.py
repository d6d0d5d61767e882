"""gust eval --study: the commands that a page shows give the very numbers that the study holds there."""

import csv
import json
import re
import shlex

import pytest

STUDY = """
schema = 1
name = "cells of a study"
seed = 7
plant = { kind = "cartpole", preset = "scg-2022", pole_length = 0.6, physics_rate = 200 }
readings = { effort = "disturbed", saturate = "before", tap_point = "tip" }

[evaluate]
episodes = 4
terminate = TERMINATE
start = ["random", { x = 0.1, theta = 0.05 }]
disturb = [{ site = "observation", waveform = "white", level = 0.01 }]

[[policy]]
name = "lqr, cautious"
kind = "lqr"
r = [0.5]

[[policy]]
name = "ppo"
kind = "train"
agent = { kind = "ppo", steps = 2048 }
seeds = [1, 5]

[[sweep]]
name = "late gusts"
site = "dynamics"
waveform = { kind = "white", std = 0.5 }
levels = { from = 0, to = 7, count = 4 }
mask = [0, 1]
start = 20
end = 90

[[sweep]]
name = "saw at theta"
site = "observation"
waveform = { kind = "sawtooth", frequency = 1.5, phase = 0.25 }
levels = [0, 0.1, 0.2]
channels = { theta = 0.5, x = 2 }

[[sweep]]
name = "pole length"
vary = "pole_length"
scale = [0.5, 1.1, 2]

[[sweep]]
name = "both"
grid = { pole_length = [0.3, 0.6], cart_mass = { from = 0.1, to = 1, count = 4 } }

[report]
keep_traces = "worst 1"
"""


@pytest.fixture(params=["true", "false"], ids=["terminated", "whole"])
def folder(gust, tmp_path, request):
    """An empty folder but for the result of the study, whose failures do or do not end an episode."""
    (tmp_path / "study.toml").write_text(STUDY.replace("TERMINATE", request.param))
    gust("run", "study.toml", "--set", "seed=11")
    return tmp_path


def page_of(folder, name="cells of a study.gust"):
    text = (folder / name / "report.html").read_text()
    return json.loads(re.search(r'id="gust-data">(.*?)</script>', text, re.S)[1])


def rows_of(gust, command):
    program, *arguments = shlex.split(command)
    assert program == "gust"
    return json.loads(gust(*arguments, "--json").stdout)


def exported(gust, folder):
    """{(policy, sweep, level, start): {(seed, episode, metric): value}}"""
    gust("export", "cells of a study.gust", "--csv", "all.csv")
    cells = {}
    with open(folder / "all.csv", newline="") as file:
        for row in csv.DictReader(file):
            level = tuple(float(row[name]) for name in ("level", "level_2") if row[name])
            cell = cells.setdefault((row["policy"], row["sweep"], level, row["start"]), {})
            key = row["seed"], int(row["episode"]), row["metric"]
            assert key not in cell
            cell[key] = float(row["value"])
    return cells


def measured(rows):
    names = {"seed", "episode", "failed", "finite", "return_sum_commanded", "return_sum_disturbed", "initial_state",
             "final_state"}
    return {(row.get("seed", ""), row["episode"], name): value for row in rows for name, value in row.items()
            if name not in names}


def test_commands_of_the_page_give_the_numbers_of_the_study(gust, folder):
    page, cells = page_of(folder), exported(gust, folder)
    commands = [one["command"] for kind in ("sweeps", "grids", "episodes") for one in page[kind] if one["command"]]
    commands += [command.replace("'lqr, cautious'", "ppo") for command in commands[:4]]
    assert len(set(commands)) >= 4 + 4 + 4

    for command in commands:
        words = shlex.split(command)
        said = dict(zip(words[3::2], words[4::2], strict=True))
        level = tuple(map(float, said["--level"].split(",")))
        cell = cells[words[2], said["--sweep"], level, said["--start"]]
        assert measured(rows_of(gust, command)) == cell, command


def test_command_of_the_run_is_all_that_was_asked_for(gust, folder):
    assert page_of(folder)["runCommand"] == "gust run study.toml --set seed=11"
    gust("run", "study.toml", "--set", "policy.ppo.seeds=[1]", "--out", "else where", "--threads", "2")
    assert page_of(folder, "else where")["runCommand"] == (
        "gust run study.toml --set 'policy.ppo.seeds=[1]' --out 'else where'")

    gust("report", "else where")

    assert page_of(folder, "else where")["runCommand"].endswith("--out 'else where'")


def test_without_a_sweep_nothing_is_disturbed_but_by_what_is_always_on(gust, folder):
    rows = rows_of(gust, "gust eval ppo --study 'cells of a study.gust'")

    assert [(row["seed"], row["episode"]) for row in rows] == [(seed, k) for seed in "15" for k in range(4)]
    assert measured(rows) == exported(gust, folder)["ppo", "none", (0.0,), "random"]


def test_mistakes_are_told_in_one_line(gust, folder):
    cell = ["eval", "ppo", "--study", "cells of a study.gust"]
    mistakes = [
        (["eval", "pop", *cell[2:]], "POLICY: unknown policy 'pop'; did you mean 'ppo'?"),
        ([*cell, "--sweep", "boht"], "--sweep: unknown sweep 'boht'; did you mean 'both'?"),
        ([*cell, "--sweep", "both"], "--sweep: 'both' needs the --level to measure"),
        ([*cell, "--sweep", "both", "--level", "1"], "--level: sweep 'both' has 2 axes, got 1"),
        ([*cell, "--sweep", "pole length", "--level", "0"], "--level: 'pole_length' must be > 0, got 0"),
        ([*cell, "--sweep", "late gusts", "--level", "nan"], "--level: 'level' must be a finite number, got nan"),
        ([*cell, "--level", "1"], "--level: needs its --sweep beside it"),
        ([*cell, "--start", "randon"], "--start: unknown start 'randon'; did you mean 'random'?"),
        ([*cell, "--episodes", "0"], "--episodes: must be 1 to"),
        ([*cell, "--plant", "cartpole"], "--plant: comes from the study"),
        ([*cell, "--seed", "3"], "--seed: comes from the study"),
        (["eval", "lqr", "--plant", "cartpole", "--sweep", "both"], "--sweep: needs the --study"),
        (["eval", "ppo", "--study", "."], ".: holds no study"),
    ]
    for arguments, message in mistakes:
        done = gust(*arguments, code=2)
        assert message in done.stderr
        assert done.stdout == "" and done.stderr.count("\n") == 1
