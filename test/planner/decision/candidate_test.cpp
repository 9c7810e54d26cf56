#include "planner/decision/candidate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "planner/decision/team_set.hpp"
#include "planner/problem/information_at.hpp"
#include "planner/problem/motion_table.hpp"
#include "test/planner/problem/random_problem.hpp"

namespace vantage::planner {
namespace {

SearchProblem open_problem(std::uint64_t seed) {
  SearchProblem problem = test::random_problem(seed).problem;
  problem.world = nullptr;  // its owner is destroyed
  problem.field = nullptr;
  problem.fixed_information.clear();
  problem.cost = CostKind::kLogDet;
  return problem;
}

TeamProblem team_of(const SearchProblem& problem, InformationMeasure measure) {
  TeamProblem team;
  team.targets = problem.targets;
  team.horizon_steps = problem.horizon_steps;
  team.step_s = problem.step_s;
  team.measure = measure;
  return team;
}

// The log-det information of the best plan is ½ (J without measurements − J of the search).
TEST(CandidateTrajectories, ContainTheBestPlanOfTheSearch) {
  ReducedValueIteration search({20'000, 400'000, 16, 16, 4});
  int planned = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const SearchProblem problem = open_problem(seed);
    TeamProblem team = team_of(problem, InformationMeasure::kLogDet);
    const CandidateOptions options{0.1, 0.2, 0.3};
    team.candidates.push_back(candidate_trajectories(problem, {}, search, options));
    const SearchResult& result = search.plan(
        problem, {ReducedSearch::kSinglePass, options.epsilon, options.delta_m, 12, 0.3},
        Deadline::never());
    if (!result.found || result.moving_steps < problem.horizon_steps) {
      EXPECT_TRUE(team.candidates[0].empty());
      continue;
    }
    ++planned;
    const TeamOracle oracle(team);
    const CandidateId best = oracle.by_value(0).front();
    SearchProblem blind = problem;
    blind.sensors.clear();
    const double unseen = score(blind, result.poses);
    EXPECT_NEAR(oracle.individual_value(best), 0.5 * (unseen - result.cost),
                1e-7 * (1.0 + std::abs(unseen)))
        << "seed " << seed;
    std::set<std::vector<int>> different;
    for (const Candidate& candidate : team.candidates[0]) {
      EXPECT_EQ(candidate.controls.size(), static_cast<std::size_t>(problem.horizon_steps));
      different.insert(candidate.controls);
    }
    EXPECT_EQ(different.size(), team.candidates[0].size());
  }
  EXPECT_GT(planned, 100);
}

TEST(CandidateTrajectories, MatchTheirControls) {
  ReducedValueIteration search({20'000, 400'000, 16, 16, 4});
  const EnergyModel energy{0.3, 0.0, 1.0, 2.0, {}};
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const SearchProblem problem = open_problem(seed);
    const std::vector<Candidate> candidates =
        candidate_trajectories(problem, energy, search, {1.0, 1.0, 0.3});
    for (std::size_t i = 0; i < std::min<std::size_t>(candidates.size(), 20); ++i) {
      const Candidate made = make_candidate(problem, energy, candidates[i].controls);
      EXPECT_EQ(made.energy_cost, candidates[i].energy_cost);
      for (std::size_t t = 0; t < made.poses.size(); ++t) {
        EXPECT_NEAR((made.poses[t].position_m() - candidates[i].poses[t].position_m()).norm(), 0.0,
                    1e-9);
      }
    }
  }
}

// The stand-alone gains that the search supplies equal those of the oracle bit for bit, so the
// oracle needs no calls.
TEST(CandidateTrajectories, SupplyStandAloneGain) {
  ReducedValueIteration search({20'000, 400'000, 16, 16, 4});
  const EnergyModel energy{0.3, 0.0, 1.0, 2.0, {}};
  int gaining = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const SearchProblem problem = open_problem(seed);
    TeamProblem team = team_of(problem, InformationMeasure::kMutual);
    team.candidates.push_back(candidate_trajectories(problem, energy, search, {1.0, 1.0, 0.3}));
    const TeamOracle brought(team);
    EXPECT_EQ(brought.calls(), 0);
    TeamProblem bare = team;
    for (Candidate& candidate : bare.candidates[0]) {
      ASSERT_TRUE(candidate.mutual_nats.has_value());
      gaining += *candidate.mutual_nats > 0.0 ? 1 : 0;
      candidate.mutual_nats.reset();
    }
    const TeamOracle without_gains(bare);
    EXPECT_EQ(without_gains.calls(), without_gains.candidate_count());
    for (CandidateId id = 0; id < without_gains.candidate_count(); ++id) {
      EXPECT_EQ(brought.individual_value(id), without_gains.individual_value(id))
          << "seed " << seed;
    }
    team.measure = InformationMeasure::kLogDet;  // the supplied gains are mutual information
    EXPECT_EQ(TeamOracle(team).calls(), without_gains.candidate_count());
  }
  EXPECT_GT(gaining, 100);
}

