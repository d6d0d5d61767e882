"""A reproduction that is killed at random moments and started again ends with the tables of one that was left alone.

GUST_KILLS says how often it is killed in all.
"""

import os
import random
import subprocess
import time

from conftest import PROGRAM

KILLS = int(os.environ.get("GUST_KILLS", 10))
SMALL = ["reproduce", "paper", "--profile", "quick", "--only", "table-dr", "--seeds", "3"]  # 24 trainings of 0.6 s


def start(folder, threads=2):
    return subprocess.Popen([PROGRAM, *SMALL, "--threads", str(threads), "--out", folder], stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)


def tables(folder):
    """Everything that was found, by file name; the page and the description tell the time."""
    files = [path for pattern in ("*.csv", "*/*.csv", "policies/*") for path in folder.glob(pattern)]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def test_killed_reproduction_finds_the_same(tmp_path):
    assert start(tmp_path / "untouched", threads=1).wait(timeout=600) == 0
    untouched = tables(tmp_path / "untouched")
    assert len(untouched) == 3  # the claims, and the table under two readings
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
        assert tables(out) == untouched, f"after {kills} kills"
        folder += 1
