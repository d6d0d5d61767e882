"""Effects: disturbances that map a signal. The truth about a delay is a linear loop written out here in NumPy."""

import json

import numpy as np
import pytest

RATE, SUBSTEPS = 50, 20
LENGTH, MASS, CART, WIDTH, GRAVITY = 0.5, 0.1, 1.0, 0.05, 9.8  # half length, pole, cart, thickness

STUDY = """
schema = 1
name   = "late"
seed   = 2
plant  = { kind = "cartpole", preset = "scg-2022" }

[evaluate]
episodes = 2

[[policy]]
name = "lqr"
kind = "lqr"

[[policy]]
name  = "ppo"
kind  = "train"
agent = { kind = "ppo", steps = 800, disturb = [
    { site = "action", effect = "delay", level = 0.013 },
    { site = "observation", effect = { kind = "delay", unit = "steps" }, level = 1 }] }
seeds = [1, 2]

[[sweep]]
name   = "late action"
site   = "action"
effect = "delay"
levels = [0, 0.01, 0.02, 0.04, 0.08]

[[sweep]]
name   = "late angle"
site   = "observation"
effect = { kind = "delay", unit = "steps" }
channels = ["theta"]
levels = "auto"

[report]
keep_traces = "worst 1, median 1"
"""


def one_substep():
    """The linear cart-pole about the upright position over one substep: x+ = f x + g u (docs/plants.md 1.2)."""
    lever = MASS * LENGTH
    inertia = MASS * (WIDTH**2 + 4 * LENGTH**2) / 12 + lever * LENGTH
    mass = np.array([[CART + MASS, lever], [lever, inertia]])
    accelerations = np.linalg.solve(mass, np.array([[0, 1], [lever * GRAVITY, 0]]))  # columns: theta, u
    dt = 1 / (RATE * SUBSTEPS)
    f, g = np.eye(4), np.zeros((4, 1))
    for row, (speed, place) in enumerate([(1, 0), (3, 2)]):
        f[speed, 2] += dt * accelerations[row, 0]
        g[speed] += dt * accelerations[row, 1]
    for speed, place in [(1, 0), (3, 2)]:  # the place moves with the new speed
        f[place] += dt * f[speed]
        g[place] += dt * g[speed]
    return f, g


def over(f, g, substeps):
    """The same over several substeps with one input."""
    a, b = np.eye(4), np.zeros((4, 1))
    for _ in range(substeps):
        a, b = f @ a, f @ b + g
    return a, b


def radius(gain, ticks):
    """The spectral radius of the loop u = -gain x whose action comes so many substeps late."""
    f, g = one_substep()
    whole, part = divmod(ticks, SUBSTEPS)
    a, b_late = over(f, g, SUBSTEPS - part)
    before, b_early = over(f, g, part)
    b_early = a @ b_early
    a = a @ before
    size = 4 + whole + 1  # the state, then the actions given and not yet used, the newest first
    loop = np.zeros((size, size))
    loop[:4, :4] = a
    if whole == 0:
        loop[:4, :4] -= b_late @ gain
        loop[:4, 4:5] = b_early
    else:
        loop[:4, 4 + whole - 1] = b_late[:, 0]
        loop[:4, 4 + whole] = b_early[:, 0]
    loop[4:5, :4] = -gain
    for i in range(1, whole + 1):
        loop[4 + i, 4 + i - 1] = 1
    return max(abs(np.linalg.eigvals(loop)))


@pytest.fixture(scope="module")
def gain():
    a, b = over(*one_substep(), SUBSTEPS)
    q, r = np.diag([5, 0.1, 1, 0.1]), 1e-4  # the weights of the reward, and 0.1 where it has none
    p = q
    for _ in range(3000):  # the Riccati recursion, far beyond where it stops moving
        p = q + a.T @ p @ (a - b @ np.linalg.solve(r + b.T @ p @ b, b.T @ p @ a))
    return np.linalg.solve(r + b.T @ p @ b, b.T @ p @ a)


@pytest.mark.parametrize("milliseconds", [0, 10, 20, 23, 24, 25, 30, 40, 60])
def test_the_regulator_tolerates_the_delays_that_the_linear_loop_does(gust, gain, milliseconds):
    answer = json.loads(
        gust("eval", "lqr", "--plant", "cartpole", "--start", "0,0,1e-3,0", "--site", "action", "--effect", "delay",
             "--level", milliseconds / 1000, "--set", "steps=2000", "--json").stdout)  # fmt: skip
    # It begins at 1 mrad and stays there, or grows in 40 s to what the actuator's limits leave of it.
    assert (answer[0]["max_abs_theta"] < 2e-3) == (radius(gain, milliseconds) < 1), radius(gain, milliseconds)


