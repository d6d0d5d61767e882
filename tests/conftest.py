"""What the Python tests share: the program under test and where its build lies."""

import fcntl
import os
import pathlib
import pty
import struct
import subprocess
import termios

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(os.environ.get("GUST_BUILD", ROOT / "build/release"))
PROGRAM = pathlib.Path(os.environ.get("GUST", BUILD / "gust"))


@pytest.fixture(scope="session", autouse=True)
def environment():
    """What whoever runs the tests has set for gust (GUST_THREADS, GUST_CACHE) reaches no program that a test starts.

    What a test file wants of it, it has read when it was imported.
    """
    for name in [name for name in os.environ if name.startswith("GUST_")]:
        del os.environ[name]


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


def in_terminal(command, folder, columns):
    """What a command prints on a terminal of so many columns."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
    with subprocess.Popen(command, cwd=folder, stdout=theirs) as running:
        os.close(theirs)
        shown = b""
        while piece := read_some(ours):  # a terminal holds a few thousand bytes, then its writer waits
            shown += piece
        os.close(ours)
    assert running.returncode == 0
    return shown.decode().replace("\r\n", "\n")


def read_some(terminal):
    """The next bytes; none at the end, which a terminal tells as an error."""
    try:
        return os.read(terminal, 65536)
    except OSError:
        return b""
