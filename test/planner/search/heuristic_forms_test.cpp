#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/index.hpp"
#include "models/belief/gaussian.hpp"
#include "planner/search/heuristic.hpp"
#include "test/planner/problem/random_problem.hpp"

// Cases in which the bound of Theorem 6 has a closed form: a known number of isotropic
// measurements. A bound below that value is weak; a bound above it is wrong.

namespace vantage::planner {
namespace {

using models::TargetKind;
using test::pick;
using test::random_spd;
using test::uniform;

constexpr double kStep_m = 0.5;  // 1 m/s for 0.5 s

/// Returns a problem with targets of every kind around a robot. The robot's sensors measure
/// position equally well in all coordinates.
SearchProblem all_round_problem(std::mt19937_64& rng) {
  SearchProblem problem;
  problem.start = {uniform(rng, -3.0, 3.0), uniform(rng, -3.0, 3.0), uniform(rng, -kPi, kPi)};
  problem.height_m = 1.5;
  problem.horizon_steps = 6;
  problem.step_s = 0.5;
  problem.controls = {{0.3, 2.0}, {1.0, 0.0}, {0.5, -1.0}};
  problem.cost = pick(rng, 0, 1) == 0 ? CostKind::kTrace : CostKind::kLogDet;
  for (const double range_m : {1.0, 2.0}) {
    models::SensorModel sensor;
    sensor.kind = models::SensorKind::kPosition;
    sensor.range_max_m = range_m;
    sensor.position_sigma_m = uniform(rng, 0.2, 1.0);
    problem.sensors.push_back(sensor);
  }
  if (pick(rng, 0, 1) == 0) {
    std::swap(problem.sensors[0], problem.sensors[1]);
  }
  const bool has_fixed = pick(rng, 0, 2) == 0;
  const models::TargetModel kinds[] = {
      {TargetKind::kStatic, 2, 0.3},      {TargetKind::kRandomWalk, 2, 0.0},
      {TargetKind::kRandomWalk, 2, 0.03}, {TargetKind::kStatic, 3, 0.0},
      {TargetKind::kRandomWalk, 3, 0.02}, {TargetKind::kDoubleIntegrator, 2, 0.05},
      {TargetKind::kDampedOscillator, 2}, {TargetKind::kDoubleIntegrator, 2, 0.0}};
  for (models::TargetModel model : kinds) {
    if (model.kind == TargetKind::kDampedOscillator) {
      model.oscillator = test::random_oscillator(rng);
    }
    const int n = model.dim();
    SearchTarget target{model, {models::StateVector::Zero(n), random_spd(rng, n, 2.0, 1.0)}};
    // Midway between two steps, so that rounding has no effect.
    const double away_m = (pick(rng, 0, 12) + 0.6) * kStep_m;
    const double bearing_rad = uniform(rng, -kPi, kPi);
    target.prior.mean.head<2>() =
        problem.start.position_m() +
        away_m * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad));
    if (n == 3) {
      target.prior.mean(2) = problem.height_m;  // so that distances are horizontal
    } else if (n == 4) {
      target.prior.mean.tail<2>() = Eigen::Vector2d(uniform(rng, -1, 1), uniform(rng, -1, 1));
    }
    problem.targets.push_back(target);
    if (has_fixed) {
      problem.fixed_information.emplace_back(index(problem.horizon_steps));
      const int p = model.position_dim;
      // Teammates measure each target in one step only, the first target in the last step.
      const int k = problem.targets.size() == 1 ? problem.horizon_steps - 1 : pick(rng, 0, 5);
      problem.fixed_information.back()[index(k)] = random_spd(rng, p, 5.0, 1.0);
    }
  }
  return problem;
}

