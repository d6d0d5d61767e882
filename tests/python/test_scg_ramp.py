"""The waveform scg_ramp against a twin in NumPy, fed with the same increments.

At a level that is never reached a sawtooth is the sum of its increments; gust draws the same ones at every level.
"""

import json

import numpy
import pytest

EPISODES = 6
LEVELS = [0, 0.004, 0.1, 0.3, 1.5, 4, 1e9]  # the last is never reached
MASKS = {"action": [1], "dynamics": [-1, 1], "observation": [-1, 1, 0, 0]}

STUDY = """schema = 1
name = "ramps"
seed = 3
plant = {{ kind = "cartpole", preset = "scg-default" }}
readings = {{ saturate = "before" }}

[evaluate]
episodes = {episodes}
start = ["nominal"]
margin_tolerance = 0

[report]
keep_traces = "worst {kept}"

[[policy]]
name = "nothing"
kind = "zero"

[[sweep]]
name = "ramp"
site = "{site}"
mask = {mask}
waveform = {{ kind = "scg_ramp", shape = "{shape}" }}
levels = {levels}
"""


def twin(increments, signs, level, shape):
    """The wave of the paper's scripts: calls x channels, its state kept from call to call and over the episodes."""
    signs = numpy.array(signs, dtype=float)
    value, direction, values = numpy.zeros(len(signs)), signs.copy(), []
    for increment in increments:
        for i, sign in enumerate(signs):
            if sign == 0:
                continue
            value[i] += (sign if shape == "sawtooth" else direction[i]) * increment[i]
            if shape == "sawtooth":
                value[i] = 0.01 * sign if sign * value[i] >= level else value[i]
            elif sign * value[i] >= level or sign * value[i] <= 0:
                value[i] = level * sign if sign * value[i] >= level else 0
                direction[i] = -direction[i]
        values.append(value.copy())
    return numpy.array(values)


def wave(trace, site):
    """What was injected in an episode: calls x channels."""
    if site == "dynamics":
        return numpy.array(trace["force"]).T
    if site == "action":
        return (numpy.array(trace["disturbed"]) - numpy.array(trace["commanded"])).T
    return (numpy.array(trace["observation"]) - numpy.array(trace["state"])).T


def injected(gust, folder, site, shape):
    """What was injected at each level, over all episodes in order."""
    kept = EPISODES * len(LEVELS)
    study = STUDY.format(episodes=EPISODES, kept=kept, site=site, mask=MASKS[site], shape=shape, levels=LEVELS)
    (folder / f"{shape}.toml").write_text(study)
    gust("run", f"{shape}.toml", "--out", shape)
    (traces,) = [found for found in map(json.loads, (path.read_text() for path in (folder / shape).rglob("traces.json")))
                 if len(found) == kept]
    traces.sort(key=lambda trace: (trace["cell"], trace["episode"]))
    return numpy.array([numpy.concatenate([wave(trace, site) for trace in traces[first:first + EPISODES]])
                        for first in range(0, kept, EPISODES)])


@pytest.mark.parametrize("site", MASKS)
def test_episodes_see_successive_pieces_of_one_wave_of_the_scripts(gust, tmp_path, site):
    waves = {shape: injected(gust, tmp_path, site, shape) for shape in ("sawtooth", "triangle")}
    unbounded = waves["sawtooth"][-1]
    assert len(unbounded) == EPISODES * (251 if site == "observation" else 250)
    assert numpy.array_equal(unbounded, waves["triangle"][-1])
    increments = numpy.abs(numpy.diff(unbounded, axis=0, prepend=0))
    assert increments[:, 0].mean() == pytest.approx(0.00798, rel=0.08)  # four standard errors

    for shape, found in waves.items():
        for level, values in zip(LEVELS[:-1], found):
            # Differences of sums, and of states of a pole that swings: some 1e-12.
            assert numpy.abs(values - twin(increments, MASKS[site], level, shape)).max() < 1e-9, (shape, level)
