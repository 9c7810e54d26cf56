#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/index.hpp"
#include "models/belief/gaussian.hpp"
#include "planner/search/sequencing_bound.hpp"
#include "test/planner/problem/random_problem.hpp"

// Compares the sequencing bound with an exhaustive solution of its relaxed problem: which target is
// observed at which step, if travel between the discs of visibility takes time.

namespace vantage::planner {
namespace {

using models::TargetKind;
using test::pick;
using test::random_spd;
using test::uniform;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSight_m = 1.0;

/// Returns a problem with an isotropic position sensor, so that all measurements have equal
/// information. Some of its static targets have process noise; some have information from
/// teammates.
SearchProblem all_round_problem(std::mt19937_64& rng) {
  SearchProblem problem;
  problem.start = {uniform(rng, -2.0, 2.0), uniform(rng, -2.0, 2.0), uniform(rng, -kPi, kPi)};
  problem.horizon_steps = pick(rng, 2, 5);
  problem.step_s = 0.5;
  const double speed_mps = uniform(rng, 0.8, 2.5);
  problem.controls = {{speed_mps, 0.0}, {speed_mps, 1.5}, {0.5 * speed_mps, -2.0}};
  problem.cost = pick(rng, 0, 1) == 0 ? CostKind::kTrace : CostKind::kLogDet;
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kPosition;
  sensor.position_sigma_m = uniform(rng, 0.2, 1.0);
  sensor.range_max_m = kSight_m;
  problem.sensors = {sensor};
  const bool spreads = pick(rng, 0, 1) == 0;
  const bool has_fixed = pick(rng, 0, 3) == 0;
  for (int m = pick(rng, 1, problem.horizon_steps < 4 ? 4 : 3); m > 0; --m) {
    SearchTarget target{{TargetKind::kStatic, 2, 0.0}, {}};
    if (spreads) {
      target.model = {TargetKind::kRandomWalk, 2, uniform(rng, 0.0, 0.2)};
    }
    target.prior.mean = Eigen::Vector2d(uniform(rng, -4.0, 4.0), uniform(rng, -4.0, 4.0));
    target.prior.covariance = random_spd(rng, 2, uniform(rng, 0.2, 2.0), 1.0);
    problem.targets.push_back(target);
    if (has_fixed) {
      problem.fixed_information.emplace_back(index(problem.horizon_steps));
      problem.fixed_information.back()[index(pick(rng, 0, problem.horizon_steps - 1))] =
          random_spd(rng, 2, 5.0, 1.0);
    }
  }
  return problem;
}

/// The relaxed problem after `depth` from pose `at`, with the included targets.
class Relaxed {
 public:
  Relaxed(const SearchProblem& problem, const std::vector<std::uint8_t>& takes_part,
          const Pose2& at, int depth, const std::vector<Eigen::Matrix2d>& covariances)
      : problem_(problem), at_(at), depth_(depth), left_(problem.horizon_steps - depth) {
    for (const models::UnicycleControl& control : problem.controls) {
      step_m_ =
          std::max(step_m_, models::step_unicycle({}, control, problem.step_s).position_m().norm());
    }
    for (std::size_t m = 0; m < takes_part.size(); ++m) {
      if (takes_part[m] != 0) {
        targets_.push_back(static_cast<int>(m));
        fill_costs(static_cast<int>(m), covariances[m]);
      }
    }
  }

  /// Returns the least cost with `control` as the next control.
  [[nodiscard]] double best_after(const models::UnicycleControl& control) const {
    const Eigen::Vector2d end_m = models::step_unicycle(at_, control, problem_.step_s).position_m();
    std::vector<int> next;
    for (const int m : targets_) {
      const double way_m = (mean_m(m) - end_m).norm() - kSight_m;
      next.push_back(way_m < 0.0 ? 1 : 1 + steps_of(way_m));
    }
    return best_from(1, next, std::vector<int>(targets_.size(), 0));
  }

