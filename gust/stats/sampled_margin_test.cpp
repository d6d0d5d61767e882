#include "gust/stats/sampled_margin.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "gust/stats/bootstrap.h"
#include "gust/stats/claim.h"
#include "gust/stats/formula.h"

// Claims about margins of simulated policies, whose truth is known.

namespace gust {
namespace {

constexpr std::size_t kResamples = 500;

/// Policies whose units differ in how sensitive they are: the score falls by `slope` of the level, or all at once.
struct Simulated {
  double slope = 0.05;
  bool steps = false;
  double spread = 0.2;

  double score(double level, double normal) const {
    const double sensitivity = std::exp(spread * normal);
    if (steps) return level * slope * sensitivity < 0.1 ? 1.0 : 0.2;
    return std::max(0.0, 1.0 - slope * level * sensitivity);
  }
  /// Of the mean over so many units that it is the truth.
  double margin() const {
    constexpr std::size_t kUnits = 4'001;
    std::vector<double> left;
    double low = 0, high = 20 * 0.05 / slope;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      double sum = 0;
      for (std::size_t u = 0; u < kUnits; ++u) sum += score(middle, Rng(99).normal(u)) / kUnits;
      (sum >= 0.9 ? low : high) = middle;
    }
    return low;
  }
};

/// p(name) is the curve of a simulated policy, with what its margin is measured from; units are seeds.
class Policies final : public FormulaData {
 public:
  Policies(std::vector<Simulated> policies, std::size_t units, const Rng& rng)
      : policies_(std::move(policies)), units_(units), rng_(rng) {}

  std::vector<std::string> functions() const override { return {"p"}; }
  FormulaValue call(std::string_view, const std::vector<FormulaValue>& arguments) const override {
    const auto which = static_cast<std::size_t>(arguments[0].as_number("p").estimate());
    const Simulated& policy = policies_[which];
    const Rng draws = rng_.split(which);
    auto data = std::make_shared<MarginData>();
    data->policy = std::string(1, static_cast<char>('a' + which));
    data->measured = "push";
    data->rng = rng_.split("compare");
    data->undisturbed = at(policy, 0, draws);
    data->add(0, data->undisturbed);
    for (double level = 0.02 / policy.slope; level < 0.5 / policy.slope; level *= 1.02)
      data->add(level, at(policy, level, draws));
    FormulaList curve;
    curve.axis = data->levels;
    Bootstrap bootstrap(draws.split("bootstrap"), kResamples);
    for (const Matrix<double>& scores : data->scores) curve.items.push_back({sampled(scores, bootstrap)});
    curve.margin_data = [data] { return data; };
    return {std::move(curve)};
  }

 private:
  Matrix<double> at(const Simulated& policy, double level, const Rng& rng) const {
    Matrix<double> scores(units_, 1);
    for (std::size_t u = 0; u < units_; ++u) scores.at(u, 0) = policy.score(level, rng.normal(u));
    return scores;
  }
  Sampled sampled(const Matrix<double>& scores, Bootstrap& bootstrap) const {
    Sampled result{std::vector<double>(1 + kResamples, 0.0)};
    result.unit = Unit::seeds;
    result.n = units_;
    for (std::size_t u = 0; u < units_; ++u) result.values[0] += scores.at(u, 0) / static_cast<double>(units_);
    const std::size_t strata[] = {units_};
    bootstrap.for_each_block(strata, [&](std::size_t first, const Rows<const std::uint16_t>& times) {
      for (std::size_t k = 0; k < times.lanes; ++k) {
        for (std::size_t u = 0; u < units_; ++u)
          result.values[1 + first + k] += times.at(u, k) * scores.at(u, 0) / static_cast<double>(units_);
      }
    });
    return result;
  }

