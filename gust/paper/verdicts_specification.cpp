#include <algorithm>
#include <numeric>

#include "gust/core/text.h"
#include "gust/paper/verdicts.h"
#include "gust/report/html.h"

namespace gust {

std::vector<Specification> specifications(const ReproductionPage& page) {
  std::vector<Specification> all(page.readings.size());
  for (std::size_t reading = 0; reading < all.size(); ++reading) all[reading].reading = reading;
  for (const auto& claim : page.claims) {
    for (const auto& verdict : claim.verdicts) {
      Specification& one = all[verdict.reading];
      one.parts += verdict.parts;
      one.true_parts += verdict.true_parts;
      one.shown += verdict.grade() == Grade::shown ? 1 : 0;
      one.refuted += verdict.ruling == Ruling::fails ? 1 : 0;
      ++one.claims;
    }
  }
  std::erase_if(all, [](const Specification& one) { return one.parts == 0; });
  std::ranges::stable_sort(all, std::ranges::greater(), &Specification::share);
  return all;
}

std::string specification_curve(const ReproductionPage& page) {
  std::string rows;
  for (const Specification& one : specifications(page)) {
    rows += cat("<tr><th scope=\"row\">", escaped(page.readings[one.reading].name),
                "</th><td class=\"bar\"><span style=\"--share:", format("{:.4f}", one.share()),
                "\"></span></td><td class=\"number\">", percent(one.share()), "</td><td class=\"number\">",
                one.true_parts, " of ", one.parts, "</td><td class=\"number\">", one.shown,
                "</td><td class=\"number\">", one.refuted, "</td><td class=\"number\">", one.claims, "</td></tr>\n");
  }
  if (rows.empty()) return "";
  return cat(
      "<h3>How much is true under each reading</h3>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" "
      "aria-label=\"How much is true under each reading\"><table class=\"specification\">\n<thead><tr><th "
      "scope=\"col\">reading</th><th scope=\"col\" colspan=\"3\">parts true</th><th scope=\"col\" "
      "class=\"number\">shown</th><th scope=\"col\" class=\"number\">refuted</th><th scope=\"col\" "
      "class=\"number\">claims "
      "asked</th></tr></thead>\n<tbody>\n",
      rows, "</tbody></table></div>\n");
}

}  // namespace gust
