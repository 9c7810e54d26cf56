#include "planner/problem/problem.hpp"

#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "core/infinity.hpp"
#include "planner/search/arvi.hpp"
#include "test/planner/problem/random_problem.hpp"

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
  const std::vector<models::StateMatrix> steps(3, Eigen::Matrix2d::Identity());
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
      {"an endless step", [](SearchProblem& p) { p.step_s = kInfinity; }},
      {"a step back", [](SearchProblem& p) { p.step_s = -0.5; }},
      {"an endless speed", [](SearchProblem& p) { p.controls.back().speed_mps = kInfinity; }},
      {"a backward last control", [](SearchProblem& p) { p.controls.back().speed_mps = -1e-9; }},
      {"a start beside numbers", [](SearchProblem& p) { p.start.y_m = kInfinity; }},
      {"a heading of no number", [](SearchProblem& p) { p.start.yaw_rad = kNan; }},
      {"a height of no number", [](SearchProblem& p) { p.height_m = -kInfinity; }},
      {"an endless start", [](SearchProblem& p) { p.start_speed_mps = kInfinity; }},
      {"an endless brake", [](SearchProblem& p) { p.brake_mps2 = kInfinity; }},
      {"a clearance of no number", [](SearchProblem& p) { p.clearance_m = kNan; }},
      {"an endless separation", [](SearchProblem& p) { p.separation_m = kInfinity; }},
      {"a mean of no number in the last",
       [](SearchProblem& p) { p.targets[1].prior.mean(3) = kNan; }},
      {"endless process noise", [](SearchProblem& p) { p.targets[1].model.q = kInfinity; }},
      {"a target on a line", [](SearchProblem& p) { p.targets[0].model.position_dim = 1; }},
      {"a long mean", [](SearchProblem& p) { p.targets[0].prior.mean = Eigen::Vector3d::Zero(); }},
      {"a wide covariance",
       [](SearchProblem& p) { p.targets[0].prior.covariance = Eigen::MatrixXd::Identity(2, 3); }},
      {"a high covariance",
       [](SearchProblem& p) { p.targets[0].prior.covariance = Eigen::MatrixXd::Identity(3, 2); }},
      {"an oscillator in space",
       [](SearchProblem& p) {
         p.targets[1].model.kind = models::TargetKind::kDampedOscillator;
         p.targets[1].model.position_dim = 3;
       }},
      {"information for some steps of the last",
       [](SearchProblem& p) { p.fixed_information[1].pop_back(); }},
      {"wide information",
       [](SearchProblem& p) { p.fixed_information[1][2] = Eigen::MatrixXd::Identity(2, 3); }},
      {"high information",
       [](SearchProblem& p) { p.fixed_information[1][2] = Eigen::MatrixXd::Identity(3, 2); }},
      {"information of no number",
       [](SearchProblem& p) { p.fixed_information[1][2](0, 1) = kNan; }},
  };
}

