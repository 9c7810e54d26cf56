#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "planner/search/astar.hpp"
#include "planner/search/beam.hpp"
#include "planner/search/root_bound.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/full_tree.hpp"
#include "test/planner/search/same_result.hpp"
#include "test/support/allocation_counter.hpp"

// A search with a capacity of exactly the problem's targets, steps and teammates behaves like a
// search with more capacity. It allocates no memory while planning.

namespace vantage::planner {
namespace {

constexpr std::uint64_t kProblems = 30;

template <class Check>
void for_problems_without_a_square(const Check& check) {
  int wide = 0;
  int long_ones = 0;
  for (std::uint64_t seed = 0; seed < kProblems; ++seed) {
    const OwnedProblem owned = test::random_problem(seed);
    const int targets = static_cast<int>(owned.problem.targets.size());
    const int steps = owned.problem.horizon_steps;
    if (targets == steps) {
      continue;
    }
    SCOPED_TRACE(seed);
    check(owned.problem, targets, steps);
    (targets > steps ? wide : long_ones) += 1;
  }
  EXPECT_GT(wide, 5);
  EXPECT_GT(long_ones, 5);
}

/// Expects `plan(search, deadline)` to have the same result with both capacities.
template <class Search, class Plan>
void expect_alike(int targets, int steps, const Plan& plan) {
  Search exact({5'000, 200'000, targets, steps, 0});
  Search roomy({5'000, 200'000, 16, 16, 4});
  const Deadline budget = Deadline::nodes(1'500);
  const test::AllocationCounter allocations;
  const SearchResult& is = plan(exact, budget);
  EXPECT_EQ(allocations.count(), 0U) << "not measured under sanitizers";
  test::expect_same(is, plan(roomy, budget));
}

TEST(SearchCapacity, ExactCapacityIsEnough) {
  for_problems_without_a_square([](const SearchProblem& problem, int targets, int steps) {
    expect_alike<ReducedValueIteration>(
        targets, steps,
        [&](ReducedValueIteration& search, const Deadline& budget) -> const SearchResult& {
          return search.plan(problem, {}, budget);
        });
    for (const BestFirst kind : {BestFirst::kAStar, BestFirst::kWeightedAStar, BestFirst::kAegis}) {
      BestFirstOptions options;
      options.search = kind;
      expect_alike<BestFirstSearch>(
          targets, steps,
          [&](BestFirstSearch& search, const Deadline& budget) -> const SearchResult& {
            return search.plan(problem, options, budget);
          });
    }
    expect_alike<RefiningBeam>(
        targets, steps, [&](RefiningBeam& search, const Deadline& budget) -> const SearchResult& {
          return search.plan(problem, {}, budget);
        });
  });
}

TEST(RootBound, NeedsOnlyExactCapacity) {
  for_problems_without_a_square([](const SearchProblem& problem, int targets, int steps) {
    Expander expander(16, 16, 1);
    expander.reset(problem);
    const auto bounds_by = [&](RootBound& root) {
      std::vector<double> bounds(3);
      std::int64_t work_nodes = 0;
      const test::AllocationCounter allocations;
      bounds[0] = root.of_any_plan(problem, expander.beliefs());
      bounds[1] = root.of_moving_plan(Deadline::never(), work_nodes).cost;
      bounds[2] = root.raise(expander, work_nodes + 2'000, Deadline::never(), work_nodes).cost;
      EXPECT_EQ(allocations.count(), 0U) << "not measured under sanitizers";
      return bounds;
    };
    RootBound exact(targets, steps);
    RootBound roomy(16, 16);
    EXPECT_EQ(bounds_by(exact), bounds_by(roomy));
  });
}

// Among the nodes that may stop, the cheapest is chosen; of equal ones the first node, for any
// order of the offers.
TEST(HoverChoice, IsTheCheapestSafeHover) {
  int chosen = 0;
  int none = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    OwnedProblem owned = test::random_problem(seed);
    if (seed % 3 == 0) {
      owned.problem.brake_mps2 = 0.02;  // so that many nodes may not stop
    }
    test::FullTree full(owned.problem);
    ASSERT_TRUE(full.complete);
    const int depth = static_cast<int>(seed) % (owned.problem.horizon_steps + 1);
    std::vector<NodeId> nodes;
    for (NodeId id = 0; id < full.tree.node_count(); ++id) {
      if (full.tree[id].depth == depth) {
        nodes.push_back(id);
      }
    }
    double least = std::numeric_limits<double>::infinity();
    for (const NodeId id : nodes) {
      const Node& node = full.tree[id];
      const MotionTable& motion = full.expander.motion();
      if (depth == 0 ? motion.can_stop_from_start()
                     : motion.can_stop(node.world_from_body, node.control, depth)) {
        std::vector<Pose2> poses = full.path(id);
        poses.resize(index(owned.problem.horizon_steps), node.world_from_body);
        least = std::min(least, score(owned.problem, poses));
      }
    }
    for (int turn = 0; turn < 2; ++turn) {
      HoverChoice choice(full.expander, full.tree);
      EXPECT_EQ(choice.best(), kNoNode);
      for (const NodeId id : nodes) {
        choice.offer(id);
      }
      EXPECT_EQ(choice.best() == kNoNode, std::isinf(least));
      if (std::isinf(least)) {
        EXPECT_EQ(choice.cost(), least);
        ++none;
      } else {
        EXPECT_NEAR(choice.cost(), least, 1e-8 * std::max(1.0, std::abs(least)));
        EXPECT_EQ(full.expander.cost_of_hovering(full.tree, choice.best()), choice.cost());
        ++chosen;
      }
      std::reverse(nodes.begin(), nodes.end());
    }
  }
  EXPECT_GT(chosen, 60);
  EXPECT_GT(none, 3);
}

}  // namespace
}  // namespace vantage::planner
