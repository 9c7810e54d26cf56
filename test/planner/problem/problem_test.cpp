#include "planner/problem/problem.hpp"

#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/search/arvi.hpp"

namespace vantage::planner {
namespace {

SearchProblem valid_problem() {
  SearchProblem problem;
  problem.controls = models::lab_primitives();
  problem.horizon_steps = 3;
  problem.sensors.emplace_back();
  problem.targets = {{{models::TargetKind::kRandomWalk, 2, 0.01},
                      {Eigen::Vector2d(1.0, 2.0), Eigen::Matrix2d::Identity()}},
                     {{models::TargetKind::kDoubleIntegrator, 2, 0.01},
                      {Eigen::Vector4d::Zero(), Eigen::Matrix4d::Identity()}}};
  const std::vector<models::PositionMatrix> steps(3, Eigen::Matrix2d::Identity());
  problem.fixed_information = {steps, steps};
  return problem;
}

struct Fault {
  const char* what;
  std::function<void(SearchProblem&)> make;
};

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<Fault> faults() {
  return {
      {"no steps", [](SearchProblem& p) { p.horizon_steps = 0; }},
      {"more steps than a depth counts", [](SearchProblem& p) { p.horizon_steps = 256; }},
      {"a step of no time", [](SearchProblem& p) { p.step_s = 0.0; }},
      {"a step of no number", [](SearchProblem& p) { p.step_s = kNan; }},
      {"no controls", [](SearchProblem& p) { p.controls.clear(); }},
      {"too many controls", [](SearchProblem& p) { p.controls.resize(65); }},
      {"a control of no number", [](SearchProblem& p) { p.controls[1].yaw_rate_radps = kNan; }},
      {"a backward control", [](SearchProblem& p) { p.controls[0].speed_mps = -1.0; }},
      {"a start of no number", [](SearchProblem& p) { p.start.x_m = kNan; }},
      {"a backward start", [](SearchProblem& p) { p.start_speed_mps = -1.0; }},
      {"a brake of no number", [](SearchProblem& p) { p.brake_mps2 = kNan; }},
      {"a negative brake", [](SearchProblem& p) { p.brake_mps2 = -1.0; }},
      {"a negative clearance", [](SearchProblem& p) { p.clearance_m = -0.1; }},
      {"a negative separation", [](SearchProblem& p) { p.separation_m = -0.1; }},
      {"a field without its world",
       [](SearchProblem& p) {
         static const models::DistanceField field;
         p.field = &field;
       }},
      {"a short mean", [](SearchProblem& p) { p.targets[1].prior.mean.resize(2); }},
      {"a mean of no number", [](SearchProblem& p) { p.targets[0].prior.mean(0) = kNan; }},
      {"a small covariance", [](SearchProblem& p) { p.targets[1].prior.covariance.resize(2, 2); }},
      {"an indefinite covariance",
       [](SearchProblem& p) {
         p.targets[0].prior.covariance(0, 1) = 2.0;
         p.targets[0].prior.covariance(1, 0) = 2.0;
       }},
      {"an asymmetric covariance",
       [](SearchProblem& p) { p.targets[0].prior.covariance(0, 1) = 0.5; }},
      {"a target in four coordinates",
       [](SearchProblem& p) { p.targets[0].model.position_dim = 4; }},
      {"a double integrator in space",
       [](SearchProblem& p) { p.targets[1].model.position_dim = 3; }},
      {"negative process noise", [](SearchProblem& p) { p.targets[0].model.q = -1.0; }},
      {"information for some targets only",
       [](SearchProblem& p) { p.fixed_information.pop_back(); }},
      {"information for some steps only",
       [](SearchProblem& p) { p.fixed_information[0].pop_back(); }},
      {"information of the wrong size",
       [](SearchProblem& p) { p.fixed_information[0][1] = Eigen::Matrix3d::Identity(); }},
      {"a sensor without noise", [](SearchProblem& p) { p.sensors[0].range_sigma_m = 0.0; }},
      {"a sensor of no reach", [](SearchProblem& p) { p.sensors[0].range_max_m = kNan; }},
  };
}

TEST(RequireValid, AcceptsAProblemThatBreaksNoRule) {
  EXPECT_NO_THROW(require_valid(valid_problem()));
}

TEST(RequireValid, RefusesEachBrokenRule) {
  ReducedValueIteration search({1'000, 10'000, 4, 8, 2});
  for (const Fault& fault : faults()) {
    SearchProblem problem = valid_problem();
    fault.make(problem);
    EXPECT_THROW(require_valid(problem), UsageError) << fault.what;
    EXPECT_THROW(search.plan(problem, {}, Deadline::nodes(100)), UsageError) << fault.what;
  }
}

TEST(ReducedValueIteration, RefusesWhatExceedsItsCapacity) {
  ReducedValueIteration search({1'000, 10'000, 1, 2, 0});
  SearchProblem problem = valid_problem();
  problem.fixed_information.clear();
  EXPECT_THROW(search.plan(problem, {}, Deadline::nodes(100)), UsageError) << "targets and steps";
  problem.targets.pop_back();
  EXPECT_THROW(search.plan(problem, {}, Deadline::nodes(100)), UsageError) << "steps";
  problem.horizon_steps = 2;
  EXPECT_NO_THROW(search.plan(problem, {}, Deadline::nodes(100)));
  problem.teammates.emplace_back();
  EXPECT_THROW(search.plan(problem, {}, Deadline::nodes(100)), UsageError) << "teammates";
}

TEST(ReducedValueIteration, RefusesOptionsThatCannotBeMeant) {
  ReducedValueIteration search({1'000, 10'000, 4, 8, 2});
  for (const auto& make : std::vector<std::function<void(ReducedOptions&)>>{
           [](ReducedOptions& o) { o.epsilon = -1.0; }, [](ReducedOptions& o) { o.delta_m = kNan; },
           [](ReducedOptions& o) { o.halvings = 101; },
           [](ReducedOptions& o) { o.yaw_weight_m_per_rad = -0.1; }}) {
    ReducedOptions options;
    make(options);
    EXPECT_THROW(search.plan(valid_problem(), options, Deadline::nodes(100)), UsageError);
  }
}

// One step, one static target, one position sensor: (1 + 1/σ²)⁻¹ on both axes.
TEST(Score, IsWhatOneDoesByHand) {
  SearchProblem problem;
  problem.horizon_steps = 2;
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kPosition;
  sensor.position_sigma_m = 0.5;  // information 4
  problem.sensors = {sensor};
  problem.targets = {{{models::TargetKind::kStatic, 2, 0.0},
                      {Eigen::Vector2d(1.0, 0.0), Eigen::Matrix2d::Identity()}}};
  const std::vector<Pose2> poses{{0.0, 0.0, 0.0}, {100.0, 0.0, 0.0}};  // sees, does not see
  EXPECT_NEAR(score(problem, poses), -4.0 * std::log(5.0), 1e-12);
  problem.cost = CostKind::kTrace;
  EXPECT_NEAR(score(problem, poses), 4.0 / 5.0, 1e-12);
}

TEST(ToTrajectory, EndsInTheStopThatTheSearchChecked) {
  SearchProblem problem = valid_problem();
  problem.start_time = from_utime(1'000'000);
  problem.height_m = 1.5;
  problem.brake_mps2 = 2.0;
  SearchResult result;
  result.controls = {0, 1};
  const models::Trajectory trajectory = to_trajectory(problem, result);
  ASSERT_EQ(trajectory.segments.size(), 3u);
  EXPECT_EQ(trajectory.height_m, 1.5);
  EXPECT_EQ(models::end_time(trajectory), problem.start_time + from_seconds(1.5));
  // Moving no more, it brakes from the speed it has.
  result.controls.clear();
  problem.start_speed_mps = 1.0;
  EXPECT_EQ(to_trajectory(problem, result).segments.size(), 1u);
  problem.start_speed_mps = 0.0;
  EXPECT_TRUE(to_trajectory(problem, result).segments.empty());
}

}  // namespace
}  // namespace vantage::planner
