#include "gust/sim/interface.h"

#include <algorithm>

#include "gust/core/text.h"

namespace gust {
namespace {

struct ToldPart {
  bool Told::*part;
  const char* missing;
};

constexpr ToldPart kParts[] = {
    {&Told::state, "no true state"}, {&Told::goal, "no goal"},       {&Told::effort, "nothing of the actuator"},
    {&Told::force, "no forces"},     {&Told::failure, "no failure"}, {&Told::after_failure, "nothing after a failure"}};

}  // namespace

bool Told::covers(const Told& needs) const {
  return std::ranges::all_of(kParts, [&](const ToldPart& of) { return this->*of.part || !(needs.*of.part); });
}

std::string untold_text(const Told& told, const Told& needs) {
  std::vector<std::string> missing;
  for (const ToldPart& of : kParts) {
    if (needs.*of.part && !(told.*of.part)) missing.emplace_back(of.missing);
  }
  return join(missing, ", ");
}

Told Interface::told() const {
  return {.state = !state.empty(),
          .goal = !error_weights.empty(),
          .effort = tells_effort,
          .force = !force.empty(),
          .failure = fails,
          .after_failure = goes_on};
}

std::vector<double> nominal_parameters(const Interface& spec) {
  std::vector<double> values;
  for (const Parameter& parameter : spec.parameters) values.push_back(parameter.nominal);
  return values;
}

std::size_t parameter_index(const Interface& spec, const std::string& name, const Place& place) {
  std::vector<std::string> names;
  for (const Parameter& parameter : spec.parameters) names.push_back(parameter.name);
  const auto at = std::ranges::find(names, name);
  if (at == names.end()) {
    throw error_at(place, "unknown parameter '", name, "'", did_you_mean(name, names), "; the plant has ",
                   names.empty() ? "none" : join(names, ", "));
  }
  return static_cast<std::size_t>(at - names.begin());
}

}  // namespace gust
