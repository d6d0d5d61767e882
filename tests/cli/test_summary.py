"""What a study prints when it is done: every line fits, on a terminal and elsewhere."""

import subprocess

import pytest
from conftest import PROGRAM, in_terminal

STUDY = """
schema = 1
name   = "summary"
plant  = { kind = "cartpole" }

[evaluate]
episodes = 3

POLICIES

[[sweep]]
name     = "observation triangle"
site     = "observation"
waveform = "triangle"
levels   = [0, 0.1, 0.3]
"""
POLICIES = "\n".join(f'[[policy]]\nname = "weight {r} on effort"\nkind = "lqr"\nr = [{r}]' for r in range(1, 9))


def printed_at(folder, columns):
    """What `gust show` prints on a terminal of so many columns, or into a pipe."""
    command = [PROGRAM, "show", "summary.gust"]
    if columns is None:
        return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout
    return in_terminal(command, folder, columns)


def test_a_study_without_levels_says_so(gust, tmp_path):
    (tmp_path / "study.toml").write_text(STUDY.replace("POLICIES", POLICIES).partition("[[sweep]]")[0])

    assert gust("run", "study.toml").stdout == (
        "No margins: nothing grows level by level. The page shows what was measured.\n\nPage: summary.gust/report.html\n")


@pytest.mark.parametrize("columns", [80, 120, None, 400])
def test_margins_of_many_policies_fit_in_blocks(gust, tmp_path, columns):
    (tmp_path / "study.toml").write_text(STUDY.replace("POLICIES", POLICIES))
    gust("run", "study.toml")

    lines = printed_at(tmp_path, columns).splitlines()

    assert max(map(len, lines)) <= (columns or 100)
    tables = sum(line.startswith("sweep") for line in lines)
    assert tables == 2 if columns == 400 else tables > 2  # there are two starts
    assert all(sum(f"weight {r} on effort" in line for line in lines) == 2 for r in range(1, 9))


def test_a_training_that_diverges_is_told_once_with_what_it_took_along(gust, tmp_path):
    policy = ('[[policy]]\nname = "ppo"\nkind = "train"\nseeds = [1, 2]\n'
              'agent = { kind = "ppo", steps = 4000, actor_rate = 1e38, critic_rate = 1e38 }\n')
    (tmp_path / "study.toml").write_text(STUDY.replace("POLICIES", policy))

    told = gust("run", "study.toml", code=1).stderr.splitlines()
    said = [line for line in told if " failed: " in line or "skipped" in line]

    assert [line.split(" failed: ")[0] for line in said] == ["gust: train ppo seed 1", "gust: train ppo seed 2"]
    assert all(line.endswith("; 2 trials of it skipped") for line in said)  # undisturbed, and the sweep


CLAIM = """
[[claim]]
id    = "an id of more than a few letters"
text  = "The regulator keeps nine tenths of what it earns when nothing disturbs it, however the pole is seen to swing."
where = { policy = "weight 1 on effort", sweep = "observation triangle", level = 0.1 }
holds = "anr_h >= 0.9"
"""


@pytest.mark.parametrize("columns", [60, 80])
def test_claims_wrap_at_words(gust, tmp_path, columns):
    (tmp_path / "study.toml").write_text(STUDY.replace("POLICIES", POLICIES) + CLAIM)
    gust("run", "study.toml")

    shown = printed_at(tmp_path, columns)
    claims = shown.partition("Claims\n\n")[2]

    assert max(map(len, claims.splitlines())) <= columns
    assert " ".join(claims.split()).startswith(("holds an id of more", "fails an id of more", "undecided an id of more"))
    assert "keeps nine tenths of what it earns when nothing disturbs it" in " ".join(claims.split())
    text = CLAIM.partition('text  = "')[2].partition('"')[0]
    assert all(word in text.split() for word in claims.partition("The ")[2].split("\n\n")[0].split())


def test_random_starts_lead_and_units_are_those_of_what_is_disturbed(gust, tmp_path):
    one = POLICIES.partition("[[policy]]")[2].partition("[[policy]]")[0]
    tilt = STUDY.replace("POLICIES", "[[policy]]" + one) + '''
[[sweep]]
name     = "tilt"
site     = "observation"
channels = "theta"
waveform = "step"
levels   = [0, 0.1, 0.3]

[[sweep]]
name     = "push"
site     = "dynamics"
waveform = "step"
levels   = [0, 0.1, 0.3]
'''
    (tmp_path / "study.toml").write_text(tilt)

    shown = gust("run", "study.toml").stdout

    assert shown.index("random start") < shown.index("nominal start")
    lines = [line.split("  ") for line in shown.splitlines()]
    units = {line[0]: [part.strip() for part in line if part] for line in lines if len(line) > 2}
    assert "rad" in units["tilt"] and "N" in units["push"]
    assert "m, m/s, rad, rad/s" in units["observation triangle"]