// With fixed measurements of teammates, the gain of a trajectory in the search is not its
// stand-alone gain.
TEST(CandidateTrajectories, SupplyNoGainWithFixedInformation) {
  ReducedValueIteration search({20'000, 400'000, 16, 16, 4});
  int made = 0;
  int zeroed = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SearchProblem problem = test::random_problem(seed).problem;
    problem.world = nullptr;
    problem.field = nullptr;
    bool is_fixed = false;
    for (auto& of_target : problem.fixed_information) {
      for (models::StateMatrix& M : of_target) {
        is_fixed = is_fixed || !M.isZero(0.0);
      }
    }
    for (const Candidate& of : candidate_trajectories(problem, {}, search, {1.0, 1.0, 0.3})) {
      EXPECT_EQ(of.mutual_nats.has_value(), !is_fixed);
      made += is_fixed ? 1 : 0;
    }
    // If the table of fixed information contains only zeros, gains are supplied.
    for (auto& of_target : problem.fixed_information) {
      for (models::StateMatrix& M : of_target) {
        M.setZero();
      }
    }
    for (const Candidate& of : candidate_trajectories(problem, {}, search, {1.0, 1.0, 0.3})) {
      EXPECT_TRUE(of.mutual_nats.has_value());
      zeroed += is_fixed ? 1 : 0;
    }
  }
  EXPECT_GT(made, 10);
  EXPECT_GT(zeroed, 10);
}

// The region "mud" begins at x = 3 m; the six steps begin at x = 0, 2, 4, 6, 8 and 8 m.
TEST(EnergyUsed, SumsControlsAndRegionsOfTheRobot) {
  models::World world;
  world.bounds = {{-1.0, -5.0}, {20.0, 5.0}};
  world.regions = {{"mud", {{3.0, -5.0}, {20.0, 5.0}}, 3.0}, {"wind", world.bounds, 7.0}};
  SearchProblem problem;
  problem.world = &world;
  problem.horizon_steps = 6;
  problem.step_s = 1.0;
  problem.controls = {{2.0, 0.0}, {0.0, 1.0}, {0.0, 0.0}};
  const EnergyModel ground{0.5, 0.0, 1.0, 2.0, {"mud"}};
  const Candidate candidate = make_candidate(problem, ground, {0, 0, 0, 0, 1, 2});
  const double controls = 4 * 2.0 + 1.0 + 0.0;
  const double mud = 4 * 3.0;
  EXPECT_DOUBLE_EQ(candidate.energy_cost, 0.5 * (controls + mud));
  const EnergyModel air{1.0, 2.0, 2.0, 4.0, {"wind"}};
  EXPECT_DOUBLE_EQ(make_candidate(problem, air, {2, 2, 2, 2, 2, 2}).energy_cost, 6 * (2.0 + 7.0));
}

TEST(MakeCandidate, RefusesUnknownControls) {
  const SearchProblem problem = open_problem(1);
  const auto count = static_cast<int>(problem.controls.size());
  const std::vector<int> controls(static_cast<std::size_t>(problem.horizon_steps), 0);
  EXPECT_NO_THROW(make_candidate(problem, {}, controls));
  for (const int none : {-1, count}) {
    std::vector<int> bad = controls;
    bad.back() = none;
    EXPECT_THROW(make_candidate(problem, {}, bad), UsageError);
    bad.back() = none < 0 ? 0 : count - 1;
    EXPECT_NO_THROW(make_candidate(problem, {}, bad));
  }
  std::vector<int> short_of_one = controls;
  short_of_one.pop_back();
  EXPECT_THROW(make_candidate(problem, {}, short_of_one), UsageError);
  std::vector<int> one_more = controls;
  one_more.push_back(0);
  EXPECT_THROW(make_candidate(problem, {}, one_more), UsageError);
}

std::vector<int> drawn_controls(const SearchProblem& problem, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::vector<int> controls;
  for (int t = 0; t < problem.horizon_steps; ++t) {
    controls.push_back(test::pick(rng, 0, static_cast<int>(problem.controls.size()) - 1));
  }
  return controls;
}

