#include "gust/control/policy_interface.h"

#include <algorithm>
#include <cmath>

#include "gust/core/math.h"
#include "gust/core/text.h"
#include "gust/core/units.h"

namespace gust {
namespace {

constexpr std::size_t kMostNumbers = 4096;
constexpr std::string_view kNormalised = "normalised";
constexpr std::string_view kPercent = "%";

using Form = ObservedNumber::Form;

std::string form_name(Form form) { return form == Form::kSin ? "sin " : form == Form::kCos ? "cos " : ""; }

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

/// Takes a word from the front if it is there.
bool take(std::string_view& text, std::string_view word) {
  if (!text.starts_with(word)) return false;
  text = trimmed(text.substr(word.size()));
  return true;
}

/// "-theta", "cos theta": which component, and its sign.
ObservedNumber read_name(std::string_view text, const Interface& spec, const Place& place) {
  ObservedNumber number;
  std::string_view rest = trimmed(text);
  if (take(rest, "-")) number.scale = -1;
  if (take(rest, "sin ")) number.form = Form::kSin;
  if (number.form == Form::kPlain && take(rest, "cos ")) number.form = Form::kCos;
  std::vector<std::string> names;
  for (const Component& component : observed_components(spec)) names.push_back(component.name);
  const auto at = std::ranges::find(names, rest);
  if (at == names.end()) {
    throw error_at(place, "'observe': unknown component '", rest, "'", did_you_mean(rest, names), "; components are ",
                   join(names, ", "));
  }
  number.component = static_cast<std::size_t>(at - names.begin());
  const std::string unit = observed_components(spec)[*number.component].unit;
  if (number.form != Form::kPlain && unit != "rad")
    throw error_at(place, "'observe': sin and cos are of angles; ", rest, " is in ", unit);
  return number;
}

void apply_unit(ObservedNumber& number, const Value& unit, const Interface& spec) {
  const Component component = observed_components(spec)[*number.component];
  if (number.form != Form::kPlain)
    throw error_at(unit.place, "'observe': a ", form_name(number.form), "has no unit; give a scale if you need one");
  number.scale *= units_in(unit.as_text("unit"), component.unit, component.name, unit.place);
}

double read_scale(const Value& value) {
  const double scale = value.as_number("scale");
  if (scale == 0) throw error_at(value.place, "'scale' must not be 0");
  return scale;
}

/// What stands beside a component's name: a unit, a scale, or a table of both.
void read_measure(ObservedNumber& number, const Value& measure, const Interface& spec) {
  if (measure.is_number()) {
    number.scale *= read_scale(measure);
  } else if (std::holds_alternative<std::string>(measure.data)) {
    apply_unit(number, measure, spec);
  } else {
    const Table& table = measure.as_table("observe");
    check_keys(table, {"unit", "scale", "offset"}, "an observed component");
    if (const Value* unit = table.find("unit")) apply_unit(number, *unit, spec);
    if (const Value* scale = table.find("scale")) number.scale *= read_scale(*scale);
    if (const Value* offset = table.find("offset")) number.offset = offset->as_number("offset");
  }
}

ObservedNumber read_observed(const Value& item, const Interface& spec) {
  if (item.is_number()) return {.scale = 0, .offset = item.as_number("observe")};
  if (const auto* text = std::get_if<std::string>(&item.data)) {
    const std::size_t equals = text->find('=');
    ObservedNumber number = read_name(text->substr(0, equals), spec, item.place);
    if (equals != text->npos) read_measure(number, value_from_text(text->substr(equals + 1), item.place), spec);
    return number;
  }
  const Table& table = item.as_table("observe");
  if (table.items.size() != 1) {
    throw error_at(item.place, "'observe': one component in each pair of braces, such as { theta = \"deg\" }, got ",
                   table.items.size());
  }
  ObservedNumber number = read_name(table.items.front().first, spec, item.place);
  read_measure(number, table.items.front().second, spec);
  return number;
}

std::vector<ObservedNumber> read_observe(const Value& value, const Interface& spec) {
  const bool one = std::holds_alternative<std::string>(value.data);
  const Value::List list = one ? Value::List{value} : value.as_list("observe");
  if (list.empty() || list.size() > kMostNumbers) {
    throw error_at(value.place, "'observe' must name 1 to ", kMostNumbers, " components, got ", list.size());
  }
  std::vector<ObservedNumber> observe;
  for (const Value& item : list) observe.push_back(read_observed(item, spec));
  if (std::ranges::none_of(observe, [](const ObservedNumber& number) { return number.component.has_value(); }))
    throw error_at(value.place, "'observe' must name at least one component");
  return observe;
}

/// The action of the preset, of one that a policy gives in a unit.
GivenNumber in_unit(const GivenNumber& given, const Value& unit, const Interface& spec, std::size_t action) {
  const std::string& name = unit.as_text("unit");
  const Component& input = spec.action[action];
  if (name == kNormalised || name == "normalized") {
    if (spec.normalized_action) return given;
    throw error_at(unit.place, "the preset acts in ", input.unit,
                   " and does not say what a normalised action is: give ", "act = { scale = … }, the ", input.unit,
                   " of an action of 1");
  }
  if (name == kPercent) {
    const double one = (spec.normalized_action ? 1.0 : spec.action_high[action]) / 100;
    return {given.scale * one, given.offset * one};
  }
  const double per_newton = units_in(name, input.unit, cat("the action ", input.name), unit.place);
  const GivenNumber physical = {given.scale / per_newton, given.offset / per_newton};
  if (!spec.normalized_action) return physical;
  const double range = spec.action_scale[action];
  return {physical.scale / range, (physical.offset - spec.action_offset[action]) / range};
}

/// `act` and `units`, which say the same of the unit.
std::vector<GivenNumber> read_act(const Value* act, const Value* units, const Interface& spec) {
  GivenNumber given;
  const Value* unit = units;
  if (act != nullptr) {
    const auto* table = std::get_if<Table>(&act->data);
    if (table != nullptr) {
      check_keys(*table, {"unit", "scale", "offset"}, "'act'");
      if (const Value* scale = table->find("scale")) given.scale = read_scale(*scale);
      if (const Value* offset = table->find("offset")) given.offset = offset->as_number("offset");
    }
    const Value* own = table ? table->find("unit") : act;
    if (own != nullptr && units != nullptr)
      throw error_at(units->place, "'units' and the unit of 'act' say the same; give one of them");
    if (own != nullptr) unit = own;
  }
  std::vector<GivenNumber> numbers(spec.action.size(), given);
  for (std::size_t i = 0; unit != nullptr && i < numbers.size(); ++i) numbers[i] = in_unit(given, *unit, spec, i);
  const bool same = std::ranges::all_of(numbers, [](const GivenNumber& number) { return number == GivenNumber{}; });
  return same ? std::vector<GivenNumber>() : numbers;
}

/// Whether it is what gust observes, in its order.
bool is_own(const std::vector<ObservedNumber>& observe, const Interface& spec) {
  if (observe.size() != spec.observations()) return false;
  for (std::size_t i = 0; i < observe.size(); ++i) {
    if (observe[i] != ObservedNumber{.component = i}) return false;
  }
  return true;
}

class TranslatedPolicy final : public Policy {
 public:
  TranslatedPolicy(std::unique_ptr<Policy> policy, const PolicyInterface& interface, const Interface& spec)
      : policy_(std::move(policy)), interface_(interface), observations_(spec.observations()) {}

