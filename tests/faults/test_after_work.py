"""Faults after the work: what was finished is said to be safe, what can be written is written, and the exit code is 1."""

import os
import resource
import signal
import subprocess
import time

import pytest
from conftest import PROGRAM
from test_every_call import STUDY, results, run, shim  # noqa: F401: a fixture


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "study.toml").write_text(STUDY)
    return tmp_path


def gust(folder, *command, **how):
    return subprocess.run([PROGRAM, *command], cwd=folder, text=True, timeout=120, **how)


def test_nobody_who_takes_the_answer_costs_neither_work_nor_page(folder):
    with open("/dev/full", "w") as full:
        done = gust(folder, "run", "study.toml", "--out", "out", stdout=full, stderr=subprocess.PIPE)

    assert done.returncode == 1
    assert done.stderr.endswith(
        "gust: standard output: cannot be written to; the results are in out (gust show)\n"
    ), done.stderr
    assert (folder / "out/report.html").exists()
    assert gust(folder, "show", "out", capture_output=True).returncode == 0


@pytest.mark.parametrize("most", range(5, 24))
def test_too_few_descriptors_end_with_a_sentence_and_the_next_run_with_equal_results(folder, most):
    calm = folder / "calm"
    calm.mkdir()
    (calm / "study.toml").write_text(STUDY)
    assert run(calm).returncode == 0

    few = gust(folder, "run", "study.toml", "--out", "out", "--threads", "1", capture_output=True,
               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (most, most)))  # fmt: skip

    assert few.returncode in (0, 1, 2), few.stderr
    assert "internal error" not in few.stderr
    assert few.returncode == 0 or few.stderr.startswith("gust: ")
    assert run(folder).returncode == 0
    assert results(folder) == results(calm)


def test_without_another_thread_the_work_is_done_on_one(folder, shim):  # noqa: F811
    calm = run(folder)
    expected = results(folder)
    subprocess.run(["rm", "-r", folder / "out"], check=True)
    for n in range(1, 12):
        done = run(folder, {"LD_PRELOAD": str(shim), "NTH_CALL": f"thread {n} 11"})
        assert done.returncode == 0, done.stderr
        assert (done.stdout, results(folder)) == (calm.stdout, expected)
        subprocess.run(["rm", "-r", folder / "out"], check=True)


def test_a_checkpoint_that_cannot_be_written_is_a_warning(folder):
    command = ["train", "ppo", "--plant", "cartpole", "--steps", "100000000", "--out", "a.onnx"]
    (folder / "a.onnx.checkpoint").mkdir()  # which no file can replace
    process = subprocess.Popen([PROGRAM, *command], cwd=folder, text=True, stderr=subprocess.PIPE)
    time.sleep(2)
    process.send_signal(signal.SIGTERM)
    said = process.communicate(timeout=60)[1]

    assert process.returncode == 75, said
    assert "warning: no checkpoint: a.onnx.checkpoint: cannot write: Is a directory" in said


def test_a_long_run_without_a_terminal_says_at_once_what_it_plans(folder):
    for command in (
        ["train", "ppo", "--plant", "cartpole", "--steps", "1000000000", "--out", "a.onnx"],
        ["run", "study.toml", "--out", "out", "--set", "policy.ppo.agent.steps=1000000000"],
    ):
        process = subprocess.Popen([PROGRAM, *command], cwd=folder, text=True, stderr=subprocess.PIPE)
        line = process.stderr.readline()
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)

        assert "about " in line and ("1000000000 steps" in line or "trials to run" in line), line


def test_errors_quote_at_most_200_characters(folder):
    long = "x" * 100_000
    (folder / "long.toml").write_text(f'schema = 1\nname = "s"\n{long} = 1\n')
    for command in (["run", "long.toml"], ["run", long[:5000]], [long], ["describe", "agent", long], ["run", "s", "--set", f"{long}=1"]):
        done = gust(folder, *command, capture_output=True)
        assert done.returncode == 2
        assert len(done.stderr) < 1000, len(done.stderr)


def test_what_a_killed_training_left_is_removed_by_the_next(folder):
    for name in (".a.onnx.checkpoint.aside", ".a.onnx.aside"):
        (folder / name).write_text("left")
    done = gust(folder, "train", "ppo", "--plant", "cartpole", "--steps", "400", "--out", "a.onnx", capture_output=True)

    assert done.returncode == 0, done.stderr
    assert sorted(os.listdir(folder)) == ["a.onnx", "study.toml"]
