#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/index.hpp"
#include "core/infinity.hpp"
#include "planner/search/lattice_bound.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/lattice_problem.hpp"

// Tests the lattice's best path and bound in limit cases: without measurements, and with a single
// path.

namespace vantage::planner {
namespace {

using test::pick;
using test::uniform;

constexpr std::size_t kStates = 400'000;
const models::SensorKind kKinds[] = {models::SensorKind::kRangeBearing,
                                     models::SensorKind::kBearing, models::SensorKind::kRange,
                                     models::SensorKind::kPosition};

/// Returns a moving target with equal variances along both axes.
SearchTarget drifting(const Eigen::Vector2d& at_m, const Eigen::Vector2d& velocity_mps) {
  SearchTarget target{{models::TargetKind::kDoubleIntegrator, 2, 0.01}, {}};
  target.prior.mean = models::StateVector::Zero(4);
  target.prior.mean << at_m, velocity_mps;
  target.prior.covariance = Eigen::Vector4d(1.0, 1.0, 0.1, 0.1).asDiagonal();
  return target;
}

/// Returns a robot with all kinds of controls among targets with isotropic beliefs.
SearchProblem all_alike(std::mt19937_64& rng) {
  SearchProblem problem;
  problem.start = {uniform(rng, -2.0, 2.0), uniform(rng, -2.0, 2.0), uniform(rng, -kPi, kPi)};
  problem.horizon_steps = pick(rng, 2, 5);
  const double turn_radps = uniform(rng, 0.5, 3.0);
  const double speed_mps = uniform(rng, 0.5, 3.0);
  problem.controls = {{speed_mps, 0.0}, {speed_mps, turn_radps}, {0.5 * speed_mps, -turn_radps}};
  for (int i = pick(rng, 1, 2); i > 0; --i) {
    models::SensorModel sensor;
    sensor.kind = kKinds[pick(rng, 0, 3)];
    sensor.range_max_m = uniform(rng, 2.0, 6.0);
    sensor.range_min_m = 0.3;  // m; no target is that near to the robot
    sensor.variance_grows_with_range = pick(rng, 0, 1) == 0;
    sensor.fov_rad = pick(rng, 0, 2) == 0 ? 2.0 * kPi : radians(uniform(rng, 30.0, 330.0));
    problem.sensors.push_back(sensor);
  }
  for (int m = pick(rng, 1, 4); m > 0; --m) {
    problem.targets.push_back(drifting({uniform(rng, -5.0, 5.0), uniform(rng, -5.0, 5.0)},
                                       {uniform(rng, -0.4, 0.4), uniform(rng, -0.4, 0.4)}));
  }
  return problem;
}

// If the reference has far more information than any measurement, every measurement has its full
// gain. With isotropic beliefs the gathered gain of the best path equals the gain of its
// measurements, for any cell width. Other paths gather less.
TEST(LatticeBound, BestPathInformationEqualsItsGain) {
  LatticeBound lattice(8, 8, kStates);
  BeliefTable beliefs(8, 8);
  LinearisedCost cost(8, 8);
  int gathered = 0;
  std::mt19937_64 rng(91);
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    const SearchProblem problem = all_alike(rng);
    beliefs.reset(problem);
    lattice.reset(problem, beliefs);
    ASSERT_FALSE(lattice.is_empty());
    cost.reset(problem, beliefs, InformationMeasure::kLogDet);
    const int depth = pick(rng, 0, 1);
    cost.clear_reached();
    lattice.mark_reached(problem.start, depth, cost);
    std::vector<float> reference(lattice.reference_size(), 0.0F);
    for (std::size_t i = 0; i < reference.size(); i += 3) {
      reference[i] = reference[i + 2] = 1e7F;
    }
    for (int m = 0; m < beliefs.target_count(); ++m) {
      cost.linearise(m, depth, beliefs.open_loop(m, depth), reference.data());
    }
    constexpr float kBefore = 3.0F;  // the path's information is added to this value
    std::vector<float> looked(reference.size(), kBefore);
    std::int64_t work_nodes = 0;
    const std::size_t states = pick(rng, 0, 1) == 0 ? kStates : 20'000;
    const auto path = lattice.best_path(problem.start, depth, cost, looked.data(), states,
                                        Deadline::never(), work_nodes);
    ASSERT_FALSE(path.expired);
    double seen = 0.0;
    double before = 0.0;
    for (int m = 0; m < beliefs.target_count(); ++m) {
      for (int k = depth + 1; k <= problem.horizon_steps; ++k) {
        if (cost.is_reached(m, k)) {
          const LinearisedCost::Gradient& g = cost.gradient(m, k);
          const Eigen::Vector3d M =
              Eigen::Vector3f(looked.data() + 3 * cost.at(m, k)).cast<double>();
          const Eigen::Vector3d G(g.xx, 2.0 * g.xy, g.yy);
          seen += G.dot(M);
          before += double{kBefore} * G.sum();
        }
      }
    }
    EXPECT_NEAR(seen - before, path.gained, 1e-4 * path.gained + 1e-5 * before);
    gathered += path.gained > 100.0 * before * 1e-5 ? 1 : 0;
    // Without the output of the measurements, the gathered gain is the same.
    const auto again = lattice.best_path(problem.start, depth, cost, nullptr, states,
                                         Deadline::never(), work_nodes);
    EXPECT_EQ(again.gained, path.gained);
  }
  EXPECT_GT(gathered, 30);
}

double open_loop_cost(const BeliefTable& beliefs, int horizon_steps) {
  double cost = 0.0;
  for (int k = 1; k <= horizon_steps; ++k) {
    cost += beliefs.open_loop_cost(k);
  }
  return cost;
}

/// The highest bound after several rounds, in each of which the reference is moved towards the
/// measurements of the best path.
class BestBound {
 public:
  double of(const SearchProblem& problem, int rounds) {
    beliefs.reset(problem);
    lattice_.reset(problem, beliefs);
    EXPECT_FALSE(lattice_.is_empty());
    std::vector<float> reference(lattice_.reference_size());
    lattice_.begin(reference.data());
    double highest = -kInfinity;
    for (int i = 0; i < rounds; ++i) {
      std::int64_t work_nodes = 0;
      const auto answer = lattice_.cost_to_go(problem.start, 0, {}, reference.data(), 2.0 / (2 + i),
                                              kStates, Deadline::never(), work_nodes);
      EXPECT_FALSE(answer.expired);
      highest = std::max(highest, answer.cost);
    }
    return highest;
  }