  std::size_t observations() const override { return observations_; }
  std::size_t actions() const override { return policy_->actions(); }
  std::vector<Component> memory() const override { return policy_->memory(); }
  Rows<const double> remembered() const override { return policy_->remembered(); }

  void act(Rows<const double> observation, std::span<const std::int64_t> step, Rows<double> action) override {
    if (interface_.observe.empty()) {
      policy_->act(observation, step, action);
    } else {
      if (seen_.lanes() != observation.lanes) seen_ = Matrix<double>(interface_.observe.size(), observation.lanes);
      for (std::size_t i = 0; i < interface_.observe.size(); ++i) see(interface_.observe[i], observation, seen_.row(i));
      policy_->act(seen_.view(), step, action);
    }
    for (std::size_t i = 0; i < interface_.act.size(); ++i) {
      const GivenNumber& number = interface_.act[i];
      for (std::size_t lane = 0; lane < action.lanes; ++lane)
        action.at(i, lane) = number.scale * action.at(i, lane) + number.offset;
    }
  }

 private:
  static void see(const ObservedNumber& number, Rows<const double> from, std::span<double> to) {
    for (std::size_t lane = 0; lane < from.lanes; ++lane) {
      double value = number.component ? from.at(*number.component, lane) : 0.0;
      if (number.form == Form::kSin) value = sin_cos(value).sin;
      if (number.form == Form::kCos) value = sin_cos(value).cos;
      to[lane] = number.scale * value + number.offset;
    }
  }

