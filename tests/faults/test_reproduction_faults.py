"""A reproduction to which something happens ends, once it is started again, with the tables of one that was left alone.

GUST_KILLS says how often it is killed in all.
"""

import os
import random
import shutil
import subprocess
import time

import pytest
from conftest import PROGRAM
from runs import in_own_mounts

KILLS = int(os.environ.get("GUST_KILLS", 10))
SMALL = ["reproduce", "paper", "--profile", "quick", "--only", "table-dr", "--seeds", "2"]  # 32 trainings of 0.6 to 3 s


def start(folder, threads=2):
    return subprocess.Popen([PROGRAM, *SMALL, "--threads", str(threads), "--out", folder], stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)


def tables(folder):
    """Everything that was found, by file name; the page and the description tell the time."""
    files = [path for pattern in ("*.csv", "*/*.csv", "policies/*") for path in folder.glob(pattern)]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


@pytest.fixture(scope="module")
def untouched(tmp_path_factory):
    """A reproduction that nothing happened to."""
    folder = tmp_path_factory.mktemp("untouched") / "out"
    assert start(folder, threads=1).wait(timeout=600) == 0
    assert len(tables(folder)) == 6  # the claims, their scores, and the table under four readings
    return folder


def test_killed_reproduction_finds_the_same(tmp_path, untouched):
    rng = random.Random(2022)
    kills = 0
    folder = 0
    while kills < KILLS:
        out = tmp_path / f"killed-{folder}"
        for _ in range(KILLS):
            process = start(out)
            time.sleep(rng.choice([rng.uniform(0, 0.5), rng.uniform(0.5, 3)]))
            process.kill()
            if process.wait(timeout=60) == 0:
                break
            kills += 1
        assert start(out).wait(timeout=600) == 0
        assert tables(out) == tables(untouched), f"after {kills} kills"
        folder += 1


def test_full_disk_hides_no_answer_and_room_mends_it(tmp_path, untouched):
    size = sum(path.stat().st_size for path in untouched.rglob("*") if path.is_file()) // 1024
    script = f"""
      mkdir disk && mount -t tmpfs -o size={size // 2}k tmpfs disk
      code=0; "$1" {" ".join(SMALL)} --out disk/out >full.txt 2>&1 || code=$?
      echo "$code" >code.txt
      mount -o remount,size=64m disk
      "$1" {" ".join(SMALL)} --out disk/out
      cp -r disk/out out
    """

    done = in_own_mounts(script, tmp_path)

    assert done.returncode == 0, done.stderr
    assert (tmp_path / "code.txt").read_text() == "1\n"
    said = (tmp_path / "full.txt").read_text()
    assert "failed: " in said and "No space left on device" in said
    assert "C58  not testable" in said
    assert tables(tmp_path / "out") == tables(untouched)


def test_read_only_folder_is_an_error_before_any_work(tmp_path, untouched):
    shutil.copytree(untouched, tmp_path / "done")
    script = f"""
      mkdir disk && mount -t tmpfs tmpfs disk && cp -r done disk/out && mount -o remount,ro disk
      for out in disk/out disk/new; do
        code=0; "$1" {" ".join(SMALL)} --out "$out" 2>>said.txt || code=$?
        echo "$code" >>codes.txt
      done
      code=0; "$1" report disk/out 2>>said.txt || code=$?
      echo "$code" >>codes.txt
    """

    done = in_own_mounts(script, tmp_path)

    assert done.returncode == 0, done.stderr
    assert (tmp_path / "codes.txt").read_text() == "2\n2\n2\n"
    said = (tmp_path / "said.txt").read_text()
    assert said.count("Read-only file system") == 3 and said.count("\n") == 3
