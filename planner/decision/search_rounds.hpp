#pragma once

#include <functional>
#include <span>

#include "planner/decision/decision.hpp"

namespace vantage::planner {

/// One round of a local search: starts from `start`, uses no candidate marked in `excluded`, and
/// returns a local optimum. Adds its effort to `decision`.
using SearchRound = std::function<Choice(const Choice& start, std::span<const char> excluded,
                                         TeamDecision& decision)>;

/// Runs two rounds of local search, the common part of centralised and distributed search. Each
/// round starts from the best single trajectory available; the second excludes the choices of the
/// first. Returns the better result.
/// Source: dissertation Alg. 6, 7.
TeamDecision search_in_two_rounds(const TeamOracle& oracle, const SearchRound& round);

}  // namespace vantage::planner
