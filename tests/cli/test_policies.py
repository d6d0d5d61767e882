"""Policies gain and pid as a bench engineer uses them: in a study, in gust eval, in kept episodes and on the page."""

import json
import math
import re

import pytest
from conftest import ROOT

HEAD = """schema = 1
name = "bench"
plant = { kind = "cartpole", preset = "scg-2022" }
[evaluate]
episodes = 3
start = "random"
"""
POLICY = HEAD + '[[policy]]\nname = "p"\n'
K = [-2.0, -3.1, -34.0, -8.6]  # N per m, m/s, rad, rad/s
DEGREES = [K[0], K[1], K[2] * math.pi / 180, K[3] * math.pi / 180]
RANDOM = ["--plant", "cartpole", "--start", "random", "--episodes", "5", "--json"]


def rows(gust, *arguments):
    return json.loads(gust("eval", *arguments).stdout)


def returns(gust, *arguments):
    return [row["return_sum"] for row in rows(gust, *arguments)]


def test_gain_in_degrees_and_in_a_file_is_the_gain(gust, tmp_path):
    (tmp_path / "k.csv").write_text("theta=deg,theta_dot=deg/s,x,x_dot\n" + ",".join(map(repr, [*DEGREES[2:], *K[:2]])) + "\n")

    si = returns(gust, "gain", *RANDOM, "--set", f"k=[{K}]")
    degrees = returns(gust, "gain", *RANDOM, "--set", f"k={DEGREES}", "--set", 'units={theta = "deg", theta_dot = "deg/s"}')
    percent = returns(gust, "gain", *RANDOM, "--set", f"k={[10 * k for k in K]}", "--units", "%")
    file = returns(gust, "gain", *RANDOM, "--set", "file=k.csv")

    assert len(si) == 5 and all(row > 200 for row in si)
    for other in (degrees, percent, file):
        assert other == pytest.approx(si, rel=1e-12)


def test_pid_runs_by_itself(gust):
    one = rows(gust, "pid", *RANDOM, "--set", "of=theta", "--set", "kp=-60", "--set", "ki=-20", "--set", "kd=-9")
    assert all(row["max_abs_theta"] < 0.2 for row in one)
    assert one == rows(gust, "pid", *RANDOM, "--set", "of=theta", "--set", "kp=-60", "--set", "ki=-20", "--set", "kd=-9")


LOOPS = """kind = "pid"
units = { theta = "deg", force = "N" }
loops = [
  { of = "x", to = "theta", kp = 4.6, ki = 0.5, kd = 8.6, filter = 0.04, low = -6, high = 6 },
  { of = "theta", kp = -1.6, ki = -0.2, kd = -0.26, derivative = "measurement", low = -3, high = 3, windup = "back", tracking = 0.5 },
]
[[sweep]]
name = "push"
site = "action"
waveform = { kind = "step", offset = 50 }
levels = [0, 4]
[report]
keep_traces = "worst 1, median 1"
"""


def pid(gains, observed, aims, period):
    """Outputs and integrals of one loop by the equations of docs/policies.md 4."""
    integral, slope, last, outputs, integrals = 0.0, 0.0, None, [], []
    for value, aim in zip(observed, aims):
        error = aim - value
        signal = -value if gains.get("measured") else error
        last = signal if last is None else last
        slope = (gains["filter"] * slope + gains["kd"] * (signal - last)) / (gains["filter"] + period)
        last = signal
        wanted = gains["kp"] * error + integral + slope
        output = max(gains["low"], min(gains["high"], wanted))
        grow = gains["ki"] * period * error
        if "tracking" in gains:
            integral += grow + period / gains["tracking"] * (output - wanted)
        elif not (wanted > gains["high"] and grow > 0 or wanted < gains["low"] and grow < 0):
            integral += grow
        outputs.append(output)
        integrals.append(integral)
    return outputs, integrals


def test_kept_episodes_of_a_pid_are_its_equations_and_the_page_has_its_memory(gust, tmp_path):
    (tmp_path / "bench.toml").write_text(POLICY + LOOPS)
    gust("run", "bench.toml")

    kept = [episode for path in (tmp_path / "bench.gust/store").rglob("traces.json")
            for episode in json.loads(path.read_text())]

    assert len(kept) >= 3
    limited = 0
    for episode in kept:
        steps = len(episode["reward"])
        x = episode["observation"][0][:steps]
        theta = [math.degrees(value) for value in episode["observation"][2][:steps]]
        outer, outer_integral = pid(dict(kp=4.6, ki=0.5, kd=8.6, filter=0.04, low=-6, high=6), x, [0] * steps, 0.02)
        inner, inner_integral = pid(dict(kp=-1.6, ki=-0.2, kd=-0.26, filter=0, low=-3, high=3, tracking=0.5, measured=True),
                                    theta, outer, 0.02)
        memory = {one["name"]: one for one in episode["memory"]}
        assert memory["integral of x to theta"]["unit"] == "rad" and memory["integral of theta to force"]["unit"] == "N"
        assert episode["commanded"][0] == pytest.approx(inner, abs=1e-10)
        asked = [math.degrees(value) for value in memory["integral of x to theta"]["values"]]
        assert asked == pytest.approx(outer_integral, abs=1e-10)
        assert memory["integral of theta to force"]["values"] == pytest.approx(inner_integral, abs=1e-10)
        limited += sum(abs(value) == 3 for value in inner)
    assert limited > 0  # the limits were met
    page = (tmp_path / "bench.gust/report.html").read_text()
    assert '"memory":[{"name":"integral of x to theta","unit":"rad","v":[' in page
    assert '"kind":"pid"' in page


