#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "planner/search/astar.hpp"
#include "planner/search/sequencing_bound.hpp"
#include "test/planner/problem/mapping_problem.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/exhaustive_oracle.hpp"
#include "test/planner/search/full_tree.hpp"
#include "test/planner/search/solved_problems.hpp"

namespace vantage::planner {
namespace {

using test::FullTree;
using test::pick;
using test::uniform;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using test::slack;

// Returns a problem with a short-range robot among boxes and more static targets than it can reach.
// It has any planar sensor, either cost, and optionally noise and teammates' information.
OwnedProblem short_sighted_problem(std::uint64_t seed) {
  std::mt19937_64 rng(0xA0761D6478BD642FU * (seed + 1));
  OwnedProblem owned;
  SearchProblem& problem = owned.problem;
  owned.world = std::make_unique<models::World>();
  owned.world->bounds = {{-4.0, -4.0}, {4.0, 4.0}};
  problem.start = {uniform(rng, -2.0, 2.0), uniform(rng, -2.0, 2.0), uniform(rng, -kPi, kPi)};
  for (int i = pick(rng, 0, 3); i > 0; --i) {
    const Eigen::Vector2d corner(uniform(rng, -4.0, 3.0), uniform(rng, -4.0, 3.0));
    const Eigen::Vector2d size(uniform(rng, 0.3, 2.0), uniform(rng, 0.3, 2.0));
    owned.world->obstacles.push_back({{corner, corner + size}, 10.0});
    if (models::clearance_m(*owned.world, problem.start.position_m()) < 0.2) {
      owned.world->obstacles.pop_back();
    }
  }
  problem.world = owned.world.get();
  problem.horizon_steps = pick(rng, 3, 6);
  const double speed_mps = uniform(rng, 1.0, 3.0);
  problem.controls = {{speed_mps, 0.0}, {speed_mps, 1.5}, {speed_mps, -1.5}};
  if (problem.horizon_steps < 5) {
    problem.controls.push_back({0.5 * speed_mps, 3.0});
    problem.controls.push_back({0.0, 0.0});
  }
  problem.cost = pick(rng, 0, 1) == 0 ? CostKind::kTrace : CostKind::kLogDet;
  models::SensorModel sensor;
  const models::SensorKind kKinds[] = {models::SensorKind::kRange, models::SensorKind::kRange,
                                       models::SensorKind::kPosition,
                                       models::SensorKind::kRangeBearing};
  sensor.kind = kKinds[pick(rng, 0, 3)];
  sensor.range_max_m = uniform(rng, 0.5, 1.5);
  sensor.range_min_m = sensor.kind == models::SensorKind::kRangeBearing ? 0.2 : 0.0;
  sensor.range_sigma_m = uniform(rng, 0.05, 0.4);
  if (pick(rng, 0, 3) == 0) {
    sensor.fov_rad = radians(120.0);
  }
  problem.sensors = {sensor};
  const bool noisy = pick(rng, 0, 2) == 0;
  for (int m = pick(rng, 2, 8); m > 0; --m) {
    SearchTarget target{{models::TargetKind::kStatic, 2, 0.0}, {}};
    if (noisy && pick(rng, 0, 1) == 0) {
      target.model = {models::TargetKind::kRandomWalk, 2, uniform(rng, 0.0, 0.05)};
    }
    target.prior.mean = Eigen::Vector2d(uniform(rng, -3.0, 3.0), uniform(rng, -3.0, 3.0));
    target.prior.covariance = test::random_spd(rng, 2, uniform(rng, 0.05, 1.0), 1.0);
    problem.targets.push_back(target);
  }
  if (pick(rng, 0, 3) == 0) {
    for (std::size_t m = 0; m < problem.targets.size(); ++m) {
      problem.fixed_information.emplace_back(static_cast<std::size_t>(problem.horizon_steps));
      problem.fixed_information[m][1] = test::random_spd(rng, 2, 10.0, 1.0);
    }
  }
  return owned;
}

struct Bounds {
  double sequenced = 0.0;
  double reached = 0.0;
};

// Tests at least `nodes_min` nodes. No bound of a node or of a control exceeds the cost of the best
// path through it. The bound may be cut off after a few states.
void expect_admissible(int states_max, std::int64_t nodes_min, double& gained) {
  InformationHeuristic heuristic(16, 8);
  SequencingBound sequencing(16, 8, states_max);
  std::int64_t nodes = 0;
  for (std::uint64_t seed = 0; nodes < nodes_min; ++seed) {
    const OwnedProblem owned = short_sighted_problem(seed);
    const SearchProblem& problem = owned.problem;
    FullTree full(problem);
    ASSERT_TRUE(full.complete);
    heuristic.reset(problem, full.expander.beliefs());
    sequencing.reset(problem, full.expander.beliefs(), heuristic);
    const std::vector<double> best = full.best_through(problem.horizon_steps);
    std::vector<double> after(full.tree.node_count() * problem.controls.size(), -kInfinity);
    for (NodeId id = 0; id < full.tree.node_count(); ++id) {
      const Node& node = full.tree[id];
      if (node.parent != kNoNode) {
        const double bound =
            after[node.parent * problem.controls.size() + static_cast<std::size_t>(node.control)];
        ASSERT_LE(bound, best[id] + slack(bound)) << "seed " << seed << " node " << id;
      }
      if (node.depth == problem.horizon_steps) {
        continue;
      }
      const Blocks blocks = full.tree.posterior(id);
      const auto parts = heuristic.cost_to_go(node.world_from_body, node.depth, blocks,
                                              sequencing.takes_part().data());
      const double others = node.cost + parts.all - parts.apart;
      std::int64_t work_nodes = 0;
      const auto answer = sequencing.cost_to_go(node.world_from_body, node.depth, blocks, kInfinity,
                                                Deadline::never(), work_nodes);
      ASSERT_LE(others + answer.cost, best[id] + slack(best[id]))
          << "seed " << seed << " node " << id;
      for (std::size_t c = 0; c < problem.controls.size(); ++c) {
        after[id * problem.controls.size() + c] =
            others + sequencing.cost_after(static_cast<int>(c));
      }
      if (std::isfinite(answer.cost)) {
        gained += answer.cost - parts.apart;
      }
      ++nodes;
    }
  }
}

TEST(SequencingBound, IsAdmissibleAndTighterThanTheoremSix) {
  double gained = 0.0;
  expect_admissible(2'000, 60'000, gained);
  EXPECT_GT(gained, 60'000 * 0.1);
}

TEST(SequencingBound, IsAdmissibleAfterAnyCutOff) {
  double gained = 0.0;
  expect_admissible(60, 60'000, gained);
}

TEST(SequencingBound, DoesNotChangeTheOptimumOfASearch) {
  const SearchCapacity capacity{20'000, 800'000, 16, 8, 1};
  BestFirstSearch by_reach(capacity);
  BestFirstSearch by_sequence(capacity);
  std::int64_t expanded_by_reach = 0;
  std::int64_t expanded_by_sequence = 0;
  int solvable = 0;
  for (std::uint64_t seed = 5'000; seed < 5'300; ++seed) {
    const OwnedProblem owned = short_sighted_problem(seed);
    BestFirstOptions options;
    options.dive_every = 0;
    options.bound = NodeBound::kReach;
    const SearchResult& a = by_reach.plan(owned.problem, options, Deadline::never());
    options.bound = NodeBound::kSequence;
    const SearchResult& b = by_sequence.plan(owned.problem, options, Deadline::never());
    ASSERT_EQ(a.moving_steps, b.moving_steps);
    if (a.moving_steps < owned.problem.horizon_steps) {
      continue;
    }
    ++solvable;
    EXPECT_EQ(b.lower_bound, b.cost);
    EXPECT_NEAR(a.cost, b.cost, slack(a.cost)) << "seed " << seed;
    expanded_by_reach += a.nodes_expanded;
    expanded_by_sequence += b.nodes_expanded;
  }
  EXPECT_GT(solvable, 200);
  EXPECT_LT(10 * expanded_by_sequence, 9 * expanded_by_reach);
}

// Four targets around a robot that can observe one at a time. Even without memory for sequences,
// the common bound exceeds the sum of the bounds of the single targets.
TEST(SequencingBound, ObservesOnePlaceAtATimeAfterAnyCutOff) {
  InformationHeuristic heuristic(8, 8);
  SequencingBound sequencing(8, 8, 1);
  BeliefTable beliefs(8, 8);
  const auto bound_of = [&](const std::vector<Eigen::Vector2d>& places_m) {
    SearchProblem problem;
    problem.horizon_steps = 8;
    problem.step_s = 1.0;
    for (int c = 0; c < 40; ++c) {  // these bounds use all memory
      problem.controls.push_back({0.6, kPi * (c - 20) / 40.0});
    }
    models::SensorModel sensor;
    sensor.kind = models::SensorKind::kPosition;
    sensor.range_max_m = 1.0;
    problem.sensors = {sensor};
    for (const Eigen::Vector2d& place_m : places_m) {
      problem.targets.push_back(
          {{models::TargetKind::kStatic, 2, 0.0}, {place_m, Eigen::Matrix2d::Identity()}});
    }
    beliefs.reset(problem);
    heuristic.reset(problem, beliefs);
    sequencing.reset(problem, beliefs, heuristic);
    std::int64_t work_nodes = 0;
    return sequencing.cost_to_go({}, 0, {}, kInfinity, Deadline::never(), work_nodes).cost;
  };
  std::vector<Eigen::Vector2d> ring_m;
  double each = 0.0;
  for (int i = 0; i < 4; ++i) {
    const double bearing_rad = 0.5 * kPi * i;
    ring_m.emplace_back(1.5 * std::cos(bearing_rad), 1.5 * std::sin(bearing_rad));
    each += bound_of({ring_m.back()});
  }
  EXPECT_GT(bound_of(ring_m), each + 40.0);
}

// Two clusters of targets, each merged into one place, are reachable only late in a long horizon.
// After the first cluster the time is too short for the second.
TEST(SequencingBound, ExcludesVisitsToTwoFarPlaces) {
  constexpr int kSteps = 200;
  InformationHeuristic heuristic(16, kSteps);
  SequencingBound sequencing(16, kSteps, 2'000);
  BeliefTable beliefs(16, kSteps);
  const auto bound_of = [&](const std::vector<double>& bearings_rad) {
    SearchProblem problem;
    problem.horizon_steps = kSteps;
    problem.step_s = 1.0;
    problem.controls = {{0.1, 0.0}, {0.1, 0.5}, {0.1, -0.5}};
    models::SensorModel sensor;
    sensor.kind = models::SensorKind::kPosition;
    sensor.range_max_m = 1.0;
    problem.sensors = {sensor};
    for (const double bearing_rad : bearings_rad) {
      for (int i = 0; i < 8; ++i) {
        problem.targets.push_back({{models::TargetKind::kStatic, 2, 0.0},
                                   {Eigen::Vector2d(16.0 * std::cos(bearing_rad) + 0.01 * i,
                                                    16.0 * std::sin(bearing_rad)),
                                    Eigen::Matrix2d::Identity()}});
      }
    }
    beliefs.reset(problem);
    heuristic.reset(problem, beliefs);
    sequencing.reset(problem, beliefs, heuristic);
    std::int64_t work_nodes = 0;
    return sequencing.cost_to_go({}, 0, {}, kInfinity, Deadline::never(), work_nodes).cost;
  };
  const double each = bound_of({-0.25}) + bound_of({0.25});
  EXPECT_GT(bound_of({-0.25, 0.25}), 0.75 * each);
}

// Many targets with overlapping discs are merged into places, so that the work stays bounded.
TEST(SequencingBound, AcceptsAnyNumberOfTargets) {
  InformationHeuristic heuristic(64, 12);
  SequencingBound sequencing(64, 12, 1'000);
  BeliefTable beliefs(64, 12);
  for (const int landmarks : {1, 8, 16, 40}) {
    const OwnedProblem owned = test::random_landmark_problem(7, landmarks);
    beliefs.reset(owned.problem);
    heuristic.reset(owned.problem, beliefs);
    sequencing.reset(owned.problem, beliefs, heuristic);
    std::int64_t work_nodes = 0;
    const auto parts =
        heuristic.cost_to_go(owned.problem.start, 0, {}, sequencing.takes_part().data());
    const auto answer =
        sequencing.cost_to_go(owned.problem.start, 0, {}, kInfinity, Deadline::never(), work_nodes);
    EXPECT_LE(work_nodes, 1'000);
    EXPECT_GE(answer.cost, parts.apart - slack(parts.apart)) << landmarks;
  }
}

// Returns J_T with 1 mm added to the range in the denominator of H, as for the known value.
double regularised_score(const SearchProblem& problem, const std::vector<Pose2>& poses) {
  double cost = 0.0;
  for (const SearchTarget& target : problem.targets) {
    Eigen::Matrix2d information = target.prior.covariance.inverse();
    for (const Pose2& pose : poses) {
      const Eigen::Vector2d d = target.prior.mean.head<2>() - pose.position_m();
      if (d.norm() < 1.0 &&
          models::line_of_sight(*problem.world, pose.position_m(), target.prior.mean.head<2>())) {
        const Eigen::Vector2d h = d / (d.norm() + 0.001) / 0.15;
        information += h * h.transpose();
      }
      cost += information.inverse().trace();
    }
  }
  return cost;
}

TEST(Mapping, IsSolvedToProvenOptimality) {
  const OwnedProblem owned = test::known_mapping_problem();
  BestFirstSearch search({50'000, 1'000'000, 8, 12, 1});
  const SearchResult& result = search.plan(owned.problem, {}, Deadline::nodes(200'000));
  EXPECT_EQ(result.stop_reason, StopReason::kFinished);
  EXPECT_EQ(result.lower_bound, result.cost);
  EXPECT_NEAR(score(owned.problem, result.poses), result.cost, 1e-7);
  EXPECT_NEAR(regularised_score(owned.problem, result.poses), test::kKnownMappingOptimum, 1e-4);
}

TEST(Mapping, HasEqualOptimaForBothBounds) {
  BestFirstSearch search({400'000, 4'000'000, 8, 12, 1});
  for (const std::uint64_t seed : {6U, 9U}) {
    const OwnedProblem owned = experiments::random_start_problem(seed);
    BestFirstOptions options;
    const SearchResult by_sequence = search.plan(owned.problem, options, Deadline::never());
    options.bound = NodeBound::kReach;
    const SearchResult& by_reach = search.plan(owned.problem, options, Deadline::never());
    EXPECT_EQ(by_sequence.stop_reason, StopReason::kFinished);
    EXPECT_NEAR(by_sequence.cost, by_reach.cost, slack(by_reach.cost));
    EXPECT_LT(20 * by_sequence.nodes_expanded, by_reach.nodes_expanded);
  }
}

TEST(Mapping, BoundIsAtMostTheOptimum) {
  const OwnedProblem owned = test::known_mapping_problem();
  BestFirstSearch search({50'000, 1'000'000, 8, 12, 1});
  for (std::int64_t budget_nodes = 200; budget_nodes < 60'000; budget_nodes *= 2) {
    for (const double w : {1.0, 1.5}) {
      BestFirstOptions options;
      options.search = BestFirst::kAegis;
      options.weight = w;
      options.epsilon = 0.01;
      options.delta_m = 0.1;
      const SearchResult& result =
          search.plan(owned.problem, options, Deadline::nodes(budget_nodes));
      EXPECT_LE(result.lower_bound, test::kKnownMappingOptimum);
      EXPECT_GE(result.cost, test::kKnownMappingOptimum - 0.005);
    }
  }
}

}  // namespace
}  // namespace vantage::planner
