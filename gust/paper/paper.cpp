#include "gust/paper/paper.h"

#include <algorithm>
#include <cctype>

#include "gust/core/csv.h"
#include "gust/core/fields.h"
#include "gust/core/text.h"
#include "gust/paper/paper_files.h"
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

/// Checks that every name is one of a figure's studies.
void check_figures(const Paper& paper, const std::vector<std::string>& names, const Table& table) {
  std::vector<std::string> known;
  for (const PaperFigure& figure : paper.figures) known.push_back(figure.study);
  for (const std::string& name : names) {
    if (paper.figure(name) == nullptr)
      throw error_at(table.place, "unknown study '", name, "'", did_you_mean(name, known));
  }
}

/// Checks that a name is that of a reading, or empty.
void check_reading(const Paper& paper, const std::string& name, const Table& table) {
  std::vector<std::string> known;
  for (const PaperReading& reading : paper.readings) known.push_back(reading.name);
  if (!name.empty() && std::ranges::find(known, name) == known.end())
    throw error_at(table.place, "unknown reading '", name, "'", did_you_mean(name, known));
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
  const std::string name = text_of(table, "like");
  if (name.empty()) return reading;
  check_reading(paper, name, table);
  reading.like = paper.reading(name);
  const PaperReading& other = paper.readings[*reading.like];
  reading.start = other.start;
  reading.asks = other.asks;
  reading.claims = other.claims;
  return reading;
}

PaperReading parse_reading(const Table& table, const Paper& paper) {
  std::vector<std::string> known = {"name",    "says", "like",  "common", "settings", "figures", "files",
                                    "instead", "asks", "start", "median", "claims",   "printed"};
  const std::vector<std::string> figures = texts_of(table, "figures");
  known.insert(known.end(), figures.begin(), figures.end());
  check_keys(table, known, "a reading");
  PaperReading reading = like_another(table, paper);
  for (const std::string& figure : figures) {
    if (table.contains(figure)) reading.own[figure] = texts_of(table, figure);
  }
  reading.name = required_text(table, "name", "a reading");
  reading.says = required_text(table, "says", "a reading");
  reading.common = texts_of(table, "common");
  reading.settings = texts_of(table, "settings");
  reading.figures = figures;
  if (table.contains("start")) reading.start = text_of(table, "start");
  reading.median = flag_of(table, "median");
  if (table.contains("claims")) reading.claims = texts_of(table, "claims");
  reading.printed = flag_of(table, "printed");
  const auto texts_by_name = [&](std::string_view key, std::map<std::string, std::string>& into) {
    const Value* value = table.find(key);
    if (value == nullptr) return;
    for (const auto& [from, to] : value->as_table(key).items) into[from] = to.as_text(from);
  };
  texts_by_name("files", reading.files);
  texts_by_name("instead", reading.instead);
  if (const Value* asks = table.find("asks")) {
    for (const auto& [claim, formula] : asks->as_table("asks").items) {
      reading.asks.insert_or_assign(claim, Formula(formula.as_text(claim), formula.place));
      if (std::ranges::find(reading.claims, claim) == reading.claims.end()) reading.claims.push_back(claim);
    }
  }
  return reading;
}

PaperFigure parse_figure(const Table& table) {
  check_keys(table, {"study", "reading", "place", "title", "says", "note", "shows", "heat", "table", "metric"},
             "a figure");
  PaperFigure figure;
  figure.study = required_text(table, "study", "a figure");
  figure.reading = text_of(table, "reading");
  figure.place = required_text(table, "place", "a figure");
  figure.title = required_text(table, "title", "a figure");
  figure.says = required_text(table, "says", "a figure");
  figure.note = text_of(table, "note");
  figure.shows = texts_of(table, "shows");
  figure.table = text_of(table, "table");
  figure.metric = text_of(table, "metric");
  if (table.contains("heat")) {
    for_each_table(table, "heat", [&](const Table& map) {
      check_keys(map, {"name", "policies", "sweep"}, "a heat map");
      figure.maps.push_back({required_text(map, "name", "a heat map"), required_text(map, "policies", "a heat map"),
                             required_text(map, "sweep", "a heat map")});
      if (figure.maps.back().policies.find("{level}") == std::string::npos)
        throw error_at(map.place, "'policies' must hold {level}");
    });
  }
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
  check_figures(paper, {claim.figure}, table);
  check_figures(paper, claim.from, table);
  check_reading(paper, claim.reading, table);
  if (const Value* holds = table.find("holds")) {
    claim.formula.emplace(holds->as_text("holds"), holds->place);
  } else {
    claim.missing = required_text(table, "missing", "a claim without 'holds'");
  }
  return claim;
}

