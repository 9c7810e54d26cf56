#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace vantage::experiments {

/// Size of an experiment's run.
struct Extent {
  int trials = 0;  ///< number of trials per setting; 0: as in the dissertation
  /// True: two trials and shortened horizons with the same code, to test that the experiment runs.
  bool is_smoke = false;
  /// Share, in (0, 1], of the dissertation's planning time, for experiments that convert this time
  /// into nodes.
  double planning_share = 1.0;
  /// Returns the number of trials, `usual` by default.
  [[nodiscard]] int trials_or(int usual) const {
    return is_smoke ? 2 : trials > 0 ? trials : usual;
  }
};

/// One setting of the trials.
struct Setting {
  std::string cells;     ///< values in the columns that name a setting: "10,2,rain"; unique
  bool is_once = false;  ///< true: only one trial, because the setting has no randomness
};

/// Settings and trials of a sweep, and the parameters in its manifest.
struct SweepPlan {
  std::string setting_columns;  ///< "robots,attacks,method"
  std::vector<Setting> settings;
  int trials = 0;
  /// All inputs that affect a unit's rows, in addition to setting, seed and trial.
  std::map<std::string, std::string> parameters;
  /// Columns of each table, by table name, without the columns of setting and trial.
  std::map<std::string, std::string> tables;
};

/// Identity that all processes in one directory must share. The number of trials is not part of it:
/// a run with more trials continues one with fewer.
struct SweepIdentity {
  std::string experiment;
  std::string version;
  std::uint64_t seed = 1;
  bool is_smoke = false;
  double planning_share = 1.0;
};

/// Smallest piece of work: one trial of one setting.
struct Unit {
  std::size_t setting = 0;  ///< index into SweepPlan::settings
  int trial = 0;
  friend auto operator<=>(const Unit&, const Unit&) = default;
};

/// Results of a unit.
struct UnitRows {
  /// Rows of each table, by its name: comma-separated cells, without setting and trial.
  std::map<std::string, std::vector<std::string>> tables;
  /// CPU time of each part of the unit, s; the only values that differ between runs.
  std::vector<std::pair<std::string, double>> times_s;
};

/// One row read from a file.
struct Record {
  Unit unit;
  std::vector<std::string> cells;
  /// Returns a cell as a number.
  /// @throws std::runtime_error when the cell is not a number
  [[nodiscard]] double number(std::size_t column) const;
};

/// Rows of all units by table, ordered by setting, trial and the order within the unit. The table
/// "times" has the columns part and CPU seconds.
using Tables = std::map<std::string, std::vector<Record>>;

/// Comparison of one of our values with the value in the dissertation.
struct Compared {
  std::string what;
  std::string ours;
  std::string printed;
  std::string deviation;
};

/// Results computed from all rows. All members except `time_lines` are independent of the table
/// "times".
struct Summary {
  std::map<std::string, std::string> files;  ///< by name: CSV files and the inputs of the figures
  std::string figure_script;  ///< gnuplot script, to be run in the files' directory; may be empty
  std::vector<std::string> figures;  ///< names of the SVG and PNG files that it draws
  std::vector<Compared> compared;
  std::vector<std::string> choices;  ///< choices for unstated parameters, and deviations
  std::vector<std::string> lines;    ///< lines to print at the end
  std::vector<std::string> time_lines;
};

/// An experiment with a given extent.
struct Sweep {
  SweepPlan plan;
  /// Runs one unit. The result depends only on the setting and `seed`, except for the times. Called
  /// from several threads.
  std::function<UnitRows(std::size_t setting, std::uint64_t seed)> run;
  std::function<Summary(const Tables& tables)> summarise;
};

/// Share of the units that one process runs: the `number`-th of `of`, counted from 1.
struct Shard {
  int number = 1;
  int of = 1;
};

/// Returns the units of `shard` in the order of execution: the first trial of every setting, then
/// the second and so on. This order allows an early estimate of the remaining time. Every shard
/// contains units of each setting; together the shards contain each unit once.
std::vector<Unit> units_of(const SweepPlan& plan, const Shard& shard);

/// True if the cells of `setting` equal or begin with one of `beginnings`, cell by cell: "a,1"
/// begins "a,1,x", but not "a,10". True if `beginnings` is empty.
bool begins_with_any(const Setting& setting, const std::vector<std::string>& beginnings);

/// Returns the cells of the rows of `done` by table, including "times".
Tables tables_of(const SweepPlan& plan, const std::map<Unit, UnitRows>& done);
/// Returns `records` of the table `name` as CSV with a header.
std::string csv_of(const SweepPlan& plan, const std::string& name,
                   const std::vector<Record>& records);
/// Returns `text` split at its commas.
std::vector<std::string> cells_of(const std::string& text);

}  // namespace vantage::experiments
