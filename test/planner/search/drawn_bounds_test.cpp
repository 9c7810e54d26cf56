#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "core/cpu_time.hpp"
#include "core/infinity.hpp"
#include "planner/search/root_bound.hpp"
#include "test/bench/tracking_family.hpp"
#include "test/planner/problem/mapping_problem.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/solved_problems.hpp"
#include "tools/plan/plan_report.hpp"
#include "tools/plan/solver.hpp"

// No lower bound is above the best cost found by any search, on random problems of both families
// and on problems with a terminal value.
// VANTAGE_BOUND_PROBLEMS sets the number of problems; default 300.

namespace vantage::planner {
namespace {

std::uint64_t problems_asked() {
  const char* const text = std::getenv("VANTAGE_BOUND_PROBLEMS");
  return text == nullptr ? 300 : std::strtoull(text, nullptr, 10);
}

tools::Solver solver_by(const char* algorithm) {
  tools::PlanRequest request;
  request.algorithm = algorithm;
  request.nodes = 20'000;
  return tools::Solver(request);
}

/// The bounds that `vantage plan` prints, and the root bounds from which they are computed.
class Bounds {
 public:
  [[nodiscard]] int plans() const { return plans_; }
  void print() const {
    std::printf("%d problems with a plan, least gap %.3g of the cost, %.1f s of CPU time\n", plans_,
                least_gap_, thread_cpu_s() - begin_s_);
  }

  void expect_below_every_plan(const SearchProblem& problem) {
    double cost = kInfinity;
    for (tools::Solver* const solver : {&beam_, &a_star_, &sampling_tree_}) {
      const SearchResult& result = solver->solve(problem).result;
      if (tools::is_complete(problem, result)) {
        cost = std::min(cost, result.cost);
      }
      bounds_[solver == &beam_     ? kBeam
              : solver == &a_star_ ? kAStar
                                   : kSamplingTree] = result.lower_bound;
    }
    beliefs_.reset(problem);
    bounds_[kAnyPlan] = root_.of_any_plan(problem, beliefs_);
    std::int64_t work_nodes = 0;
    bounds_[kMovingPlan] = root_.of_moving_plan(Deadline::never(), work_nodes).cost;
    expander_.reset(problem);
    constexpr std::int64_t kRaiseNodes = 600'000;  // about 0.04 s
    const std::int64_t until_nodes = work_nodes + kRaiseNodes;
    bounds_[kRaised] = root_.raise(expander_, until_nodes, Deadline::never(), work_nodes).cost;
    if (cost == kInfinity) {
      return;  // the robot is enclosed
    }
    ++plans_;
    for (int i = 0; i < kBounds; ++i) {
      const double slack = test::slack(cost);
      EXPECT_LE(bounds_[i], cost + slack) << kNames[i];
      least_gap_ = std::min(least_gap_, (cost - bounds_[i]) / std::max(1.0, std::abs(cost)));
    }
    EXPECT_LE(bounds_[kAnyPlan], bounds_[kMovingPlan]);
  }

 private:
  enum Bound { kBeam, kAStar, kSamplingTree, kAnyPlan, kMovingPlan, kRaised, kBounds };
  static constexpr const char* kNames[kBounds] = {
      "beam", "A*", "sampling tree", "root, any plan", "root, moving plan", "root, raised"};
  tools::Solver beam_ = solver_by("beam");
  tools::Solver a_star_ = solver_by("astar");
  tools::Solver sampling_tree_ = solver_by("sampling_tree");
  RootBound root_{25, 12};
  BeliefTable beliefs_{25, 12};
  Expander expander_{25, 12, 4};
  double bounds_[kBounds] = {};
  int plans_ = 0;
  double least_gap_ = kInfinity;
  double begin_s_ = thread_cpu_s();
};

/// Tests half of the requested problems, each made by draw(rng, seed) with seeds that were not used
/// for the choice of settings. @return share of problems with a plan
template <class Draw>
double expect_below_every_plan(const Draw& draw) {
  Bounds bounds;
  const std::uint64_t count = problems_asked() / 2;
  for (std::uint64_t i = 0; i < count && !::testing::Test::HasFailure(); ++i) {
    SCOPED_TRACE(i);
    std::mt19937_64 rng(i);
    bounds.expect_below_every_plan(draw(rng, 1'000'001 + i).problem);
  }
  bounds.print();
  return static_cast<double>(bounds.plans()) / static_cast<double>(count);
}

TEST(BoundsOfRandomProblems, AreBelowEveryTrackingPlan) {
  const double share = expect_below_every_plan([](std::mt19937_64& rng, std::uint64_t seed) {
    const int targets = test::pick(rng, 1, 25);
    // Every second problem has the standard field of view, 94°, the others a random one.
    const double fov_deg = seed % 2 == 0 ? 94.0 : test::uniform(rng, 40.0, 360.0);
    return bench::tracking_problem(targets, seed, fov_deg);
  });
  EXPECT_EQ(share, 1.0);
}

TEST(BoundsOfRandomProblems, AreBelowEveryMappingPlan) {
  const double share = expect_below_every_plan([](std::mt19937_64& rng, std::uint64_t seed) {
    return test::random_landmark_problem(seed, test::pick(rng, 1, 12));
  });
  EXPECT_GT(share, 0.5);  // from some starts no path is feasible
}

// Every second problem is a small one with a drawn tour. The others are tracking problems with a
// planned tour, mostly beyond the horizon.
TEST(DrawnBounds, AreBelowEveryPlanWithATour) {
  const double share = expect_below_every_plan([](std::mt19937_64& rng, std::uint64_t seed) {
    tools::PlanningProblem drawn;
    if (seed % 2 == 0) {
      test::OwnedProblem owned = test::random_problem(seed);
      test::add_random_tour(rng, owned.problem);
      drawn.world = std::move(owned.world);
      drawn.field = std::move(owned.field);
      drawn.problem = std::move(owned.problem);
      drawn.problem.seed = seed;
      return drawn;
    }
    drawn = bench::tracking_problem(test::pick(rng, 2, 25), seed);
    for (SearchTarget& target : drawn.problem.targets) {
      target.prior.mean.head<2>() *= 1.5;
    }
    bench::add_tour(drawn.problem);
    return drawn;
  });
  EXPECT_GT(share, 0.5);  // small problems can have no feasible path
}

}  // namespace
}  // namespace vantage::planner