/// Returns the cost of each step after `depth` for target m with belief `belief`, if every sensor
/// that can be in range from `at` measures the target. The first cost is at index depth + 1.
std::vector<double> stages(const SearchProblem& problem, int m, const Pose2& at, int depth,
                           models::Gaussian belief, bool nobody_looks = false) {
  const models::TargetModel& model = problem.targets[index(m)].model;
  std::vector<double> out(index(problem.horizon_steps + 1), 0.0);
  for (int k = depth + 1; k <= problem.horizon_steps; ++k) {
    belief = models::predict(belief, model, problem.step_s);
    if (!problem.fixed_information.empty() &&
        problem.fixed_information[index(m)][index(k - 1)].size() > 0) {
      belief.covariance = models::update_covariance(
          belief.covariance, problem.fixed_information[index(m)][index(k - 1)]);
    }
    const double way_m = (belief.mean.head<2>() - at.position_m()).norm();
    for (const models::SensorModel& sensor : problem.sensors) {
      if (!nobody_looks && way_m < sensor.range_max_m + (k - depth) * kStep_m) {
        const int p = model.position_dim;
        belief.covariance = models::update_covariance(
            belief.covariance, models::PositionMatrix(Eigen::MatrixXd::Identity(p, p) /
                                                      std::pow(sensor.position_sigma_m, 2)));
      }
    }
    out[index(k)] = problem.cost == CostKind::kTrace ? belief.covariance.trace()
                                                     : models::log_det(belief.covariance);
  }
  return out;
}

double sum(const std::vector<double>& all) {
  double total = 0.0;
  for (const double each : all) {
    total += each;
  }
  return total;
}

/// Returns the belief about a target at `depth` if the robot takes no measurements.
models::Gaussian open_loop(const SearchProblem& problem, int m, int depth) {
  models::Gaussian belief = problem.targets[index(m)].prior;
  for (int k = 1; k <= depth; ++k) {
    belief = models::predict(belief, problem.targets[index(m)].model, problem.step_s);
    if (!problem.fixed_information.empty() &&
        problem.fixed_information[index(m)][index(k - 1)].size() > 0) {
      belief.covariance = models::update_covariance(
          belief.covariance, problem.fixed_information[index(m)][index(k - 1)]);
    }
  }
  return belief;
}

/// True if a distance at some step is so near to a limit that the result depends on rounding.
bool is_close(const SearchProblem& problem, const Pose2& at, int depth) {
  for (int m = 0; m < static_cast<int>(problem.targets.size()); ++m) {
    const bool rounds = problem.targets[index(m)].model.dim() < 4;  // rounded to quarters of a step
    for (int k = depth + 1; k <= problem.horizon_steps; ++k) {
      const double way_m =
          (open_loop(problem, m, k).mean.head<2>() - at.position_m()).norm() / kStep_m;
      const double beyond = way_m - std::floor(way_m);
      if (beyond < (rounds ? 0.25 : 1e-6) || beyond > 1.0 - 1e-6) {
        return true;
      }
    }
  }
  return false;
}

class InformationHeuristicTest : public ::testing::Test {
 protected:
  InformationHeuristic heuristic_{8, 8};
  BeliefTable beliefs_{8, 8};
  void reset(const SearchProblem& problem) {
    beliefs_.reset(problem);
    heuristic_.reset(problem, beliefs_);
  }
};

// Targets are near and far, with and without earlier measurements. The heuristic starts from every
// depth. With `apart`, it also returns the part of the cost that belongs to selected targets.
TEST_F(InformationHeuristicTest, EqualsClosedFormForIsotropicMeasurements) {
  std::mt19937_64 rng(51);
  int compared = 0;
  for (int trial = 0; trial < 250; ++trial) {
    SCOPED_TRACE(trial);
    const SearchProblem problem = all_round_problem(rng);
    reset(problem);
    const int targets = static_cast<int>(problem.targets.size());
    const int depth = pick(rng, 0, problem.horizon_steps - 1);
    Pose2 at = problem.start;
    if (depth > 0) {
      at = {at.x_m + uniform(rng, -0.3, 0.3) * depth, at.y_m + uniform(rng, -0.3, 0.3) * depth,
            uniform(rng, -kPi, kPi)};
    }
    if (is_close(problem, at, depth)) {
      continue;
    }
    ++compared;
    std::vector<std::uint16_t> touched;
    std::vector<double> packed;
    std::vector<std::uint8_t> apart(index(targets));
    std::vector<double> expected;
    for (int m = 0; m < targets; ++m) {
      models::Gaussian belief = open_loop(problem, m, depth);
      if (pick(rng, 0, 2) == 0) {
        belief.covariance =
            random_spd(rng, static_cast<int>(belief.mean.rows()), uniform(rng, 0.05, 1.0), 1.0);
        touched.push_back(static_cast<std::uint16_t>(m));
        packed.resize(packed.size() + kMaxPacked);
        double* const block = packed.data() + packed.size() - kMaxPacked;
        pack(beliefs_.layout(m), belief.covariance, block);
        packed.resize(packed.size() - kMaxPacked + index(packed_size(beliefs_.layout(m))));
      }
      apart[index(m)] = pick(rng, 0, 1) == 0 ? 1 : 0;
      expected.push_back(sum(stages(problem, m, at, depth, belief)));
    }
    const Blocks blocks{touched, packed.data()};
    double all = 0.0;
    double some = 0.0;
    for (int m = 0; m < targets; ++m) {
      all += expected[index(m)];
      some += apart[index(m)] != 0 ? expected[index(m)] : 0.0;
    }
    const double play = 1e-7 * std::max(1.0, std::abs(all));
    EXPECT_NEAR(heuristic_.cost_to_go(at, depth, blocks), all, play);
    const auto parts = heuristic_.cost_to_go(at, depth, blocks, apart.data());
    EXPECT_NEAR(parts.all, all, play);
    EXPECT_NEAR(parts.apart, some, play);
    // A second call uses the filled tables.
    EXPECT_EQ(heuristic_.cost_to_go(at, depth, blocks, apart.data()).all, parts.all);
    EXPECT_EQ(heuristic_.cost_to_go(at, problem.horizon_steps, blocks), 0.0);
  }
  EXPECT_GT(compared, 50);
}

