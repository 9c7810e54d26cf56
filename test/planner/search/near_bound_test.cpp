#include "planner/search/near_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "planner/search/root_bound.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/exhaustive_oracle.hpp"

namespace vantage::planner {
namespace {

using test::OwnedProblem;
using test::pick;
using test::uniform;

// Returns a problem with targets around the start, in which bearing measurements from very near a
// target dominate.
OwnedProblem crowded_problem(std::uint64_t seed) {
  std::mt19937_64 rng(0xBF58476D1CE4E5B9U * (seed + 1));
  OwnedProblem owned;
  SearchProblem& problem = owned.problem;
  problem.horizon_steps = pick(rng, 2, 5);
  const double speed_mps = uniform(rng, 0.3, 2.0);
  problem.controls = {{speed_mps, 0.0}, {speed_mps, 2.5}, {speed_mps, -2.5}};
  if (problem.horizon_steps < 5) {
    problem.controls.push_back({0.5 * speed_mps, 1.0});
  }
  if (pick(rng, 0, 3) == 0) {
    problem.controls.push_back({0.0, 1.0});
  }
  problem.cost = pick(rng, 0, 2) == 0 ? CostKind::kTrace : CostKind::kLogDet;
  models::SensorModel sensor;
  sensor.kind =
      pick(rng, 0, 2) == 0 ? models::SensorKind::kBearing : models::SensorKind::kRangeBearing;
  sensor.range_max_m = uniform(rng, 1.0, 5.0);
  sensor.range_min_m = pick(rng, 0, 1) == 0 ? 1e-3 : 0.05;
  sensor.variance_grows_with_range = pick(rng, 0, 1) == 0;
  if (pick(rng, 0, 1) == 0) {
    sensor.fov_rad = radians(uniform(rng, 60.0, 300.0));
  }
  problem.sensors = {sensor};
  for (int m = pick(rng, 1, 4); m > 0; --m) {
    SearchTarget target{{models::TargetKind::kDoubleIntegrator, 2, uniform(rng, 0.0, 0.01)}, {}};
    if (pick(rng, 0, 3) == 0) {
      target.model = {models::TargetKind::kRandomWalk, 2, uniform(rng, 1e-4, 0.05)};
    }
    const int n = target.model.dim();
    target.prior.mean = models::StateVector::Zero(n);
    for (int i = 0; i < n; ++i) {
      target.prior.mean(i) = i < 2 ? uniform(rng, -1.5, 1.5) : uniform(rng, -0.4, 0.4);
    }
    // Every second target is on the path of some control.
    if (pick(rng, 0, 1) == 0) {
      const auto& control = problem.controls[rng() % problem.controls.size()];
      const int t = pick(rng, 1, problem.horizon_steps);
      const Eigen::Vector2d p_m =
          models::step_unicycle({}, control, t * problem.step_s).position_m();
      for (int i = 0; i < 2; ++i) {
        const double drift_m = n == 4 ? t * problem.step_s * target.prior.mean(i + 2) : 0.0;
        target.prior.mean(i) = p_m(i) - drift_m + uniform(rng, -0.02, 0.02);
      }
    }
    target.prior.covariance = test::random_spd(rng, n, uniform(rng, 0.1, 2.0), 1.0);
    problem.targets.push_back(target);
  }
  test::let_one_in_three_oscillate(seed, rng, problem);
  return owned;
}

// The bounds of a problem and the optimum by exhaustive search.
class Bounds {
 public:
  void expect_below_every_plan(const SearchProblem& problem, double relative_slack) {
    const test::OracleAnswer best = test::best_completion(problem, test::start_of(problem));
    ASSERT_TRUE(best.found);
    beliefs_.reset(problem);
    any_plan = root.of_any_plan(problem, beliefs_);
    work_nodes = 0;
    const auto moving = root.of_moving_plan(Deadline::never(), work_nodes);
    EXPECT_FALSE(moving.expired);
    moving_plan = moving.cost;
    EXPECT_GE(moving_plan, any_plan);
    ASSERT_LE(moving_plan, best.cost + relative_slack * std::max(1.0, std::abs(best.cost)));
  }
  [[nodiscard]] bool is_tighter() const { return moving_plan > any_plan + 0.1; }

  RootBound root{8, 8};
  double any_plan = 0.0;
  double moving_plan = 0.0;
  std::int64_t work_nodes = 0;

