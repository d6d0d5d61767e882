"""gust eval: the rows of the reference through the program itself, and what it prints."""

import csv
import json
import math

import pytest
from scg_rows import POLICIES, REFERENCE, arguments_of, difference

EVERY = 59  # a prime, so that the sample meets every site, waveform, start and level: 21 rows a policy


def sample(policy):
    with open(REFERENCE / f"eval_{policy}.csv", newline="") as file:
        return [(number, row) for number, row in enumerate(csv.DictReader(file), 2)][::EVERY]


@pytest.mark.parametrize("policy", POLICIES)
def test_sample_of_the_reference_is_reproduced_by_the_program(gust, policy):
    rows = sample(policy)
    assert len(rows) == 21
    for number, row in rows:
        done = gust(*arguments_of(row))
        assert done.stderr == ""
        (got,) = json.loads(done.stdout)
        assert difference(row, got) == "", f"eval_{policy}.csv:{number}"


def rows_of(gust, *arguments):
    return json.loads(gust("eval", *arguments, "--plant", "cartpole", "--json").stdout)


def test_object_has_every_metric_and_both_states(gust):
    (row,) = rows_of(gust, "zero")
    metrics = [metric["name"] for metric in json.loads(gust("list", "metrics", "--json").stdout)]
    assert set(row) == {"episode", "failed", "finite", "return_sum_commanded", "return_sum_disturbed", "initial_state",
                        "final_state", *metrics} - {"anr_pooled"}  # of all episodes together
    assert row["initial_state"] == [0, 0, 0, 0]
    assert row["length"] == 250 and row["return_sum_commanded"] == 250  # nothing moves an upright pole


def test_random_starts_are_25_and_differ_and_explicit_ones_are_one(gust):
    rows = rows_of(gust, "lqr", "--start", "random", "--seed", "7")
    assert [row["episode"] for row in rows] == list(range(25))
    assert len({tuple(row["initial_state"]) for row in rows}) == 25
    assert all(abs(row["initial_state"][0]) <= 0.3 and row["initial_state"][1] == 0 for row in rows)
    assert len(rows_of(gust, "lqr", "--start", "-0.1,0,0.05,0")) == 1
    assert rows_of(gust, "lqr", "--start", "-0.1,0,0.05,0")[0]["initial_state"] == [-0.1, 0, 0.05, 0]


def test_noise_depends_on_the_seed_alone_and_grows_with_the_level(gust):
    noise = ["lqr", "--site", "action", "--waveform", "white", "--episodes", "3"]
    once = gust("eval", *noise, "--level", "1", "--plant", "cartpole", "--json").stdout
    assert gust("eval", *noise, "--level", "1", "--plant", "cartpole", "--json").stdout == once
    assert gust("eval", *noise, "--level", "1", "--plant", "cartpole", "--json", "--seed", "2").stdout != once
    weak, strong = (rows_of(gust, *noise, "--level", level) for level in ("0.1", "3"))
    assert all(a["rmse_paper"] < b["rmse_paper"] for a, b in zip(weak, strong, strict=True))


def test_without_termination_the_row_goes_on_to_the_horizon(gust):
    fall = ["zero", "--start", "0,0,0.1,0"]
    (ended,), (whole,) = rows_of(gust, *fall), rows_of(gust, *fall, "--terminate", "no")
    assert ended["failed"] and whole["failed"]
    assert ended["length"] < 250 and whole["length"] == 250
    assert whole["return_sum_commanded"] > ended["return_sum_commanded"]
    assert abs(ended["final_state"][2]) == pytest.approx(math.pi / 2, abs=0.2)
    assert ended["rmse_sum"] == pytest.approx(ended["rmse_paper"] * math.sqrt(ended["length"]), rel=1e-12)
    assert whole["anr"] == ended["anr"]  # a metric keeps its definition