// Returns faults of a single number of one sensor or oscillator among several.
std::vector<Fault> faults_of_one_number() {
  std::vector<Fault> faults;
  for (const double wrong : {0.0, -1.0, kInfinity, kNan}) {
    using models::SensorModel;
    for (const auto number :
         {&SensorModel::fov_rad, &SensorModel::range_sigma_m, &SensorModel::bearing_sigma_rad,
          &SensorModel::position_sigma_m, &SensorModel::pixel_sigma}) {
      faults.push_back({"a sensor's number", [number, wrong](SearchProblem& p) {
                          p.sensors.emplace_back().*number = wrong;
                        }});
    }
    faults.push_back({"a sensor's floor", [wrong](SearchProblem& p) {
                        p.sensors.emplace_back().variance_floor = wrong;
                        p.sensors.back().variance_grows_with_range = true;
                      }});
    using models::DampedOscillator;
    for (const auto number :
         {&DampedOscillator::position_sigma_m, &DampedOscillator::velocity_sigma_mps,
          &DampedOscillator::damping_per_s}) {
      for (const int axis : {0, 1}) {
        faults.push_back({"an oscillator's number", [number, axis, wrong](SearchProblem& p) {
                            p.targets[1].model.kind = models::TargetKind::kDampedOscillator;
                            (p.targets[1].model.oscillator.*number)(axis) = wrong;
                          }});
      }
    }
  }
  for (const double wrong : {0.0, -1.0, kNan}) {
    faults.push_back({"a sensor's reach",
                      [wrong](SearchProblem& p) { p.sensors.emplace_back().range_max_m = wrong; }});
  }
  for (const double wrong : {-1e-9, kInfinity, kNan}) {
    faults.push_back({"a sensor's least range",
                      [wrong](SearchProblem& p) { p.sensors.emplace_back().range_min_m = wrong; }});
  }
  for (const int axis : {0, 1}) {
    faults.push_back({"an oscillator's centre", [axis](SearchProblem& p) {
                        p.targets[1].model.kind = models::TargetKind::kDampedOscillator;
                        p.targets[1].model.oscillator.center_m(axis) = -kInfinity;
                      }});
  }
  return faults;
}

TEST(RequireValid, AcceptsAValidProblem) { EXPECT_NO_THROW(require_valid(valid_problem())); }

TEST(RequireValid, RefusesAProblemThatBreaksAnyRule) {
  ReducedValueIteration search({1'000, 10'000, 4, 8, 2});
  for (const Fault& fault : faults()) {
    SearchProblem problem = valid_problem();
    fault.make(problem);
    EXPECT_THROW(require_valid(problem), UsageError) << fault.what;
    EXPECT_THROW(search.plan(problem, {}, Deadline::nodes(100)), UsageError) << fault.what;
  }
}

TEST(RequireValid, RefusesEachInvalidNumber) {
  for (const Fault& fault : faults_of_one_number()) {
    SearchProblem problem = valid_problem();
    fault.make(problem);
    EXPECT_THROW(require_valid(problem), UsageError) << fault.what;
  }
}

// Values exactly at each limit are accepted.
TEST(RequireValid, AcceptsValuesExactlyAtTheLimits) {
  static const models::World world;
  static const models::DistanceField field;
  const std::vector<Fault> allowed = {
      {"one step", [](SearchProblem& p) { p.horizon_steps = 1; }},
      {"255 steps",
       [](SearchProblem& p) {
         p.horizon_steps = 255;
         p.fixed_information.clear();
       }},
      {"one control", [](SearchProblem& p) { p.controls.resize(1); }},
      {"64 controls", [](SearchProblem& p) { p.controls.resize(64); }},
      {"a turn on the spot",
       [](SearchProblem& p) {
         p.controls[0] = {0.0, -9.0};
       }},
      {"all that may be nothing",
       [](SearchProblem& p) {
         p.start_speed_mps = p.brake_mps2 = p.clearance_m = p.separation_m = 0.0;
         p.targets[0].model.q = 0.0;
         p.sensors[0].range_min_m = 0.0;
       }},
      {"where nothing is below zero",
       [](SearchProblem& p) {
         p.start = {-5.0, -6.0, -3.0};
         p.height_m = -7.0;
       }},
      {"a world", [](SearchProblem& p) { p.world = &world; }},
      {"a field of its world",
       [](SearchProblem& p) {
         p.world = &world;
         p.field = &field;
       }},
      {"an endless reach", [](SearchProblem& p) { p.sensors[0].range_max_m = kInfinity; }},
      {"a floor that nobody needs", [](SearchProblem& p) { p.sensors[0].variance_floor = 0.0; }},
      {"no sensor and no target",
       [](SearchProblem& p) {
         p.sensors.clear();
         p.targets.clear();
         p.fixed_information.clear();
       }},
      {"an oscillator",
       [](SearchProblem& p) {
         p.targets[1].model.kind = models::TargetKind::kDampedOscillator;
         p.targets[1].model.oscillator.center_m = {-2.0, -3.0};
       }},
      {"a target in space, and what is told of it",
       [](SearchProblem& p) {
         p.targets[0].model.position_dim = 3;
         p.targets[0].prior = {Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity()};
         p.fixed_information[0].assign(3, Eigen::Matrix3d::Identity());
       }},
      {"information that is none",
       [](SearchProblem& p) { p.fixed_information[1][1] = models::PositionMatrix(); }},
      {"information for longer", [](SearchProblem& p) { p.horizon_steps = 2; }},
  };
  for (const Fault& each : allowed) {
    SearchProblem problem = valid_problem();
    each.make(problem);
    EXPECT_NO_THROW(require_valid(problem)) << each.what;
  }
}