 private:
  BeliefTable beliefs_{8, 8};
};

TEST(NearBound, IsBelowEveryMovingPlanAndOftenTighter) {
  Bounds bounds;
  int tighter = 0;
  double gained = 0.0;  // sum over costs in nats and in m²
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    SCOPED_TRACE(seed);
    const OwnedProblem owned = crowded_problem(seed);
    // The reference recursion loses digits very near a target.
    ASSERT_NO_FATAL_FAILURE(bounds.expect_below_every_plan(owned.problem, 1e-4));
    tighter += bounds.is_tighter() ? 1 : 0;
    gained += bounds.moving_plan - bounds.any_plan;
    for (std::int64_t budget_nodes = 0; budget_nodes < bounds.work_nodes; budget_nodes += 3) {
      std::int64_t cut_work_nodes = 0;
      const auto cut = bounds.root.of_moving_plan(Deadline::nodes(budget_nodes), cut_work_nodes);
      ASSERT_LE(cut.cost, bounds.moving_plan);
      ASSERT_GE(cut.cost, bounds.any_plan);
    }
  }
  EXPECT_GT(tighter, 150);
  // Measured sum: 15 178; if the discs had half the largest radius: 13 884.
  EXPECT_GT(gained, 15'000.0);
}

// A robot that moves 1 m per step is near a target at one step; a robot that can hover may stay.
// The bound must distinguish both at every step of the horizon.
TEST(NearBound, AllowsOneStepNearATargetIfTheRobotMoves) {
  RootBound root(8, 8);
  BeliefTable beliefs(8, 8);
  for (int k = 1; k <= 4; ++k) {
    SearchProblem problem;
    problem.horizon_steps = 5;
    problem.step_s = 1.0;
    models::SensorModel sensor;
    sensor.kind = models::SensorKind::kBearing;
    sensor.range_min_m = 1e-3;
    sensor.range_max_m = 20.0;
    problem.sensors = {sensor};
    problem.targets = {
        {{models::TargetKind::kDoubleIntegrator, 2, 0.01},
         {Eigen::Vector4d(k, 0.0, 0.0, 0.0), Eigen::Vector4d(1.0, 1.0, 0.01, 0.01).asDiagonal()}}};
    const auto bound_with = [&](const std::vector<models::UnicycleControl>& controls) {
      problem.controls = controls;
      beliefs.reset(problem);
      static_cast<void>(root.of_any_plan(problem, beliefs));
      std::int64_t work_nodes = 0;
      return root.of_moving_plan(Deadline::never(), work_nodes).cost;
    };
    const double moves = bound_with({{1.0, 0.0}, {-1.0, 0.0}});
    const double stays = bound_with({{1.0, 0.0}, {-1.0, 0.0}, {0.0, 0.0}});
    EXPECT_GT(moves, stays + 5.0) << "first near the target at step " << k;
  }
}

// Returns a problem with several targets 0.5 m to 1 m apart and a slow robot that stays near all of
// them at every step. With overlapping discs the bound would count one near target at a time only.
OwnedProblem slow_among_targets(std::uint64_t seed) {
  std::mt19937_64 rng(0x94D049BB133111EBU * (seed + 1));
  OwnedProblem owned;
  SearchProblem& problem = owned.problem;
  problem.horizon_steps = pick(rng, 2, 5);
  const double speed_mps = uniform(rng, 0.02, 0.2);
  problem.controls = {{speed_mps, 0.0}, {speed_mps, 2.0}, {speed_mps, -2.0}};
  problem.cost = pick(rng, 0, 2) == 0 ? CostKind::kTrace : CostKind::kLogDet;
  // The bound ignores directions. With isotropic information it almost equals the cost of a plan
  // that stays near all targets.
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kPosition;
  sensor.position_sigma_m = uniform(rng, 0.05, 0.5);
  sensor.range_max_m = uniform(rng, 1.0, 3.0);
  sensor.variance_grows_with_range = true;
  sensor.variance_floor = uniform(rng, 0.0, 0.05);
  if (pick(rng, 0, 2) == 0) {
    sensor.kind = models::SensorKind::kRangeBearing;
    sensor.range_min_m = 1e-3;
    sensor.range_sigma_m = uniform(rng, 0.01, 0.1);
    sensor.variance_grows_with_range = pick(rng, 0, 1) == 0;
  }
  problem.sensors = {sensor};
  const int count = pick(rng, 2, 6);
  const double spacing_m = uniform(rng, 0.5, 1.0) * (count > 3 ? 0.6 : 1.0);
  const double ring_m = 0.5 * spacing_m / std::sin(kPi / count);
  const double turn_rad = uniform(rng, -kPi, kPi);
  for (int m = 0; m < count; ++m) {
    SearchTarget target{{models::TargetKind::kDoubleIntegrator, 2, uniform(rng, 0.0, 0.01)}, {}};
    target.prior.mean = models::StateVector::Zero(4);
    const double bearing_rad = turn_rad + 2.0 * kPi * m / count;
    target.prior.mean.head<2>() =
        ring_m * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad));
    target.prior.covariance = Eigen::Vector4d(1.0, 1.0, 0.01, 0.01).asDiagonal();
    problem.targets.push_back(target);
  }
  test::let_one_in_three_oscillate(seed, rng, problem);
  return owned;
}