def test_the_linear_loop_is_the_known_one(gain):
    assert gain[0] == pytest.approx([-118.170, -89.4452, -331.382, -86.6227], rel=1e-5)  # printed by gust describe
    assert radius(gain, 0) == pytest.approx(0.93465, abs=1e-5)
    assert radius(gain, 40) == pytest.approx(1.143, abs=1e-3)


def test_effects_are_listed_and_described(gust):
    assert "delay" in gust("list", "effects").stdout
    said = gust("describe", "effect", "delay").stdout
    assert "in s, from 0, which changes no bit" in said
    assert 'effect = { kind = "delay", unit = "s" }' in said


def test_a_study_trains_and_measures_with_effects(gust, tmp_path):
    (tmp_path / "late.toml").write_text(STUDY)
    plan = gust("plan", "late.toml").stdout
    assert "late action" in plan
    shown = gust("preview", "late.toml").stdout
    assert "what becomes of a step at 0.5 s" in shown
    assert "while ppo trains" in shown
    run = json.loads(gust("run", "late.toml", "--threads", "1", "--json").stdout)
    again = json.loads(gust("run", "late.toml", "--threads", "2", "--out", "again.gust", "--json").stdout)
    assert run["margins"] == again["margins"]
    margins = {(margin["policy"], margin["sweep"], margin["start"]): margin for margin in run["margins"]}
    lqr = margins["lqr", "late action", "random"]
    assert lqr["waveform"] == "delay"
    assert 0.01 < lqr["margin"] < 0.06
    assert margins["lqr", "late action", "nominal"]["censored"]  # it begins where nothing has to be done
    gust("export", "late.gust", "--csv", "rows.csv")
    rows = (tmp_path / "rows.csv").read_text()
    assert ',late action,action,force,"delay(unit = ""s"")",0:250,' in rows
    page = (tmp_path / "late.gust/report.html").read_text()
    assert '"waveform":"delay"' in page and '"unit":"s"' in page and '"unit":"steps"' in page


def test_a_training_under_a_delay_is_another_one(gust, tmp_path):
    (tmp_path / "late.toml").write_text(STUDY)
    ids = {trial["id"] for trial in json.loads(gust("plan", "late.toml", "--json").stdout) if trial["kind"] == "train"}
    (tmp_path / "other.toml").write_text(STUDY.replace("0.013", "0.014"))
    others = json.loads(gust("plan", "other.toml", "--json").stdout)
    assert not ids & {trial["id"] for trial in others}


@pytest.mark.parametrize(
    "old, new, told",
    [
        ('"delay"\nlevels', '"dealy"\nlevels', "did you mean 'delay'"),
        ("[0, 0.01", "[-0.1, 0.01", "the level of a delay is 0 or more s, got -0.1"),
        ('unit = "steps" }\nchannels', 'unit = "ms" }\nchannels', "'unit' must be one of s, steps"),
        ('["theta"]', "{ theta = 0.5 }", "an effect maps a channel or leaves it alone"),
        ('effect = "delay"\nlevels', 'effect = "delay"\nwaveform = "step"\nlevels', "not both"),
        ('site   = "action"\neffect = "delay"\n', 'site   = "action"\n', "needs a 'waveform'"),
        (', level = 0.013', "", "needs a 'level'"),
        ("level = 0.013", "level = -1", "the level of a delay is 0 or more s, got -1"),
        ('"observation", effect = { kind', '"action", effect = { kind', "two effects such as delay"),
    ],
)  # fmt: skip
def test_a_wrong_effect_is_told_with_its_place(gust, tmp_path, old, new, told):
    assert old in STUDY
    (tmp_path / "late.toml").write_text(STUDY.replace(old, new, 1))
    error = gust("run", "late.toml", code=2).stderr
    assert told in error
    assert error.startswith("gust: late.toml:")
    assert not (tmp_path / "late.gust").exists()


def test_eval_refuses_a_waveform_beside_an_effect(gust):
    error = gust("eval", "lqr", "--plant", "cartpole", "--site", "action", "--effect", "delay", "--waveform", "step",
                 "--level", "1", code=2).stderr  # fmt: skip
    assert "not both" in error


def test_a_cell_of_a_study_has_no_level_that_its_effect_cannot_have(gust, tmp_path):
    (tmp_path / "late.toml").write_text(STUDY.replace("steps = 800", "steps = 400"))
    gust("run", "late.toml")
    cell = ["eval", "lqr", "--study", "late.gust", "--sweep", "late action"]
    assert "the level of a delay is 0 or more s, got -0.1" in gust(*cell, "--level", "-0.1", code=2).stderr
    assert gust(*cell, "--level", "0.013").returncode == 0
