// What a sweep may set beside its axis: parameters of the plant and disturbances that are on in all of its cells; and a
// grid whose second axis is a level. Each is the same as saying it another way.
#include <doctest/doctest.h>

#include "gust/study/summary/summary.h"
#include "gust/study/text/study_fixture.h"
#include "gust/study/trials/run.h"

using namespace gust;
using namespace gust::test;

namespace {

const char* const kEnd = "[[claim]]";

/// The small study with more sweeps, run; asks for the mean scores of the regulator from random starts.
struct Ran {
  ScratchFolder folder;
  Study study;
  Store store;
  Summary summary;

  Ran(const std::string& name, const std::string& sweeps, const std::vector<std::string>& settings = {})
      : folder(name),
        study(small_study(settings, changed(kEnd, sweeps + kEnd))),
        store(folder.path / "store", Store::Access::write),
        summary(summarise(
            *stored_measurements(study, run_study(study, store, {.threads = 1, .stop = {}, .watch = {}}).plan, store),
            1)) {}

  std::vector<double> scores(const std::string& sweep) const {
    for (std::size_t s = 0; s < study.sweeps.size(); ++s) {
      if (study.sweeps[s].name != sweep) continue;
      const Series& series = *summary.find(0, s, 1);
      std::vector<double> scores;
      for (std::size_t cell = 0; cell < series.cells; ++cell)
        scores.push_back(series.at(summary.margin_metric, cell).value);
      return scores;
    }
    return {};
  }
};

std::string problem_of(const std::string& sweep) {
  try {
    small_study({}, changed(kEnd, sweep + kEnd));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a grid over a parameter and a level is a sweep over the level for each value of the parameter") {
  const Ran ran("gust-setting-grid",
                "[[sweep]]\nname = \"grid\"\nsite = \"action\"\nwaveform = \"white\"\n"
                "grid = { pole_mass = [0.1, 0.4], level = [0, 5, 20] }\n"
                "[[sweep]]\nname = \"light\"\nsite = \"action\"\nwaveform = \"white\"\nlevels = [0, 5, 20]\n"
                "[[sweep]]\nname = \"heavy\"\nsite = \"action\"\nwaveform = \"white\"\nlevels = [0, 5, 20]\n"
                "params = { pole_mass = \"x4\" }\n");

  std::vector<double> rows = ran.scores("light");
  const std::vector<double> heavy = ran.scores("heavy");
  rows.insert(rows.end(), heavy.begin(), heavy.end());

  CHECK(ran.scores("grid") == rows);
  CHECK(rows[0] != rows[3]);
  CHECK_FALSE(ran.summary.find(0, 2, 1)->has_margin);
}

TEST_CASE("what is on in a sweep is what would be on in the whole study") {
  const std::string sweep = "[[sweep]]\nname = \"mass\"\nvary = \"pole_mass\"\nscale = [1, 2]\n";
  const std::string on = "[{ site = \"action\", waveform = \"white\", level = 8 }]";
  const Ran quiet("gust-setting-quiet", sweep);
  const Ran within("gust-setting-within", sweep + "disturb = " + on + "\n");
  const Ran always("gust-setting-always", sweep, {"evaluate.disturb=" + on});

  CHECK(within.scores("mass") == always.scores("mass"));
  CHECK(within.scores("mass") != quiet.scores("mass"));
}

TEST_CASE("several parameters change together") {
  const Ran ran("gust-setting-params",
                "[[sweep]]\nname = \"all\"\nvary = \"pole_length\"\nscale = [1.5]\n"
                "params = { pole_mass = \"x1.5\", cart_mass = 1.5 }\n"
                "[[sweep]]\nname = \"grid\"\ngrid = { pole_length = [0.75], pole_mass = [0.15] }\n"
                "params = { cart_mass = 1.5 }\n");

  CHECK(ran.scores("all") == ran.scores("grid"));
  CHECK(ran.study.sweeps[2].setting(ran.study.setup.plant->spec()) ==
        "pole_mass = 0.15000000000000002, cart_mass = 1.5");
}

TEST_CASE("the setting tells all that makes a standing disturbance another one") {
  const auto setting = [](const std::string& more) {
    const std::string on = "{ site = \"dynamics\", level = 2, " + more + " }";
    const Study study = small_study({}, changed(kEnd, "[[sweep]]\nname = \"s\"\nvary = \"pole_mass\"\nscale = [1]\n" +
                                                          ("disturb = [" + on + "]\n") + kEnd));
    return study.sweeps.back().setting(study.setup.plant->spec());
  };

  CHECK(setting("waveform = \"white\"") == "dynamics white(std = 1) at 2");
  CHECK(setting("waveform = \"white\", start = 5, end = 20") == "dynamics white(std = 1) in steps 5:20 at 2");
  CHECK(setting("waveform = \"white\", start = 5").find(" in steps 5:") != std::string::npos);
  CHECK(setting("waveform = \"white\", channels = [\"fz\"]") == "dynamics white(std = 1) on fz at 2");
  CHECK(setting("waveform = { kind = \"sine\", frequency = 1 }") !=
        setting("waveform = { kind = \"sine\", frequency = 2 }"));
}

TEST_CASE("what is wrong with a sweep's setting is said when the study is read") {
  const std::string sweep = "[[sweep]]\nname = \"s\"\nvary = \"pole_mass\"\nscale = [1]\n";

  CHECK(problem_of(sweep + "params = { pole_mas = 2 }\n").find("did you mean 'pole_mass'?") != std::string::npos);
  CHECK(problem_of(sweep + "params = { pole_mass = 2 }\n").find("is what the sweep varies") != std::string::npos);
  CHECK(problem_of(sweep + "params = { cart_mass = \"x-1\" }\n").find("must be > 0") != std::string::npos);
  CHECK(problem_of(sweep + "params = { cart_mass = \"heavy\" }\n").find("small.toml:33:") == 0);
  CHECK(problem_of(sweep + "disturb = [{ site = \"action\", waveform = \"white\" }]\n").find("needs a 'level'") !=
        std::string::npos);
  CHECK(problem_of("[[sweep]]\nname = \"s\"\ngrid = { pole_mass = [1], level = [1] }\n").find("site") !=
        std::string::npos);
  CHECK(problem_of("[[sweep]]\nname = \"s\"\ngrid = { level = [1] }\n").find("'grid' needs two axes") !=
        std::string::npos);
}
