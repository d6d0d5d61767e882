#include <algorithm>

#include "gust/core/crew.h"
#include "gust/paper/reproduction.h"
#include "gust/stats/bootstrap.h"
#include "gust/study/summary/claim_scores.h"

namespace gust {
namespace {

/// Scores under a reading that has another name for some of them.
class RenamedScores final : public FormulaData {
 public:
  RenamedScores(const FormulaData& scores, const std::map<std::string, std::string>& instead)
      : scores_(scores), instead_(instead) {}

  std::vector<std::string> functions() const override { return scores_.functions(); }
  FormulaValue call(std::string_view function, const std::vector<FormulaValue>& arguments) const override {
    const auto other = instead_.find(std::string(function));
    return scores_.call(other == instead_.end() ? function : other->second, arguments);
  }
  std::optional<std::size_t> fewest_seeds() const override { return scores_.fewest_seeds(); }

 private:
  const FormulaData& scores_;
  const std::map<std::string, std::string>& instead_;
};

/// The numbers of a printed table: score(column, row).
class PrintedScores final : public FormulaData {
 public:
  PrintedScores(const Paper& paper, std::string table, std::vector<std::string> functions)
      : paper_(paper), table_(std::move(table)), functions_(std::move(functions)) {}

  std::vector<std::string> functions() const override { return functions_; }
  FormulaValue call(std::string_view function, const std::vector<FormulaValue>& arguments) const override {
    if (function != "score" || arguments.size() != 2) throw NotTestable("the paper prints no such number");
    const std::string& column = arguments[0].as_text("'score'");
    const std::string& row = arguments[1].as_text("'score'");
    for (const PrintedValue& value : paper_.tables) {
      if (value.table != table_ || value.column != column || value.row != row) continue;
      return {FormulaList{{{Sampled::constant(value.mean)}}, {}}};
    }
    throw NotTestable(cat("the paper prints no value of ", column, " for ", row));
  }

 private:
  const Paper& paper_;
  std::string table_;
  std::vector<std::string> functions_;
};

/// A claim under a reading.
struct Question {
  std::size_t claim = 0;
  std::size_t reading = 0;
};

class Judge {
 public:
  /// Where nothing was measured, all scores are 1.
  explicit Judge(const Reproduction& reproduction, StudyMeasurements measured = {}, ScoreLog* log = nullptr)
      : reproduction_(reproduction), paper_(*reproduction.paper), measured_(measured), log_(log) {}

  /// In the order of the claims, the reading that decides first.
  std::vector<Question> questions() const {
    std::vector<Question> all;
    for (std::size_t c = 0; c < paper_.claims.size(); ++c) {
      if (!can_ask(paper_.claims[c])) continue;
      const std::size_t deciding = reading_of(paper_.claims[c]);
      all.push_back({c, deciding});
      for (std::size_t r = 0; r < paper_.readings.size(); ++r) {
        if (r != deciding && (r == 0 || bears_on(paper_.readings[r], paper_.claims[c]))) all.push_back({c, r});
      }
    }
    return all;
  }

  PaperVerdict ask(const Question& question) const {
    const PaperClaim& claim = paper_.claims[question.claim];
    const PaperReading& reading = paper_.readings[question.reading];
    PaperVerdict result{question.claim, question.reading, {}, {}};
    if (!claim.formula) {
      result.verdict = {Ruling::not_testable, claim.missing};
      return result;
    }
    const auto other = reading.asks.find(claim.id);
    const Formula& formula = other == reading.asks.end() ? *claim.formula : other->second;
    ClaimView view = view_of(claim, reading);
    const ClaimScores scores(sources(claim.from, question.reading), view, Rng(1).split("paper"));
    Finding finding;
    try {
      const PrintedScores printed(paper_, paper_.figure(claim.figure)->table, scores.functions());
      const RenamedScores renamed(scores, reading.instead);
      const FormulaData& data = reading.printed ? static_cast<const FormulaData&>(printed) : renamed;
      if (measured_.empty()) formula.evaluate(paper_.names, data);  // a place beyond the levels is a mistake now
      finding = judge(formula, paper_.names, data, left_out(question));
      result.seeds = finding.seeds;
      if (result.seeds >= kSeedsForVerdict && !formula.calls("alike")) {
        view.one_training = true;
        const ClaimScores ones(sources(claim.from, question.reading), view, Rng(1).split("paper"));
        result.one_training = judge(formula, paper_.names, RenamedScores(ones, reading.instead)).share;
      }
    } catch (const BeyondLevels& mistake) {  // of data that are there it is told by judge()
      throw Error(cat(claim.id, ", ", reading.name, ": ", mistake.what()));
    } catch (const NotTestable&) {  // a choice among scores that are yet to come
    } catch (const Error& error) {  // these data cannot answer; those with shapes only must
      if (measured_.empty()) throw;
      finding.verdict = {Ruling::not_testable, error.what()};
    }
    result.measured = finding.margin;
    result.left_out_parts = finding.left_out;
    result.widened = finding.widened;
    result.verdict = std::move(finding.verdict);
    if (const std::string told = interval_text(finding.measured); result.verdict.reason.starts_with(told))
      result.verdict.reason.replace(0, told.size(), interval_text(finding.margin));  // the number beside it
    result.share = finding.share;
    result.parts = finding.parts.size();
    result.true_parts = finding.true_parts();
    result.each_part = std::move(finding.parts);
    return result;
  }

