#pragma once

#include <functional>
#include <span>

#include "planner/decision/decision.hpp"

namespace vantage::planner {

/// One round of a local search: from `start` without the candidates marked in `excluded` to where
/// it ends, adding what that took to `decision`.
using SearchRound = std::function<Choice(const Choice& start, std::span<const char> excluded,
                                         TeamDecision& decision)>;

/// What centralised and distributed local search share: two rounds, each from the best single
/// trajectory that is left, the second without what the first chose; the better result of both.
/// Source: dissertation Alg. 6, 7.
TeamDecision search_in_two_rounds(const TeamOracle& oracle, const SearchRound& round);

}  // namespace vantage::planner
