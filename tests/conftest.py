"""What the Python tests share: the program under test and where its build lies."""

import os
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(os.environ.get("GUST_BUILD", ROOT / "build/release"))
PROGRAM = pathlib.Path(os.environ.get("GUST", BUILD / "gust"))


@pytest.fixture(scope="session")
def build():
    """The build tree of the program under test."""
    return BUILD


@pytest.fixture(scope="session")
def program():
    """The program under test."""
    return PROGRAM


@pytest.fixture
def gust(tmp_path):
    """Runs the program in an empty folder: gust("run", "x.toml", code=2) returns the finished process.

    The exit code must be `code`; None accepts any.
    """

    def run(*arguments, code=0, seconds=300, **options):
        options.setdefault("cwd", tmp_path)
        command = [PROGRAM, *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=seconds, **options)
        if code is not None:
            assert done.returncode == code, f"{command} exited {done.returncode}\n{done.stdout}\n{done.stderr}"
        return done

    return run