 private:
  /// Which parts of a claim have a premise that did not happen under a reading: none of the printed numbers.
  std::function<bool(const TruthPart&)> left_out(const Question& question) const {
    const std::string& id = paper_.claims[question.claim].id;
    std::vector<const PaperPremise*> failed;
    for (const PaperPremise& premise : paper_.premises) {
      const bool asked = std::ranges::find(premise.claims, id) != premise.claims.end();
      if (asked && !paper_.readings[question.reading].printed && has_failed(premise, question.reading))
        failed.push_back(&premise);
    }
    if (failed.empty()) return {};
    return [id, failed](const TruthPart& part) {
      return std::ranges::any_of(failed, [&](const PaperPremise* premise) { return premise->bears_on(id, part); });
    };
  }

  /// Where its data are not there a premise is taken for granted.
  bool has_failed(const PaperPremise& premise, std::size_t reading) const {
    const bool known = std::ranges::all_of(
        premise.from, [&](const std::string& study) { return reproduction_.find(reading, study).has_value(); });
    if (!known) return false;
    const ClaimScores scores(sources(premise.from, reading),
                             {.metric = metric_of(premise.metric, premise.from), .start = start_of(premise.from)},
                             Rng(1));
    const Finding finding = judge(*premise.formula, paper_.names, scores);
    return !measured_.empty() && !finding.parts.empty() && finding.true_parts() < finding.parts.size();
  }

  bool can_ask(const PaperClaim& claim) const {
    return std::ranges::all_of(claim.from,
                               [&](const std::string& study) { return reproduction_.find(0, study).has_value(); });
  }

  std::size_t reading_of(const PaperClaim& claim) const {
    const auto at = std::ranges::find(paper_.readings, claim.reading, &PaperReading::name);
    return at == paper_.readings.end() ? 0 : static_cast<std::size_t>(at - paper_.readings.begin());
  }

  /// The first of some studies under the main reading.
  const Study& first_of(const std::vector<std::string>& from) const {
    return reproduction_.studies[*reproduction_.find(0, from.front())].study;
  }

  std::string metric_of(const std::string& metric, const std::vector<std::string>& from) const {
    const Study& study = first_of(from);
    return metric.empty() ? study.metric_set.name(margin_metric(study)) : metric;
  }
  std::string metric_of(const PaperClaim& claim) const { return metric_of(claim.metric, claim.from); }

  /// Random starts, unless the first of the studies has none.
  std::string start_of(const std::vector<std::string>& from) const {
    const std::vector<StartProtocol>& starts = first_of(from).starts;
    const bool random = std::ranges::find(starts, "random", &StartProtocol::name) != starts.end();
    return random ? "random" : starts.front().name;
  }

  /// Whether a claim asks for metrics by their names.
  bool asks_metrics(const PaperClaim& claim) const {
    const MetricSet& metrics = first_of(claim.from).metric_set;
    for (std::size_t i = 0; i < metrics.size(); ++i) {
      if (claim.formula->calls(metrics.name(i))) return true;
    }
    return false;
  }

  /// Whether the reading changes anything that the claim asks for.
  bool bears_on(const PaperReading& reading, const PaperClaim& claim) const {
    if (!claim.formula) return false;
    if (!reading.claims.empty()) return std::ranges::find(reading.claims, claim.id) != reading.claims.end();
    if (reading.printed) return !paper_.figure(claim.figure)->table.empty();
    const bool asks_scores = claim.formula->calls("score");
    const bool asks_episodes = asks_scores || asks_metrics(claim);
    if (reading.median) return asks_episodes || claim.formula->calls("curve") || claim.formula->calls("own_curve");
    if (!reading.start.empty()) return asks_episodes;
    if (!reading.instead.empty()) return asks_scores && reading.instead.contains(metric_of(claim));
    return std::ranges::any_of(claim.from, [&](const std::string& study) {
      return std::ranges::find(reading.figures, study) != reading.figures.end();
    });
  }

  std::vector<ClaimSource> sources(const std::vector<std::string>& from, std::size_t reading) const {
    std::vector<ClaimSource> all;
    for (const std::string& name : from) {
      const std::size_t at = *reproduction_.find(reading, name);
      all.push_back({&reproduction_.studies[at].study, measured_.empty() ? nullptr : measured_[at].get(), log_,
                     reproduction_.stem(reproduction_.studies[at])});
    }
    return all;
  }

  ClaimView view_of(const PaperClaim& claim, const PaperReading& reading) const {
    const std::string metric = metric_of(claim);
    const auto other = reading.instead.find(metric);
    return {.metric = other == reading.instead.end() ? metric : other->second,
            .start = reading.start.empty() ? start_of(claim.from) : reading.start,
            .over_seeds = reading.median ? Statistic::median : Statistic::mean};
  }

  const Reproduction& reproduction_;
  const Paper& paper_;
  StudyMeasurements measured_;
  ScoreLog* log_;
};

}  // namespace

std::vector<PaperVerdict> judge_paper(const Reproduction& reproduction, StudyMeasurements measured, std::size_t threads,
                                      const std::vector<std::string>& named, ScoreLog* log) {
  const Judge judge(reproduction, measured, log);
  std::vector<Question> questions = judge.questions();
  std::erase_if(questions, [&](const Question& question) {
    const std::string& id = reproduction.paper->claims[question.claim].id;
    return !named.empty() && std::ranges::find(named, id) == named.end();
  });
  std::vector<PaperVerdict> verdicts(questions.size());
  for_each_item(threads, questions.size(),
                [&] { return [&](std::size_t i) { verdicts[i] = judge.ask(questions[i]); }; });
  return verdicts;
}

void check_claims(const Reproduction& reproduction) {
  const Judge judge(reproduction);
  for (const Question& question : judge.questions()) judge.ask(question);
}

}  // namespace gust
