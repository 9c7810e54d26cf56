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

/// Returns the number of teams, from the environment variable VANTAGE_BOUND_PROBLEMS; default 200.
std::uint64_t team_count() {
  const char* const text = std::getenv("VANTAGE_BOUND_PROBLEMS");
  return text != nullptr ? std::stoull(text) : 200;
}

/// Returns problems of two or three robots with the same targets, each with its own sensors and
/// controls.
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

/// Returns the team problem in which the candidates of each robot are all its control sequences.
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

// Returns the tolerance: the recursion starts from a covariance so small that eight digits are
// lost.
double tolerance(double value) { return 1e-5 * std::max(1.0, value); }

constexpr InformationMeasure kMeasures[] = {InformationMeasure::kMutual,
                                            InformationMeasure::kLogDet};
constexpr std::int64_t kNodes = 60'000;

TEST(PathsBound, IsAnUpperBound) {
  PathsBound bound(4, 5);
  int bounded_count = 0;
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
        ASSERT_GE(answer.information_nats, best - tolerance(best));
        ASSERT_LE(answer.information_nats, before);  // more work never weakens the bound
        before = answer.information_nats;
      }
      if (before < kInfinity) {
        ++bounded_count;
        least = std::min(least, (before - best) / std::max(1e-6, best));
      }
    }
  }
  EXPECT_GT(bounded_count, static_cast<int>(team_count()));
  EXPECT_LT(least, 0.05);  // almost tight for at least one team
}

TEST(PathsBound, CountsOnlyGivenRobots) {
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

TEST(PathsBound, UnderAttackIsAnUpperBound) {
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
        ASSERT_GE(answer.information_nats, best - tolerance(best)) << attacks;
      }
      EXPECT_EQ(bound.under_attack(team, oracle.robot_count(), measure, kNodes).information_nats,
                0.0);
    }
  }
}

