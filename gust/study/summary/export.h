#pragma once

#include <filesystem>
#include <functional>
#include <limits>

#include "gust/store/store.h"
#include "gust/study/plan/plan.h"

namespace gust {

/// One line of the exported table: one metric of one episode. All but the value are its key: no two lines share it.
struct ExportRow {
  std::string plant, preset, readings, policy, seed;
  std::string sweep;                     ///< its name; "none" where nothing is swept, as in the next four
  std::string site, channels, waveform;  ///< of what is swept; channels as "fx fz=0.5", with factors that are not 1
  std::string window;                    ///< control steps "start:end", end not included
  std::string vary;                      ///< parameters along the axes, and what else the sweep sets
  double level = 0;                      ///< along the sweep's axis, of a grid along its first
  double level_2 = std::numeric_limits<double>::quiet_NaN();  ///< along the second axis of a grid, else NaN
  std::string start;
  std::int64_t episode = 0;
  std::string metric;
  double value = 0;
};

/// What the rows of a policy's member along a sweep have in common.
ExportRow export_head(const Study& study, std::size_t policy, std::size_t member, std::size_t sweep);

inline constexpr std::string_view kExportHead =
    "plant,preset,readings,policy,seed,sweep,site,channels,waveform,window,vary,level_2,level,start,episode,metric,"
    "value";

/// Hands over every row of every finished evaluation in plan order, and of the levels that margins asked for. A grid
/// names both axes in `vary`, joined by "*". Returns the trials of every kind that the store lacks, by their places in
/// the plan; an Error if it lacks all evaluations.
std::vector<std::size_t> for_each_export_row(const Study& study, const Plan& plan, const Store& store,
                                             const std::function<void(const ExportRow&)>& take);

/// The same as CSV (RFC 4180), floats in their shortest form that reads back, to a new file that appears whole.
std::vector<std::size_t> export_csv(const Study& study, const Plan& plan, const Store& store,
                                    const std::filesystem::path& file);

/// The same, the learning curves and the names of what is missing as tables `episodes`, `learning` and `missing` of an
/// SQLite file, which is replaced.
std::vector<std::size_t> export_sqlite(const Study& study, const Plan& plan, const Store& store,
                                       const std::filesystem::path& file);

}  // namespace gust
