#include "planner/robot/round_problem.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "test/planner/robot/team_scenario.hpp"

namespace vantage::planner {
namespace {

// Its noise grows with the steps that a target has not been seen: until the plan begins, not only
// until the belief was made.
TEST(ProblemOfRound, PlansWithTheNoiseOfTargetsAsLongUnseenAsTheyAreThen) {
  scenario::Scenario scenario = test::lab_scenario();
  scenario.estimator.target_model = {models::TargetKind::kGrowingUncertainty, 2, 0.1};
  scenario.planner.step_s = 0.5;
  PlanInputs inputs = test::first_inputs(scenario, 0, 1);
  inputs.belief->stamp.time = inputs.slot.activation - from_seconds(1.2);
  inputs.belief->targets.resize(2);
  inputs.belief->targets[0].last_seen = inputs.belief->stamp.time - from_seconds(0.9);
  inputs.belief->targets[1].last_seen = inputs.belief->stamp.time;
  Workspace workspace(scenario);
  models::Trajectory committed;
  committed.start_time = inputs.slot.activation;
  committed.start = scenario.robots[0].start;
  const RoundProblem round = problem_of_round(workspace, 0, inputs, committed, {});
  ASSERT_GE(round.search.targets.size(), 2U);
  const double whole_steps[] = {4.0, 2.0};  // of 2.1 s and of 1.2 s
  for (std::size_t m = 0; m < 2; ++m) {
    EXPECT_EQ(round.search.targets[m].model.kind, models::TargetKind::kRandomWalk);
    EXPECT_NEAR(round.search.targets[m].model.q, 0.1 * whole_steps[m] / 0.5, 1e-12) << m;
  }
}

/// A field in which unseen targets are told by several Gaussians.
class PlansByMixtures : public ::testing::Test {
 protected:
  PlansByMixtures() {
    scenario_.estimator.target_model = {models::TargetKind::kDoubleIntegrator, 2, 0.01};
    scenario_.estimator.samples = true;
    inputs_ = test::first_inputs(scenario_, 0);
    models::RobotBelief belief;
    belief.stamp = {inputs_.slot.begin, 7, 0};
    belief.robot = "Q1";
    belief.step = 3;
    for (int id = 0; id < 5; ++id) {
      belief.targets.push_back({id, *models::to_information(gaussian(id, 0.0)), belief.stamp.time});
    }
    inputs_.belief = belief;
    inputs_.mixture = models::BeliefMixture{belief.stamp, "Q1", 3, {}};
  }

  static models::Gaussian gaussian(double x_m, double y_m) {
    return {Eigen::Vector4d(x_m, y_m, 0.1, 0.0), 0.3 * Eigen::Matrix4d::Identity()};
  }
  void add(int id, const std::vector<double>& weights) {
    models::TargetMixture target{id, 1.0, {}};
    for (const double weight : weights) {
      const double y_m = 1.0 + static_cast<double>(target.components.size());
      target.components.push_back({weight, gaussian(id, y_m)});
    }
    inputs_.mixture->targets.push_back(target);
  }
  /// Where the problem has targets, by ascending y in each column.
  [[nodiscard]] std::vector<Eigen::Vector2d> places_m() const {
    Workspace workspace(scenario_);
    models::Trajectory committed;
    committed.start_time = inputs_.slot.activation;
    committed.start = scenario_.robots[0].start;
    const RoundProblem round = problem_of_round(workspace, 0, inputs_, committed, {});
    require_valid(round.search);
    std::vector<Eigen::Vector2d> places_m;
    for (const SearchTarget& target : round.search.targets) {
      places_m.emplace_back(target.prior.mean.head<2>());
    }
    return places_m;
  }
  [[nodiscard]] double ahead_m() const {  // at 0.1 m/s until the plan begins
    return 0.1 * to_seconds(inputs_.slot.activation - inputs_.belief->stamp.time);
  }

