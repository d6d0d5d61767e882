"""Trials that run as processes of their own, by an executor that knows the command line alone."""

import re
import time

from process_executor import ProcessExecutor
from runs import Runs, ended, leftovers


def studied(folder, steps):
    """A study with trainings, searches, evaluations and margins."""
    runs = Runs(folder, steps)
    text = runs.study.read_text()
    runs.study.write_text(text.replace("levels   = { from = 0, to = 15, count = 8 }", 'levels   = "auto"'))
    return runs


def kill_at_checkpoint(store):
    """Kills the first process of a training as soon as it has left a checkpoint."""
    kept = []

    def begun(trial, process):
        if trial["kind"] != "train" or kept:
            return
        kept.append(trial["id"])
        checkpoint = store / "checkpoints" / trial["id"]
        deadline = time.monotonic() + 120
        while not checkpoint.exists():
            assert process.poll() is None and time.monotonic() < deadline
            time.sleep(0.002)
        process.kill()

    return begun


def test_processes_leave_what_threads_leave_though_one_is_killed(tmp_path):
    runs = studied(tmp_path, steps=1_000_000)
    runs.finish("threads")
    out = tmp_path / "processes"
    executor = ProcessExecutor(tmp_path, runs.study, out, begun=kill_at_checkpoint(out / "store"))

    executor.run()

    assert executor.failed == {} and len(executor.killed) == 1
    assert {trial["kind"] for trial in executor.plan()} == {"train", "search", "evaluate", "margin"}
    assert sorted(executor.ran) == sorted(trial["id"] for trial in executor.plan())
    before = sorted((path, path.stat().st_mtime_ns) for path in (out / "store").glob("*/*/*"))
    runs.finish("processes")
    assert sorted((path, path.stat().st_mtime_ns) for path in (out / "store").glob("*/*/*")) == before
    assert runs.results("processes") == runs.results("threads")
    assert leftovers(out) == []


def progress_lines(process):
    """The percents that a process tells while it runs, one every ten."""
    for line in process.stderr:
        if told := re.match(r"gust: (\d+) %", line):
            yield int(told[1])


def test_a_killed_trial_goes_on_from_its_checkpoint_and_a_stopped_one_exits_with_75(tmp_path):
    runs = studied(tmp_path, steps=3_000_000)  # some ten seconds; checkpoints every two
    out = tmp_path / "out"
    training = ProcessExecutor(tmp_path, runs.study, out).plan("--prepare")[0]

    process = runs.begin("trial", out, training["id"])
    next(percent for percent in progress_lines(process) if percent >= 50)
    process.kill()
    process.communicate(timeout=60)
    process = runs.begin("trial", out, training["id"])
    again = next(progress_lines(process))
    process.terminate()

    assert "the same command goes on from here" in ended(process, code=75)
    assert again >= 20  # from the start it would tell 10 % first


def test_two_processes_on_one_trial_leave_one(tmp_path):
    runs = studied(tmp_path, steps=100_000)
    runs.finish("threads")
    out = tmp_path / "twice"
    training = ProcessExecutor(tmp_path, runs.study, out).plan("--prepare")[0]

    both = [runs.begin("trial", out, training["id"]) for _ in range(2)]
    for process in both:
        ended(process)
    runs.finish("twice")

    assert runs.results("twice") == runs.results("threads")
    assert leftovers(out) == []


def test_a_training_that_fails_is_told_with_what_needs_it(tmp_path):
    runs = studied(tmp_path, steps=2000)
    text = runs.study.read_text().replace('profile = "scg-2022"', 'profile = "scg-2022", actor_rate = 1e300')
    runs.study.write_text(text)
    out = tmp_path / "out"
    executor = ProcessExecutor(tmp_path, runs.study, out)

    executor.run()

    kinds = {trial["id"]: trial for trial in executor.plan()}
    trainings = [said for id, said in executor.failed.items() if kinds[id]["kind"] == "train"]
    others = [said for id, said in executor.failed.items() if kinds[id]["kind"] != "train"]
    assert len(trainings) == 2 and all(" failed: " in said for said in trainings)
    assert others and all("was skipped: " in said for said in others), others
