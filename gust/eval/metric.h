#pragma once

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

/// One number that says how an episode went, or of a quotient how all episodes of a cell went.
class Metric {
 public:
  virtual ~Metric() = default;

  /// The value; NaN if the episode had numbers that were none. Of a quotient that of a cell of this episode alone.
  virtual double value(const Episode& episode) const = 0;
  /// What is divided, where the metric is a quotient of means; see quotient.h.
  virtual std::optional<Quotient> quotient() const = 0;
  virtual bool higher_is_better() const = 0;
  virtual std::string_view unit() const = 0;
  /// Whether a plant has what is measured; elsewhere the value says nothing.
  virtual bool applies(const PlantSpec& spec) const = 0;
  /// Whether an episode gives 0 or 1, so that the mean is a share of successes (share.h).
  virtual bool is_zero_or_one() const = 0;
};

/// Every metric there is, in the order of metrics/list.inc.
const Catalog<Metric>& metrics();

/// The quotient that a metric is; none of a metric of an episode, nor of a name that there is not.
std::optional<Quotient> quotient_of(std::string_view metric);

/// All metrics, made once, in catalogue order.
class MetricSet {
 public:
  MetricSet();
  std::size_t size() const { return made_.size(); }
  const std::string& name(std::size_t index) const { return made_[index].kind; }
  const Metric& operator[](std::size_t index) const { return *made_[index].object; }
  /// The position of a name; an unknown one is an Error at the place with the nearest name.
  std::size_t index(std::string_view name, const Place& place) const;
  /// Those that are stored for every episode: all but the quotients, which follow from them.
  const std::vector<std::size_t>& stored() const { return stored_; }
  /// Which of them apply to a plant.
  std::vector<bool> applying(const PlantSpec& spec) const;

 private:
  std::vector<Made<Metric>> made_;
  std::vector<std::size_t> stored_;
};

}  // namespace gust
