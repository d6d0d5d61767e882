#include "gust/study/paper_results.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "gust/core/csv.h"
#include "gust/core/text.h"
#include "gust/study/files.h"
#include "gust/study/results.h"
#include "gust/study/trials.h"

namespace gust {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kSchema = 3;
constexpr const char* kDescription = "reproduction.json";
constexpr const char* kClaims = "claims.csv";

bool shows(const PaperFigure& figure, std::string_view part) {
  return std::ranges::find(figure.shows, part) != figure.shows.end();
}

/// The files of one study under one reading, without what tells them apart.
fs::path stem_of(const fs::path& folder, const Reproduction& reproduction, const ReproductionStudy& study) {
  const Paper& paper = *reproduction.paper;
  return folder / slug(paper.readings[study.reading].name) / paper.figures[study.figure].study;
}

fs::path with(const fs::path& stem, const std::string& end) { return stem.string() + end; }

std::string number_text(double value) { return std::isnan(value) ? std::string() : cat(value); }

std::string claims_csv(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  std::string text =
      csv_line({"id", "reading", "verdict", "estimate", "low", "high", "seeds", "share", "one_training", "reason"});
  for (const PaperVerdict& verdict : results.verdicts) {
    const Interval& measured = verdict.measured;
    text += csv_line({paper.claims[verdict.claim].id, paper.readings[verdict.reading].name,
                      std::string(ruling_name(verdict.verdict.ruling)), number_text(measured.estimate),
                      number_text(measured.low), number_text(measured.high), cat(verdict.seeds),
                      number_text(verdict.share), number_text(verdict.one_training), verdict.verdict.reason});
  }
  return text;
}

Ruling ruling_from(const std::string& name, const std::string& place) {
  for (const Ruling ruling : {Ruling::holds, Ruling::fails, Ruling::undecided, Ruling::not_testable}) {
    if (name == ruling_name(ruling)) return ruling;
  }
  throw Error(cat(place, ": '", name, "' is no verdict"));
}

void read_claims(const fs::path& file, PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  const CsvTable table(read_file(file), file.string());
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto claim = std::ranges::find(paper.claims, table.text(i, "id"), &PaperClaim::id);
    const auto reading = std::ranges::find(paper.readings, table.text(i, "reading"), &PaperReading::name);
    if (claim == paper.claims.end()) throw Error(cat(table.place(i), ": no claim ", table.text(i, "id")));
    if (reading == paper.readings.end()) throw Error(cat(table.place(i), ": no reading ", table.text(i, "reading")));
    PaperVerdict verdict;
    verdict.claim = static_cast<std::size_t>(claim - paper.claims.begin());
    verdict.reading = static_cast<std::size_t>(reading - paper.readings.begin());
    verdict.measured.estimate = table.number(i, "estimate");
    verdict.measured.low = table.number(i, "low");
    verdict.measured.high = table.number(i, "high");
    verdict.seeds = table.whole(i, "seeds");
    verdict.share = table.number(i, "share");
    verdict.one_training = table.number(i, "one_training");
    verdict.verdict = {ruling_from(table.text(i, "verdict"), table.place(i)), table.text(i, "reason")};
    results.verdicts.push_back(std::move(verdict));
  }
}

Json description(const PaperResults& results) {
  const ReproductionChoice& choice = results.reproduction.choice;
  Json provenance = Json::array();
  for (const auto& [what, value] : results.provenance) provenance.push_back({what, value});
  return {{"schema", kSchema},
          {"paper", results.reproduction.paper->name},
          {"profile", choice.profile},
          {"only", choice.only},
          {"seeds", choice.seeds ? Json(*choice.seeds) : Json(nullptr)},
          {"provenance", provenance},
          {"failures", results.failures},
          {"missing", results.missing}};
}

PaperResults read_description(const fs::path& file) {
  const std::string bytes = read_file(file);
  try {
    const Json json = Json::parse(bytes);
    if (json.at("schema") != kSchema)
      throw Error(cat(file.string(), ": was written by another version of gust; choose another folder"));
    if (!json.at("missing").is_number_unsigned()) throw Error(cat(file.string(), ": 'missing' is no count"));
    ReproductionChoice choice{json.at("profile"), json.at("only"), {}};
    if (!json.at("seeds").is_null()) choice.seeds = json.at("seeds").get<std::int64_t>();
    PaperResults results{open_reproduction(paper_at(json.at("paper").get<std::string>()), choice), {}, {}, {}, {}};
    results.failures = json.at("failures");
    results.missing = json.at("missing").get<std::uint64_t>();
    for (const Json& entry : json.at("provenance")) results.provenance.emplace_back(entry.at(0), entry.at(1));
    return results;
  } catch (const Json::exception& error) {
    throw Error(cat(file.string(), ": is no description of a reproduction: ", error.what()));
  }
}

std::string kept_text(const Study& study, const KeptTraces& kept) {
  const Json head = {{"policy", study.policies[kept.policy].name},
                     {"member", kept.member},
                     {"sweep", kept.sweep == Trial::kNominal ? "" : study.sweeps[kept.sweep].name},
                     {"traces", traces_text(kept.traces)}};
  return head.dump() + "\n";
}

KeptTraces read_kept(const fs::path& file, const Study& study) {
  const std::string bytes = read_file(file);
  try {
    const Json json = Json::parse(bytes);
    const auto policy = std::ranges::find(study.policies, json.at("policy").get<std::string>(), &StudyPolicy::name);
    const auto name = json.at("sweep").get<std::string>();
    const auto sweep = std::ranges::find(study.sweeps, name, &Sweep::name);
    if (policy == study.policies.end() || (!name.empty() && sweep == study.sweeps.end()))
      throw Error(cat(file.string(), ": belongs to another study"));
    return {static_cast<std::size_t>(policy - study.policies.begin()), json.at("member"),
            name.empty() ? Trial::kNominal : static_cast<std::size_t>(sweep - study.sweeps.begin()),
            read_traces(json.at("traces").get<std::string>(), file.string())};
  } catch (const Json::exception& error) {
    throw Error(cat(file.string(), ": holds no episodes: ", error.what()));
  }
}

}  // namespace