  scenario::Scenario scenario_ = test::lab_scenario();
  PlanInputs inputs_;
};

// The lab of the tests has targets at rest and nothing that was looked at.
TEST(ProblemOfRound, ExploresUntilAllAreFoundWhereItIsTold) {
  scenario::Scenario scenario = test::lab_scenario();
  PlanInputs inputs = test::first_inputs(scenario, 0, 1);
  const models::VisibilityGrid grid(scenario.world, scenario.estimator.grid_resolution_m,
                                    scenario.estimator.grid_memory_s);
  inputs.belief->grid = grid.geometry();
  inputs.belief->last_seen_utime = grid.last_seen_utime();
  inputs.belief->last_seen_utime[0] = to_utime(inputs.belief->stamp.time);  // a frontier
  const auto landmarks = [&] {
    Workspace workspace(scenario);
    models::Trajectory committed;
    committed.start_time = inputs.slot.activation;
    committed.start = scenario.robots[0].start;
    const RoundProblem round = problem_of_round(workspace, 0, inputs, committed, {});
    EXPECT_EQ(round.unusable_beliefs, 0);
    return round.search.targets.size() - inputs.belief->targets.size();
  };
  ASSERT_EQ(inputs.belief->targets.size(), scenario.targets.size());
  const std::size_t all = landmarks();
  EXPECT_GT(all, 0U);
  scenario.planner.exploration.until_found = true;
  EXPECT_EQ(landmarks(), 0U);
  inputs.belief->targets.pop_back();
  EXPECT_EQ(landmarks(), all);
  scenario.planner.exploration.until_found = false;
  EXPECT_EQ(landmarks(), all);
}

TEST_F(PlansByMixtures, WhereverATargetMayBeThereIsOne) {
  add(1, {0.5, 0.3, 0.2});
  add(4, {0.97, 0.03});  // of less than 1/32 nothing is planned, and one place is the belief's
  const std::vector<Eigen::Vector2d> places_m = this->places_m();
  const double a = ahead_m();
  const std::vector<Eigen::Vector2d> right_m = {{0 + a, 0}, {1 + a, 1}, {1 + a, 2}, {1 + a, 3},
                                                {2 + a, 0}, {3 + a, 0}, {4 + a, 0}};
  ASSERT_EQ(places_m.size(), right_m.size());
  for (std::size_t i = 0; i < right_m.size(); ++i) {
    EXPECT_LT((places_m[i] - right_m[i]).norm(), 1e-9) << i;
  }
}

TEST_F(PlansByMixtures, OfItsVeryBeliefAlone) {
  add(1, {0.5, 0.5});
  EXPECT_EQ(places_m().size(), 6U);
  const models::BeliefMixture right = *inputs_.mixture;
  inputs_.mixture->step = 2;
  EXPECT_EQ(places_m().size(), 5U);
  inputs_.mixture = right;
  inputs_.mixture->stamp.run_id = 8;
  EXPECT_EQ(places_m().size(), 5U);
  inputs_.mixture = right;
  inputs_.mixture->stamp.time += Duration{1};
  EXPECT_EQ(places_m().size(), 5U);
  inputs_.mixture = right;
  inputs_.mixture->robot = "Q2";
  EXPECT_EQ(places_m().size(), 5U);
  inputs_.mixture = right;
  inputs_.mixture->targets[0].components[1].belief = {Eigen::Vector2d::Zero(),
                                                      Eigen::Matrix2d::Identity()};
  EXPECT_EQ(places_m().size(), 5U) << "of another model's state";
  inputs_.mixture = right;
  EXPECT_EQ(places_m().size(), 6U);
}

TEST_F(PlansByMixtures, AsFarAsThereIsRoom) {
  EXPECT_EQ(parts_max(scenario_), 35U);
  for (int id = 0; id < 5; ++id) {
    add(id, std::vector<double>(8, 0.125));
  }
  EXPECT_EQ(places_m().size(), 40U);
  inputs_.mixture->targets[0].components.assign(10, {0.1, gaussian(0, 1.0)});
  EXPECT_EQ(places_m().size(), 10U + 3 * 8U + 1U) << "the last is what its belief says";
  scenario_.estimator.samples = false;
  EXPECT_EQ(parts_max(scenario_), 0U);
  EXPECT_EQ(places_m().size(), 5U);
  scenario_.robots[1].detection.detects_ids = false;
  EXPECT_EQ(parts_max(scenario_), 35U);
}

}  // namespace
}  // namespace vantage::planner
