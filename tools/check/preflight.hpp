#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenario/scenario.hpp"

namespace vantage::tools {

/// What a look at a scenario before flying found.
struct Preflight {
  std::vector<std::string> understood;  ///< the trial in a few lines
  std::vector<std::string> faults;      ///< why it must not fly
  std::vector<std::string> notes;       ///< what it does not budget or use, and what to change
  [[nodiscard]] bool is_ready() const { return faults.empty(); }
};

/// Checks what a reader of the file alone cannot: every robot's start is clear of obstacles and
/// walls by its radius and the planner's margin, can be stopped at, no two starts are nearer than
/// the separation, stated targets start on free ground, drawn ones find some (by the scenario's own
/// seed), the network's address is multicast, the slots fit into the round; and flight
/// safety has limits that it can keep and refuses none of the robots' primitives. Noted is a
/// separation or a margin that a driver which dies in motion would use up (lost_way_m), and a wind
/// that nothing feels.
///
/// The least that a driver's death needs, so that its vehicle touches nothing: what it flies on
/// when set-points stop, beyond the way that was checked, and kLossSpareM for how well it is
/// followed.
inline constexpr double kLossSpareM = 0.1;

Preflight check_preflight(const scenario::Scenario& scenario);

/// What one robot's planner holds at most, measured: fifty in one process took 5.7 GB.
inline constexpr double kPlannerBytes = 120e6;
struct MemoryRoom {
  bool is_enough = true;
  std::string words;
};
/// Whether the planners of the host that has most of them find room, in a sentence.
MemoryRoom room_for_planners(const scenario::Scenario& scenario,
                             std::optional<std::uint64_t> free_bytes);
/// What this machine can still give out; nullopt when it does not say.
std::optional<std::uint64_t> free_memory_bytes();

}  // namespace vantage::tools
