"""A run that is killed at any moment and started again ends with the same bytes as one that was left alone."""

import random
import time

from runs import Runs, ended, leftovers

KILLS = 30
KILLS_A_FOLDER = 10
TRAININGS = 2


def training(out):
    """Whether a policy is still being trained."""
    return len(list((out / "store/train").glob("*/manifest.json"))) < TRAININGS


def begun(process, out):
    """Waits until a run has opened its store; false if it ended instead."""
    while not list((out / "store/aside").glob(f"{process.pid}-*.lock")):
        if process.poll() is not None:
            return False
        time.sleep(0.002)
    return True


def moments(rng, out):
    """Seconds after the opening of the store at which to kill, or None for one soon after the start of the process.

    Checkpoints are written every two seconds: a short wait falls before the first of them, a long one after it.
    """
    yield None
    long = True
    while True:
        if training(out):
            yield rng.uniform(2.1, 3.2) if long else rng.uniform(0, 2)
        else:
            yield rng.uniform(0, 0.3)
        long = not long


def kill_sometime(runs, out, moment, rng):
    """Starts a run and kills it. Returns "done" if it was faster, else where it was: "training" or "elsewhere"."""
    process = runs.start(out.name)
    if moment is None:
        time.sleep(rng.uniform(0, 0.1))
        opened = False
    else:
        opened = begun(process, out)
        time.sleep(moment)
    process.kill()
    process.communicate(timeout=60)
    if process.returncode == 0:
        return "done"
    assert process.returncode == -9
    return "training" if opened and training(out) else "elsewhere"


def test_thirty_kills_change_nothing(tmp_path):
    runs = Runs(tmp_path, steps=1_000_000)
    runs.finish("untouched", threads=1)
    untouched = runs.results("untouched")
    rng = random.Random(20231)
    places = []

    while len(places) < KILLS:
        out = tmp_path / f"killed-{len(places)}"
        here = []
        for moment in moments(rng, out):
            place = kill_sometime(runs, out, moment, rng)
            if place != "done":
                here.append(place)
            if place == "done" or len(here) == KILLS_A_FOLDER:
                break
        places += here
        ended(runs.start(out.name))
        assert runs.results(out.name) == untouched, f"after kills in {here}"
        assert leftovers(out) == []

    assert places.count("training") >= KILLS / 2, places


def test_a_killed_training_goes_on_from_its_checkpoint(tmp_path):
    runs = Runs(tmp_path, steps=1_000_000)
    out = tmp_path / "killed"
    process = runs.start("killed")
    deadline = time.monotonic() + 120
    while len(list((out / "store/checkpoints").glob("*"))) < TRAININGS:
        assert time.monotonic() < deadline and process.poll() is None
        time.sleep(0.01)
    process.kill()
    process.communicate(timeout=60)
    kept = {path.name: path.read_bytes() for path in (out / "store/checkpoints").iterdir()}

    process = runs.start("killed")
    assert begun(process, out)
    time.sleep(0.3)
    process.kill()
    process.communicate(timeout=60)

    # 0.3 seconds are too short for another checkpoint, so the old ones must have been read, not removed.
    assert {path.name: path.read_bytes() for path in (out / "store/checkpoints").iterdir()} == kept
