#pragma once

#include <functional>
#include <span>
#include <vector>

#include "planner/decision/decision.hpp"

namespace vantage::planner {

/// The bait: the `attacks_max` robots whose plans alone are worth most, ascending; of equals the
/// lower numbers. All robots when there are no more.
std::vector<int> bait_robots(std::span<const double> values_alone, int attacks_max);

/// How the robots outside the bait solve their problem without attacks.
enum class SubSolver { kCoordinateDescent, kExhaustive };

/// Robust trajectory planning: the bait keep what is best for each alone; the rest choose as if the
/// bait did not exist. J is to be information gained, costs zero: normalised and non-decreasing.
/// Where no attack is worse than A*, with the exhaustive sub-solver:
///   J(V \ A*) ≥ max(1 − κ, 1 / (1 + α)) · max min J for submodular J (kMutual),
///   J(V \ A*) ≥ (1 − c)² · max min J otherwise,
/// with coordinate descent half of the first, ½ (1 − c)³. `value` is that without attacks.
/// Source: dissertation Alg. 10, Thm 1, Prop. 1.
TeamDecision plan_resiliently(const TeamOracle& oracle, int attacks_max, SubSolver sub_solver);

/// Plans `robot` beside the plans that the robots `beside` have now, keeps that plan as its own,
/// and returns the information it gains, nats.
using PlanRobot = std::function<double(int robot, const std::vector<int>& beside)>;

/// The same round over robots that search for their plans: with attacks, all plan alone, and those
/// outside the bait then plan one after another beside those of them that have; without, it is
/// coordinate descent. Returns the bait, ascending. This is what RAIN does every T_REPLAN steps.
/// Source: dissertation Alg. 9, 10.
std::vector<int> plan_round_resiliently(int robot_count, int attacks_max, const PlanRobot& plan);

}  // namespace vantage::planner
