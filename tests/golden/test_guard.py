"""What must not change unless somebody means it to: every trial's name, every byte of an export, what the pages show.

Run as a program it writes guard.json anew; the commit that does so says why."""

import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
RECORD = pathlib.Path(__file__).with_name("guard.json")
PROGRAM = os.environ.get("GUST", str(ROOT / "build/release/gust"))
STUDIES = ["demo", "demo-quadrotor", "all", "all-quadrotor"]


def gust(folder, *arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], cwd=folder, capture_output=True, timeout=900)
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout


def hashed(data):
    return hashlib.sha256(data if isinstance(data, bytes) else data.encode()).hexdigest()


def names(plan):
    return hashed("\n".join(trial["id"] for trial in json.loads(plan)))


def page_data(page):
    return hashed("\n".join(re.findall(r'<script type="application/json".*?</script>', page.read_text(), re.S)))


def study(name, folder):
    """What a study leaves. It is copied beside its results, as the page names it."""
    (folder / "study.toml").write_text((ROOT / f"studies/{name}.toml").read_text())
    gust(folder, "run", "study.toml", "--out", "out")
    gust(folder, "export", "out", "--csv", "rows.csv")
    return {
        "trials": names(gust(folder, "plan", "study.toml", "--out", "out", "--json")),
        "export": hashed((folder / "rows.csv").read_bytes()),
        "page": page_data(folder / "out/report.html"),
    }


def paper(folder):
    """The names of all trials under every reading, and the page made again from the kept tables."""
    trials = json.loads(gust(folder, "plan", "paper", "--json"))
    readings = {trial["what"].rsplit(", ", 1)[1] for trial in trials}
    gust(folder, "report", ROOT / "results/paper", "--out", "page")
    return {
        "trials": {
            reading: hashed("\n".join(trial["id"] for trial in trials if trial["what"].endswith(f", {reading}")))
            for reading in sorted(readings)
        },
        "page": page_data(folder / "page/report.html"),
        "text": hashed((folder / "page/reproduce.md").read_bytes()),
    }


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_has_the_trials_the_bytes_and_the_page_that_it_had(tmp_path, name):
    assert study(name, tmp_path) == json.loads(RECORD.read_text())[name]


def test_the_paper_has_the_trials_under_every_reading_and_the_page_that_it_had(tmp_path):
    assert paper(tmp_path) == json.loads(RECORD.read_text())["paper"]


def record():
    kept = {}
    for name in STUDIES:
        with tempfile.TemporaryDirectory() as folder:
            kept[name] = study(name, pathlib.Path(folder))
    with tempfile.TemporaryDirectory() as folder:
        kept["paper"] = paper(pathlib.Path(folder))
    RECORD.write_text(json.dumps(kept, indent=1) + "\n")


if __name__ == "__main__":
    sys.exit(record())
