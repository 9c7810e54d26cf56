#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/result.hpp"

// Calls of the Slurm commands sbatch, squeue and scancel.

namespace vantage::experiments {

/// The array job that runs the shards, and the job that collects their rows.
struct SlurmJobs {
  std::string array;      ///< format of job_of(); empty: nothing was submitted
  std::string collector;  ///< format of job_of(); empty: nothing was submitted
  int shards = 0;         ///< number of shards of the sweep
  /// Returns the beginning of a sentence about the jobs: "jobs 12 and 13 are".
  [[nodiscard]] std::string subject_and_verb() const;
};

/// States of the array job and of the collecting job in Slurm. Slurm reports the states until a few
/// minutes after the jobs' end.
struct SlurmQueue {
  std::map<int, std::string> tasks;  ///< state by shard
  std::string collector;             ///< state; empty: unknown
  /// True if a task is in a state for which `rule` (such as is_live()) is true.
  [[nodiscard]] bool has_task(bool (*rule)(const std::string& state)) const;
  /// Returns "tasks: 3 running, 5 waiting".
  [[nodiscard]] std::string describe() const;
};

/// Runs `sbatch OPTIONS SCRIPT` and returns the job in the format of job_of().
/// @throws StartupError with Slurm's message when it refuses the job, or sbatch is not installed
std::string submit_job(const std::vector<std::string>& options, const std::string& script);

/// Queries the states of the jobs on their cluster. Returns an Error with the message of squeue if
/// the query fails.
Result<SlurmQueue> query_queue(const SlurmJobs& jobs);

/// Cancels the job on its cluster, with additional options for scancel. Errors are ignored: the job
/// may have ended already.
void cancel_job(const std::string& job, const std::vector<std::string>& options = {});
/// Returns the command that cancels the array job and the collecting job.
std::string cancel_command(const SlurmJobs& jobs);

}  // namespace vantage::experiments
