#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <sys/types.h>

#include "experiments/sweep/sweep.hpp"

// Rows on disk: DIRECTORY/rows/*.jsonl, one file per process that ran units. The first line names
// the process and its run; each further line is one complete unit.

namespace vantage::experiments {

/// A process that ran units.
struct RowProcess {
  std::string machine;  ///< name of its CPU
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
  std::vector<RowProcess> processes;  ///< by file name
  std::size_t torn = 0;               ///< last lines that a process did not finish
};

/// Returns one unit as a line of text; unit_of_line() parses it. The numbers in `rows` are text
/// already, so parsing returns exactly what was written.
std::string unit_line(const SweepPlan& plan, const Unit& unit, const UnitRows& rows);
/// Parses a line of unit_line().
/// @throws std::exception when the line is incomplete or names a setting that is not in `plan`
std::pair<Unit, UnitRows> unit_of_line(const SweepPlan& plan, const std::string& line);

/// Reads all rows in `directory`; none if there are no files. An incomplete last line and trials
/// beyond the plan's are left out.
/// @throws StartupError when another line is incomplete, a unit is present twice with different
/// rows, or a file is from another run (it was copied there)
StoredRows read_rows(const std::string& directory, const SweepPlan& plan,
                     const SweepIdentity& identity);

/// Writer that appends rows to a separate file. A line is safe against the end of the process (not
/// against loss of power) once append() has returned.
class RowWriter {
 public:
  /// @throws StartupError when the file cannot be created
  RowWriter(const std::string& directory, const RowProcess& process, const SweepIdentity& identity,
            const SweepPlan& plan);
  RowWriter(const RowWriter&) = delete;
  RowWriter& operator=(const RowWriter&) = delete;
  ~RowWriter();

  /// Appends one line.
  /// @throws std::runtime_error when it cannot be written; then nothing of the line is left
  void append(const std::string& line);

 private:
  std::string path_;
  int descriptor_ = -1;
  off_t whole_bytes_ = 0;
};

}  // namespace vantage::experiments
