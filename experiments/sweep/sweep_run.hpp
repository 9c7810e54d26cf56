#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/sweep/manifest.hpp"
#include "experiments/sweep/progress.hpp"
#include "experiments/sweep/sweep.hpp"

namespace vantage::experiments {

/// Options of run_sweep().
struct SweepOptions {
  std::string directory;
  int jobs = 1;
  std::optional<Shard> shard;  ///< if set: runs only this share and writes only rows
  /// Runs only settings with cells that begin with one of these texts, see begins_with_any(). Their
  /// rows and tables are written, but no summary, which needs all settings. Empty: all settings.
  std::vector<std::string> only;
  std::function<bool()> stop;  ///< called before each unit; true: stop; may be empty
  /// Called about once per second and after each unit; may be empty.
  std::function<void(const SweepProgress&)> progress;
};

struct SweepOutcome {
  SweepProgress progress;
  bool is_stopped = false;         ///< true: stopped before all units of the share were done
  std::vector<std::string> lines;  ///< lines to print
};

/// Runs the missing units of the share of `sweep` in the directory. The rows of a unit are written
/// as soon as the unit ends; units on disk are not run again. When no unit is missing and no shard
/// is set, it writes all results. The results are all tables and summary files as CSV, times.csv
/// and times.txt, the figures (if gnuplot is installed), report.md and the complete manifest. Equal
/// seeds and settings give equal files for any shards, jobs and interruptions, except for rows/,
/// manifest.json and times.*.
/// @throws StartupError when the directory belongs to another run, a file cannot be written, or an
/// entry of `only` matches no setting
SweepOutcome run_sweep(const Sweep& sweep, const SweepIdentity& identity, const std::string& what,
                       const SweepOptions& options);

}  // namespace vantage::experiments
