"""gust preview: the disturbances of a study, drawn."""

import os

STUDY = """
schema = 1
name = "seen"
seed = 1
plant = { kind = "cartpole" }

[evaluate]
disturb = [{ site = "observation", waveform = "white", channels = ["theta"], level = 0.01 }]

[[policy]]
name = "lqr"
kind = "lqr"

[[sweep]]
name = "push"
site = "dynamics"
waveform = { kind = "step", offset = 50 }
levels = { from = 0, to = 2, count = 5 }

[[sweep]]
name = "length"
vary = "pole_length"
scale = [0.5, 1, 2]
"""


def preview(gust, tmp_path, locale):
    (tmp_path / "seen.toml").write_text(STUDY)
    environment = {key: value for key, value in os.environ.items() if not key.startswith("LC_")}
    done = gust("preview", "seen.toml", env={**environment, "LANG": locale})
    assert done.stderr == ""
    assert [path.name for path in tmp_path.iterdir()] == ["seen.toml"]  # nothing was run
    return done.stdout


def test_preview_draws_every_disturbance_in_plain_text(gust, tmp_path):
    text = preview(gust, tmp_path, "C")
    assert text.isascii()
    assert text.startswith("seen: cartpole, scg-2022, 250 control steps at 50 Hz\n")
    assert "in every evaluation\n  observation white(std = 1)" in text
    assert "  theta [rad]\n" in text
    assert "push: level 0 to 2 in 5 values\n" in text
    assert "  fx [N], fz [N]\n" in text  # one drawing for what looks the same
    assert "length: pole_length 0.25 to 1 in 3 values\n" in text


def test_preview_of_a_step_rises_once_at_its_offset(gust, tmp_path):
    text = preview(gust, tmp_path, "C")
    lines = text[text.index("fx [N], fz [N]"):].splitlines()[1:6]
    assert lines[0].startswith("        2 +") and lines[4].startswith("        0 +")
    top, bottom = (line.split("+", 1)[1] for line in (lines[0], lines[4]))
    rise = top.index("*")
    assert rise == 69 * 50 // 250  # a fifth of the 69 columns
    assert set(top[rise:]) == {"*"} and set(bottom[:rise]) == {"*"}


def test_preview_uses_braille_where_the_locale_is_utf_8(gust, tmp_path):
    text = preview(gust, tmp_path, "C.UTF-8")
    assert any("\u2801" <= letter <= "\u28ff" for letter in text)