// The floors are the stage costs of a robot that is near all reachable targets, step by step. The
// cost without measurements is the sum of the remaining stages.
TEST_F(InformationHeuristicTest, FloorsAndOpenLoopCostEqualClosedForm) {
  std::mt19937_64 rng(52);
  int compared = 0;
  for (int trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE(trial);
    const SearchProblem problem = all_round_problem(rng);
    if (is_close(problem, problem.start, 0)) {
      continue;
    }
    ++compared;
    reset(problem);
    std::vector<double> floors(index(problem.horizon_steps + 1), 0.0);
    std::vector<double> rests(index(problem.horizon_steps + 1), 0.0);
    for (int m = 0; m < static_cast<int>(problem.targets.size()); ++m) {
      const models::Gaussian& prior = problem.targets[index(m)].prior;
      const std::vector<double> seen = stages(problem, m, problem.start, 0, prior);
      const std::vector<double> unseen = stages(problem, m, problem.start, 0, prior, true);
      double rest = 0.0;
      for (int k = problem.horizon_steps; k >= 0; --k) {
        floors[index(k)] += seen[index(k)];
        EXPECT_NEAR(heuristic_.open_loop_rest(m, k), rest, 1e-7 * std::max(1.0, std::abs(rest)));
        rests[index(k)] += rest;
        rest += unseen[index(k)];
      }
    }
    for (int k = 0; k <= problem.horizon_steps; ++k) {
      EXPECT_NEAR(heuristic_.open_loop_rest(k), rests[index(k)],
                  1e-7 * std::max(1.0, std::abs(rests[index(k)])));
      if (k > 0) {
        EXPECT_NEAR(heuristic_.stage_floor(k), floors[index(k)],
                    1e-7 * std::max(1.0, std::abs(floors[index(k)])));
      }
    }
  }
  EXPECT_GT(compared, 20);
}

