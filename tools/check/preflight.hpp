#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenario/scenario.hpp"

namespace vantage::tools {

/// Result of checking a scenario before a flight.
struct Preflight {
  std::vector<std::string> understood;  ///< summary of the trial
  std::vector<std::string> faults;      ///< reasons why the scenario must not be flown
  std::vector<std::string> notes;       ///< risks and unused settings, with remedies
  [[nodiscard]] bool is_ready() const { return faults.empty(); }
};

/// m; allowance for tracking errors when a driver dies. The vehicle then flies beyond its checked
/// path, because set-points are missing. To prevent a contact, the obstacle margin must be at least
/// this additional distance plus the allowance. The separation must be larger by two radii.
inline constexpr double kLossSpareM = 0.1;

/// Checks a scenario for problems that the parser of its file does not detect. Faults:
/// - a robot's start is closer to obstacles or walls than its radius plus the planner's margin, or
///   two starts are closer than the separation;
/// - a given target start is not free, or no free starts are found for drawn targets (with the
///   scenario's seed);
/// - the network's URL is invalid, or its address is not multicast;
/// - the slots do not fit into the round, or more steps are executed than planned;
/// - a robot's limits are invalid, or flight safety refuses one of its primitives;
/// - the combination of devices has a fault.
///
/// Notes:
/// - a separation or margin that is too small for a driver that dies while its vehicle moves
///   (stopping_distance_after_loss_m);
/// - plans that are published too late, and wind without effect;
/// - moving targets that are modelled as static;
/// - settings with which the trial cannot fulfil its purpose (purpose_notes()).
Preflight check_preflight(const scenario::Scenario& scenario);

/// Bytes; maximum memory of one robot's planner. Measured: 50 planners in one process used 5.7 GB.
inline constexpr double kPlannerBytes = 120e6;
struct MemoryCheck {
  bool is_enough = true;
  std::string summary;
};
/// Compares the free memory with the memory that the planners need on the host with most planners.
MemoryCheck check_planner_memory(const scenario::Scenario& scenario,
                                 std::optional<std::uint64_t> free_bytes);
/// Returns the available memory of this machine in bytes; nullopt if unknown.
std::optional<std::uint64_t> free_memory_bytes();

}  // namespace vantage::tools
