#include <array>

#include "gust/core/error.h"
#include "gust/core/rng.h"
#include "tests/page/fixture.h"

namespace gust {
namespace {

constexpr std::array kSites = {"observation", "action", "dynamics"};

/// The parts of a page that a figure keeps.
Page empty_page(const Page& of, std::string name) {
  Page page = of;
  page.name = std::move(name);
  page.sweeps.clear();
  page.curves.clear();
  page.margins.clear();
  page.grids.clear();
  page.learning.clear();
  page.claims.clear();
  page.episodes.clear();
  return page;
}

/// The sweeps of one waveform alone.
Page waveform_page(const Page& demo, std::string name, std::string_view waveform) {
  Page page = empty_page(demo, std::move(name));
  for (std::size_t sweep = 0; sweep < demo.sweeps.size(); ++sweep) {
    if (demo.sweeps[sweep].waveform != waveform) continue;
    for (auto curve : demo.curves) {
      if (curve.sweep != sweep) continue;
      curve.sweep = page.sweeps.size();
      page.curves.push_back(std::move(curve));
    }
    page.sweeps.push_back(demo.sweeps[sweep]);
  }
  return page;
}

Page learning_page(const Page& demo) {
  Page page = empty_page(demo, "learning-curves");
  page.learning = demo.learning;
  return page;
}

Page injected_page(const Page& demo) {
  Page page = empty_page(demo, "disturbances");
  page.sweeps = demo.sweeps;
  page.episodes = demo.episodes;
  return page;
}

Page plant_page(const Page& demo) {
  Page page = waveform_page(demo, "two-parameters", "pole_length");
  page.grids = demo.grids;
  std::swap(page.policies[1], page.policies[2]);  // in another order than elsewhere
  return page;
}

ReproductionPage::Figure table_figure() {
  ReproductionPage::Figure figure{"ranges", "Table I", "Ranges of domain randomisation"};
  figure.says = "Wider ranges cost a little at home and pay abroad.";
  figure.claims = {"C10", "C11"};
  figure.table_metric = "RMSE over 250 steps";
  const std::array rows = {"default", "params x1.5", "tap force"};
  const std::array columns = {"PPO", "PPO-DR low", "PPO-DR high"};
  const Rng noise(5);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double printed = (r == 0 ? 0.18 : 17.3 * r) / (1.0 + 0.8 * static_cast<double>(c));
      const double ours = printed * (0.8 + 0.5 * noise.uniform(10 * r + c));
      figure.table.push_back(
          {rows[r], columns[c], {printed, printed * 0.85, printed * 1.15}, {ours, ours * 0.9, ours * 1.1}});
    }
  }
  for (auto& cell : figure.table) {
    for (std::size_t seed = 0; seed < 10; ++seed)
      cell.trainings.push_back(cell.ours.value * (0.7 + 0.6 * noise.uniform(100 + seed)));
  }
  figure.table[1].printed = {0.148, Page::kUnknown, Page::kUnknown};
  figure.table[5].ours = {};
  figure.table[5].trainings.clear();
  return figure;
}

ReproductionPage::Claim claim(std::size_t number) {
  constexpr std::array kTexts = {
      "SAC, PPO and RAP each reach 90 % of the final return in fewer steps than RARL.",
      "RAP and PPO need about as many steps.",
      "Under white noise at the dynamics site the return falls linearly with the standard deviation.",
      "PPO has the highest return at the upper third of the observation levels, and stays there to the end of the "
      "range."};
  const auto ruling = static_cast<Ruling>(number * 7 / 3 % 4);
  ReproductionPage::Claim out;
  out.id = cat("C", number);
  out.place = number % 3 == 0 ? "Section IV-B, second paragraph" : "Section IV-A";
  out.text = kTexts[number % kTexts.size()];
  out.formula = cat("all(score(a, \"dynamics white\") > ", number, " for a in agents)");
  out.hard = number % 3 != 0;
  const double value = 0.25 * static_cast<double>(number) - 1;
  out.verdicts.push_back(
      {0, ruling, {value, value - 0.12, value + 0.2}, 10, "The interval of the difference says so."});
  for (std::size_t reading = 1; reading < 3; ++reading) {
    if (number % 4 == 3 && reading == 2) continue;
    const Ruling other = number % 6 == 2 && reading == 2 ? Ruling::fails : ruling;
    out.verdicts.push_back({reading, other, {value + 0.1, value, value + 0.3}, 5, "Judged with five seeds."});
  }
  if (ruling == Ruling::not_testable) {
    for (auto& verdict : out.verdicts)
      verdict = {verdict.reading, ruling, {}, 0, "The paper does not say which levels."};
    out.formula.clear();
  }
  return out;
}

}  // namespace

