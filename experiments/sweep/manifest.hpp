#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/sweep/row_files.hpp"
#include "experiments/sweep/sweep.hpp"

// The file DIRECTORY/manifest.json names the experiment of a directory, its version and its
// machines.

namespace vantage::experiments {

/// Returns the SHA-256 in hex.
std::string text_hash(const std::string& text);
/// Returns the SHA-256 of the plan without the number of trials.
std::string settings_hash(const SweepPlan& plan);

/// Returns the identity of this run as JSON: experiment, version, seed, smoke, planning_share,
/// settings_sha256.
std::string identity_text(const SweepIdentity& identity, const SweepPlan& plan);
/// Returns the first difference between this run and `theirs`, JSON with at least the same keys:
/// "different version: "1.0", but this run has "1.1"". Empty if both describe the same run.
std::string difference_of(const std::string& theirs, const SweepIdentity& identity,
                          const SweepPlan& plan);

/// Reserves `directory` for this run, and creates it if needed. One process writes the manifest;
/// all other processes of the run, even later ones, compare their manifest with this file.
/// @throws StartupError that names the difference, or when the directory contains other files
void claim_directory(const std::string& directory, const SweepIdentity& identity,
                     const SweepPlan& plan);

/// Writes the manifest of a finished run, with the number of trials and the processes.
/// @throws StartupError when it cannot be written
void finish_manifest(const std::string& directory, const SweepIdentity& identity,
                     const SweepPlan& plan, const std::vector<RowProcess>& processes);

std::string host_name();

/// Returns this process with its machine: CPU name, number of cores, start time.
RowProcess this_process(int jobs, const Shard& shard);

}  // namespace vantage::experiments
