#include "planner/search/linearised_cost.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "models/belief/gaussian.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/lattice_problem.hpp"

namespace vantage::planner {
namespace {

using test::OwnedProblem;
using test::pick;
using test::random_spd;
using test::uniform;

/// Information about every target at every depth, [m][k − 1], exactly representable as float.
using Looks = std::vector<std::vector<Eigen::Matrix2d>>;

Eigen::Matrix2d as_floats(const Eigen::Matrix2d& M) { return M.cast<float>().cast<double>(); }

Looks random_looks(std::mt19937_64& rng, const SearchProblem& problem) {
  Looks looks(problem.targets.size());
  for (auto& of_target : looks) {
    for (int k = 0; k < problem.horizon_steps; ++k) {
      const Eigen::Matrix2d M =
          pick(rng, 0, 3) == 0
              ? Eigen::Matrix2d(Eigen::Matrix2d::Zero())
              : Eigen::Matrix2d(random_spd(rng, 2, std::pow(10.0, uniform(rng, -1.0, 1.5)), 2.0));
      of_target.push_back(as_floats(M));
    }
  }
  return looks;
}

/// Returns the cost of target m over the depths after `depth`, by the recursion of models/belief:
/// J_T, or −2 I for mutual information.
double cost_of(const SearchProblem& problem, int m, int depth, models::Gaussian belief,
               const Looks& looks, InformationMeasure measure) {
  double cost = 0.0;
  for (int k = depth + 1; k <= problem.horizon_steps; ++k) {
    belief = models::predict(belief, problem.targets[index(m)].model, problem.step_s);
    if (!problem.fixed_information.empty()) {
      const auto& fixed = problem.fixed_information[index(m)][index(k - 1)];
      if (fixed.size() > 0) {
        belief.covariance = models::update_covariance(belief.covariance, fixed);
      }
    }
    const double before = models::log_det(belief.covariance);
    belief.covariance = models::update_covariance(
        belief.covariance, models::PositionMatrix(looks[index(m)][index(k - 1)]));
    cost += models::log_det(belief.covariance) -
            (measure == InformationMeasure::kMutual ? before : 0.0);
  }
  return cost;
}

/// The linearised cost of a problem around a reference.
struct Tabled {
  Tabled(const SearchProblem& problem, InformationMeasure measure)
      : problem_(problem), beliefs_(8, 8), cost(8, 8) {
    beliefs_.reset(problem);
    cost.reset(problem, beliefs_, measure);
    cost.clear_reached();
  }
  void reach(int m, int k) { cost.set_reached(m, k); }
  /// Returns J(R) + Σ ⟨G, R⟩ of target m with `covariance` after `depth`.
  double around(int m, int depth, const models::StateMatrix& covariance, const Looks& looks) {
    std::vector<float> reference(cost.reference_size());
    for (int i = 0; i < static_cast<int>(problem_.targets.size()); ++i) {
      for (int k = 1; k <= problem_.horizon_steps; ++k) {
        const Eigen::Matrix2d& M = looks[index(i)][index(k - 1)];
        float* const R = reference.data() + 3 * cost.at(i, k);
        R[0] = static_cast<float>(M(0, 0));
        R[1] = static_cast<float>(M(0, 1));
        R[2] = static_cast<float>(M(1, 1));
      }
    }
    double packed[kMaxPacked];
    pack(beliefs_.layout(m), covariance, packed);
    return cost.linearise(m, depth, packed, reference.data());
  }
  /// Returns Σ ⟨G, M⟩, the cost saved by the measurements `looks` after `depth`.
  [[nodiscard]] double taken_off(int m, int depth, const Looks& looks) const {
    double sum = 0.0;
    for (int k = depth + 1; k <= problem_.horizon_steps; ++k) {
      const LinearisedCost::Gradient& g = cost.gradient(m, k);
      const Eigen::Matrix2d& M = looks[index(m)][index(k - 1)];
      sum += g.xx * M(0, 0) + 2.0 * g.xy * M(0, 1) + g.yy * M(1, 1);
    }
    return sum;
  }

 private:
  const SearchProblem& problem_;
  BeliefTable beliefs_;

