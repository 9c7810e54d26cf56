#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/search/astar.hpp"
#include "planner/search/beam.hpp"
#include "planner/search/catalogue.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/full_tree.hpp"
#include "test/planner/search/solved_problems.hpp"

// Tests of the options of searches and of the counts that searches report.

namespace vantage::planner {
namespace {

using test::slack;
using test::small_capacity;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Sets one option at a time and expects values within its limits to be accepted and others
/// refused.
template <class Search, class Options>
class OptionLimits {
 public:
  template <class Number>
  void expect(Number Options::*field, const std::vector<double>& taken,
              const std::vector<double>& refused) {
    for (const double value : taken) {
      EXPECT_NO_THROW(plan_with(field, value)) << value;
    }
    for (const double value : refused) {
      EXPECT_THROW(plan_with(field, value), UsageError) << value;
    }
  }

 private:
  template <class Number>
  void plan_with(Number Options::*field, double value) {
    Options options;
    options.*field = static_cast<Number>(value);
    search_.plan(owned_.problem, options, Deadline::nodes(10));
  }
  OwnedProblem owned_ = test::random_problem(2);
  Search search_{small_capacity()};
};

constexpr double kLittle = 1e-9;

TEST(Reduced, AcceptsOptionsWithinTheirLimits) {
  OptionLimits<ReducedValueIteration, ReducedOptions> limits;
  limits.expect(&ReducedOptions::halvings, {0, 1, 100}, {-1, 101});
  limits.expect(&ReducedOptions::epsilon, {0.0, kInfinity}, {-kLittle, kNaN});
  limits.expect(&ReducedOptions::delta_m, {0.0, kInfinity}, {-kLittle, kNaN});
  limits.expect(&ReducedOptions::yaw_weight_m_per_rad, {0.0, 5.0}, {-kLittle, kNaN});
}

TEST(BestFirst, AcceptsOptionsWithinTheirLimits) {
  OptionLimits<BestFirstSearch, BestFirstOptions> limits;
  limits.expect(&BestFirstOptions::weight, {1.0, 1e6}, {1.0 - kLittle, kInfinity, kNaN});
  limits.expect(&BestFirstOptions::epsilon, {0.0, 1e9}, {-kLittle, kNaN});
  limits.expect(&BestFirstOptions::delta_m, {0.0, 1e9}, {-kLittle, kNaN});
  limits.expect(&BestFirstOptions::yaw_weight_m_per_rad, {0.0, 5.0}, {-kLittle, kNaN});
  limits.expect(&BestFirstOptions::dive_every, {0, 1}, {-1});
}

TEST(RefiningBeam, AcceptsOptionsWithinTheirLimits) {
  OptionLimits<RefiningBeam, BeamOptions> limits;
  limits.expect(&BeamOptions::first_width, {1, 1'000}, {0});
  limits.expect(&BeamOptions::growth, {1.0 + kLittle, 1e6}, {1.0, kNaN});
  limits.expect(&BeamOptions::cell_m, {kLittle, 1e6}, {0.0, -1.0, kNaN});
  limits.expect(&BeamOptions::cell_rad, {kLittle, 1e6}, {0.0, -1.0, kNaN});
  limits.expect(&BeamOptions::alternation, {kLittle, 2.0}, {0.0, -1.0, kNaN});
  limits.expect(&BeamOptions::breadth, {0.0, 1.0}, {-kLittle, 1.0 + kLittle, kNaN});
  limits.expect(&BeamOptions::shrink, {kLittle, 1.0}, {0.0, 1.0 + kLittle, kNaN});
}

// The exact capacity is accepted; a capacity that is smaller by one is refused.
TEST(SearchCapacity, IsAnExactLimit) {
  SearchProblem problem;
  problem.horizon_steps = 3;
  problem.controls = models::lab_primitives();
  problem.targets.assign(2, {{models::TargetKind::kStatic, 2, 0.0},
                             {Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity()}});
  problem.teammates.assign(1, {});
  const SearchCapacity just{1'000, 10'000, 2, 3, 1};
  const auto plan_by_all = [&](const SearchCapacity& capacity) {
    ReducedValueIteration(capacity).plan(problem, {}, Deadline::nodes(100));
    BestFirstSearch(capacity).plan(problem, {}, Deadline::nodes(100));
    RefiningBeam(capacity).plan(problem, {}, Deadline::nodes(100));
  };
  EXPECT_NO_THROW(plan_by_all(just));
  EXPECT_NO_THROW(require_fits(problem, just));
  SearchCapacity less = just;
  less.horizon_max = 2;
  EXPECT_THROW(require_fits(problem, less), UsageError);
  less = just;
  less.targets_max = 1;
  EXPECT_THROW(require_fits(problem, less), UsageError);
  less = just;
  less.teammates_max = 0;
  EXPECT_THROW(require_fits(problem, less), UsageError);
  less = just;
  less.horizon_max = 2;
  ReducedValueIteration reduced(less);
  EXPECT_THROW(reduced.plan(problem, {}, Deadline::nodes(100)), UsageError);
  BestFirstSearch best_first(less);
  EXPECT_THROW(best_first.plan(problem, {}, Deadline::nodes(100)), UsageError);
  RefiningBeam beam(less);
  EXPECT_THROW(beam.plan(problem, {}, Deadline::nodes(100)), UsageError);
  less = just;
  less.nodes_max = 0;
  BestFirstSearch none(less);
  EXPECT_THROW(none.plan(problem, {}, Deadline::nodes(100)), UsageError);
  problem.step_s = 0.0;
  EXPECT_THROW(plan_by_all(just), UsageError) << "for any other values";
}

// A finished pass is reported with its options; a pass that is cut off is not reported.
TEST(BestFirst, ReportsItsOptions) {
  BestFirstSearch search(small_capacity());
  int converged = 0;
  for (const test::SolvedProblem& each : test::solved_problems(1000, 400)) {
    if (!each.best.found) {
      continue;
    }
    for (const BestFirst kind : {BestFirst::kAStar, BestFirst::kWeightedAStar, BestFirst::kAegis}) {
      BestFirstOptions how;
      how.search = kind;
      how.epsilon = 0.7;
      how.delta_m = 0.9;
      how.weight = kind == BestFirst::kWeightedAStar ? 2.0 : 1.0;
      const SearchResult& result = search.plan(each.owned.problem, how, Deadline::never());
      if (result.moving_steps < each.owned.problem.horizon_steps) {
        continue;  // all continuations were pruned
      }
      const bool prunes = kind == BestFirst::kAegis;
      EXPECT_EQ(result.epsilon, prunes ? 0.7 : 0.0);
      EXPECT_EQ(result.delta_m, prunes ? 0.9 : 0.0);
      EXPECT_EQ(result.passes, 1);
      ASSERT_EQ(result.history.size(), 1U);
      EXPECT_EQ(result.history[0].epsilon, result.epsilon);
      EXPECT_EQ(result.history[0].delta_m, result.delta_m);
      EXPECT_EQ(result.history[0].cost, result.cost);
      EXPECT_EQ(result.history[0].work_nodes, result.work_nodes);
      EXPECT_EQ(result.stop_reason == StopReason::kFinished, result.lower_bound == result.cost);
      EXPECT_TRUE(kind != BestFirst::kAStar || result.stop_reason == StopReason::kFinished);
      converged += result.stop_reason == StopReason::kConverged ? 1 : 0;
      EXPECT_GE(result.peak_bytes, search.tree().bytes_used());
    }
    const SearchResult& cut = search.plan(each.owned.problem, {}, Deadline::nodes(2));
    EXPECT_EQ(cut.passes, 0);
    EXPECT_TRUE(cut.history.empty());
    EXPECT_EQ(cut.stop_reason, StopReason::kDeadline);
  }
  EXPECT_GT(converged, 20);
}

// The peak memory is that of the tree plus the largest depth levels of generated and of expanded
// nodes.
TEST(Reduced, ReportsPeakMemory) {
  ReducedValueIteration search(small_capacity());
  int pruned = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const OwnedProblem owned = test::smooth_problem(seed);
    const int horizon = owned.problem.horizon_steps;
    ReducedOptions how;
    how.keeps_leaves = true;
    how.search = ReducedSearch::kExhaustive;
    const SearchResult all = search.plan(owned.problem, how, Deadline::never());
    EXPECT_EQ(all.peak_bytes, search.tree().bytes_used());
    EXPECT_EQ(all.epsilon, 0.0);
    EXPECT_EQ(all.passes, 1);
    EXPECT_EQ(all.nodes_generated + 1, static_cast<std::int64_t>(search.tree().node_count()));
    how.search = ReducedSearch::kSinglePass;
    how.epsilon = 0.3;
    how.delta_m = 0.4;
    const SearchResult& result = search.plan(owned.problem, how, Deadline::never());
    EXPECT_EQ(result.stop_reason, StopReason::kConverged);
    EXPECT_EQ(result.epsilon, 0.3);
    EXPECT_EQ(result.delta_m, 0.4);
    EXPECT_EQ(result.nodes_generated + 1, static_cast<std::int64_t>(search.tree().node_count()));
    std::vector<std::size_t> generated(index(horizon) + 1, 0);
    std::vector<std::size_t> opened(index(horizon) + 1, 0);
    std::vector<std::uint8_t> has_children(search.tree().node_count(), 0);
    for (NodeId id = 0; id < search.tree().node_count(); ++id) {
      const Node& node = search.tree()[id];
      ++generated[node.depth];
      if (node.parent != kNoNode && has_children[node.parent] == 0) {
        has_children[node.parent] = 1;
        ++opened[index(node.depth - 1)];
      }
    }
    const auto most = [&](const std::vector<std::size_t>& of) {  // excluding root and leaves
      return horizon > 1 ? *std::max_element(of.begin() + 1, of.end() - 1) : 0;
    };
    EXPECT_EQ(result.peak_bytes, search.tree().bytes_used() +
                                     most(generated) * CostOrder::bytes_per_entry() +
                                     most(opened) * CrossingIndex::bytes_per_entry());
    pruned += most(opened) < most(generated) ? 1 : 0;
    EXPECT_EQ(result.nodes_expanded,
              static_cast<std::int64_t>(
                  std::count(has_children.begin(), has_children.end(), std::uint8_t{1})));
  }
  EXPECT_GT(pruned, 20);
}

// Without keeps_leaves the tree has one node of depth T, that of the plan. The plan is the same.
TEST(Reduced, StoresOnlyTheBestLeafUnlessAllAreRequested) {
  ReducedValueIteration search(small_capacity());
  for (const ReducedSearch kind :
       {ReducedSearch::kExhaustive, ReducedSearch::kSinglePass, ReducedSearch::kAnytime}) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      const OwnedProblem owned = test::smooth_problem(seed);
      ReducedOptions how;
      how.search = kind;
      how.keeps_leaves = true;
      const SearchResult with = search.plan(owned.problem, how, Deadline::nodes(5'000));
      const std::size_t nodes_with_leaves = search.tree().node_count();
      how.keeps_leaves = false;
      const SearchResult& without = search.plan(owned.problem, how, Deadline::nodes(5'000));
      EXPECT_EQ(without.controls, with.controls);
      EXPECT_EQ(without.cost, with.cost);
      EXPECT_EQ(without.lower_bound, with.lower_bound);
      EXPECT_EQ(without.work_nodes, with.work_nodes);
      EXPECT_EQ(without.nodes_generated, with.nodes_generated);
      EXPECT_LE(search.tree().node_count(), nodes_with_leaves);
      int leaves = 0;
      for (NodeId id = 0; id < search.tree().node_count(); ++id) {
        leaves += search.tree()[id].depth == owned.problem.horizon_steps ? 1 : 0;
      }
      EXPECT_LE(leaves, 1);
    }
  }
}

// If no complete path can stop safely, the plan hovers as late as possible, at the cheapest node
// that can stop.
TEST(Hovering, StartsAsLateAsSafeAtTheCheapestPose) {
  ReducedValueIteration reduced(small_capacity());
  BestFirstSearch best_first(small_capacity());
  RefiningBeam beam(small_capacity());
  int hovered = 0;
  int later = 0;
  for (const std::uint64_t first : {0U, 1000U, 5000U}) {
    for (const test::SolvedProblem& each : test::solved_problems(first, first == 0 ? 240 : 400)) {
      if (each.best.found) {
        continue;
      }
      const SearchProblem& problem = each.owned.problem;
      test::FullTree full(problem);
      ASSERT_TRUE(full.complete);
      int latest = -1;
      double cheapest = kInfinity;
      int count = 0;  // nodes of that depth
      for (NodeId id = 0; id < full.tree.node_count(); ++id) {
        const Node& node = full.tree[id];
        const MotionTable& motion = full.expander.motion();
        const bool stops = node.depth == 0
                               ? motion.can_stop_from_start()
                               : motion.can_stop(node.world_from_body, node.control, node.depth);
        if (!stops || node.depth == problem.horizon_steps) {
          continue;
        }
        if (node.depth > latest) {
          latest = node.depth;
          cheapest = kInfinity;
        }
        cheapest = std::min(cheapest, full.expander.cost_of_hovering(full.tree, id));
      }
      for (NodeId id = 0; id < full.tree.node_count(); ++id) {
        count += full.tree[id].depth == latest ? 1 : 0;
      }
      ReducedOptions how;
      how.search = ReducedSearch::kExhaustive;
      BestFirstOptions a_star;
      a_star.bound = NodeBound::kReach;
      const SearchResult results[] = {reduced.plan(problem, how, Deadline::never()),
                                      best_first.plan(problem, a_star, Deadline::never()),
                                      beam.plan(problem, {}, Deadline::never())};
      for (const SearchResult& result : results) {
        ASSERT_EQ(result.found, latest >= 0) << each.seed;
        if (latest < 0) {
          continue;
        }
        ++hovered;
        later += latest > 0 ? 1 : 0;
        EXPECT_EQ(result.moving_steps, latest) << each.seed;
        EXPECT_EQ(result.controls.size(), index(latest));
        EXPECT_EQ(result.poses.size(), index(problem.horizon_steps));
        EXPECT_GE(result.cost, cheapest - slack(cheapest)) << each.seed;
        if (count <= 16) {  // larger sets are sampled
          EXPECT_NEAR(result.cost, cheapest, slack(cheapest)) << each.seed;
        }
        EXPECT_LE(result.lower_bound, result.cost);
      }
    }
  }
  EXPECT_GT(hovered, 5);
  EXPECT_GT(later, 1);
}

/// Returns a tracking problem that is too large for any budget of these tests.
SearchProblem tracking_problem(std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  SearchProblem problem;
  problem.horizon_steps = 7;
  problem.controls = models::standard_primitives();
  models::SensorModel sensor;
  sensor.fov_rad = radians(94.0);
  sensor.range_min_m = 0.1;
  sensor.range_max_m = 6.0;
  problem.sensors = {sensor};
  for (int m = 0; m < 5; ++m) {
    SearchTarget target{{models::TargetKind::kDoubleIntegrator, 2, 0.001}, {}};
    target.prior.mean =
        Eigen::Vector4d(test::uniform(rng, -6.0, 6.0), test::uniform(rng, -6.0, 6.0),
                        test::uniform(rng, -0.5, 0.5), test::uniform(rng, -0.5, 0.5));
    target.prior.covariance = Eigen::Vector4d(1.0, 1.0, 0.1, 0.1).asDiagonal();
    problem.targets.push_back(target);
  }
  return problem;
}

/// Returns the index of the first pass, from `from` on, that ended at `work_nodes` or later.
std::size_t first_pass_at(const SearchResult& result, std::int64_t work_nodes, std::size_t from) {
  std::size_t pass = from;
  while (pass < result.history.size() && result.history[pass].work_nodes < work_nodes) {
    ++pass;
  }
  return pass;
}

// A search without its own certificate first reports the bound of any plan. From 50,000 nodes on it
// reports the bound of moving plans. From 300,000 nodes on, a beam search raises that bound with
// 500,000 nodes and a quarter of the previous work.
TEST(Certificate, IsImprovedAfterTheStatedWork) {
  const SearchProblem problem = tracking_problem(3);
  const SearchCapacity capacity{100'000, 3'000'000, 8, 8, 1};
  RootBound root(8, 8);
  BeliefTable beliefs(8, 8);
  beliefs.reset(problem);
  const double any = root.of_any_plan(problem, beliefs);
  std::int64_t root_nodes = 0;
  const double moving = root.of_moving_plan(Deadline::never(), root_nodes).cost;
  ASSERT_GT(moving, any + 0.01);

  RefiningBeam beam(capacity);
  const auto bound_of_beam = [&](std::int64_t budget_nodes) {
    return beam.plan(problem, {}, Deadline::nodes(budget_nodes)).lower_bound;
  };
  const SearchResult whole = beam.plan(problem, {}, Deadline::nodes(800'000));
  const std::size_t first = first_pass_at(whole, 50'000, 0);
  const std::size_t raised = first_pass_at(whole, 300'000, first);
  ASSERT_LT(raised, whole.history.size());
  ASSERT_GT(raised, first + 1);
  EXPECT_EQ(bound_of_beam(whole.history[first].work_nodes), any);
  EXPECT_EQ(bound_of_beam(whole.history[first + 1].work_nodes), moving);
  const std::int64_t before_nodes = whole.history[raised].work_nodes;
  EXPECT_EQ(bound_of_beam(before_nodes), moving);
  Expander expander(8, 8, 1);
  expander.reset(problem);
  std::int64_t work_nodes = before_nodes;
  const std::int64_t until_nodes = before_nodes + before_nodes / 4 + 500'000;
  const double more = root.raise(expander, until_nodes, Deadline::never(), work_nodes).cost;
  EXPECT_GT(more, moving + 0.01);
  EXPECT_EQ(bound_of_beam(work_nodes + 1'000), more);

  ReducedValueIteration reduced(capacity);
  const auto bound_of_reduced = [&](std::int64_t budget_nodes) {
    return reduced.plan(problem, {}, Deadline::nodes(budget_nodes)).lower_bound;
  };
  const SearchResult passes = reduced.plan(problem, {}, Deadline::nodes(300'000));
  const std::size_t second = first_pass_at(passes, 50'000, 1);
  ASSERT_LT(second, passes.history.size());
  EXPECT_EQ(bound_of_reduced(passes.history[second].work_nodes), any);
  EXPECT_EQ(bound_of_reduced(passes.history[second].work_nodes + root_nodes + 100), moving);
}

}  // namespace
}  // namespace vantage::planner
