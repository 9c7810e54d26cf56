#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/sweep/row_files.hpp"
#include "experiments/sweep/sweep.hpp"

// DIRECTORY/manifest.json: what is run there, by which version, on which machines.

namespace vantage::experiments {

/// SHA-256 in hex.
std::string text_hash(const std::string& text);
/// Of the plan but for the number of trials.
std::string settings_hash(const SweepPlan& plan);

/// What tells this run from others, as JSON: experiment, version, seed, smoke, settings_sha256.
std::string identity_text(const SweepIdentity& identity, const SweepPlan& plan);
/// "another version: "1.0", and this one is of "1.1"" when `theirs`, JSON that has at least the
/// same, is of another run; "" when it is of this one.
std::string difference_of(const std::string& theirs, const SweepIdentity& identity,
                          const SweepPlan& plan);

/// Makes `directory` (made if need be) the place of this run: one process writes the manifest, all
/// others, now and later, find it equal.
/// @throws StartupError that names what differs, or when there is something else in the directory
void claim_directory(const std::string& directory, const SweepIdentity& identity,
                     const SweepPlan& plan);

/// Writes the manifest of a run that is done: with the number of trials and the processes.
/// @throws StartupError when it cannot be written
void finish_manifest(const std::string& directory, const SweepIdentity& identity,
                     const SweepPlan& plan, const std::vector<RowProcess>& processes);

std::string host_name();

/// This process on this machine: name of the CPU, cores, the time of day.
RowProcess this_process(int jobs, const Shard& shard);

}  // namespace vantage::experiments
