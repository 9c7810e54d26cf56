// Tests the conditions under which hovering robots that weigh information gain against energy turn
// towards free space.

#include <algorithm>
#include <utility>

#include <gtest/gtest.h>

#include "planner/robot/robot_planner.hpp"
#include "planner/robot/round.hpp"
#include "test/planner/robot/team_scenario.hpp"

namespace vantage::planner {
namespace {

using test::energy_scenario;
using test::first_inputs;

/// The first robot of an energy scenario over several rounds. Mocap reports the robot exactly on
/// its plans. Its teammates hover at their poses of `first_inputs` and publish nothing.
class AloneAtRest {
 public:
  AloneAtRest(const scenario::Scenario& scenario, const Pose2& start)
      : scenario_(scenario),
        inputs_(first_inputs(scenario, 0, 7)),
        at_(start),
        planner_(scenario, "Q1") {}

  /// Returns the robot's plan of the next round, after the exchange if its team algorithm has one.
  models::RobotPlan plan() {
    const Deadline deadline = Deadline::nodes(20'000);
    inputs_.mocap->stamp.time = inputs_.belief->stamp.time = inputs_.slot.begin;
    inputs_.mocap->bodies[0].world_from_body = lift(at_, scenario_.robots[0].height_m);
    inputs_.solution.reset();
    if (const auto exchange = planner_.begin_exchange(inputs_, deadline)) {
      while (auto proposal = exchange->improve(Deadline::never())) {
        inputs_.solution = std::move(proposal);
      }
    }
    inputs_.own_plan = planner_.plan(inputs_, deadline);
    EXPECT_TRUE(inputs_.own_plan);
    const double clearance_m =
        scenario_.robots[0].limits.radius_m + scenario_.planner.obstacle_margin_m;
    const models::Trajectory& motion = inputs_.own_plan->trajectory;
    EXPECT_TRUE(models::is_clear(scenario_.world, motion, motion.start_time, clearance_m - 0.021));
    inputs_.slot = RoundSchedule(scenario_.planner, 0, 3).slot(inputs_.slot.round + 1);
    at_ = models::at(motion, inputs_.slot.begin).world_from_body;
    return *inputs_.own_plan;
  }

  [[nodiscard]] const Pose2& at() const { return at_; }
  [[nodiscard]] const PlannerCounts& counts() const { return planner_.counts(); }

 private:
  const scenario::Scenario& scenario_;
  PlanInputs inputs_;
  Pose2 at_;
  RobotPlanner planner_;
};

/// Parameterised by the team algorithm.
class EnergyAtRest : public ::testing::TestWithParam<scenario::TeamAlgorithm> {
 protected:
  EnergyAtRest() { scenario_.planner.team_algorithm = GetParam(); }

  void set_price_nats(double price_nats) { scenario_.robots[0].energy.price_nats = price_nats; }

  scenario::Scenario scenario_ = energy_scenario();
  double nearest_m_ = scenario_.robots[0].limits.radius_m + scenario_.planner.obstacle_margin_m;
};

INSTANTIATE_TEST_SUITE_P(Teams, EnergyAtRest,
                         testing::Values(scenario::TeamAlgorithm::kLocalSearch,
                                         scenario::TeamAlgorithm::kCoordinateDescent));

// A robot with an energy cost may hover. If the wall ahead is nearer than the tightest arc, no
// primitive is feasible, and without a turn the robot would hover permanently.
TEST_P(EnergyAtRest, TurnsNearAWallDespiteTheEnergyCost) {
  set_price_nats(1e-6);
  for (const Pose2& start :
       {Pose2{0.0, 2.0 - nearest_m_ - 0.06, kPi / 2},
        Pose2{4.0 - nearest_m_ - 0.06, 2.0 - nearest_m_ - 0.06, kPi / 4},
        Pose2{-4.0 + nearest_m_ + 0.06, 0.0, kPi}, Pose2{0.0, 2.0 - nearest_m_ - 0.003, kPi / 2}}) {
    AloneAtRest robot(scenario_, start);
    double gone_m = 0.0;
    for (int round = 0; round < 8; ++round) {
      robot.plan();
      gone_m = std::max(gone_m, (robot.at().position_m() - start.position_m()).norm());
    }
    EXPECT_GT(gone_m, 0.5) << start.x_m << " " << start.y_m;
    EXPECT_GE(robot.counts().turns_away, 1);
    EXPECT_LE(robot.counts().turns_away, 4);
  }
}

// Once the robot faces free space, it hovers until a motion gains more information than its energy
// costs.
TEST_P(EnergyAtRest, StopsTurningOnceItFacesFreeSpace) {
  set_price_nats(1e6);
  AloneAtRest robot(scenario_, {-4.0 + nearest_m_ + 0.06, 0.0, kPi});
  for (int round = 0; round < 8; ++round) {
    robot.plan();
  }
  EXPECT_GE(robot.counts().turns_away, 1);
  EXPECT_LE(robot.counts().turns_away, 4);
  EXPECT_EQ(robot.counts().rest_rounds, 8 - robot.counts().turns_away);
  EXPECT_TRUE(robot.plan().trajectory.segments.empty());
}

// A robot that is too near to a teammate stops turning once it faces free space.
TEST_P(EnergyAtRest, StopsTurningNextToTeammateOnceItFacesFreeSpace) {
  set_price_nats(1e6);
  const Eigen::Vector2d teammate_m = scenario_.robots[1].start.position_m();
  scenario_.robots[0].height_m = scenario_.robots[1].height_m;
  for (const double yaw_rad : {0.0, 0.5 * kPi, kPi, -0.5 * kPi}) {
    AloneAtRest robot(scenario_, {teammate_m.x() - 0.8, teammate_m.y(), yaw_rad});
    for (int round = 0; round < 8; ++round) {
      robot.plan();
    }
    EXPECT_LE(robot.counts().turns_away, 6) << yaw_rad;
    EXPECT_TRUE(robot.plan().trajectory.segments.empty()) << yaw_rad;
  }
}

}  // namespace
}  // namespace vantage::planner
