"""The digitised plots of the paper's first author can be read, and every curve is whole."""

import collections
import csv

from conftest import ROOT


def test_every_curve_has_its_levels_in_order_and_positive_costs():
    with open(ROOT / "tests/reference/authors_plots.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    curves = collections.defaultdict(list)
    for row in rows:
        assert row["agent"] in ("PPO", "RARL", "SAC", "RAP")
        assert float(row["value"]) > 0 and float(row["error"]) in (1, 2, 3) and row["hidden"] in ("0", "1")
        own = row["file"].endswith("noise_vs_cost")  # tested as it was trained
        assert row["trained"] == row["level"] if own else row["trained"] == "" or row["file"] == "noise_comparison_plot"
        curves[row["file"], row["agent"], "" if own else row["trained"]].append(float(row["level"]))

    assert all(levels == sorted(set(levels)) for levels in curves.values())
    counts = collections.Counter((file, len(levels)) for (file, _, _), levels in curves.items())
    assert counts == {("white_noise_dynamics_all", 9): 4, ("white_noise_action_all", 10): 4, ("white_noise_obs_all", 8): 4,
                      ("step_dynamics_all", 8): 4, ("noise_comparison_no_disturbance_all", 5): 3,
                      ("noise_comparison_plot", 5): 5, ("ppo_noise_vs_cost", 9): 1, ("rarl_noise_vs_cost", 9): 1}
