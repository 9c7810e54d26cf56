#include "planner/decision/team_set.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/planner/decision/team_instance.hpp"
#include "test/planner/problem/random_problem.hpp"

namespace vantage::planner {
namespace {

using test::plain_value;

/// The same of both measures.
template <class Look>
void for_each_instance(std::uint64_t count, const test::InstanceLimits& limits, const Look& look) {
  for (const InformationMeasure measure :
       {InformationMeasure::kMutual, InformationMeasure::kLogDet}) {
    test::for_each_instance(count, limits, measure, look);
  }
}

TEST(TeamSet, IsWorthWhatThePlainRecursionSaysWhateverWasAddedAndDropped) {
  const auto check = [](std::uint64_t seed, const TeamProblem& problem, const TeamOracle& oracle) {
    TeamSet team(oracle);
    std::mt19937_64 rng(seed);
    for (int i = 0; i < 40 && oracle.candidate_count() > 0; ++i) {
      const CandidateId id = test::pick(rng, 0, oracle.candidate_count() - 1);
      const int robot = oracle.robot_of(id);
      if (team.choice()[static_cast<std::size_t>(robot)] == kNoCandidate) {
        const double foretold = team.value_with(id);
        team.add(id);
        EXPECT_EQ(team.value(), foretold);
      } else {
        const double foretold = team.value_without(robot);
        team.drop(robot);
        EXPECT_EQ(team.value(), foretold);
      }
      ASSERT_NEAR(team.value(), plain_value(problem, test::chosen_of(oracle, team.choice())), 1e-9)
          << "seed " << seed << " change " << i;
    }
  };
  for_each_instance(300, {6, 5, 1.0}, check);
}

TEST(TeamSet, GainsWhatTheUnionTellsAlsoWhereTheRobotHasAnother) {
  const auto check = [](std::uint64_t seed, const TeamProblem& problem, const TeamOracle& oracle) {
    TeamSet team(oracle);
    team.become(test::random_choice(oracle, seed));
    auto chosen = test::chosen_of(oracle, team.choice());
    const double before = plain_value(problem, chosen);
    for (CandidateId id = 0; id < oracle.candidate_count(); ++id) {
      chosen.push_back(&oracle.candidate(id));
      const double cost = oracle.candidate(id).energy_cost;
      EXPECT_NEAR(team.information_gain(id), plain_value(problem, chosen) + cost - before, 1e-9);
      chosen.pop_back();
    }
  };
  for_each_instance(200, {4, 5, 1.0}, check);
}

TEST(TeamSet, IsWorthTheSameToTheBitWhicheverWayItCameAbout) {
  const auto check = [](std::uint64_t seed, const TeamProblem&, const TeamOracle& oracle) {
    TeamSet wanders(oracle);
    for (std::uint64_t i = 0; i < 10; ++i) {
      const Choice choice = test::random_choice(oracle, 100 * seed + i);
      wanders.become(choice);
      TeamSet backwards(oracle);
      for (int robot = oracle.robot_count() - 1; robot >= 0; --robot) {
        if (choice[static_cast<std::size_t>(robot)] != kNoCandidate) {
          backwards.add(choice[static_cast<std::size_t>(robot)]);
        }
      }
      EXPECT_EQ(wanders.choice(), choice);
      EXPECT_EQ(wanders.value(), backwards.value());
      EXPECT_EQ(wanders.information(), backwards.information());
    }
  };
  for_each_instance(300, {6, 5, 1.0}, check);
}

TEST(TeamSet, CountsOneCallForEachValueThatIsAskedFor) {
  const TeamProblem problem = test::random_instance(1, {4, 4, 1.0}, InformationMeasure::kMutual);
  const TeamOracle oracle(problem);
  TeamSet team(oracle);
  for (CandidateId id = 0; id < oracle.candidate_count(); ++id) {
    EXPECT_EQ(team.value_with(id), oracle.alone(id));
  }
  team.add(0);
  team.value_without(oracle.robot_of(0));
  team.drop(oracle.robot_of(0));
  EXPECT_EQ(team.calls(), oracle.candidate_count() + 1);
}

// I(S ∪ {a}) − I(S) never grows with S, which lazy searches and all guarantees rest on.
TEST(MutualInformation, NeverGainsMoreFromALargerSet) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const TeamProblem problem = test::random_instance(seed, {5, 3, 0.0}, {});
    const TeamOracle oracle(problem);
    TeamSet small(oracle);
    TeamSet large(oracle);
    const Choice choice = test::random_choice(oracle, seed);
    std::mt19937_64 rng(seed);
    for (const CandidateId id : choice) {
      if (id != kNoCandidate) {
        large.add(id);
        if (test::pick(rng, 0, 1) == 0) {
          small.add(id);
        }
      }
    }
    for (CandidateId id = 0; id < oracle.candidate_count(); ++id) {
      if (choice[static_cast<std::size_t>(oracle.robot_of(id))] == kNoCandidate) {
        const double gain_of_large = large.value_with(id) - large.value();
        EXPECT_GE(small.value_with(id) - small.value(), gain_of_large - 1e-10);
        EXPECT_GE(gain_of_large, -1e-10);
      }
    }
  }
}

// Two looks at a still target of variance s² by sensors of variance v²: ½ log(1 + s²(1/v² + 1/v²))
// in each of both coordinates.
TEST(MutualInformation, OfAStillTargetIsTheClosedForm) {
  TeamProblem problem;
  problem.horizon_steps = 3;
  const double variance_m2 = 4.0;
  const double information = 25.0;
  problem.targets.push_back(
      {{models::TargetKind::kStatic, 2, 0.0},
       {models::StateVector::Zero(2), variance_m2 * models::StateMatrix::Identity(2, 2)}});
  Candidate candidate;
  candidate.looks = {{0, 2, {{information, 0.0, information}}}};
  problem.candidates = {{candidate}, {candidate}};
  const TeamOracle oracle(problem);
  EXPECT_NEAR(oracle.alone(0), std::log(1.0 + variance_m2 * information), 1e-12);
  TeamSet team(oracle);
  team.add(0);
  team.add(1);
  EXPECT_NEAR(team.value(), std::log(1.0 + 2.0 * variance_m2 * information), 1e-12);
}

TEST(TeamOracle, RefusesLooksThatAreOutOfOrderOrRange) {
  TeamProblem problem = test::random_instance(2, {2, 2, 0.0}, {});
  const auto refuses = [&](std::vector<Look> looks, double cost) {
    problem.candidates = {{Candidate{{}, {}, std::move(looks), cost}}};
    EXPECT_THROW(TeamOracle{problem}, UsageError);
  };
  refuses({{99, 1, {}}}, 0.0);
  refuses({{0, 0, {}}}, 0.0);
  refuses({{0, static_cast<std::uint16_t>(problem.horizon_steps + 1), {}}}, 0.0);
  refuses({{0, 1, {}}, {0, 1, {}}}, 0.0);
  refuses({}, -1.0);
}

TEST(TeamOracle, RefusesAGainBroughtAlongThatIsNone) {
  for (const double nats :
       {-1e-3, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    TeamProblem problem = test::random_instance(2, {2, 2, 0.0}, {});
    problem.candidates[0][0].mutual_nats = nats;
    EXPECT_THROW(TeamOracle{problem}, UsageError);
  }
}

}  // namespace
}  // namespace vantage::planner