  BeliefTable beliefs{8, 8};

 private:
  LatticeBound lattice_{8, 8, kStates};
};

// If no step can see anything, the bound is the cost without measurements. The target is too near,
// too far in every reachable direction, or outside the field of view. With slightly wider limits
// the target is visible.
TEST(LatticeBound, EqualsOpenLoopCostWhenNothingIsSeen) {
  BestBound bound;
  for (const models::SensorKind kind : kKinds) {
    for (const double yaw_rad : {0.0, 0.5 * kPi, kPi, -0.5 * kPi, 0.8}) {
      SCOPED_TRACE(testing::Message() << kind.name() << ' ' << yaw_rad);
      SearchProblem problem;
      problem.start = {5.0, -3.0, yaw_rad};
      problem.horizon_steps = 3;
      problem.controls = {{1.0, 0.0}};  // 0.5 m per step
      models::SensorModel sensor;
      sensor.kind = kind;
      const auto sees = [&](double ahead_m, double left_m, double range_min_m, double range_max_m,
                            double fov_rad) {
        sensor.range_min_m = range_min_m;
        sensor.range_max_m = range_max_m;
        sensor.fov_rad = fov_rad;
        problem.sensors = {sensor};
        const Pose2 there = problem.start * Pose2{ahead_m, left_m, 0.0};
        SearchTarget target{{models::TargetKind::kStatic, 2, 0.0}, {}};
        target.prior = {there.position_m(), Eigen::Matrix2d::Identity()};
        problem.targets = {target};
        const double highest = bound.of(problem, 4);
        const double cost = open_loop_cost(bound.beliefs, problem.horizon_steps);
        EXPECT_LE(highest, cost + 1e-9);
        return highest < cost - 1e-3;
      };
      const double all_round_rad = 2.0 * kPi;
      for (const double side : {1.0, -1.0}) {
        // The robot's positions are at 0.5, 1 and 1.5 m; cells have 1/24 of a step.
        const double nearest_m = 2.0;  // m; from the position after the second step
        EXPECT_TRUE(sees(1.0, side * nearest_m, 0.3, nearest_m + 0.1, all_round_rad));
        EXPECT_FALSE(sees(1.0, side * nearest_m, 0.3, nearest_m - 0.1, all_round_rad));
        const double farthest_m = std::hypot(0.5, nearest_m);  // after steps 1 and 3
        EXPECT_TRUE(sees(1.0, side * nearest_m, farthest_m - 0.1, 9.0, all_round_rad));
        EXPECT_FALSE(sees(1.0, side * nearest_m, farthest_m + 0.1, 9.0, all_round_rad));
        // The target's bearing is 45° after step 1 and larger after the next steps.
        const double first_rad = 0.25 * kPi;  // rad; bearing after step 1
        EXPECT_TRUE(sees(2.5, side * 2.0, 0.3, 2.9, 2.0 * first_rad + 0.2));
        EXPECT_FALSE(sees(2.5, side * 2.0, 0.3, 2.9, 2.0 * std::atan2(2.0, 2.0) - 0.2));
        // The target is behind the robot from step 1 on.
        EXPECT_FALSE(sees(0.2, side * 0.4, 0.1, 9.0, kPi));
        EXPECT_TRUE(sees(0.2, side * 0.4, 0.1, 9.0, 2.0 * kPi - 0.4));
      }
      EXPECT_FALSE(sees(-0.6, 0.0, 0.1, 1.0, all_round_rad)) << "behind the start";
      EXPECT_TRUE(sees(-0.4, 0.0, 0.1, 1.0, all_round_rad));
      EXPECT_TRUE(sees(2.4, 0.0, 0.1, 1.0, all_round_rad));
      EXPECT_FALSE(sees(2.6, 0.0, 0.1, 1.0, all_round_rad)) << "beyond the reachable positions";
    }
  }
}

// A robot on rails has only one plan. The bound is below its cost by at most the effect of a cell's
// width.
TEST(LatticeBound, IsTightForASinglePath) {
  BestBound bound;
  std::mt19937_64 rng(92);
  int compared = 0;
  for (int trial = 0; compared < 60 && trial < 1'000; ++trial) {
    SCOPED_TRACE(trial);
    SearchProblem problem;
    problem.start = {uniform(rng, -3.0, 3.0), uniform(rng, -3.0, 3.0), uniform(rng, -kPi, kPi)};
    problem.horizon_steps = pick(rng, 1, 4);
    const double speed_mps = uniform(rng, 0.2, 0.6);
    const int side = pick(rng, -1, 1);
    problem.controls = {{speed_mps, side * uniform(rng, 0.2, 1.0)}};
    models::SensorModel sensor;
    sensor.kind = kKinds[pick(rng, 0, 3)];
    sensor.range_max_m = 5.0;
    sensor.range_min_m = 0.05;
    sensor.variance_grows_with_range = pick(rng, 0, 1) == 0;
    sensor.variance_floor = uniform(rng, 0.05, 0.5);
    sensor.fov_rad = pick(rng, 0, 1) == 0 ? 2.0 * kPi : uniform(rng, 2.0, 5.0);
    problem.sensors = {sensor};
    for (int m = pick(rng, 1, 2); m > 0; --m) {
      const Eigen::Vector2d off_m = test::random_point(rng, -4.0, 4.0);
      problem.targets.push_back(drifting(problem.start.position_m() + off_m,
                                         {uniform(rng, -0.1, 0.1), uniform(rng, -0.1, 0.1)}));
      problem.targets.back().prior.covariance =
          test::random_spd(rng, 4, uniform(rng, 0.1, 2.0), 1.0);
    }
    std::vector<Pose2> way;
    bool is_plain = true;  // far from range and view limits and from targets
    for (int k = 1; k <= problem.horizon_steps; ++k) {
      way.push_back(models::step_unicycle(way.empty() ? problem.start : way.back(),
                                          problem.controls[0], problem.step_s));
      for (const SearchTarget& target : problem.targets) {
        const Eigen::Vector2d to_m = target.prior.mean.head<2>() +
                                     k * problem.step_s * target.prior.mean.tail<2>() -
                                     way.back().position_m();
        const double off_rad =
            std::abs(wrap_to_pi(std::atan2(to_m.y(), to_m.x()) - way.back().yaw_rad));
        is_plain = is_plain && to_m.norm() > 1.0 && std::abs(to_m.norm() - 5.0) > 0.3 &&
                   (sensor.fov_rad > 6.0 || std::abs(off_rad - 0.5 * sensor.fov_rad) > 0.3);
      }
    }
    if (!is_plain) {
      continue;
    }
    ++compared;
    const double cost = score(problem, way);
    const double highest = bound.of(problem, 24);
    EXPECT_LE(highest, cost + 1e-9 * std::max(1.0, std::abs(cost)));
    const double gained = open_loop_cost(bound.beliefs, problem.horizon_steps) - cost;
    EXPECT_GE(highest, cost - 0.05 * gained - 0.01);
  }
  EXPECT_EQ(compared, 60);
}

// The bound is the cost at the reference, minus the gathered gain of the best path, minus the
// rounding error of the float sums.
TEST(LatticeBound, IncludesFloatRounding) {
  LatticeBound lattice(8, 8, kStates);
  BeliefTable beliefs(8, 8);
  LinearisedCost linear(8, 8);
  std::mt19937_64 rng(93);
  for (int trial = 0; trial < 20; ++trial) {
    const SearchProblem problem = all_alike(rng);
    beliefs.reset(problem);
    lattice.reset(problem, beliefs);
    std::vector<float> reference(lattice.reference_size());
    lattice.begin(reference.data());
    linear.reset(problem, beliefs, InformationMeasure::kLogDet);
    linear.clear_reached();
    lattice.mark_reached(problem.start, 0, linear);
    double base = 0.0;
    for (int m = 0; m < beliefs.target_count(); ++m) {
      base += linear.linearise(m, 0, beliefs.open_loop(m, 0), reference.data());
    }
    std::int64_t work_nodes = 0;
    const double gained =
        lattice.best_path(problem.start, 0, linear, nullptr, 20'000, Deadline::never(), work_nodes)
            .gained;
    const double cost = lattice
                            .cost_to_go(problem.start, 0, {}, reference.data(), 0.0, 20'000,
                                        Deadline::never(), work_nodes)
                            .cost;
    EXPECT_LE(cost, base - gained - 0.9e-5 * (1.0 + gained)) << trial;
    EXPECT_GE(cost, base - gained - 1.1e-5 * (1.0 + gained)) << trial;
  }
}

// The bound uses the best position of a cell. No position of the cell may have more information,
// even if the target is only about a cell away.
TEST(LatticeBound, IsValidForMeasurementsFromAnywhereInACell) {
  LatticeBound lattice(2, 2, kStates);
  BeliefTable beliefs(2, 2);
  std::mt19937_64 rng(94);
  constexpr double kLong_m = 1.0;
  const double cell_m = kLong_m / ReachLattice::kCellsPerStep[0];
  for (int trial = 0; trial < 600; ++trial) {
    SearchProblem problem;
    problem.horizon_steps = 1;
    problem.step_s = 0.5;
    const double way_m = 0.5 + cell_m * uniform(rng, -0.5, 0.5);
    problem.controls = {{kLong_m / problem.step_s, 0.0},
                        {way_m / problem.step_s, uniform(rng, -0.15, 0.15)}};
    models::SensorModel sensor;
    sensor.kind = kKinds[pick(rng, 0, 2)];
    sensor.range_min_m = 0.02;
    sensor.range_max_m = 0.3;  // m; nothing is visible from the end of the long path
    sensor.range_sigma_m = uniform(rng, 0.01, 0.3);
    problem.sensors = {sensor};
    std::vector<Pose2> ends;
    for (const models::UnicycleControl& control : problem.controls) {
      ends.push_back(models::step_unicycle(problem.start, control, problem.step_s));
    }
    const double bearing_rad = uniform(rng, -kPi, kPi);
    const double away_m = cell_m * uniform(rng, 1.0, 5.0);
    SearchTarget target{{models::TargetKind::kStatic, 2, 0.0}, {}};
    target.prior.mean = ends[1].position_m() +
                        away_m * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad));
    target.prior.covariance = test::random_spd(rng, 2, 4.0, 3.0);
    problem.targets = {target};
    beliefs.reset(problem);
    lattice.reset(problem, beliefs);
    ASSERT_FALSE(lattice.is_empty());
    const double best = std::min(score(problem, {ends[0]}), score(problem, {ends[1]}));
    std::vector<float> reference(lattice.reference_size());
    lattice.begin(reference.data());
    for (int i = 0; i < 8; ++i) {
      std::int64_t work_nodes = 0;
      const auto answer = lattice.cost_to_go(problem.start, 0, {}, reference.data(), 2.0 / (2 + i),
                                             kStates, Deadline::never(), work_nodes);
      ASSERT_LE(answer.cost, best + 1e-6) << trial << ' ' << i << ' ' << sensor.kind.name();
    }
  }
}

