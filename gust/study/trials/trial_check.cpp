#include "gust/study/trials/trial_check.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "gust/core/text.h"
#include "gust/onnx/onnx.h"
#include "gust/store/files_posix.h"
#include "gust/store/rows.h"
#include "gust/study/trials/margin_trial.h"
#include "gust/study/trials/trials.h"

namespace gust {
namespace {

void need(const StoredTrial& stored, std::string_view file) {
  if (!stored.contains(file)) throw Error(cat("it has no '", file, "'"));
}

/// Whether two names may be of one start: trials are named by what they do, and one state can be spelled in many ways.
bool may_be_one_start(const std::string& name, const StartProtocol& start) {
  if (name == start.name) return true;
  const bool spells_state = name == "nominal" || name.find('=') != std::string::npos;
  return !start.random && spells_state;
}

/// What is wrong with rows for so many cells; 0 if any number will do.
void check_rows(const StoredTrial& stored, const std::string& file, const Plan* plan, std::uint64_t cells,
                CheckDepth depth) {
  need(stored, file);
  std::ifstream stream = stored.open(file);
  const RowsHeader header = skim_rows(stream, file);
  if (cells > 0 && header.cells != cells) throw Error(cat(file, ": has ", header.cells, " cells, not ", cells));
  if (plan != nullptr && !plan->starts.empty()) {
    if (header.episodes != plan->episodes)
      throw Error(cat(file, ": has ", header.episodes, " episodes, not ", plan->episodes));
    if (!std::ranges::equal(header.starts, plan->starts, may_be_one_start))
      throw Error(cat(file, ": its starts are ", join(header.starts, ", "), ", which are not the study's"));
  }
  if (depth == CheckDepth::quick) return;
  stream.clear();
  stream.seekg(0);
  RowsReader rows(stream, file);
  while (!rows.next().empty()) continue;
}

void check_train(const StoredTrial& stored, CheckDepth depth) {
  need(stored, kCurveFile);
  read_curve(stored.read(kCurveFile), kCurveFile);
  if (stored.contains(kFailureFile)) return;
  need(stored, kPolicyFile);
  if (depth == CheckDepth::whole) read_onnx(stored.read(kPolicyFile), kPolicyFile);
}

void check_evaluate(const StoredTrial& stored, const Plan* plan, std::uint64_t cells, CheckDepth depth) {
  check_rows(stored, std::string(kRowsFile), plan, cells, depth);
  need(stored, kTracesFile);
  if (depth == CheckDepth::whole) read_traces(stored.read(kTracesFile), kTracesFile);
}

void check_margin(const StoredTrial& stored, const Plan* plan, CheckDepth depth) {
  const std::vector<std::vector<double>> rounds = margin_levels(stored);
  for (std::size_t round = 0; round < rounds.size(); ++round) {
    std::size_t member = 0;
    do check_rows(stored, margin_rows_file(round, member), plan, rounds[round].size(), depth);
    while (stored.contains(margin_rows_file(round, ++member)));
  }
}

std::string damage(const StoredTrial& stored, const Plan* plan, std::uint64_t cells, CheckDepth depth) try {
  const std::string& kind = stored.manifest.kind;
  if (kind == kind_name(Trial::Kind::kTrain)) check_train(stored, depth);
  if (kind == kind_name(Trial::Kind::kSearch)) read_level(stored);
  if (kind == kind_name(Trial::Kind::kEvaluate)) check_evaluate(stored, plan, cells, depth);
  if (kind == kind_name(Trial::Kind::kMargin)) check_margin(stored, plan, depth);
  return "";
} catch (const std::bad_alloc&) {
  throw;
} catch (const FileError& error) {
  if (!error.is_about_file()) throw;  // the machine could not look; the trial may be right
  return error.what();
} catch (const std::exception& error) {
  return error.what();
}

}  // namespace

std::string content_damage(const StoredTrial& stored, CheckDepth depth) { return damage(stored, nullptr, 0, depth); }

std::string content_damage(const Plan& plan, const Trial& trial, const StoredTrial& stored, CheckDepth depth) {
  return damage(stored, &plan, trial.cells, depth);
}

std::optional<StoredTrial> load_trial(const Plan& plan, const Trial& trial, const Store& store, CheckDepth depth) {
  std::optional<StoredTrial> stored = store.load(kind_name(trial.kind), trial.id);
  if (!stored) return std::nullopt;
  const std::string damage = content_damage(plan, trial, *stored, depth);
  if (damage.empty()) return stored;
  store.condemn(*stored, damage);
  return std::nullopt;
}

std::vector<std::string> missing_trials(const Plan& plan, const Store& store) {
  std::vector<std::string> missing;
  for (const Trial& trial : plan.trials) {
    if (!load_trial(plan, trial, store)) missing.push_back(trial.what);
  }
  if (!plan.complete) missing.emplace_back("what needs automatic levels that were not found");
  return missing;
}

}  // namespace gust
