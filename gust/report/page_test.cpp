#include "gust/report/page.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "gust/core/error.h"
#include "gust/report/page_data.h"

namespace gust {
namespace {

bool holds(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

std::size_t count(const std::string& text, std::string_view part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

/// A page with the given number of levels on one sweep, two metrics, one policy.
Page small_page(std::size_t levels) {
  Page page;
  page.name = "small";
  page.policies = {{"lqr", "lqr", 1}};
  page.metrics = {{"anr", "return / length", "", 0, 1}, {"rmse", "RMSE", "", Page::kUnknown, Page::kUnknown}};
  page.starts = {{"nominal", "one fixed start"}};
  page.sweeps = {{"action step", "action", "step", "N", {}, Page::kUnknown, ""}};
  for (std::size_t i = 0; i < levels; ++i) page.sweeps[0].levels.push_back(static_cast<double>(i));
  const std::vector<double> values(levels, 0.5);
  page.curves = {{0, 0, 0, 0, {values, values, values}}, {0, 0, 0, 1, {values, {}, {}}}};
  page.margins = {{0, 0, 0, {0.5, 0.4, 0.6}, false, 1, "0.5 [0.4, 0.6]"}};
  return page;
}

Page::Episode short_episode() {
  Page::Episode episode;
  episode.title = "falls";
  episode.plant = "cartpole";
  episode.states = {{"x", "m", {0, 1, 2}}};
  episode.commanded = {{"force", "N", {1, 1}}};
  episode.applied = {{"force", "N", {1, 1}}};
  episode.disturbances = {{"action", {"force", "N", {0, 1}}}};
  episode.reward = {1, 0.5};
  episode.failed_step = 2;
  return episode;
}

}  // namespace

TEST_CASE("an empty study still gives a whole page") {
  const std::string html = render_page({});

  CHECK(html.starts_with("<!doctype html>"));
  CHECK(html.ends_with("</html>\n"));
  CHECK(holds(html, "id=\"provenance\""));
  CHECK_FALSE(holds(html, "id=\"figure-curves\""));
  CHECK_FALSE(holds(html, "id=\"figure-replay\""));
}

TEST_CASE("a page of one policy has its curves, its margin and no ranking") {
  const std::string html = render_page(small_page(3));

  CHECK(holds(html, "id=\"figure-curves\""));
  CHECK(holds(html, "<span class=\"value\">0.5</span>"));
  CHECK_FALSE(holds(html, "tolerates the most"));
  CHECK_FALSE(holds(html, "clearly ahead.</li>"));
}

TEST_CASE("a page asks nothing of the network") {
  const std::string html = render_page(small_page(3));

  CHECK_FALSE(holds(html, "<link"));
  CHECK_FALSE(holds(html, "<script src"));
  CHECK_FALSE(holds(html, "@import"));
  CHECK(holds(html, "default-src 'none'"));
}

TEST_CASE("hostile texts stay texts wherever they are shown") {
  const std::string bad = "</script><script>alert(1)</script><img src=x onerror=alert(1)>{{data}}";
  Page page = small_page(3);
  page.name = page.question = page.plant = page.study_text = page.run_command = bad;
  page.policies[0] = {bad, bad, 1};
  page.sweeps[0].waveform = page.sweeps[0].unit = page.metrics[0].title = bad;
  page.warnings = page.answer = page.confidence = {bad};
  page.claims = {{bad, bad, bad, bad, Ruling::fails, true}};
  page.provenance = {{bad, bad}};
  page.episodes = {short_episode()};
  page.episodes[0].title = bad;

  const std::string html = render_page(page);

  CHECK_FALSE(holds(html, "<script>alert"));
  CHECK_FALSE(holds(html, "<img src=x"));
  CHECK(count(html, "</script") == count(html, "<script"));
  CHECK(count(html, "id=\"gust-data\"") == 1);
}

TEST_CASE("the page's data are JSON with the curves' numbers") {
  const auto data = nlohmann::json::parse(page_data(small_page(3)).json);

  CHECK(data["curves"].size() == 2);
  CHECK(data["curves"][0]["v"] == nlohmann::json{0.5, 0.5, 0.5});
  CHECK(data["curves"][0]["l"].size() == 3);
  CHECK_FALSE(data["curves"][1].contains("l"));
  CHECK(data["sweeps"][0]["levels"] == nlohmann::json{0, 1, 2});
  CHECK(data["metrics"][1]["low"].is_null());
}

TEST_CASE("an episode reaches the page's data whole") {
  Page page = small_page(2);
  page.episodes = {short_episode()};

  const auto data = nlohmann::json::parse(page_data(page).json);

  const auto& episode = data["episodes"][0];
  CHECK(episode["states"][0]["v"] == nlohmann::json{0, 1, 2});
  CHECK(episode["disturbances"][0]["site"] == "action");
  CHECK(episode["failed"] == 2);
}

TEST_CASE("data beyond the limit are left out, the leading metric last, and the page says so") {
  Page page = small_page(2000);
  page.data_limit = 40000;

  const PageData data = page_data(page);

  const auto json = nlohmann::json::parse(data.json);
  CHECK(data.json.size() < 60000);
  CHECK(json["curves"].size() >= 1);
  CHECK(json["curves"][0]["m"] == 0);
  CHECK(json["curves"][0]["v"].size() == json["sweeps"][0]["levels"].size());
  CHECK(json["sweeps"][0]["levels"].back() == 1999);
  REQUIRE_FALSE(data.left_out.empty());
  CHECK(holds(render_page(page), "Curves show at most"));
}

TEST_CASE("a page that contradicts itself is a bug, not a broken file") {
  Page outside = small_page(3);
  outside.curves[0].policy = 1;
  Page uneven = small_page(3);
  uneven.curves[0].band.low.pop_back();
  Page episode = small_page(3);
  episode.episodes = {short_episode()};
  episode.episodes[0].reward.push_back(1);

  CHECK_THROWS_AS(render_page(outside), Bug);
  CHECK_THROWS_AS(render_page(uneven), Bug);
  CHECK_THROWS_AS(render_page(episode), Bug);
}

TEST_CASE("the licences of what is inside are in the page") {
  const std::string html = render_page({});

  CHECK(holds(html, "University of Washington Interactive Data Lab"));
  CHECK(holds(html, "Mike Bostock"));
  CHECK(holds(html, "SIL Open Font License"));
}

TEST_CASE("equal pages give equal bytes") { CHECK(render_page(small_page(5)) == render_page(small_page(5))); }

}  // namespace gust
