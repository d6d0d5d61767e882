"""Where output goes: through links and into what is open, and what happens where nobody takes it."""

import json
import os
import subprocess

import pytest
from conftest import PROGRAM, ROOT, in_terminal

STUDY = """
schema = 1
name   = "small"
plant  = { kind = "cartpole" }

[evaluate]
episodes = 2

[[policy]]
name = "lqr"
kind = "lqr"
"""
SWEEP = """
[[sweep]]
name     = "push"
site     = "action"
waveform = "step"
levels   = [0, 3]
"""
DIVERGING = """
[[policy]]
name  = "ppo"
kind  = "train"
seeds = [1, 2]
agent = { kind = "ppo", steps = 2000, actor_rate = 1e300 }
"""


@pytest.fixture
def ran(gust, tmp_path):
    """A folder with small.gust."""
    (tmp_path / "small.toml").write_text(STUDY + SWEEP)
    gust("run", "small.toml")
    return tmp_path


def in_shell(folder, line):
    """Runs a line of a shell in which $gust is the program."""
    return subprocess.run(["bash", "-c", line], cwd=folder, env={**os.environ, "gust": str(PROGRAM)},
                          capture_output=True, text=True, timeout=60)


@pytest.mark.parametrize("arguments", [("export", "small.gust", "--csv"), ("export", "small.gust", "--sqlite"),
                                       ("store", "pack", "small.gust")], ids=["csv", "sqlite", "pack"])
def test_a_link_is_followed_and_stays(gust, ran, arguments):
    (ran / "there").mkdir()
    for link, target in (("first", "there/second"), ("there/second", "target")):
        (ran / link).symlink_to(target)

    for _ in range(2):  # to nothing, then to what was written
        gust(*arguments, "first")
        assert (ran / "first").is_symlink() and (ran / "there/second").is_symlink()
        assert (ran / "there/target").stat().st_size > 100
        assert sorted(path.name for path in (ran / "there").iterdir()) == ["second", "target"]


def test_a_policy_is_written_through_a_link_and_over_nothing_but_a_file(gust, tmp_path):
    train = ("train", "ppo", "--plant", "cartpole", "--steps", 1000, "--out")
    (tmp_path / "link.onnx").symlink_to("target")
    (tmp_path / "full.onnx").symlink_to("/dev/full")

    gust(*train, "link.onnx")

    assert (tmp_path / "link.onnx").is_symlink()
    assert (tmp_path / "target").stat().st_size > 1000
    assert gust(*train, "full.onnx", code=2).stderr == (
        "gust: --out: 'full.onnx' is no regular file; choose another\n")


def test_an_open_stream_takes_a_table_and_refuses_what_is_none(ran):
    (ran / "stdout").symlink_to("/proc/self/fd/1")

    piped = in_shell(ran, "$gust export small.gust --csv stdout | cat")
    added = in_shell(ran, "echo before > all.csv; $gust export small.gust --csv stdout >> all.csv")
    closed = in_shell(ran, "$gust export small.gust --csv stdout >&-")

    assert piped.stdout.startswith("plant,preset,") and piped.stdout.count("\n") > 100
    assert (added.returncode, (ran / "all.csv").read_text()) == (0, "before\n" + piped.stdout)
    assert closed.returncode == 2 and "cannot write" in closed.stderr
    for refused in ("export small.gust --sqlite stdout", "store pack small.gust stdout"):
        done = in_shell(ran, f"$gust {refused} | cat; exit ${{PIPESTATUS[0]}}")
        assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert (ran / "stdout").is_symlink()


@pytest.mark.parametrize(("command", "code"), [("frob", 2), ("plan small.toml", 0), ("run small.toml", 0),
                                               ("train ppo --plant cartpole --steps 1000 --out p.onnx", 0)])
@pytest.mark.parametrize("nobody", ["2>&-", "2>/dev/full"])
def test_a_stderr_that_takes_nothing_changes_no_exit_code(ran, command, code, nobody):
    assert in_shell(ran, f"$gust {command} {nobody}").returncode == code


def test_no_file_takes_the_place_of_a_closed_stderr(ran):
    (ran / "small.gust/store/evaluate").rename(ran / "gone")
    (ran / "small.gust/store/evaluate").mkdir()
    whole = sorted((ran / "gone").iterdir())
    for trial in whole[1:]:
        trial.rename(ran / "small.gust/store/evaluate" / trial.name)

    assert in_shell(ran, "$gust export small.gust --csv out.csv 2>&-").returncode == 1
    assert "gust:" not in (ran / "out.csv").read_text()


@pytest.mark.parametrize("command", ["version", "--version", "--help", "list"])
def test_a_full_stdout_is_an_error(tmp_path, command):
    done = in_shell(tmp_path, f"$gust {command} > /dev/full")
    assert (done.returncode, done.stderr) == (2, "gust: standard output: cannot be written to\n")


def test_what_a_diverged_training_leaves_out_is_told_and_the_rest_exported(gust, tmp_path):
    (tmp_path / "small.toml").write_text(STUDY + DIVERGING + SWEEP)
    gust("run", "small.toml", code=1)

    told = gust("export", "small.gust", "--csv", "out.csv", "--sqlite", "out.db", code=1).stderr
    reported = gust("report", "small.gust", code=1)

    assert told == "".join(
        f"gust: train ppo seed {seed} failed: the network's parameters are not finite after 400 steps; "
        "2 trials of it missing\n" for seed in (1, 2))
    lines = (tmp_path / "out.csv").read_text().splitlines()
    assert len(lines) > 100 and all(",lqr," in line for line in lines[1:])
    assert (tmp_path / "out.db").stat().st_size > 1000
    assert reported.stdout == "small.gust/report.html\n"
    assert reported.stderr == gust("show", "small.gust", code=1).stderr
    assert reported.stderr.startswith("gust: not in the store: ")