  std::vector<Simulated> policies_;
  std::size_t units_;
  Rng rng_;
};

Sampled number(const std::string& text, const Policies& policies) {
  return Formula(text, {"test"}).evaluate({}, policies).as_number("a test");
}

/// p(k)'s data, as a comparison of two policies has them.
Sampled margin_of(std::size_t k, const Policies& policies) { return number(cat("margin(p(", k, "))"), policies); }

TEST_CASE("a claim about one margin has the interval of the table, at any confidence") {
  for (const std::size_t units : {3, 5, 10, 30}) {
    for (const bool steps : {false, true}) {
      const Policies policies({{.steps = steps}}, units, Rng(units));
      const Sampled told = margin_of(0, policies);
      for (const double confidence : {0.95, 0.9, 0.99}) {
        CAPTURE(units);
        CAPTURE(confidence);
        const Interval table = margin(told.margin->curve(), {.confidence = confidence}).level;
        const Interval claim = interval_of(told, confidence);
        CHECK(claim.estimate == doctest::Approx(table.estimate).epsilon(1e-9));
        if (confidence == 0.95) {
          CHECK(claim.low == table.low);
          CHECK(claim.high == table.high);
        }
        CHECK(claim.low == doctest::Approx(table.low).epsilon(0.05));  // tails are told in steps of a fifth
        CHECK(claim.high == doctest::Approx(table.high).epsilon(0.05));
      }
    }
  }
}

TEST_CASE("a ratio of margins has the interval of gust compare, and the order of two margins its verdict") {
  for (const double slope : {0.05, 0.06, 0.09}) {
    const Policies policies({{}, {.slope = slope}}, 8, Rng(3));
    const Interval compared = margin_ratio(*margin_of(0, policies).margin, *margin_of(1, policies).margin);
    const Interval claimed = interval_of(number("margin(p(0)) / margin(p(1))", policies));
    const auto ruling = [&](const std::string& text) {
      return judge(Formula(text, {"test"}), {}, policies).verdict.ruling;
    };

    CHECK(claimed.estimate == compared.estimate);
    CHECK(claimed.low == compared.low);
    CHECK(claimed.high == compared.high);
    CHECK(ruling("margin(p(0)) > margin(p(1))") == ruling("margin(p(0)) / margin(p(1)) > 1"));
    CHECK(ruling("margin(p(0)) - margin(p(1)) > 0") == ruling("margin(p(0)) / margin(p(1)) > 1"));
    CHECK(ruling("margin(p(1)) < margin(p(0))") == ruling("margin(p(0)) > margin(p(1))"));
  }
  const Policies one({{}}, 8, Rng(3));
  const Interval itself = interval_of(number("margin(p(0)) - margin(p(0))", one));
  CHECK(itself.low == 0.0);
  CHECK(itself.high == 0.0);
}

/// In how many of 200 sets of units the interval of a formula holds the truth, in percent.
double covered(const std::string& text, const std::vector<Simulated>& simulated, std::size_t units, double truth) {
  constexpr std::size_t kSets = 200;
  std::size_t within = 0;
  for (std::size_t set = 0; set < kSets; ++set) {
    const Interval found = interval_of(number(text, Policies(simulated, units, Rng(5).split(units).split(set))));
    within += found.low <= truth && truth <= found.high ? 1 : 0;
  }
  return 100.0 * static_cast<double>(within) / kSets;
}

TEST_CASE("intervals of formulas over margins cover the truth in 95 % of sets of units at least, few or many") {
  const std::vector<Simulated> lines = {{}, {.slope = 0.07}};
  const double a = lines[0].margin(), b = lines[1].margin();
  const std::pair<std::string, double> formulas[] = {{"margin(p(0)) - 1.4 * margin(p(1))", a - 1.4 * b},
                                                     {"mean(margin(p(0)), margin(p(1)))", 0.5 * (a + b)}};
  for (const auto& [text, truth] : formulas) {
    for (const std::size_t units : {5, 10, 30}) {
      const double share = covered(text, lines, units, truth);
      MESSAGE(text, ", ", units, " units: ", share, " %");
      CHECK(share >= 92);
      // Above 95 %: each of two intervals has its own few degrees of freedom, and reaches out to the levels, 2 % apart.
      CHECK(share <= (units == 5 ? 100 : 99.5));
    }
  }
}

}  // namespace
}  // namespace gust