TEST(NearBound, IsBelowPlansNearSeveralTargets) {
  Bounds bounds;
  int tight = 0;  // tighter than the bound of all plans
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    const OwnedProblem owned = slow_among_targets(seed);
    ASSERT_NO_FATAL_FAILURE(bounds.expect_below_every_plan(owned.problem, 1e-6));
    tight += bounds.is_tighter() ? 1 : 0;
  }
  EXPECT_GT(tight, 20);
}

// A robot circles around one of several targets and is near it at every step. Its distance is just
// above the minimum range, where range and bearing have equal information. Its plan therefore has
// the full gain that the bound allows.
TEST(NearBound, AllowsEveryStepNearATargetIfTheRobotCanStay) {
  Bounds bounds;
  std::mt19937_64 rng(71);
  for (int count = 1; count <= 4; ++count) {
    for (int visited = 0; visited < count; ++visited) {
      for (const CostKind cost : {CostKind::kLogDet, CostKind::kTrace}) {
        SCOPED_TRACE(testing::Message() << visited << " of " << count);
        SearchProblem problem;
        problem.horizon_steps = pick(rng, 2, 5);
        problem.cost = cost;
        constexpr double kRadius_m = 0.08;  // within the smallest discs
        const double turn_radps = uniform(rng, 2.0, 5.0);
        problem.controls = {{kRadius_m * turn_radps, turn_radps}, {0.1, 0.0}};
        models::SensorModel sensor;
        sensor.kind = models::SensorKind::kRangeBearing;
        sensor.bearing_sigma_rad = 0.05;
        sensor.range_sigma_m = kRadius_m * sensor.bearing_sigma_rad;
        sensor.range_min_m = 0.999 * kRadius_m;
        sensor.range_max_m = 4.0;
        problem.sensors = {sensor};
        for (int m = 0; m < count; ++m) {
          const double away_m = m == visited ? 0.0 : 9.0 + 3.0 * m;
          SearchTarget target{{models::TargetKind::kRandomWalk, 2, 0.05}, {}};
          target.prior = {Eigen::Vector2d(away_m, kRadius_m), Eigen::Matrix2d::Identity()};
          problem.targets.push_back(target);
        }
        ASSERT_NO_FATAL_FAILURE(bounds.expect_below_every_plan(problem, 1e-6));
      }
    }
  }
}

/// Returns the cost of a target that is measured isotropically with `strengths` at the end of each
/// step.
double cost_of(const SearchProblem& problem, const SearchTarget& target,
               const std::vector<double>& strengths) {
  models::Gaussian belief = target.prior;
  double cost = 0.0;
  for (const double strength : strengths) {
    belief = models::predict(belief, target.model, problem.step_s);
    belief.covariance = models::update_covariance(
        belief.covariance, models::PositionMatrix(strength * Eigen::Matrix2d::Identity()));
    cost += problem.cost == CostKind::kLogDet ? models::log_det(belief.covariance)
                                              : belief.covariance.trace();
  }
  return cost;
}

