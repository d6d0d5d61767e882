#include "gust/eval/metric.h"

#include <algorithm>
#include <cmath>

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

Limits axis_of(const MetricTraits& traits, const Interface& spec) {
  if (!traits.mean_reward) return {traits.low, traits.high};
  if (std::isfinite(spec.reward.low) && std::isfinite(spec.reward.high)) return spec.reward;
  return {std::nan(""), std::nan("")};
}

std::optional<Quotient> quotient_of(std::string_view metric) {
  static const MetricSet set;
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (set.name(i) == metric) return set[i].quotient();
  }
  return std::nullopt;
}

MetricSet::MetricSet() : MetricSet(Told{true, true, true, true, true, true}) {}

MetricSet::MetricSet(const Interface& spec) : MetricSet(spec.told()) {}

MetricSet::MetricSet(const Told& told) : told_(told) {
  for (const Entry<Metric>& entry : metrics().entries()) {
    Made<Metric> metric = entry.make(Table{});
    if (!told.covers(metric->traits().needs)) continue;
    made_.push_back(std::move(metric));
    if (!made_.back()->quotient()) stored_.push_back(made_.size() - 1);
  }
}

std::size_t MetricSet::index(std::string_view name, const Place& place) const {
  const Entry<Metric>& entry = metrics().at(name, place);
  for (std::size_t i = 0; i < made_.size(); ++i) {
    if (made_[i].kind == name) return i;
  }
  throw error_at(place, "the metric '", name, "' is not applicable: the plant tells ",
                 untold_text(told_, entry.make(Table{})->traits().needs));
}

std::optional<std::size_t> MetricSet::first(MetricRole role) const {
  const auto of_role = [&](const Made<Metric>& metric) { return metric->traits().role == role; };
  const auto found = std::ranges::find_if(made_, of_role);
  if (found == made_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - made_.begin());
}

std::string MetricSet::name_of(MetricRole role) const {
  const std::optional<std::size_t> found = first(role);
  return found ? name(*found) : std::string();
}

std::vector<std::string> MetricSet::names_not_applicable() const {
  std::vector<std::string> names;
  for (const std::string& name : metrics().names()) {
    if (std::ranges::find(made_, name, &Made<Metric>::kind) == made_.end()) names.push_back(name);
  }
  return names;
}

std::string MetricSet::not_applicable() const {
  std::vector<std::string> parts;
  for (const std::string& name : names_not_applicable())
    parts.push_back(cat(name, " (", untold_text(told_, metrics().at(name).make(Table{})->traits().needs), ")"));
  return join(parts, ", ");
}

std::vector<std::size_t> MetricSet::leading() const {
  std::vector<std::size_t> leading;
  for (std::size_t i = 0; i < size(); ++i) {
    if (made_[i]->traits().lead > 0) leading.push_back(i);
  }
  std::ranges::sort(leading, {}, [&](std::size_t i) { return made_[i]->traits().lead; });
  return leading;
}

std::vector<bool> MetricSet::applying(const Interface& spec) const {
  std::vector<bool> applying;
  for (const Made<Metric>& metric : made_) applying.push_back(metric->applies(spec));
  return applying;
}

}  // namespace gust
