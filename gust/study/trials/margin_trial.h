#pragma once

#include "gust/stats/margin.h"
#include "gust/study/trials/executor.h"
#include "gust/study/trials/member_rows.h"

namespace gust {

/// The scores from which the margins of one policy along one sweep are measured, one curve a start. The undisturbed
/// scores come first.
class MarginScores {
 public:
  MarginScores(const Study& study, std::size_t sweep) : study_(study), sweep_(sweep) {}

  /// From the rows of the policy's undisturbed trial.
  void take_undisturbed(MemberRows rows);
  /// From the cell at hand of rows along the sweep.
  void take(double level, const MemberRows& rows);
  /// From one start's scores at a level: members x episodes, or one episode where all are the same one.
  void take(double level, std::size_t start, Cell scores);

  /// The curve from a start. Where the sweep itself changes nothing else, level 0 is the undisturbed case.
  const MarginCurve& curve(std::size_t start) const { return curves_[start]; }
  /// The margin from a start, with the reason where it is none or 0.
  Margin margin(std::size_t start) const;
  /// Whether no start has a margin, whatever the levels show.
  bool hopeless() const;

 private:
  const Study& study_;
  std::size_t sweep_;
  std::vector<MarginCurve> curves_;
  std::vector<std::string> obstacles_;  ///< by start
};

/// Why there is no margin along a sweep from a start whatever its levels show, from the cell at hand of the undisturbed
/// rows; empty if there may be one.
std::string margin_obstacle(const Study& study, std::size_t sweep, const MemberRows& undisturbed, std::size_t start);
/// Why no policy has a margin along a sweep with these levels; empty if there may be one.
std::string levels_obstacle(const Sweep& sweep);
/// Why a policy has none of whose undisturbed episodes this share lasts to the end; empty if there may be one.
std::string survival_obstacle(double share);

/// Looks at more levels until no margin moves any more, from all starts at once, and stores the rows of all of them.
Outcome run_margin(const Study& study, const Plan& plan, const Trial& trial, const Store& store, std::stop_token stop,
                   ProgressSink& progress);

/// Where the rows of a round and a member lie in a margin's trial, and the levels of its rounds; an Error if they
/// cannot be read.
std::string margin_rows_file(std::size_t round, std::size_t member);
std::vector<std::vector<double>> margin_levels(const StoredTrial& stored);

/// The rows of the levels that a margin's trial looked at beside the study's own: `take(level, rows)` for each, in the
/// order of looking.
void for_each_margin_level(const Study& study, const Trial& trial, const StoredTrial& stored,
                           const std::function<void(double, const MemberRows&)>& take);

}  // namespace gust