// An asymmetry of 1e-9 of the greatest variance counts as rounding, whichever entry is greater.
TEST(RequireValid, AllowsRoundingInSymmetry) {
  for (const double side : {1.0, -1.0}) {
    for (const double share : {0.99, 1.01}) {
      SearchProblem problem = valid_problem();
      models::StateMatrix& covariance = problem.targets[0].prior.covariance;
      covariance << 2.0, 0.5, 0.5 + side * share * 1e-9 * 100.0, 100.0;
      if (share < 1.0) {
        EXPECT_NO_THROW(require_valid(problem)) << side;
      } else {
        EXPECT_THROW(require_valid(problem), UsageError) << side;
      }
    }
  }
}

TEST(RequireValid, LimitsTargetsTo16Bits) {
  SearchProblem problem = valid_problem();
  problem.fixed_information.clear();
  problem.targets.assign(65'534, problem.targets[0]);
  EXPECT_NO_THROW(require_valid(problem));
  problem.targets.push_back(problem.targets[0]);
  EXPECT_THROW(require_valid(problem), UsageError);
}

TEST(SearchProblem, HasTheStatedDefaults) {
  const SearchProblem problem;
  EXPECT_EQ(problem.horizon_steps, 12);
  EXPECT_EQ(problem.step_s, 0.5);
  EXPECT_EQ(problem.cost, CostKind::kLogDet);
  EXPECT_EQ(problem.clearance_m, 0.0);
  EXPECT_EQ(problem.separation_m, 0.0);
  EXPECT_EQ(problem.brake_mps2, 0.0);
  EXPECT_EQ(problem.start_speed_mps, 0.0);
  EXPECT_EQ(problem.seed, 0U);
  EXPECT_FALSE(problem.separation_from_above);
  models::World world;
  SearchProblem walled;
  walled.world = &world;
  EXPECT_EQ(sight_world(walled), &world);
  walled.obstacles_block_sight = false;
  EXPECT_EQ(sight_world(walled), nullptr);
  walled.height_m = 2.0;
  models::Trajectory teammate;
  teammate.height_m = 3.0;
  EXPECT_EQ(separation_height_m(walled, teammate), 3.0);
  walled.separation_from_above = true;
  EXPECT_EQ(separation_height_m(walled, teammate), 2.0);
}

TEST(SearchResult, ResetClearsEveryField) {
  SearchResult result;
  result.found = true;
  result.controls = {1, 2};
  result.poses.resize(2);
  result.history.resize(3);
  result.cost = result.lower_bound = result.epsilon = result.delta_m = 7.0;
  result.moving_steps = 2;
  result.passes = result.nodes_generated = result.nodes_expanded = result.work_nodes = 9;
  result.peak_bytes = 10;
  result.stop_reason = StopReason::kMemory;
  EXPECT_EQ(result.replay_budget_nodes(), 10);
  result.stop_reason = StopReason::kDeadline;
  EXPECT_EQ(result.replay_budget_nodes(), 9);
  result.reset();
  EXPECT_FALSE(result.found);
  EXPECT_TRUE(result.controls.empty() && result.poses.empty() && result.history.empty());
  EXPECT_EQ(result.cost, kInfinity);
  EXPECT_EQ(result.lower_bound, -kInfinity);
  EXPECT_EQ(result.epsilon, kInfinity);
  EXPECT_EQ(result.delta_m, kInfinity);
  EXPECT_EQ(result.moving_steps, 0);
  EXPECT_EQ(result.passes, 0);
  EXPECT_EQ(result.nodes_generated, 0);
  EXPECT_EQ(result.nodes_expanded, 0);
  EXPECT_EQ(result.work_nodes, 0);
  EXPECT_EQ(result.peak_bytes, 0U);
  EXPECT_EQ(result.stop_reason, StopReason::kFinished);
  EXPECT_EQ(result.replay_budget_nodes(), 1);
}

TEST(ReducedValueIteration, RefusesProblemsBeyondItsCapacity) {
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

TEST(ReducedValueIteration, RefusesInvalidOptions) {
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

// With one step, one static target and one position sensor, the variance on both axes is (1 +
// 1/σ²)⁻¹.
TEST(Score, EqualsClosedFormForOneStep) {
  SearchProblem problem;
  problem.horizon_steps = 2;
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kPosition;
  sensor.position_sigma_m = 0.5;  // information 4
  problem.sensors = {sensor};
  problem.targets = {{{models::TargetKind::kStatic, 2, 0.0},
                      {Eigen::Vector2d(1.0, 0.0), Eigen::Matrix2d::Identity()}}};
  const std::vector<Pose2> poses{{0.0, 0.0, 0.0}, {100.0, 0.0, 0.0}};  // visible, then not visible
  EXPECT_NEAR(score(problem, poses), -4.0 * std::log(5.0), 1e-12);
  problem.cost = CostKind::kTrace;
  EXPECT_NEAR(score(problem, poses), 4.0 / 5.0, 1e-12);
}

TEST(ToTrajectory, EndsInTheCheckedStop) {
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
  // A plan without steps brakes from the current speed.
  result.controls.clear();
  problem.start_speed_mps = 1.0;
  EXPECT_EQ(to_trajectory(problem, result).segments.size(), 1u);
  problem.start_speed_mps = 0.0;
  EXPECT_TRUE(to_trajectory(problem, result).segments.empty());
}

// The trajectory starts at the problem's start, with one step per control in order, then brakes
// from the speed of the last control. The poses equal those of the unicycle model.
TEST(ToTrajectory, FollowsItsControls) {
  std::mt19937_64 rng(51);
  for (int i = 0; i < 50; ++i) {
    SearchProblem problem;
    problem.start_time = from_utime(1'700'000'000'000'000 + i);
    problem.start = {test::uniform(rng, -5.0, 5.0), test::uniform(rng, -5.0, 5.0),
                     test::uniform(rng, -kPi, kPi)};
    problem.height_m = test::uniform(rng, 0.0, 3.0);
    problem.step_s = test::uniform(rng, 0.2, 1.0);
    problem.brake_mps2 = i % 3 == 0 ? 0.0 : test::uniform(rng, 0.5, 4.0);
    problem.start_speed_mps = test::uniform(rng, 0.1, 3.0);
    problem.controls = models::standard_primitives();
    problem.controls.push_back({0.0, 1.0});
    std::vector<int> controls;
    Pose2 end = problem.start;
    double speed_mps = problem.start_speed_mps;
    for (int k = test::pick(rng, 0, 4); k > 0; --k) {
      controls.push_back(test::pick(rng, 0, 10));
      const auto& control = problem.controls[static_cast<std::size_t>(controls.back())];
      end = models::step_unicycle(end, control, problem.step_s);
      speed_mps = control.speed_mps;
    }
    const auto steps = static_cast<double>(controls.size());
    double duration_s = steps * problem.step_s;
    if (problem.brake_mps2 > 0.0) {
      const double stop_m = 0.5 * speed_mps * speed_mps / problem.brake_mps2;
      end.x_m += stop_m * std::cos(end.yaw_rad);
      end.y_m += stop_m * std::sin(end.yaw_rad);
      duration_s += speed_mps / problem.brake_mps2;
    }
    const models::Trajectory trajectory = to_trajectory(problem, controls);
    EXPECT_EQ(trajectory.start, problem.start);
    EXPECT_EQ(trajectory.start_time, problem.start_time);
    EXPECT_EQ(trajectory.height_m, problem.height_m);
    const bool brakes = problem.brake_mps2 > 0.0 && speed_mps > 0.0;
    EXPECT_EQ(trajectory.segments.size(), controls.size() + (brakes ? 1 : 0));
    EXPECT_EQ(models::end_time(trajectory), problem.start_time + from_seconds(duration_s));
    const Pose2 there = models::at(trajectory, Time::max()).world_from_body;
    EXPECT_LT((there.position_m() - end.position_m()).norm(), 1e-9) << i;
    EXPECT_NEAR(wrap_to_pi(there.yaw_rad - end.yaw_rad), 0.0, 1e-9) << i;
  }
}

// The kept separation from each teammate is the distance at the plan's start minus 1 cm. It is at
// most the required separation and at least 0.
TEST(KeptSeparation, IsDistanceAtPlanStart) {
  std::mt19937_64 rng(52);
  int nearer = 0;
  int farther = 0;
  for (int i = 0; i < 200; ++i) {
    SearchProblem problem;
    problem.start_time = from_utime(1'700'000'000'000'000);
    problem.start = {test::uniform(rng, -5.0, 5.0), test::uniform(rng, -5.0, 5.0), 0.0};
    problem.height_m = test::uniform(rng, 0.5, 2.5);
    problem.separation_m = test::uniform(rng, 0.3, 2.0);
    problem.separation_from_above = i % 2 == 0;
    for (int k = 0; k < 3; ++k) {
      models::Trajectory teammate;
      const double ago_s = test::uniform(rng, -1.0, 2.0);
      teammate.start_time = problem.start_time - from_seconds(ago_s);
      const double yaw_rad = test::uniform(rng, -kPi, kPi);
      const Eigen::Vector2d way_m(std::cos(yaw_rad), std::sin(yaw_rad));
      const Eigen::Vector2d then_m(problem.start.x_m + test::uniform(rng, -1.5, 1.5),
                                   problem.start.y_m + test::uniform(rng, -1.5, 1.5));
      const Eigen::Vector2d from_m = then_m - std::max(0.0, ago_s) * way_m;
      teammate.start = {from_m.x(), from_m.y(), yaw_rad};
      teammate.segments = {{{1.0, 0.0}, 5.0, 0.0}};
      teammate.height_m = test::uniform(rng, 0.5, 2.5);
      problem.teammates.push_back(teammate);
      const double up_m = i % 2 == 0 ? 0.0 : teammate.height_m - problem.height_m;
      const double apart_m = std::hypot((then_m - problem.start.position_m()).norm(), up_m);
      const double kept_m = std::min(problem.separation_m, std::max(0.0, apart_m - 0.01));
      const auto index = static_cast<std::size_t>(k);
      EXPECT_NEAR(required_separation_m(problem, index), kept_m, 2e-6) << i;
      models::Trajectory own;
      own.start = problem.start;
      own.height_m = problem.height_m;
      EXPECT_NEAR(required_separation_m(problem, own, teammate), kept_m, 2e-6) << i;
      (kept_m < problem.separation_m ? nearer : farther) += 1;
    }
  }
  EXPECT_GT(nearer, 50);
  EXPECT_GT(farther, 50);
  SearchProblem one;  // robots at one position: separation 0
  one.separation_m = 1.0;
  one.teammates.resize(1);
  EXPECT_EQ(required_separation_m(one, 0), 0.0);
}

}  // namespace
}  // namespace vantage::planner
