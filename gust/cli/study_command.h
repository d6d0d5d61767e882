#pragma once

#include <span>

#include "gust/report/study_page.h"
#include "gust/study/summary/summary.h"
#include "gust/study/trials/folder.h"
#include "gust/study/trials/run.h"

namespace gust {

/// A finished (or partly finished) study as the reading commands open it: the folder that `gust run` or `gust import`
/// left. Notices about damaged trials go to stderr.
struct OpenStudy {
  explicit OpenStudy(const std::string& path);
  OpenStudy(const OpenStudy&) = delete;
  OpenStudy& operator=(const OpenStudy&) = delete;

  /// The trials; an Error that names the command where the rows came from elsewhere.
  const Store& trials(std::string_view command) const;

  StudyFolder folder;
  Study study;
  bool imported = false;  ///< the rows were measured elsewhere: then there is no store, and no trial in the plan
  std::unique_ptr<Store> store = nullptr;
  Plan plan = {};
  std::unique_ptr<Measurements> measured = nullptr;
};

/// Why a trial that failed or was skipped did so, in one line.
std::string complaint(const Trial& trial, const Outcome& outcome);
/// One line for each trial that did not end well; those that were skipped for want of another are counted with that
/// one.
std::vector<std::string> complaints(std::span<const RunOutcome> outcomes);

/// Versions, machine and time, as pages tell them.
std::vector<std::pair<std::string, std::string>> provenance();

/// Writes report.html into the result folder, or into another one, and returns its path.
std::string write_report(const StudyFolder& folder, const Study& study, const Summary& summary,
                         const std::vector<std::string>& warnings, std::vector<SweepComparison> comparisons,
                         const std::filesystem::path& into = {});

/// Tells what is wrong with policies and what the store lacks; the exit code is of what it lacks.
int tell_missing(const Summary& summary);

/// Says at once what a run is going to do and how long it takes, where no terminal shows it and it takes long.
void tell_plan(const Plan& plan, const Store& store, std::size_t threads);

/// Seconds from which on it is worth telling.
inline constexpr double kWorthTelling = 30;

/// Threads to use: --threads, else GUST_THREADS, else all cores.
std::size_t thread_count(std::size_t asked);

/// What a study prints on the terminal, as wide as it is: margins for each start, then verdicts.
std::string summary_text(const Study& study, const Summary& summary);
/// The same as one JSON object.
std::string summary_json(const Study& study, const Summary& summary);

}  // namespace gust
