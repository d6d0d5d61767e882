"""gust compare: which of two policies is better, by how much, and what it says where it cannot know."""

import json

import pytest

STUDY = """
schema = 1
name = "pair"
plant = { kind = "cartpole", preset = "scg-default" }
[evaluate]
episodes = 4
[[policy]]
name = "lqr"
kind = "lqr"
[[policy]]
name = "none"
kind = "zero"
[[sweep]]
name = "push"
site = "action"
waveform = { kind = "step", offset = 2 }
levels = [0, 5, 30]
"""


@pytest.fixture
def study(gust, tmp_path):
    """A finished study of two policies in the folder where gust runs."""
    (tmp_path / "pair.toml").write_text(STUDY)
    gust("run", "pair.toml")
    return tmp_path


def test_the_better_policy_is_named_with_its_lead(gust, study):
    done = gust("compare", "lqr", "none", "pair.gust")
    assert "undisturbed: lqr is ahead" in done.stdout
    assert "push: lqr is ahead" in done.stdout
    assert all(len(line) <= 80 for line in done.stdout.splitlines())


def test_json_holds_every_level_and_turns_round_with_the_names(gust, study):
    forth = json.loads(gust("compare", "lqr", "none", "pair.gust", "--json").stdout)
    back = json.loads(gust("compare", "none", "lqr", "pair.gust", "--json").stdout)
    assert [item["sweep"] for item in forth["comparisons"]] == [None, "push"]
    assert [level["level"] for level in forth["comparisons"][1]["levels"]] == [0, 5, 30]
    for one, other in zip(forth["comparisons"], back["comparisons"]):
        assert one["difference"]["estimate"] == pytest.approx(-other["difference"]["estimate"])
        assert {one["verdict"], other["verdict"]} in ({"ahead", "behind"}, {"undecided"})
        assert one["improvement"]["estimate"] == pytest.approx(1 - other["improvement"]["estimate"])


def test_names_that_are_none_and_a_policy_against_itself_are_errors(gust, study):
    for arguments, message in [
        (("lqq", "none"), "no policy 'lqq'; did you mean 'lqr'?"),
        (("lqr", "lqr"), "compared with itself"),
        (("lqr", "none", "--start", "nomnal"), "did you mean 'nominal'?"),
    ]:
        done = gust("compare", *arguments[:2], "pair.gust", *arguments[2:], code=2)
        assert message in done.stderr and done.stderr.count("gust:") == 1


def test_more_episodes_decide_nothing_where_all_are_the_same_one(gust, study):
    fixed = gust("compare", "lqr", "none", "pair.gust", "--start", "nominal").stdout
    assert "every episode is the same one, so more of them decide nothing" in fixed
    assert "would decide" not in fixed.replace("\n", " ")


def test_the_page_has_the_comparison(study):
    page = (study / "pair.gust" / "report.html").read_text()
    assert "Which is better, and by how much" in page
