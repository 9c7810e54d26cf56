#pragma once

#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// Returns the smallest network.neighbourhood_m that keeps the separation guarantee: two robots
/// that are farther apart now cannot come too close before each has received the other's plan. It
/// is twice the longest reach of the team's plans plus the distance kept between robots:
///   2 (v (T τ + 2 n τ) + v² / 2b) + separation + 2 tolerance
/// T τ is for a plan. The two n τ are for the round in which a robot approaches and the one in
/// which its plan is published. The result is at least the communication range and the distance at
/// which a plan of T steps can observe a target. Source: docs/decisions/0016.
double least_neighbourhood_m(const Scenario& scenario);

}  // namespace vantage::scenario