// A moving target starts just within and just beyond the reach of the k-th measurement, for planar
// targets and for spatial targets at other heights.
TEST_F(InformationHeuristicTest, CountsFromFirstStepInRange) {
  for (const double drop_m : {0.0, 1.2, -1.2}) {
    SearchProblem problem;
    problem.start = {1.0, -2.0, 2.5};
    problem.height_m = 2.0;
    problem.horizon_steps = 5;
    problem.step_s = 0.5;
    problem.controls = {{1.0, 0.0}, {0.2, 1.0}};
    models::SensorModel sensor;
    sensor.kind = models::SensorKind::kPosition;
    sensor.range_max_m = 2.0;
    sensor.position_sigma_m = 0.5;
    problem.sensors = {sensor};
    const bool in_space = drop_m != 0.0;
    const double sight_m = in_space ? 1.6 : 2.0;  // 1.2, 1.6, 2 is a right triangle
    const models::TargetModel model =
        in_space ? models::TargetModel{TargetKind::kRandomWalk, 3, 0.01}
                 : models::TargetModel{TargetKind::kDoubleIntegrator, 2, 0.01};
    const int n = model.dim();
    for (int first = 1; first <= problem.horizon_steps; ++first) {
      for (const double beyond_m : {-1e-6, 1e-6}) {
        SearchTarget target{model, {models::StateVector::Zero(n), Eigen::MatrixXd::Identity(n, n)}};
        const double away_m = sight_m + first * kStep_m + beyond_m;
        target.prior.mean.head<2>() =
            problem.start.position_m() + away_m * Eigen::Vector2d(std::cos(2.0), -std::sin(2.0));
        if (in_space) {
          target.prior.mean(2) = problem.height_m - drop_m;
        }
        problem.targets = {target};
        reset(problem);
        EXPECT_NEAR(heuristic_.sight_m(0), sight_m, 1e-12);
        EXPECT_NEAR(heuristic_.step_m(), kStep_m, 1e-8);
        models::Gaussian belief = target.prior;
        double expected = 0.0;
        for (int k = 1; k <= problem.horizon_steps; ++k) {
          belief = models::predict(belief, model, problem.step_s);
          if (k > first || (k == first && beyond_m < 0.0)) {
            const int p = model.position_dim;
            belief.covariance = models::update_covariance(
                belief.covariance, models::PositionMatrix(4.0 * Eigen::MatrixXd::Identity(p, p)));
          }
          expected += models::log_det(belief.covariance);
        }
        // The target has a separate belief, so its distance is exact instead of tabulated.
        double packed[kMaxPacked];
        pack(beliefs_.layout(0), target.prior.covariance, packed);
        const std::uint16_t touched[] = {0};
        EXPECT_NEAR(heuristic_.cost_to_go(problem.start, 0, {touched, packed}), expected, 1e-8)
            << "from " << first << " steps beyond its range";
      }
    }
  }
}

SearchProblem round_about(const models::TargetModel& model, models::SensorModel sensor,
                          CostKind cost) {
  SearchProblem problem;
  problem.horizon_steps = 5;
  problem.step_s = 0.5;
  problem.controls = {{1.0, 0.0}, {1.0, 1.0}};
  problem.cost = cost;
  sensor.range_max_m = 20.0;
  problem.sensors = {sensor};
  const int n = model.dim();
  problem.targets = {{model, {models::StateVector::Zero(n), Eigen::MatrixXd::Identity(n, n)}}};
  problem.targets[0].prior.mean(0) = 2.0;
  if (n == 4) {
    problem.targets[0].prior.covariance(2, 2) = problem.targets[0].prior.covariance(3, 3) = 0.3;
    for (const int i : {0, 1}) {
      problem.targets[0].prior.covariance(i, i + 2) = 0.1;
      problem.targets[0].prior.covariance(i + 2, i) = 0.1;
    }
  }
  return problem;
}