PaperPremise parse_premise(const Table& table, const Paper& paper) {
  check_keys(table, {"of", "says", "claims", "from", "holds"}, "a premise");
  PaperPremise premise{required_text(table, "of", "a premise"),
                       required_text(table, "says", "a premise"),
                       texts_of(table, "claims"),
                       texts_of(table, "from"),
                       {}};
  check_figures(paper, premise.from, table);
  premise.formula.emplace(required_text(table, "holds", "a premise"), table.find("holds")->place);
  for (const std::string& id : premise.claims) {
    if (std::ranges::find(paper.claims, id, &PaperClaim::id) == paper.claims.end())
      throw error_at(table.place, "a premise speaks of ", id, ", which is no claim");
  }
  return premise;
}

void parse_manifest(std::string_view text, Paper& paper) {
  const Table table = parse_toml(text, "paper.toml");
  const Value* schema = table.find("schema");
  if (schema == nullptr || schema->as_int("schema") != 1)
    throw error_at(table.place, "a paper begins with 'schema = 1'");
  check_keys(table, {"schema", "name", "title", "source", "note", "profile", "reading", "figure"}, "a paper");
  paper.name = required_text(table, "name", "a paper");
  paper.title = required_text(table, "title", "a paper");
  paper.source = required_text(table, "source", "a paper");
  paper.note = text_of(table, "note");
  for_each_table(table, "profile", [&](const Table& item) { paper.profiles.push_back(parse_profile(item)); });
  for_each_table(table, "figure", [&](const Table& item) { paper.figures.push_back(parse_figure(item)); });
  for_each_table(table, "reading", [&](const Table& item) {
    paper.readings.push_back(parse_reading(item, paper));
    check_figures(paper, paper.readings.back().figures, item);
    for (const auto& [study, file] : paper.readings.back().files) check_figures(paper, {study}, item);
  });
  for (const PaperFigure& figure : paper.figures) check_reading(paper, figure.reading, table);
}

void parse_claims(std::string_view text, Paper& paper) {
  const Table table = parse_toml(text, "claims.toml");
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
        throw error_at(table.place, "the reading '", reading.name, "' speaks of ", id, ", which is no claim");
    }
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

const PaperFigure* Paper::figure(std::string_view study) const {
  const auto at = std::ranges::find(figures, study, &PaperFigure::study);
  return at == figures.end() ? nullptr : &*at;
}

Paper parse_paper(const PaperFiles& files) {
  Paper paper;
  parse_manifest(files.manifest, paper);
  parse_claims(files.claims, paper);
  paper.checks = files.checks;
  const CsvTable csv(files.tables, "tables.csv");
  for (std::size_t i = 0; i < csv.size(); ++i) {
    paper.tables.push_back(
        {csv.text(i, "table"), csv.text(i, "row"), csv.text(i, "column"), csv.number(i, "mean"), csv.number(i, "std")});
  }
  return paper;
}

const Paper& paper_at(std::string_view name) {
  static const Paper paper = parse_paper(
      {paper_file("paper.toml"), paper_file("claims.toml"), paper_file("tables.csv"), paper_file("checks.md")});
  if (name == paper.name) return paper;
  throw Error(cat("there is no reproduction '", name, "'", did_you_mean(name, std::vector<std::string>{paper.name}),
                  "; it is 'paper'"));
}

std::string_view paper_study(std::string_view study) { return paper_file(cat(study, ".toml")); }

}  // namespace gust
