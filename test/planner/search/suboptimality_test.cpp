#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "planner/search/arvi.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/full_tree.hpp"

// Theorem 3 (1): a finished pass at (ε, δ) is within a bound of the optimum. Two forms, because
// the constants of (6.1) exist only where the information is Lipschitz in the pose.
//
// A. Substitution bound, any problem. Let V(n) be the cost of the best completion of node n. When
//    a pass prunes n, it has expanded some n' at the same depth t with J' ≤ J, d(n, n') ≤ δ and
//    Σ + εI ⪰ Σ'. Follow the optimal path; if its node n is pruned, continue from n' instead:
//    that loses at most L_t(ε, δ) = max {V(n') − V(n)} over all such pairs, once per depth. So
//      J^{ε,δ} − J* ≤ Σ_{t=1}^{T−1} max(0, L_t(ε, δ)).
//    The bound is proven. L_t is measured as the maximum over all nodes of the exhaustive tree. It
//    is +∞ if n' has no completion and n has one, hence the test of the share of finite values.
//
// B. Closed form of (6.1), problems with Lipschitz information (‖M(x) − M(x')‖ ≤ L_m ‖p − p'‖).
//    With the legend λ_t ≤ every eigenvalue of Σ at depth t, λ̄ ≥ those of every prediction into
//    depth t + s, ρ the longest chord of one step, w the yaw weight:
//      Σ' ⪯ Σ + εI ⪯ (1 + ε/λ_t) Σ.
//    The same controls from n and n' keep ‖p − p'‖ ≤ δ √(1 + (sρ/w)²) =: d_s after s steps, hence
//    M' ⪰ M − η_s I with η_s = L_m d_s, and if Σ'_{s−1} ⪯ C Σ_{s−1} with C ≥ 1, predictions keep
//    the factor (P' ⪯ C P), and with η_s λ̄ < 1
//      P'⁻¹ + M' ⪰ P'⁻¹ − η_s I + M ⪰ (1 − η_s λ̄) P'⁻¹ + M ⪰ (1 − η_s λ̄)/C · (P⁻¹ + M).
//    So Σ'_s ⪯ C_s Σ_s, C_s = (1 + ε/λ_t) Π_{k≤s} 1/(1 − η_k λ̄): the ζ_T of the thesis, and
//      V(n') − V(n) ≤ Σ_s dim · log C_s   (log det),   Σ_s (C_s − 1) tr Σ_s   (trace).
//    Proven without measurements; tr Σ_s is bounded by the open loop. Summed over t as in A.

