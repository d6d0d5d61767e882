#!/usr/bin/env python3
"""Writes statistics.json: what SciPy, NumPy and rliable say about the samples in it.

    pip install numpy==2.4.6 scipy==1.17.1 rliable==1.2.0 "pandas<3"
    python make.py

Every bootstrap entry holds the interval's bounds and, for each, the band in which a bound from TESTED resamples must lie: the
reference's percentiles four standard errors to either side of 2.5 % and 97.5 %. rliable draws from NumPy's global generator; it
is seeded here, so the file comes out the same every time.
"""

import json
import pathlib

import numpy as np
import scipy
import scipy.integrate
import scipy.optimize
import scipy.stats
from rliable import library, metrics

RESAMPLES = 20_000  # of the reference
TESTED = 100_000  # of the program that is compared with it


def plain(value):
    """NumPy's numbers and arrays as JSON has them."""
    return np.asarray(value, dtype=float).tolist()


def bounds_of(resampled):
    """The percentile interval and its Monte-Carlo bands; infinite values stand as 1e300, which JSON can hold."""
    finite = np.where(np.isinf(resampled), 1e300, resampled)
    error = np.sqrt(0.025 * 0.975 * (1 / len(finite) + 1 / TESTED))
    shares = np.array([0.025, 0.025 - 4 * error, 0.025 + 4 * error])
    low, high = np.quantile(finite, shares), np.quantile(finite, 1 - shares)
    return {"low": plain(low[0]), "low_band": plain(low[1:]), "high": plain(high[0]), "high_band": plain(high[:0:-1])}


def samples():
    """Samples as scores come: few, tied, skewed, far from zero, constant."""
    rng = np.random.default_rng(8)
    return {
        "oracle 8.8.4": [0, 0, 0, 1, 2, 3, 10, 10, 10, 10],
        "one": [0.3],
        "two": [0.9, 0.1],
        "three": [2.5, -1.0, 7.25],
        "four": [1.0, 4.0, 2.0, 8.0],
        "five tied": [0.5, 0.5, 0.25, 0.5, 0.75],
        "ten normal": rng.normal(size=10),
        "eleven returns": rng.beta(8, 1, size=11),
        "twenty-five skewed": rng.lognormal(size=25),
        "thirty-seven offset": 1e6 + rng.normal(size=37),
        "hundred uniform": rng.uniform(-1, 1, size=100),
    }


def exact_statistics(values):
    values = np.asarray(values, dtype=float)
    column = values[:, None]
    shares = [0.0, 0.025, 0.1, 0.25, 0.5, 2 / 3, 0.9, 0.975, 1.0]
    return {
        "values": plain(values),
        "mean": plain(np.mean(values)),
        "sample_deviation": plain(np.std(values, ddof=1)) if len(values) > 1 else None,
        "median": plain(np.median(values)),
        "iqm": plain(metrics.aggregate_iqm(column)),
        "trim_mean": plain(scipy.stats.trim_mean(values, 0.25)),
        "optimality_gap": plain(metrics.aggregate_optimality_gap(column, gamma=1)),
        "optimality_gap_half": plain(metrics.aggregate_optimality_gap(column, gamma=0.5)),
        "shares": shares,
        "quantiles": plain(np.quantile(values, shares, method="linear")),
    }


def wilson_intervals():
    rows = []
    for successes, trials in [(0, 1), (1, 1), (0, 25), (1, 25), (13, 25), (24, 25), (25, 25), (237, 250), (9_999, 10_000)]:
        for confidence in [0.8, 0.95, 0.99]:
            interval = scipy.stats.binomtest(successes, trials).proportion_ci(confidence, method="wilson")
            rows.append([successes, trials, confidence, interval.low, interval.high])
    return rows


def improvement(rng):
    rows = []
    for n, m in [(1, 1), (3, 5), (10, 10), (10, 20)]:
        x = np.round(rng.normal(0.4, 1, size=(n, 1)), 1)  # one decimal: ties
        y = np.round(rng.normal(0.0, 1, size=(m, 1)), 1)
        rows.append({"x": plain(x[:, 0]), "y": plain(y[:, 0]), "p": plain(metrics.probability_of_improvement(x, y))})
    return rows


