#include "gust/study/summary/export.h"

#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>

#include "gust/core/csv.h"
#include "gust/core/text.h"
#include "gust/store/files.h"
#include "gust/store/rows.h"
#include "gust/study/trials/margin_trial.h"
#include "gust/study/trials/trial_check.h"
#include "gust/study/trials/trials.h"

namespace gust {
namespace {

namespace fs = std::filesystem;

ExportRow head_of(const Study& study, const Trial& trial) {
  return export_head(study, trial.policy, trial.member, trial.sweep);
}

void set_levels(const Study& study, const Trial& trial, std::size_t cell, ExportRow& row) {
  if (trial.sweep == Trial::kNominal) return;
  const std::vector<double> at = study.sweeps[trial.sweep].at(cell);
  row.level = at[0];
  if (at.size() == 2) row.level_2 = at[1];
}

using TakeRow = std::function<void(const ExportRow&)>;

/// One cell of one member; the row says which.
void export_cell(const RowsHeader& header, std::span<const double> values, ExportRow& row, const TakeRow& take) {
  std::size_t i = 0;
  for (const std::string& start : header.starts) {
    row.start = start;
    for (row.episode = 0; row.episode < static_cast<std::int64_t>(header.episodes); ++row.episode) {
      for (const std::string& metric : header.metrics) {
        row.metric = metric;
        row.value = values[i++];
        take(row);
      }
    }
  }
}

void export_trial(const Study& study, const Trial& trial, const StoredTrial& stored, const TakeRow& take) {
  std::ifstream stream = stored.open(kRowsFile);
  RowsReader rows(stream, (stored.folder / kRowsFile).string());
  ExportRow row = head_of(study, trial);
  try {
    for (std::size_t cell = 0; cell < rows.header().cells; ++cell) {
      const std::span<const double> values = rows.next();
      set_levels(study, trial, cell, row);
      export_cell(rows.header(), values, row, take);
    }
  } catch (const Error& error) {
    throw Error(cat(error.what(), Store::remedy(stored.folder.parent_path().parent_path())));
  }
}

/// The levels that a margin asked for, of all its members; those that the sweep has itself stand there already.
void export_margin(const Study& study, const Plan& plan, const Trial& trial, const StoredTrial& stored,
                   const TakeRow& take) {
  const std::vector<double>& own = study.sweeps[trial.sweep].axes.front().values;
  std::vector<ExportRow> heads;
  for (const std::size_t input : trial.inputs) {
    if (plan.trials[input].sweep == trial.sweep) heads.push_back(head_of(study, plan.trials[input]));
  }
  for_each_margin_level(study, trial, stored, [&](double level, const MemberRows& rows) {
    if (std::ranges::find(own, level) != own.end()) return;
    for (std::size_t member = 0; member < rows.members(); ++member) {
      heads[member].level = level;
      export_cell(rows.header(member), rows.cell(member), heads[member], take);
    }
  });
}

/// A file beside another one, which it can replace; SQLite writes by name, to nothing but regular files. It vanishes
/// with the object.
class AsideFile {
 public:
  explicit AsideFile(const fs::path& file)
      : file_(link_target(file)), path_(file_.parent_path() / cat(".", file_.filename().string(), ".part")) {
    if (is_stream(file_)) throw Error(cat(file.string(), ": is no regular file"));
    std::error_code error;
    fs::remove(path_, error);
  }
  ~AsideFile() {
    std::error_code error;
    fs::remove(path_, error);
  }
  AsideFile(const AsideFile&) = delete;
  AsideFile& operator=(const AsideFile&) = delete;

  const fs::path& path() const { return path_; }
  void replace() const {
    if (std::rename(path_.c_str(), file_.c_str()) != 0) throw file_error(file_, "cannot write");
  }

 private:
  fs::path file_, path_;
};

/// A small owner of an SQLite connection; every failure is an Error that names the file.
class Database {
 public:
  explicit Database(const fs::path& file) : name_(file.string()) { check(sqlite3_open(name_.c_str(), &handle_)); }
  ~Database() {
    sqlite3_finalize(statement_);
    sqlite3_close(handle_);
  }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void execute(const char* sql) { check(sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr)); }
  void prepare(const char* sql) {
    sqlite3_finalize(statement_);
    statement_ = nullptr;
    check(sqlite3_prepare_v2(handle_, sql, -1, &statement_, nullptr));
  }
  void bind(int column, const std::string& text) {
    check(sqlite3_bind_text(statement_, column, text.c_str(), static_cast<int>(text.size()), SQLITE_TRANSIENT));
  }
  void bind(int column, std::int64_t number) { check(sqlite3_bind_int64(statement_, column, number)); }
  void bind(int column, double number) { check(sqlite3_bind_double(statement_, column, number)); }
  void insert() {
    if (sqlite3_step(statement_) != SQLITE_DONE) check(sqlite3_errcode(handle_));
    check(sqlite3_reset(statement_));
  }

 private:
  void check(int code) {
    if (code != SQLITE_OK) throw Error(cat(name_, ": ", handle_ ? sqlite3_errmsg(handle_) : "cannot be opened"));
  }

