#include "gust/paper/paper.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "gust/core/csv.h"
#include "gust/core/fields.h"
#include "gust/core/text.h"
#include "gust/paper/paper_checks.h"
#include "gust/report/charts.h"
#include "gust/setup/toml.h"
#include "gust/study/text/parse.h"

namespace gust {
namespace {

/// The text of a key, or nothing.
std::string text_of(const Table& table, std::string_view key) {
  const Value* value = table.find(key);
  return value ? value->as_text(key) : std::string();
}

std::vector<std::string> texts_of(const Table& table, std::string_view key) {
  std::vector<std::string> texts;
  const Value* value = table.find(key);
  if (value == nullptr) return texts;
  for (const Value& item : value->as_list(key)) texts.push_back(item.as_text(key));
  return texts;
}

bool flag_of(const Table& table, std::string_view key) {
  const Value* value = table.find(key);
  return value != nullptr && value->as_bool(key);
}

/// Calls visit(table) for each of [[key]].
template <class Visit>
void for_each_table(const Table& table, std::string_view key, Visit&& visit) {
  const Value* list = table.find(key);
  if (list == nullptr) throw error_at(table.place, "there is no [[", key, "]]");
  for (const Value& item : list->as_list(key)) visit(item.as_table(key));
}

/// Reads the text of a study that a value names.
void read_study(Paper& paper, const Value& value, std::string_view key) {
  check_file_name(value, key);
  const std::string file = cat(value.as_text(key), ".toml");
  std::optional<std::string> text = paper.files_from.read(file);
  if (!text) throw error_at(value.place, "there is no ", paper.files_from.place(file));
  paper.files[file] = std::move(*text);
}

PaperProfile parse_profile(const Table& table) {
  check_keys(table, {"name", "seeds", "steps"}, "a profile");
  PaperProfile profile{required_text(table, "name", "a profile"), {}, 1.0};
  if (const Value* seeds = table.find("seeds")) {
    profile.seeds = seeds->as_int("seeds");
    if (*profile.seeds < 1) throw error_at(seeds->place, "'seeds' must be at least 1");
  }
  if (const Value* steps = table.find("steps"))
    read_value(profile.steps, *steps, "steps", Range{.low = 0, .high = 1, .low_open = true});
  return profile;
}

/// What a reading takes from the one that it is like: where episodes begin, what claims ask, and which ones. Its
/// studies are found by Reproduction::find.
PaperReading like_another(const Table& table, const Paper& paper) {
  PaperReading reading;
  if (!table.contains("like")) return reading;
  check_reading(paper, table, "like");
  reading.like = paper.reading(text_of(table, "like"));
  const PaperReading& other = paper.readings[*reading.like];
  reading.start = other.start;
  reading.asks = other.asks;
  reading.claims = other.claims;
  return reading;
}

/// The files of figures' studies that a reading replaces by others.
std::map<std::string, std::string> parse_files(const Table& table, Paper& paper) {
  std::map<std::string, std::string> files;
  const Value* value = table.find("files");
  if (value == nullptr) return files;
  for (const auto& [study, file] : value->as_table("files").items) {
    check_study(paper, {study, file.place});
    read_study(paper, file, study);
    files[study] = file.as_text(study);
  }
  return files;
}

PaperReading parse_reading(const Table& table, Paper& paper) {
  std::vector<std::string> known = {"name",    "says", "like",  "common", "settings", "figures", "files",
                                    "instead", "asks", "start", "median", "claims",   "printed"};
  const std::vector<std::string> figures = texts_of(table, "figures");
  known.insert(known.end(), figures.begin(), figures.end());
  check_keys(table, known, "a reading");
  PaperReading reading = like_another(table, paper);
  for (const std::string& figure : figures) {
    if (table.contains(figure)) reading.own[figure] = texts_of(table, figure);
  }
  reading.name = checked_name(table, "name", "a reading");
  check_folder_name(paper, reading, table.find("name")->place);
  reading.says = required_text(table, "says", "a reading");
  reading.common = texts_of(table, "common");
  reading.settings = texts_of(table, "settings");
  reading.figures = figures;
  if (table.contains("start")) reading.start = text_of(table, "start");
  reading.median = flag_of(table, "median");
  if (table.contains("claims")) reading.claims = texts_of(table, "claims");
  reading.printed = flag_of(table, "printed");
  reading.where = table.place;
  check_studies(paper, table, "figures");
  reading.files = parse_files(table, paper);
  if (const Value* instead = table.find("instead")) {
    for (const auto& [from, to] : instead->as_table("instead").items) reading.instead[from] = to.as_text(from);
  }
  if (const Value* asks = table.find("asks")) {
    for (const auto& [claim, formula] : asks->as_table("asks").items) {
      reading.asks.insert_or_assign(claim, Formula(formula.as_text(claim), formula.place));
      if (std::ranges::find(reading.claims, claim) == reading.claims.end()) reading.claims.push_back(claim);
    }
  }
  return reading;
}

std::vector<PaperMap> parse_maps(const Table& table) {
  std::vector<PaperMap> maps;
  if (!table.contains("heat")) return maps;
  for_each_table(table, "heat", [&](const Table& map) {
    check_keys(map, {"name", "policies", "sweep"}, "a heat map");
    maps.push_back({required_text(map, "name", "a heat map"), required_text(map, "policies", "a heat map"),
                    required_text(map, "sweep", "a heat map")});
    if (maps.back().policies.find("{level}") == std::string::npos)
      throw error_at(map.place, "'policies' must hold {level}");
  });
  return maps;
}

/// The parts of the page that a figure shows, each once.
std::vector<std::string> parse_shows(const Table& table) {
  const std::vector<std::string> known(chart_kinds().begin(), chart_kinds().end());
  std::vector<std::string> shows;
  const Value* list = table.find("shows");
  if (list == nullptr) return shows;
  for (const Value& item : list->as_list("shows")) {
    check_known(known, item, "part of a page");
    if (std::ranges::find(shows, item.as_text("shows")) != shows.end())
      throw error_at(item.place, "'", item.as_text("shows"), "' is shown twice");
    shows.push_back(item.as_text("shows"));
  }
  return shows;
}

/// The printed table of a figure, which tables.csv must have.
std::string parse_table(const Table& table, const Paper& paper) {
  const Value* name = table.find("table");
  if (name == nullptr) return {};
  std::vector<std::string> known;
  for (const PrintedValue& value : paper.tables) known.push_back(value.table);
  const std::string file = paper.files_from.place("tables.csv");
  if (!paper.files.contains("tables.csv")) throw error_at(name->place, "there is no ", file, ", which has its numbers");
  if (std::ranges::find(known, name->as_text("table")) == known.end())
    throw error_at(name->place, file, " has no table '", name->as_text("table"), "'",
                   did_you_mean(name->as_text("table"), known));
  return name->as_text("table");
}

PaperFigure parse_figure(const Table& table, Paper& paper) {
  check_keys(table,
             {"study", "reading", "place", "title", "says", "note", "shows", "heat", "table", "metric", "spread"},
             "a figure");
  PaperFigure figure;
  figure.study = required_text(table, "study", "a figure");
  read_study(paper, *table.find("study"), "study");
  if (paper.figure(figure.study) != nullptr)
    throw error_at(table.find("study")->place, "two figures have the study '", figure.study, "'");
  figure.reading = text_of(table, "reading");
  figure.place = required_text(table, "place", "a figure");
  figure.title = required_text(table, "title", "a figure");
  figure.says = required_text(table, "says", "a figure");
  figure.note = text_of(table, "note");
  figure.shows = parse_shows(table);
  figure.table = parse_table(table, paper);
  figure.metric =
      figure.table.empty() ? text_of(table, "metric") : required_text(table, "metric", "a figure with a table");
  if (const Value* spread = table.find("spread")) check_known({"episodes"}, *spread, "spread");
  figure.over_episodes = table.contains("spread");
  figure.maps = parse_maps(table);
  figure.where = table.place;
  return figure;
}

PaperClaim parse_claim(const Table& table, const Paper& paper) {
  check_keys(table,
             {"id", "figure", "from", "soft", "primary", "headline", "text", "metric", "reading", "holds", "missing"},
             "a claim");
  PaperClaim claim;
  claim.id = required_text(table, "id", "a claim");
  claim.text = required_text(table, "text", "a claim");
  claim.figure = required_text(table, "figure", "a claim");
  claim.from = texts_of(table, "from");
  if (claim.from.empty()) claim.from = {claim.figure};
  claim.soft = flag_of(table, "soft");
  claim.primary = flag_of(table, "primary");
  claim.headline = text_of(table, "headline");
  claim.metric = text_of(table, "metric");
  claim.reading = text_of(table, "reading");
  check_study(paper, *table.find("figure"));
  check_studies(paper, table, "from");
  check_reading(paper, table, "reading");
  if (const Value* holds = table.find("holds")) {
    claim.formula.emplace(holds->as_text("holds"), holds->place);
  } else {
    claim.missing = required_text(table, "missing", "a claim without 'holds'");
  }
  return claim;
}

PaperPremise parse_premise(const Table& table, const Paper& paper) {
  check_keys(table, {"of", "says", "claims", "from", "metric", "holds"}, "a premise");
  PaperPremise premise;
  premise.of = required_text(table, "of", "a premise");
  premise.says = required_text(table, "says", "a premise");
  premise.claims = texts_of(table, "claims");
  premise.from = texts_of(table, "from");
  premise.metric = text_of(table, "metric");
  if (premise.from.empty()) throw error_at(table.place, "a premise needs a 'from': the studies that it asks");
  check_studies(paper, table, "from");
  premise.formula.emplace(required_text(table, "holds", "a premise"), table.find("holds")->place);
  for (const std::string& id : premise.claims) {
    if (std::ranges::find(paper.claims, id, &PaperClaim::id) == paper.claims.end())
      throw error_at(table.place, "a premise speaks of ", id, ", which is no claim");
  }
  return premise;
}

/// The text of a file of the paper, which is kept; nothing where it is not there.
std::optional<std::string> text_from(Paper& paper, const std::string& name) {
  std::optional<std::string> text = paper.files_from.read(name);
  if (text) paper.files[name] = *text;
  return text;
}

std::string required_from(Paper& paper, const std::string& name) {
  const std::optional<std::string> text = text_from(paper, name);
  if (!text) throw Error(cat(paper.files_from.folder, ": is no paper: there is no ", paper.files_from.place(name)));
  return *text;
}

void parse_manifest(Paper& paper) {
  const Table table = parse_toml(required_from(paper, "paper.toml"), paper.files_from.place("paper.toml"));
  const Value* schema = table.find("schema");
  if (schema == nullptr || schema->as_int("schema") != 1)
    throw error_at(schema ? schema->place : table.place, "a paper begins with 'schema = 1'");
  check_keys(table, {"schema", "name", "title", "source", "note", "profile", "reading", "figure"}, "a paper");
  paper.name = required_text(table, "name", "a paper");
  check_file_name(*table.find("name"), "name");
  paper.title = required_text(table, "title", "a paper");
  paper.source = required_text(table, "source", "a paper");
  paper.note = text_of(table, "note");
  if (table.contains("profile"))
    for_each_table(table, "profile", [&](const Table& item) { paper.profiles.push_back(parse_profile(item)); });
  if (paper.profiles.empty()) paper.profiles = {{"paper", {}, 1.0}, {"quick", 2, 0.1}};
  for_each_table(table, "figure", [&](const Table& item) { paper.figures.push_back(parse_figure(item, paper)); });
  for_each_table(table, "reading", [&](const Table& item) { paper.readings.push_back(parse_reading(item, paper)); });
  for_each_table(table, "figure", [&](const Table& item) { check_reading(paper, item, "reading"); });
}

void parse_claims(Paper& paper) {
  const Table table = parse_toml(required_from(paper, "claims.toml"), paper.files_from.place("claims.toml"));
  check_keys(table, {"names", "claim", "premise"}, "the claims");
  if (const Value* names = table.find("names")) paper.names = parse_names(names->as_table("names"));
  for_each_table(table, "claim", [&](const Table& item) {
    PaperClaim claim = parse_claim(item, paper);
    if (std::ranges::find(paper.claims, claim.id, &PaperClaim::id) != paper.claims.end())
      throw error_at(item.place, "duplicate claim ", claim.id);
    paper.claims.push_back(std::move(claim));
  });
  if (table.contains("premise"))
    for_each_table(table, "premise", [&](const Table& item) { paper.premises.push_back(parse_premise(item, paper)); });
  for (const PaperReading& reading : paper.readings) {
    for (const std::string& id : reading.claims) {
      if (std::ranges::find(paper.claims, id, &PaperClaim::id) == paper.claims.end())
        throw error_at(reading.where, "the reading '", reading.name, "' speaks of ", id, ", which is no claim");
    }
  }
}

void parse_findings(Paper& paper) {
  const std::optional<std::string> text = text_from(paper, "findings.toml");
  if (!text) return;
  const Table table = parse_toml(*text, paper.files_from.place("findings.toml"));
  check_keys(table, {"finding"}, "the findings");
  for_each_table(table, "finding", [&](const Table& item) {
    PaperFinding finding = parse_finding(item);
    if (paper.finding(finding.measure) != nullptr)
      throw error_at(item.place, "two findings measure '", finding.measure, "'");
    paper.findings.push_back(std::move(finding));
  });
}

void parse_tables(Paper& paper) {
  const std::optional<std::string> text = text_from(paper, "tables.csv");
  if (!text) return;
  const CsvTable csv(*text, paper.files_from.place("tables.csv"));
  for (std::size_t i = 0; i < csv.size(); ++i) {
    paper.tables.push_back(
        {csv.text(i, "table"), csv.text(i, "row"), csv.text(i, "column"), csv.number(i, "mean"), csv.number(i, "std")});
  }
}

}  // namespace

bool PaperPremise::bears_on(const std::string& claim, const TruthPart& part) const {
  if (std::ranges::find(claims, claim) == claims.end()) return false;
  const auto speaks = [&](std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text.find(of) != std::string::npos;
  };
  return speaks(part.label) || speaks(part.statement);
}

std::size_t Paper::reading(std::string_view name) const {
  const auto at = std::ranges::find(readings, name, &PaperReading::name);
  return at == readings.end() ? 0 : static_cast<std::size_t>(at - readings.begin());
}

const PaperFinding* Paper::finding(std::string_view measure) const {
  const auto at = std::ranges::find(findings, measure, &PaperFinding::measure);
  return at == findings.end() ? nullptr : &*at;
}

const PaperFigure* Paper::figure(std::string_view study) const {
  const auto at = std::ranges::find(figures, study, &PaperFigure::study);
  return at == figures.end() ? nullptr : &*at;
}

Paper parse_paper(const PaperSource& from) {
  Paper paper;
  paper.asked = from.folder;
  paper.foreign = true;
  paper.files_from = from;
  parse_tables(paper);
  parse_manifest(paper);
  parse_claims(paper);
  parse_findings(paper);
  paper.checks = text_from(paper, "checks.md").value_or("");
  return paper;
}

const Paper& paper_at(std::string_view name) {
  static const Paper paper = [] {
    Paper known = parse_paper(embedded_source());
    known.asked = known.name;
    known.foreign = false;
    return known;
  }();
  if (name == paper.name) return paper;
  throw Error(cat("there is no reproduction '", name, "'", did_you_mean(name, std::vector<std::string>{paper.name}),
                  "; it is '", paper.name, "', or a folder with a paper.toml"));
}

Paper open_paper(const std::string& asked) {
  std::error_code unknown;
  if (asked != "paper" && std::filesystem::is_directory(asked, unknown)) return parse_paper(folder_source(asked));
  return paper_at(asked);
}

}  // namespace gust