// A range gives information in one direction only. For a static target the bound assumes that all
// measurements are made in the best directions. For a moving target it credits half of each
// measurement to each of two directions.
TEST_F(InformationHeuristicTest, EqualsClosedFormForRanges) {
  constexpr double kStrength = 16.0;
  models::SensorModel range;
  range.kind = models::SensorKind::kRange;
  range.range_sigma_m = 0.25;
  for (const CostKind cost : {CostKind::kTrace, CostKind::kLogDet}) {
    const SearchProblem still = round_about({TargetKind::kStatic, 2, 0.0}, range, cost);
    reset(still);
    double expected = 0.0;
    for (int k = 1; k <= still.horizon_steps; ++k) {
      const double trace = 2.0 + k * kStrength;  // trace of the information
      const double det = k == 1 ? 1.0 + kStrength : 0.25 * trace * trace;
      expected += cost == CostKind::kTrace ? trace / det : -std::log(det);
    }
    EXPECT_NEAR(heuristic_.cost_to_go(still.start, 0, {}), expected, 1e-9 * std::abs(expected));

    models::TargetModel swings{TargetKind::kDampedOscillator, 2};
    swings.oscillator.damping_per_s.setConstant(0.4);
    for (const models::TargetModel& model :
         {models::TargetModel{TargetKind::kDoubleIntegrator, 2, 0.1}, swings}) {
      const SearchProblem moving = round_about(model, range, cost);
      reset(moving);
      models::Gaussian belief = moving.targets[0].prior;
      double half = 0.0;
      for (int k = 1; k <= moving.horizon_steps; ++k) {
        belief = models::predict(belief, model, moving.step_s);
        belief.covariance = models::update_covariance(
            belief.covariance,
            models::PositionMatrix(0.5 * kStrength * Eigen::Matrix2d::Identity()));
        half += cost == CostKind::kTrace ? belief.covariance.trace()
                                         : models::log_det(belief.covariance);
      }
      EXPECT_NEAR(heuristic_.cost_to_go(moving.start, 0, {}), half, 1e-9 * std::abs(half));
    }

    // For a slow random walk, either form may be the larger one at a step.
    const SearchProblem spreads = round_about({TargetKind::kRandomWalk, 2, 0.1}, range, cost);
    reset(spreads);
    models::Gaussian belief = spreads.targets[0].prior;
    double larger = 0.0;
    for (int k = 1; k <= spreads.horizon_steps; ++k) {
      belief = models::predict(belief, spreads.targets[0].model, spreads.step_s);
      belief.covariance = models::update_covariance(
          belief.covariance, models::PositionMatrix(0.5 * kStrength * Eigen::Matrix2d::Identity()));
      const double trace = 2.0 + k * kStrength;
      const double det = k == 1 ? 1.0 + kStrength : 0.25 * trace * trace;
      larger += cost == CostKind::kTrace
                    ? std::max(belief.covariance.trace(), trace / det)
                    : std::max(models::log_det(belief.covariance), -std::log(det));
    }
    EXPECT_NEAR(heuristic_.cost_to_go(spreads.start, 0, {}), larger, 1e-9 * std::abs(larger));
  }
}

// Compares the greatest information of one measurement, per sensor, with closed forms. The robot
// measures from a distance within an interval, or up to the given number of steps nearer.
TEST_F(InformationHeuristicTest, BoundsOneMeasurementAsInClosedForm) {
  constexpr double kPlay = 1e-6;
  models::SensorModel sensor;
  sensor.range_max_m = 3.0;
  sensor.range_min_m = 0.2;
  sensor.range_sigma_m = 0.5;
  sensor.bearing_sigma_rad = 0.25;
  sensor.position_sigma_m = 0.4;
  sensor.calibration.range_scale = 1.5;
  const double range = 9.0;      // (1.5 / 0.5)²
  const double position = 6.25;  // 1 / 0.4²
  const auto bearing = [](double r_m) { return 16.0 / (r_m * r_m); };
  SearchProblem problem;
  problem.height_m = 1.0;
  problem.controls = {{1.0, 0.0}, {0.4, 0.0}};
  problem.step_s = 0.5;
  for (const int dim : {2, 3}) {
    problem.targets.push_back(
        {{TargetKind::kStatic, dim, 0.0},
         {models::StateVector::Zero(dim), Eigen::MatrixXd::Identity(dim, dim)}});
  }
  problem.targets[1].prior.mean(2) = problem.height_m;
  const auto look = [&](const std::vector<models::SensorKind>& kinds, int m, double nearest_m,
                        double farthest_m, int steps) {
    problem.sensors.clear();
    for (const models::SensorKind kind : kinds) {
      sensor.kind = kind;
      problem.sensors.push_back(sensor);
    }
    reset(problem);
    return heuristic_.look_bound(m, nearest_m, farthest_m, steps);
  };
  using Kind = models::SensorKind;
  const auto expect = [&](const LookBound& is, double all_round, double pointed, int count) {
    EXPECT_NEAR(is.all_round, all_round, kPlay * std::max(1.0, all_round));
    EXPECT_NEAR(is.pointed, pointed, kPlay * std::max(1.0, pointed));
    EXPECT_EQ(is.pointed_count, count);
  };
  expect(look({Kind::kPosition}, 0, 2.0, 2.5, 0), position, 0.0, 0);
  expect(look({Kind::kRange}, 0, 2.0, 2.5, 0), 0.0, range, 1);
  expect(look({Kind::kBearing}, 0, 2.0, 2.5, 0), 0.0, bearing(2.0), 1);
  expect(look({Kind::kBearing}, 0, 2.0, 2.5, 2), 0.0, bearing(1.0), 1);
  expect(look({Kind::kBearing}, 0, 2.0, 2.5, 9), 0.0, bearing(0.2), 1);  // at minimum range
  // Far away a range gives more information, nearby a bearing does. The bound credits the weaker of
  // the two in every direction.
  expect(look({Kind::kRangeBearing}, 0, 2.0, 2.5, 0), bearing(2.0), range - bearing(2.0), 1);
  expect(look({Kind::kRangeBearing}, 0, 1.0, 2.5, 0), range, bearing(1.0) - range, 1);
  // The information of several sensors adds up; for a spatial target, in all directions.
  expect(look({Kind::kRange, Kind::kPosition, Kind::kBearing}, 0, 2.0, 2.5, 0), position,
         range + bearing(2.0), 2);
  expect(look({Kind::kRange, Kind::kBearing}, 1, 2.0, 2.5, 0), range + bearing(2.0), 0.0, 0);
  // The target is just outside or just within the range.
  expect(look({Kind::kRange}, 0, 4.0 + 1e-6, 4.5, 2), 0.0, 0.0, 0);
  expect(look({Kind::kRange}, 0, 4.0 - 1e-6, 4.5, 2), 0.0, range, 1);
  // In the first case all distances of the interval are below the minimum range.
  expect(look({Kind::kRange}, 0, 0.0, 0.1, 0), 0.0, 0.0, 0);
  expect(look({Kind::kRange}, 0, 0.0, 0.3, 0), 0.0, range, 1);
}

