"""How far a run is, on a terminal and elsewhere."""

import os
import pty
import re
import subprocess

from conftest import PROGRAM

STUDY = """
schema = 1
name   = "progress"
seed   = 1
plant  = { kind = "cartpole", preset = "scg-2022" }

[evaluate]
episodes = EPISODES

[[policy]]
name = "lqr"
kind = "lqr"

[[sweep]]
name     = "white noise on the action"
site     = "action"
waveform = { kind = "white" }
levels   = { from = 0, to = 5, count = COUNT }
"""
SECONDS_LONG = STUDY.replace("EPISODES", "100").replace("COUNT", "300")  # some seconds
SOON_DONE = STUDY.replace("EPISODES", "2").replace("COUNT", "2")


def run_on_terminal(folder, study, **environment):
    """Runs a study with stderr on a terminal of its own; returns stdout and what the terminal got."""
    (folder / "study.toml").write_text(study)
    ours, theirs = pty.openpty()
    settings = {"TERM": "xterm", "LC_ALL": "C.UTF-8", **environment}
    keep = {name: value for name, value in os.environ.items() if name not in ("NO_COLOR", "GUST_CACHE")}
    command = [PROGRAM, "run", "study.toml", "--threads", "2"]
    process = subprocess.Popen(
        command, cwd=folder, env=keep | settings, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=theirs
    )
    os.close(theirs)
    shown = b""
    while True:
        try:
            piece = os.read(ours, 65536)
        except OSError:  # the other end is closed
            break
        if not piece:
            break
        shown += piece
    said = process.communicate(timeout=60)[0].decode()
    assert process.returncode == 0, shown
    return said, shown.decode()


def test_a_terminal_gets_a_bar_that_is_gone_in_the_end(tmp_path):
    said, shown = run_on_terminal(tmp_path, SECONDS_LONG)

    assert re.search(r"━.* +\d+ %  \d/3 trials  (\d+:\d\d|\?) left", shown)
    assert "evaluate lqr · white noise on the action" in shown
    assert "\x1b[36m" in shown
    assert shown.endswith("\r\x1b[J")
    assert "\x1b" not in said and "left" not in said


def test_no_color_means_no_colours(tmp_path):
    _, shown = run_on_terminal(tmp_path, SECONDS_LONG, NO_COLOR="1")

    assert "trials" in shown
    assert set(re.findall(r"\x1b\[[0-9;]*[A-Za-z]", shown)) == {"\x1b[J", "\x1b[1A"}


def test_a_plain_locale_gets_a_plain_bar(tmp_path):
    _, shown = run_on_terminal(tmp_path, SECONDS_LONG, LC_ALL="C")

    assert re.search(r"#.*-.* %", shown)
    assert "━" not in shown


def test_what_is_soon_done_shows_nothing(tmp_path):
    _, shown = run_on_terminal(tmp_path, SOON_DONE)

    assert shown == ""


def test_a_file_gets_a_line_every_ten_percent(tmp_path, gust):
    (tmp_path / "study.toml").write_text(SECONDS_LONG)

    done = gust("run", "study.toml", "--threads", "2")

    lines = done.stderr.splitlines()
    shares = [int(re.fullmatch(r"gust: (\d+) %, \d of 3 trials(, \d+:\d\d left)?", line)[1]) for line in lines]
    assert 1 <= len(shares) <= 10
    assert all(later // 10 > earlier // 10 for earlier, later in zip(shares, shares[1:]))
    assert "%" not in done.stdout.split("Page:")[-1]
