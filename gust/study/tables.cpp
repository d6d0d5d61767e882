#include <fmt/format.h>

#include <algorithm>

#include "gust/study/summary.h"

namespace gust {
namespace {

/// How many columns a text takes, one a code point.
std::size_t width(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t columns) {
  return text + std::string(columns - std::min(columns, width(text)), ' ');
}

/// Rows of cells with aligned columns, two spaces between them.
std::string aligned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width(row[c]));
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) line += padded(row[c], widths[c] + 2);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace

std::string margins_table(const Study& study, const Summary& summary, std::size_t start) {
  std::vector<std::vector<std::string>> rows;
  rows.push_back({"sweep", "site", "waveform", "unit"});
  for (const StudyPolicy& policy : study.policies) rows.front().push_back(policy.name);
  for (std::size_t s = 0; s < study.sweeps.size(); ++s) {
    const Sweep& sweep = study.sweeps[s];
    if (!sweep.along_levels()) continue;
    std::vector<std::string> row = {sweep.name, std::string(site_name(sweep.injection->site)),
                                    sweep.injection->waveform.kind, sweep.unit(study.setup.plant->spec())};
    for (std::size_t p = 0; p < study.policies.size(); ++p) {
      const Series* series = summary.find(p, s, start);
      row.push_back(series && series->has_margin ? margin_text(series->margin) : "-");
    }
    rows.push_back(std::move(row));
  }
  return rows.size() == 1 ? std::string() : aligned(rows);
}

std::string claims_table(const Summary& summary) {
  std::vector<std::vector<std::string>> rows;
  for (const ClaimVerdict& verdict : summary.claims) {
    rows.push_back({std::string(ruling_name(verdict.verdict.ruling)), verdict.claim->id, verdict.claim->holds,
                    interval_text(verdict.measured), verdict.claim->text});
  }
  return aligned(rows);
}

}  // namespace gust
