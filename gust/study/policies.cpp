#include "gust/study/policies.h"

#include "gust/control/cascade.h"
#include "gust/control/lqr.h"
#include "gust/core/text.h"

namespace gust {
namespace {

std::string names_of(const std::vector<Component>& components) {
  std::vector<std::string> names;
  for (const Component& component : components) names.push_back(component.name);
  return join(names, ", ");
}

void check_sizes(const OnnxModel& model, std::string_view name, const Setup& setup) {
  const PlantSpec& spec = setup.plant->spec();
  if (model.observations() != spec.observations()) {
    throw Error(cat(name, ": the policy takes ", model.observations(), " numbers; the plant ", setup.plant.kind,
                    " is observed by ", spec.observations(), " (", names_of(spec.state), ")"));
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

}  // namespace

std::unique_ptr<Policy> make_policy(std::string_view kind, const Setup& setup, const Place& place) {
  const PlantSpec& spec = setup.plant->spec();
  if (kind == "zero") return zero_policy(spec.observations(), spec.action.size());
  if (kind == "lqr") return lqr_policy(*setup.plant, reward_weights(spec));
  if (kind == "pd" && spec.cascade) return cascade_policy(*setup.plant, *spec.cascade);
  if (kind == "pd") {
    throw error_at(place, "the plant ", setup.plant.kind, " has no policy 'pd'; try lqr or zero");
  }
  const std::vector<std::string> names = {"lqr", "zero", "pd"};
  throw error_at(place, "unknown policy '", kind, "'", did_you_mean(kind, names),
                 "; policies are lqr, pd, zero, or a file", " that ends in .onnx");
}

std::unique_ptr<Policy> onnx_policy(std::string_view bytes, std::string_view name, const Setup& setup,
                                    const PolicyUse& use) {
  const std::optional<float> alpha = use.alpha ? std::optional(static_cast<float>(*use.alpha)) : std::nullopt;
  OnnxModel model = read_onnx(bytes, name, {.alpha = alpha, .output = use.output, .data = use.data});
  check_sizes(model, name, setup);
  check_metadata(model, name, setup);
  return network_policy(std::move(model), use.arithmetic);
}

}  // namespace gust
