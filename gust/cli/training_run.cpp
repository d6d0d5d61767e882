#include "gust/cli/training_run.h"

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "gust/cli/output_file.h"
#include "gust/cli/settings.h"
#include "gust/cli/text_output.h"
#include "gust/core/hash.h"
#include "gust/core/version.h"
#include "gust/onnx/onnx.h"
#include "gust/store/files.h"
#include "gust/study/plan/training_time.h"
#include "gust/study/text/agent_options.h"
#include "gust/study/text/warnings.h"

namespace gust {
namespace {

std::vector<std::string> names_of(const std::vector<FieldInfo>& fields) {
  std::vector<std::string> names;
  for (const FieldInfo& field : fields) names.push_back(field.name);
  return names;
}

struct Settings {
  Table agent, readings, plant;
  std::optional<Value> randomise;
  bool curve_as_trained = false;
};

Settings read_settings(const TrainRequest& request) {
  Settings settings;
  std::vector<std::string> of_agent = names_of(agents().at(request.agent, {"AGENT"}).fields);
  of_agent.push_back("profile");
  of_agent.push_back("randomise");
  of_agent.push_back("curve");
  const SettingGroup groups[] = {{&settings.agent, of_agent},
                                 {&settings.readings, field_names<Readings>()},
                                 {&settings.plant, names_of(plant_fields(request.plant, {"--plant"}))}};
  sort_settings(request.settings, groups, cat(" (gust describe agent ", request.agent, ")"));
  if (const Value* randomise = settings.agent.find("randomise")) settings.randomise = *randomise;
  settings.agent.erase("randomise");
  if (const Value* curve = settings.agent.find("curve")) settings.curve_as_trained = parse_curve(*curve);
  settings.agent.erase("curve");
  settings.agent.place = {"--set"};
  settings.agent.set("kind", {request.agent, {"gust"}});
  if (request.steps) settings.agent.set("steps", {*request.steps, {"--steps"}});
  settings.plant.place = {"--plant"};
  settings.plant.set("kind", {request.plant, {"--plant"}});
  set_preset(settings.plant, request.preset, {"--preset"});
  return settings;
}

}  // namespace

TrainingRun::TrainingRun(const TrainRequest& request) : out_(request.out), seed_(request.seed) {
  if (!out_.ends_with(".onnx")) throw Error(cat("--out: '", out_, "' must end in .onnx"));
  check_output(out_, OutputKind::onnx, "--out", request.force);
  if (is_stream(out_)) throw Error(cat("--out: '", out_, "' is no regular file; choose another"));
  const Settings settings = read_settings(request);
  setup_ = make_setup(settings.plant, &settings.readings);
  const Plant& plant = setup_.equations("a training", {"--plant"});
  agent_ = make_agent(settings.agent, setup_);
  agent_->check(plant.spec(), {"gust train"});
  if (settings.randomise) randomised_ = parse_randomise(*settings.randomise, setup_);
  const std::string drawn = randomised_.canonical(setup_.plant->spec());
  identity_ =
      hash_hex(cat("gust ", kVersion, "\n", agent_.canonical(), "\n", setup_.preset, "\n", setup_.plant.canonical(),
                   "\n", canonical_fields(setup_.readings), "\nseed ", seed_, drawn.empty() ? "" : "\nrandomise ",
                   drawn, settings.curve_as_trained ? "\ncurve training" : ""));
  const std::string checkpoint = request.out + ".checkpoint";
  remove_left_aside(checkpoint);
  checkpoint_ = checkpoint_file(checkpoint, identity_);
  AtomicFile probe(out_);  // the folder can be written, or this throws; the old file stays as it was
  training_ = begin_training(
      *agent_, {&plant, setup_.readings, {}, seed_, randomised_.draws, settings.curve_as_trained}, *checkpoint_);
}

std::vector<std::string> TrainingRun::warnings() const {
  std::vector<std::string> warnings = plant_warnings(setup_);
  std::ranges::move(draw_warnings(setup_, randomised_), std::back_inserter(warnings));
  return warnings;
}

TrainingRun::End TrainingRun::go(const std::stop_token& stop, const std::function<void(double)>& tell_share) {
  if (!train_to_end(*training_, *checkpoint_, stop, tell_share, tell)) return End::stopped;
  const bool failed = !training_->failure().empty();
  try {
    if (!failed) write_policy();
  } catch (const Error&) {
    keep_checkpoint(*training_, *checkpoint_, tell);
    throw;
  }
  checkpoint_->remove();
  return failed ? End::failed : End::done;
}

double TrainingRun::predicted_seconds() const { return training_seconds(*agent_.object, *setup_.plant); }

double TrainingRun::last_score() const {
  const std::vector<CurvePoint>& curve = training_->curve();
  return curve.empty() ? std::numeric_limits<double>::quiet_NaN() : curve.back().anr_h;
}

void TrainingRun::write_policy() const {
  const OnnxMetadata metadata = {{"gust.plant", setup_.plant.kind},
                                 {"gust.preset", setup_.preset},
                                 {"gust.units", setup_.plant->spec().action_unit()},
                                 {"gust.seed", cat(seed_)},
                                 {"gust.version", std::string(kVersion)},
                                 {"gust.trial", identity_}};
  write_file_atomically(out_, write_onnx(training_->actor(), metadata));
}

}  // namespace gust
