#include "planner/decision/team_set.hpp"

#include <limits>
#include <random>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/planner/decision/team_instance.hpp"
#include "test/planner/problem/random_problem.hpp"

namespace vantage::planner {
namespace {

using test::plain_value;

/// Calls look() for the instances of both measures.
template <class Look>
void for_each_instance(std::uint64_t count, const test::InstanceLimits& limits, const Look& look) {
  for (const InformationMeasure measure :
       {InformationMeasure::kMutual, InformationMeasure::kLogDet}) {
    test::for_each_instance(count, limits, measure, look);
  }
}

TEST(TeamSet, ValueEqualsPlainRecursionAfterAdditionsAndDeletions) {
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

TEST(TeamSet, GainEqualsInformationOfUnionEvenIfRobotHasACandidate) {
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

TEST(TeamSet, ValueIsBitIdenticalForAnyOrderOfChanges) {
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

TEST(TeamSet, CountsOneCallPerComputedValue) {
  const TeamProblem problem = test::random_instance(1, {4, 4, 1.0}, InformationMeasure::kMutual);
  const TeamOracle oracle(problem);
  TeamSet team(oracle);
  for (CandidateId id = 0; id < oracle.candidate_count(); ++id) {
    EXPECT_EQ(team.value_with(id), oracle.individual_value(id));
  }
  team.add(0);
  team.value_without(oracle.robot_of(0));
  team.drop(oracle.robot_of(0));
  EXPECT_EQ(team.calls(), oracle.candidate_count() + 1);
}

// I(S ∪ {a}) − I(S) never grows with S. Lazy searches and all guarantees require this property.
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

// Two measurements of variance v² of a static target of variance s² give ½ log(1 + s²(1/v² + 1/v²))
// nats for each of the two coordinates.
TEST(MutualInformation, EqualsClosedFormForStaticTarget) {
  TeamProblem problem;
  problem.horizon_steps = 3;
  const double variance_m2 = 4.0;
  const double information = 25.0;
  problem.targets.push_back(
      {{models::TargetKind::kStatic, 2, 0.0},
       {models::StateVector::Zero(2), variance_m2 * models::StateMatrix::Identity(2, 2)}});
  Candidate candidate;
  candidate.measurements = {{0, 2, {{information, 0.0, information}}}};
  problem.candidates = {{candidate}, {candidate}};
  const TeamOracle oracle(problem);
  EXPECT_NEAR(oracle.individual_value(0), std::log(1.0 + variance_m2 * information), 1e-12);
  TeamSet team(oracle);
  team.add(0);
  team.add(1);
  EXPECT_NEAR(team.value(), std::log(1.0 + 2.0 * variance_m2 * information), 1e-12);
}

TEST(TeamOracle, RefusesUnsortedOrOutOfRangeMeasurements) {
  TeamProblem problem = test::random_instance(2, {2, 2, 0.0}, {});
  const auto target = problem.targets.front();
  problem.targets.assign(2, target);
  problem.horizon_steps = 3;
  const auto takes = [&](std::vector<PredictedMeasurement> measurements) {
    problem.candidates = {
        {}, {Candidate{{}, {}, {}, 0.0}, Candidate{{}, {}, std::move(measurements), 0.0}}};
    try {
      const TeamOracle oracle(problem);
      return true;
    } catch (const UsageError&) {
      return false;
    }
  };
  EXPECT_TRUE(takes({{0, 1, {}}, {0, 3, {}}, {1, 1, {}}, {1, 3, {}}}));
  EXPECT_FALSE(takes({{2, 1, {}}}));
  EXPECT_FALSE(takes({{0, 0, {}}}));
  EXPECT_FALSE(takes({{0, 4, {}}}));
  EXPECT_FALSE(takes({{0, 1, {}}, {0, 1, {}}}));
  EXPECT_FALSE(takes({{0, 2, {}}, {0, 1, {}}}));
  EXPECT_FALSE(takes({{1, 1, {}}, {0, 2, {}}}));
  EXPECT_FALSE(takes({{0, 1, {}}, {1, 1, {}}, {0, 2, {}}}));
}

TEST(TeamOracle, RefusesNegativeOrInfiniteCostsAndGains) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto takes = [](auto&& set) {
    TeamProblem problem = test::random_instance(2, {2, 2, 0.0}, {});
    set(problem.candidates[0].back());
    try {
      const TeamOracle oracle(problem);
      return true;
    } catch (const UsageError&) {
      return false;
    }
  };
  for (const auto& [nats, is_taken] :
       {std::pair(0.0, true), std::pair(1e6, true), std::pair(-1e-12, false),
        std::pair(kInf, false), std::pair(kNan, false)}) {
    const double value = nats;
    EXPECT_EQ(takes([&](Candidate& c) { c.energy_cost = value; }), is_taken) << nats;
    EXPECT_EQ(takes([&](Candidate& c) { c.unshared_nats = value; }), is_taken) << nats;
  }
  // A supplied gain may be slightly below zero through rounding.
  for (const auto& [nats, is_taken] :
       {std::pair(0.0, true), std::pair(-0.9e-9, true), std::pair(-1.1e-9, false),
        std::pair(kInf, false), std::pair(kNan, false)}) {
    const double value = nats;
    EXPECT_EQ(takes([&](Candidate& c) { c.mutual_nats = value; }), is_taken) << nats;
  }
}

// Candidates are numbered robot by robot. The value of each is its information plus its unshared
// information minus its cost. The ranking is by value, then by number.
TEST(TeamOracle, RanksCandidatesByStandAloneValue) {
  const auto check = [](std::uint64_t seed, TeamProblem problem) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    double offset = 0.0;
    std::int64_t unknown = 0;
    for (auto& of_robot : problem.candidates) {
      double dearest = 0.0;
      for (Candidate& candidate : of_robot) {
        candidate.unshared_nats = test::pick(rng, 0, 1) * test::uniform(rng, 0.0, 2.0);
        if (test::pick(rng, 0, 2) == 0) {
          candidate.mutual_nats = test::uniform(rng, 0.0, 5.0);  // used unchecked by the oracle
        }
        const bool is_known =
            candidate.mutual_nats && problem.measure == InformationMeasure::kMutual;
        unknown += is_known ? 0 : 1;
        dearest = std::max(dearest, candidate.energy_cost);
      }
      offset += dearest;
    }
    const TeamOracle oracle(problem);
    EXPECT_NEAR(oracle.offset(), offset, 1e-12);
    EXPECT_EQ(oracle.calls(), unknown);
    EXPECT_EQ(oracle.target_count(), std::ssize(problem.targets));
    EXPECT_EQ(oracle.is_submodular(), problem.measure == InformationMeasure::kMutual);
    CandidateId id = 0;
    for (int robot = 0; robot < oracle.robot_count(); ++robot) {
      EXPECT_EQ(oracle.begin(robot), id);
      for (const Candidate& candidate : problem.candidates[static_cast<std::size_t>(robot)]) {
        EXPECT_EQ(&oracle.candidate(id), &candidate);
        EXPECT_EQ(oracle.robot_of(id), robot);
        const double information = candidate.mutual_nats && oracle.is_submodular()
                                       ? *candidate.mutual_nats
                                       : plain_value(problem, {&candidate}) + candidate.energy_cost;
        EXPECT_NEAR(oracle.individual_value(id),
                    information + candidate.unshared_nats - candidate.energy_cost, 1e-9);
        ++id;
      }
      EXPECT_EQ(oracle.end(robot), id);
      const auto ranked = oracle.by_value(robot);
      ASSERT_EQ(std::ssize(ranked), oracle.end(robot) - oracle.begin(robot));
      EXPECT_EQ(std::set<CandidateId>(ranked.begin(), ranked.end()).size(), ranked.size());
      for (std::size_t i = 0; i < ranked.size(); ++i) {
        EXPECT_EQ(oracle.robot_of(ranked[i]), robot);
        if (i > 0) {
          EXPECT_LT(std::pair(-oracle.individual_value(ranked[i - 1]), ranked[i - 1]),
                    std::pair(-oracle.individual_value(ranked[i]), ranked[i]));
        }
      }
    }
    EXPECT_EQ(oracle.candidate_count(), id);
  };
  for (const InformationMeasure measure :
       {InformationMeasure::kMutual, InformationMeasure::kLogDet}) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      check(seed, test::random_instance(seed, {4, 5, 1.0}, measure));
    }
  }
}

}  // namespace
}  // namespace vantage::planner
