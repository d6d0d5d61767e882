#pragma once

#include <optional>
#include <string>

#include "gust/store/store.h"
#include "gust/study/plan/plan.h"

namespace gust {

/// How much of a trial is read when its content is checked: headers and short files, or every byte.
enum class CheckDepth { quick, whole };

/// What is wrong with the content of a trial whose hashes are right; empty if nothing is. Kinds of other versions are
/// not known and pass.
std::string content_damage(const StoredTrial& stored, CheckDepth depth);

/// The same of a trial of a plan, which also says how many cells, starts and episodes there must be.
std::string content_damage(const Plan& plan, const Trial& trial, const StoredTrial& stored, CheckDepth depth);

/// A finished trial of a plan whose content is right too; one that is wrong is told, moved away where the store is open
/// for writing, and counts as missing.
std::optional<StoredTrial> load_trial(const Plan& plan, const Trial& trial, const Store& store,
                                      CheckDepth depth = CheckDepth::quick);

/// The trials of a plan that the store lacks, in plan order, and what the plan itself lacks; for people. This is what
/// every reading command lists, and why it exits with 1.
std::vector<std::string> missing_trials(const Plan& plan, const Store& store);

}  // namespace gust
