"""A metric's own file says all there is to say of it: what is told of every metric comes from there, and no name is known elsewhere."""

import csv
import json
import re
import subprocess

import pytest
from conftest import PROGRAM, ROOT

HEAD = """
schema = 1
name   = "metrics"
seed   = 3
plant  = { kind = "quadrotor" }

[evaluate]
episodes = 3
start    = ["random"]
metrics  = [METRICS]

[[policy]]
name = "lqr"
kind = "lqr"

[[sweep]]
name     = "step"
site     = "action"
waveform = "step"
levels   = [0, 0.01, 0.02]
"""


def described(kind):
    return json.loads(subprocess.run([PROGRAM, "describe", "metric", kind, "--json"], capture_output=True).stdout)


METRICS = [item["name"] for item in json.loads(subprocess.run([PROGRAM, "list", "metrics", "--json"], capture_output=True).stdout)]


def page_data(page):
    return json.loads(re.search(r'<script type="application/json" id="gust-data">(.*?)</script>', page.read_text(), re.S)[1])


def finish(folder, leading, claims=""):
    text = HEAD.replace("METRICS", ", ".join(f'"{name}"' for name in leading)) + claims
    (folder / "study.toml").write_text(text)
    done = subprocess.run([PROGRAM, "run", "study.toml", "--out", "out"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(subprocess.run([PROGRAM, "show", "out", "--json"], cwd=folder, capture_output=True).stdout)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("metrics")
    claims = "".join(
        f"""
[[claim]]
id     = "{name}"
text   = "{name} has a value"
metric = "{name}"
holds  = "score('lqr') > -1"
"""
        for name in METRICS
    )
    return folder, finish(folder, METRICS, claims)


@pytest.mark.parametrize("name", METRICS)
def test_every_metric_is_on_the_page_with_the_unit_of_its_file_and_can_be_asked_for_in_claims(finished, name):
    folder, shown = finished
    notes = described(name)["notes"]

    on_page = next(metric for metric in page_data(folder / "out/report.html")["metrics"] if metric["name"] == name)
    claim = next(claim for claim in shown["claims"] if claim["id"] == name)

    assert on_page["title"].endswith(f" [{notes['unit']}]") if "unit" in notes else "[" not in on_page["title"]
    assert claim["verdict"] != "not testable" and claim["estimate"] >= 0


def test_every_metric_of_an_episode_is_a_row_of_the_export(finished):
    folder, _ = finished
    subprocess.run([PROGRAM, "export", "out", "--csv", "rows.csv"], cwd=folder, check=True, capture_output=True)
    with open(folder / "rows.csv", encoding="utf-8") as file:
        exported = {row["metric"] for row in csv.DictReader(file)}
    quotients = {name for name in METRICS if name not in exported}

    assert exported <= set(METRICS)
    assert quotients == {"anr_pooled"}


@pytest.mark.parametrize("name", METRICS)
def test_a_margin_falls_from_the_metric_that_leads_where_higher_is_better(tmp_path, name):
    higher = described(name)["notes"]["better"] == "higher"
    finish(tmp_path, [name])

    data = page_data(tmp_path / "out/report.html")
    margin = data["metrics"][data["marginMetric"]]["name"]

    assert margin == (name if higher and name != "survival" else "anr_h")


def test_no_name_of_a_metric_is_known_outside_its_file():
    """But in the module of the paper, whose claims name them, and in columns of learning curves, which are agents' own.

    The page has a part and keys named survival and saturation, for the metrics of these roles."""
    quoted = re.compile("|".join(f'"{name}"' for name in METRICS))
    away = ("gust/eval/metrics/", "gust/paper/", "gust/agents/agent.h", "gust/onnx/")
    found = []
    for path in sorted((ROOT / "gust").rglob("*.cpp")) + sorted((ROOT / "gust").rglob("*.h")):
        name = str(path.relative_to(ROOT))
        if name.startswith(away) or name.endswith(("_test.cpp", "_fixture.h", "_test.h")):
            continue
        text = path.read_text()
        if name.startswith("gust/report/"):
            text = text.replace('"survival"', "").replace('"saturation"', "")
        found += [f"{name}:{n}: {line.strip()}" for n, line in enumerate(text.splitlines(), 1) if quoted.search(line)]
    assert found == []
