#include "gust/study/policies/file_policy.h"

#include <algorithm>
#include <cmath>

#include "gust/core/text.h"

namespace gust {
namespace {

std::string names_of(const std::vector<Component>& components) {
  std::vector<std::string> names;
  for (const Component& component : components) names.push_back(component.name);
  return join(names, ", ");
}

void check_sizes(const OnnxModel& model, std::string_view name, const Setup& setup, const PolicyUse& use) {
  const Interface& spec = setup.plant->spec();
  const std::size_t observed = use.interface.observe.size();
  if (observed > 0 && model.observations() != observed) {
    throw Error(cat(name, ": the policy takes ", model.observations(), " numbers; 'observe' gives ", observed));
  }
  if (observed == 0 && model.observations() != spec.observations()) {
    throw Error(cat(name, ": the policy takes ", model.observations(), " numbers; the plant ", setup.plant.kind,
                    " is observed by ", spec.observations(), " (", names_of(observed_components(spec)),
                    "); 'observe' says which of them it takes"));
  }
  if (model.actions() == 2 * spec.action.size()) {
    throw Error(
        cat(name, ": the policy gives ", model.actions(), " numbers, twice the ", spec.action.size(),
            " that the plant ", setup.plant.kind, " takes (", names_of(spec.action),
            "): probably the mean and the log-deviation of the action, joined. Export the mean alone (output[:, :",
            spec.action.size(), "] of the network), or choose another output of the file"));
  }
  if (model.actions() != spec.action.size()) {
    throw Error(cat(name, ": the policy gives ", model.actions(), " numbers; the plant ", setup.plant.kind, " takes ",
                    spec.action.size(), " (", names_of(spec.action), ")"));
  }
}

/// Our own files say what they were made for; foreign ones say nothing, and the setup decides.
void check_metadata(const OnnxModel& model, std::string_view name, const Setup& setup) {
  const auto check = [&](const char* key, std::string_view what, std::string_view wanted) {
    const auto found = model.metadata.find(key);
    if (found == model.metadata.end() || found->second == wanted) return;
    throw Error(cat(name, ": the policy was made for the ", what, " '", found->second, "' (", key,
                    " in its metadata), not for '", wanted, "'"));
  };
  check("gust.plant", "plant", setup.plant.kind);
  check("gust.preset", "preset", setup.preset);
  check("gust.units", "action unit", setup.plant->spec().action_unit());
}

/// "; of 100 actions at random starts 82 lie beyond -1 to 1, …" where more than a tenth do: they may be in another
/// unit.
std::string beyond_box(Policy& policy, const Setup& setup) {
  constexpr std::size_t kStarts = 100;
  const Interface& spec = setup.plant->spec();
  const std::unique_ptr<Loop> loop = setup.plant->make({}, kStarts);
  for (std::size_t lane = 0; lane < kStarts; ++lane)
    loop->begin(lane, {.state = setup.plant->start_state(random_starts(), Rng(0).split("unit").split(lane)),
                       .parameters = nominal_parameters(spec),
                       .levels = {},
                       .signals = nullptr});
  Matrix<double> action(spec.action.size(), kStarts);
  policy.act(loop->observation(), loop->steps_done(), action.view());
  std::size_t beyond = 0;
  double greatest = 0;
  for (std::size_t lane = 0; lane < kStarts; ++lane) {
    double size = 0;
    for (std::size_t i = 0; i < action.rows(); ++i) size = std::max(size, std::abs(action.at(i, lane)));
    beyond += size > 1 ? 1 : 0;
    greatest = std::max(greatest, size);
  }
  if (beyond <= kStarts / 10) return {};
  return cat("; of ", kStarts, " actions at random starts ", beyond, " lie beyond -1 to 1 (up to ",
             format("{:.3g}", greatest), "), as ", spec.action.front().unit, " would");
}

/// "force = 10 N times action"
std::string action_law(const Interface& spec, std::size_t i) {
  const std::string offset = spec.action_offset[i] == 0 ? "" : format("{:.4g} + ", spec.action_offset[i]);
  return format("{} = {}{:.4g} {} times action", spec.action[i].name, offset, spec.action_scale[i],
                spec.action[i].unit);
}

/// What is assumed of a unit that nobody says.
std::string assumed_unit(Policy& policy, const Setup& setup) {
  const Interface& spec = setup.plant->spec();
  return cat(" does not say the unit of its actions: they are taken as normalised (", action_law(spec, 0), ")",
             beyond_box(policy, setup), ". Say units = \"normalised\" or units = \"", spec.action.front().unit,
             "\" (--units)");
}

}  // namespace

std::string level_text(const std::optional<double>& alpha) {
  return alpha ? cat("alpha ", canonical_text(*alpha), "\n") : std::string();
}

FilePolicy file_policy(std::string_view bytes, std::string_view name, const Setup& setup, const PolicyUse& use) {
  const std::optional<float> alpha = use.alpha ? std::optional(static_cast<float>(*use.alpha)) : std::nullopt;
  OnnxModel model = read_onnx(bytes, name, {.alpha = alpha, .output = use.output, .data = use.data});
  const Interface& spec = setup.plant->spec();
  check_sizes(model, name, setup, use);
  check_metadata(model, name, setup);
  if (model.metadata.contains("gust.units") && !use.interface.act.empty())
    throw Error(cat(name, ": its metadata say the unit of its actions; leave 'act' and 'units' out"));
  FilePolicy file;
  file.foreign = !model.metadata.contains("gust.plant");
  const bool said = use.interface.says_unit || model.metadata.contains("gust.units");
  file.policy = translated_policy(network_policy(std::move(model), use.arithmetic), use.interface, spec);
  if (spec.normalized_action && !said) file.unit_warning = cat(name, assumed_unit(*file.policy, setup));
  return file;
}

std::unique_ptr<Policy> onnx_policy(std::string_view bytes, std::string_view name, const Setup& setup,
                                    const PolicyUse& use) {
  return std::move(file_policy(bytes, name, setup, use).policy);
}

std::string interface_hint(const Interface& spec) {
  const std::vector<Component>& seen = spec.measured();
  const Component& turned = seen[std::min(spec.angle, seen.size() - 1)];
  const std::string degrees = turned.unit == "rad" ? cat("{ ", turned.name, " = \"deg\" }, ") : "";
  std::vector<Component> action = spec.action;
  for (Component& component : action) component.unit = spec.action_unit();
  return cat("look at the order, sign and unit of what it observes and gives. gust gives it ",
             components_text(observed_components(spec)), " and takes ", components_text(action), "; observe = [\"",
             seen.back().name, "\", \"-", turned.name, "\", ", degrees,
             "…] and act = { scale = -1 } say otherwise (--observe, --act)");
}

}  // namespace gust
