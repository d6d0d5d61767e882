"""gust train: a policy file that gust eval takes, the same bytes however often it is interrupted."""

import json
import os
import pathlib
import signal
import subprocess
import time

import pytest
from conftest import PROGRAM

SHORT = ["train", "ppo", "--plant", "cartpole", "--preset", "scg-2022", "--steps", "2000"]


def test_trained_policy_is_a_file_that_eval_takes(gust, tmp_path):
    done = gust(*SHORT, "--seed", "3", "--out", "ppo.onnx")
    assert done.stdout == "ppo.onnx\n"
    assert "2000 steps" in done.stderr
    (row,) = json.loads(gust("eval", "ppo.onnx", "--plant", "cartpole", "--preset", "scg-2022", "--json").stdout)
    assert 1 <= row["length"] <= 250
    assert [path.name for path in tmp_path.iterdir()] == ["ppo.onnx"]


def test_trained_policy_knows_what_it_was_made_for(gust):
    gust(*SHORT, "--out", "ppo.onnx")
    wrong = gust("eval", "ppo.onnx", "--plant", "cartpole", "--preset", "scg-default", code=2)
    assert "made for the preset 'scg-2022'" in wrong.stderr
    gust("eval", "ppo.onnx", "--plant", "cartpole", "--preset", "scg-2022", "--set", "normalized_action=false", code=2)


def test_a_folder_that_is_not_there_is_an_error_before_any_work(gust, tmp_path):
    assert "--out: 'no/such/x.onnx': no/such is not there; make the folder first" in gust(
        *SHORT, "--out", "no/such/x.onnx", code=2).stderr
    (tmp_path / "file").write_text("")
    assert "is no folder" in gust(*SHORT, "--out", "file/x.onnx", code=2).stderr
    assert "--csv: 'no/x.csv': no is not there" in gust("export", "a.gust", "--csv", "no/x.csv", code=2).stderr
    assert "--sqlite: 'no/x.db': no is not there" in gust("export", "a.gust", "--sqlite", "no/x.db", code=2).stderr
    assert "FILE: 'no/x.pack': no is not there" in gust("store", "pack", "a.gust", "no/x.pack", code=2).stderr
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_angles_that_look_like_degrees_are_told(gust, tmp_path):
    limit = ["--plant", "cartpole", "--set", "theta_limit=12"]
    study = tmp_path / "s.toml"
    study.write_text('schema = 1\nname = "s"\nplant = { kind = "cartpole", theta_limit = 12, steps = 5 }\n'
                     '[[policy]]\nname = "zero"\nkind = "zero"\n')
    for command in (["train", "ppo", *limit, "--steps", "400", "--out", "a.onnx"], ["eval", "zero", *limit],
                    ["plan", study], ["run", study]):
        assert "theta = 12 rad, more than half a turn" in gust(*command).stderr
    assert "half a turn" not in gust("eval", "zero", "--plant", "cartpole", "--set", "theta_limit=0.209").stderr


def test_draws_that_cannot_hover_are_told(gust):
    quadrotor = ["train", "ppo", "--plant", "quadrotor", "--steps", "1000", "--out", "ppo.onnx"]
    assert "warning" not in gust(*quadrotor).stderr
    assert "gust: warning: randomise: some of mass, drawn from 0.022 to 0.032 kg" in gust(
        *quadrotor, "--set", "randomise=mid").stderr


def test_equal_commands_give_equal_bytes_and_other_seeds_or_options_do_not(gust, tmp_path):
    variants = {"a": [], "b": [], "seed": ["--seed", "2"], "rate": ["--set", "actor_rate=1e-3"],
                "reading": ["--set", "effort=applied"], "plant": ["--set", "pole_length=0.4"],
                "modern": ["--set", "profile=modern"], "drawn": ["--set", "randomise=mid"]}
    for name, more in variants.items():
        gust(*SHORT, *more, "--out", f"{name}.onnx")
    files = {name: (tmp_path / f"{name}.onnx").read_bytes() for name in variants}
    assert files["a"] == files["b"]
    assert len(set(files.values())) == len(variants) - 1


def wait_until_busy(process, seconds=0.2):
    """Waits until a process has used so much time of a processor: it is then well inside its work, on any machine."""
    ticks = os.sysconf("SC_CLK_TCK")
    while process.poll() is None:
        used = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
        if (int(used[11]) + int(used[12])) / ticks >= seconds:
            return
        time.sleep(0.005)


@pytest.mark.parametrize(("how", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 75), (signal.SIGKILL, -9)])
def test_interrupted_training_goes_on_and_gives_the_same_bytes(gust, tmp_path, how, code):
    steps = ["train", "ppo", "--plant", "cartpole", "--steps", "100000"]
    gust(*steps, "--out", "whole.onnx")
    command = [PROGRAM, *steps, "--out", "cut.onnx"]
    interrupted = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wait_until_busy(interrupted)
    interrupted.send_signal(how)
    out, err = interrupted.communicate(timeout=60)
    assert interrupted.returncode == code, "the training was over before the signal: train longer"
    assert out == ""
    assert not (tmp_path / "cut.onnx").exists()
    if how != signal.SIGKILL:
        assert "the same command goes on from here" in err
        assert (tmp_path / "cut.onnx.checkpoint").exists()
    gust(*steps, "--out", "cut.onnx")
    assert (tmp_path / "cut.onnx").read_bytes() == (tmp_path / "whole.onnx").read_bytes()
    assert not (tmp_path / "cut.onnx.checkpoint").exists()


def test_damaged_or_foreign_checkpoint_is_as_if_it_were_not_there(gust, tmp_path):
    gust(*SHORT, "--out", "whole.onnx")
    for content in (b"", b"x" * 1000):
        (tmp_path / "p.onnx.checkpoint").write_bytes(content)
        gust(*SHORT, "--out", "p.onnx")
        assert (tmp_path / "p.onnx").read_bytes() == (tmp_path / "whole.onnx").read_bytes()
