#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gust/paper/finding_words.h"
#include "gust/paper/paper_source.h"
#include "gust/stats/formula.h"

namespace gust {

/// What is to be run of a paper's studies: all of it, or a miniature.
struct PaperProfile {
  std::string name;
  std::optional<std::int64_t> seeds;  ///< of every training: 1 to this; else as the studies have them
  double steps = 1.0;                 ///< the share of every training's steps
};

/// One way to read what the paper leaves open.
struct PaperReading {
  std::string name;
  std::string says;
  std::optional<std::size_t> like;                      ///< the one that it takes all from that it does not change
  std::vector<std::string> common;                      ///< settings of all its studies
  std::vector<std::string> settings;                    ///< further ones; "{study}" stands for a study's name
  std::map<std::string, std::vector<std::string>> own;  ///< of one study, in place of those
  std::vector<std::string> figures;                     ///< whose studies it changes; all others are the main reading's
  std::map<std::string, std::string> files;             ///< the file of a figure's study, where it is another one
  std::map<std::string, std::string> instead;           ///< what claims ask for, and what they ask for here
  std::string start;                                    ///< where episodes begin; empty: drawn
  bool median = false;                                  ///< of the trainings in place of their mean
  std::map<std::string, Formula> asks;                  ///< what claims, by id, ask in place of their own formula
  std::vector<std::string> claims;                      ///< those that it bears on; empty: those whose data it changes
  bool printed = false;                                 ///< the paper's own tables instead of measurements
  Place where;                                          ///< it stands in paper.toml
};

/// A heat map made of the curves of policies that differ in one level.
struct PaperMap {
  std::string name;
  std::string policies;  ///< with "{level}" in it
  std::string sweep;

  /// The policy that was trained at a level.
  std::string policy(double level) const;
};

/// A figure or table of the paper: a study.
struct PaperFigure {
  std::string study;    ///< its file's name, without ".toml"
  std::string reading;  ///< the one that it is drawn under; empty: the main one
  std::string place;    ///< in the paper: "Figure 3"
  std::string title;
  std::string says;                ///< what the paper says about it
  std::string note;                ///< what to know of ours before one reads it; may be empty
  std::vector<std::string> shows;  ///< parts of the page: "curves", "grids", …
  std::vector<PaperMap> maps;
  std::string table;           ///< in tables.csv; empty if it is no table
  std::string metric;          ///< of the table's numbers
  bool over_episodes = false;  ///< the table's deviations are those of episodes
  Place where;                 ///< it stands in paper.toml
};

/// A statement of the paper.
struct PaperClaim {
  std::string id;
  std::string text;
  bool soft = false;              ///< the paper itself words it softly
  bool primary = false;           ///< named before the run as what the reproduction is about
  std::string headline;           ///< a sentence that the findings name it by; empty: they do not
  std::string figure;             ///< where it stands on the page
  std::vector<std::string> from;  ///< the studies that its scores come from
  std::string metric;             ///< of score(); empty: that of the first study's margins
  std::string reading;            ///< the one that decides; empty: the main one
  std::optional<Formula> formula;
  std::string missing;  ///< why there is no formula: the datum that nobody has
};

/// What the paper's claims about something take for granted. Where it did not happen in our runs, parts of claims that
/// speak of it cannot be compared.
struct PaperPremise {
  std::string of;                   ///< what parts speak of, as part of a name: "raac"
  std::string says;                 ///< a sentence: what the paper had, and we have not
  std::vector<std::string> claims;  ///< by id
  std::vector<std::string> from;    ///< the studies that the formula asks
  std::string metric;               ///< of score(); empty: that of the first study's margins
  std::optional<Formula> formula;

  bool bears_on(const std::string& claim, const TruthPart& part) const;
};

/// A number that the paper prints.
struct PrintedValue {
  std::string table, row, column;
  double mean = 0;
  double deviation = 0;  ///< NaN where the paper has none
};

/// All that makes the reproduction of a paper: studies/paper, compiled into the program, or a folder like it.
struct Paper {
  std::string name, title, source;
  std::string note;                    ///< what to know before one reads the findings; may be empty
  std::vector<PaperProfile> profiles;  ///< the first is what is run unless another is asked for
  std::vector<PaperReading> readings;  ///< the first is the main one
  std::vector<PaperFigure> figures;    ///< in the paper's order
  FormulaNames names;
  std::vector<PaperClaim> claims;
  std::vector<PaperPremise> premises;
  std::vector<PrintedValue> tables;
  std::vector<PaperFinding> findings;  ///< words of its own, each of another measurement
  std::string checks;                  ///< what else agrees with the paper's authors, as Markdown; may be empty

  std::string asked;                         ///< what `gust reproduce` is given for it: "paper", or its folder
  bool foreign = false;                      ///< it is not the one in the program
  PaperSource files_from;                    ///< where its files lie
  std::map<std::string, std::string> files;  ///< its texts by name: "paper.toml", "white.toml"

  const PaperFigure* figure(std::string_view study) const;
  /// Its words for a measurement; null where it has none.
  const PaperFinding* finding(std::string_view measure) const;
  /// Where a reading stands; the main one's place for an empty name.
  std::size_t reading(std::string_view name) const;
};

/// Reads paper.toml, claims.toml, the texts of all studies that these name, and tables.csv, findings.toml and checks.md
/// if they are there. Throws Error with file, line and column.
Paper parse_paper(const PaperSource& from);

/// The paper that the program knows, by name; an Error with the nearest name otherwise.
const Paper& paper_at(std::string_view name);

/// The same, or the paper of a folder.
Paper open_paper(const std::string& asked);

}  // namespace gust
