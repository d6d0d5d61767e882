#include "gust/paper/paper_results.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "gust/core/csv.h"
#include "gust/core/hash.h"
#include "gust/core/text.h"
#include "gust/store/files.h"
#include "gust/study/summary/results.h"
#include "gust/study/trials/trial_check.h"
#include "gust/study/trials/trials.h"

namespace gust {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kDeepest = 8;  // of reproduction.json: writing out what is nested deeper would recurse

constexpr int kSchema = 5;
constexpr const char* kDescription = "reproduction.json";
constexpr const char* kClaims = "claims.csv";

bool shows(const PaperFigure& figure, std::string_view part) {
  return std::ranges::find(figure.shows, part) != figure.shows.end();
}

bool shows_episodes(const PaperFigure& figure) { return shows(figure, "replay") || shows(figure, "disturbances"); }

/// The files of one study under one reading, without what tells them apart.
fs::path with(const fs::path& stem, const std::string& end) { return stem.string() + end; }

std::string number_text(double value) { return std::isnan(value) ? std::string() : cat(value); }

/// To seven digits, which is more than any number of episodes knows of a mean.
double rounded(double value) {
  std::array<char, 32> text;
  const std::to_chars_result end = std::to_chars(text.begin(), text.end(), value, std::chars_format::general, 7);
  std::from_chars(text.begin(), end.ptr, value);
  return value;
}

/// What is wrong with a JSON text, without the library's number of it.
std::string problem_of(const Json::exception& error) {
  const std::string text = error.what();
  return text.substr(text.find("] ") + 2);
}

/// Writes files into the folder, and knows their hashes.
class ResultsWriter {
 public:
  explicit ResultsWriter(fs::path folder) : folder_(std::move(folder)) {}

  void write(const fs::path& file, const std::string& bytes) {
    write_file_atomically(folder_ / file, bytes);
    hashes_[file.generic_string()] = hash_hex(bytes);
  }
  const Json& hashes() const { return hashes_; }

 private:
  fs::path folder_;
  Json hashes_ = Json::object();
};

/// Reads files of the folder, and notes the first that is not as it was written: what reads it may know better what is
/// wrong with it.
class ResultsReader {
 public:
  ResultsReader(fs::path folder, std::map<std::string, std::string> hashes)
      : folder_(std::move(folder)), hashes_(std::move(hashes)) {}

  bool has(const fs::path& file) const { return hashes_.contains(file.generic_string()); }
  std::string path(const fs::path& file) const { return (folder_ / file).string(); }
  std::string read(const fs::path& file) {
    std::string bytes = read_file(folder_ / file);
    const auto hash = hashes_.find(file.generic_string());
    const bool same = hash != hashes_.end() && hash->second == hash_hex(bytes);
    if (!same && changed_.empty()) changed_ = path(file);
    return bytes;
  }
  void check() const {
    if (!changed_.empty()) throw Error(cat(changed_, ": has changed since it was written; run the reproduction again"));
  }

