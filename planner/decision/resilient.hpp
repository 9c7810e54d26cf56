#pragma once

#include <functional>
#include <span>
#include <vector>

#include "planner/decision/decision.hpp"

namespace vantage::planner {

/// Returns the bait: the `attacks_max` robots whose plans have the greatest individual values,
/// sorted by robot number. Returns all robots if the team has no more than `attacks_max`. Of robots
/// with equal values, those with lower numbers are preferred.
std::vector<int> bait_robots(std::span<const double> individual_values, int attacks_max);

/// Split of the team into bait and the others in a round of robust trajectory planning. The split
/// depends only on the robots' individual values, so robots with the same values make the same
/// split. Robots on the bus exchange these values and use this class in the same way as
/// plan_resiliently(). Source: dissertation Alg. 10.
class ResilientRound {
 public:
  /// @throws UsageError when attacks_max < 0
  ResilientRound(std::span<const double> individual_values, int attacks_max);

  /// Returns the bait robots, ascending. They keep the plans that they made alone.
  [[nodiscard]] const std::vector<int>& bait() const { return bait_; }
  /// Returns the other robots, ascending, which is their order in coordinate descent. They plan
  /// together as if the bait did not exist.
  [[nodiscard]] const std::vector<int>& non_bait() const { return non_bait_; }
  [[nodiscard]] bool is_bait(int robot) const;
  /// Returns the robots that the plan of `robot` assumes to have no sensors: all robots if it is
  /// bait, otherwise the bait.
  [[nodiscard]] std::vector<int> robots_without_sensing_for(int robot) const;

 private:
  std::vector<int> bait_;
  std::vector<int> non_bait_;
};

/// Plans `robot` as if no other robot had sensors, keeps that plan, and returns its information
/// gain, nats: 0 without measurements, and never less with more measurements.
using PlanAlone = std::function<double(int robot)>;
/// Plans `robots` (at least one) as if they were the whole team.
using PlanTogether = std::function<void(const std::vector<int>& robots)>;
/// Plans `robot` given the current plans of `fixed_robots`, keeps that plan, and returns its
/// information gain, nats.
using PlanRobot = std::function<double(int robot, const std::vector<int>& fixed_robots)>;

/// Robust trajectory planning for any kind of plan. If attacks are expected, all robots plan alone,
/// then the robots outside the bait plan together; otherwise all plan together. Returns the bait,
/// ascending. RAIN calls this every T_REPLAN steps. Source: dissertation Alg. 9, 10.
std::vector<int> plan_resiliently(int robot_count, int attacks_max, const PlanAlone& alone,
                                  const PlanTogether& together);

/// As above, for robots that search for their plans. They plan together by coordinate descent, each
/// given the plans of the robots before it. The first robot reuses the plan that it made alone.
std::vector<int> plan_resiliently(int robot_count, int attacks_max, const PlanRobot& plan);

/// Method by which robots outside the bait choose candidates.
enum class SubSolver { kCoordinateDescent, kExhaustive };

/// As above, for robots that choose from candidates; all costs must be zero. With the exhaustive
/// sub-solver, for the worst attack A*:
///   J(V \ A*) ≥ max(1 − κ, 1 / (1 + α)) · max min J for submodular J (kMutual),
///   J(V \ A*) ≥ (1 − c)² · max min J otherwise.
/// With coordinate descent the first factor is halved and the second is ½ (1 − c)³. `value` is J
/// without attacks.
/// Source: dissertation Thm 1, Prop. 1.
TeamDecision plan_resiliently(const TeamOracle& oracle, int attacks_max, SubSolver sub_solver);

/// Returns the individual value of each robot's best candidate, nats; 0 for a robot without
/// candidates.
std::vector<double> best_individual_values(const TeamOracle& oracle);

}  // namespace vantage::planner
