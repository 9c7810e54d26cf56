#include "planner/decision/paths_bound.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/infinity.hpp"
#include "planner/decision/candidate.hpp"
#include "planner/decision/exhaustive.hpp"
#include "planner/decision/team_oracle.hpp"
#include "test/planner/problem/random_problem.hpp"
#include "test/planner/search/lattice_problem.hpp"

namespace vantage::planner {
namespace {

using test::pick;
using test::uniform;

/// As many as VANTAGE_BOUND_PROBLEMS says.
std::uint64_t team_count() {
  const char* const asked = std::getenv("VANTAGE_BOUND_PROBLEMS");
  return asked != nullptr ? std::stoull(asked) : 200;
}

/// Two or three robots, each with its own sensors and controls, about the same targets.
std::vector<SearchProblem> drawn_team(std::uint64_t seed) {
  std::mt19937_64 rng(0x9E3779B97F4A7C15U * (seed + 7));
  const int robots = pick(rng, 2, 3);
  std::vector<SearchProblem> team;
  for (int i = 0; i < robots; ++i) {
    team.push_back(test::lattice_problem(100'000 * static_cast<std::uint64_t>(i) + seed).problem);
    SearchProblem& own = team.back();
    own.targets = team.front().targets;
    own.fixed_information.clear();
    own.step_s = team.front().step_s;
    own.horizon_steps = robots == 2 ? 3 : 2;
    own.controls.resize(3);
  }
  return team;
}

/// Every sequence of each robot's controls.
TeamProblem every_path(const std::vector<SearchProblem>& team, InformationMeasure measure) {
  const SearchProblem& first = team.front();
  TeamProblem out{first.targets, first.horizon_steps, first.step_s, measure, {}};
  for (const SearchProblem& own : team) {
    out.candidates.emplace_back();
    const auto kinds = static_cast<int>(own.controls.size());
    const auto count = static_cast<int>(std::lround(std::pow(kinds, own.horizon_steps)));
    for (int code = 0; code < count; ++code) {
      std::vector<int> controls;
      for (int t = 0, left = code; t < own.horizon_steps; ++t, left /= kinds) {
        controls.push_back(left % kinds);
      }
      out.candidates.back().push_back(make_candidate(own, {}, controls));
    }
  }
  return out;
}

// The recursion from a millimetre takes eight digits away.
double slack(double value) { return 1e-5 * std::max(1.0, value); }

constexpr InformationMeasure kMeasures[] = {InformationMeasure::kMutual,
                                            InformationMeasure::kLogDet};
constexpr std::int64_t kNodes = 60'000;

TEST(PathsBound, IsAboveEveryChoiceOfPaths) {
  PathsBound bound(4, 5);
  int told = 0;
  double least = kInfinity;
  for (std::uint64_t seed = 0; seed < team_count(); ++seed) {
    SCOPED_TRACE(seed);
    const std::vector<SearchProblem> team = drawn_team(seed);
    std::vector<int> robots(team.size());
    std::iota(robots.begin(), robots.end(), 0);
    for (const InformationMeasure measure : kMeasures) {
      const TeamProblem problem = every_path(team, measure);
      const TeamOracle oracle(problem);
      const double best = exhaustive_optimum(oracle, robots).value;
      double before = kInfinity;
      for (const std::int64_t nodes : {kNodes / 4, kNodes}) {
        const auto answer = bound.of(team, robots, measure, Deadline::nodes(nodes));
        ASSERT_GE(answer.information_nats, best - slack(best));
        ASSERT_LE(answer.information_nats, before);  // more work, no worse
        before = answer.information_nats;
      }
      if (before < kInfinity) {
        ++told;
        least = std::min(least, (before - best) / std::max(1e-6, best));
      }
    }
  }
  EXPECT_GT(told, static_cast<int>(team_count()));
  EXPECT_LT(least, 0.05);  // somewhere it is as good as tight
}

TEST(PathsBound, OfSomeRobotsLeavesTheOthersOut) {
  PathsBound bound(4, 5);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const std::vector<SearchProblem> team = drawn_team(seed);
    const std::vector<int> none;
    EXPECT_EQ(
        bound.of(team, none, InformationMeasure::kMutual, Deadline::nodes(kNodes)).information_nats,
        0.0);
    const std::vector<SearchProblem> alone = {team[1]};
    for (const InformationMeasure measure : kMeasures) {
      EXPECT_EQ(
          bound.of(team, std::vector<int>{1}, measure, Deadline::nodes(kNodes)).information_nats,
          bound.of(alone, std::vector<int>{0}, measure, Deadline::nodes(kNodes)).information_nats);
    }
  }
}

TEST(PathsBound, UnderAttackIsAboveTheBestThatTheWorstAttackLeaves) {
  PathsBound bound(4, 5);
  for (std::uint64_t seed = 0; seed < team_count() / 4; ++seed) {
    SCOPED_TRACE(seed);
    const std::vector<SearchProblem> team = drawn_team(seed);
    for (const InformationMeasure measure : kMeasures) {
      const TeamProblem problem = every_path(team, measure);
      const TeamOracle oracle(problem);
      for (int attacks = 0; attacks < oracle.robot_count(); ++attacks) {
        const double best = exhaustive_max_min(oracle, attacks).value;
        const auto answer = bound.under_attack(team, attacks, measure, 2 * kNodes);
        ASSERT_GE(answer.information_nats, best - slack(best)) << attacks;
      }
      EXPECT_EQ(bound.under_attack(team, oracle.robot_count(), measure, kNodes).information_nats,
                0.0);
    }
  }
}

// A horizon that no lattice holds, and a deadline that never comes.
TEST(PathsBound, EndsWhereNoLatticeFits) {
  constexpr int kSteps = 44;
  PathsBound bound(4, kSteps);
  std::vector<SearchProblem> team = drawn_team(0);
  for (SearchProblem& own : team) {
    own.horizon_steps = kSteps;
  }
  EXPECT_EQ(bound.of(team, std::vector<int>{0, 1}, InformationMeasure::kLogDet, Deadline::never())
                .information_nats,
            kInfinity);
}

TEST(PathsBound, SaysNothingWhereItsRulesDoNotHold) {
  PathsBound bound(4, 5);
  std::vector<SearchProblem> team = drawn_team(0);
  team[1].controls[1].yaw_rate_radps *= std::sqrt(2.0);
  EXPECT_EQ(
      bound.of(team, std::vector<int>{0, 1}, InformationMeasure::kMutual, Deadline::nodes(kNodes))
          .information_nats,
      kInfinity);
}

}  // namespace
}  // namespace vantage::planner
