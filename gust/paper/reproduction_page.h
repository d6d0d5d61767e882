#pragma once

#include <string>
#include <utility>
#include <vector>

#include "gust/report/page.h"
#include "gust/stats/claim.h"

namespace gust {

/// A paper's reproduction as plain data, in the paper's own order; render_reproduction draws it. Texts are UTF-8 of any
/// content; they are escaped where they are drawn.
struct ReproductionPage {
  /// One way to read what the paper leaves open; claims are judged under each one that bears on them.
  struct Reading {
    std::string name;  ///< "scg-2022", "saturate before"
    std::string says;  ///< one sentence
  };

  struct Verdict {
    std::size_t reading = 0;
    Ruling ruling = Ruling::not_testable;
    Page::Estimate measured;
    std::size_t seeds = 0;                 ///< the fewest of any policy that was asked; 0 if none was trained
    std::string reason;                    ///< a sentence
    bool printed = false;                  ///< it is about the paper's own numbers, not ours
    double one_training = Page::kUnknown;  ///< how likely it is to be true of one training of each policy
    std::size_t parts = 0;                 ///< statements that the claim puts together; 0 where it could not be asked
    std::size_t true_parts = 0;            ///< those that are true, at the estimate
    std::size_t left_out_parts = 0;        ///< beside them: those whose premise did not happen here

    Grade grade() const { return grade_of(ruling, parts, true_parts, left_out_parts); }
  };

  struct Claim {
    std::string id;     ///< "C7"
    std::string place;  ///< where the paper says it
    std::string text;
    std::string formula;            ///< what was asked of the data; empty where nothing could be
    bool hard = true;               ///< stated as a fact, not in soft words
    std::vector<Verdict> verdicts;  ///< the main reading first
  };

  /// A value that the paper prints beside ours.
  struct TableCell {
    std::string row;
    std::string column;
    Page::Estimate printed;  ///< low and high: one standard deviation to each side, where the paper has it
    Page::Estimate ours;
    std::vector<double> trainings = {};  ///< ours, of each training alone
    double deviation = Page::kUnknown;   ///< ours, of episodes, as the paper's is
  };

  struct Figure {
    std::string id;     ///< "white", fit for an address
    std::string place;  ///< "Figure 3"
    std::string title;
    std::string says;                 ///< what the paper says about it, in our words
    std::string trained;              ///< sentences: how many seeds of each policy and for how long, what else to know
    std::vector<std::string> claims;  ///< ids; each claim belongs to one figure
    std::vector<TableCell> table;     ///< row by row
    std::string table_metric;         ///< what its numbers are
    bool over_episodes = true;        ///< what it prints as ± is the deviation of episodes, as ours is
    std::vector<std::string> shows;   ///< of chart_kinds(); what the page has no data for is left out
    Page page;                        ///< the charts' data
  };

  std::string title;
  std::string source;                 ///< the paper, as one cites it
  std::string note;                   ///< what to know of the verdicts; may be empty
  std::string label;                  ///< says at once if this is a miniature; empty for the full run
  std::vector<std::string> opening;   ///< what was found, in at most ten sentences
  std::vector<std::string> findings;  ///< what else the data show, a sentence each
  std::vector<std::string> warnings;  ///< what is missing or failed
  std::vector<Reading> readings;      ///< the first is the main one
  std::vector<Claim> claims;
  std::vector<Figure> figures;
  std::string run_command;
  std::vector<std::pair<std::string, std::string>> provenance;
};

/// One HTML file that needs nothing else, of less than 20 MB. Throws Bug where an index points outside its list, a
/// claim is unknown or belongs to two figures, or a figure shows what no chart is called.
std::string render_reproduction(const ReproductionPage& page);

}  // namespace gust
