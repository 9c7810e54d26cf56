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

/// How much of an experiment is run.
struct Extent {
  int trials = 0;         ///< of each setting; 0: as the dissertation
  bool is_smoke = false;  ///< two trials, shortened horizons, the same code: does it run at all
  /// Of the time for planning that the dissertation gives, in (0, 1]; of experiments that turn such
  /// a time into nodes.
  double planning_share = 1.0;
  /// `usual` unless told otherwise.
  [[nodiscard]] int trials_or(int usual) const {
    return is_smoke ? 2 : trials > 0 ? trials : usual;
  }
};

/// One way in which trials are run.
struct Setting {
  std::string cells;     ///< its text in the columns that name a setting: "10,2,rain"; unique
  bool is_once = false;  ///< the first trial only: nothing in it is random
};

/// All that is to be run, and what of it goes to the manifest.
struct SweepPlan {
  std::string setting_columns;  ///< "robots,attacks,method"
  std::vector<Setting> settings;
  int trials = 0;
  /// Everything besides setting, seed and trial that a unit's rows depend on.
  std::map<std::string, std::string> parameters;
  /// Columns of each table of rows, those of setting and trial not among them.
  std::map<std::string, std::string> tables;
};

/// What every process that works in one directory must agree on. How many trials are run is not of
/// it: more of them go on from where fewer ended.
struct SweepIdentity {
  std::string experiment;
  std::string version;
  std::uint64_t seed = 1;
  bool is_smoke = false;
  double planning_share = 1.0;
};

/// The least that is run at once: one trial of one setting.
struct Unit {
  std::size_t setting = 0;  ///< index into SweepPlan::settings
  int trial = 0;
  friend auto operator<=>(const Unit&, const Unit&) = default;
};

/// What a unit leaves behind.
struct UnitRows {
  /// By the table's name: rows, each its cells with commas between, setting and trial left out.
  std::map<std::string, std::vector<std::string>> tables;
  /// CPU seconds of its parts: the only thing in it that differs from run to run.
  std::vector<std::pair<std::string, double>> times_s;
};

/// One row as it is read back.
struct Record {
  Unit unit;
  std::vector<std::string> cells;
  /// @throws std::runtime_error when that cell is no number
  [[nodiscard]] double number(std::size_t column) const;
};

/// The rows of all units by table, ordered by setting, trial and the order within the unit; those
/// of the table "times" are (part, CPU seconds).
using Tables = std::map<std::string, std::vector<Record>>;

/// A value of ours set beside what the dissertation says.
struct Compared {
  std::string what;
  std::string ours;
  std::string printed;
  std::string deviation;
};

/// What all rows together say. All but `time_lines` is a function of the rows other than "times".
struct Summary {
  std::map<std::string, std::string> files;  ///< by name: CSV, and what the figures read
  std::string figure_script;                 ///< gnuplot, to be run among the files; may be empty
  std::vector<std::string> figures;          ///< that it draws: names of SVG and PNG files
  std::vector<Compared> compared;
  std::vector<std::string> choices;  ///< what the source leaves open or is done otherwise
  std::vector<std::string> lines;    ///< what to tell at the end
  std::vector<std::string> time_lines;
};

/// An experiment at one extent.
struct Sweep {
  SweepPlan plan;
  /// A pure function of the setting and `seed` but for the times. Called from several threads.
  std::function<UnitRows(std::size_t setting, std::uint64_t seed)> run;
  std::function<Summary(const Tables& tables)> summarise;
};

/// A part of the units that one process runs: the `number`-th of `of`, counted from 1.
struct Shard {
  int number = 1;
  int of = 1;
};

/// The units of `shard` in the order in which they are run: the first trial of every setting, then
/// the second …, so that the time left can be told early. Every shard has its share of each
/// setting; together they are all units, once.
std::vector<Unit> units_of(const SweepPlan& plan, const Shard& shard);

/// Whether the cells of `setting` are or begin with one of `beginnings`, cell by cell: "a,1" begins
/// "a,1,x", not "a,10"; of no beginnings: yes.
bool begins_with_any(const Setting& setting, const std::vector<std::string>& beginnings);

/// Cells of the rows of `done` by table; "times" as well.
Tables tables_of(const SweepPlan& plan, const std::map<Unit, UnitRows>& done);
/// `records` of the table `name` as CSV, with a header.
std::string csv_of(const SweepPlan& plan, const std::string& name,
                   const std::vector<Record>& records);
/// `text` parted at its commas.
std::vector<std::string> cells_of(const std::string& text);

}  // namespace vantage::experiments