def rliable_interval(scores, function, resamples=RESAMPLES):
    """rliable's estimate and interval; the bands from the same draws."""
    np.random.seed(1)
    estimates, intervals = library.get_interval_estimates(
        {"it": scores}, lambda *x: np.array([function(*x)]), reps=resamples
    )
    np.random.seed(1)
    kind = library.StratifiedIndependentBootstrap if isinstance(scores, list) else library.StratifiedBootstrap
    args = scores if isinstance(scores, list) else [scores]
    bounds = bounds_of(kind(*args).apply(function, reps=resamples)[:, 0])
    assert np.allclose(intervals["it"][:, 0], [bounds["low"], bounds["high"]], rtol=1e-12)
    return {"estimate": plain(estimates["it"][0]), **bounds}


def aggregates(rng):
    rows = []
    for runs, tasks in [(10, 1), (5, 4), (25, 3), (12, 9)]:
        scores = rng.beta(5, 2, size=(runs, tasks)) + 0.05 * np.arange(tasks)
        rows.append(
            {
                "scores": plain(scores.T),  # a row is a task
                "mean": rliable_interval(scores, metrics.aggregate_mean),
                "iqm": rliable_interval(scores, metrics.aggregate_iqm),
                "median": rliable_interval(scores, np.median),
                "optimality_gap": rliable_interval(scores, lambda x: metrics.aggregate_optimality_gap(x, gamma=0.8)),
                "sample_deviation": rliable_interval(scores, lambda x: np.std(x, ddof=1)),
            }
        )
    return rows


def profiles(rng):
    scores = rng.beta(5, 2, size=(20, 6))
    thresholds = np.array([0.0, 0.45, 0.6, 0.7, 0.8, 1.0])
    np.random.seed(3)
    profile, band = library.create_performance_profile({"it": scores}, thresholds, reps=RESAMPLES)
    return {
        "scores": plain(scores.T),
        "thresholds": plain(thresholds),
        "profile": plain(profile["it"]),
        "low": plain(band["it"][0]),
        "high": plain(band["it"][1]),
    }


def improvement_intervals(rng):
    rows = []
    for n, m, tasks in [(10, 10, 1), (20, 12, 3)]:
        x = rng.normal(0.5, 1, size=(n, tasks))
        y = rng.normal(0.0, 1, size=(m, tasks))
        interval = rliable_interval([x, y], metrics.probability_of_improvement, resamples=5_000)  # slow
        rows.append({"x": plain(x.T), "y": plain(y.T), **interval})
    return rows


def differences(rng):
    """Two policies on the same 25 episodes, whose luck they share; a row is a seed. Alone, the paired t interval; with
    seeds that differ much more than episodes do, Welch's interval of the seeds' means."""

    def policy(seeds, level):
        return level + 0.1 * rng.normal(size=(seeds, 1)) + luck + 0.002 * rng.normal(size=(seeds, 25))

    def entry(a, b, result):
        interval = result.confidence_interval(0.95)
        estimate = plain(np.mean(a) - np.mean(b))
        return {"a": plain(a), "b": plain(b), "estimate": estimate, "low": interval.low, "high": interval.high}

    luck = 0.3 * rng.normal(size=(1, 25))
    rows = {}
    a, b = policy(8, 0.9), policy(14, 0.8)
    rows["seeds"] = entry(a, b, scipy.stats.ttest_ind(a.mean(axis=1), b.mean(axis=1), equal_var=False))
    a, b = policy(1, 0.9), policy(10, 0.8)
    rows["one alone"] = entry(a, b, scipy.stats.ttest_1samp(np.mean(a) - b.mean(axis=1), 0))
    a, b = policy(1, 0.9), policy(1, 0.8)
    rows["paired episodes"] = entry(a, b, scipy.stats.ttest_rel(a[0], b[0]))
    return rows


def margin_of(levels, scores, fraction=0.9):
    """The first root of score - fraction * nominal on NumPy's piecewise linear curve; inf if there is none."""
    threshold = fraction * scores[0]
    below = np.flatnonzero(scores < threshold)
    if len(below) == 0:
        return np.inf
    bracket = levels[below[0] - 1], levels[below[0]]
    return scipy.optimize.brentq(lambda level: np.interp(level, levels, scores) - threshold, *bracket, xtol=1e-15)