 private:
  fs::path folder_;
  std::map<std::string, std::string> hashes_;
  std::string changed_;
};

std::string claims_csv(const PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  std::string text = csv_line({"id", "reading", "verdict", "estimate", "low", "high", "seeds", "share", "one_training",
                               "true_parts", "parts", "left_out_parts", "widened", "reason"});
  for (const PaperVerdict& verdict : results.verdicts) {
    const Interval& measured = verdict.measured;
    text +=
        csv_line({paper.claims[verdict.claim].id, paper.readings[verdict.reading].name,
                  std::string(ruling_name(verdict.verdict.ruling)), number_text(measured.estimate),
                  number_text(measured.low), number_text(measured.high), cat(verdict.seeds), number_text(verdict.share),
                  number_text(verdict.one_training), cat(verdict.true_parts), cat(verdict.parts),
                  cat(verdict.left_out_parts), std::string(ruling_name(verdict.widened)), verdict.verdict.reason});
  }
  return text;
}

Ruling ruling_from(const std::string& name, const std::string& place) {
  for (const Ruling ruling : {Ruling::holds, Ruling::fails, Ruling::undecided, Ruling::not_testable}) {
    if (name == ruling_name(ruling)) return ruling;
  }
  throw Error(cat(place, ": '", name, "' is no verdict"));
}

void read_claims(ResultsReader& files, PaperResults& results) {
  const Paper& paper = *results.reproduction.paper;
  const CsvTable table(files.read(kClaims), files.path(kClaims));
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
    verdict.true_parts = table.whole(i, "true_parts");
    verdict.parts = table.whole(i, "parts");
    verdict.left_out_parts = table.whole(i, "left_out_parts");
    verdict.widened = ruling_from(table.text(i, "widened"), table.place(i));
    verdict.verdict = {ruling_from(table.text(i, "verdict"), table.place(i)), table.text(i, "reason")};
    results.verdicts.push_back(std::move(verdict));
  }
}

constexpr const char* kInputs = "inputs";

/// Keeps the files that a paper was made of, so that its results can be read where the paper is not.
void write_paper(ResultsWriter& files, const Reproduction& reproduction) {
  const fs::path inputs = kInputs;
  for (const auto& [name, text] : reproduction.paper->files) files.write(inputs / name, text);
  for (const ReproductionStudy& part : reproduction.studies) {
    for (const std::vector<StudyFile>& found : part.study.found) {
      for (const StudyFile& file : found) {
        const fs::path path = (inputs / file.path).lexically_normal();
        files.write(path, file.bytes);
        for (const auto& [name, bytes] : file.data) files.write((path.parent_path() / name).lexically_normal(), bytes);
      }
    }
  }
}

/// The paper that results were made of: that of the program, or the copy that they keep.
std::shared_ptr<const Paper> paper_of(const ResultsHead& head, ResultsReader& files) {
  if (!head.folder) return {std::shared_ptr<const Paper>(), &paper_at(head.paper)};
  const std::string inputs = cat(kInputs, "/");
  for (const auto& [name, hash] : head.hashes) {
    if (name.starts_with(inputs)) files.read(name);
  }
  files.check();
  PaperSource source = folder_source(files.path(kInputs));
  source.find = [within = source.find, known = head.hashes, inputs](const std::string& pattern, const Place& place) {
    std::vector<StudyFile> found = within(pattern, place);
    std::erase_if(found, [&](const StudyFile& file) {
      return !known.contains((fs::path(inputs) / file.path).lexically_normal().generic_string());
    });
    return found;
  };
  Paper paper = parse_paper(source);
  paper.asked = *head.folder;
  return std::make_shared<const Paper>(std::move(paper));
}

Json description(const PaperResults& results, const Json& hashes) {
  const ReproductionChoice& choice = results.reproduction.choice;
  Json provenance = Json::array();
  for (const auto& [what, value] : results.provenance) provenance.push_back({what, value});
  const Paper& paper = *results.reproduction.paper;
  Json json = {{"schema", kSchema}, {"paper", paper.name}};
  if (paper.foreign) json["folder"] = paper.asked;
  json["profile"] = choice.profile;
  json["only"] = choice.only;
  json["seeds"] = choice.seeds ? Json(*choice.seeds) : Json(nullptr);
  json["provenance"] = provenance;
  json["failures"] = results.failures;
  json["missing"] = results.missing;
  json["files"] = hashes;
  return json;
}

/// The same object with the hash of its content.
Json hashed(Json json) {
  json.erase("hash");
  const std::string hash = hash_hex(json.dump());
  json["hash"] = hash;
  return json;
}

