#pragma once

#include <filesystem>
#include <functional>

#include "gust/study/plan.h"
#include "gust/study/store.h"

namespace gust {

/// One line of the exported table: one metric of one episode.
struct ExportRow {
  std::string plant, preset, readings, policy, seed, site, waveform, vary, level, start;
  std::int64_t episode = 0;
  std::string metric;
  double value = 0;
};

inline constexpr std::string_view kExportHead =
    "plant,preset,readings,policy,seed,site,waveform,vary,level,start,episode,metric,value";

/// Hands over every row of every finished evaluation in plan order. A grid names both parameters in `vary` and both
/// values in `level`, joined by "*". Returns the evaluations that the store lacks, by their places in the plan; an
/// Error if it lacks them all.
std::vector<std::size_t> for_each_export_row(const Study& study, const Plan& plan, const Store& store,
                                             const std::function<void(const ExportRow&)>& take);

/// The same as CSV (RFC 4180), floats in their shortest form that reads back, to a new file that appears whole.
std::vector<std::size_t> export_csv(const Study& study, const Plan& plan, const Store& store,
                                    const std::filesystem::path& file);

/// The same and the learning curves as tables `episodes` and `learning` of an SQLite file, which is replaced.
std::vector<std::size_t> export_sqlite(const Study& study, const Plan& plan, const Store& store,
                                       const std::filesystem::path& file);

}  // namespace gust
