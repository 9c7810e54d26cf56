#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <sys/types.h>

#include "experiments/sweep/sweep.hpp"

// Rows on disk: DIRECTORY/rows/*.jsonl, a file for each process that ran units. The first line
// says which process and of which run, every further one is a whole unit.

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

/// What the files of a directory hold.
struct StoredRows {
  std::map<Unit, UnitRows> done;
  std::vector<RowProcess> processes;  ///< by file name
  std::size_t torn = 0;               ///< last lines that a process did not live to finish
};

/// One unit as a line of text, and back. The numbers of `rows` are text already, so that what was
/// read back is what was written.
std::string unit_line(const SweepPlan& plan, const Unit& unit, const UnitRows& rows);
/// @throws std::exception when the line is not whole or names a setting that `plan` has not
std::pair<Unit, UnitRows> unit_of_line(const SweepPlan& plan, const std::string& line);

/// Reads all rows in `directory`; none where there are no files. A last line that is not whole is
/// left out; trials beyond the plan's are, too.
/// @throws StartupError when another line is not whole, a unit is there twice with other rows, or
///   a file is of another run (it was copied there)
StoredRows read_rows(const std::string& directory, const SweepPlan& plan,
                     const SweepIdentity& identity);

/// Appends to a file of its own. What append() has returned from outlives the process (not the
/// loss of power).
class RowWriter {
 public:
  /// @throws StartupError when the file cannot be made
  RowWriter(const std::string& directory, const RowProcess& process, const SweepIdentity& identity,
            const SweepPlan& plan);
  RowWriter(const RowWriter&) = delete;
  RowWriter& operator=(const RowWriter&) = delete;
  ~RowWriter();

  /// @throws std::runtime_error when the disk takes no more; then nothing is left of the line
  void append(const std::string& line);

 private:
  std::string path_;
  int descriptor_ = -1;
  off_t whole_bytes_ = 0;
};

}  // namespace vantage::experiments
