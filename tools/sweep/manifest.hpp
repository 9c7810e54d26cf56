#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/sweep/row_files.hpp"
#include "tools/sweep/sweep.hpp"

// DIRECTORY/manifest.json: what is run there, by which version, on which machines.

namespace vantage::tools {

/// What every process that works in one directory must agree on. How many trials are run is not of
/// it: more of them go on from where fewer ended.
struct SweepIdentity {
  std::string experiment;
  std::string version;
  std::uint64_t seed = 1;
  bool is_smoke = false;
};

/// SHA-256 in hex.
std::string text_hash(const std::string& text);
/// Of the plan but for the number of trials.
std::string settings_hash(const SweepPlan& plan);

/// Makes `directory` (made if need be) the place of this run: one process writes the manifest, all
/// others, now and later, find it equal.
/// @throws StartupError that names what differs, or when there is something else in the directory
void claim_directory(const std::string& directory, const SweepIdentity& identity,
                     const SweepPlan& plan);

/// Writes the manifest of a run that is done: with the number of trials and the processes.
/// @throws StartupError when it cannot be written
void finish_manifest(const std::string& directory, const SweepIdentity& identity,
                     const SweepPlan& plan, const std::vector<RowProcess>& processes);

/// This process on this machine: name of the CPU, cores, the time of day.
RowProcess this_process(int jobs, const Shard& shard);

}  // namespace vantage::tools