  std::string name_;
  sqlite3* handle_ = nullptr;
  sqlite3_stmt* statement_ = nullptr;
};

void insert_learning(Database& database, const Study& study, const Plan& plan, const Store& store) {
  std::string places = "?,?,?,?";
  for (std::size_t i = 0; i < std::size(kCurveColumns); ++i) places += ",?";
  database.prepare(cat("INSERT INTO learning VALUES (", places, ")").c_str());
  for (const Trial& trial : plan.trials) {
    if (trial.kind != Trial::Kind::kTrain) continue;
    const std::optional<StoredTrial> stored = load_trial(plan, trial, store);
    if (!stored) continue;
    for (const CurvePoint& point : read_curve(stored->read(kCurveFile), kCurveFile)) {
      database.bind(1, study.policies[trial.policy].name);
      database.bind(2, study.policies[trial.policy].training()->seeds[trial.member]);
      database.bind(3, point.steps);
      int column = 3;
      for (const CurveColumn& of_curve : kCurveColumns) database.bind(++column, point.*of_curve.value);
      database.bind(++column, point.protagonist_steps);
      database.insert();
    }
  }
}

}  // namespace

ExportRow export_head(const Study& study, std::size_t policy, std::size_t member, std::size_t sweep_index) {
  ExportRow row;
  row.plant = study.setup.plant.kind;
  row.preset = study.setup.preset.empty() ? "none" : study.setup.preset;
  row.readings = study.setup.preset.empty() ? "none" : study.setup.readings_text();
  row.policy = study.policies[policy].name;
  row.seed = study.policies[policy].member(member);
  for (std::string* text : {&row.sweep, &row.site, &row.channels, &row.waveform, &row.window}) *text = "none";
  if (sweep_index == Trial::kNominal) return row;
  const Sweep& sweep = study.sweeps[sweep_index];
  const Interface& spec = study.setup.plant->spec();
  row.sweep = sweep.name;
  row.site = "parameters";
  if (const std::optional<Injection>& injection = sweep.injection) {
    row.site = site_name(injection->site);
    row.channels = channels_text(*injection, spec);
    row.waveform = injection->shape();
    row.window = cat(injection->start, ":", std::min(injection->end, spec.steps));
  }
  if (!sweep.along_levels()) {
    for (const Sweep::Axis& axis : sweep.axes) row.vary += cat(row.vary.empty() ? "" : "*", axis.name());
  }
  const std::string setting = sweep.setting(spec);
  if (!setting.empty()) row.vary += cat(row.vary.empty() ? "" : ", ", setting);
  return row;
}

std::vector<std::size_t> for_each_export_row(const Study& study, const Plan& plan, const Store& store,
                                             const TakeRow& take) {
  std::vector<std::size_t> missing;
  bool any = false;
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    const Trial& trial = plan.trials[i];
    const std::optional<StoredTrial> stored = load_trial(plan, trial, store);
    any = any || (stored && trial.kind == Trial::Kind::kEvaluate);
    if (!stored) missing.push_back(i);
    if (stored && trial.kind == Trial::Kind::kMargin) export_margin(study, plan, trial, *stored, take);
    if (stored && trial.kind == Trial::Kind::kEvaluate) export_trial(study, trial, *stored, take);
  }
  if (any) return missing;
  throw Error(cat("'", plan.trials[missing.front()].what, "' is not in the store; run the study first (gust run)"));
}

std::vector<std::size_t> export_csv(const Study& study, const Plan& plan, const Store& store, const fs::path& file) {
  AtomicFile out(file);
  out.append(cat(kExportHead, "\n"));
  std::vector<std::size_t> missing = for_each_export_row(study, plan, store, [&](const ExportRow& row) {
    out.append(csv_line({row.plant, row.preset, row.readings, row.policy, row.seed, row.sweep, row.site, row.channels,
                         row.waveform, row.window, row.vary, std::isnan(row.level_2) ? "" : cat(row.level_2),
                         cat(row.level), row.start, cat(row.episode), row.metric, cat(row.value)}));
  });
  out.commit();
  return missing;
}

std::vector<std::size_t> export_sqlite(const Study& study, const Plan& plan, const Store& store, const fs::path& file) {
  const AsideFile aside(file);
  std::vector<std::size_t> missing;
  {
    Database database(aside.path());
    database.execute("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; BEGIN");
    database.execute(
        "CREATE TABLE episodes (plant TEXT, preset TEXT, readings TEXT, policy TEXT, seed TEXT, sweep TEXT, "
        "site TEXT, channels TEXT, waveform TEXT, \"window\" TEXT, vary TEXT, level_2 REAL, level REAL, start TEXT, "
        "episode INTEGER, metric TEXT, value REAL)");
    std::string columns;
    for (const CurveColumn& column : kCurveColumns) columns += cat(column.name, " REAL, ");
    const std::string head = "CREATE TABLE learning (policy TEXT, seed INTEGER, steps INTEGER, ";
    database.execute(cat(head, columns, "protagonist_steps INTEGER)").c_str());
    database.execute("CREATE TABLE missing (trial TEXT)");
    database.prepare("INSERT INTO episodes VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
    missing = for_each_export_row(study, plan, store, [&](const ExportRow& row) {
      int column = 0;
      for (const std::string* text : {&row.plant, &row.preset, &row.readings, &row.policy, &row.seed, &row.sweep,
                                      &row.site, &row.channels, &row.waveform, &row.window, &row.vary})
        database.bind(++column, *text);
      for (const double level : {row.level_2, row.level}) database.bind(++column, level);  // NaN becomes NULL
      database.bind(++column, row.start);
      database.bind(++column, row.episode);
      database.bind(++column, row.metric);
      database.bind(++column, row.value);
      database.insert();
    });
    insert_learning(database, study, plan, store);
    database.prepare("INSERT INTO missing VALUES (?)");
    for (const std::size_t trial : missing) {
      database.bind(1, plan.trials[trial].what);
      database.insert();
    }
    database.execute("COMMIT");
  }
  aside.replace();
  return missing;
}

}  // namespace gust
