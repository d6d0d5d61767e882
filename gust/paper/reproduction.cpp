#include "gust/paper/reproduction.h"

#include <algorithm>
#include <cmath>

#include "gust/core/text.h"
#include "gust/study/text/parse.h"

namespace gust {
namespace {

template <class Items>
const typename Items::value_type& item_at(const Items& items, const std::string& name, const char* what) {
  std::vector<std::string> names;
  for (const auto& item : items) {
    if (item.name == name) return item;
    names.push_back(item.name);
  }
  throw Error(cat("unknown ", what, " '", name, "'", did_you_mean(name, names), "; there are ", join(names, ", ")));
}

/// Whole thousands, as a person would write them.
std::int64_t share_of(std::int64_t steps, double share) {
  const double thousands = std::round(static_cast<double>(steps) * share / 1000.0);
  return 1000 * std::max<std::int64_t>(1, static_cast<std::int64_t>(thousands));
}

/// What a profile changes in a study: policies are named by their places.
std::vector<std::string> profile_settings(const Study& study, const PaperProfile& profile,
                                          std::optional<std::int64_t> seeds) {
  std::vector<std::string> settings;
  for (std::size_t i = 0; i < study.policies.size(); ++i) {
    const PolicyTraining* training = study.policies[i].training();
    if (training == nullptr) continue;
    if (profile.steps < 1.0)
      settings.push_back(cat("policy.", i, ".agent.steps=", share_of(training->agent->steps(), profile.steps)));
    if (!seeds) continue;
    std::vector<std::string> numbers;
    for (std::int64_t seed = 1; seed <= *seeds; ++seed) numbers.push_back(cat(seed));
    settings.push_back(cat("policy.", i, ".seeds=[", join(numbers, ", "), "]"));
  }
  return settings;
}

/// Of its trainings.
std::int64_t most_seeds(const Study& study) {
  std::size_t most = 0;
  for (const StudyPolicy& policy : study.policies) most = std::max(most, policy.training() ? policy.count() : 0);
  return static_cast<std::int64_t>(most);
}

/// The settings of a reading for one of its studies.
std::vector<std::string> reading_settings(const PaperReading& reading, const std::string& study) {
  constexpr std::string_view kStudy = "{study}";
  const auto own = reading.own.find(study);
  std::vector<std::string> settings = reading.common;
  for (std::string setting : own != reading.own.end() ? own->second : reading.settings) {
    const std::size_t at = setting.find(kStudy);
    if (at != std::string::npos) setting.replace(at, kStudy.size(), study);
    settings.push_back(std::move(setting));
  }
  return settings;
}

/// Whether a figure that is drawn under a reading tells margins: claims ask for the paper's grid alone.
bool shows_margins(const Paper& paper, std::size_t figure, std::size_t reading) {
  const PaperFigure& drawn = paper.figures[figure];
  return paper.reading(drawn.reading) == reading && std::ranges::find(drawn.shows, "curves") != drawn.shows.end();
}

bool wanted(const ReproductionChoice& choice, const std::string& study) {
  return choice.only.empty() || std::ranges::find(choice.only, study) != choice.only.end();
}

/// A study's text under the settings of a reading; what is wrong with one of them is told at the reading.
Study study_under(const Paper& paper, const PaperReading& reading, const std::string& file,
                  const std::vector<std::string>& settings) {
  try {
    return parse_study(paper.files.at(file), paper.files_from.place(file), settings, paper.files_from.find);
  } catch (const Error& error) {
    constexpr std::string_view kSetting = "--set ";
    const std::string_view problem = error.what();
    if (!problem.starts_with(kSetting)) throw;
    throw error_at(reading.where, "in ", file, " under '", reading.name, "': ", problem.substr(kSetting.size()));
  }
}

std::vector<std::string> names_of(const auto& items) {
  std::vector<std::string> names;
  for (const auto& item : items) names.push_back(item.name);
  return names;
}

/// An Error at a figure or reading unless the name is one of its study's.
void check_has(const Place& where, const Study& study, const std::vector<std::string>& known, const std::string& name,
               const char* what) {
  if (std::ranges::find(known, name) == known.end())
    throw error_at(where, "the study '", study.name, "' has no ", what, " '", name, "'", did_you_mean(name, known));
}

/// Checks that a study has what its figure draws.
void check_drawn(const PaperFigure& figure, const Study& study) {
  if (!figure.table.empty()) {
    std::vector<std::string> metrics;
    for (const std::size_t metric : summarised_metrics(study)) metrics.push_back(study.metric_set.name(metric));
    check_has(figure.where, study, metrics, figure.metric, "metric");
  }
  for (const PaperMap& map : figure.maps) {
    check_has(figure.where, study, names_of(study.sweeps), map.sweep, "sweep");
    const Sweep& sweep = *std::ranges::find(study.sweeps, map.sweep, &Sweep::name);
    for (const double level : sweep.axes.front().values)
      check_has(figure.where, study, names_of(study.policies), map.policy(level), "policy");
  }
}

/// Checks that what a reading says of starts is true of some study.
void check_start(const Reproduction& reproduction, std::size_t reading) {
  const PaperReading& asked = reproduction.paper->readings[reading];
  const Study* last = nullptr;
  for (const PaperFigure& figure : reproduction.paper->figures) {
    const std::optional<std::size_t> at = reproduction.find(reading, figure.study);
    if (!at) continue;
    last = &reproduction.studies[*at].study;
    const std::vector<std::string> starts = names_of(last->starts);
    if (std::ranges::find(starts, asked.start) != starts.end()) return;
  }
  if (last != nullptr) check_has(asked.where, *last, names_of(last->starts), asked.start, "start");
}

}  // namespace

std::string PaperMap::policy(double level) const {
  constexpr std::string_view kLevel = "{level}";
  std::string name = policies;
  return name.replace(name.find(kLevel), kLevel.size(), cat(level));
}

std::optional<std::size_t> Reproduction::find(std::size_t reading, std::string_view study) const {
  const auto at = std::ranges::find_if(studies, [&](const ReproductionStudy& part) {
    return part.reading == reading && paper->figures[part.figure].study == study;
  });
  if (at != studies.end()) return static_cast<std::size_t>(at - studies.begin());
  if (reading == 0) return std::nullopt;
  return find(paper->readings[reading].like.value_or(0), study);
}

std::string Reproduction::stem(const ReproductionStudy& study) const {
  return cat(slug(paper->readings[study.reading].name), "/", paper->figures[study.figure].study);
}

Reproduction open_reproduction(const Paper& paper, const ReproductionChoice& choice) {
  Reproduction reproduction{&paper, choice, &paper.profiles.front(), {}};
  if (!choice.profile.empty()) reproduction.profile = &item_at(paper.profiles, choice.profile, "profile");
  reproduction.choice.profile = reproduction.profile->name;
  std::vector<std::string> names;
  for (const PaperFigure& figure : paper.figures) names.push_back(figure.study);
  for (const std::string& name : choice.only) {
    if (paper.figure(name) == nullptr)
      throw Error(cat("unknown figure '", name, "'", did_you_mean(name, names), "; there are ", join(names, ", ")));
  }
  const std::optional<std::int64_t> seeds = choice.seeds ? choice.seeds : reproduction.profile->seeds;
  if (seeds && (*seeds < 1 || *seeds > kMostSeeds))
    throw Error(cat("a reproduction has 1 to ", kMostSeeds, " seeds of each training, not ", *seeds));
  for (std::size_t r = 0; r < paper.readings.size(); ++r) {
    for (std::size_t f = 0; f < paper.figures.size(); ++f) {
      const std::string& study = paper.figures[f].study;
      const PaperReading& reading = paper.readings[r];
      const bool changed = std::ranges::find(reading.figures, study) != reading.figures.end();
      if (!wanted(choice, study) || (r > 0 && !changed)) continue;
      const auto other = reading.files.find(study);
      const std::string file = cat(other == reading.files.end() ? study : other->second, ".toml");
      std::vector<std::string> settings = reading_settings(reading, study);
      const Study whole = study_under(paper, reading, file, settings);
      reproduction.fewer_seeds = reproduction.fewer_seeds || (seeds && most_seeds(whole) > *seeds);
      std::ranges::move(profile_settings(whole, *reproduction.profile, seeds), std::back_inserter(settings));
      if (r > 0 && !shows_margins(paper, f, r)) settings.push_back("evaluate.margin_tolerance=0");
      reproduction.studies.push_back({r, f, study_under(paper, reading, file, settings)});
    }
  }
  for (const PaperFigure& figure : paper.figures) {
    if (const std::optional<std::size_t> at = reproduction.drawn(figure))
      check_drawn(figure, reproduction.studies[*at].study);
  }
  for (std::size_t r = 0; r < paper.readings.size(); ++r) {
    if (choice.only.empty() && !paper.readings[r].start.empty()) check_start(reproduction, r);
  }
  return reproduction;
}

}  // namespace gust
