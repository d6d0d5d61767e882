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
    assert rise == round(69 * 50 / 250)  # a fifth of the 69 columns
    assert set(top[rise:]) == {"*"} and set(bottom[:rise]) == {"*"}


def test_preview_uses_braille_where_the_locale_is_utf_8(gust, tmp_path):
    text = preview(gust, tmp_path, "C.UTF-8")
    assert any("\u2801" <= letter <= "\u28ff" for letter in text)


FAST = """
schema = 1
name = "fast"
plant = { kind = "cartpole" }

[[policy]]
name = "lqr"
kind = "lqr"

[[sweep]]
name = "a sine on the pole of which only a part reaches the plant, and which has a name of many words"
site = "dynamics"
waveform = { kind = "sine", frequency = FREQUENCY, phase = 0.125 }
levels = { from = 0, to = 2, count = 5 }
start = 20
end = 200

[[sweep]]
name = "seen"
site = "observation"
channels = { theta = 1, theta_dot = -2, x = 0.3333333333333333 }
waveform = { kind = "triangle", frequency = 2, polarity = "unipolar" }
levels = [0, 0.1]
"""


def test_preview_says_what_is_left_of_a_wave_and_fits_eighty_columns(gust, tmp_path):
    (tmp_path / "fast.toml").write_text(FAST.replace("FREQUENCY", "12.5"))

    done = gust("preview", "fast.toml")

    # sin(2 pi (k / 4 + 1 / 8)) is plus or minus the root of a half at every step
    assert "4 samples a period: -0.7071 to 0.7071 of the level reach the plant" in done.stdout
    assert "25 samples a period: 0 to 0.96 of the level reach the policy" in done.stdout
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert "the dynamics sine of 12.5 Hz has 4 samples a period: its shape is coarse" in done.stderr


def test_a_wave_at_half_the_control_rate_is_refused_by_every_command(gust, tmp_path):
    (tmp_path / "fast.toml").write_text(FAST.replace("FREQUENCY", "50"))
    said = "fast.toml:13:41: a sine of 50 Hz is sampled at 50 Hz: it vanishes"

    for command in ("preview", "run", "plan"):
        assert said in gust(command, "fast.toml", code=2).stderr

    assert [path.name for path in tmp_path.iterdir()] == ["fast.toml"]
    wave = ["eval", "lqr", "--plant", "cartpole", "--site", "action", "--waveform", "sine", "--level", "1", "--set"]
    assert "it acts as one of 1 Hz" in gust(*wave, "frequency=49", code=2).stderr
    assert "2.5 samples a period: its shape is coarse" in gust(*wave, "frequency=20").stderr
    assert gust(*wave, "frequency=5").stderr == ""


def test_preview_of_a_ramp_turns_at_the_level_that_is_drawn(gust, tmp_path):
    ramp = '\n[[sweep]]\nname = "ramp"\nsite = "action"\nwaveform = { kind = "scg_ramp", shape = "triangle" }\nlevels = [0, 0.125]\n'
    (tmp_path / "ramp.toml").write_text(STUDY + ramp)
    text = gust("preview", "ramp.toml", env={**os.environ, "LC_ALL": "C"}).stdout
    lines = text[text.index("drawn at level 0.125"):].splitlines()[2:7]
    assert lines[0].startswith("    0.125 +") and lines[4].startswith("        0 +")
    assert "*" in lines[0] and "*" in lines[4]  # it meets both ends