def test_an_export_of_nothing_at_all_is_an_error(gust, ran):
    (ran / "small.gust/store/evaluate").rename(ran / "gone")
    done = gust("export", "small.gust", "--csv", "out.csv", code=2)
    assert "is not in the store; run the study first" in done.stderr
    assert not (ran / "out.csv").exists()


def test_packing_a_store_with_a_damaged_trial_keeps_the_others_and_says_so(gust, ran):
    trial = next((ran / "small.gust/store/evaluate").iterdir())
    (trial / "rows.bin").write_bytes(b"damaged")

    done = gust("store", "pack", "small.gust", "out.pack", code=1)

    assert done.stdout.startswith("out.pack: 2 trials, ")
    assert "gust: out.pack: lacks 1 damaged trial; run the study again\n" in done.stderr
    assert gust("store", "unpack", "out.pack", "new.gust").stdout == "new.gust: 2 trials added, 0 were there\n"


def test_names_with_control_characters_reach_no_terminal(gust, tmp_path):
    (tmp_path / "a\x1b[31m.json").write_text("{")
    assert r"gust: a\x1b[31m.csv: is not there" in gust("validate", "a\x1b[31m.json", code=2).stderr
    (tmp_path / "small.toml").write_text(STUDY + SWEEP + """
[[claim]]
id    = "red"
text  = "\\u001B[31m \\u009B32m"
where = { policy = "lqr" }
holds = "survival >= 0"
""")
    shown = gust("run", "small.toml").stdout
    assert r"\x1b[31m \x9b32m" in shown and "\x1b" not in shown and "\x9b" not in shown


def test_a_name_too_long_or_not_of_letters_is_no_internal_error(gust, ran):
    long = "x" * 300
    for command in (("report", long), ("show", long), ("run", "small.toml", "--out", long), ("plan", long),
                    ("export", "small.gust", "--csv", long), ("store", "pack", "small.gust", long)):
        told = gust(*command, code=2).stderr
        assert "internal error" not in told and told.count("\n") == 1
    odd = os.fsencode(ran) + b"/caf\xe9.toml"
    with open(odd, "w") as study:
        study.write(STUDY.replace("small", "odd"))
    done = subprocess.run([PROGRAM, "run", b"caf\xe9.toml"], cwd=ran, capture_output=True)
    assert (done.returncode, done.stderr) == (0, b"")
    gust("report", "odd.gust")


WIDE = """
[[policy]]
name = "cautious"
kind = "lqr"
r    = [5]

[[sweep]]
name     = "a push on the cart"
site     = "action"
waveform = { kind = "step", offset = 2 }
levels   = [0, 5, 30]
disturb  = [{ site = "dynamics", waveform = "white", level = 0.01, start = 10, end = 50 }]

[[claim]]
id    = "margin"
text  = "The regulator tolerates a push that lasts from the second step of an episode on to its end."
holds = "all(margin(score(p, 'a push on the cart')) >= 0.5 for p in ['lqr', 'cautious']) and min(survival('lqr'), survival('cautious')) >= 0.99"
"""
CATALOGUE = [("plant", "cartpole"), ("plant", "quadrotor"), ("preset", "scg-2022"), ("preset", "modern"),
             ("distribution", "normal"), ("waveform", "scg_ramp"), ("agent", "wcpg"), ("metric", "anr"), ("site", "action")]
RECORDINGS = ROOT / "tests/reference/traj"


def test_what_people_read_fits_80_columns(gust, tmp_path):
    (tmp_path / "small.toml").write_text(STUDY + SWEEP + WIDE)
    gust("run", "small.toml")
    commands = [command["name"] for command in json.loads(gust("list", "commands", "--json").stdout)]
    told = [("list",), ("--help",), ("--help-all",), ("version",), ("plan", "small.toml"), ("preview", "small.toml"),
            ("run", "small.toml"), ("show", "small.gust"), ("compare", "lqr", "cautious", "small.gust"),
            ("eval", "lqr", "--plant", "quadrotor"), ("store", "pack", "small.gust", "out.pack"),
            ("eval", "lqr", "--plant", "cartpole", "--site", "action", "--waveform", "step", "--level", 5),
            ("plan", "paper", "--profile", "quick", "--only", "table-dr"),
            ("validate", *sorted(RECORDINGS.glob("d_*.json")))]
    told += [("describe", *item) for item in CATALOGUE] + [("help", command) for command in commands]

    for command in told:
        piped = gust(*command, code=None).stdout
        shown = in_terminal([PROGRAM, "--color", "never", *map(str, command)], tmp_path, 80)
        for line in [*piped.splitlines(), *shown.splitlines()]:
            assert len(line) <= 80, (command[:2], line)


@pytest.mark.parametrize("columns", [40, 60, 100])
def test_the_margins_fit_the_terminal(gust, tmp_path, columns):
    (tmp_path / "small.toml").write_text(STUDY + SWEEP + WIDE)
    gust("run", "small.toml")
    shown = in_terminal([PROGRAM, "--color", "never", "show", "small.gust"], tmp_path, columns)
    assert "cautious" in shown
    assert all(len(line) <= columns for line in shown.splitlines()), shown
