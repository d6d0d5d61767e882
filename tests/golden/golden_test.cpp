#include <doctest/doctest.h>

#include <algorithm>

#include "gust/core/csv.h"
#include "gust/core/hash.h"
#include "gust/study/summary/export.h"
#include "gust/study/text/study_fixture.h"
#include "gust/study/trials/run.h"
#include "gust/study/trials/trials.h"

// Bits that must not change unless somebody means them to: then the signature here changes in the same commit, and the
// commit says so. They are the same on every x86-64-v3 machine.

using namespace gust;
using namespace gust::test;

namespace {

constexpr std::string_view kGoldenStudy = R"(schema = 1
name = "golden"
seed = 11
plant = { kind = "cartpole", preset = "scg-2022" }

[evaluate]
episodes = 2

[[policy]]
name = "lqr"
kind = "lqr"

[[policy]]
name = "ppo"
kind = "train"
agent = { kind = "ppo", steps = 8_000 }
seeds = [1]

[[sweep]]
name = "seen"
site = "observation"
waveform = "white"
levels = [0, 0.1]

[[sweep]]
name = "pushed"
site = "dynamics"
waveform = { kind = "triangle", frequency = 2 }
levels = [0, 0.3]
)";

constexpr std::string_view kGoldenGames = R"(schema = 1
name = "golden-games"
plant = { kind = "cartpole", preset = "scg-2022" }

[[policy]]
name = "rarl"
kind = "train"
agent = { kind = "rarl", steps = 8_000 }

[[policy]]
name = "rap"
kind = "train"
agent = { kind = "rap", steps = 8_000, reset_each_rollout = false }

[[policy]]
name = "drawn"
kind = "train"
agent = { kind = "ppo", steps = 8_000, randomise = "mid" }
)";

/// The parameters of a policy's actor after its training with seed 1.
std::string trained_bits(const Study& study, std::size_t policy) {
  const PolicyTraining& trained = *study.policies[policy].training();
  const std::unique_ptr<Training> training =
      trained.agent->start({study.setup.plant->plant(), study.setup.readings, {}, 1, trained.randomised.draws});
  while (!training->done()) training->advance();
  const ActorNetwork actor = training->actor();
  const std::span<const float> weights = actor.mlp.parameters();
  return hash_hex({reinterpret_cast<const char*>(weights.data()), weights.size_bytes()});
}

/// The exported numbers with a choice of columns and metrics that never changes, so that only other numbers give
/// another hash.
std::string exported_numbers(const Study& study, const Plan& plan, const Store& store) {
  static constexpr std::string_view kMetrics[] = {"return_sum",    "length",          "anr",        "anr_h",
                                                  "anr_nt",        "rmse_paper",      "rmse_scg",   "rmse_sum",
                                                  "survival",      "time_to_failure", "saturation", "max_abs_x",
                                                  "max_abs_theta", "ground_contact"};
  std::string text = "plant,preset,readings,policy,seed,site,waveform,vary,level,start,episode,metric,value\n";
  for_each_export_row(study, plan, store, [&](const ExportRow& row) {
    if (std::ranges::find(kMetrics, row.metric) == std::end(kMetrics)) return;
    text += csv_line({row.plant, row.preset, row.readings, row.policy, row.seed, row.site, row.waveform, row.vary,
                      cat(row.level), row.start, cat(row.episode), row.metric, cat(row.value)});
  });
  return text;
}

}  // namespace

TEST_CASE("a small study with a training gives the bits that it always gave") {
  const ScratchFolder folder("gust-golden");
  Study study =
      small_study({"evaluate.margin_tolerance=0"}, kGoldenStudy);  // a margin may ask for other levels one day
  const Store store(folder.path / "store", Store::Access::write);

  const RunOutcome outcome = run_study(study, store, {.threads = 2, .stop = {}, .watch = {}});

  REQUIRE(outcome.failed() == 0);
  CHECK(hash_hex(exported_numbers(study, outcome.plan, store)) == "763d45e8daf98cd2d5c2418f641e2e53");
  CHECK(trained_bits(study, 1) == "6ae342ff543f211924079b43d3ddc788");
}

TEST_CASE("small trainings against adversaries and with drawn parameters give the bits that they always gave") {
  const Study study = small_study({}, kGoldenGames);

  CHECK(trained_bits(study, 0) == "6cd2b7e5e7b04b4046297bd26c05311e");
  CHECK(trained_bits(study, 1) == "abef4d5c122f7ef167fa2c5431cba627");
  CHECK(trained_bits(study, 2) == "1614ed0046304c19813708c3904dc072");
}
