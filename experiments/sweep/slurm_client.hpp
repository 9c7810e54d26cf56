#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/result.hpp"

// Slurm's own commands: sbatch, squeue, scancel.

namespace vantage::experiments {

/// The array of shards, and the job that collects them.
struct SlurmJobs {
  std::string array;      ///< number; empty: none was submitted
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

/// The number that the job got from `sbatch OPTIONS SCRIPT`.
/// @throws StartupError with Slurm's own words when it takes no job, or is not here
std::string submit_job(const std::vector<std::string>& options, const std::string& script);

/// The Error is squeue's when it cannot be asked.
Result<SlurmQueue> ask_queue(const SlurmJobs& jobs);

/// scancel; that a job has ended already is as good.
void cancel_jobs(const std::vector<std::string>& arguments);

}  // namespace vantage::experiments