// A robot on rails drives 1.1 m per step among distant targets. It can be near one target at one
// step at most. All other measurements are from the nearest position that is reachable by then, or
// from the edge of the disc. The bound uses the best of three disc sizes. Beliefs are isotropic, so
// the bound has a closed form.
TEST(NearBound, CountsOneNearMeasurementAndTheRestFromADistance) {
  std::mt19937_64 rng(72);
  BeliefTable beliefs(8, 8);
  InformationHeuristic heuristic(8, 8);
  NearBound near(8, 8);
  const models::SensorKind kinds[] = {models::SensorKind::kPosition, models::SensorKind::kRange,
                                      models::SensorKind::kBearing,
                                      models::SensorKind::kRangeBearing};
  int beside = 0;
  int never = 0;
  for (int trial = 0; trial < 80; ++trial) {
    SCOPED_TRACE(trial);
    SearchProblem problem;
    problem.horizon_steps = pick(rng, 1, 4);
    problem.step_s = 0.5;
    problem.cost = trial % 2 == 0 ? CostKind::kLogDet : CostKind::kTrace;
    constexpr double kStep_m = 1.1;  // m; larger than any disc
    problem.controls = {{kStep_m / problem.step_s, 0.0}};
    problem.start = {uniform(rng, -9.0, 9.0), uniform(rng, -9.0, 9.0), uniform(rng, -kPi, kPi)};
    models::SensorModel sensor;
    sensor.kind = kinds[pick(rng, 0, 3)];
    sensor.range_max_m = uniform(rng, 2.0, 9.0);
    sensor.range_min_m = 0.03;
    sensor.variance_grows_with_range = pick(rng, 0, 1) == 0;
    sensor.variance_floor = 0.01;
    problem.sensors = {sensor};
    const int count = pick(rng, 1, 3);
    for (int m = 0; m < count; ++m) {
      // Targets around the start, far apart from each other.
      const double away_m = uniform(rng, 0.5, 8.0) + (m == 0 ? 0.0 : 12.0);
      const double bearing_rad = problem.start.yaw_rad + 2.5 * m + uniform(rng, -0.3, 0.3);
      SearchTarget target{{models::TargetKind::kDoubleIntegrator, 2, 0.02}, {}};
      if (pick(rng, 0, 1) == 0) {
        target.model.kind = models::TargetKind::kRandomWalk;
      }
      const int n = target.model.dim();
      target.prior.mean = models::StateVector::Zero(n);
      target.prior.mean.head<2>() =
          problem.start.position_m() +
          away_m * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad));
      target.prior.covariance = uniform(rng, 0.1, 2.0) * models::StateMatrix::Identity(n, n);
      problem.targets.push_back(target);
    }
    std::shuffle(problem.targets.begin(), problem.targets.end(), rng);
    double expected = -std::numeric_limits<double>::infinity();
    bool is_beside = false;
    for (const double radius_m : {0.5, 0.2, 0.1}) {
      double from_afar = 0.0;
      double saved = 0.0;
      for (const SearchTarget& target : problem.targets) {
        const double away_m = (target.prior.mean.head<2>() - problem.start.position_m()).norm();
        const auto strength_from = [&](double r_m) {
          // The target is visible from the minimum range on.
          const double from_m = std::max(r_m, sensor.range_min_m);
          const models::PositionVector origin = Eigen::Vector2d::Zero();
          return 0.5 * models::information(sensor, {{-from_m, 0.0, 0.0}, problem.height_m}, origin)
                           .trace();
        };
        std::vector<double> afar;
        for (int k = 1; k <= problem.horizon_steps; ++k) {
          afar.push_back(strength_from(std::max(radius_m, away_m - kStep_m * k)));
        }
        const double base = cost_of(problem, target, afar);
        from_afar += base;
        for (int k = 1; k <= problem.horizon_steps; ++k) {
          if (away_m - kStep_m * k < radius_m) {
            std::vector<double> with_one = afar;
            with_one[index(k - 1)] = strength_from(std::max(0.0, away_m - kStep_m * k));
            saved = std::max(saved, base - cost_of(problem, target, with_one));
          }
        }
      }
      is_beside = is_beside || saved > 0.0;
      expected = std::max(expected, from_afar - saved);
    }
    beliefs.reset(problem);
    heuristic.reset(problem, beliefs);
    near.reset(problem, beliefs, heuristic);
    ASSERT_FALSE(near.is_empty());
    std::int64_t work_nodes = 0;
    const auto answer = near.cost(Deadline::never(), work_nodes);
    EXPECT_FALSE(answer.expired);
    EXPECT_NEAR(answer.cost, expected, 1e-3 * std::max(1.0, std::abs(expected)))
        << sensor.kind.name();
    (is_beside ? beside : never) += 1;
  }
  EXPECT_GT(beside, 10);
  EXPECT_GT(never, 15);
}

