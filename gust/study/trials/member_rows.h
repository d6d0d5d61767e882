#pragma once

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

/// The cells of one member along a sweep, one after the other.
class CellSource {
 public:
  virtual ~CellSource() = default;
  virtual const RowsHeader& header() const = 0;
  /// The next cell, valid until the next call; empty after the last one.
  virtual std::span<const double> next() = 0;
};

/// The rows of several members of a policy along a sweep, read cell by cell side by side.
class MemberRows {
 public:
  /// `repeats` says of each start whether all its episodes are the same one.
  MemberRows(std::vector<std::unique_ptr<CellSource>> members, std::vector<bool> repeats)
      : sources_(std::move(members)), repeats_(std::move(repeats)) {}

  std::size_t members() const { return sources_.size(); }
  const RowsHeader& header(std::size_t member = 0) const { return sources_[member]->header(); }
  /// Whether all episodes from a start are the same one.
  bool repeats(std::size_t start) const { return repeats_[start]; }
  /// All values of the cell at hand of one member, in the order of the header.
  std::span<const double> cell(std::size_t member) const { return cells_[member]; }

  /// Reads the next cell of every member; false after the last.
  bool next();

  /// Whether a metric was measured of all members: rows that another version stored may lack it.
  bool has(std::string_view metric) const;
  /// One metric that there is, from one start: members x episodes, or one episode where all are the same one. Of a
  /// quotient what each episode contributes to it (quotient_values).
  Matrix<double> values(std::size_t start, std::string_view metric) const;

 private:
  std::vector<std::unique_ptr<CellSource>> sources_;
  std::vector<bool> repeats_;
  std::vector<std::span<const double>> cells_;
};

/// The rows of evaluations in a store; what it lacks is added to `missing`.
MemberRows stored_rows(const Study& study, const Plan& plan, const TrialGroup& group, const Store& store,
                       std::vector<std::string>& missing);
/// The rows files of one trial along a sweep, a member each.
MemberRows stored_rows(const Study& study, std::size_t sweep, const StoredTrial& stored,
                       const std::vector<std::string>& files);

}  // namespace gust
