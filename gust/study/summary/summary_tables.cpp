#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "gust/core/text.h"
#include "gust/study/summary/summary.h"
#include "gust/study/trials/margin_trial.h"

namespace gust {
namespace {

std::string padded(const std::string& text, std::size_t columns) {
  return text + std::string(columns - std::min(columns, text_width(text)), ' ');
}

using TextRows = std::vector<std::vector<std::string>>;

constexpr std::size_t kGap = 2;  // spaces between columns

std::vector<std::size_t> widths_of(const TextRows& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], text_width(row[c]));
  }
  return widths;
}

std::size_t total(std::span<const std::size_t> widths) {
  return std::accumulate(widths.begin(), widths.end(), kGap * (widths.size() - 1));
}

/// Rows of cells with aligned columns.
std::string aligned(const TextRows& rows) {
  const std::vector<std::size_t> widths = widths_of(rows);
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) line += padded(row[c], widths[c] + kGap);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

/// The first `labels` columns and, behind them, those of [from, end).
TextRows block_of(const TextRows& rows, std::size_t labels, std::size_t from, std::size_t end) {
  TextRows block;
  for (const auto& row : rows) {
    auto& cells = block.emplace_back(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(labels));
    for (std::size_t c = from; c < end; ++c) cells.push_back(row[c]);
  }
  return block;
}

/// The rows in blocks of as many columns as fit beside the first `labels`, at least one, with a line between them.
std::string in_blocks(const TextRows& rows, std::size_t labels, std::size_t columns) {
  const std::vector<std::size_t> widths = widths_of(rows);
  std::string text;
  for (std::size_t from = labels, end = from; from < widths.size(); from = end) {
    std::size_t used = total(std::span(widths).first(labels));
    do used += kGap + widths[end++];
    while (end < widths.size() && used + kGap + widths[end] <= columns);
    text += cat(text.empty() ? "" : "\n", aligned(block_of(rows, labels, from, end)));
  }
  return text;
}

/// The rows below one another, a line a policy, where not even one column fits beside the first two.
std::string as_list(const TextRows& rows, std::size_t columns) {
  std::size_t widest = 0;
  for (std::size_t c = 2; c < rows.front().size(); ++c) widest = std::max(widest, text_width(rows.front()[c]));
  std::string text;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    text += cat(wrapped(cat(rows[r][0], ", ", rows[r][1]), columns), "\n");
    for (std::size_t c = 2; c < rows[r].size(); ++c)
      text += cat("  ", padded(rows.front()[c], widest + kGap), rows[r][c], "\n");
  }
  return text;
}

std::vector<std::string> margin_row(const Study& study, const Summary& summary, std::size_t s, std::size_t start) {
  const Sweep& sweep = study.sweeps[s];
  std::vector<std::string> row = {sweep.name, std::string(site_name(sweep.injection->site)), sweep.injection->kind(),
                                  sweep.unit(study.setup.plant->spec())};
  for (std::size_t p = 0; p < study.policies.size(); ++p) {
    const Series* series = summary.find(p, s, start);
    row.push_back(series && series->has_margin ? margin_text(series->margin) : "–");
  }
  return row;
}

/// What the margins are falls from; a star where it falls short of the best.
std::vector<std::string> undisturbed_row(const Study& study, const Summary& summary, std::size_t start) {
  std::vector<double> scores;
  for (std::size_t p = 0; p < study.policies.size(); ++p) scores.push_back(summary.undisturbed(p, start));
  double best = 0;
  for (const double score : scores) best = std::max(best, score);  // never NaN: that compares false
  std::vector<std::string> row = {"undisturbed", "", "", study.metric_set.name(summary.margin_metric)};
  for (const double score : scores) {
    row.push_back(std::isnan(score) ? "-" : format("{:.3g}{}", score, falls_short(score, best) ? " *" : ""));
  }
  return row;
}

/// Why sweeps and policies have no margin, or the margin 0, a line each; the same reason of one policy once.
std::string reasons(const Study& study, const Summary& summary, std::size_t start) {
  std::vector<std::string> lines;
  for (const Sweep& sweep : study.sweeps) {
    const std::string reason = sweep.along_levels() ? levels_obstacle(sweep) : "";
    if (!reason.empty()) lines.push_back(cat("– under ", sweep.name, ": ", reason, "\n"));
  }
  for (const Series& series : summary.series) {
    if (!series.has_margin || series.start != start || series.margin.reason.empty()) continue;
    if (!levels_obstacle(study.sweeps[series.sweep]).empty()) continue;
    const bool zero = !std::isnan(series.margin.level.estimate);
    const std::string& policy = study.policies[series.policy].name;
    const std::string whose =
        zero ? cat("0 for ", policy, " under ", study.sweeps[series.sweep].name) : cat("– for ", policy);
    std::string line = cat(whose, ": ", series.margin.reason, "\n");
    if (std::ranges::find(lines, line) == lines.end()) lines.push_back(std::move(line));
  }
  return lines.empty() ? "" : cat("\n", join(lines, ""));
}

}  // namespace

std::string margins_table(const Study& study, const Summary& summary, std::size_t start, std::size_t columns) {
  TextRows rows = {{"sweep", "site", "waveform", "unit"}, undisturbed_row(study, summary, start)};
  for (const StudyPolicy& policy : study.policies) rows.front().push_back(policy.name);
  for (std::size_t s = 0; s < study.sweeps.size(); ++s) {
    if (study.sweeps[s].along_levels()) rows.push_back(margin_row(study, summary, s, start));
  }
  if (rows.size() == 2) return {};
  const bool starred = std::ranges::any_of(rows[1], [](const std::string& cell) { return cell.ends_with('*'); });
  std::string note =
      starred ? "\n* below 90 % of the best: a margin from there does not compare with the others\n" : "";
  note = wrapped(note + reasons(study, summary, start), columns);
  if (total(widths_of(rows)) <= columns) return aligned(rows) + note;
  for (auto& row : rows) row.erase(row.begin() + 1, row.begin() + 3);  // the name of the sweep has to do
  const std::vector<std::size_t> widths = widths_of(rows);
  const bool fits =
      total(std::span(widths).first(2)) + kGap + *std::max_element(widths.begin() + 2, widths.end()) <= columns;
  return (fits ? in_blocks(rows, 2, columns) : as_list(rows, columns)) + note;
}

std::string claims_table(const Summary& summary, std::size_t columns) {
  TextRows rows;
  for (const ClaimVerdict& verdict : summary.claims) {
    rows.push_back({std::string(ruling_name(verdict.finding.verdict.ruling)), verdict.claim->id, verdict.claim->holds,
                    measured_text(verdict.finding), verdict.claim->text});
  }
  const std::vector<std::size_t> widths = widths_of(rows);
  if (rows.empty() || total(widths) <= columns) return aligned(rows);
  const std::size_t indent = widths.front() + kGap;
  const std::size_t room = columns - std::min(columns, indent);
  std::string text;
  for (const auto& row : rows) {
    text += padded(row.front(), indent);
    for (std::size_t c = 1; c < row.size(); ++c) {
      if (row[c].empty()) continue;
      text += cat(c == 1 ? "" : std::string(indent, ' '), wrapped(row[c], room, indent), "\n");
    }
  }
  return text;
}

}  // namespace gust