TEST_F(InformationHeuristicTest, EqualsClosedFormForStaticAndFixedTargets) {
  std::mt19937_64 rng(53);
  bool seen_fixed = false;
  for (int trial = 0; trial < 20; ++trial) {
    SearchProblem problem = all_round_problem(rng);
    const bool has_fixed = !problem.fixed_information.empty();
    seen_fixed = seen_fixed || has_fixed;
    if (has_fixed) {
      problem.fixed_information[2].assign(index(problem.horizon_steps),
                                          models::PositionMatrix::Zero(2, 2));  // no information
    }
    reset(problem);
    for (int m = 0; m < 8; ++m) {
      const models::TargetModel& model = problem.targets[index(m)].model;
      const bool looked_at = has_fixed && m != 2;
      EXPECT_EQ(heuristic_.has_static_position(m), m < 5) << m;
      EXPECT_EQ(heuristic_.has_fixed(m), looked_at) << m;
      const bool spreads = model.kind != TargetKind::kStatic && model.q > 0.0;
      EXPECT_EQ(heuristic_.has_only_own_information(m), m < 5 && !spreads && !looked_at) << m;
      const bool is_alike = model.kind != TargetKind::kDampedOscillator ||
                            (model.transition(0.5)(0, 0) == model.transition(0.5)(1, 1) &&
                             model.transition(0.5)(0, 2) == model.transition(0.5)(1, 3));
      EXPECT_EQ(heuristic_.is_averaged(m), model.position_dim == 2 && !looked_at && is_alike) << m;
    }
  }
  EXPECT_TRUE(seen_fixed);
}

// A bearing sensor without a minimum range has unlimited information, so nodes and stages have no
// bound.
TEST_F(InformationHeuristicTest, HasNoBoundForUnlimitedInformation) {
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kBearing;
  sensor.range_min_m = 0.0;
  SearchProblem problem =
      round_about({TargetKind::kDoubleIntegrator, 2, 0.1}, sensor, CostKind::kLogDet);
  const double infinity = std::numeric_limits<double>::infinity();
  problem.targets[0].prior.mean(0) = 1.2;  // m; reached in the third step
  reset(problem);
  EXPECT_EQ(heuristic_.cost_to_go(problem.start, 0, {}), -infinity);
  for (int k = 1; k <= problem.horizon_steps; ++k) {
    EXPECT_EQ(heuristic_.stage_floor(k), -infinity) << k;
  }
  problem.targets[0].prior.mean(0) = 9.0;  // m; not reached
  reset(problem);
  EXPECT_TRUE(std::isfinite(heuristic_.cost_to_go(problem.start, 0, {})));
  EXPECT_TRUE(std::isfinite(heuristic_.stage_floor(1)));
}

}  // namespace
}  // namespace vantage::planner
