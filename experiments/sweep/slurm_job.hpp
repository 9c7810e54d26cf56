#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiments/sweep/sweep.hpp"

// A sweep as Slurm jobs, as far as text goes: an array of its shards and one that collects them.

namespace vantage::experiments {

/// What both jobs run.
struct SlurmScripts {
  std::string shards;   ///< of each task of the array: the shard of its number
  std::string collect;  ///< the same command without a shard
};
/// `command` is the program with its arguments but for --shard; nothing in it is expanded.
SlurmScripts slurm_scripts(const std::vector<std::string>& command, int shards);

/// The numbers of the shards, of `of`, that have a unit which is not in `done`.
std::vector<int> shards_lacking(const SweepPlan& plan, int of,
                                const std::map<Unit, UnitRows>& done);

/// "1-3,7" of ascending numbers, as sbatch --array has it.
std::string array_text(const std::vector<int>& numbers);

/// Returns the job that `sbatch --parsable` reports, with warnings around it: "12", or "12;east"
/// where Slurm named the cluster; "" when there is none.
std::string job_of(const std::string& answer);
/// The parts of it; a cluster that was not named is "".
std::string number_of(const std::string& job);
std::string cluster_of(const std::string& job);
/// Returns the option that has squeue, scancel and sbatch work on the cluster of `job`; none where
/// that was not named. A number alone may be another job on the default cluster.
std::vector<std::string> cluster_option(const std::string& job);
/// "12", "12 on cluster east".
std::string job_text(const std::string& job);

/// States as squeue names them, by job: of tasks "12_3", of a job that is no array "13". Words are
/// those of `squeue --noheader --array --format=%i|%T`.
std::map<std::string, std::string> states_of(const std::string& answer);
/// Whether a job in that state may still write, now or put back into the queue; "" is none. One
/// that is being taken down (COMPLETING) may: until its node has answered, squeue does not say
/// whether it will run again.
bool is_live(const std::string& state);
/// The same without those that are being taken down: enough to wait for where no unit lacks.
bool is_at_work(const std::string& state);
/// Whether it ended otherwise than by its own success.
bool is_failure(const std::string& state);

}  // namespace vantage::experiments