/// A target that the robot passes over in its first step, and the bound for its controls
/// afterwards.
class ReturnToTarget : public ::testing::Test {
 protected:
  ReturnToTarget() {
    problem_.horizon_steps = 4;
    problem_.step_s = 1.0;
    models::SensorModel sensor;
    sensor.kind = models::SensorKind::kBearing;
    sensor.range_min_m = 1e-3;
    sensor.range_max_m = 20.0;
    problem_.sensors = {sensor};
    problem_.targets = {spread(1.0, 0.0)};
  }
  static SearchTarget spread(double x_m, double y_m) {
    return {{models::TargetKind::kRandomWalk, 2, 0.5},
            {Eigen::Vector2d(x_m, y_m), Eigen::Matrix2d::Identity()}};
  }
  double bound_with(const std::vector<models::UnicycleControl>& controls) {
    problem_.controls = controls;
    reset();
    std::int64_t work_nodes = 0;
    return near_.cost(Deadline::never(), work_nodes).cost;
  }
  void reset() {
    beliefs_.reset(problem_);
    heuristic_.reset(problem_, beliefs_);
    near_.reset(problem_, beliefs_, heuristic_);
  }
  SearchProblem problem_;
  BeliefTable beliefs_{8, 32};
  InformationHeuristic heuristic_{8, 32};
  NearBound near_{8, 32};
};

// A robot leaves a target. The bound counts a return after one, two or three steps only if the
// controls allow it: by hovering, by driving 1 m away and back, or around a triangle.
TEST_F(ReturnToTarget, IsCountedOnlyIfControlsLeadBack) {
  const double never = bound_with({{1.0, 0.0}});
  const double after_two = bound_with({{1.0, 0.0}, {1.0, kPi}});
  const double third_rad = 2.0 * kPi / 3.0;
  // Three arcs with chords of 1 m form a full circle.
  const double chord = 0.5 * third_rad / std::sin(0.5 * third_rad);
  problem_.targets = {spread(0.5, std::sqrt(0.75))};
  const double after_three = bound_with({{chord, third_rad}});
  problem_.targets = {spread(1.0, 0.0)};
  const double always = bound_with({{1.0, 0.0}, {0.0, 0.0}});
  constexpr double kOneLook = 3.0;  // nats; minimum gain of one near measurement
  EXPECT_GT(never, after_three + kOneLook);
  EXPECT_GT(after_three, always + kOneLook);
  EXPECT_GT(never, after_two + kOneLook);
  EXPECT_GT(after_two, always + kOneLook);
}

// With more than a dozen controls, three-step returns are not computed. The bound then allows a
// return to any position.
TEST_F(ReturnToTarget, IsAlwaysAllowedWithMoreThanTwelveControls) {
  std::vector<models::UnicycleControl> controls(12, {1.0, 0.0});
  const double few = bound_with(controls);
  EXPECT_EQ(bound_with({{1.0, 0.0}}), few);
  controls.push_back({1.0, 0.0});
  EXPECT_LT(bound_with(controls), few - 3.0);
}

// The bound applies only to planar targets that move or have noise, over at most 30 steps.
TEST_F(ReturnToTarget, IsBoundedForMovingAndNoisyTargetsOnly) {
  problem_.targets = {spread(1.0, 0.0), spread(2.0, 0.0), spread(3.0, 0.0), spread(4.0, 0.0)};
  problem_.targets[0].model.kind = models::TargetKind::kStatic;
  problem_.targets[1].model.q = 0.0;
  problem_.targets[2].model.position_dim = 3;
  problem_.targets[2].prior = {Eigen::Vector3d(3.0, 0.0, 0.0), Eigen::Matrix3d::Identity()};
  problem_.controls = {{1.0, 0.0}};
  reset();
  EXPECT_EQ(near_.takes_part(), (std::vector<std::uint8_t>{0, 0, 0, 1}));
  problem_.horizon_steps = 30;
  reset();
  EXPECT_FALSE(near_.is_empty());
  problem_.horizon_steps = 31;
  reset();
  EXPECT_TRUE(near_.is_empty());
  EXPECT_EQ(near_.takes_part(), (std::vector<std::uint8_t>(4, 0)));
  problem_.horizon_steps = 4;
  problem_.fixed_information.assign(
      4, std::vector<models::StateMatrix>(4, Eigen::Matrix2d::Identity()));
  problem_.fixed_information[2].assign(4, Eigen::Matrix3d::Identity());
  reset();
  EXPECT_TRUE(near_.is_empty()) << "teammates observe all targets";
}

// If a step leads from one target to the other, the robot may be near both; otherwise near one of
// them only.
TEST_F(ReturnToTarget, MayPassASecondTargetOnlyIfAStepLeadsThere) {
  const auto bound_of = [&](double apart_m) {
    problem_.targets = {spread(1.0, 0.0), spread(1.0 + apart_m, 0.0)};
    return bound_with({{1.0, 0.0}});
  };
  const double both = bound_of(1.0);
  for (const double apart_m : {0.6, 1.3, 1.6}) {
    EXPECT_GT(bound_of(apart_m), both + 1.0) << apart_m;
  }
}

}  // namespace
}  // namespace vantage::planner