// A lattice with exact capacity for steps and targets has the finest possible cells. Its results
// equal those of one with more capacity.
TEST(LatticeBound, HasCapacityForItsFinestLattice) {
  for (const int steps : {1, 2, 3}) {
    SearchProblem problem;
    problem.horizon_steps = steps;
    // With these controls the robot reaches about the same distance in all directions.
    problem.controls = {{3.0, 0.0}, {0.0, kPi}, {0.0, -kPi}, {0.0, 2.0 * kPi}, {0.0, 0.0}};
    models::SensorModel sensor;
    sensor.range_max_m = 9.0;
    sensor.fov_rad = 2.0 * kPi;
    problem.sensors = {sensor};
    for (const double side : {1.0, -1.0}) {
      problem.targets.push_back(drifting({side * 2.0, side * 1.0}, {0.1, side * 0.2}));
    }
    BeliefTable beliefs(2, steps);
    beliefs.reset(problem);
    const auto bounds_of = [&](LatticeBound& lattice) {
      lattice.reset(problem, beliefs);
      std::vector<float> reference(lattice.reference_size());
      lattice.begin(reference.data());
      std::vector<double> bounds;
      for (int i = 0; i < 3; ++i) {
        std::int64_t work_nodes = 0;
        bounds.push_back(lattice
                             .cost_to_go(problem.start, 0, {}, reference.data(), 0.4, kStates,
                                         Deadline::never(), work_nodes)
                             .cost);
      }
      return bounds;
    };
    LatticeBound exact(2, steps, kStates);
    LatticeBound roomy(8, 12, kStates);
    const std::vector<double> expected = bounds_of(roomy);
    EXPECT_GT(expected.back(), -kInfinity);
    EXPECT_EQ(bounds_of(exact), expected) << steps;
  }
}