// The horizon exceeds the capacity of the lattice. The computation has no deadline.
TEST(PathsBound, EndsWithoutALattice) {
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

TEST(PathsBound, IsInfiniteForUnsupportedProblems) {
  PathsBound bound(4, 5);
  std::vector<SearchProblem> team = drawn_team(0);
  team[1].controls[1].yaw_rate_radps *= std::sqrt(2.0);
  EXPECT_EQ(
      bound.of(team, std::vector<int>{0, 1}, InformationMeasure::kMutual, Deadline::nodes(kNodes))
          .information_nats,
      kInfinity);
}

// ---- Teams in which all paths have the same measurements, so that the bound is known ----

/// Returns a robot that drives straight from `x_m`. In each step it measures all targets within 20
/// m with information 1 / σ².
SearchProblem observer_robot(double x_m, double sigma_m) {
  SearchProblem problem;
  problem.start = {x_m, 0.0, 0.0};
  problem.controls = {{0.1, 0.0}};
  problem.horizon_steps = 3;
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kPosition;
  sensor.position_sigma_m = sigma_m;
  sensor.range_max_m = 20.0;
  sensor.range_min_m = 1e-3;
  sensor.fov_rad = 2.0 * kPi;
  problem.sensors = {sensor};
  for (const double target_x_m : {5.0, 105.0}) {
    SearchTarget target{{models::TargetKind::kRandomWalk, 2, 0.0}, {}};
    target.prior.mean = Eigen::Vector2d(target_x_m, 5.0);
    target.prior.covariance = Eigen::Matrix2d::Identity();
    problem.targets.push_back(target);
  }
  return problem;
}

/// Returns the total information, nats, about a target of variance 1 m² with a measurement of
/// information `information` in each of three steps.
double known_nats(double information, InformationMeasure measure) {
  return measure == InformationMeasure::kMutual
             ? std::log(1.0 + 3.0 * information)
             : std::log(1.0 + information) + std::log(1.0 + 2.0 * information) +
                   std::log(1.0 + 3.0 * information);
}

// Returns a team in which the first and third robot see one target and the second robot the other.
std::vector<SearchProblem> observer_team() {
  return {observer_robot(0.0, 0.5), observer_robot(100.0, 1.0), observer_robot(1.0, 2.0)};
}

void expect_known(double is, double known) {
  EXPECT_GE(is, known);
  EXPECT_LE(is, known * (1.0 + 2e-3));
}

TEST(PathsBound, IsExactWhenAllPathsHaveTheSameMeasurements) {
  PathsBound bound(4, 5);
  std::vector<SearchProblem> team = observer_team();
  for (const InformationMeasure measure : kMeasures) {
    const auto of = [&](const std::vector<int>& robots) {
      return bound.of(team, robots, measure, Deadline::nodes(kNodes));
    };
    expect_known(of({0}).information_nats, known_nats(4.0, measure));
    expect_known(of({1}).information_nats, known_nats(1.0, measure));
    expect_known(of({2}).information_nats, known_nats(0.25, measure));
    expect_known(of({0, 2}).information_nats, known_nats(4.25, measure));
    const PathsBound::Answer all = of({0, 1, 2});
    expect_known(all.information_nats, known_nats(4.25, measure) + known_nats(1.0, measure));
    ASSERT_EQ(all.parts.size(), 3U);
    EXPECT_NEAR(all.parts[0], 16.0 * all.parts[2], 0.02 * all.parts[0])
        << "a sixteenth of the information";
    const PathsBound::Answer turned = of({2, 1, 0});
    EXPECT_NEAR(turned.information_nats, all.information_nats, 1e-3);
    EXPECT_NEAR(turned.parts[0], all.parts[2], 1e-3 * all.parts[0]);
    // Fixed information must not change the bound of the team.
    for (std::size_t robot = 0; robot < team.size(); ++robot) {
      team[robot].fixed_information.assign(
          2, std::vector<models::StateMatrix>(3, models::PositionMatrix::Identity(2, 2)));
      EXPECT_EQ(of({0, 1, 2}).information_nats, all.information_nats) << robot;
    }
    team = observer_team();
  }
}

TEST(PathsBound, UnderAttackExcludesBestRobots) {
  PathsBound bound(4, 5);
  const std::vector<SearchProblem> team = observer_team();
  for (const InformationMeasure measure : kMeasures) {
    const auto left = [&](int attacks) {
      return bound.under_attack(team, attacks, measure, 2 * kNodes);
    };
    for (const int none : {-1, 0}) {
      expect_known(left(none).information_nats,
                   known_nats(4.25, measure) + known_nats(1.0, measure));
    }
    EXPECT_EQ(left(0).parts.size(), 3U);
    // The robot with the largest part of the bound is attacked, so the information that only this
    // robot can gather is lost.
    const std::vector<double> parts =
        bound.of(team, std::vector<int>{0, 1, 2}, measure, Deadline::nodes(kNodes)).parts;
    const bool is_first = parts[0] > parts[1];
    expect_known(left(1).information_nats,
                 is_first ? known_nats(0.25, measure) + known_nats(1.0, measure)
                          : known_nats(4.25, measure));
    EXPECT_EQ(left(1).parts.size(), 2U);
    expect_known(left(2).information_nats, known_nats(0.25, measure));
    EXPECT_EQ(left(2).parts.size(), 1U);
    EXPECT_EQ(left(3).information_nats, 0.0);
    EXPECT_EQ(left(9).information_nats, 0.0);
    EXPECT_TRUE(left(3).parts.empty());
    // Half of the work determines the attacked robots, half the bound of the others.
    EXPECT_GE(left(1).work_nodes, 2 * kNodes);
    EXPECT_LE(left(1).work_nodes, 3 * kNodes);
    EXPECT_GE(left(3).work_nodes, kNodes);
    EXPECT_LE(left(3).work_nodes, 3 * kNodes / 2);
  }
}

TEST(PathsBound, IsInfiniteWithABudgetOfZeroNodes) {
  PathsBound bound(4, 5);
  const std::vector<SearchProblem> team = observer_team();
  const auto answer =
      bound.of(team, std::vector<int>{0, 1}, InformationMeasure::kMutual, Deadline::nodes(0));
  EXPECT_EQ(answer.information_nats, kInfinity);
  EXPECT_EQ(answer.parts, (std::vector<double>{kInfinity, kInfinity}));
}

}  // namespace
}  // namespace vantage::planner
