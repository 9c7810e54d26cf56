#pragma once

#include <functional>
#include <span>
#include <vector>

#include "planner/decision/decision.hpp"

namespace vantage::planner {

/// The bait: the `attacks_max` robots whose plans alone are worth most, ascending; of equals the
/// lower numbers. All robots when there are no more.
std::vector<int> bait_robots(std::span<const double> values_alone, int attacks_max);

/// Who plans against whom in a round of robust trajectory planning: a function of what each robot's
/// plan alone is worth, so that all who know the same decide the same. Robots on the bus, which
/// have told one another, ask it as plan_resiliently() does. Source: dissertation Alg. 10.
class ResilientRound {
 public:
  /// @throws UsageError when attacks_max < 0
  ResilientRound(std::span<const double> values_alone, int attacks_max);

  /// They do what is best for each alone. Ascending.
  [[nodiscard]] const std::vector<int>& bait() const { return bait_; }
  /// They plan together, as if the bait did not exist: in this order, where one after another.
  [[nodiscard]] const std::vector<int>& rest() const { return rest_; }
  [[nodiscard]] bool is_bait(int robot) const;
  /// Whose sensors the plan of `robot` does not count on: everybody's of bait, else the bait's.
  [[nodiscard]] std::vector<int> unseeing_for(int robot) const;

 private:
  std::vector<int> bait_;
  std::vector<int> rest_;
};

/// Plans `robot` as if nobody else looked, keeps that plan, and returns the information it gains,
/// nats: normalised and non-decreasing.
using PlanAlone = std::function<double(int robot)>;
/// Plans `robots`, one at least, as if there were no others.
using PlanTogether = std::function<void(const std::vector<int>& robots)>;
/// Plans `robot` beside the plans that the robots `beside` have now, keeps that plan as its own,
/// and returns the information it gains, nats.
using PlanRobot = std::function<double(int robot, const std::vector<int>& beside)>;

/// Robust trajectory planning, whatever a plan is: where attacks are expected all plan alone, and
/// those outside the bait then plan together; where none are, all plan together. Returns the bait,
/// ascending. This is what RAIN does every T_REPLAN steps. Source: dissertation Alg. 9, 10.
std::vector<int> plan_resiliently(int robot_count, int attacks_max, const PlanAlone& alone,
                                  const PlanTogether& together);

/// The same of robots that search for their plans and plan together one after another, each beside
/// those before it (coordinate descent). The first does not plan again what it has planned alone.
std::vector<int> plan_resiliently(int robot_count, int attacks_max, const PlanRobot& plan);

/// How the robots outside the bait choose from candidates.
enum class SubSolver { kCoordinateDescent, kExhaustive };

/// The same of robots that choose from candidates, whose costs are to be zero. Where no attack is
/// worse than A*, with the exhaustive sub-solver:
///   J(V \ A*) ≥ max(1 − κ, 1 / (1 + α)) · max min J for submodular J (kMutual),
///   J(V \ A*) ≥ (1 − c)² · max min J otherwise,
/// with coordinate descent half of the first, ½ (1 − c)³. `value` is that without attacks.
/// Source: dissertation Thm 1, Prop. 1.
TeamDecision plan_resiliently(const TeamOracle& oracle, int attacks_max, SubSolver sub_solver);

/// What each robot's best candidate alone is worth, nats; 0 of a robot that has none.
std::vector<double> best_alone(const TeamOracle& oracle);

}  // namespace vantage::planner