def student_interval(levels, scores, fraction=0.9, confidence=0.95):
    """All levels that a t-test of the seeds' falls does not exclude, out to the grid; inf beyond it. The lower end lies
    no higher than the tolerance limit (noncentral t) of the quantile at which seeds fall, for curves that fall in steps."""
    n = len(scores)
    left = scores - fraction * scores[:, :1]
    ends = [scipy.stats.ttest_1samp(column, 0).confidence_interval(confidence) for column in left.T]
    low = next((i for i, end in enumerate(ends) if end.low < 0), len(levels))
    high = next((i for i, end in enumerate(ends) if end.high < 0), len(levels))
    fallen = np.flatnonzero(left.mean(axis=0) < 0)
    if len(fallen) > 0:
        losses = np.maximum(0, scores[:, 0] - scores[:, fallen[0]])
        share = min(0.5, losses.sum() ** 2 / (n * (losses**2).sum()))
        falls = np.log([min(margin_of(levels, row, fraction), levels[-1]) for row in scores])
        shift = -scipy.stats.norm.ppf(share) * np.sqrt(n)
        reach = scipy.stats.nct.ppf(0.5 + confidence / 2, n - 1, shift) / np.sqrt(n)
        low = min(low, int(np.searchsorted(levels, np.exp(falls.mean() - reach * falls.std(ddof=1)))))
    return {
        "student_low": plain(levels[low - 1] if low > 0 else 0.0),
        "student_high": plain(levels[high] if high < len(levels) else 1e300),
    }


def margins(rng):
    levels = np.array([0.0, 0.5, 1.0, 2.0, 3.0, 4.5, 6.0])
    rows = {}
    for name, center in {"inside": 3.0, "partly beyond": 9.3, "beyond": 30.0}.items():
        middle = center * np.exp(0.25 * rng.normal(size=(10, 1)))
        scores = 0.95 / (1 + (levels / middle) ** 6) + 0.01 * rng.normal(size=(10, len(levels)))
        areas = scipy.integrate.trapezoid(scores, levels, axis=1) / (levels[-1] - levels[0])
        rows[name] = {
            "levels": plain(levels),
            "scores": plain(scores),
            "margin": plain(min(margin_of(levels, scores.mean(axis=0)), 1e300)),
            "areas": plain(areas),
            **student_interval(levels, scores),
        }
    return rows


def correlations():
    pairs = [
        ([0.1, 0.5, 0.2, 0.9, 0.4], [1.0, 2.0, 1.0, 1.5, 2.5]),
        ([0.0, 0.1, 0.2, 0.3, 0.5, 0.8, 1.3], [0.98, 0.97, 0.99, 0.62, 0.61, 0.05, 0.05]),
        ([3.0, 1.0, 2.0, 2.0, 1.0, 3.0], [1.0, 1.0, 2.0, 3.0, 3.0, 2.0]),
    ]
    functions = [scipy.stats.pearsonr, scipy.stats.spearmanr, scipy.stats.kendalltau]
    return [{"x": x, "y": y, "r_rho_tau": [plain(f(x, y)[0]) for f in functions]} for x, y in pairs]


def main():
    rng = np.random.default_rng(20231)
    data = {
        "made_with": {"numpy": np.__version__, "scipy": scipy.__version__, "rliable": "1.2.0"},
        "statistics": {name: exact_statistics(values) for name, values in samples().items()},
        "wilson": wilson_intervals(),
        "improvement": improvement(rng),
        "aggregates": aggregates(rng),
        "profile": profiles(rng),
        "improvement_intervals": improvement_intervals(rng),
        "differences": differences(rng),
        "margins": margins(rng),
        "correlations": correlations(),
    }
    lines = ",\n".join(f" {json.dumps(key)}: {json.dumps(value)}" for key, value in data.items())
    pathlib.Path(__file__).with_name("statistics.json").write_text("{\n" + lines + "\n}\n")


if __name__ == "__main__":
    main()