std::string kept_text(const Study& study, const KeptTraces& kept) {
  const Json head = {{"policy", study.policies[kept.policy].name},
                     {"member", kept.member},
                     {"sweep", kept.sweep == Trial::kNominal ? "" : study.sweeps[kept.sweep].name},
                     {"traces", traces_text(kept.traces)}};
  return head.dump() + "\n";
}

KeptTraces read_kept(ResultsReader& files, const fs::path& name, const Study& study) {
  const std::string bytes = files.read(name), file = files.path(name);
  try {
    const Json json = Json::parse(bytes);
    const auto policy = std::ranges::find(study.policies, json.at("policy").get<std::string>(), &StudyPolicy::name);
    const auto along = json.at("sweep").get<std::string>();
    const auto sweep = std::ranges::find(study.sweeps, along, &Sweep::name);
    if (policy == study.policies.end() || (!along.empty() && sweep == study.sweeps.end()))
      throw Error(cat(file, ": belongs to another study"));
    return {static_cast<std::size_t>(policy - study.policies.begin()), json.at("member"),
            along.empty() ? Trial::kNominal : static_cast<std::size_t>(sweep - study.sweeps.begin()),
            read_traces(json.at("traces").get<std::string>(), file)};
  } catch (const Json::exception& error) {
    throw Error(cat(file, ": holds no episodes: ", problem_of(error)));
  }
}

}  // namespace