 private:
  [[nodiscard]] Eigen::Vector2d mean_m(int m) const {
    return problem_.targets[index(m)].prior.mean.head<2>();
  }
  [[nodiscard]] int steps_of(double way_m) const {
    return std::max(1, static_cast<int>(std::ceil(way_m / step_m_ - 1e-7)));
  }
  [[nodiscard]] double between_m(std::size_t i, std::size_t j) const {
    return (mean_m(targets_[i]) - mean_m(targets_[j])).norm() - 2.0 * kSight_m;
  }
  void fill_costs(int m, const Eigen::Matrix2d& covariance) {
    costs_.emplace_back(index(left_ + 1), std::vector<double>(index(left_ + 1), 0.0));
    const double strength = 1.0 / std::pow(problem_.sensors[0].position_sigma_m, 2);
    for (int k = 1; k <= left_; ++k) {
      for (int n = 0; n <= k; ++n) {
        models::Gaussian belief{mean_m(m), covariance};
        for (int step = 1; step <= k; ++step) {
          belief = models::predict(belief, problem_.targets[index(m)].model, problem_.step_s);
          if (!problem_.fixed_information.empty()) {
            const auto& fixed = problem_.fixed_information[index(m)][index(depth_ + step - 1)];
            if (fixed.size() > 0) {
              belief.covariance = models::update_covariance(belief.covariance, fixed);
            }
          }
          if (step > k - n) {
            belief.covariance = models::update_covariance(
                belief.covariance, models::PositionMatrix(strength * Eigen::Matrix2d::Identity()));
          }
        }
        costs_.back()[index(k)][index(n)] = problem_.cost == CostKind::kTrace
                                                ? belief.covariance.trace()
                                                : models::log_det(belief.covariance);
      }
    }
  }
  [[nodiscard]] double best_from(int k, const std::vector<int>& next,
                                 const std::vector<int>& looks) const {
    if (k > left_) {
      return 0.0;
    }
    double best = kInfinity;
    for (unsigned seen = 0; seen < 1U << targets_.size(); ++seen) {
      bool can_be = true;
      double cost = 0.0;
      std::vector<int> then = next;
      std::vector<int> counts = looks;
      for (std::size_t i = 0; i < targets_.size(); ++i) {
        const bool is_seen = (seen >> i & 1U) != 0;
        can_be = can_be && (!is_seen || next[i] <= k);
        counts[i] += is_seen ? 1 : 0;
        cost += costs_[i][index(k)][index(counts[i])];
        for (std::size_t j = 0; is_seen && j < targets_.size(); ++j) {
          can_be = can_be && ((seen >> j & 1U) == 0 || i == j || between_m(i, j) < 0.0);
          then[j] = std::max(then[j], k + (i == j ? 1 : steps_of(between_m(i, j))));
        }
      }
      if (can_be) {
        best = std::min(best, cost + best_from(k + 1, then, counts));
      }
    }
    return best;
  }