void expect_same_looks(const Candidate& a, const Candidate& b) {
  ASSERT_EQ(a.measurements.size(), b.measurements.size());
  for (std::size_t i = 0; i < a.measurements.size(); ++i) {
    EXPECT_EQ(a.measurements[i].target, b.measurements[i].target);
    EXPECT_EQ(a.measurements[i].step, b.measurements[i].step);
    for (int k = 0; k < 6; ++k) {
      const double of_b = b.measurements[i].information.m[k];
      EXPECT_NEAR(a.measurements[i].information.m[k], of_b, 1e-6 * (1.0 + std::abs(of_b)));
    }
  }
}

// The measurements are the sums over all sensors, per target and step, at the expected target
// positions. They are ordered by target and step and contain visible targets only.
TEST(MakeCandidate, HasMeasurementsOfAllVisibleTargets) {
  int seen = 0;
  int hidden = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    test::OwnedProblem owned = test::random_problem(seed);
    SearchProblem& problem = owned.problem;
    problem.fixed_information.clear();
    const Candidate made = make_candidate(problem, {}, drawn_controls(problem, seed));
    ASSERT_EQ(made.poses.size(), made.controls.size());
    std::size_t next = 0;
    for (std::size_t m = 0; m < problem.targets.size(); ++m) {
      const int p = problem.targets[m].model.position_dim;
      models::Gaussian belief = problem.targets[m].prior;
      Pose2 at = problem.start;
      for (std::size_t t = 0; t < made.poses.size(); ++t) {
        belief = models::predict(belief, problem.targets[m].model, problem.step_s);
        at = models::step_unicycle(at, problem.controls[static_cast<std::size_t>(made.controls[t])],
                                   problem.step_s);
        const models::PositionMatrix M = information_at(
            sight_world(problem), problem.sensors, {at, problem.height_m}, belief.mean.head(p));
        if (M.isZero(0.0)) {
          ++hidden;
          continue;
        }
        ++seen;
        ASSERT_LT(next, made.measurements.size());
        const PredictedMeasurement& is = made.measurements[next++];
        EXPECT_EQ(is.target, m);
        EXPECT_EQ(is.step, t + 1);
        const models::PositionMatrix stated =
            unpack(p == 3 ? BlockLayout::kSpatial : BlockLayout::kPlanar, is.information.m);
        EXPECT_LE((stated - M).norm(), 1e-6 * M.norm());
      }
    }
    EXPECT_EQ(next, made.measurements.size());
  }
  EXPECT_GT(seen, 300);
  EXPECT_GT(hidden, 300);
}

