#include "gust/paper/reproduction_page.h"

#include <doctest/doctest.h>

#include <limits>

#include "gust/core/error.h"
#include "gust/paper/printed_table.h"
#include "gust/paper/verdicts.h"

namespace gust {
namespace {

bool holds(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

std::size_t count(const std::string& text, std::string_view part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

ReproductionPage::Claim claim(std::string id, std::vector<Ruling> rulings) {
  ReproductionPage::Claim out;
  out.id = std::move(id);
  out.text = "PPO is best.";
  out.formula = "score(ppo) > 0.5";
  for (std::size_t reading = 0; reading < rulings.size(); ++reading)
    out.verdicts.push_back({reading, rulings[reading], {0.75, 0.5, 1}, 10, "It says so."});
  return out;
}

/// Two figures, of which the first has a learning curve, three claims and two readings.
ReproductionPage small_page() {
  ReproductionPage page;
  page.title = "A paper, measured again";
  page.readings = {{"main", "As written."}, {"other", "As one may read it, too."}};
  page.claims = {claim("C1", {Ruling::holds, Ruling::holds}), claim("C2", {Ruling::holds, Ruling::fails}),
                 claim("C3", {Ruling::not_testable})};
  page.figures.resize(2);
  auto& first = page.figures[0];
  first.id = "one";
  first.place = "Figure 1";
  first.claims = {"C1", "C2"};
  first.shows = {"learning", "grids"};
  first.page.policies = {{"lqr", "lqr", 1}, {"ppo", "train ppo", 10}};
  first.page.learning = {{.policy = 1, .source = "", .steps = {0, 1}, .mean = {{0.25, 0.5}, {}, {}}, .runs = {}}};
  auto& second = page.figures[1];
  second.id = "two";
  second.place = "Table I";
  second.table = {{"default", "PPO", {0.5, 0.25, 0.75}, {0.75, 0.625, 0.875}, {0.875, 0.25, 0.5, 0.75}},
                  {"default", "RAP", {0.5, 0.25, 0.75}, {0.5, 0.25, 0.75}}};
  return page;
}

}  // namespace

TEST_CASE("a claim that does not hold has the first reason that the data give") {
  using enum Ruling;
  ReproductionPage page;
  for (const char* id : {"fine", "few", "reading", "seeds", "printed", "most", "some", "hardly", "intervals", "none"})
    page.claims.push_back(claim(id, {std::string(id) == "fine" ? holds : fails, fails}));
  page.claims[1].verdicts[0] = {0, undecided, {}, 2, ""};
  page.claims[2].verdicts[1].ruling = holds;
  page.claims[2].verdicts[0].one_training = 0.5;
  page.claims[3].verdicts[0].one_training = 0.1;
  page.claims[3].verdicts[0].ruling = undecided;
  page.claims[4].verdicts[1].printed = true;
  page.claims[5].verdicts[0].one_training = 0.95;
  page.claims[5].verdicts[0].ruling = undecided;
  page.claims[6].verdicts[0].one_training = 0.1;
  page.claims[7].verdicts[0].one_training = 0.02;
  page.claims[8].verdicts[0].seeds = 10;
  page.claims[9].verdicts[0].seeds = 0;

  const std::vector<ClaimsOfReason> found = claims_by_reason(page);

  REQUIRE(found.size() == 9);
  for (std::size_t i = 0; i < found.size(); ++i) {
    REQUIRE(found[i].claims.size() == 1);
    CHECK(found[i].claims[0] == &page.claims[i + 1]);
  }
  CHECK(gust::holds(claims_by_reason_html(page), "1 claim: <a href=\"#claim-none\">none</a>"));
  page.claims.resize(1);
  CHECK(claims_by_reason_html(page).empty());
}

TEST_CASE("an empty reproduction still gives a whole page") {
  const std::string html = render_reproduction({});

  CHECK(html.starts_with("<!doctype html>"));
  CHECK(html.ends_with("</html>\n"));
  CHECK_FALSE(holds(html, "id=\"readings\""));
}

TEST_CASE("every claim stands once on the page, in its figure or at the end, and the picture leads to it") {
  const std::string html = render_reproduction(small_page());

  for (const std::string id : {"C1", "C2", "C3"}) {
    CHECK(count(html, cat("id=\"claim-", id, "\"")) == 1);
    CHECK(holds(html, cat("href=\"#claim-", id, "\"")));
  }
  CHECK(count(html, "class=\"cell ") == 3);
  CHECK(html.find("id=\"claim-C3\"") > html.find("id=\"figure-two\""));
}

TEST_CASE("a verdict's number and seeds stand once, the rest of its reason below") {
  ReproductionPage page = small_page();
  page.claims[0].verdicts[0].reason = "0.75 [0.5, 1] (10 seeds); true in some resamples";
  page.claims[1].verdicts[0].reason = "0.75 [0.5, 1] (2 seeds; five are needed)";  // it says more than the line above

  const std::string html = render_reproduction(page);

  CHECK(holds(html, "<p class=\"reason\">true in some resamples</p>"));
  CHECK(holds(html, "<p class=\"reason\">0.75 [0.5, 1] (2 seeds; five are needed)</p>"));
}

TEST_CASE("readings are told from most to least of the parts that are true under them") {
  ReproductionPage page = small_page();
  for (auto& verdict : page.claims[0].verdicts) verdict.parts = 4;
  page.claims[0].verdicts[0].true_parts = 1;
  page.claims[0].verdicts[1].true_parts = 3;
  page.readings.push_back({"asked nothing", "So it has no share."});

  const std::vector<Specification> all = specifications(page);

  REQUIRE(all.size() == 2);
  CHECK(all[0].reading == 1);
  CHECK(all[0].share() == 0.75);
  CHECK(all[0].claims == 2);
  CHECK(all[0].refuted == 1);
  CHECK(all[1].reading == 0);
  CHECK(all[1].true_parts == 1);
  const std::string html = render_reproduction(page);
  CHECK(html.find("75 %</td><td class=\"number\">3 of 4") < html.find("25 %</td><td class=\"number\">1 of 4"));
}

TEST_CASE("a claim hangs on a reading where it holds under one and fails under another") {
  CHECK_FALSE(hangs_on_reading(claim("C1", {Ruling::holds, Ruling::holds})));
  CHECK_FALSE(hangs_on_reading(claim("C1", {Ruling::not_testable, Ruling::holds})));
  CHECK_FALSE(hangs_on_reading(claim("C1", {Ruling::holds, Ruling::undecided})));
  CHECK(hangs_on_reading(claim("C1", {Ruling::not_testable, Ruling::holds, Ruling::fails})));
}

TEST_CASE("the page says how many claims hang on a reading and which ones") {
  const std::string html = render_reproduction(small_page());

  CHECK(holds(html, "1 of 3 claims is shown under one reading and refuted under another"));
  CHECK(count(html, "class=\"cell holds hangs\"") == 1);
  CHECK(holds(html, "</span> shown: main</span>"));
  CHECK(holds(html, "</span> refuted: other</span>"));
}

TEST_CASE("a figure shows what its data allow and nothing else") {
  const std::string html = render_reproduction(small_page());

  CHECK(count(html, "data-figure=\"learning\"") == 1);
  CHECK(count(html, "data-figure=\"grids\"") == 0);
  CHECK(count(html, "type=\"application/json\">{") == 1);
}

TEST_CASE("a policy has one place in the order of colours on all figures that show it") {
  ReproductionPage page = small_page();
  page.figures[1].page = page.figures[0].page;
  page.figures[1].shows = {"learning"};
  page.figures[1].page.policies = {{"ppo", "train ppo", 10}, {"rap", "train rap", 10}, {"lqr", "lqr", 1}};

  const std::string html = render_reproduction(page);

  CHECK(count(html, R"("name":"lqr","kind":"lqr","seeds":1,"place":1)") == 2);
  CHECK(count(html, R"("name":"ppo","kind":"train ppo","seeds":10,"place":0)") == 2);
  CHECK(count(html, R"("name":"rap","kind":"train rap","seeds":10,"place":2)") == 1);
}

TEST_CASE("the difference to the paper is marked where our interval leaves its value out") {
  const auto figure = small_page().figures[1];

  const std::string html = printed_table(figure);

  CHECK(stands_apart(figure.table[0]));
  CHECK_FALSE(stands_apart(figure.table[1]));
  CHECK(holds(html, "1 of 2 printed values lies outside our interval"));
  CHECK(holds(html, "▲ +0.25"));
  CHECK(holds(html, "0.5 <span class=\"interval\">± 0.25</span>"));
  CHECK(count(html, "<th colspan=\"6\" scope=\"rowgroup\"") == 1);
  CHECK(count(html, "<th scope=\"col\"") == 6);
}

TEST_CASE("a table shows what single trainings would have shown") {
  const auto figure = small_page().figures[1];

  const std::string html = printed_table(figure);

  CHECK(among_trainings(figure.table[0]));
  CHECK_FALSE(among_trainings(figure.table[1]));  // none were kept
  CHECK_FALSE(among_trainings({"", "", {0.2, 0.2, 0.2}, {}, {0.25, 0.5}}));
  CHECK(among_trainings({"", "", {0.25, 0.25, 0.25}, {}, {0.25, Page::kUnknown}}));
  CHECK(holds(html, "1 lies between our least and greatest single training"));
  CHECK(holds(html, "0.625 <span class=\"interval\">[0.25, 0.875]</span>"));
  CHECK(count(html, "<circle class=\"ours\"") == 4);
}

TEST_CASE("a value without an interval is not called different, and one that is missing has no difference") {
  constexpr double kNone = Page::kUnknown;

  CHECK_FALSE(stands_apart({"", "", {1, kNone, kNone}, {2, kNone, kNone}}));
  CHECK_FALSE(stands_apart({"", "", {kNone, kNone, kNone}, {2, 1, 3}}));
  CHECK(stands_apart({"", "", {1, kNone, kNone}, {3, 2, std::numeric_limits<double>::infinity()}}));
  CHECK(holds(printed_table({.table = {{"r", "c", {1, kNone, kNone}, {}}}}), "<td class=\"number\">–</td>"));
}

TEST_CASE("a miniature says so at the top and at each figure") {
  ReproductionPage page = small_page();
  CHECK_FALSE(holds(render_reproduction(page), "not the full run"));

  page.label = "Miniature: two seeds";
  const std::string html = render_reproduction(page);

  CHECK(holds(html, "<p class=\"label-banner\" role=\"note\">Miniature: two seeds</p>"));
  CHECK(count(html, "not the full run") == 2);
}

TEST_CASE("hostile texts of a reproduction stay texts wherever they are shown") {
  const std::string bad = "</script><script>alert(1)</script><img src=x onerror=alert(1)>{{data}}\"'";
  ReproductionPage page = small_page();
  page.title = page.source = page.note = page.label = page.run_command = bad;
  page.findings = page.warnings = {bad};
  page.provenance = {{bad, bad}};
  for (auto& reading : page.readings) reading = {bad, bad};
  auto& hostile = page.claims[1];
  hostile.id = hostile.place = hostile.text = hostile.formula = hostile.verdicts[0].reason =
      hostile.verdicts[1].reason = bad;
  auto& figure = page.figures[0];
  figure.claims[1] = figure.id = figure.place = figure.title = figure.says = figure.trained = figure.table_metric = bad;
  figure.table = {{bad, bad, {1, 1, 1}, {2, 2, 2}}};
  figure.page.policies[1].name = figure.page.name = bad;

  const std::string html = render_reproduction(page);

  CHECK_FALSE(holds(html, "<script>alert"));
  CHECK_FALSE(holds(html, "<img src=x"));
  CHECK(count(html, "</script") == count(html, "<script"));
}

TEST_CASE("a reproduction that contradicts itself is a bug, not a broken file") {
  ReproductionPage reading = small_page();
  reading.claims[0].verdicts[0].reading = 2;
  ReproductionPage unknown = small_page();
  unknown.figures[0].claims.push_back("C9");
  ReproductionPage twice = small_page();
  twice.figures[1].claims = {"C1"};
  ReproductionPage twins = small_page();
  twins.claims.push_back(twins.claims[0]);
  ReproductionPage chart = small_page();
  chart.figures[0].shows = {"pie"};
  ReproductionPage data = small_page();
  data.figures[0].page.learning[0].policy = 2;

  for (const auto& page : {reading, unknown, twice, twins, chart, data})
    CHECK_THROWS_AS(render_reproduction(page), Bug);
}

TEST_CASE("large figures share the room of one file") {
  ReproductionPage page = small_page();
  auto& data = page.figures[0].page;
  data.metrics = {{"anr", "return / length", "", 0, 1}};
  data.starts = {{"nominal", "one fixed start"}};
  data.sweeps = {{"step", "action", "step", "N", std::vector<double>(1000, 1.0)}};
  const std::vector<double> values(1000, 0.12345);
  for (std::size_t i = 0; i < 400; ++i) data.curves.push_back({0, 0, 0, 0, {values, values, values}});
  page.figures[0].shows = {"curves"};
  page.figures[1].page = data;
  page.figures[1].shows = {"curves"};
  for (auto& figure : page.figures) figure.page.data_limit = 100'000'000;

  const std::string html = render_reproduction(page);

  CHECK(html.size() < 20'000'000);
  CHECK(count(html, "Curves show at most") == 2);
}

TEST_CASE("equal reproductions give equal bytes") {
  CHECK(render_reproduction(small_page()) == render_reproduction(small_page()));
}

}  // namespace gust
