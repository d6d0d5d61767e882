#include "gust/paper/printed_table.h"

#include <algorithm>
#include <cmath>

#include "gust/core/error.h"
#include "gust/report/html.h"

namespace gust {
namespace {

using TableCell = ReproductionPage::TableCell;

/// The axis that the cells of one row share.
struct Axis {
  double low = 0;
  double high = 0;

  void reach(const Page::Estimate& estimate) {
    for (const double value : {estimate.value, estimate.low, estimate.high}) {
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  std::string place(double value) const {
    const double share = high > low ? (value - low) / (high - low) : 0.0;
    return format("{:.1f}%", 100 * std::clamp(share, 0.0, 1.0));
  }
};

std::string bar(std::string_view kind, const Page::Estimate& estimate, const Axis& axis, int middle) {
  std::string out;
  if (estimate.low <= estimate.high) {
    out += cat("<line class=\"bar ", kind, "\" x1=\"", axis.place(estimate.low), "\" x2=\"", axis.place(estimate.high),
               "\" y1=\"", middle, "\" y2=\"", middle, "\"/>");
  }
  if (!std::isfinite(estimate.value)) return out;
  const std::string x = axis.place(estimate.value);
  return cat(out, "<line class=\"tick ", kind, "\" x1=\"", x, "\" x2=\"", x, "\" y1=\"", middle - 4, "\" y2=\"",
             middle + 4, "\"/>");
}

std::string dots(const std::vector<double>& values, const Axis& axis, int middle) {
  std::string out;
  for (const double value : values) {
    if (std::isfinite(value))
      out += cat("<circle class=\"ours\" cx=\"", axis.place(value), "\" cy=\"", middle, "\" r=\"2\"/>");
  }
  return out;
}

/// The printed value above ours and, below, our single trainings, on the axis of their row.
std::string micro_plot(const TableCell& cell, const Axis& axis) {
  const std::string zero = axis.place(0);
  const int height = cell.trainings.empty() ? 20 : 26;
  return cat("<svg class=\"micro\" height=\"", height, "\" aria-hidden=\"true\"><line class=\"axis\" x1=\"", zero,
             "\" x2=\"", zero, "\" y1=\"0\" y2=\"", height, "\"/>", bar("printed", cell.printed, axis, 5),
             bar("ours", cell.ours, axis, 15), dots(cell.trainings, axis, 23), "</svg>");
}

/// "0.195 [0.142, 11.7]": errors of one table differ by orders of magnitude, so each number has its own three digits.
std::string number_text(const Page::Estimate& estimate) {
  std::string out = short_number(estimate.value);
  if (estimate.low < estimate.high)
    out +=
        cat(" <span class=\"interval\">[", short_number(estimate.low), ", ", short_number(estimate.high), "]</span>");
  return out;
}

std::string printed_text(const Page::Estimate& printed) {
  const double deviation = (printed.high - printed.low) / 2;
  return cat(short_number(printed.value),
             std::isfinite(deviation) ? cat(" <span class=\"interval\">± ", short_number(deviation), "</span>") : "");
}

/// " ± 0.087" of our episodes, as the paper's is.
std::string spread_text(const TableCell& cell) {
  return std::isfinite(cell.deviation) ? cat(" <span class=\"interval\">± ", short_number(cell.deviation), "</span>")
                                       : "";
}

std::string difference_text(const TableCell& cell) {
  const double difference = cell.ours.value - cell.printed.value;
  if (!std::isfinite(difference)) return "–";
  const std::string text = cat(difference > 0 ? "+" : "", short_number(difference));
  if (!stands_apart(cell)) return text;
  return cat("<b title=\"Our interval leaves out the printed value\">", difference > 0 ? "▲" : "▼", " ", text, "</b>");
}

std::string cell_row(const TableCell& cell, bool over_episodes, const Axis& axis) {
  std::string out = cat("<tr><th scope=\"row\">", escaped(cell.column), "</th>");
  for (const std::string& number :
       {printed_text(cell.printed), cat(number_text(cell.ours), over_episodes ? spread_text(cell) : ""),
        difference_text(cell), number_text(training_range(cell))})
    out += cat("<td class=\"number\">", number, "</td>");
  return cat(out, "<td class=\"plot\">", micro_plot(cell, axis), "</td></tr>\n");
}

/// Neighbours of one row's name, under that name.
std::string group_html(std::span<const TableCell> cells, bool over_episodes) {
  Axis axis;
  for (const auto& cell : cells) {
    axis.reach(cell.printed);
    axis.reach(cell.ours);
    axis.reach(training_range(cell));
  }
  std::string out = cat("<tbody><tr class=\"group\"><th colspan=\"6\" scope=\"rowgroup\">", escaped(cells.front().row),
                        "</th></tr>\n");
  for (const auto& cell : cells) out += cell_row(cell, over_episodes, axis);
  return out + "</tbody>\n";
}

}  // namespace

bool stands_apart(const TableCell& cell) {
  return cell.printed.value < cell.ours.low || cell.printed.value > cell.ours.high;
}

Page::Estimate training_range(const TableCell& cell) {
  std::vector<double> values;
  std::ranges::copy_if(cell.trainings, std::back_inserter(values), [](double value) { return std::isfinite(value); });
  if (values.empty()) return {};
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return {values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]), values.front(),
          values.back()};
}

bool among_trainings(const TableCell& cell) {
  const Page::Estimate range = training_range(cell);
  return range.low <= cell.printed.value && cell.printed.value <= range.high;
}

std::string printed_table(const ReproductionPage::Figure& figure) {
  if (figure.table.empty()) return "";
  const auto apart = static_cast<std::size_t>(std::ranges::count_if(figure.table, stands_apart));
  const auto measured = static_cast<std::size_t>(
      std::ranges::count_if(figure.table, [](const TableCell& cell) { return std::isfinite(cell.ours.low); }));
  const auto among = std::ranges::count_if(figure.table, among_trainings);
  std::string out =
      cat("<h3>The paper’s table beside ours</h3>\n<p class=\"lead\">", escaped(figure.table_metric), ". ", apart,
          " of ", counted(measured, "printed value", "printed values"), apart == 1 ? " lies" : " lie",
          " outside our interval: <b>▲</b> ours is larger, <b>▼</b> smaller. ", among, among == 1 ? " lies" : " lie",
          " between our least and greatest single training.</p>\n"
          "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"The paper’s table beside ours\"><table "
          "class=\"printed\">\n<thead><tr><th scope=\"col\">policy</th><th scope=\"col\" "
          "class=\"number\">paper <small>±",
          figure.over_episodes ? " over episodes" : "",
          "</small></th><th scope=\"col\" class=\"number\">ours "
          "<small>[interval]</small>"
          "</th><th scope=\"col\" class=\"number\">difference</th><th scope=\"col\" class=\"number\">one training "
          "<small>median [least, greatest]</small></th><th scope=\"col\" class=\"plot\"><span "
          "class=\"swatch-bar printed\"></span>paper <span class=\"swatch-bar ours\"></span>ours "
          "<span class=\"swatch-dot\"></span>each training</th></tr></thead>\n");
  const std::span<const TableCell> cells(figure.table);
  for (std::size_t from = 0; from < cells.size();) {
    std::size_t to = from + 1;
    while (to < cells.size() && cells[to].row == cells[from].row) ++to;
    out += group_html(cells.subspan(from, to - from), figure.over_episodes);
    from = to;
  }
  return out + "</table></div>\n";
}

}  // namespace gust
