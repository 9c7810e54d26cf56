#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/sweep/sweep_run.hpp"

namespace vantage::experiments {

/// How a sweep is given to a Slurm cluster.
struct SlurmOptions {
  std::vector<std::string> command;  ///< as slurm_scripts() takes it
  int shards = 8;
  int cores_per_task = 1;
  std::vector<std::string> sbatch;  ///< options handed to sbatch as they are, after ours
  bool is_waiting = true;
  std::function<void(const std::string& line)> tell;
  /// About as often as the queue is asked; the text says what the jobs are doing.
  std::function<void(const SweepProgress&, const std::string& jobs)> progress;
};

enum class SlurmEnd {
  kCollected,  ///< all is done and written
  kSubmitted,  ///< jobs are in the queue, and nobody waits for them here
  kLacking,    ///< jobs have ended without all of their units
};

/// Runs `sweep` in options.directory, which all nodes must share, as an array of jobs, one for each
/// shard that lacks units, and a job after them that collects. What is still in the queue from an
/// earlier call is waited for, not submitted again; what is all done is collected here, without a
/// job. Once the array has ended, a caller that waits collects here. `options.stop` ends the
/// waiting only. DIRECTORY/slurm/ has scripts, logs and numbers of the jobs.
/// @throws StartupError with Slurm's own words when it does not take a job or cannot be asked, and
///   as run_sweep does
SlurmEnd run_on_slurm(const Sweep& sweep, const SweepIdentity& identity, const std::string& what,
                      const SweepOptions& options, const SlurmOptions& slurm);

}  // namespace vantage::experiments