namespace vantage::planner {
namespace {

using test::FullTree;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kYawWeight_m_per_rad = 0.3;

struct Pass {
  double epsilon;
  double delta_m;
};

// Returns Σ_t max(0, L_t(ε, δ)) of form A.
double substitution_bound(const FullTree& full, const std::vector<double>& best_through,
                          int horizon_steps, const Pass& pass) {
  const PoseMetric metric{kYawWeight_m_per_rad};
  std::vector<double> loss(static_cast<std::size_t>(horizon_steps), 0.0);
  const double delta2_m2 = pass.delta_m * pass.delta_m;
  for (NodeId kept = 1; kept < full.tree.node_count(); ++kept) {
    const Node& a = full.tree[kept];
    for (NodeId left = 1; left < full.tree.node_count(); ++left) {
      const Node& b = full.tree[left];
      if (left == kept || a.depth != b.depth || b.depth == horizon_steps || a.cost > b.cost ||
          !std::isfinite(best_through[left])) {
        continue;
      }
      // The difference of the best completions' costs from this depth on.
      const double lost = (best_through[kept] - a.cost) - (best_through[left] - b.cost);
      if (lost <= loss[b.depth] ||
          metric.squared(a.world_from_body, b.world_from_body) > delta2_m2) {
        continue;
      }
      bool related = !std::isfinite(pass.epsilon);
      if (!related) {
        related = true;
        for (int m = 0; related && m < full.expander.beliefs().target_count(); ++m) {
          const models::StateMatrix covariance = full.covariance(left, m);
          const Eigen::MatrixXd difference =
              covariance +
              pass.epsilon * models::StateMatrix::Identity(covariance.rows(), covariance.cols()) -
              full.covariance(kept, m);
          related = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(difference).eigenvalues()(0) >=
                    -1e-12 * (difference.norm() + covariance.norm());
        }
      }
      if (related) {
        loss[b.depth] = lost;
      }
    }
  }
  double bound = 0.0;
  for (const double lost : loss) {
    bound += lost;
  }
  return bound;
}

/// Returns options for passes from ε = δ = `first` on, halved `halvings` times.
ReducedOptions anytime(double first, int halvings) {
  ReducedOptions options;
  options.search = ReducedSearch::kAnytime;
  options.epsilon = first;
  options.delta_m = first;
  options.halvings = halvings;
  options.yaw_weight_m_per_rad = kYawWeight_m_per_rad;
  return options;
}

TEST(FinishedPass, StaysWithinTheSubstitutionBound) {
  ReducedValueIteration search({20'000, 800'000, 8, 8, 4});
  int passes = 0;
  int finite = 0;
  int lossy = 0;
  for (std::uint64_t seed = 0; seed < 240; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    const int horizon = owned.problem.horizon_steps;
    const FullTree full(owned.problem);
    const std::vector<double> best_through = full.best_through(horizon);
    const double optimum = best_through[0];
    if (!std::isfinite(optimum)) {
      continue;
    }
    const ReducedOptions options = anytime(2.0, 4);
    const std::vector<PassReport> history =
        search.plan(owned.problem, options, Deadline::never()).history;
    ASSERT_EQ(history.size(), 6u);
    for (const PassReport& report : history) {
      const double bound =
          substitution_bound(full, best_through, horizon, {report.epsilon, report.delta_m});
      const double gap = report.cost - optimum;
      const double slack = 1e-9 * std::max(1.0, std::abs(optimum));
      EXPECT_GE(gap, -slack) << "seed " << seed;
      EXPECT_TRUE(gap <= bound + slack) << "seed " << seed << " epsilon " << report.epsilon
                                        << ": gap " << gap << " bound " << bound;
      ++passes;
      finite += std::isfinite(bound) ? 1 : 0;
      lossy += gap > slack ? 1 : 0;
    }
  }
  EXPECT_GE(passes, 6 * 200);
  EXPECT_GE(finite, passes * 8 / 10);
  EXPECT_GE(lossy, 100);  // cases in which pruning lost something
}

double eigenvalue(const models::StateMatrix& X, bool largest) {
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(X)).eigenvalues();
  return largest ? values(values.size() - 1) : values(0);
}

// Returns the bound of form B; +∞ if some η λ̄ ≥ 1.
double lipschitz_bound(const SearchProblem& problem, const Pass& pass) {
  const models::SensorModel& sensor = problem.sensors.front();
  const int T = problem.horizon_steps;
  double chord_m = 0.0;
  for (const models::UnicycleControl& control : problem.controls) {
    chord_m =
        std::max(chord_m, models::step_unicycle({}, control, problem.step_s).position_m().norm());
  }
  const auto apart_m = [&](int s) {
    return pass.delta_m * std::hypot(1.0, s * chord_m / kYawWeight_m_per_rad);
  };
  const double k_range = 1.0 / (sensor.range_sigma_m * sensor.range_sigma_m);
  const double k_bearing = sensor.kind == models::SensorKind::kRangeBearing
                               ? 1.0 / (sensor.bearing_sigma_rad * sensor.bearing_sigma_rad)
                               : 0.0;
  double bound = 0.0;
  for (const SearchTarget& target : problem.targets) {
    const models::StateMatrix A = target.model.transition(problem.step_s);
    const models::StateMatrix W = target.model.process_noise(problem.step_s);
    const Eigen::Index n = target.model.dim();
    // Least distance of the target from any point between two compared poses.
    double nearest_m = kInfinity;
    models::Gaussian moving = target.prior;
    for (int t = 0; t <= T; ++t) {
      nearest_m = std::min(nearest_m, (moving.mean.head(2) - problem.start.position_m()).norm());
      moving = models::predict(moving, A, W);
    }
    nearest_m -= T * chord_m;
    // ‖uuᵀ − vvᵀ‖ ≤ ‖Δp‖/r and ‖∇(u⊥u⊥ᵀ/r²)‖ ≤ 3/r³; the segment between may bulge inwards.
    const double between_m = nearest_m - 0.5 * apart_m(T);
    if (!(between_m > 0.0)) {
      return kInfinity;
    }
    const double L_m = k_range / between_m + 3.0 * k_bearing / std::pow(between_m, 3);
    const double information_max = std::max(k_range, k_bearing / (nearest_m * nearest_m));

    // Least eigenvalue of any covariance and largest of any prediction, by depth.
    std::vector<double> least{eigenvalue(target.prior.covariance, false)};
    std::vector<double> largest{0.0};
    std::vector<double> open_trace{target.prior.covariance.trace()};
    models::Gaussian open = target.prior;
    models::Gaussian sharp = target.prior;
    for (int t = 1; t <= T; ++t) {
      open = models::predict(open, A, W);
      sharp = models::predict(sharp, A, W);
      sharp.covariance = models::update_covariance(sharp.covariance,
                                                   information_max * Eigen::Matrix2d::Identity());
      least.push_back(eigenvalue(sharp.covariance, false));
      largest.push_back(eigenvalue(open.covariance, true));
      open_trace.push_back(open.covariance.trace());
    }
    for (int t = 1; t < T; ++t) {
      double C = 1.0 + pass.epsilon / least[static_cast<std::size_t>(t)];
      for (int s = 1; s <= T - t; ++s) {
        const double left = 1.0 - L_m * apart_m(s) * largest[static_cast<std::size_t>(t + s)];
        if (!(left > 0.0)) {
          return kInfinity;
        }
        C /= left;
        bound += problem.cost == CostKind::kLogDet
                     ? static_cast<double>(n) * std::log(C)
                     : (C - 1.0) * open_trace[static_cast<std::size_t>(t + s)];
      }
    }
  }
  return bound;
}

TEST(FinishedPass, StaysWithinTheClosedFormBound) {
  ReducedValueIteration search({20'000, 800'000, 8, 8, 4});
  int passes = 0;
  int finite = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const OwnedProblem owned = test::smooth_problem(seed);
    const ReducedOptions options = anytime(0.5, 8);
    const SearchResult& result = search.plan(owned.problem, options, Deadline::never());
    const double optimum = result.cost;
    double last_bound = kInfinity;
    for (std::size_t i = 1; i < result.history.size(); ++i) {  // the first has ε = δ = ∞
      const PassReport& report = result.history[i];
      const double bound = lipschitz_bound(owned.problem, {report.epsilon, report.delta_m});
      const double slack = 1e-9 * std::max(1.0, std::abs(optimum));
      EXPECT_LE(report.cost - optimum, bound + slack) << "seed " << seed;
      EXPECT_LE(bound, last_bound) << "monotone in (ε, δ)";
      last_bound = bound;
      ++passes;
      finite += std::isfinite(bound) ? 1 : 0;
    }
    EXPECT_NEAR(last_bound, 0.0, 1e-12);  // no loss at ε = δ = 0
  }
  EXPECT_GE(finite, passes / 2);
}

}  // namespace
}  // namespace vantage::planner
