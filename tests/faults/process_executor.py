"""An executor of one's own: asks `gust plan` what there is to do, and runs each trial as a process of `gust trial`."""

import json
import subprocess
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait

from conftest import PROGRAM

FAILED = 1


class ProcessExecutor:
    """Runs a study's trials in a result folder, so many processes at a time.

    `begun` is called with each trial and its process as soon as it runs: a test may kill it. A killed process is started
    again; the trial goes on where it was.
    """

    def __init__(self, folder, study, out, processes=2, begun=lambda trial, process: None):
        self.folder = folder
        self.study = study
        self.out = out
        self.processes = processes
        self.begun = begun
        self.ran = []  # ids of the processes, in the order of their ends
        self.killed = []  # ids of those that were killed
        self.failed = {}  # what failed or was skipped, and what it said

    def plan(self, *options):
        """The trials as `gust plan --json` tells them."""
        command = [PROGRAM, "plan", self.study, "--out", self.out, "--json", *options]
        return json.loads(subprocess.run(command, cwd=self.folder, check=True, capture_output=True).stdout)

    def run(self):
        """Until nothing is missing, but what failed. Levels that are found make more trials, so it asks again."""
        trials = self.plan("--prepare")
        while self._missing(trials):
            self._run_all(self._missing(trials))
            trials = self.plan()

    def _missing(self, trials):
        return {trial["id"]: trial for trial in trials if not trial["done"] and trial["id"] not in self.failed}

    def _run_all(self, missing):
        """Runs these, each after those of them that it needs."""
        running = {}
        with ThreadPoolExecutor(self.processes) as pool:
            while missing or running:
                busy = missing.keys() | running.values()
                for trial in [trial for trial in missing.values() if not busy & set(trial["needs"])]:
                    del missing[trial["id"]]
                    running[pool.submit(self._run, trial)] = trial["id"]
                for ended in wait(running, return_when=FIRST_COMPLETED).done:
                    ended.result()
                    self.ran.append(running.pop(ended))

    def _run(self, trial):
        while True:
            command = [PROGRAM, "trial", self.out, trial["id"]]
            process = subprocess.Popen(command, cwd=self.folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.begun(trial, process)
            complaint = process.communicate(timeout=300)[1]
            if process.returncode >= 0:
                break
            self.killed.append(trial["id"])
        assert process.returncode in (0, FAILED), complaint
        if process.returncode == FAILED:
            self.failed[trial["id"]] = complaint