def test_policies_without_memory_leave_no_trace_of_it(gust, tmp_path):
    (tmp_path / "bench.toml").write_text(POLICY + 'kind = "lqr"\n[report]\nkeep_traces = "worst 1"\n')
    gust("run", "bench.toml")

    assert all("memory" not in path.read_text() for path in (tmp_path / "bench.gust/store").rglob("traces.json"))
    assert '"memory":' not in (tmp_path / "bench.gust/report.html").read_text()


def test_study_of_the_bench_is_run_and_its_claim_decided(gust, tmp_path):
    (tmp_path / "bench.toml").write_text((ROOT / "studies/bench.toml").read_text())

    done = gust("run", "bench.toml", "--set", "evaluate.episodes=5")

    assert "feedback" in done.stdout and "pid cascade" in done.stdout
    one = rows(gust, "pid cascade", "--study", "bench.gust", "--sweep", "action step", "--level", "1", "--start", "random", "--json")
    assert len(one) == 5
    exported = gust("export", "bench.gust", "--csv", "bench.csv")
    assert exported.returncode == 0 and "pid cascade" in (tmp_path / "bench.csv").read_text()


MISTAKES = [
    ('kind = "gian"', "9:8: unknown policy kind 'gian'; did you mean 'gain'?"),
    ('kind = "gain"', "7:1: a gain policy needs a 'k'"),
    ('kind = "gain"\nk = [[1, 2, 3]]', "10:6: K must be 1 x 4, a row for each action and a column for each of x, x_dot, theta, theta_dot"),
    ('kind = "gain"\nk = [[1, 2, nan, 4]]', "10:13: 'k' must be a finite number"),
    ('kind = "gain"\nk = [[1, 2, 3, 4]]\nunits = { theta_dto = "deg/s" }', "11:23: 'units': unknown component 'theta_dto'; did you mean 'theta_dot'?"),
    ('kind = "gain"\nk = [[1, 2, 3, 4]]\nunits = { theta = "degree" }', "11:19: 'degree' is no unit of theta [rad]"),
    ('kind = "gain"\nfile = "missing.csv"', "10:8: missing.csv: cannot read"),
    ('kind = "gain"\nfile = "bad.csv"', "bad.csv:2:3: K must be numbers with commas between, got 'b'"),
    ('kind = "gain"\nkp = 1', "10:6: unknown key 'kp' in a policy of kind gain"),
    ('kind = "pid"\nof = "theta"\nkp = 1\nlow = 3\nhigh = -3', "7:1: 'low' must be less than 'high', got 3 and -3"),
    ('kind = "pid"\nof = "theta"\nkp = 1\nfilter = -0.01', "12:10: 'filter' must be >= 0, got -0.01"),
    ('kind = "pid"\nof = "thata"\nkp = 1', "10:6: 'of': unknown component 'thata'; did you mean 'theta'?"),
    ('kind = "pid"\nof = "theta"\nto = "torque"\nkp = 1', "11:6: 'to': unknown component 'torque'"),
    ('kind = "pid"\nof = "theta"\nkp = 1\nwindup = "clmap"', "12:10: 'windup' must be one of clamp, back, none, got 'clmap'; did you mean 'clamp'?"),
    ('kind = "pid"\nloops = [{ of = "theta", kp = 1 }, { of = "x", to = "theta", kp = 1 }]',
     "10:10: the loop of theta must come after the one that gives its reference"),
    ('kind = "lqr"\nk = [[1, 2, 3, 4]]', "10:5: unknown key 'k' in a policy of kind lqr"),
]


@pytest.mark.parametrize("policy, wanted", MISTAKES, ids=[str(i) for i in range(len(MISTAKES))])
def test_mistake_is_one_sentence_with_its_place(gust, tmp_path, policy, wanted):
    (tmp_path / "x.toml").write_text(POLICY + policy + "\n")
    (tmp_path / "bad.csv").write_text("x,x_dot\n1,b\n")

    done = gust("run", "x.toml", code=2)

    assert done.stdout == "" and len(done.stderr.splitlines()) == 1
    assert wanted in done.stderr and re.match(r"gust: (x\.toml|bad\.csv):\d+:\d+: ", done.stderr)
    assert not (tmp_path / "bench.gust").exists()


def test_gain_of_another_plant_is_refused_and_one_of_a_moving_reference_tracks_it(gust):
    refused = gust("eval", "gain", "--plant", "quadrotor", "--set", f"k=[{K}]", code=2).stderr
    assert "K must be 2 x 6" in refused
    alone = rows(gust, "gain", "--plant", "quadrotor", "--set", f"k={[[0] * 6, [0] * 6]}", "--json")[0]
    damped = rows(gust, "gain", "--plant", "quadrotor", "--json", "--set",
                  f"k={[[0, 0, 0.2, 0.1, 0, 0]] * 2}")[0]
    assert damped["rmse_scg"] < alone["rmse_scg"]  # it follows the height of the circle


def test_mistakes_on_the_command_line(gust):
    assert "has to be trained first" in gust("eval", "train", *RANDOM, code=2).stderr
    assert "unknown policy 'piid'; did you mean 'pid'?" in gust("eval", "piid", *RANDOM, code=2).stderr
    assert "--units: is given by --set as well" in gust("eval", "gain", *RANDOM, "--set", "units=N", "--units", "%", code=2).stderr
    assert "did you mean 'filter'?" in gust("eval", "pid", *RANDOM, "--set", "fliter=1", code=2).stderr


def test_shells_complete_the_kinds(gust):
    for shell in ("bash", "zsh", "fish"):
        script = gust("completion", shell).stdout
        assert re.search(r"lqr pd gain pid zero onnx\b(?! train)", script)
