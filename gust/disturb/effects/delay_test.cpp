#include <doctest/doctest.h>

#include "gust/disturb/effect.h"

using namespace gust;

namespace {

Made<Effect> delay(const std::string& unit = "s") {
  return effects().make(Table{{{"kind", {std::string("delay"), {}}}, {"unit", {unit, {}}}}, {}});
}

/// What a delay makes of the numbers 1, 2, 3, …, each early or late within its control step.
std::vector<EffectValue> delayed(const Made<Effect>& effect, double level, const EffectPlace& place, int count) {
  std::vector<std::vector<double>> memory(1, std::vector<double>(effect->memory(level, place)));
  std::vector<std::uint8_t> fresh = {1};
  const std::vector<std::uint8_t> on = {1};
  const double factor = 1, rest = -1;
  std::vector<EffectValue> values;
  for (int k = 1; k <= count; ++k) {
    Matrix<double> late(1, 1, k), early(1, 1, place.seen ? k - 0.5 : k);
    effect->apply({.place = place,
                   .early = early.view(),
                   .late = late.view(),
                   .factors = std::span(&factor, 1),
                   .rest = place.seen ? std::span<const double>() : std::span(&rest, 1),
                   .level = std::span(&level, 1),
                   .on = on,
                   .fresh = fresh,
                   .memory = memory,
                   .count = 1});
    values.push_back({early.at(0, 0), late.at(0, 0)});
  }
  return values;
}

std::vector<double> late_of(const std::vector<EffectValue>& values) {
  std::vector<double> late;
  for (const EffectValue& value : values) late.push_back(value.late);
  return late;
}
std::vector<double> early_of(const std::vector<EffectValue>& values) {
  std::vector<double> early;
  for (const EffectValue& value : values) early.push_back(value.early);
  return early;
}

const EffectPlace kActs{.rate = 50, .substeps = 20, .steps = 250};
const EffectPlace kSeen{.rate = 50, .substeps = 20, .steps = 250, .seen = true};

}  // namespace

TEST_CASE("an action that is late by whole steps is the one of so many steps ago, at rest before the first") {
  CHECK(late_of(delayed(delay(), 0, kActs, 4)) == std::vector<double>{1, 2, 3, 4});
  CHECK(late_of(delayed(delay(), 0.04, kActs, 4)) == std::vector<double>{-1, -1, 1, 2});
  CHECK(early_of(delayed(delay(), 0.04, kActs, 4)) == std::vector<double>{-1, -1, 1, 2});
  CHECK(late_of(delayed(delay("steps"), 2, kActs, 4)) == std::vector<double>{-1, -1, 1, 2});
  CHECK(delay()->split(0.04, kActs) == 0);
}

TEST_CASE("an action that is late by a part of a step changes within it") {
  const auto values = delayed(delay(), 0.025, kActs, 4);  // one step and five substeps

  CHECK(delay()->split(0.025, kActs) == 5);
  CHECK(early_of(values) == std::vector<double>{-1, -1, 1, 2});
  CHECK(late_of(values) == std::vector<double>{-1, 1, 2, 3});
}

TEST_CASE("an observation that is late by a part of a step is the one within the step before") {
  CHECK(late_of(delayed(delay(), 0.02, kSeen, 4)) == std::vector<double>{1, 1, 2, 3});
  CHECK(late_of(delayed(delay(), 0.005, kSeen, 4)) == std::vector<double>{0.5, 1.5, 2.5, 3.5});
  CHECK(late_of(delayed(delay(), 0.025, kSeen, 4)) == std::vector<double>{1, 0.5, 1.5, 2.5});
}

TEST_CASE("a delay of more than an episode lets nothing through, and needs no more memory") {
  CHECK(late_of(delayed(delay(), 1e9, kActs, 3)) == std::vector<double>{-1, -1, -1});
  CHECK(delay()->memory(1e9, kActs) == 253);
}