// Controls, a search result and a teammate's trajectory of the same motion give the same candidate.
TEST(MakeCandidate, IsSameFromSearchAndFromMotion) {
  ReducedValueIteration search({20'000, 400'000, 16, 16, 4});
  const EnergyModel energy{0.3, 0.0, 1.0, 2.0, {}};
  int looks = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    SearchProblem problem = open_problem(seed);
    problem.start_time = Time{Duration{7'000'000}};
    problem.height_m = 1.0 + 0.1 * static_cast<double>(seed % 7);
    SearchResult result = search.plan(problem, {}, Deadline::nodes(2'000));
    if (!result.found || result.moving_steps < problem.horizon_steps) {
      continue;
    }
    const Candidate made = make_candidate(problem, energy, result.controls);
    const Candidate found = make_candidate(problem, energy, result);
    EXPECT_EQ(found.controls, result.controls);
    EXPECT_NEAR(found.energy_cost, made.energy_cost, 1e-12);
    expect_same_looks(found, made);
    looks += static_cast<int>(made.measurements.size());

    // The candidate uses the sensor and height of the moving robot, not those of the evaluating
    // robot.
    const models::SensorModel sensor = problem.sensors.back();
    const models::Trajectory motion = to_trajectory(problem, result.controls);
    SearchProblem own = problem;
    own.sensors = {sensor};
    SearchProblem of_another = problem;
    of_another.height_m += 0.7;
    of_another.sensors.resize(1);
    of_another.sensors[0].range_max_m *= 0.5;
    const Candidate from_motion = make_candidate(of_another, &sensor, motion, 2.5);
    expect_same_looks(from_motion, make_candidate(own, energy, result.controls));
    EXPECT_EQ(from_motion.energy_cost, 2.5);
    EXPECT_EQ(from_motion.poses.size(), made.poses.size());
    const Candidate blind = make_candidate(problem, nullptr, motion, 2.5);
    EXPECT_TRUE(blind.measurements.empty());
    EXPECT_EQ(blind.energy_cost, 2.5);

    result.poses.pop_back();
    EXPECT_THROW(make_candidate(problem, energy, result), UsageError) << "a pose is missing";
    result.poses.push_back(problem.start);
    EXPECT_NO_THROW(make_candidate(problem, energy, result));
    result.found = false;
    EXPECT_THROW(make_candidate(problem, energy, result), UsageError);
  }
  EXPECT_GT(looks, 100);
}

// ---- Selection of leaves ----

struct PlainLeaf {
  NodeId id = kNoNode;
  double order = 0.0;
  std::vector<int> controls;
  std::vector<Pose2> poses;
  std::vector<Eigen::MatrixXd> last;  // covariance of each target at the last step
};

std::vector<PlainLeaf> leaves_of(const SearchProblem& problem, const EnergyModel& energy,
                                 const Tree& tree, bool is_anytime) {
  MotionTable motion(static_cast<int>(problem.controls.size()), problem.horizon_steps,
                     static_cast<int>(problem.teammates.size()));
  motion.reset(problem);
  std::vector<PlainLeaf> leaves;
  for (NodeId id = 0; id < static_cast<NodeId>(tree.node_count()); ++id) {
    const Node& node = tree[id];
    if (node.depth != problem.horizon_steps ||
        !motion.can_stop(node.world_from_body, node.control, node.depth)) {
      continue;
    }
    PlainLeaf leaf;
    leaf.id = id;
    for (NodeId at = id; tree[at].parent != kNoNode; at = tree[at].parent) {
      leaf.controls.insert(leaf.controls.begin(), tree[at].control);
      leaf.poses.insert(leaf.poses.begin(), tree[at].world_from_body);
    }
    const Candidate made = make_candidate(problem, energy, leaf.controls);
    leaf.order = is_anytime ? 0.5 * node.cost + made.energy_cost : node.cost;
    for (std::size_t m = 0; m < problem.targets.size(); ++m) {
      const int p = problem.targets[m].model.position_dim;
      models::Gaussian belief = problem.targets[m].prior;
      for (int t = 1; t <= problem.horizon_steps; ++t) {
        belief = models::predict(belief, problem.targets[m].model, problem.step_s);
        for (const PredictedMeasurement& look : made.measurements) {
          if (look.target == m && look.step == t) {
            belief.covariance = models::update_covariance(
                belief.covariance,
                unpack(p == 3 ? BlockLayout::kSpatial : BlockLayout::kPlanar, look.information.m));
          }
        }
      }
      leaf.last.emplace_back(belief.covariance);
    }
    leaves.push_back(std::move(leaf));
  }
  std::stable_sort(leaves.begin(), leaves.end(),
                   [](const PlainLeaf& a, const PlainLeaf& b) { return a.order < b.order; });
  return leaves;
}

// Returns the smallest eigenvalue, over all targets, of the covariance of `leaf` minus that of
// `kept`. `leaf` is redundant if the result is at least −ε.
double least_lead(const PlainLeaf& leaf, const PlainLeaf& kept) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t m = 0; m < leaf.last.size(); ++m) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> values(leaf.last[m] - kept.last[m]);
    least = std::min(least, values.eigenvalues().minCoeff());
  }
  return least;
}