ReproductionPage reproduction_page() {
  const Page demo = demo_page();
  ReproductionPage page;
  page.title = "Robustness of policies, measured again";
  page.source = "A. Author and B. Author, “A paper that was invented for a test”, Journal of Fixtures 1 (2026), 1–12.";
  page.label = "Miniature: two seeds and short trainings. It shows that everything runs; it decides nothing.";
  page.opening = {"Of the twelve claims four hold and three fail.",
                  "What the paper says about white noise stands; its ranking under impulses does not.",
                  "One claim hangs on what the paper leaves open."};
  page.findings = {"Where nothing disturbs, everybody holds out."};
  page.warnings = {"One trial of 64 diverged and is missing."};
  page.readings = {{"scg-2022", "The simulator as it was when the paper was written: the pole starts upright."},
                   {"scg-default", "The simulator's defaults of today: random starts."},
                   {"saturate before", "Actions saturate before the disturbance is added, not after."}};
  for (std::size_t number = 1; number <= 12; ++number) page.claims.push_back(claim(number));
  ReproductionPage::Figure learning{"learning", "Figure 1", "Training without disturbance"};
  learning.says = "Vanilla agents learn fast; the robust ones take longer and end at the same return.";
  learning.claims = {"C1", "C2"};
  learning.shows = {"learning"};
  learning.page = learning_page(demo);
  ReproductionPage::Figure injected{"injected", "Figure 2", "The disturbances"};
  injected.says = "What is injected, in words.";
  injected.shows = {"disturbances", "replay"};
  injected.page = injected_page(demo);
  ReproductionPage::Figure white{"white", "Figure 3", "White noise"};
  white.says = "The return falls linearly at the dynamics site and hardly at the others.";
  white.claims = {"C3", "C4", "C5", "C6"};
  white.shows = {"curves", "survival"};
  white.page = waveform_page(demo, "white", "white noise");
  ReproductionPage::Figure plant{"plant", "Figure 8", "Two varying disturbances"};
  plant.says = "Length matters more than mass.";
  plant.claims = {"C7", "C8", "C9"};
  plant.shows = {"parameters", "grids", "replay"};  // there is no episode: no replay
  plant.page = plant_page(demo);
  page.figures = {learning, injected, white, plant, table_figure()};
  page.run_command = "gust reproduce paper --profile quick";
  page.provenance = {{"gust", "0.1.0"}, {"profile", "quick"}, {"machine", "2 cores, x86-64-v3"}};
  return page;
}

ReproductionPage large_reproduction() {
  const Page demo = demo_page();
  ReproductionPage page = reproduction_page();
  page.figures.clear();
  page.claims.clear();
  for (int r = 3; r < 12; ++r) page.readings.push_back({cat("reading ", r), "What else the words may mean."});
  for (std::size_t number = 1; number <= 72; ++number) {
    page.claims.push_back(claim(number));
    for (std::size_t r = 3; r < 12; ++r)
      page.claims.back().verdicts.push_back({r, Ruling::holds, {1, 0.9, 1.1}, 10, ""});
  }
  for (std::size_t f = 0; f < 19; ++f) {
    ReproductionPage::Figure figure{cat("figure-", f), cat("Figure ", f + 1), "One of many"};
    figure.says = "Something or other.";
    for (std::size_t c = 0; c < 3; ++c) figure.claims.push_back(cat("C", 3 * f + c + 1));
    figure.shows = {"curves", "survival", "parameters", "grids", "learning"};
    figure.page = demo;
    Page& one = figure.page;
    for (std::size_t p = 4; p < 46; ++p) {
      one.policies.push_back({cat("ppo ", kSites[p % 3], " ", 0.25 * static_cast<double>(p)), "train ppo", 10});
      for (auto curve : demo.curves) {
        if (curve.policy != 1) continue;
        curve.policy = p;
        for (auto* values : {&curve.band.value, &curve.band.low, &curve.band.high}) {
          for (auto& value : *values) value *= 1 - 0.01 * static_cast<double>(p);
        }
        one.curves.push_back(std::move(curve));
      }
      Page::Grid::Layer layer = one.grids[0].layers[0];
      layer.policy = p;
      one.grids[0].layers.push_back(std::move(layer));
      Page::Learning learning = one.learning[0];
      learning.policy = p;
      one.learning.push_back(std::move(learning));
    }
    page.figures.push_back(std::move(figure));
  }
  return page;
}

}  // namespace gust
