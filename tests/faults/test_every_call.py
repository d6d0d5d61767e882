"""Each system call of a small study fails, is cut short, or is the last one: the study ends right, or says why and goes on.

Not a sample: every call, one after the other. What was tried is told at the end (pytest -s)."""

import errno
import os
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor

import pytest
from conftest import PROGRAM

STUDY = """
schema = 1
name   = "calls"
seed   = 7
plant  = { kind = "cartpole", preset = "scg-2022" }

[evaluate]
episodes = 1
start    = ["nominal"]
metrics  = ["anr"]

[[policy]]
name = "lqr"
kind = "lqr"

[[policy]]
name  = "ppo"
kind  = "train"
agent = { kind = "ppo", steps = 400, profile = "scg-2022" }
seeds = [1]

[[sweep]]
name     = "white"
site     = "action"
waveform = { kind = "white" }
levels   = [0, 5]
"""

FAULTS = {
    "open": [errno.EIO, errno.EMFILE, errno.ENOSPC],
    "read": [errno.EIO, "short"],
    "write": [errno.ENOSPC, errno.EIO, "short"],
    "fsync": [errno.EIO],
    "rename": [errno.EIO],
    "mkdir": [errno.ENOSPC],
    "unlink": [errno.EIO],
    "flock": [errno.EIO],
    "mmap": [errno.ENOMEM],
    "thread": [errno.EAGAIN],
}
ENDS = ["kill", "cut", "torn"]
EVERY_NEW = int(os.environ.get("NTH_CALL_EVERY", 250))  # the first allocations one by one, then with growing strides


@pytest.fixture(scope="session")
def shim(tmp_path_factory):
    library = tmp_path_factory.mktemp("shim") / "nth_call.so"
    source = os.path.join(os.path.dirname(__file__), "nth_call.c")
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", library, source, "-ldl"], check=True)
    return library


def run(folder, environment=None):
    command = [PROGRAM, "run", "study.toml", "--out", "out", "--threads", "1"]
    return subprocess.run(command, cwd=folder, env={**os.environ, **(environment or {})}, capture_output=True, timeout=120)


def results(folder):
    """Every file of the trials, and the study as it is kept."""
    kept = [path for path in (folder / "out").rglob("*") if path.is_file()]
    names = {path: str(path.relative_to(folder)) for path in kept}
    away = ("report.html", "timings.json")
    return {names[path]: path.read_bytes() for path in kept if path.name not in away and "/damaged/" not in names[path]}


def without_leftovers(files):
    """The next run removes them."""
    return {name: data for name, data in files.items() if "/aside/" not in name and not name.endswith(".aside")}


def fresh(folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    (folder / "study.toml").write_text(STUDY)
    return folder


@pytest.fixture(scope="module")
def calm(tmp_path_factory, shim):
    """What an undisturbed run leaves, and how many calls of each name it makes."""
    folder = fresh(tmp_path_factory.mktemp("calm") / "run")
    log = folder.parent / "counts.txt"
    done = run(folder, {"LD_PRELOAD": str(shim), "NTH_CALL": "count", "NTH_CALL_LOG": str(log)})
    assert done.returncode == 0, done.stderr
    counts = {name: int(count) for name, count in (line.split() for line in log.read_text().splitlines())}
    return results(folder), counts


def tried(folder, shim, expected, order):
    """What is wrong with a run under this order and the run after it; nothing if all is well."""
    fresh(folder)
    done = run(folder, {"LD_PRELOAD": str(shim), "NTH_CALL": order})
    said = done.stderr.decode(errors="replace")
    killed = order.split()[-1] in ENDS
    if done.returncode == 0 and without_leftovers(results(folder)) != expected:
        return f"{order}: exit 0 with other results\n{said}"
    if not killed and done.returncode not in (0, 1, 2):
        return f"{order}: exit {done.returncode}\n{said}"
    if not killed and done.returncode != 0 and (not said.startswith("gust: ") or "internal error" in said):
        return f"{order}: no sentence: {said!r}"
    again = run(folder)
    if again.returncode != 0:
        return f"{order}: exit {done.returncode}, then {again.returncode}\n{said}{again.stderr.decode()}"
    if results(folder) != expected:
        differ = {name for name, _ in set(results(folder).items()) ^ set(expected.items())}
        return f"{order}: other results after the second run: {sorted(differ)}\n{said}{again.stderr.decode()}"
    return ""


def try_all(folder, shim, expected, orders):
    def one(numbered):
        return tried(folder / str(numbered[0] % 1000), shim, expected, numbered[1])

    with ThreadPoolExecutor(2) as crew:
        wrong = [text for text in crew.map(one, enumerate(orders)) if text]
    print(f"\n{len(orders)} tried, {len(orders) - len(wrong)} clean")
    assert wrong == [], f"{len(wrong)} of {len(orders)}:\n" + "\n".join(wrong[:20])


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_at_every_call_ends_right_or_with_a_sentence_and_the_next_run_heals_it(tmp_path, shim, calm, name):
    expected, counts = calm
    assert counts[name] > 0
    orders = [f"{name} {n} {fault}" for n in range(1, counts[name] + 1) for fault in FAULTS[name]]

    try_all(tmp_path, shim, expected, orders)


@pytest.mark.parametrize("end", ENDS)
def test_an_end_at_every_call_loses_nothing_that_the_next_run_does_not_make_again(tmp_path, shim, calm, end):
    expected, counts = calm

    try_all(tmp_path, shim, expected, [f"any {n} {end}" for n in range(1, counts["any"] + 1)])


def test_memory_that_runs_out_ends_right_or_with_a_sentence(tmp_path, shim, calm):
    expected, counts = calm
    places, at = [], 1
    while at <= counts["new"]:
        places.append(at)
        at += 1 + at // EVERY_NEW

    try_all(tmp_path, shim, expected, [f"new {n} 12" for n in places])
