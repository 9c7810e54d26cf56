#include "planner/decision/candidate.hpp"

#include <set>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/decision/team_set.hpp"
#include "test/planner/problem/random_problem.hpp"

namespace vantage::planner {
namespace {

SearchProblem open_problem(std::uint64_t seed) {
  SearchProblem problem = test::random_problem(seed).problem;
  problem.world = nullptr;  // it goes away with its owner
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

// ½ (J without looks − J of the search) is the log-det information of its best plan.
TEST(CandidateTrajectories, HoldTheBestPlanOfTheSearchAtItsValue) {
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
    EXPECT_NEAR(oracle.alone(best), 0.5 * (unseen - result.cost), 1e-7 * (1.0 + std::abs(unseen)))
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

TEST(CandidateTrajectories, AreWhatTheirControlsMake) {
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

// What the search brings along is what the oracle would say, to the bit, and saves all its calls.
TEST(CandidateTrajectories, BringWhatTheyGainAlone) {
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
    const TeamOracle asked(bare);
    EXPECT_EQ(asked.calls(), asked.candidate_count());
    for (CandidateId id = 0; id < asked.candidate_count(); ++id) {
      EXPECT_EQ(brought.alone(id), asked.alone(id)) << "seed " << seed;
    }
    team.measure = InformationMeasure::kLogDet;  // that is not what they bring
    EXPECT_EQ(TeamOracle(team).calls(), asked.candidate_count());
  }
  EXPECT_GT(gaining, 100);
}

// A teammate's fixed looks take from what a trajectory gains here, not from what it gains alone.
TEST(CandidateTrajectories, BringNothingWhereTeammatesAreFixed) {
  ReducedValueIteration search({20'000, 400'000, 16, 16, 4});
  int made = 0;
  int zeroed = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SearchProblem problem = test::random_problem(seed).problem;
    problem.world = nullptr;
    problem.field = nullptr;
    bool is_fixed = false;
    for (auto& of_target : problem.fixed_information) {
      for (models::PositionMatrix& M : of_target) {
        is_fixed = is_fixed || !M.isZero(0.0);
      }
    }
    for (const Candidate& of : candidate_trajectories(problem, {}, search, {1.0, 1.0, 0.3})) {
      EXPECT_EQ(of.mutual_nats.has_value(), !is_fixed);
      made += is_fixed ? 1 : 0;
    }
    // Teammates who see nothing fix nothing, whatever room there is for it.
    for (auto& of_target : problem.fixed_information) {
      for (models::PositionMatrix& M : of_target) {
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

// Mud from x = 3 m on; the six steps begin at 0, 2, 4, 6, 8 and 8 m.
TEST(EnergyUsed, PaysForControlsAndForTheRegionsThatConcernTheRobot) {
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

TEST(MakeCandidate, RefusesControlsThatAreNotThere) {
  const SearchProblem problem = open_problem(1);
  std::vector<int> controls(static_cast<std::size_t>(problem.horizon_steps), 0);
  controls.back() = static_cast<int>(problem.controls.size());
  EXPECT_THROW(make_candidate(problem, {}, controls), UsageError);
  controls.pop_back();
  EXPECT_THROW(make_candidate(problem, {}, controls), UsageError);
}

}  // namespace
}  // namespace vantage::planner
