#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/sweep/sweep_run.hpp"

namespace vantage::experiments {

/// Options of a sweep on a Slurm cluster.
struct SlurmOptions {
  std::vector<std::string> command;  ///< see slurm_scripts()
  int shards = 8;
  int cores_per_task = 1;
  std::vector<std::string> sbatch;  ///< options passed unchanged to sbatch, after our options
  bool is_waiting = true;
  std::function<void(const std::string& line)> print_line;
  /// Called about once per query of the queue; the text describes the jobs' states.
  std::function<void(const SweepProgress&, const std::string& jobs)> progress;
};

enum class SlurmEnd {
  kCollected,   ///< all units are done and the results are written
  kSubmitted,   ///< jobs are in the queue, and this call does not wait for them
  kIncomplete,  ///< jobs have ended with units missing
};

/// Runs `sweep` in options.directory, which all nodes must share. It submits an array of jobs, one
/// per shard with missing units, and a job that collects the results after them. Jobs that are
/// still in the queue from an earlier call are not submitted again, but waited for. If all units
/// are done, or after the array has ended while the caller waits, this process collects the results
/// itself. `options.stop` ends only the waiting, not the jobs. DIRECTORY/slurm/ contains the
/// scripts, logs and numbers of the jobs.
/// @throws StartupError with Slurm's message when it refuses a job or cannot be queried, and as
/// run_sweep() does
SlurmEnd run_on_slurm(const Sweep& sweep, const SweepIdentity& identity, const std::string& what,
                      const SweepOptions& options, const SlurmOptions& slurm);

}  // namespace vantage::experiments