// The expected candidates are computed from the tree of the search. Leaves are processed in
// ascending order. A leaf is dropped if it is within δ of a kept leaf and its covariance plus ε I
// is at least the covariance of the kept leaf.
TEST(CandidateTrajectories, AreTheNonRedundantLeaves) {
  ReducedValueIteration search({20'000, 400'000, 16, 16, 4});
  const EnergyModel energy{0.3, 0.1, 1.0, 2.0, {}};
  constexpr std::size_t kAll = CandidateOptions::kNoLimit;
  const std::vector<CandidateOptions> options = {
      {0.3, 0.6, 0.3, false, kAll, kAll}, {0.05, 1.5, 0.0, false, kAll, kAll},
      {0.3, 0.6, 0.3, true, kAll, kAll},  {0.3, 0.6, 0.3, true, 7, kAll},
      {0.3, 0.6, 0.3, false, kAll, 3},    {0.3, 0.6, 0.3, true, 1, kAll},
      {0.3, 0.6, 0.3, false, 0, kAll},    {0.3, 0.6, 0.3, false, kAll, 0}};
  int redundant = 0;
  int near_alone = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    test::OwnedProblem owned = test::random_problem(seed);
    SearchProblem& problem = owned.problem;
    problem.fixed_information.clear();
    problem.cost = CostKind::kLogDet;
    if (problem.horizon_steps > 3) {
      problem.horizon_steps = 3;
    }
    for (std::size_t k = 0; k < options.size(); ++k) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << " options " << k);
      const CandidateOptions& of = options[k];
      const auto found = candidate_trajectories(problem, energy, search, of);
      std::vector<PlainLeaf> leaves = leaves_of(problem, energy, search.tree(), of.is_anytime);
      leaves.resize(std::min(leaves.size(), of.leaves_max));
      std::vector<const PlainLeaf*> kept;
      bool is_on_an_edge = false;  // result depends on rounding
      for (std::size_t i = 0; i < leaves.size() && kept.size() < of.candidates_max; ++i) {
        const PlainLeaf& leaf = leaves[i];
        is_on_an_edge |=
            i > 0 && leaf.order - leaves[i - 1].order < 1e-9 && leaf.order > leaves[i - 1].order;
        const bool is_redundant = std::any_of(kept.begin(), kept.end(), [&](const PlainLeaf* one) {
          const Pose2& a = leaf.poses.back();
          const Pose2& b = one->poses.back();
          const double apart =
              std::hypot((a.position_m() - b.position_m()).norm(),
                         of.yaw_weight_m_per_rad * wrap_to_pi(a.yaw_rad - b.yaw_rad));
          is_on_an_edge |= std::abs(apart - of.delta_m) < 1e-9;
          if (apart > of.delta_m) {
            return false;
          }
          const double lead = least_lead(leaf, *one) + of.epsilon;
          is_on_an_edge |= std::abs(lead) < 1e-9;
          near_alone += lead < 0.0 ? 1 : 0;
          return lead >= 0.0;
        });
        redundant += is_redundant ? 1 : 0;
        if (!is_redundant) {
          kept.push_back(&leaf);
        }
      }
      if (is_on_an_edge) {
        continue;
      }
      std::sort(kept.begin(), kept.end(), [](auto* a, auto* b) { return a->id < b->id; });
      ASSERT_EQ(found.size(), kept.size());
      for (std::size_t i = 0; i < kept.size(); ++i) {
        EXPECT_EQ(found[i].controls, kept[i]->controls);
      }
    }
  }
  EXPECT_GT(redundant, 500);
  EXPECT_GT(near_alone, 50) << "near, but more certain";
}

// If a robot must be able to stop, leaves from which it cannot stop are dropped.
TEST(CandidateTrajectories, CanStopWhenStopIsRequired) {
  ReducedValueIteration search({20'000, 400'000, 16, 16, 4});
  int left_out = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    test::OwnedProblem owned = test::random_problem(seed);
    SearchProblem& problem = owned.problem;
    problem.fixed_information.clear();
    if (problem.world == nullptr || problem.brake_mps2 == 0.0) {
      continue;
    }
    const auto found = candidate_trajectories(problem, {}, search, {0.1, 0.1, 0.3});
    for (const Candidate& each : found) {
      EXPECT_TRUE(models::is_clear(*problem.world, to_trajectory(problem, each.controls),
                                   problem.start_time, problem.clearance_m - 1e-9))
          << seed;
    }
    int leaves = 0;
    for (NodeId id = 0; id < static_cast<NodeId>(search.tree().node_count()); ++id) {
      leaves += search.tree()[id].depth == problem.horizon_steps ? 1 : 0;
    }
    const auto stopping = leaves_of(problem, {}, search.tree(), false).size();
    left_out += leaves - static_cast<int>(stopping);
    EXPECT_LE(found.size(), stopping);
  }
  EXPECT_GT(left_out, 100);
}

TEST(CandidateTrajectories, RefuseInvalidTolerances) {
  ReducedValueIteration search({20'000, 400'000, 16, 16, 4});
  const SearchProblem problem = open_problem(1);
  for (const double none :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(candidate_trajectories(problem, {}, search, {none, 1.0}), UsageError);
    EXPECT_THROW(candidate_trajectories(problem, {}, search, {1.0, none}), UsageError);
  }
  const CandidateOptions options;
  EXPECT_EQ(options.epsilon, 1.0);
  EXPECT_EQ(options.delta_m, 2.0);
  EXPECT_EQ(options.yaw_weight_m_per_rad, 0.3);
  EXPECT_FALSE(options.is_anytime);
  EXPECT_EQ(options.leaves_max, std::numeric_limits<std::size_t>::max());
  EXPECT_EQ(options.candidates_max, std::numeric_limits<std::size_t>::max());
}

}  // namespace
}  // namespace vantage::planner
