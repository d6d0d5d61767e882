"""Signals, two runs at once, damage, other versions, full and read-only disks."""

import os
import shutil
import signal
import subprocess
import time

import pytest
from runs import Runs, ended, in_own_mounts, leftovers, trials

STEPS = 100_000


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A run that nothing happened to, and its results."""
    runs = Runs(tmp_path_factory.mktemp("finished"), STEPS)
    runs.finish("out")
    return runs.folder / "out", runs.results("out")


@pytest.fixture
def runs(tmp_path):
    return Runs(tmp_path, STEPS)


def wait_for(process, folder, pattern, count=1):
    """Until so many of a run's files are there."""
    deadline = time.monotonic() + 120
    while len(list(folder.glob(pattern))) < count:
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.002)


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 75)])
def test_a_signal_stops_a_run_soon_and_the_same_command_goes_on(runs, finished, number, code):
    long = Runs(runs.folder, steps=100_000_000)
    process = long.start("out")
    wait_for(process, runs.folder / "out/store/checkpoints", "*", count=2)

    process.send_signal(number)
    sent = time.monotonic()
    said = ended(process, code)

    assert time.monotonic() - sent < 10
    assert "gust: stopping" in said
    assert "the same command goes on from here" in said
    checkpoints = list((runs.folder / "out/store/checkpoints").iterdir())
    assert len(checkpoints) == 2
    Runs(runs.folder, STEPS).finish("short")
    assert runs.results("short") == finished[1]


def test_a_stopped_run_resumes_to_the_same_bytes(runs, finished):
    process = runs.start("out", threads=1)
    wait_for(process, runs.folder / "out/store/aside", f"{process.pid}-*.lock")
    time.sleep(0.1)  # into the first training, or before it: every moment will do
    process.send_signal(signal.SIGTERM)
    ended(process, 75)

    runs.finish("out")

    assert runs.results("out") == finished[1]
    assert leftovers(runs.folder / "out") == []


def test_two_runs_on_one_store_both_finish_with_equal_results(runs, finished):
    first = runs.start("out")
    second = runs.start("out")

    ended(first)
    ended(second)

    assert runs.results("out") == finished[1]
    assert leftovers(runs.folder / "out") == []


@pytest.mark.parametrize("name", ["rows.bin", "traces.json", "manifest.json", "policy.onnx"])
def test_a_damaged_file_is_found_told_and_computed_again(runs, finished, name):
    out = runs.folder / "out"
    shutil.copytree(finished[0], out)
    path = sorted((out / "store").rglob(name))[0]
    damaged = bytearray(path.read_bytes())
    damaged[len(damaged) // 2] ^= 0x10
    path.write_bytes(damaged)

    if name == "rows.bin":  # a command that only reads tells it and leaves it where it is
        assert f"damaged: {path}: its hash differs" in runs.gust("export", out, "--csv", "x.csv", code=1)
        rest = (runs.folder / "x.csv").read_bytes().splitlines()
        assert path.exists() and set(rest) < set(finished[1][0].splitlines())
    said = runs.finish("out")

    assert "damaged: " in said and name in said and "computed again" in said
    assert runs.results("out") == finished[1]
    kept = [file for file in (out / "store/damaged").rglob(name)]
    assert [file.read_bytes() for file in kept] == [bytes(damaged)]


def test_a_missing_file_is_computed_again(runs, finished):
    out = runs.folder / "out"
    shutil.copytree(finished[0], out)
    sorted((out / "store").rglob("rows.bin"))[0].unlink()

    said = runs.finish("out")

    assert "rows.bin" in said
    assert runs.results("out") == finished[1]


def test_a_store_of_another_version_is_refused_before_any_work(runs, finished):
    out = runs.folder / "out"
    shutil.copytree(finished[0], out)
    (out / "store/store.json").write_text('{"format":7,"gust":"9.1.0"}\n')
    before = trials(out)

    for command in (["run", runs.study, "--out", out], ["show", out], ["export", out, "--csv", "x.csv"]):
        said = runs.gust(*command, code=2)
        assert "a store of format 7, made by gust 9.1.0; gust " in said
        assert said.count("\n") == 1

    assert trials(out) == before
    assert not (runs.folder / "x.csv").exists()


def test_a_pack_carries_a_run_to_another_folder(runs, finished):
    runs.gust("store", "pack", finished[0], "run.pack")
    runs.gust("store", "unpack", "run.pack", "moved")

    runs.finish("moved")

    assert runs.results("moved") == finished[1]
    runs.gust("store", "pack", "moved", "again.pack")
    assert (runs.folder / "again.pack").read_bytes() == (runs.folder / "run.pack").read_bytes()


@pytest.mark.parametrize("keep", [0, 11, 1000, -1])
def test_a_damaged_pack_is_one_error_and_leaves_nothing(runs, finished, keep):
    runs.gust("store", "pack", finished[0], "run.pack")
    pack = (runs.folder / "run.pack").read_bytes()
    (runs.folder / "cut.pack").write_bytes(pack[:keep])

    said = runs.gust("store", "unpack", "cut.pack", "moved", code=2)

    assert said.startswith("gust: cut.pack: ") and said.count("\n") == 1
    assert not (runs.folder / "moved").exists()


@pytest.mark.parametrize("out", ["/proc/gust", "study.toml/out", "/dev/null"])
def test_an_output_that_cannot_be_written_is_an_error_before_any_work(runs, out):
    said = runs.finish(out, code=2)

    assert said.startswith(f"gust: {runs.folder / out}") and said.count("\n") == 1


def test_a_full_disk_fails_trials_with_the_reason_and_room_mends_it(runs, finished):
    script = """
      mkdir disk && mount -t tmpfs -o size=KILOBYTESk tmpfs disk
      code=0; "$1" run study.toml --out disk/out 2>full.txt || code=$?
      echo "$code" >code.txt
      mount -o remount,size=64m disk
      "$1" run study.toml --out disk/out
      cp -r disk/out out
    """
    size = sum(len(content) for content in trials(finished[0]).values()) // 1024

    done = in_own_mounts(script.replace("KILOBYTES", str(size // 2)), runs.folder)

    assert done.returncode == 0, done.stderr
    assert (runs.folder / "code.txt").read_text() == "1\n"
    said = (runs.folder / "full.txt").read_text()
    assert "failed: " in said and "No space left on device" in said
    assert runs.results("out") == finished[1]
    assert leftovers(runs.folder / "out") == []


def test_a_read_only_disk_is_an_error_before_any_work_but_can_be_read(runs, finished):
    shutil.copytree(finished[0], runs.folder / "done")
    script = """
      mkdir disk && mount -t tmpfs tmpfs disk && cp -r done disk/out && mount -o remount,ro disk
      for out in disk/out disk/new; do
        code=0; "$1" run study.toml --out "$out" 2>>said.txt || code=$?
        echo "$code" >>codes.txt
      done
      "$1" export disk/out --csv table.csv
    """

    done = in_own_mounts(script, runs.folder)

    assert done.returncode == 0, done.stderr
    assert (runs.folder / "codes.txt").read_text() == "2\n2\n"
    said = (runs.folder / "said.txt").read_text()
    assert said.count("Read-only file system") == 2 and said.count("\n") == 2
    assert (runs.folder / "table.csv").read_bytes() == finished[1][0]
