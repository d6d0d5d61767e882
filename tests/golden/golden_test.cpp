#include <doctest/doctest.h>

#include "gust/core/hash.h"
#include "gust/study/export.h"
#include "gust/study/files.h"
#include "gust/study/run.h"
#include "gust/study/study_fixture.h"
#include "gust/study/trials.h"

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

}  // namespace

TEST_CASE("a small study with a training gives the bits that it always gave") {
  const ScratchFolder folder("gust-golden");
  Study study = small_study({}, kGoldenStudy);
  const Store store(folder.path / "store", Store::Access::write);

  const RunOutcome outcome = run_study(study, store, {.threads = 2, .stop = {}, .watch = {}});
  export_csv(study, outcome.plan, store, folder.path / "rows.csv");

  REQUIRE(outcome.failed() == 0);
  CHECK(hash_hex(read_file(folder.path / "rows.csv")) == "763d45e8daf98cd2d5c2418f641e2e53");
  const std::unique_ptr<Training> training =
      study.policies[1].agent->start({study.setup.plant.object.get(), study.setup.readings, {}, 1});
  while (!training->done()) training->advance();
  const ActorNetwork actor = training->actor();
  const std::span<const float> weights = actor.mlp.parameters();
  CHECK(hash_hex({reinterpret_cast<const char*>(weights.data()), weights.size_bytes()}) ==
        "6ae342ff543f211924079b43d3ddc788");
}