 public:
  LinearisedCost cost;
};

/// Returns the measures that apply to `problem`. Mutual information counts the team's own
/// measurements only, so it needs a problem without fixed information.
std::vector<InformationMeasure> measures_of(const SearchProblem& problem) {
  std::vector<InformationMeasure> measures{InformationMeasure::kLogDet};
  if (problem.fixed_information.empty()) {
    measures.push_back(InformationMeasure::kMutual);
  }
  return measures;
}

double slack(double cost) { return 1e-6 * std::max(1.0, std::abs(cost)); }

/// Calls check(problem, measure, rng) for each measure of `count` lattice problems.
template <class Check>
void for_drawn_problems(std::uint64_t count, const Check& check) {
  for (std::uint64_t seed = 0; seed < count; ++seed) {
    SCOPED_TRACE(seed);
    const OwnedProblem owned = test::lattice_problem(seed);
    std::mt19937_64 rng(seed);
    for (const InformationMeasure measure : measures_of(owned.problem)) {
      check(owned.problem, measure, rng);
    }
  }
}

// The linear form is tangent to the cost at the reference and lies below it elsewhere. The test
// covers every depth, with and without teammates, noise and oscillators.
TEST(LinearisedCost, IsATangentLowerBound) {
  int far = 0;
  for_drawn_problems(
      60, [&](const SearchProblem& problem, InformationMeasure measure, std::mt19937_64& rng) {
        Tabled tabled(problem, measure);
        const int targets = static_cast<int>(problem.targets.size());
        for (int m = 0; m < targets; ++m) {
          for (int k = 1; k <= problem.horizon_steps; ++k) {
            tabled.reach(m, k);
          }
        }
        const int depth = pick(rng, 0, problem.horizon_steps - 1);
        const Looks reference = random_looks(rng, problem);
        for (int m = 0; m < targets; ++m) {
          models::Gaussian belief = problem.targets[index(m)].prior;
          belief.covariance =
              random_spd(rng, static_cast<int>(belief.mean.rows()), uniform(rng, 0.1, 2.0), 1.0);
          const double base = tabled.around(m, depth, belief.covariance, reference);
          const double there = cost_of(problem, m, depth, belief, reference, measure);
          EXPECT_NEAR(base - tabled.taken_off(m, depth, reference), there, slack(there));
          for (int i = 0; i < 10; ++i) {
            const Looks other = random_looks(rng, problem);
            const double cost = cost_of(problem, m, depth, belief, other, measure);
            const double bound = base - tabled.taken_off(m, depth, other);
            EXPECT_LE(bound, cost + slack(cost));
            far += bound < cost - 0.5 ? 1 : 0;
          }
        }
      });
  EXPECT_GT(far, 500);
}

// G = −∂J/∂M: each entry at each depth is compared with the effect of a small change of that
// measurement.
TEST(LinearisedCost, HasTheGradientOfTheCost) {
  constexpr double kSmall = 1e-4;
  Eigen::Matrix2d directions[3];
  directions[0] << 1.0, 0.0, 0.0, 0.0;
  directions[1] << 0.0, 1.0, 1.0, 0.0;
  directions[2] << 0.0, 0.0, 0.0, 1.0;
  for_drawn_problems(
      30, [&](const SearchProblem& problem, InformationMeasure measure, std::mt19937_64& rng) {
        Tabled tabled(problem, measure);
        const int m = static_cast<int>(problem.targets.size()) - 1;
        for (int k = 1; k <= problem.horizon_steps; ++k) {
          tabled.reach(m, k);
        }
        const Looks reference = random_looks(rng, problem);
        const models::Gaussian& belief = problem.targets[index(m)].prior;
        static_cast<void>(tabled.around(m, 0, belief.covariance, reference));
        for (int k = 1; k <= problem.horizon_steps; ++k) {
          const LinearisedCost::Gradient& g = tabled.cost.gradient(m, k);
          const double expected[] = {g.xx, 2.0 * g.xy, g.yy};
          for (int i = 0; i < 3; ++i) {
            Looks more = reference;
            Looks less = reference;
            more[index(m)][index(k - 1)] += kSmall * directions[i];
            less[index(m)][index(k - 1)] -= kSmall * directions[i];
            const double slope = (cost_of(problem, m, 0, belief, less, measure) -
                                  cost_of(problem, m, 0, belief, more, measure)) /
                                 (2.0 * kSmall);
            EXPECT_NEAR(slope, expected[i], 1e-3 * std::max(1.0, std::abs(g.xx) + std::abs(g.yy)))
                << "entry " << i << " at " << k;
          }
        }
      });
}

// If the robot cannot come near a target at a depth, the reference at that depth has no effect. If
// it can never come near, the cost is that without measurements.
TEST(LinearisedCost, UsesReferencesOnlyNearTargets) {
  const OwnedProblem owned = test::lattice_problem(1);
  const SearchProblem& problem = owned.problem;
  std::mt19937_64 rng(3);
  const int targets = static_cast<int>(problem.targets.size());
  for (const InformationMeasure measure : measures_of(problem)) {
    Tabled tabled(problem, measure);
    const Looks reference = random_looks(rng, problem);
    Looks counted(reference.size(), std::vector<Eigen::Matrix2d>(index(problem.horizon_steps),
                                                                 Eigen::Matrix2d::Zero()));
    for (int m = 0; m < targets; ++m) {
      const models::Gaussian& belief = problem.targets[index(m)].prior;
      const double alone = cost_of(problem, m, 0, belief, counted, measure);
      EXPECT_NEAR(tabled.around(m, 0, belief.covariance, reference), alone, slack(alone));
      tabled.reach(m, problem.horizon_steps);
      EXPECT_TRUE(tabled.cost.is_reached(m, problem.horizon_steps));
      EXPECT_FALSE(tabled.cost.is_reached(m, 1));
      counted[index(m)].back() = reference[index(m)].back();
      const double base = tabled.around(m, 0, belief.covariance, reference);
      const double there = cost_of(problem, m, 0, belief, counted, measure);
      EXPECT_NEAR(base - tabled.taken_off(m, 0, counted), there, slack(there));
    }
    tabled.cost.clear_reached();
    for (int m = 0; m < targets; ++m) {
      for (int k = 1; k <= problem.horizon_steps; ++k) {
        EXPECT_FALSE(tabled.cost.is_reached(m, k));
      }
    }
  }
}

// The reported information without measurements is that of the direction with the least
// information. A measurement that raises it by a factor f lowers the cost by at most weight · ln f.
TEST(LinearisedCost, BoundsGainOfOneMeasurement) {
  for_drawn_problems(
      40, [&](const SearchProblem& problem, InformationMeasure measure, std::mt19937_64& rng) {
        Tabled tabled(problem, measure);
        const int m = 0;
        tabled.reach(m, 1);
        const Looks none(
            problem.targets.size(),
            std::vector<Eigen::Matrix2d>(index(problem.horizon_steps), Eigen::Matrix2d::Zero()));
        const models::Gaussian& belief = problem.targets[0].prior;
        static_cast<void>(tabled.around(m, 0, belief.covariance, none));
        models::Gaussian open_loop = belief;
        for (int k = 1; k <= problem.horizon_steps; ++k) {
          open_loop = models::predict(open_loop, problem.targets[0].model, problem.step_s);
          if (!problem.fixed_information.empty() &&
              problem.fixed_information[0][index(k - 1)].size() > 0) {
            open_loop.covariance = models::update_covariance(
                open_loop.covariance, problem.fixed_information[0][index(k - 1)]);
          }
          const Eigen::Matrix2d P = open_loop.covariance.topLeftCorner(2, 2);
          const double known =
              1.0 / Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(P).eigenvalues().maxCoeff();
          EXPECT_NEAR(tabled.cost.known(m, k), known, 1e-9 * known) << k;
          const double steps_after = problem.horizon_steps - k;
          EXPECT_EQ(tabled.cost.weight(k),
                    measure == InformationMeasure::kLogDet ? steps_after + 1.0 : 1.0);
          for (int i = 0; i < 5; ++i) {
            const double angle_rad = uniform(rng, -kPi, kPi);
            const double strength = std::pow(10.0, uniform(rng, -1.0, 3.0));
            const Eigen::Vector2d u(std::cos(angle_rad), std::sin(angle_rad));
            Looks one = none;
            one[0][index(k - 1)] = strength * u * u.transpose();
            const double less = cost_of(problem, m, 0, belief, none, measure) -
                                cost_of(problem, m, 0, belief, one, measure);
            EXPECT_LE(less, tabled.cost.weight(k) * std::log1p(strength / known) + 1e-9) << k;
          }
        }
      });
}

}  // namespace
}  // namespace vantage::planner