  const SearchProblem& problem_;
  Pose2 at_;
  int depth_ = 0;
  int left_ = 0;
  double step_m_ = 0.0;
  std::vector<int> targets_;
  std::vector<std::vector<std::vector<double>>> costs_;  ///< indices [i][k][n]
};

double slack(double cost) { return 1e-7 * std::max(1.0, std::abs(cost)); }

TEST(SequencingBound, EqualsTheRelaxedOptimum) {
  InformationHeuristic heuristic(8, 8);
  SequencingBound sequencing(8, 8, 20'000);
  BeliefTable beliefs(8, 8);
  std::mt19937_64 rng(61);
  int with_several = 0;
  int late = 0;
  for (int trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE(trial);
    const SearchProblem problem = all_round_problem(rng);
    beliefs.reset(problem);
    heuristic.reset(problem, beliefs);
    sequencing.reset(problem, beliefs, heuristic);
    if (sequencing.is_empty()) {
      continue;
    }
    const int depth = pick(rng, 0, problem.horizon_steps - 1);
    Pose2 at = problem.start;
    at.x_m += 0.3 * depth;
    at.yaw_rad = wrap_to_pi(at.yaw_rad + depth);
    std::vector<Eigen::Matrix2d> covariances;
    std::vector<std::uint16_t> touched;
    std::vector<double> packed;
    for (int m = 0; m < beliefs.target_count(); ++m) {
      covariances.emplace_back(unpack(BlockLayout::kPlanar, beliefs.open_loop(m, depth)));
      if (pick(rng, 0, 1) == 0) {
        covariances.back() = random_spd(rng, 2, uniform(rng, 0.05, 1.0), 1.0);
        touched.push_back(static_cast<std::uint16_t>(m));
        packed.resize(packed.size() + 3);
        pack(BlockLayout::kPlanar, covariances.back(), packed.data() + packed.size() - 3);
      }
    }
    const Blocks blocks{touched, packed.data()};
    const Relaxed relaxed(problem, sequencing.takes_part(), at, depth, covariances);
    std::vector<double> after;
    for (const models::UnicycleControl& control : problem.controls) {
      after.push_back(relaxed.best_after(control));
    }
    const double best = *std::min_element(after.begin(), after.end());
    std::int64_t work_nodes = 0;
    const auto bound = [&](double cutoff) {
      return sequencing.cost_to_go(at, depth, blocks, cutoff, Deadline::never(), work_nodes);
    };
    const auto whole = bound(kInfinity);
    EXPECT_FALSE(whole.expired);
    EXPECT_NEAR(whole.cost, best, slack(best));
    for (std::size_t c = 0; c < after.size(); ++c) {
      EXPECT_GE(sequencing.cost_after(static_cast<int>(c)), whole.cost);
      EXPECT_LE(sequencing.cost_after(static_cast<int>(c)), after[c] + slack(after[c]));
    }
    // With a higher cutoff the bound stays the same; with a lower one it is limited to the cutoff.
    const auto above = bound(best + 1.0);
    EXPECT_NEAR(above.cost, best, slack(best));
    const auto below = bound(best - 0.3);
    EXPECT_NEAR(below.cost, best - 0.3, slack(best));
    with_several += covariances.size() > 1 ? 1 : 0;
    late += depth > 0 ? 1 : 0;
  }
  EXPECT_GT(with_several, 30);
  EXPECT_GT(late, 30);
}

// The sixteen nearest of many targets are included, for any order. Unreachable, moving and spatial
// targets are not included.
TEST(SequencingBound, UsesTheNearestReachableStaticTargets) {
  constexpr int kTargets = 24;
  InformationHeuristic heuristic(kTargets, 8);
  SequencingBound sequencing(kTargets, 8, 100);
  BeliefTable beliefs(kTargets, 8);
  SearchProblem problem;
  problem.start = {1.0, 2.0, 0.5};
  problem.horizon_steps = 4;
  problem.step_s = 1.0;
  problem.controls = {{0.5, 0.0}, {0.1, 1.0}};
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kPosition;
  sensor.range_max_m = kSight_m;
  problem.sensors = {sensor};
  const auto at = [&](double away_m, const models::TargetModel& model) {
    const int n = model.dim();
    SearchTarget target{model, {models::StateVector::Zero(n), Eigen::MatrixXd::Identity(n, n)}};
    target.prior.mean.head<2>() =
        problem.start.position_m() + away_m * Eigen::Vector2d(std::cos(4.0), std::sin(4.0));
    return target;
  };
  const models::TargetModel still{TargetKind::kStatic, 2, 0.0};
  // The reach is the range plus four steps, 3 m.
  problem.targets = {at(3.0 + 1e-5, still), at(1.0, {TargetKind::kDoubleIntegrator, 2, 0.0}),
                     at(1.0, {TargetKind::kStatic, 3, 0.0}), at(3.0 - 1e-5, still)};
  beliefs.reset(problem);
  heuristic.reset(problem, beliefs);
  sequencing.reset(problem, beliefs, heuristic);
  EXPECT_EQ(sequencing.takes_part(), (std::vector<std::uint8_t>{0, 0, 0, 1}));

  problem.targets.clear();
  for (int i = 0; i < kTargets; ++i) {
    problem.targets.push_back(at(0.5 + 0.1 * (7 * i % kTargets), still));
  }
  beliefs.reset(problem);
  heuristic.reset(problem, beliefs);
  sequencing.reset(problem, beliefs, heuristic);
  for (int i = 0; i < kTargets; ++i) {
    EXPECT_EQ(sequencing.takes_part()[index(i)], 7 * i % kTargets < 16 ? 1 : 0) << i;
  }
  problem.targets.clear();
  beliefs.reset(problem);
  heuristic.reset(problem, beliefs);
  sequencing.reset(problem, beliefs, heuristic);
  EXPECT_TRUE(sequencing.is_empty());
}

// A control that ends in a box or behind a wall is infeasible, so the bound uses the other controls
// only.
TEST(SequencingBound, RespectsObstaclesAndWalls) {
  InformationHeuristic heuristic(4, 8);
  SequencingBound sequencing(4, 8, 2'000);
  BeliefTable beliefs(4, 8);
  models::World world;
  world.bounds = {{-6.0, -5.0}, {6.0, 5.0}};
  world.obstacles = {{{{0.7, -0.4}, {1.3, 0.4}}, 10.0}};
  for (const Pose2& start : {Pose2{0.0, 0.0, 0.0}, Pose2{1.0, -1.0, 0.5 * kPi},
                             Pose2{5.5, 0.0, 0.0}, Pose2{0.0, -4.5, -0.5 * kPi}}) {
    SCOPED_TRACE(start.x_m);
    SearchProblem problem;
    problem.world = &world;
    problem.obstacles_block_sight = true;
    problem.start = start;
    problem.horizon_steps = 3;
    problem.step_s = 0.5;
    models::SensorModel sensor;
    sensor.kind = models::SensorKind::kPosition;
    sensor.range_max_m = kSight_m;
    problem.sensors = {sensor};
    // The targets are just ahead of a position that the robot cannot reach.
    const Pose2 there = start * Pose2{1.1, 0.9, 0.0};
    problem.targets = {
        {{TargetKind::kStatic, 2, 0.0}, {there.position_m(), Eigen::Matrix2d::Identity()}}};
    const models::UnicycleControl ahead{2.0, 0.0};
    const models::UnicycleControl back{1.0, 2.0 * kPi};
    const models::UnicycleControl aside{0.5, 1.0};
    const auto bound_of = [&](const std::vector<models::UnicycleControl>& controls) {
      problem.controls = controls;
      beliefs.reset(problem);
      heuristic.reset(problem, beliefs);
      sequencing.reset(problem, beliefs, heuristic);
      EXPECT_FALSE(sequencing.is_empty());
      std::int64_t work_nodes = 0;
      return sequencing.cost_to_go(start, 0, {}, kInfinity, Deadline::never(), work_nodes).cost;
    };
    for (const std::size_t blocked : {0U, 1U, 2U}) {
      std::vector<models::UnicycleControl> controls = {back, aside};
      controls.insert(controls.begin() + static_cast<std::ptrdiff_t>(blocked), ahead);
      bound_of(controls);
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(std::isinf(sequencing.cost_after(static_cast<int>(c))), c == blocked) << c;
      }
    }
    EXPECT_TRUE(std::isinf(bound_of({ahead})));
  }
}

}  // namespace
}  // namespace vantage::planner
