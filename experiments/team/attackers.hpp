#pragma once

#include <array>

#include "planner/decision/attack.hpp"

namespace vantage::experiments {

/// An attacker of the experiments, with its text in tables and its description.
struct NamedAttacker {
  planner::Attacker attacker;
  const char* name;
  const char* text;
};

/// The attackers of the experiments. The first one is that of the dissertation.
inline constexpr std::array<NamedAttacker, 2> kAttackers = {
    {{planner::Attacker::kGreedy, "greedy", "robots whose loss costs most, chosen greedily"},
     {planner::Attacker::kBestAlone, "best_alone", "robots whose single plans gain most"}}};

}  // namespace vantage::experiments
