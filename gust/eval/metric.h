#pragma once

#include "gust/control/episode.h"
#include "gust/core/catalog.h"

namespace gust {

/// One number that says how an episode went.
class Metric {
 public:
  virtual ~Metric() = default;

  /// The value; NaN if the episode had numbers that were none.
  virtual double value(const Episode& episode) const = 0;
  virtual bool higher_is_better() const = 0;
  virtual std::string_view unit() const = 0;
  /// Whether a plant has what is measured; elsewhere the value says nothing.
  virtual bool applies(const PlantSpec& spec) const = 0;
  /// Whether an episode gives 0 or 1, so that the mean is a share of successes (share.h).
  virtual bool is_zero_or_one() const = 0;
};

/// Every metric there is, in the order of metrics/list.inc.
const Catalog<Metric>& metrics();

/// All metrics, made once, in catalogue order. Every one of them is stored for every episode.
class MetricSet {
 public:
  MetricSet();
  std::size_t size() const { return made_.size(); }
  const std::string& name(std::size_t index) const { return made_[index].kind; }
  const Metric& operator[](std::size_t index) const { return *made_[index].object; }
  /// The position of a name; an unknown one is an Error at the place with the nearest name.
  std::size_t index(std::string_view name, const Place& place) const;
  /// Which of them apply to a plant.
  std::vector<bool> applying(const PlantSpec& spec) const;

 private:
  std::vector<Made<Metric>> made_;
};

}  // namespace gust
