#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "planner/robot/robot_planner.hpp"
#include "planner/robot/round.hpp"
#include "planner/robot/trajectory_tools.hpp"
#include "test/planner/robot/team_scenario.hpp"

namespace vantage::planner {
namespace {

constexpr std::int64_t kFirstRound = 1'700'000'000;  // rounds of 1 s since the epoch

// A team that plans in successive rounds on beliefs drawn from a seed. Mocap reports every robot
// exactly on its plan.
class Team {
 public:
  explicit Team(scenario::Scenario scenario, unsigned seed)
      : scenario_(std::move(scenario)), rng_(seed) {
    for (const scenario::RobotSpec& robot : scenario_.robots) {
      planners_.emplace_back(scenario_, robot.name);
    }
  }

  void run_round(std::int64_t round, double silent_share) {
    for (std::size_t i = 0; i < planners_.size(); ++i) {
      const scenario::RobotSpec& robot = scenario_.robots[i];
      PlanInputs inputs;
      inputs.slot =
          RoundSchedule(scenario_.planner, static_cast<int>(i), static_cast<int>(planners_.size()))
              .slot(round);
      if (std::uniform_real_distribution<double>(0.0, 1.0)(rng_) < silent_share) {
        continue;
      }
      inputs.mocap = mocap(inputs.slot.begin);
      inputs.belief = belief(robot, inputs.slot.begin);
      for (const auto& [name, plan] : plans_) {
        if (name == robot.name) {
          inputs.own_plan = plan;
        } else {
          inputs.team_plans[name] = plan;
        }
      }
      const bool late = std::uniform_real_distribution<double>(0.0, 1.0)(rng_) < silent_share;
      auto plan = late ? planners_[i].plan_without_search(inputs)
                       : planners_[i].plan(inputs, Deadline::nodes(scenario_.planner.node_budget));
      ASSERT_TRUE(plan.has_value());
      plan->stamp.run_id = 1;
      plan->stamp.sequence = round;
      check(*plan);
      plans_.insert_or_assign(robot.name, *plan);
    }
  }

