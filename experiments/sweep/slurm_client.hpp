#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/result.hpp"

// Slurm's own commands: sbatch, squeue, scancel.

namespace vantage::experiments {

/// The array of shards, and the job that collects them.
struct SlurmJobs {
  std::string array;      ///< as job_of() has it; empty: none was submitted
  std::string collector;  ///< likewise
  int shards = 0;         ///< into how many the sweep was parted
  /// "jobs 12 and 13 are".
  [[nodiscard]] std::string are() const;
};

/// What Slurm knows of them: all until a few minutes after their end, then nothing.
struct SlurmQueue {
  std::map<int, std::string> tasks;  ///< state by shard
  std::string collector;             ///< state; empty: not known
  /// Whether the state of a task is one of those, as is_live().
  [[nodiscard]] bool has_task(bool (*rule)(const std::string& state)) const;
  /// "tasks: 3 running, 5 waiting".
  [[nodiscard]] std::string describe() const;
};

/// Returns the job that `sbatch OPTIONS SCRIPT` made, as job_of() has it.
/// @throws StartupError with Slurm's own words when it takes no job, or is not here
std::string submit_job(const std::vector<std::string>& options, const std::string& script);

/// Asks the cluster that the jobs were submitted to. The Error is squeue's when it cannot be asked.
Result<SlurmQueue> ask_queue(const SlurmJobs& jobs);

/// Cancels the job on its cluster, with more options for scancel; that it has ended already is as
/// good.
void cancel_job(const std::string& job, const std::vector<std::string>& options = {});
/// The command that cancels both.
std::string cancel_command(const SlurmJobs& jobs);

}  // namespace vantage::experiments
