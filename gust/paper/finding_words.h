#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "gust/core/value.h"

namespace gust {

/// The words of a finding that results are measured for. {name} in them stands for a number of the measurement, or for
/// a piece that is said only where the measurement has the fact of its name.
struct PaperFinding {
  std::string measure;  ///< "early failure"; see below
  std::string says;
  std::map<std::string, std::string> pieces;  ///< by fact
};

/// What was measured for a finding.
struct Measured {
  std::map<std::string, std::string> numbers;  ///< as a sentence has them
  std::set<std::string> facts;
};

/// One of [[finding]] in findings.toml:
///
///     trainings        how much was run: {trainings}, {agents}, {readings}
///     early failure    episodes that practically all fail: {cells}, their {return_over_length}, {return_over_horizon}
///     training noise   whether training with the noise of the test helps, over the levels of the first figure with
///     heat
///                      maps: {tested} from the first start that is not random, {near} from random ones, {other} under
///                      the main {reading}; undisturbed scores {noisy_tested}, {noisy_near}, {clean_tested},
///                      {clean_near} of policies that were trained with noise and without; facts: elsewhere (the figure
///                      is drawn under another reading than the main one), reversed (it helps only there)
///
/// Throws Error, with the place, where the words ask for something else.
PaperFinding parse_finding(const Table& table);

/// The sentence.
std::string filled(const PaperFinding& finding, const Measured& measured);

}  // namespace gust
