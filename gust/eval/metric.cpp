#include "gust/eval/metric.h"

#include <algorithm>

namespace gust {

#define GUST_ENTRY(name) Entry<Metric> metric_##name();
#include "gust/eval/metrics/list.inc"
#undef GUST_ENTRY

const Catalog<Metric>& metrics() {
  static const Catalog<Metric> catalog("metric", {
#define GUST_ENTRY(name) metric_##name(),
#include "gust/eval/metrics/list.inc"
#undef GUST_ENTRY
                                                 });
  return catalog;
}

std::optional<Quotient> quotient_of(std::string_view metric) {
  static const MetricSet set;
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (set.name(i) == metric) return set[i].quotient();
  }
  return std::nullopt;
}

MetricSet::MetricSet() {
  for (const Entry<Metric>& entry : metrics().entries()) {
    made_.push_back(entry.make(Table{}));
    if (!made_.back()->quotient()) stored_.push_back(made_.size() - 1);
  }
}

std::size_t MetricSet::index(std::string_view name, const Place& place) const {
  metrics().at(name, place);
  std::size_t i = 0;
  while (made_[i].kind != name) ++i;
  return i;
}

std::size_t MetricSet::first(MetricRole role) const {
  const auto of_role = [&](const Made<Metric>& metric) { return metric->traits().role == role; };
  const auto found = std::ranges::find_if(made_, of_role);
  GUST_CHECK(found != made_.end());
  return static_cast<std::size_t>(found - made_.begin());
}

std::vector<std::size_t> MetricSet::leading() const {
  std::vector<std::size_t> leading;
  for (std::size_t i = 0; i < size(); ++i) {
    if (made_[i]->traits().lead > 0) leading.push_back(i);
  }
  std::ranges::sort(leading, {}, [&](std::size_t i) { return made_[i]->traits().lead; });
  return leading;
}

std::vector<bool> MetricSet::applying(const PlantSpec& spec) const {
  std::vector<bool> applying;
  for (const Made<Metric>& metric : made_) applying.push_back(metric->applies(spec));
  return applying;
}

}  // namespace gust