def test_squared_state_is_that_of_the_state_itself_and_not_of_its_error(gust):
    (held,) = rows_of(gust, "lqr", "--start", "1,0,0,0", "--set", "goal=[1,0,0,0]")
    assert held["squared_state_sum"] == pytest.approx(250, rel=1e-12)  # stays at x = 1 m for 250 steps
    assert held["rmse_sum"] < 1e-6
    fall = ["zero", "--start", "0,0,0.1,0"]
    (ended,), (whole,) = rows_of(gust, *fall), rows_of(gust, *fall, "--terminate", "no")
    assert ended["squared_state_sum"] == pytest.approx(ended["rmse_sum"] ** 2, rel=1e-12)  # the goal is 0
    assert whole["squared_state_sum"] == pytest.approx(whole["rmse_sum"] ** 2, rel=1e-12)


def test_the_table_has_the_quotient_of_mean_return_and_mean_length_and_rows_have_not(gust):
    noisy = ["lqr", "--start", "random", "--episodes", "25", "--site", "dynamics", "--waveform",
             "white", "--level", "4"]
    rows = rows_of(gust, *noisy)
    pooled = sum(row["return_sum"] for row in rows) / sum(row["length"] for row in rows)
    assert len({row["length"] for row in rows}) > 3  # some fail early
    assert "anr_pooled" not in rows[0]
    table = {line.split()[0]: line.split()[1:] for line in gust("eval", *noisy, "--plant", "cartpole").stdout.splitlines()[3:]}
    assert [float(number) for number in table["anr_pooled"]] == pytest.approx([pooled] * 3, rel=1e-5)
    assert abs(float(table["anr"][0]) - pooled) > 1e-3


def test_parameters_are_set_or_scaled_behind_the_policy_and_options_before_it(gust):
    start = ["lqr", "--start", "0.2,0,0.1,0"]
    (absolute,) = rows_of(gust, *start, "--param", "pole_length=0.75")
    (scaled,) = rows_of(gust, *start, "--param", "pole_length=x1.5")
    (designed,) = rows_of(gust, *start, "--set", "pole_length=0.75")
    (nominal,) = rows_of(gust, *start)
    assert absolute == scaled
    assert absolute["final_state"] != nominal["final_state"]
    assert designed["final_state"] != absolute["final_state"]  # the regulator knows


def test_readings_channels_and_window_are_settings(gust):
    push = ["lqr", "--site", "dynamics", "--waveform", "step", "--level", "1"]
    (both,) = rows_of(gust, *push)
    (only_x,) = rows_of(gust, *push, "--set", "mask=10")
    (named,) = rows_of(gust, *push, "--set", "channels=fx")
    (early,) = rows_of(gust, *push, "--set", "end=3")
    (tip,) = rows_of(gust, *push, "--set", "tap_point=tip")
    assert only_x == named != both
    assert early["rmse_paper"] < both["rmse_paper"]
    assert tip["final_state"] != both["final_state"]
    (charged,) = rows_of(gust, "lqr", "--start", "0.3,0,0.1,0", "--site", "action", "--waveform", "constant", "--level",
                         "5", "--set", "effort=disturbed")
    assert charged["return_sum"] == charged["return_sum_disturbed"] != charged["return_sum_commanded"]


def test_what_is_no_number_is_null(gust):
    (row,) = rows_of(gust, "lqr", "--terminate", "no", "--site", "action", "--waveform", "constant", "--level", "1e308",
                     "--set", "saturate=before")
    assert row["failed"] and not row["finite"]
    assert row["final_state"][0] is None
    assert row["max_abs_x"] is None and row["max_abs_theta"] is None


def test_table_is_for_people(gust):
    done = gust("eval", "lqr", "--plant", "cartpole", "--start", "random", "--episodes", "5")
    assert done.stdout.startswith("5 episodes, 0 failed\n")
    assert "rmse_paper" in done.stdout and "greatest" in done.stdout


def test_table_has_units_and_only_what_the_plant_has(gust):
    cartpole = gust("eval", "lqr", "--plant", "cartpole").stdout
    quadrotor = gust("eval", "lqr", "--plant", "quadrotor").stdout

    for head in ("max_abs_x [m] ", "max_abs_theta [rad] ", "time_to_failure [s] ", "length [control steps] "):
        assert head in cartpole and head in quadrotor
    assert "ground_contact" not in cartpole and "ground_contact" in quadrotor
    assert len({len(line) for line in cartpole.splitlines()[2:]}) == 1  # the columns are aligned
