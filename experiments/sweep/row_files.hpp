#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <sys/types.h>

#include "experiments/sweep/sweep.hpp"

// Rows are stored in DIRECTORY/rows/*.jsonl, one file per process that ran units. The first line
// names the process and its run; each further line is one complete unit.

namespace vantage::experiments {

/// A process that ran units.
struct RowProcess {
  std::string machine;  ///< name of the machine's CPU
  int cores = 0;
  int jobs = 1;
  std::string shard;    ///< "1/4"
  std::string started;  ///< UTC, ISO 8601
  std::size_t units = 0;
  double cpu_s = 0.0;
};

/// Content of the row files of a directory.
struct StoredRows {
  std::map<Unit, UnitRows> done;
  std::vector<RowProcess> processes;  ///< processes, sorted by file name
  std::size_t torn = 0;               ///< number of incomplete last lines
};

/// Returns one unit as a line of text; unit_of_line() parses it. The numbers in `rows` are already
/// text, so parsing returns exactly the same rows.
std::string unit_line(const SweepPlan& plan, const Unit& unit, const UnitRows& rows);
/// Parses a line of unit_line().
/// @throws std::exception when the line is incomplete or names a setting that is not in `plan`
std::pair<Unit, UnitRows> unit_of_line(const SweepPlan& plan, const std::string& line);

/// Reads all rows in `directory`; returns none if it has no files. Omits an incomplete last
/// line, and trials beyond the number in the plan.
/// @throws StartupError when another line is incomplete, a unit is present twice with different
/// rows, or a file is from another run (it was copied there)
StoredRows read_rows(const std::string& directory, const SweepPlan& plan,
                     const SweepIdentity& identity);

/// Writer that appends rows to a separate file. When append() has returned, the line survives the
/// end of the process, but not a loss of power.
class RowWriter {
 public:
  /// @throws StartupError when the file cannot be created
  RowWriter(const std::string& directory, const RowProcess& process, const SweepIdentity& identity,
            const SweepPlan& plan);
  RowWriter(const RowWriter&) = delete;
  RowWriter& operator=(const RowWriter&) = delete;
  ~RowWriter();

  /// Appends one line.
  /// @throws std::runtime_error when the line cannot be written; a partly written line is removed
  void append(const std::string& line);

 private:
  std::string path_;
  int descriptor_ = -1;
  off_t whole_bytes_ = 0;
};

}  // namespace vantage::experiments
