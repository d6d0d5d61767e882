#pragma once

#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gust/core/rows.h"
#include "gust/store/rows.h"
#include "gust/store/store.h"
#include "gust/study/plan/plan.h"

namespace gust {

/// The evaluations of one policy's members over one sweep.
struct TrialGroup {
  std::size_t policy = 0;
  std::size_t sweep = Trial::kNominal;
  std::vector<std::size_t> trials;
};

/// All of a plan, in its order.
std::vector<TrialGroup> trial_groups(const Plan& plan);

/// Whether all episodes from a start are the same one: neither start nor disturbance is random.
bool episodes_repeat(const Study& study, std::size_t sweep, std::size_t start);

/// The rows of several members of a policy, read cell by cell side by side.
class MemberRows {
 public:
  /// Adds to `missing` what the store lacks.
  MemberRows(const Plan& plan, const TrialGroup& group, const Store& store, std::vector<std::string>& missing);

  /// The rows files of one trial, a member each.
  MemberRows(const StoredTrial& stored, const std::vector<std::string>& files);

  std::size_t members() const { return readers_.size(); }
  const RowsHeader& header(std::size_t member = 0) const { return readers_[member].header(); }
  /// All values of the cell at hand of one member, in the order of the header.
  std::span<const double> cell(std::size_t member) const { return cells_[member]; }

  /// Reads the next cell of every member; false after the last.
  bool next();

  /// Whether a metric was measured of all members: rows that another version stored may lack it.
  bool has(std::string_view metric) const;
  /// One metric that there is, from one start: members x episodes, or one episode where all are the same one. Of a
  /// quotient what each episode contributes to it (quotient_values).
  Matrix<double> values(std::size_t start, std::string_view metric, bool repeats) const;

 private:
  std::vector<std::unique_ptr<std::ifstream>> streams_;
  std::string remedy_;  ///< of damaged rows
  std::vector<RowsReader> readers_;
  std::vector<std::span<const double>> cells_;
};

}  // namespace gust
