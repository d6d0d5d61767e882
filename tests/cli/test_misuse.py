"""Mistakes on the command line: exit code 2, one clear line, nothing on stdout."""

import re
import subprocess

import pytest
from conftest import PROGRAM, ROOT

DEMO = ROOT / "studies/demo.toml"
EVAL = ["eval", "lqr", "--plant", "cartpole"]
STEP = [*EVAL, "--site", "action", "--waveform", "step", "--level", "1"]
TRAIN = ["train", "ppo", "--plant", "cartpole", "--preset", "scg-2022"]

MISTAKES = [
    ([], "which command?"),
    (["evla"], "unknown command 'evla'; did you mean 'eval'?"),
    (["help", "evla"], "unknown command 'evla'; did you mean 'eval'?"),
    (["--colour", "never", "version"], "unknown option '--colour'; did you mean '--color'?"),
    (["--color"], "--color: "),
    (["list", "--color"], "--color: "),
    (["--color", "never"], "which command?"),
    (["version", "now"], "unexpected argument 'now'"),
    (["eval", "lqr"], "--plant is required"),
    (["eval", "--plant", "cartpole"], "POLICY is required"),
    ([*EVAL, "--levle", "2"], "unknown option '--levle'; did you mean '--level'?"),
    (["eval", "lqrr", "--plant", "cartpole"], "unknown policy 'lqrr'; did you mean 'lqr'?"),
    (["eval", "pd", "--plant", "cartpole"], "the plant cartpole has no policy 'pd'"),
    (["eval", "missing.onnx", "--plant", "cartpole"], "missing.onnx: "),
    (["eval", "lqr", "--plant", "cartpol"], "unknown plant 'cartpol'; did you mean 'cartpole'?"),
    ([*EVAL, "--preset", "scg-2202"], "unknown preset 'scg-2202'; did you mean 'scg-2022'?"),
    ([*EVAL, "--preset", "modern"], "unknown preset 'modern'"),
    ([*EVAL, "--start", "nominel"], "did you mean 'nominal'?"),
    ([*EVAL, "--start", "0,0,0"], "must have 4 numbers (x,x_dot,theta,theta_dot), got 3"),
    ([*EVAL, "--start", "0,0,0,inf"], "must be a finite number"),
    ([*EVAL, "--site", "action"], "needs all of --site, --waveform (or --effect) and --level"),
    ([*EVAL, "--set", "mask=1"], "'mask' belongs to a disturbance"),
    ([*EVAL, "--set", "offset=1"], "options of a disturbance need --site, --waveform or --effect, and --level"),
    ([*EVAL, "--site", "actoin", "--waveform", "step", "--level", "1"], "unknown site 'actoin'; did you mean 'action'?"),
    ([*EVAL, "--site", "action", "--waveform", "setp", "--level", "1"], "did you mean 'step'?"),
    ([*EVAL, "--site", "action", "--waveform", "step", "--level", "high"], "'level' must be a number"),
    ([*EVAL, "--site", "action", "--waveform", "step", "--level", "nan"], "must be a finite number"),
    ([*STEP, "--set", "ofset=1"], "unknown key 'ofset'; did you mean 'offset'?"),
    ([*STEP, "--set", "offset=-1"], "'offset' must be >= 0, got -1"),
    ([*STEP, "--set", "offset=250"], "must lie within the episode"),
    ([*STEP, "--set", "offset"], "'offset' must read key=value"),
    ([*STEP, "--set", "offset=1", "--set", "offset=2"], "'offset' is given twice"),
    ([*STEP, "--set", "mask=11"], "'mask' must have 1 entries"),
    ([*STEP, "--set", "mask=0"], "disturbs nothing; choose at least one of the channels force"),
    ([*STEP, "--set", "mask=1", "--set", "channels=force"], "'mask' and 'channels' say the same"),
    ([*STEP, "--set", "channels=torque"], "unknown channel 'torque'"),
    ([*STEP, "--set", "start=5", "--set", "end=5"], "'end' must be after 'start'"),
    ([*STEP, "--set", "end=251"], "within the episode, 0 to 250"),
    ([*EVAL, "--set", "effort=aplied"], "did you mean 'applied'?"),
    ([*EVAL, "--param", "pole_lenght=1"], "unknown parameter 'pole_lenght'; did you mean 'pole_length'?"),
    ([*EVAL, "--param", "pole_length=-1"], "'pole_length' must be > 0"),
    ([*EVAL, "--param", "pole_length=x0"], "'pole_length' must be > 0"),
    ([*EVAL, "--param", "pole_length=long"], "'pole_length' must be a number"),
    ([*EVAL, "--terminate", "maybe"], "must be yes or no"),
    ([*EVAL, "--episodes", "0"], "--episodes: must be 1 to"),
    ([*EVAL, "--episodes", "many"], "--episodes"),
    ([*EVAL, "--episodes", "1e3"], "--episodes: must be a whole number, got '1e3'"),
    ([*EVAL, "--seed", "-1"], "--seed: must be a whole number, >= 0, got '-1'"),
    ([*EVAL, "--seed", "9" * 30], "--seed: must be a whole number, >= 0, got '999"),
    ([*TRAIN, "--steps", "1e3", "--out", "p.onnx"], "--steps: must be a whole number, got '1e3'"),
    ([*EVAL, "--episodes"], "--episodes"),
    ([*STEP, "--level", "2"], "--level"),
    ([*TRAIN, "--set", "randomise=hihg", "--out", "p.onnx"], "unknown range 'hihg' of parameters; did you mean 'high'?"),
    (["train", "rarl", *TRAIN[2:], "--set", "scale=0", "--out", "p.onnx"], "'scale' must be > 0, got 0"),
    (["train", "rarl", *TRAIN[2:], "--set", "site=dynamic", "--out", "p.onnx"], "did you mean 'dynamics'?"),
    (["train", "rap", *TRAIN[2:], "--set", "population=0", "--out", "p.onnx"], "'population' must be 1 to 8, got 0"),
    (["train", "rap", *TRAIN[2:], "--set", "populaton=2", "--out", "p.onnx"], "did you mean 'population'?"),
    (["list", "waveform", "extra"], "unexpected argument 'extra'"),
    (["list", "waveforme"], "unknown kind 'waveforme'; did you mean 'waveforms'?"),
    (["describe", "waveform"], "NAME is required"),
    (["describe", "waveform", "sien"], "unknown waveform 'sien'; did you mean 'sine'?"),
    (["completion", "bsh"], "unknown shell 'bsh'; did you mean 'bash'?"),
    (["preview", "missing.toml"], "missing.toml"),
    (["run"], "STUDY is required"),
    (["run", "/dev/null"], "/dev/null:1:1: a study begins with 'schema = 1'"),
    (["run", "/dev/zero"], "/dev/zero: cannot read: longer than"),
    (["run", "."], ".: cannot read: Is a directory"),
    (["plan", DEMO, "--set", "evaluate=5"], "'evaluate' must be a table"),
    (["plan", DEMO, "--set", "policy.lqr=3"], "'policy' must be a table"),
    (["plan", DEMO, "--set", "policy.lqt.r=3"], "the study has no 'lqt' there; did you mean 'lqr'?"),
    (["plan", DEMO, "--set", 'policy."lqr.r=3'], "a quote is not closed"),
    (["plan", DEMO, "--set", "name=../../x"], "no slashes, no leading dot, got '../../x'"),
    (["plan", DEMO, "--set", "claim.step-3N.where.level=4"], "sweep 'action step' has no level 4; it has [0, 1.5, 3"),
    (["plan", DEMO, "--set", "claim.nominal.holds=survival => 1"], "column 10: expected >=, >, <= or <"),
    (["run", DEMO, "--threads", "0"], "--threads: must be a whole number, 1 to 1024, got '0'"),
    (["run", DEMO, "--out", "/proc/x"], "/proc/x: cannot make the folder"),
    (["report", "."], ".: holds no study; give the folder that 'gust run' or 'gust reproduce' left"),
    (["export", "."], "where to? give --csv FILE, --sqlite FILE, or both"),
    (["export", ".", "--csv", "a", "--sqlite", "a"], "--csv and --sqlite: name two files"),
    (["validate", "recording.csv"], "is recording.json meant?"),
    (TRAIN, "--out is required"),
    ([*TRAIN, "--out", "ppo.txt"], "must end in .onnx"),
    (["train", "pop", "--plant", "cartpole", "--out", "p.onnx"], "unknown agent 'pop'; did you mean 'ppo'?"),
    ([*TRAIN, "--out", "p.onnx", "--steps", "0"], "'steps' must be"),
    ([*TRAIN, "--out", "p.onnx", "--set", "clpi=0.1"], "unknown key 'clpi'; did you mean 'clip'?"),
    ([*TRAIN, "--out", "p.onnx", "--set", "profile=moderm"], "did you mean 'modern'?"),
    ([*TRAIN, "--out", "/proc/p.onnx"], "/proc/p.onnx"),
]


