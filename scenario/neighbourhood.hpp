#pragma once

#include "scenario/scenario.hpp"

namespace vantage::scenario {

/// The least network.neighbourhood_m that changes nothing of what keeps robots apart: two that are
/// farther from each other now cannot come too near before each has heard the other's plan. The
/// farthest that the team's plans reach, twice, and what is kept between them:
///   2 (v (T τ + 2 n τ) + v² / 2b) + separation + 2 tolerance
/// T τ for a plan, n τ each for the round in which one comes near and the one in which his plan is
/// said. Nor less than what is heard (communication range), or than what a plan of T steps may come
/// to see. Source: docs/decisions/0016.
double least_neighbourhood_m(const Scenario& scenario);

}  // namespace vantage::scenario
