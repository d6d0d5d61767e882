#include "gust/report/answer.h"

#include <doctest/doctest.h>

#include <limits>

#include "gust/stats/margin.h"

namespace gust {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Two policies under a step on the action and the dynamics; levels to 10 N and 1 N.
Page two_policies() {
  Page page;
  page.policies = {{"lqr", "lqr", 1}, {"ppo", "train ppo", 3}};
  page.metrics = {{"anr", "return / length", "", 0, 1}};
  page.starts = {{"nominal", "one fixed start"}};
  page.sweeps = {{"action step", "action", "step", "N", {0, 5, 10}, Page::kUnknown, ""},
                 {"dynamics step", "dynamics", "step", "N", {0, 0.5, 1}, Page::kUnknown, ""}};
  return page;
}

/// The margins of a page with the texts that they would have.
void tell(Page& page) {
  for (Page::Margin& margin : page.margins) {
    const Interval level{.estimate = margin.level.value, .low = margin.level.low, .high = margin.level.high};
    margin.text = margin_text({.level = level, .censored = margin.censored, .last_level = margin.level.value});
  }
}

std::string html_of(Page::Margin margin) {
  Page page = two_policies();
  page.margins = {margin};
  tell(page);
  return margin_html(page, page.margins.front());
}

}  // namespace

TEST_CASE("a policy is ahead where its interval lies above the others'") {
  Page page = two_policies();
  page.margins = {{0, 0, 0, {4, 4, 4}, false, 0.98}, {0, 1, 0, {6, 5, 7}, false, 0.98}};

  CHECK(clear_winner(page, 0, 0) == 1);
  page.margins[1].level.low = 4;
  CHECK(clear_winner(page, 0, 0) == Page::kNone);
}

TEST_CASE("of two policies that both outlast the grid none is ahead") {
  Page page = two_policies();
  page.margins = {{0, 0, 0, {10, 10, kInfinity}, true, 0.98}, {0, 1, 0, {10, 10, kInfinity}, true, 0.98}};

  CHECK(clear_winner(page, 0, 0) == Page::kNone);
  page.margins[0] = {0, 0, 0, {4, 4, 4}, false, 0.98};
  CHECK(clear_winner(page, 0, 0) == 1);
}

TEST_CASE("a lone policy is not called ahead") {
  Page page = two_policies();
  page.margins = {{0, 1, 0, {6, 5, 7}, false, 0.98}};

  CHECK(clear_winner(page, 0, 0) == Page::kNone);
}

TEST_CASE("the answer ranks the policies, then names the first to fall on each site") {
  Page page = two_policies();
  page.margins = {{0, 0, 0, {4, 4, 4}, false, 0.98},
                  {0, 1, 0, {6, 5, 7}, false, 0.98},
                  {1, 0, 0, {1, 1, kInfinity}, true, 0.98},
                  {1, 1, 0, {1, 1, kInfinity}, true, 0.98},
                  {0, 0, 1, {7, 7, 7}, false, 0.98}};
  tell(page);

  const auto sentences = answer_html(page, 0);

  REQUIRE(sentences.size() == 3);
  CHECK(sentences[0] ==
        "<b class=\"policy\" data-policy=\"1\">ppo</b> tolerates the most under 1 of 2 disturbances; under 1 no policy "
        "is "
        "clearly "
        "ahead.");
  CHECK(sentences[1] ==
        "On the <b>action</b> site the first to fall is <b class=\"policy\" data-policy=\"0\">lqr</b>, under action "
        "step at "
        "4&nbsp;N <span class=\"interval\">[4, 4]</span>.");
  CHECK(sentences[2] == "On the <b>dynamics</b> site nothing on the grid costs more than 10\u00a0% of the score.");
  REQUIRE(answer_html(page, 1).size() == 2);
  CHECK(answer_html(page, 1)[0].find("lqr</b>, under action step at 7&nbsp;N") != std::string::npos);
  CHECK(answer_html(page, 2).empty());
}

TEST_CASE("a site where no policy has a margin is not said to cost little") {
  Page page = two_policies();
  page.margins = {{0, 0, 0, {}, false, -3.5, "–"}, {0, 1, 0, {}, false, -2.5, "–"}};

  const auto sentences = answer_html(page, 0);

  CHECK(sentences[0] == "On the <b>action</b> site no policy has a margin.");
}

TEST_CASE("a policy that is far from the best undisturbed is not ranked, and that is said") {
  Page page = two_policies();
  page.margins = {{0, 0, 0, {4, 4, 4}, false, 0.98}, {0, 1, 0, {6, 5, 7}, false, 0.3}};

  const auto sentences = answer_html(page, 0);

  CHECK(clear_winner(page, 0, 0) == Page::kNone);
  REQUIRE(sentences.size() == 3);
  CHECK(
      sentences[0] ==
      "<b class=\"policy\" data-policy=\"1\">ppo</b> (0.3) is not ranked: undisturbed it scores less than 90\u00a0% "
      "of "
      "the best, <b class=\"policy\" data-policy=\"0\">lqr</b> (0.98); a margin is a fall from a policy’s own score.");
}

TEST_CASE("those that do about as well undisturbed are ranked among themselves") {
  Page page = two_policies();
  page.policies.push_back({"zero", "zero", 1});
  page.margins = {
      {0, 0, 0, {4, 4, 4}, false, 1.0}, {0, 1, 0, {6, 5, 7}, false, 0.9}, {0, 2, 0, {10, 10, kInfinity}, true, 0.89}};

  const auto sentences = answer_html(page, 0);

  CHECK(clear_winner(page, 0, 0) == 1);
  CHECK(sentences[0].find("ppo</b> tolerates the most under 1 of 1 disturbance.") != std::string::npos);
  CHECK(sentences[1].find("zero</b> (0.89) is not ranked") != std::string::npos);
}

TEST_CASE("a margin is told with its unit and interval, and one beyond the grid as at least") {
  CHECK(html_of({0, 1, 0, {6, 5, 7}, false, 1}) == "6&nbsp;N <span class=\"interval\">[5, 7]</span>");
  CHECK(html_of({0, 1, 0, {10, 10, kInfinity}, true, 1}) == "≥ 10&nbsp;N");
}

TEST_CASE("the text in place of a margin is told as it is, without a unit") {
  Page page = two_policies();
  page.margins = {{0, 0, 0, {}, false, 0.1, "– (fails undisturbed)"}};

  CHECK(margin_html(page, page.margins[0]) == "– (fails undisturbed)");
}

TEST_CASE("the notes name policies of a single seed and count the margins beyond the grid") {
  Page page = two_policies();
  page.margins = {{0, 0, 0, {4, 4, 4}, false, 0.98}, {0, 1, 0, {10, 10, kInfinity}, true, 0.98}};

  const auto notes = confidence_html(page);

  REQUIRE(notes.size() == 3);
  CHECK(notes[1].find("lqr</b> has one seed") != std::string::npos);
  CHECK(notes[2].starts_with("1 of 2 margins lies beyond"));
}

}  // namespace gust
