#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/sweep/manifest.hpp"
#include "experiments/sweep/progress.hpp"
#include "experiments/sweep/sweep.hpp"

namespace vantage::experiments {

/// Where and how units are run.
struct SweepOptions {
  std::string directory;
  int jobs = 1;
  std::optional<Shard> shard;  ///< run this share, write rows only
  /// Beginnings of settings' cells (begins_with_any): run those alone, and write their rows and
  /// tables but no summary, which is of all settings. Empty: all.
  std::vector<std::string> only;
  std::function<bool()> stop;  ///< asked before each unit; may be empty
  /// Told about once a second and after each unit; may be empty.
  std::function<void(const SweepProgress&)> progress;
};

struct SweepOutcome {
  SweepProgress progress;
  bool is_stopped = false;         ///< before all of the share was done
  std::vector<std::string> lines;  ///< what to tell
};

/// Runs what is not done yet of the share of `sweep` in the directory. Rows are on disk as each
/// unit ends; those that are there are not run again. Once no unit is left, and no shard was asked
/// for, writes each table and the summary's files as CSV, times.csv and times.txt, figures (where
/// gnuplot is there), report.md and the whole manifest. Equal seeds and settings leave equal files
/// whatever the shards, jobs and interruptions, but for rows/, manifest.json and times.*.
/// @throws StartupError when the directory is another run's, a file cannot be written, or one of
///   `only` begins no setting
SweepOutcome run_sweep(const Sweep& sweep, const SweepIdentity& identity, const std::string& what,
                       const SweepOptions& options);

}  // namespace vantage::experiments
