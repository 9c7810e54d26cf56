#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "planner/search/catalogue.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/solved_problems.hpp"

// In free space, search results do not depend on left or right, on north or east, or on the order
// of targets. A problem that is mirrored or turned, or has its targets reordered, has a plan of the
// same cost and the same bound. (The lawn mower is an exception: its rows are aligned with the
// world.)

namespace vantage::planner {
namespace {

using test::pick;
using test::uniform;

// Returns a problem without isotropic priors, so that no two measurements have the same gain and no
// choice depends on the last bit. The problem is small enough for each search to finish.
SearchProblem problem_in_free_space(std::uint64_t seed) {
  std::mt19937_64 rng(0xA24BAED4963EE407U * (seed + 1));
  SearchProblem problem;
  problem.seed = seed;
  problem.start = {uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0), uniform(rng, -kPi, kPi)};
  problem.horizon_steps = pick(rng, 2, 4);
  problem.controls = models::standard_primitives();
  std::shuffle(problem.controls.begin(), problem.controls.end(), rng);
  problem.controls.resize(5);
  problem.cost = pick(rng, 0, 1) == 0 ? CostKind::kTrace : CostKind::kLogDet;
  models::SensorModel sensor;
  const models::SensorKind kKinds[] = {models::SensorKind::kRange, models::SensorKind::kBearing,
                                       models::SensorKind::kRangeBearing};
  sensor.kind = kKinds[pick(rng, 0, 2)];
  sensor.range_max_m = uniform(rng, 2.0, 7.0);
  sensor.range_min_m = 0.3;
  sensor.fov_rad = pick(rng, 0, 2) == 0 ? 2.0 * kPi : radians(uniform(rng, 60.0, 260.0));
  problem.sensors = {sensor};
  for (int m = pick(rng, 1, 4); m > 0; --m) {
    const models::TargetKind kTargets[] = {models::TargetKind::kStatic,
                                           models::TargetKind::kRandomWalk,
                                           models::TargetKind::kDoubleIntegrator};
    SearchTarget target;
    target.model = {kTargets[pick(rng, 0, 2)], 2, 0.0};
    target.model.q =
        target.model.kind == models::TargetKind::kStatic ? 0.0 : uniform(rng, 0.0, 0.05);
    const int n = target.model.dim();
    target.prior.mean = models::StateVector::Zero(n);
    for (int i = 0; i < n; ++i) {
      target.prior.mean(i) = i < 2 ? uniform(rng, -6.0, 6.0) : uniform(rng, -0.8, 0.8);
    }
    target.prior.covariance = test::random_spd(rng, n, uniform(rng, 0.2, 2.0), 1.0);
    problem.targets.push_back(target);
  }
  return problem;
}

/// Returns the problem mirrored in the x axis if `is_mirrored`, and then turned.
SearchProblem transformed(const SearchProblem& problem, bool is_mirrored, double turn_rad) {
  const double side = is_mirrored ? -1.0 : 1.0;
  const Eigen::Matrix2d Q =
      Eigen::Rotation2Dd(turn_rad).toRotationMatrix() * Eigen::Vector2d(1.0, side).asDiagonal();
  SearchProblem out = problem;
  const Eigen::Vector2d start_m = Q * problem.start.position_m();
  out.start = {start_m.x(), start_m.y(), wrap_to_pi(turn_rad + side * problem.start.yaw_rad)};
  for (models::UnicycleControl& control : out.controls) {
    control.yaw_rate_radps *= side;
  }
  for (SearchTarget& target : out.targets) {
    const int n = target.model.dim();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < n; i += 2) {
      all.block<2, 2>(i, i) = Q;
    }
    const Eigen::MatrixXd turned = all * target.prior.covariance * all.transpose();
    target.prior.mean = (all * target.prior.mean).eval();
    target.prior.covariance = 0.5 * (turned + turned.transpose());
  }
  return out;
}

class Equivariance : public ::testing::TestWithParam<std::string> {
 protected:
  // Compares the result for each problem with that for other_of(problem, seed).
  template <class Other>
  static void expect_alike(const Other& other_of) {
    const Algorithm& algorithm = algorithm_called(GetParam());
    AlgorithmOptions options;
    options.epsilon = 0.37;
    options.delta_m = 0.83;  // m; differs from all distances between primitive ends
    constexpr std::size_t kNodesMax = 20'000;
    SearchProblem largest = problem_in_free_space(0);
    largest.targets.resize(4);
    largest.horizon_steps = 4;
    const auto search =
        algorithm.make(capacity_for(algorithm, largest, 64U << 20U, kNodesMax), options);
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      SCOPED_TRACE(seed);
      const SearchProblem problem = problem_in_free_space(seed);
      const SearchResult plain = search->plan(problem, Deadline::never());
      const SearchResult& other = search->plan(other_of(problem, seed), Deadline::never());
      ASSERT_TRUE(plain.found && other.found);
      EXPECT_EQ(plain.stop_reason, other.stop_reason);
      EXPECT_NEAR(plain.cost, other.cost, test::slack(plain.cost));
      if (plain.lower_bound != other.lower_bound) {  // −∞ without a bound
        EXPECT_NEAR(plain.lower_bound, other.lower_bound, test::slack(plain.lower_bound));
      }
    }
  }
};

TEST_P(Equivariance, HoldsForMirroring) {
  expect_alike(
      [](const SearchProblem& problem, std::uint64_t) { return transformed(problem, true, 0.0); });
}

/// Rotation and reordering of targets change the last bits of sums.
class EquivarianceUpToRounding : public Equivariance {};

TEST_P(EquivarianceUpToRounding, HoldsForRotation) {
  expect_alike([](const SearchProblem& problem, std::uint64_t seed) {
    return transformed(problem, seed % 2 == 0, 0.1 + 0.1 * static_cast<double>(seed));
  });
}

TEST_P(EquivarianceUpToRounding, HoldsForTargetOrder) {
  expect_alike([](SearchProblem problem, std::uint64_t) {
    std::reverse(problem.targets.begin(), problem.targets.end());
    return problem;
  });
}

std::vector<std::string> all_but(const std::vector<std::string>& left_out) {
  std::vector<std::string> names;
  for (const Algorithm& algorithm : all_algorithms()) {
    if (std::find(left_out.begin(), left_out.end(), algorithm.name) == left_out.end()) {
      names.emplace_back(algorithm.name);
    }
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(Planner, Equivariance, ::testing::ValuesIn(all_but({"lawn_mower"})),
                         [](const auto& each) { return each.param; });
// Paths without measurements have equal costs up to the last bit. AEGIS keeps the first one that it
// finds, within (ε, δ), so AEGIS is excluded.
INSTANTIATE_TEST_SUITE_P(Planner, EquivarianceUpToRounding,
                         ::testing::ValuesIn(all_but({"lawn_mower", "aegis"})),
                         [](const auto& each) { return each.param; });

}  // namespace
}  // namespace vantage::planner
