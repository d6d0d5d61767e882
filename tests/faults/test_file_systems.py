"""File systems that lack a call: what they cannot do and nobody needs is no error, what is needed is told."""

import errno
import os
import subprocess

import pytest

STUDY = """
schema = 1
name   = "small"
plant  = { kind = "cartpole", steps = 10 }

[evaluate]
episodes = 2

[[policy]]
name = "zero"
kind = "zero"
"""

NO_SUCH_CALL = [errno.EINVAL, errno.EOPNOTSUPP, errno.ENOSYS]
NO_LOCKS = [*NO_SUCH_CALL, errno.ENOLCK]


@pytest.fixture(scope="module")
def shim(tmp_path_factory):
    """A library that stands between the program and the file system."""
    library = tmp_path_factory.mktemp("shim") / "file_system.so"
    source = os.path.join(os.path.dirname(__file__), "file_system.c")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, source, "-ldl"], check=True)
    return library


@pytest.fixture
def run(gust, shim, tmp_path):
    """Runs the study on a file system that answers so."""
    (tmp_path / "small.toml").write_text(STUDY)

    def on(answers, *command, code=0):
        env = {**os.environ, "LD_PRELOAD": str(shim), "FILE_SYSTEM": answers}
        return gust(*(command or ("run", "small.toml", "--out", "out")), code=code, env=env)

    return on


@pytest.mark.parametrize("answer", NO_SUCH_CALL)
@pytest.mark.parametrize("call", ["fsync_folder", "fsync"])
def test_a_sync_that_the_file_system_does_not_know_is_no_error(run, tmp_path, call, answer):
    done = run(f"{call}={answer}")
    assert (tmp_path / "out" / "report.html").stat().st_size > 0 and "cannot write" not in done.stderr


@pytest.mark.parametrize("call", ["fsync_folder", "fsync"])
def test_a_sync_that_fails_is_an_error(run, call):
    assert "cannot write: Input/output error" in run(f"{call}={errno.EIO}", code=2).stderr


@pytest.mark.parametrize("answer", NO_LOCKS)
def test_a_file_system_without_locks_is_told_with_the_way_out(run, answer):
    for command in [(), ("train", "ppo", "--plant", "cartpole", "--steps", "400", "--out", "a.onnx")]:
        said = run(f"flock={answer}", *command, code=2).stderr
        assert "cannot lock: its file system has no locks" in said and "choose a folder on another one" in said


def test_the_shim_alone_changes_nothing(run, tmp_path):
    run("none")
    assert (tmp_path / "out" / "report.html").stat().st_size > 0
