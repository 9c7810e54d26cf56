#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiments/sweep/sweep.hpp"

// Texts of a sweep as Slurm jobs: an array of its shards and one job that collects them.

namespace vantage::experiments {

/// Scripts of the array job and of the collecting job.
struct SlurmScripts {
  std::string shards;   ///< script of the array's tasks: task k runs shard k
  std::string collect;  ///< script of the collecting job: the command without a shard
};
/// Returns the scripts. `command` is the program with its arguments except --shard; the shell
/// expands nothing in it.
SlurmScripts slurm_scripts(const std::vector<std::string>& command, int shards);

/// Divides the sweep into `of` shards and returns the numbers of those with a unit that is not in
/// `done`.
std::vector<int> incomplete_shards(const SweepPlan& plan, int of,
                                   const std::map<Unit, UnitRows>& done);

/// Returns ascending numbers in the format of sbatch --array: "1-3,7".
std::string array_text(const std::vector<int>& numbers);

/// Extracts the number (and cluster) of the job from the output of `sbatch --parsable`, which may
/// contain warnings: "12", or "12;east" if Slurm named the cluster; "" if there is none.
std::string job_of(const std::string& answer);
/// Return the job's number and its cluster; "" for an unnamed cluster.
std::string number_of(const std::string& job);
std::string cluster_of(const std::string& job);
/// Returns the option that makes squeue, scancel and sbatch use the cluster of `job`; empty if the
/// cluster is unnamed. Without this option, the number could refer to a different job on the
/// default cluster.
std::vector<std::string> cluster_option(const std::string& job);
/// Returns "12" or "12 on cluster east".
std::string job_text(const std::string& job);

/// Parses the output of `squeue --noheader --array --format=%i|%T`. Returns the states by job:
/// "12_3" for an array task, "13" for other jobs.
std::map<std::string, std::string> states_of(const std::string& answer);
/// True if a job in this state may still write, now or after being requeued; false for "". The
/// state COMPLETING is included, because squeue does not report whether the job will run again
/// until the node has responded.
bool is_live(const std::string& state);
/// As is_live(), but false for COMPLETING. If no unit is missing, only jobs in these states must be
/// waited for.
bool is_running_or_pending(const std::string& state);
/// True if the job ended without success.
bool is_failure(const std::string& state);

}  // namespace vantage::experiments
