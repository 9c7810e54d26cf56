#pragma once

#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Returns the smallest network.neighbourhood_m that keeps the separation guarantee: two robots
/// that are farther apart than the result cannot violate separation_m before each has received the
/// other's plan. The result is twice the longest reach of a robot plus the required distance
/// between robots:
///   2 (v (T τ + 2 n τ) + v² / 2b) + separation + 2 tolerance
/// T τ is the duration of a plan, n τ that of a round. The formula includes two rounds: in the
/// first a robot approaches, in the second its plan is published. The result is at least the
/// communication range, and at least the distance within which a plan of T steps can observe a
/// target. Source: docs/decisions/0016.
double least_neighbourhood_m(const Scenario& scenario);

}  // namespace vantage::scenario