std::string PaperResults::label() const {
  const PaperProfile& profile = *reproduction.profile;
  const std::optional<std::int64_t> seeds = reproduction.choice.seeds ? reproduction.choice.seeds : profile.seeds;
  std::vector<std::string> parts;
  if (profile.steps < 1.0) parts.push_back(fmt::format("{:.3g} % of the training steps", 100 * profile.steps));
  if (reproduction.fewer_seeds) parts.push_back(cat(*seeds, *seeds == 1 ? " seed" : " seeds", " of each training"));
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

void reduce_to_tables(PaperResults& results) {
  for (Summary& summary : results.summaries) {
    for (Series& series : summary.series) {
      series.added_levels.clear();
      series.added_values.clear();
      for (Estimate& cell : series.values) cell = {rounded(cell.value), rounded(cell.low), rounded(cell.high)};
    }
  }
  for (std::size_t i = 0; i < results.summaries.size(); ++i) {
    const PaperFigure& figure = results.reproduction.paper->figures[results.reproduction.studies[i].figure];
    if (!shows(figure, "learning")) results.summaries[i].curves.clear();
    if (!shows_episodes(figure)) results.summaries[i].kept.clear();
  }
}

bool ResultsHead::same_as(const Reproduction& reproduction) const {
  const Paper& of = *reproduction.paper;
  return paper == of.name && folder.has_value() == of.foreign && choice == reproduction.choice;
}

ResultsHead read_results_head(const fs::path& folder) {
  const std::string file = (folder / kDescription).string();
  const std::string bytes = read_file(file);
  try {
    const Json json = Json::parse(bytes, [](int depth, Json::parse_event_t, const Json&) { return depth <= kDeepest; });
    if (json.at("schema") != kSchema)
      throw Error(cat(file, ": was written by another version of gust; choose another folder"));
    if (json.contains("hash") && json != hashed(json))
      throw Error(cat(file, ": has changed since it was written; run the reproduction again"));
    if (!json.at("missing").is_number_unsigned()) throw Error(cat(file, ": 'missing' is no count"));
    ResultsHead head{json.at("paper"), {}, {json.at("profile"), json.at("only"), {}}, {}, json.at("failures"), 0, {}};
    if (json.contains("folder")) head.folder = json.at("folder").get<std::string>();
    if (!json.at("seeds").is_null()) head.choice.seeds = json.at("seeds").get<std::int64_t>();
    for (const Json& entry : json.at("provenance")) head.provenance.emplace_back(entry.at(0), entry.at(1));
    head.missing = json.at("missing").get<std::uint64_t>();
    head.hashes = json.at("files");
    return head;
  } catch (const Json::exception& error) {
    throw Error(cat(file, ": is no description of a reproduction: ", problem_of(error)));
  }
}

void write_results(const PaperResults& results, const fs::path& folder) {
  std::error_code error;
  fs::remove(folder / kDescription, error);  // it comes last again: without it nothing there counts as results
  const Reproduction& reproduction = results.reproduction;
  ResultsWriter files(folder);
  for (std::size_t i = 0; i < reproduction.studies.size(); ++i) {
    const ReproductionStudy& part = reproduction.studies[i];
    const PaperFigure& figure = reproduction.paper->figures[part.figure];
    const fs::path stem = reproduction.stem(part);
    files.write(with(stem, ".csv"), cells_csv(part.study, results.summaries[i]));
    if (shows(figure, "learning"))
      files.write(with(stem, "-learning.csv"), curves_csv(part.study, results.summaries[i]));
    for (std::size_t k = 0; shows_episodes(figure) && k < results.summaries[i].kept.size(); ++k)
      files.write(with(stem, cat("-", k + 1, ".json")), kept_text(part.study, results.summaries[i].kept[k]));
  }
  if (reproduction.paper->foreign) write_paper(files, reproduction);
  files.write(kClaims, claims_csv(results));
  if (results.scores && !results.scores->empty()) {
    files.write("scores.csv", results.scores->index());
    files.write("scores.f32", results.scores->values());
  }
  write_file_atomically(folder / kDescription, hashed(description(results, files.hashes())).dump(2) + "\n");
}

PaperResults read_results(const fs::path& folder) {
  const ResultsHead head = read_results_head(folder);
  ResultsReader files(folder, head.hashes);
  const std::shared_ptr<const Paper> paper = paper_of(head, files);
  PaperResults results{open_reproduction(*paper, head.choice), {}, {}, head.failures, head.provenance, head.missing};
  results.own_paper = paper;
  for (ReproductionStudy& part : results.reproduction.studies) {
    const PaperFigure& figure = results.reproduction.paper->figures[part.figure];
    const fs::path stem = results.reproduction.stem(part);
    Summary& summary = results.summaries.emplace_back();
    const fs::path cells = with(stem, ".csv");
    read_cells(files.read(cells), files.path(cells), part.study, summary);
    const fs::path learning = with(stem, "-learning.csv");
    if (shows(figure, "learning")) read_curves(files.read(learning), files.path(learning), part.study, summary);
    for (std::size_t k = 1; shows_episodes(figure) && files.has(with(stem, cat("-", k, ".json"))); ++k)
      summary.kept.push_back(read_kept(files, with(stem, cat("-", k, ".json")), part.study));
  }
  read_claims(files, results);
  files.check();
  return results;
}

bool holds_results(const fs::path& folder) {
  std::error_code unknown;
  return fs::exists(folder / kDescription, unknown);
}

void write_headline_policies(const Reproduction& reproduction, const std::vector<Plan>& plans, const Store& store,
                             const fs::path& folder) {
  for (std::size_t i = 0; i < reproduction.studies.size(); ++i) {
    const ReproductionStudy& part = reproduction.studies[i];
    const PaperFigure& figure = reproduction.paper->figures[part.figure];
    if (part.reading != 0 || !shows(figure, "learning")) continue;
    for (const Trial& trial : plans[i].trials) {
      if (trial.kind != Trial::Kind::kTrain || trial.member != 0) continue;
      const std::optional<StoredTrial> stored = load_trial(plans[i], trial, store);
      if (!stored || !stored->contains(kPolicyFile)) continue;
      const StudyPolicy& policy = part.study.policies[trial.policy];
      const std::string name =
          cat(part.study.setup.plant.kind, "-", slug(policy.name), "-s", policy.member(trial.member), ".onnx");
      write_file_atomically(folder / "policies" / name, stored->read(kPolicyFile));
    }
  }
}

}  // namespace gust
