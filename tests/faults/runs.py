"""A small study, and runs of it that can be interrupted."""

import os
import subprocess

import pytest
from conftest import PROGRAM

STUDY = """
schema = 1
name   = "faults"
seed   = 7
plant  = { kind = "cartpole", preset = "scg-2022" }

[evaluate]
episodes = 10
start    = ["nominal", "random"]
metrics  = ["anr"]

[[policy]]
name = "lqr"
kind = "lqr"

[[policy]]
name  = "ppo"
kind  = "train"
agent = { kind = "ppo", steps = STEPS, profile = "scg-2022" }
seeds = [1, 2]

[[sweep]]
name     = "action white"
site     = "action"
waveform = { kind = "white" }
levels   = { from = 0, to = 15, count = 8 }

[[sweep]]
name = "length and mass"
grid = { pole_length = { from = 0.1, to = 3, count = 8 }, pole_mass = { from = 0.01, to = 2, count = 8 } }
"""


class Runs:
    """One study in one folder, and as many result folders as one wants."""

    def __init__(self, folder, steps):
        self.folder = folder
        self.study = folder / "study.toml"
        self.study.write_text(STUDY.replace("STEPS", str(steps)))

    def start(self, out, threads=2):
        """Begins `gust run` and does not wait for it."""
        command = [PROGRAM, "run", self.study, "--out", self.folder / out, "--threads", str(threads)]
        return started(command, self.folder)

    def finish(self, out, threads=2, code=0):
        """Runs to the end; returns what it said on stderr."""
        return ended(self.start(out, threads), code)

    def begin(self, *arguments):
        """Begins another command and does not wait for it."""
        return started([PROGRAM, *map(str, arguments)], self.folder)

    def gust(self, *arguments, code=0):
        """Runs another command; returns what it said on stderr."""
        return ended(self.begin(*arguments), code)

    def results(self, out):
        """Everything that must not depend on what happened on the way: the exported table and the stored trials."""
        self.gust("export", self.folder / out, "--csv", self.folder / "export.csv")
        return (self.folder / "export.csv").read_bytes(), trials(self.folder / out)


def started(command, folder):
    """Begins a command and does not wait for it."""
    return subprocess.Popen(command, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def ended(process, code=0, seconds=300):
    """Waits for a process, checks its exit code, and returns what it said on stderr."""
    said, complained = process.communicate(timeout=seconds)
    assert process.returncode == code, f"exited {process.returncode}\n{said}\n{complained}"
    return complained


def trials(out):
    """Every file of every finished trial."""
    files = {}
    for kind in ("train", "search", "evaluate", "margin"):
        for path in sorted((out / "store" / kind).rglob("*")):
            if path.is_file():
                files[str(path.relative_to(out))] = path.read_bytes()
    return files


def leftovers(out):
    """What an interrupted run may leave in the store and a finished one may not."""
    store = out / "store"
    return [path for folder in ("aside", "checkpoints", "damaged") for path in (store / folder).rglob("*")]


def in_own_mounts(script, folder):
    """Runs a shell script that may mount file systems which nobody else sees; skips where that is not allowed."""
    unshare = ["unshare", "--mount"] if os.geteuid() == 0 else ["unshare", "--map-root-user", "--mount"]
    if os.geteuid() != 0 and subprocess.run([*unshare, "true"], capture_output=True).returncode != 0:
        pytest.skip("mounting needs root or user namespaces")
    command = [*unshare, "sh", "-euc", script, "sh", PROGRAM]
    return subprocess.run(command, cwd=folder, text=True, capture_output=True, timeout=300)
