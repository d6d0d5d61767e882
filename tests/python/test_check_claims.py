"""scripts/check-claims recomputes claims from kept scores: on invented scores as closed forms say, on those of results/paper as
gust did."""

import ast
import csv
import importlib.machinery
import importlib.util
import json
import math
import subprocess
import sys

import numpy as np
import pytest
from conftest import ROOT

SCRIPT = ROOT / "scripts/check-claims"
RESULTS = ROOT / "results/paper"


def script():
    """scripts/check-claims as a module."""
    loader = importlib.machinery.SourceFileLoader("check_claims", str(SCRIPT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


CHECK = script()


def evaluated(formula, **names):
    """The estimate of a formula; of a bound its two ends."""
    ends = np.broadcast_to(CHECK.value(ast.parse(formula, mode="eval").body, names), (2, 1 + CHECK.RESAMPLES))[:, 0]
    return ends[0] if ends[0] == ends[1] else tuple(ends)


def along(axis, values):
    cells = CHECK.resampled(np.array(values, float)[:, None], "any", np.mean)
    return CHECK.Curve(cells, axis)


@pytest.mark.parametrize(("formula", "value"), [
    ("1 + 2 * 3 - 4 / 8", 6.5),
    ("mean([1, 2, 6])", 3), ("median(1, 2, 6)", 2), ("min(l for l in [3, 2, 5] if l > 2)", 3), ("sum([1, 2])", 3),
    ("max([x * y for x in [1, 2] for y in [3, 4]])", 8), ("abs(1 - 3)", 2), ("first([4, 5])", 4), ("last([4, 5])", 5),
    ("at(c, 1)", 0.5), ("at(c, 2.5)", 0.25), ("area(c)", (1 * 0.75 + 3 * 0.25) / 4), ("drop(c)", 0.5), ("rise(c)", 0), ("rise([abs(y - 3) for y in [1, 3, 4]])", 0.5),
    ("half(c)", 4), ("reach(c, 0.9)", 0), ("argmax(c)", 0), ("max(levels(c))", 4),
    ("straightness(c)", 12 / 13),  # R^2 of (0, 1), (1, 0.5), (4, 0): Sxy^2 / (Sxx Syy) = 2^2 / (26/3 * 1/2)
    ("spearman(c)", -1), ("spearman([1, 2, 3, 4], [1, 3, 2, 4])", 0.8), ("kendall([1, 2, 3], [1, 3, 2])", 1 / 3),
    ("kendall([1, 1, 2], [1, 2, 3])", 2 / math.sqrt(6)),  # tau-b: one pair is tied in the first list
    ("count(x > 1 for x in [1, 2, 3])", 2), ("share(x >= 2 or x < 1 for x in [0, 1, 2, 3])", 0.75),
    ("3 > 1", 2), ("3 >= 5", -2), ("1 < 1", -CHECK.LEAST), ("1 <= 1", 0), ("not 1 < 1", CHECK.LEAST), ("not 1 <= 1", -CHECK.LEAST),
    ("1 < 3 and 5 > 4", 1), ("1 < 3 or 5 > 4", 2), ("all(x < 3 for x in [1, 2])", 1), ("any(x < 3 for x in [1, 2])", 2),
    ("alike(1, 1, 0)", math.inf), ("alike(1, 3, 1)", -1),
    ("at(named['{a} {x}'], 1)", 0.5),
])
def test_the_functions_of_claims_give_what_their_definitions_say(formula, value):
    curve = along([0, 1, 4], [1, 0.5, 0])
    assert evaluated(formula, c=curve, a="ppo", x=2, named={"ppo 2": curve}) == pytest.approx(value, rel=1e-12, abs=0)


def test_a_place_beyond_the_levels_is_a_bound_in_every_relation():
    curve = along([0, 1, 4], [1, 0.9, 0.8])
    low, high = evaluated("half(c)", c=curve)
    assert low == np.nextafter(4, 5) and high == math.inf
    assert evaluated("half(c) > 3", c=curve) == (low - 3, math.inf)
    assert evaluated("half(c) < 3", c=curve) == (-math.inf, 3 - low)
    assert evaluated("half(c) > half(c)", c=curve) == (-math.inf, math.inf)
    assert evaluated("min(half(c), 4)", c=curve) == 4


def test_units_are_resampled_with_replacement_and_those_of_one_word_together():
    tenths = np.array([[1.0] * 5 + [0.0] * 5])
    [share], [same], [other] = (CHECK.resampled(tenths, word, np.mean) for word in ("a", "a", "b"))

    # Of a binomial number of 10 at 0.5 the 2.5 and 97.5 % quantiles are 2 and 8: P(<= 1) = 0.011, P(<= 2) = 0.055.
    assert CHECK.interval(share) == [0.5, 0.2, 0.8]
    assert CHECK.interval(share - same) == [0, 0, 0]
    # The difference of two has the variance 2 * 0.25 / 10; that of 2000 resamples is known to 3.2 %.
    assert np.var((share - other)[0, 1:]) == pytest.approx(0.05, rel=4 * 0.032)


def test_one_unit_has_no_interval():
    [number] = CHECK.resampled(np.array([[0.5]]), "a", np.mean)
    assert CHECK.interval(number)[0] == 0.5 and np.isnan(CHECK.interval(number)[1:]).all()


PAPER = """
[[reading]]
name = "main"
[[reading]]
name    = "The other one"
figures = ["white"]
start   = "nominal"
[reading.asks]
A = "score('ppo') > 3"
[[reading]]
name    = "like it"
like    = "The other one"
instead = { anr = "anr_h" }
[[reading]]
name   = "median"
median = true
[[reading]]
name    = "printed"
printed = true
"""
CLAIMS = """
[names]
agents = ["sac", "rap"]
[[claim]]
id     = "A"
figure = "white"
holds  = "all(area(score('ppo', 'w')) > area(score(a, 'w')) for a in agents) and at(score('ppo', 'w'), 2) >= 0.5 * score('ppo')"
[[claim]]
id      = "B"
figure  = "white"
missing = "nobody has it"
[[claim]]
id     = "C"
figure = "white"
metric = "rmse"
holds  = "all(mean(score(a, 'g')) > 1 for a in agents) and first(score('ppo', 'g', 2)) > 1"
[[premise]]
of     = "rap"
claims = ["C"]
from   = ["white"]
holds  = "last(curve('rap')) > 0.5 and reach(curve('rap'), 0.4) < 100"
"""
#          policy, sweep, start, metric, word, cells of units
CURVES = [("ppo", "", "random", "anr", "p", [[1, 1]]), ("ppo", "w", "random", "anr", "p", [[1, 1], [0.5, 0.25]]),
          ("sac", "", "random", "anr", "s", [[1, 1]]), ("sac", "w", "random", "anr", "s", [[0.5, 0.5], [0.5, 0.5]]),
          ("rap", "", "random", "anr", "r", [[1, 1, 1]]), ("rap", "w", "random", "anr", "r", [[0, 0, 3], [0, 0, 3]]),
          ("ppo", "", "nominal", "anr", "p", [[4, 4]]), ("ppo", "", "nominal", "anr_h", "p", [[2, 2]]),
          ("sac", "g", "random", "rmse", "s", [[3], [2], [1], [1]]), ("rap", "g", "random", "rmse", "r", [[1], [1], [1], [1]]),
          ("ppo", "g", "random", "rmse", "p", [[9], [9], [2.5], [9]])]


@pytest.fixture
def results(tmp_path):
    """A paper with two studies: the main reading's, and that of one that changes it."""
    (tmp_path / "paper.toml").write_text(PAPER)
    (tmp_path / "claims.toml").write_text(CLAIMS)
    (tmp_path / "tables.csv").write_text("table,row,column,mean\n")
    (tmp_path / "claims.csv").write_text("id,reading\n")
    rows, values = [], []
    for policy, sweep, start, metric, word, cells in CURVES:
        study = "main/white" if start == "random" else "the-other-one/white"
        rows.append([study, policy, sweep, start, metric, word, len(cells[0]), len(cells), len(values)])
        values += [unit for cell in cells for unit in cell]
    np.array(values, "<f4").tofile(tmp_path / "scores.f32")
    places = [["w", 0, ""], ["w", 2, ""], ["w", "", ""], ["g", 1, 5], ["g", 1, 6], ["g", 2, 5], ["g", 2, 6]]
    learning = [["rap", seed, steps, score] for seed in (1, 2) for steps, score in ((0, 0.1), (50, 0.4), (100, 0.45))]
    for name, lines in {"scores": ["study policy sweep start metric trainings units cells first".split(), *rows],
                        "main/white": [["sweep", "level", "level_2"], *places],
                        "main/white-learning": [["policy", "seed", "steps", "anr_h"], *learning, ["rap", 2, 150, 9]]}.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        with open(tmp_path / f"{name}.csv", "w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows(lines)
    return CHECK.Results(tmp_path, tmp_path)


def test_parts_are_told_by_their_names_with_scores_of_kept_curves(results):
    parts, left_out = results.ask("A", "main")

    assert left_out == 0
    assert [part.is_true for part in parts] == [True, False, False]
    # Areas: ppo (1 + 0.375) / 2, sac 0.5, rap 1.
    assert [part.interval[0] for part in parts] == [0.1875, -0.3125, -0.125]
    assert [part.says.endswith(name) for part, name in zip(parts, ("a = sac", "a = rap", "0.5 * score('ppo')"))] == [True] * 3
    # The last part is false in all resamples, and furthest from true: 0.5 or 0.25 at level 2 are against 0.5.
    assert min(parts, key=lambda part: part.order(3)).interval[1:] == [-0.25, 0]


def test_readings_ask_other_studies_starts_metrics_and_statistics(results):
    assert [part.interval[0] for part in results.ask("A", "The other one")[0]] == [1]
    assert [part.interval[0] for part in results.ask("A", "like it")[0]] == [-1]
    # Of rap's trainings the median is 0.
    assert [part.interval[0] for part in results.ask("A", "median")[0]] == [0.1875, 0.6875, -0.125]


def test_parts_whose_premise_did_not_happen_are_left_out(results):
    parts, left_out = results.ask("C", "main")

    assert left_out == 1
    assert [part.interval[0] for part in parts] == [0.75, 1.5]  # sac's mean over the grid, ppo's first cell of row 2


def test_what_cannot_be_asked_says_why(results):
    for claim, reading, why in (("B", "main", "nobody has it"), ("C", "The other one", "not kept: rmse of sac, g")):
        row = {"id": claim, "reading": reading} | dict.fromkeys(CHECK.KEPT, "")
        assert CHECK.answer(results, row)["not_recomputed"] == why


def test_a_folder_without_scores_and_a_claim_that_is_not_there_are_errors(tmp_path):
    done = subprocess.run([sys.executable, SCRIPT, tmp_path], capture_output=True, text=True, timeout=60)
    assert done.returncode == 2 and "scores.f32: No such file or directory" in done.stderr


needs_scores = pytest.mark.skipif(not (RESULTS / "scores.csv").exists(), reason=f"no {RESULTS / 'scores.csv'}: it comes with a measurement")

# The percentiles of two sets of 2000 resamples differ by no more than those of one at shares that lie so far apart: 4 standard errors.
TAIL = 4 * math.sqrt(2 * 0.025 * 0.975 / CHECK.RESAMPLES)
# Standard errors of 2000 resamples are known to 1.6 %, so distances differ by no more than this: 4 standard errors again.
DISTANCE = 4 * math.sqrt(2) / math.sqrt(2 * CHECK.RESAMPLES)


def close(a, b):
    """Scores were rounded to float32, and are of the order of 1."""
    return a == b or math.isclose(a, b, rel_tol=1e-5, abs_tol=1e-6) or math.isnan(a) and math.isnan(b)


def within(end, ends, share):
    """Whether a percentile of gust's resamples is one of ours."""
    least, most = (np.quantile(ends[1:], q, method=method) for q, method in ((share - TAIL, "lower"), (share + TAIL, "higher")))
    return least < end < most or close(end, least) or close(end, most)


def problem(row, parts, left_out):
    """What of a row of claims.csv is not as recomputed."""
    found, kept = (len(parts), sum(part.is_true for part in parts), left_out), ("parts", "true_parts", "left_out_parts")
    if found != tuple(int(row[key]) for key in kept):
        return f"{kept} are {found}"
    if not parts:
        return None
    estimate, low, high = (float(row[key] or "nan") for key in ("estimate", "low", "high"))
    decides = min(parts, key=lambda part: part.order(len(parts)))
    most = decides.distance * (1 + math.copysign(DISTANCE, decides.distance))
    same = [part for part in parts if close(part.interval[0], estimate) and (part.distance == decides.distance or part.distance <= most)]
    if not same:
        return f"decides: {decides.says}, {decides.interval}"
    if not any(within(low, part.margin[0], 0.025) and within(high, part.margin[1], 0.975) for part in same):
        return f"interval of {same[0].says}: {same[0].interval}"
    return None