  std::unique_ptr<Policy> policy_;
  PolicyInterface interface_;
  std::size_t observations_;
  Matrix<double> seen_;
};

}  // namespace

std::string PolicyInterface::canonical(const Interface& spec) const {
  const std::vector<Component> components = observed_components(spec);
  std::string text;
  for (const ObservedNumber& number : observe) {
    text +=
        cat(text.empty() ? "observe " : ", ", form_name(number.form),
            number.component ? components[*number.component].name : "constant", " ", number.scale, " ", number.offset);
  }
  if (!text.empty()) text += "\n";
  for (std::size_t i = 0; i < act.size(); ++i) text += cat(i == 0 ? "act " : ", ", act[i].scale, " ", act[i].offset);
  return act.empty() ? text : text + "\n";
}

std::vector<Component> observed_components(const Interface& spec) {
  std::vector<Component> components = spec.measured();
  for (std::size_t ahead = 1; ahead <= spec.horizon; ++ahead) {
    for (const Component& measured : spec.measured())
      components.push_back({cat(measured.name, "_ref", ahead == 1 ? std::string() : cat(ahead)), measured.unit});
  }
  return components;
}

PolicyInterface read_interface(const Table& table, const Interface& spec) {
  PolicyInterface interface;
  const Value* observe = table.find("observe");
  if (observe != nullptr) interface.observe = read_observe(*observe, spec);
  if (is_own(interface.observe, spec)) interface.observe.clear();
  const Value* act = table.find("act");
  const Value* units = table.find("units");
  interface.says_unit = act != nullptr || units != nullptr;
  interface.act = read_act(act, units, spec);
  return interface;
}

NamedUnits read_units(const Value* units, const Interface& spec) {
  NamedUnits named{std::vector<double>(spec.state.size(), 1.0), std::vector<GivenNumber>(spec.action.size())};
  if (units == nullptr) return named;
  const auto set_action = [&](std::size_t i, const Value& unit) {
    const GivenNumber preset = in_unit({}, unit, spec, i);
    named.action[i] = {spec.action_scale[i] * preset.scale,
                       spec.action_offset[i] + spec.action_scale[i] * preset.offset};
  };
  if (std::holds_alternative<std::string>(units->data)) {
    for (std::size_t i = 0; i < spec.action.size(); ++i) set_action(i, *units);
    return named;
  }
  std::vector<std::string> names;
  for (const auto* components : {&spec.state, &spec.action})
    for (const Component& component : *components) names.push_back(component.name);
  for (const auto& [name, unit] : units->as_table("units").items) {
    const auto at = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    if (at == names.size())
      throw error_at(unit.place, "'units': unknown component '", name, "'", did_you_mean(name, names),
                     "; states and actions are ", join(names, ", "));
    if (at < spec.state.size())
      named.state[at] = units_in(unit.as_text(name), spec.state[at].unit, name, unit.place);
    else
      set_action(at - spec.state.size(), unit);
  }
  return named;
}

std::unique_ptr<Policy> translated_policy(std::unique_ptr<Policy> policy, const PolicyInterface& interface,
                                          const Interface& spec) {
  if (interface.observe.empty() && interface.act.empty()) return policy;
  return std::make_unique<TranslatedPolicy>(std::move(policy), interface, spec);
}

std::string components_text(const std::vector<Component>& components) {
  std::vector<std::string> parts;
  for (const Component& component : components) parts.push_back(cat(component.name, " [", component.unit, "]"));
  return join(parts, ", ");
}

}  // namespace gust