@pytest.mark.parametrize(("arguments", "message"), MISTAKES, ids=[" ".join(map(str, mistake[0])) for mistake in MISTAKES])
def test_mistake_is_told_in_one_line(gust, tmp_path, arguments, message):
    done = gust(*arguments, code=2, seconds=20)
    assert done.stdout == ""
    assert re.fullmatch(r"gust: [^\n]+\n", done.stderr), done.stderr
    assert message in done.stderr
    assert "gust: gust:" not in done.stderr
    assert not list(tmp_path.iterdir())


def test_files_that_are_no_policy_are_refused(gust, tmp_path):
    for content in (b"", b"not protobuf at all", bytes(range(256)) * 100):
        (tmp_path / "bad.onnx").write_bytes(content)
        done = gust("eval", "bad.onnx", "--plant", "cartpole", code=2, seconds=20)
        assert re.fullmatch(r"gust: bad\.onnx: [^\n]+\n", done.stderr)
    (tmp_path / "folder.onnx").mkdir()
    assert "folder.onnx" in gust("eval", "folder.onnx", "--plant", "cartpole", code=2).stderr


def test_output_that_cannot_be_written_is_an_error():
    with open("/dev/full", "w") as full:
        done = subprocess.run([PROGRAM, "list"], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2
    assert done.stderr == "gust: standard output: cannot be written to\n"
