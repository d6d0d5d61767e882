#include "gust/eval/metric.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gust {
namespace {

/// An episode that failed in step 4 of 8 and went on to fall; all sums are exact in binary.
Episode fallen() {
  Episode episode;
  episode.ended = {.steps = 4,
                   .return_sum = 3.0,
                   .return_commanded = 3.0,
                   .return_disturbed = 2.5,
                   .squared_error = 16.0,
                   .squared_masked_error = 1.0,
                   .squared_state = 18.0,
                   .saturated_steps = 1,
                   .max_abs_state = {0.5, 2.0, 1.75, 4.0},
                   .final_state = {}};
  episode.whole = {.steps = 8,
                   .return_sum = 3.5,
                   .return_commanded = 3.5,
                   .return_disturbed = 3.0,
                   .squared_error = 128.0,
                   .squared_masked_error = 64.0,
                   .squared_state = 130.0,
                   .saturated_steps = 5,
                   .max_abs_state = {9.0, 9.0, 9.0, 9.0},
                   .final_state = {}};
  episode.failed = true;
  episode.safe_steps = 4;
  episode.control_rate = 8.0;
  episode.horizon = 8;
  episode.angle = 2;
  return episode;
}

double value_of(std::string_view name, const Episode& episode) {
  const MetricSet metrics;
  return metrics[metrics.index(name, {})].value(episode);
}

TEST_CASE("every metric of an episode that failed halfway is what its definition says") {
  const Episode episode = fallen();

  CHECK(value_of("return_sum", episode) == 3.0);
  CHECK(value_of("length", episode) == 4.0);
  CHECK(value_of("anr", episode) == 0.75);        // over the steps that were done
  CHECK(value_of("anr_h", episode) == 0.375);     // over the horizon
  CHECK(value_of("anr_nt", episode) == 0.4375);   // as if failure ended nothing
  CHECK(value_of("rmse_paper", episode) == 4.0);  // all components, to the horizon
  CHECK(value_of("rmse_scg", episode) == 0.5);    // weighted components, to the end
  CHECK(value_of("rmse_sum", episode) == 4.0);
  CHECK(value_of("squared_state_sum", episode) == 18.0);  // of the state itself, not of its error
  CHECK(value_of("anr_pooled", episode) == 0.75);         // of a cell of one episode
  CHECK(value_of("survival", episode) == 0.0);
  CHECK(value_of("time_to_failure", episode) == 0.5);
  CHECK(value_of("saturation", episode) == 0.25);
  CHECK(value_of("max_abs_x", episode) == 0.5);
  CHECK(value_of("max_abs_theta", episode) == 1.75);
}

TEST_CASE("an episode that stands to the horizon survives, and its length is the horizon") {
  Episode episode = fallen();
  episode.ended = episode.whole;
  episode.failed = false;
  episode.safe_steps = 8;

  CHECK(value_of("survival", episode) == 1.0);
  CHECK(value_of("length", episode) == 8.0);
  CHECK(value_of("time_to_failure", episode) == 1.0);
  CHECK(value_of("anr", episode) == value_of("anr_h", episode));
}

TEST_CASE("the largest of NaN is NaN, and a later step does not change that of an earlier end") {
  Episode episode = fallen();
  episode.finite = false;
  episode.whole.squared_error = std::numeric_limits<double>::quiet_NaN();
  CHECK(value_of("max_abs_x", episode) == 0.5);
  CHECK(value_of("max_abs_theta", episode) == 1.75);

  episode.ended.squared_error = std::numeric_limits<double>::infinity();  // of a large number
  CHECK(value_of("max_abs_theta", episode) == 1.75);

  episode.ended.squared_error = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isnan(value_of("max_abs_x", episode)));
  CHECK(std::isnan(value_of("max_abs_theta", episode)));
}

TEST_CASE("quotients of means divide metrics of an episode, and all others are stored") {
  const MetricSet metrics;
  std::vector<std::string> quotients;
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    const auto quotient = metrics[i].quotient();
    CHECK(quotient.has_value() == (std::ranges::count(metrics.stored(), i) == 0));
    if (!quotient) continue;
    quotients.push_back(metrics.name(i));
    for (const std::string_view part : {quotient->numerator, quotient->denominator})
      CHECK_FALSE(metrics[metrics.index(part, {})].quotient());
  }

  CHECK(quotients == std::vector<std::string>{"anr_pooled"});
  CHECK(quotient_of("anr_pooled")->numerator == "return_sum");
  CHECK(quotient_of("anr_pooled")->denominator == "length");
  CHECK_FALSE(quotient_of("anr"));
  CHECK_FALSE(quotient_of("of another version"));
}

TEST_CASE("an unknown metric is an error with the nearest name") {
  CHECK_THROWS_WITH_AS(MetricSet().index("survivel", {"study.toml", 3, 4}),
                       doctest::Contains("study.toml:3:4: unknown metric 'survivel'; did you mean 'survival'?"), Error);
}

TEST_CASE("a loop that tells rewards alone has the metrics of rewards and of the length") {
  Interface spec;
  spec.tells_effort = spec.fails = spec.goes_on = false;
  const MetricSet metrics(spec);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < metrics.size(); ++i) names.push_back(metrics.name(i));
  std::ranges::sort(names);

  CHECK(names == std::vector<std::string>{"anr", "anr_h", "anr_pooled", "length", "return_sum"});
  CHECK_FALSE(metrics.first(MetricRole::survival));
  CHECK(metrics.name_of(MetricRole::survival).empty());
  CHECK_THROWS_WITH_AS(
      metrics.index("rmse_paper", {"s.toml", 1, 2}),
      "s.toml:1:2: the metric 'rmse_paper' is not applicable: the plant tells no goal, nothing after a "
      "failure",
      Error);
}

TEST_CASE("the axis of a mean of rewards is the range of a reward, where it has one") {
  const MetricSet metrics;
  const MetricTraits& mean = metrics[metrics.index("anr_h", {})].traits();
  const MetricTraits& share = metrics[metrics.index("saturation", {})].traits();
  Interface spec;

  CHECK(axis_of(mean, spec).high == 1);
  spec.reward = {-16.5, 0};
  CHECK(axis_of(mean, spec).low == -16.5);
  spec.reward = {};
  CHECK(std::isnan(axis_of(mean, spec).low));
  CHECK(axis_of(share, spec).high == 1);
}

}  // namespace
}  // namespace gust
