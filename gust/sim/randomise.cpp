#include "gust/sim/randomise.h"

#include <algorithm>

namespace gust {
namespace {

/// A range that leaves a bound to a default would be a surprise: all of it is said.
Made<Distribution> read_distribution(const std::string& name, const Value& value) {
  Table table = value.as_table(name);
  if (!table.contains("kind")) table.set("kind", {std::string("uniform"), table.place});
  const Value& kind = *table.find("kind");
  const Entry<Distribution>& entry = distributions().at(kind.as_text("kind"), kind.place);
  Made<Distribution> made = entry.make(table);
  for (const FieldInfo& field : entry.fields) {
    if (!table.contains(field.name)) throw error_at(value.place, "'", name, "' needs '", field.name, "': ", field.help);
  }
  return made;
}

}  // namespace

Randomisation read_randomisation(const Table& table, const Interface& spec) {
  std::string mode = "absolute";
  if (const Value* value = table.find("mode")) read_value(mode, *value, "mode", one_of("absolute|additive"));
  Randomisation randomisation;
  for (const auto& [name, value] : table.items) {
    if (name == "mode") continue;
    ParameterDraw draw{parameter_index(spec, name, value.place), read_distribution(name, value), 0};
    const double nominal = spec.parameters[draw.parameter].nominal;
    if (mode == "additive") draw.offset = nominal;
    const double least = draw.offset + draw.distribution->low();
    if (!(least > 0)) {
      throw error_at(value.place, "'", name, "' must stay > 0, got a least value of ", least,
                     mode == "additive" ? cat(" (", nominal, " and the draw)") : "");
    }
    randomisation.draws.push_back(std::move(draw));
  }
  if (randomisation.draws.empty()) {
    throw error_at(table.place, "'randomise' must name a parameter, such as ", spec.parameters.front().name,
                   " = { low = ", 0.5 * spec.parameters.front().nominal,
                   ", high = ", 2 * spec.parameters.front().nominal, " }");
  }
  // Equal draws are one text, in whatever order they were written.
  std::ranges::sort(randomisation.draws, {}, &ParameterDraw::parameter);
  return randomisation;
}

std::string Randomisation::canonical(const Interface& spec) const {
  std::string text;
  for (const ParameterDraw& draw : draws) {
    text += cat(text.empty() ? "" : ", ", spec.parameters[draw.parameter].name, " = ", canonical_text(draw.offset),
                " + ", draw.distribution.canonical());
  }
  return text;
}

std::string Randomisation::label(const Interface& spec) const {
  if (!name.empty()) return name;
  std::vector<std::string> names;
  for (const ParameterDraw& draw : draws) names.push_back(spec.parameters[draw.parameter].name);
  return join(names, ", ");
}

std::vector<double> draw_parameters(std::span<const ParameterDraw> draws, const Interface& spec, const Rng& episode) {
  std::vector<double> values = nominal_parameters(spec);
  const Rng rng = episode.split("parameters");
  for (const ParameterDraw& draw : draws) {
    values[draw.parameter] = draw.offset + draw.distribution->draw(rng.split(spec.parameters[draw.parameter].name));
  }
  return values;
}

}  // namespace gust
