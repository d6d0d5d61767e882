#include "gust/study/summary/comparison.h"

#include <doctest/doctest.h>

#include <cmath>

#include "gust/study/text/study_fixture.h"
#include "gust/study/trials/run.h"

using namespace gust;
using namespace gust::test;

namespace {

struct ComparedStudy {
  ScratchFolder folder{"gust-compare"};
  Study study;
  Store store;
  Plan plan;
  Summary summary;

  explicit ComparedStudy(const std::string& text = std::string(kSmallStudy))
      : study(small_study({}, text)),
        store(folder.path / "store", Store::Access::write),
        plan(run_study(study, store, {.threads = 1, .stop = {}, .watch = {}}).plan),
        summary(summarise(*stored_measurements(study, plan, store), 1)) {}
};

}  // namespace

TEST_CASE("two policies are compared undisturbed and along every sweep, with the summary's own scores") {
  const ComparedStudy run;
  const std::size_t random = compared_start(run.study);

  const auto found = compare_policies(*stored_measurements(run.study, run.plan, run.store), {0, 1, random});
  const auto turned = compare_policies(*stored_measurements(run.study, run.plan, run.store), {1, 0, random});

  REQUIRE(found.size() == 3);
  CHECK(run.study.starts[random].random);
  CHECK(found[0].sweep == Trial::kNominal);
  CHECK(found[0].found.over.interval.estimate ==
        doctest::Approx(run.summary.undisturbed(0, random) - run.summary.undisturbed(1, random)));
  CHECK(found[0].standing_of(found[0].found.over.interval) == Standing::ahead);  // the bare plant falls
  CHECK(turned[0].standing_of(turned[0].found.over.interval) == Standing::behind);
  CHECK(found[1].found.levels == std::vector<double>{0, 5, 30});
  CHECK(found[1].count(Standing::ahead) + found[1].count(Standing::behind) + found[1].count(Standing::undecided) == 3);
  CHECK(found[1].found.over.interval.estimate == doctest::Approx(-turned[1].found.over.interval.estimate));
  CHECK(found[1].found.improvement.estimate == doctest::Approx(1.0 - turned[1].found.improvement.estimate));
  CHECK(found[0].needed().empty());
  CHECK(found[0].seeds == 0);
}

TEST_CASE("the ratio of margins is that of the margins which the summary has") {
  const std::string second = "[[policy]]\nname = \"calm\"\nkind = \"lqr\"\nr = [1]\n\n";
  const ComparedStudy run(changed("[[sweep]]\nname = \"push\"", second + "[[sweep]]\nname = \"push\""));
  const std::size_t random = compared_start(run.study);
  const auto margin = [&](std::size_t policy) { return run.summary.find(policy, 0, random)->margin.level.estimate; };

  const Interval ratio =
      compare_policies(*stored_measurements(run.study, run.plan, run.store), {0, 2, random})[1].found.ratio;
  const Interval none =
      compare_policies(*stored_measurements(run.study, run.plan, run.store), {0, 1, random})[1].found.ratio;

  CHECK(ratio.estimate == doctest::Approx(margin(0) / margin(2)).epsilon(1e-12));
  CHECK(ratio.low <= ratio.estimate);
  CHECK(ratio.high >= ratio.estimate);
  CHECK(std::isnan(none.estimate));  // the bare plant has no margin
}

TEST_CASE("fewer than five seeds do not decide which policy is better, and the comparison says so") {
  SweepComparison item{{0, 1, 0}, 0, {}, 2};
  const Interval clear{.estimate = 1, .low = 0.9, .high = 1.1};

  CHECK(item.standing_of(clear) == Standing::undecided);
  CHECK(item.needed() == "2 seeds; five are needed");
  item.seeds = 5;
  CHECK(item.standing_of(clear) == Standing::ahead);
  item.seeds = 0;
  CHECK(item.standing_of(clear) == Standing::ahead);
}

TEST_CASE("what the store lacks is left out, and a page of many policies shows each against the first") {
  const ScratchFolder folder("gust-compare-missing");
  Study study = small_study();
  const Store store(folder.path / "store", Store::Access::write);

  const Plan plan = plan_with_store(study, store);

  CHECK(compare_policies(*stored_measurements(study, plan, store), {0, 1, 0}).empty());
  CHECK(shown_pairs(study, 1).size() == 1);
  while (study.policies.size() < 6) study.policies.push_back(study.policies.back());
  CHECK(shown_pairs(study, 1).size() == 15);
  study.policies.push_back(study.policies.back());
  CHECK(shown_pairs(study, 1).size() == 6);
}