// A search that is cut off reports this, with or without the output of its path. With one more node
// it reaches its end.
TEST(LatticeBound, ReportsCutOff) {
  LatticeBound lattice(8, 8, 20'000);
  BeliefTable beliefs(8, 8);
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const test::OwnedProblem owned = test::lattice_problem(seed);
    beliefs.reset(owned.problem);
    lattice.reset(owned.problem, beliefs);
    std::vector<float> reference(lattice.reference_size());
    lattice.begin(reference.data());
    for (const double share : {0.0, 0.4}) {
      const auto ask = [&](const Deadline& deadline, std::int64_t& work_nodes) {
        std::vector<float> own = reference;
        return lattice.cost_to_go(owned.problem.start, 0, {}, own.data(), share, 20'000, deadline,
                                  work_nodes);
      };
      std::int64_t all_nodes = 0;
      const double cost = ask(Deadline::never(), all_nodes).cost;
      for (int part = 0; part <= 12; ++part) {
        std::int64_t work_nodes = 0;
        const auto cut = ask(Deadline::nodes((all_nodes - 1) * part / 12), work_nodes);
        EXPECT_TRUE(cut.expired) << seed << ' ' << share << ' ' << part;
        // A bound exists only after all gains are gathered.
        EXPECT_TRUE(cut.cost == -kInfinity || cut.cost == cost) << seed << ' ' << part;
      }
      std::int64_t work_nodes = 0;
      EXPECT_FALSE(ask(Deadline::nodes(all_nodes + 1), work_nodes).expired);
      EXPECT_EQ(work_nodes, all_nodes);
    }
  }
}

}  // namespace
}  // namespace vantage::planner