  /// Moves all robots along their plans from `from` to `to` and records the smallest distances.
  void fly(Time from, Time to) {
    for (Time now = from; now < to; now += Duration{10'000}) {
      for (std::size_t i = 0; i < scenario_.robots.size(); ++i) {
        const Eigen::Vector3d a = position_m(scenario_.robots[i], now);
        least_clearance_m_ =
            std::min(least_clearance_m_, models::clearance_m(scenario_.world, a.head<2>()));
        for (std::size_t j = 0; j < i; ++j) {
          const Eigen::Vector3d between_m = a - position_m(scenario_.robots[j], now);
          least_separation_m_ = std::min(least_separation_m_, between_m.norm());
          least_from_above_m_ = std::min(least_from_above_m_, between_m.head<2>().norm());
        }
      }
    }
  }

  [[nodiscard]] double least_separation_m() const { return least_separation_m_; }
  [[nodiscard]] double least_from_above_m() const { return least_from_above_m_; }
  [[nodiscard]] double least_clearance_m() const { return least_clearance_m_; }
  [[nodiscard]] int searched() const { return searched_; }
  [[nodiscard]] int planned() const { return planned_; }
  [[nodiscard]] const std::map<std::string, models::RobotPlan>& plans() const { return plans_; }

 private:
  void check(const models::RobotPlan& plan) {
    ++planned_;
    searched_ += plan.source == models::PlanSource::kSearched ? 1 : 0;
    EXPECT_EQ(plan.trajectory.start_time, plan.stamp.time);
    // The plan ends in a hover …
    const Time end = models::end_time(plan.trajectory);
    EXPECT_EQ(models::at(plan.trajectory, end + from_seconds(1.0)).control.speed_mps, 0.0);
    // … and begins at the point of the last plan at that time.
    const auto last = plans_.find(plan.robot);
    if (last != plans_.end()) {
      const Pose2 expected =
          models::at(last->second.trajectory, plan.trajectory.start_time).world_from_body;
      EXPECT_NEAR((expected.position_m() - plan.trajectory.start.position_m()).norm(), 0.0, 1e-9);
    }
  }

  Eigen::Vector3d position_m(const scenario::RobotSpec& robot, Time now) const {
    // The current plan is the newest one that has begun.
    Pose2 pose = robot.start;
    const auto in_force = in_force_.find(robot.name);
    const auto newest = plans_.find(robot.name);
    if (newest != plans_.end() && newest->second.stamp.time <= now) {
      pose = models::at(newest->second.trajectory, now).world_from_body;
      in_force_.insert_or_assign(robot.name, newest->second.trajectory);
    } else if (in_force != in_force_.end()) {
      pose = models::at(in_force->second, now).world_from_body;
    }
    return {pose.x_m, pose.y_m, robot.height_m};
  }

  models::MocapFrame mocap(Time now) {
    models::MocapFrame frame;
    frame.stamp.time = now;
    for (const scenario::RobotSpec& robot : scenario_.robots) {
      const Eigen::Vector3d p = position_m(robot, now);
      frame.bodies.push_back({robot.name, lift({p.x(), p.y(), 0.0}, p.z()), false});
    }
    return frame;
  }

  models::RobotBelief belief(const scenario::RobotSpec& robot, Time now) {
    models::RobotBelief belief;
    belief.stamp.time = now;
    belief.robot = robot.name;
    const models::VisibilityGrid grid(scenario_.world, scenario_.estimator.grid_resolution_m, 0.0);
    belief.grid = grid.geometry();
    belief.last_seen_utime = grid.last_seen_utime();
    std::uniform_real_distribution<double> x(-4.0, 4.0);
    std::uniform_real_distribution<double> y(-2.0, 2.0);
    for (int id = 0; id < 5; ++id) {
      const models::Gaussian guess{Eigen::Vector2d(x(rng_), y(rng_)),
                                   0.3 * Eigen::Matrix2d::Identity()};
      belief.targets.push_back({id, *models::to_information(guess), now});
    }
    return belief;
  }

  scenario::Scenario scenario_;
  std::mt19937_64 rng_;
  std::vector<RobotPlanner> planners_;
  std::map<std::string, models::RobotPlan> plans_;
  mutable std::map<std::string, models::Trajectory> in_force_;
  double least_separation_m_ = 1e9;
  double least_from_above_m_ = 1e9;
  double least_clearance_m_ = 1e9;
  int planned_ = 0;
  int searched_ = 0;
};

class TeamSafety : public ::testing::TestWithParam<const char*> {};

TEST_P(TeamSafety, KeepsSeparationAndClearanceWithSilentOrLateRobots) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.planner.algorithm = GetParam();
  const double radius_m = scenario.robots[0].limits.radius_m;
  for (unsigned seed : {1U, 2U}) {
    Team team(scenario, seed);
    for (std::int64_t round = kFirstRound; round < kFirstRound + 60; ++round) {
      ASSERT_NO_FATAL_FAILURE(team.run_round(round, seed == 1 ? 0.0 : 0.2));
      team.fly(Time{std::chrono::seconds(round + 1)}, Time{std::chrono::seconds(round + 2)});
    }
    // The required separation plus the tracking tolerance of both vehicles.
    EXPECT_GE(team.least_separation_m(),
              scenario.planner.separation_m + 2.0 * scenario.planner.tracking_tolerance_m - 0.02);
    EXPECT_GE(team.least_clearance_m(), radius_m + scenario.planner.obstacle_margin_m - 0.02);
    EXPECT_GT(team.searched(), team.planned() * (seed == 1 ? 9 : 5) / 10);
  }
}

// In a flight, the autopilot landed a vehicle straight down after its link was cut. The vehicle
// came down on a teammate that flew a metre below.
TEST(TeamSafetyFromAbove, RobotsDoNotFlyOverEachOther) {
  for (const bool is_from_above : {false, true}) {
    scenario::Scenario scenario = test::lab_scenario();
    scenario.planner.separation_from_above = is_from_above;
    for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
      scenario.robots[i].height_m = 1.0 + static_cast<double>(i);
    }
    Team team(scenario, 3);
    for (std::int64_t round = kFirstRound; round < kFirstRound + 60; ++round) {
      ASSERT_NO_FATAL_FAILURE(team.run_round(round, 0.1));
      team.fly(Time{std::chrono::seconds(round + 1)}, Time{std::chrono::seconds(round + 2)});
    }
    const double asked_m =
        scenario.planner.separation_m + 2.0 * scenario.planner.tracking_tolerance_m;
    EXPECT_EQ(team.least_from_above_m() >= asked_m - 0.02, is_from_above)
        << team.least_from_above_m();
    EXPECT_GT(team.searched(), team.planned() * 7 / 10);
  }
}

INSTANTIATE_TEST_SUITE_P(Planner, TeamSafety,
                         ::testing::Values("arvi", "beam", "astar", "wastar", "aegis", "greedy",
                                           "sampling_tree", "random_walk", "lawn_mower"),
                         [](const auto& each) { return std::string(each.param); });

TEST(RobotPlanner, ContinuesItsPlanAfterALateSearch) {
  Team team(test::lab_scenario(), 5);
  ASSERT_NO_FATAL_FAILURE(team.run_round(kFirstRound, 0.0));
  const auto before = team.plans();
  ASSERT_NO_FATAL_FAILURE(team.run_round(kFirstRound + 1, 1.1));  // no robot receives messages
  for (const auto& [name, plan] : team.plans()) {
    EXPECT_EQ(plan.round, before.at(name).round);
  }
}

TEST(RobotPlanner, IsDeterministic) {
  Team a(test::lab_scenario(), 9);
  Team b(test::lab_scenario(), 9);
  for (std::int64_t round = kFirstRound; round < kFirstRound + 5; ++round) {
    ASSERT_NO_FATAL_FAILURE(a.run_round(round, 0.0));
    ASSERT_NO_FATAL_FAILURE(b.run_round(round, 0.0));
    for (const auto& [name, plan] : a.plans()) {
      EXPECT_EQ(plan.cost, b.plans().at(name).cost);
      EXPECT_EQ(plan.nodes, b.plans().at(name).nodes);
    }
  }
}

// Planners that share a workspace in turn do not affect each other's results.
TEST(Workspace, SharingDoesNotChangeResults) {
  for (const char* algorithm : {"arvi", "rvi", "beam", "astar", "aegis", "random_walk"}) {
    scenario::Scenario scenario = test::lab_scenario();
    scenario.planner.algorithm = algorithm;
    const auto shared = std::make_shared<Workspace>(scenario);
    std::vector<RobotPlanner> sharing;
    for (const scenario::RobotSpec& robot : scenario.robots) {
      sharing.emplace_back(shared, robot.name);
    }
    for (unsigned seed = 1; seed <= 5; ++seed) {
      for (std::size_t i = 0; i < sharing.size(); ++i) {
        const PlanInputs inputs = test::first_inputs(scenario, i, seed);
        const auto plan = sharing[i].plan(inputs, Deadline::nodes(2'000));
        const auto alone =
            RobotPlanner(scenario, scenario.robots[i].name).plan(inputs, Deadline::nodes(2'000));
        ASSERT_TRUE(plan && alone);
        EXPECT_EQ(plan->cost, alone->cost);
        EXPECT_EQ(plan->lower_bound, alone->lower_bound);
        EXPECT_EQ(plan->nodes, alone->nodes);
        EXPECT_EQ(plan->trajectory.segments.size(), alone->trajectory.segments.size());
      }
    }
  }
}

// A teammate on the ground publishes plans but does not fly them yet.
TEST(RobotPlanner, KeepsClearOfTeammateThatDoesNotFollowItsPlan) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.world.obstacles.clear();
  scenario.robots.resize(2);
  scenario.robots[0].start = {-1.5, 0.0, 0.0};
  scenario.robots[1].start = {0.0, 0.0, kPi / 2};
  const RoundSchedule schedule(scenario.planner, 0, 2);
  PlanInputs inputs;
  inputs.slot = schedule.slot(kFirstRound);
  inputs.mocap.emplace().stamp.time = inputs.slot.begin;
  for (const scenario::RobotSpec& robot : scenario.robots) {
    inputs.mocap->bodies.push_back({robot.name, lift(robot.start, 0.0), false});
  }
  // The target is behind the teammate. The teammate's plan is far away.
  inputs.belief.emplace().stamp.time = inputs.slot.begin;
  const models::Gaussian guess{Eigen::Vector2d(1.2, 0.0), 0.3 * Eigen::Matrix2d::Identity()};
  inputs.belief->targets.push_back({0, *models::to_information(guess), inputs.slot.begin});
  const std::string other = scenario.robots[1].name;
  models::RobotPlan away;
  away.robot = other;
  away.trajectory = hover_at({0.0, 3.0, 0.0}, scenario.robots[1].height_m, inputs.slot.activation);
  inputs.team_plans[other] = away;

  const double asked_m =
      scenario.planner.separation_m + 2.0 * scenario.planner.tracking_tolerance_m;
  const Eigen::Vector3d place_m(0.0, 0.0, scenario.robots[1].height_m);
  std::map<models::FlightState, double> nearest_m;
  for (const models::FlightState state :
       {models::FlightState::kFollow, models::FlightState::kIdle}) {
    inputs.team_statuses[other].state = state;
    RobotPlanner planner(scenario, scenario.robots[0].name);
    const auto plan = planner.plan(inputs, Deadline::nodes(50'000));
    ASSERT_TRUE(plan.has_value());
    EXPECT_EQ(plan->source, models::PlanSource::kSearched);
    nearest_m[state] = 1e9;
    for (double s = 0.0; s < 8.0; s += 0.01) {
      const Eigen::Vector2d at_m =
          models::at(plan->trajectory, plan->trajectory.start_time + from_seconds(s))
              .world_from_body.position_m();
      nearest_m[state] = std::min(
          nearest_m[state],
          (Eigen::Vector3d(at_m.x(), at_m.y(), scenario.robots[0].height_m) - place_m).norm());
    }
  }
  EXPECT_LT(nearest_m[models::FlightState::kFollow], asked_m - 0.1);  // the plan passes too near
  EXPECT_GE(nearest_m[models::FlightState::kIdle], asked_m - 0.02);
}

// A restarted planner does not know the plan that its robot flies and that its teammates plan
// around.
TEST(RobotPlanner, WaitsForTheEndOfAnUnknownPlan) {
  const scenario::Scenario scenario = test::lab_scenario();  // a plan lasts 6 rounds
  PlanInputs inputs = test::first_inputs(scenario, 0);
  models::VehicleStatus& status = inputs.team_statuses["Q1"];
  status.state = models::FlightState::kFollow;
  const auto plans_in = [&](std::int64_t rounds_later) {
    RobotPlanner planner(scenario, "Q1");
    status.plan_round = inputs.slot.round - rounds_later;
    const bool is_planned = planner.plan(inputs, Deadline::nodes(500)).has_value();
    EXPECT_EQ(planner.counts().unknown_plan, is_planned ? 0 : 1);
    EXPECT_EQ(planner.plan_without_search(inputs).has_value(), is_planned);
    PlanInputs before = inputs;
    before.slot.is_proposal = true;
    EXPECT_EQ(planner.propose(before, Deadline::nodes(500)).has_value(), is_planned);
    EXPECT_EQ(planner.counts().unknown_plan, is_planned ? 0 : 2);  // proposals are not counted
    EXPECT_EQ(planner.counts().no_pose, 0);
    return is_planned;
  };
  for (std::int64_t rounds = 0; rounds <= 6; ++rounds) {
    EXPECT_FALSE(plans_in(rounds)) << rounds;
  }
  EXPECT_TRUE(plans_in(8));
  // After 6 s of steps the plan brakes for half a second. The pose is that at the beginning of the
  // slot.
  inputs.slot.begin = inputs.slot.activation - from_seconds(0.49);
  EXPECT_TRUE(plans_in(7));
  inputs.slot.begin = inputs.slot.activation - from_seconds(0.51);
  EXPECT_FALSE(plans_in(7));
  inputs.slot.begin = inputs.slot.activation;
  EXPECT_TRUE(plans_in(-1));  // a future round: the plan has a different schedule

  status.state = models::FlightState::kHold;  // the vehicle does not follow its plan
  EXPECT_TRUE(plans_in(1));
  status.state = models::FlightState::kFollow;
  status.plan_round = -1;  // no plan yet
  EXPECT_TRUE(RobotPlanner(scenario, "Q1").plan(inputs, Deadline::nodes(500)).has_value());

  inputs.own_plan = RobotPlanner(scenario, "Q1").plan(inputs, Deadline::nodes(500));
  EXPECT_TRUE(plans_in(1));  // the planner has its robot's plan
}

}  // namespace
}  // namespace vantage::planner