std::string PaperResults::label() const {
  const PaperProfile& profile = *reproduction.profile;
  const std::optional<std::int64_t> seeds = reproduction.choice.seeds ? reproduction.choice.seeds : profile.seeds;
  std::vector<std::string> parts;
  if (profile.steps < 1.0) parts.push_back(fmt::format("{:.3g} % of the training steps", 100 * profile.steps));
  if (seeds) parts.push_back(cat(*seeds, *seeds == 1 ? " seed" : " seeds", " of each training"));
  if (missing > 0)
    parts.push_back(cat(missing, missing == 1 ? " known trial is" : " known trials are", " still to be run"));
  if (parts.empty()) return "";
  const bool decides = !seeds || *seeds >= static_cast<std::int64_t>(kSeedsForVerdict);
  return cat(profile.steps < 1.0 ? "A miniature: " : "Not the full run: ", join(parts, ", "), ".",
             decides || missing > 0 ? "" : " It shows that everything runs, and decides nothing.");
}

const Summary* PaperResults::summary(std::size_t reading, std::string_view study) const {
  const std::optional<std::size_t> at = reproduction.find(reading, study);
  return at ? &summaries[*at] : nullptr;
}

std::vector<const PaperVerdict*> PaperResults::on(std::size_t claim) const {
  std::vector<const PaperVerdict*> found;
  for (const PaperVerdict& verdict : verdicts) {
    if (verdict.claim == claim) found.push_back(&verdict);
  }
  return found;
}

void leave_out_unshown(PaperResults& results) {
  for (std::size_t i = 0; i < results.summaries.size(); ++i) {
    const PaperFigure& figure = results.reproduction.paper->figures[results.reproduction.studies[i].figure];
    if (!shows(figure, "learning")) results.summaries[i].curves.clear();
    if (!shows(figure, "replay")) results.summaries[i].kept.clear();
  }
}

Reproduction read_results_choice(const fs::path& folder) {
  return read_description(folder / kDescription).reproduction;
}

void write_results(const PaperResults& results, const fs::path& folder) {
  std::error_code error;
  fs::remove(folder / kDescription, error);  // it comes last again: without it nothing there counts as results
  const Reproduction& reproduction = results.reproduction;
  for (std::size_t i = 0; i < reproduction.studies.size(); ++i) {
    const ReproductionStudy& part = reproduction.studies[i];
    const PaperFigure& figure = reproduction.paper->figures[part.figure];
    const fs::path stem = stem_of(folder, reproduction, part);
    write_file_atomically(with(stem, ".csv"), cells_csv(part.study, results.summaries[i]));
    if (shows(figure, "learning"))
      write_file_atomically(with(stem, "-learning.csv"), curves_csv(part.study, results.summaries[i]));
    for (std::size_t k = 0; shows(figure, "replay") && k < results.summaries[i].kept.size(); ++k)
      write_file_atomically(with(stem, cat("-", k + 1, ".json")), kept_text(part.study, results.summaries[i].kept[k]));
  }
  write_file_atomically(folder / kClaims, claims_csv(results));
  write_file_atomically(folder / kDescription, description(results).dump(2) + "\n");
}

PaperResults read_results(const fs::path& folder) {
  PaperResults results = read_description(folder / kDescription);
  for (ReproductionStudy& part : results.reproduction.studies) {
    const PaperFigure& figure = results.reproduction.paper->figures[part.figure];
    const fs::path stem = stem_of(folder, results.reproduction, part);
    Summary& summary = results.summaries.emplace_back();
    const fs::path cells = with(stem, ".csv");
    read_cells(read_file(cells), cells.string(), part.study, summary);
    const fs::path learning = with(stem, "-learning.csv");
    if (shows(figure, "learning")) read_curves(read_file(learning), learning.string(), part.study, summary);
    for (std::size_t k = 1; shows(figure, "replay") && fs::exists(with(stem, cat("-", k, ".json"))); ++k)
      summary.kept.push_back(read_kept(with(stem, cat("-", k, ".json")), part.study));
  }
  read_claims(folder / kClaims, results);
  return results;
}

bool holds_results(const fs::path& folder) { return fs::exists(folder / kDescription); }

void write_headline_policies(const Reproduction& reproduction, const std::vector<Plan>& plans, const Store& store,
                             const fs::path& folder) {
  for (std::size_t i = 0; i < reproduction.studies.size(); ++i) {
    const ReproductionStudy& part = reproduction.studies[i];
    const PaperFigure& figure = reproduction.paper->figures[part.figure];
    if (part.reading != 0 || !shows(figure, "learning")) continue;
    for (const Trial& trial : plans[i].trials) {
      if (trial.kind != Trial::Kind::kTrain || trial.member != 0) continue;
      const std::optional<StoredTrial> stored = store.load(kind_name(trial.kind), trial.id);
      if (!stored || !stored->contains(kPolicyFile)) continue;
      const StudyPolicy& policy = part.study.policies[trial.policy];
      const std::string name =
          cat(part.study.setup.plant.kind, "-", slug(policy.name), "-s", policy.seeds[trial.member], ".onnx");
      write_file_atomically(folder / "policies" / name, stored->read(kPolicyFile));
    }
  }
}

}  // namespace gust
