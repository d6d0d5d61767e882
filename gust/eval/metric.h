#pragma once

#include <limits>
#include <optional>
#include <string_view>

#include "gust/control/episode.h"
#include "gust/core/catalog.h"

namespace gust {

/// Two metrics of an episode, by name: their means over the episodes of a cell are divided.
struct Quotient {
  std::string_view numerator;
  std::string_view denominator;
};

/// What a metric says of an episode.
enum class MetricRole {
  score,         ///< how well it went
  error,         ///< how far the state was from where it should be
  survival,      ///< whether it ended without a failure
  failure_time,  ///< when it failed
  length,        ///< how many control steps it had
  saturation,    ///< how often the actuator could not give what was asked for
  diagnostic,    ///< anything else
};

/// What is true of a metric for every episode: its own file declares it, and nobody else guesses.
struct MetricTraits {
  std::string_view title;      ///< of an axis, without the unit
  std::string_view unit = {};  ///< empty: none
  MetricRole role = MetricRole::diagnostic;
  bool higher_is_better = true;
  bool zero_or_one = false;    ///< an episode gives 0 or 1, so that the mean is a share of successes (share.h)
  Told needs = {};             ///< of the loop; where it is not told, the metric is not applicable
  bool mean_reward = false;    ///< a mean of rewards, so that its axis is the range of a reward
  bool sums_over_row = false;  ///< sums over the steps of a row of `gust eval`, terminated or not
  double low = std::numeric_limits<double>::quiet_NaN();  ///< ends of an axis; NaN: as the data are
  double high = std::numeric_limits<double>::quiet_NaN();
  int lead = 0;  ///< its place among the metrics that a study leads with unless it names others; 0: not among them
};

/// One number that says how an episode went, or of a quotient how all episodes of a cell went.
class Metric {
 public:
  virtual ~Metric() = default;

  /// The value; NaN if the episode had NaN or infinities. Of a quotient that of a cell of this episode alone.
  virtual double value(const Episode& episode) const = 0;
  /// What is divided, where the metric is a quotient of means; see quotient.h.
  virtual std::optional<Quotient> quotient() const = 0;
  virtual const MetricTraits& traits() const = 0;
  /// Whether there is what is measured; elsewhere the value says nothing.
  virtual bool applies(const Interface& spec) const = 0;
};

/// The ends of a metric's axis for a loop; NaN where there is none.
Limits axis_of(const MetricTraits& traits, const Interface& spec);

/// Every metric there is, in the order of metrics/list.inc.
const Catalog<Metric>& metrics();

/// The quotient that a metric is; none of a metric of an episode, nor of a name that there is not.
std::optional<Quotient> quotient_of(std::string_view metric);

/// The metrics of a loop, made once, in catalogue order: those whose needs it tells.
class MetricSet {
 public:
  /// All that there are.
  MetricSet();
  explicit MetricSet(const Interface& spec);
  std::size_t size() const { return made_.size(); }
  const std::string& name(std::size_t index) const { return made_[index].kind; }
  const Metric& operator[](std::size_t index) const { return *made_[index].object; }
  /// The position of a name; an unknown one is an Error at the place with the nearest name, one that is not applicable
  /// an Error that says what the loop does not tell.
  std::size_t index(std::string_view name, const Place& place) const;
  /// The first one of a role; none where the loop does not tell what it needs.
  std::optional<std::size_t> first(MetricRole role) const;
  /// Its name, or an empty one, which no metric has.
  std::string name_of(MetricRole role) const;
  /// What a study leads with unless it names others.
  std::vector<std::size_t> leading() const;
  /// Those that are stored for every episode: all but the quotients, which follow from them.
  const std::vector<std::size_t>& stored() const { return stored_; }
  /// Which of them apply.
  std::vector<bool> applying(const Interface& spec) const;
  /// Those that are not in the set, because the loop does not tell what they need.
  std::vector<std::string> names_not_applicable() const;
  /// The same for people: "rmse_scg (no goal), …"; empty if all are in the set.
  std::string not_applicable() const;

 private:
  explicit MetricSet(const Told& told);

  Told told_;
  std::vector<Made<Metric>> made_;
  std::vector<std::size_t> stored_;
};

}  // namespace gust
