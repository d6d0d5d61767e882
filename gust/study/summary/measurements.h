#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gust/store/store.h"
#include "gust/study/plan/plan.h"
#include "gust/study/trials/member_rows.h"

namespace gust {

/// The rows of some members of a policy along a sweep.
struct RowGroup {
  std::size_t policy = 0;
  std::size_t sweep = Trial::kNominal;
  std::vector<std::size_t> members = {};
};

/// The learning curve of one seed of a policy.
struct SeedCurve {
  std::size_t policy = 0;
  std::size_t member = 0;
  std::vector<CurvePoint> points = {};
};

/// Episodes that were kept whole, of one evaluation.
struct KeptTraces {
  std::size_t policy = 0;
  std::size_t member = 0;
  std::size_t sweep = Trial::kNominal;
  std::vector<Trace> traces = {};
};

/// What was measured in a study, wherever it was: statistics read this and know no files. The study must outlive it;
/// all of it may be asked from many threads at once. Names of what is not there are added to `missing`.
class Measurements {
 public:
  explicit Measurements(const Study& study) : study_(study) {}
  virtual ~Measurements() = default;
  Measurements(const Measurements&) = delete;
  Measurements& operator=(const Measurements&) = delete;

  const Study& study() const { return study_; }

  /// Every policy along every sweep that the study asks for, with all members; in the order of results.
  virtual const std::vector<RowGroup>& groups() const = 0;
  /// The same of one policy and sweep; without members where the study does not ask for it.
  RowGroup group(std::size_t policy, std::size_t sweep) const;

  /// The rows of these members side by side, without those that are not there.
  virtual MemberRows rows(const RowGroup& group, std::vector<std::string>& missing) const = 0;
  virtual bool has_rows(std::size_t policy, std::size_t sweep, std::size_t member) const = 0;

  /// `take(level, rows)` for each level beside the sweep's own that was looked at, for margins. The rows may be those
  /// of fewer members.
  virtual void for_each_added_level(std::size_t policy, std::size_t sweep,
                                    const std::function<void(double, const MemberRows&)>& take) const = 0;

  /// The learning curves that there are, in the order of results.
  virtual std::vector<SeedCurve> curves() const = 0;
  /// That of one member; none, and its name in `missing`, where it is not there.
  virtual std::optional<std::vector<CurvePoint>> curve(std::size_t policy, std::size_t member,
                                                       std::vector<std::string>& missing) const = 0;
  /// Whether the training of a member ended without a policy.
  virtual bool training_failed(std::size_t policy, std::size_t member) const = 0;
  /// Kept episodes: a choice that a page can hold.
  virtual std::vector<KeptTraces> kept() const = 0;

  /// All that the study asks for and is not there, of these policies or of all; for people.
  virtual std::vector<std::string> missing(const std::vector<std::size_t>& policies = {}) const = 0;
  /// What is wrong with policies; for people.
  virtual std::vector<std::string> notes() const = 0;

 private:
  const Study& study_;
};

/// What the trials in a store measured. The plan and the store must outlive it.
std::unique_ptr<Measurements> stored_measurements(const Study& study, const Plan& plan, const Store& store);

}  // namespace gust
