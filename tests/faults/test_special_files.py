"""Pipes, devices and huge files where files should be: one sentence, soon, in little memory."""

import os
import resource
import shutil
import signal
import subprocess
import time

import pytest
from conftest import PROGRAM
from runs import Runs

STEPS = 4_000


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    runs = Runs(tmp_path_factory.mktemp("finished"), STEPS)
    runs.study.write_text(runs.study.read_text().replace("episodes = 10", "episodes = 2"))
    runs.finish("out")
    return runs


@pytest.fixture
def runs(tmp_path, finished):
    copy = Runs(tmp_path, STEPS)
    copy.study.write_text(finished.study.read_text())
    shutil.copytree(finished.folder / "out", tmp_path / "out")
    return copy


def soon(folder, *command, megabytes=1000):
    """Runs a command that must end within seconds and in little memory."""
    limit = megabytes << 20
    before = lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit))  # noqa: E731
    done = subprocess.run(
        [PROGRAM, *map(str, command)], cwd=folder, capture_output=True, text=True, timeout=60, preexec_fn=before
    )
    assert "internal error" not in done.stderr and "out of memory" not in done.stderr, done.stderr
    return done


def one(folder, pattern):
    return sorted(folder.glob(pattern))[0]


PLACES = [
    "out/store/store.json",
    "out/store/timings.json",
    "out/store/evaluate/*/manifest.json",
    "out/store/evaluate/*/rows.bin",
    "out/store/train/*/policy.onnx",
    "out/store/train/*/curve.csv",
    "out/study.toml",
    "out/inputs.json",
    "out/report.html",
]


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("kind", ["pipe", "zeros", "sparse", "folder"])
def test_no_reading_command_waits_or_fills_memory(runs, place, kind):
    path = one(runs.folder, place)
    path.unlink()
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "zeros":
        path.symlink_to("/dev/zero")
    elif kind == "folder":
        path.mkdir()
    else:
        with open(path, "wb") as file:
            file.truncate(1 << 40)

    for command in (["show", "out"], ["export", "out", "--csv", "a.csv"], ["report", "out"], ["store", "check", "out"],
                    ["store", "pack", "out", "a.pack"], ["plan", "study.toml", "--out", "out"]):  # fmt: skip
        done = soon(runs.folder, *command)
        assert done.returncode in (0, 1, 2)
    done = soon(runs.folder, "run", "study.toml", "--out", "out", "--threads", 1)
    assert done.returncode in (0, 1, 2) and done.stderr.count("\n") < 12


def test_a_pipe_without_a_reader_is_an_error_and_no_hang(runs):
    os.mkfifo(runs.folder / "a.csv")

    assert "nobody reads from this pipe" in runs.gust("export", "out", "--csv", "a.csv", code=2)


@pytest.mark.parametrize("command", [["run", "p"], ["validate", "p.json"], ["plan", "p"], ["eval", "p.onnx", "--plant", "cartpole"],
                                     ["store", "unpack", "p", "new"]])  # fmt: skip
def test_a_pipe_as_input_is_refused(tmp_path, command):
    for name in ("p", "p.onnx", "p.json"):
        os.mkfifo(tmp_path / name)

    done = soon(tmp_path, *command)

    assert done.returncode == 2 and "pipe" in done.stderr


@pytest.mark.parametrize(("name", "command"), [
    ("s.toml", ["run", "s.toml"]),
    ("r.json", ["validate", "r.json"]),
    ("p.onnx", ["eval", "p.onnx", "--plant", "cartpole"]),
])  # fmt: skip
def test_a_huge_input_is_refused_before_it_is_read(tmp_path, name, command):
    with open(tmp_path / name, "wb") as file:
        file.truncate(900 << 20)

    done = soon(tmp_path, *command, megabytes=300)

    assert done.returncode == 2 and "longer than" in done.stderr


@pytest.mark.parametrize("pattern", ["/*/*/*", "/**", "/proc/*/task/*/*"])
def test_a_pattern_that_matches_half_the_disk_is_refused(tmp_path, pattern):
    study = 'schema = 1\nname = "s"\nplant = { kind = "cartpole" }\n[[policy]]\nname = "p"\nkind = "onnx"\n'
    (tmp_path / "s.toml").write_text(study + f'file = "{pattern}"\n')

    done = soon(tmp_path, "plan", "s.toml", megabytes=400)

    assert done.returncode == 2 and done.stderr.count("\n") == 1


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 75), (signal.SIGINT, 130)])
def test_a_signal_in_the_first_milliseconds_has_its_exit_code(runs, number, code):
    for milliseconds in range(4, 40, 2):
        process = runs.start(f"new{milliseconds}", threads=1)
        time.sleep(milliseconds / 1000)
        process.send_signal(number)
        assert process.wait(timeout=60) in (code, -number if milliseconds < 10 else code, 0)
        process.communicate()
