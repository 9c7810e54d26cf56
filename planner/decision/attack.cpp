#include "planner/decision/attack.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

#include "core/index.hpp"
#include "planner/decision/team_set.hpp"

namespace vantage::planner {
namespace {

bool has(const Choice& choice, int robot) { return choice[index(robot)] != kNoCandidate; }

// Calls of() for every set of exactly `count` robots of `choice`, with indices ≥ `from`, while that
// set is removed from `team`.
void for_each_removal(const Choice& choice, int from, int count, TeamSet& team,
                      std::vector<int>& removed, const std::function<void()>& of) {
  if (count == 0) {
    of();
    return;
  }
  for (int robot = from; robot < static_cast<int>(choice.size()); ++robot) {
    if (!has(choice, robot)) {
      continue;
    }
    team.drop(robot);
    removed.push_back(robot);
    for_each_removal(choice, robot + 1, count - 1, team, removed, of);
    removed.pop_back();
    team.add(choice[index(robot)]);
  }
}

}  // namespace

Attack worst_attack(const TeamOracle& oracle, const Choice& choice, int attacks_max) {
  TeamSet team(oracle);
  team.become(choice);
  Attack worst;
  worst.value = team.value();
  std::vector<int> removed;
  for (int count = 1; count <= attacks_max; ++count) {
    for_each_removal(choice, 0, count, team, removed, [&] {
      ++worst.oracle_calls;
      if (team.value() < worst.value) {
        worst.value = team.value();
        worst.robots = removed;
      }
    });
  }
  return worst;
}

Attack greedy_attack(const TeamOracle& oracle, const Choice& choice, int attacks_max) {
  TeamSet team(oracle);
  team.become(choice);
  Attack attack;
  for (int k = 0; k < attacks_max; ++k) {
    int hardest = -1;
    double least = team.value();
    for (int robot = 0; robot < oracle.robot_count(); ++robot) {
      if (!has(team.choice(), robot)) {
        continue;
      }
      const double value = team.value_without(robot);
      if (value < least) {
        least = value;
        hardest = robot;
      }
    }
    if (hardest < 0) {
      break;
    }
    team.drop(hardest);
    attack.robots.push_back(hardest);
  }
  std::sort(attack.robots.begin(), attack.robots.end());
  attack.value = team.value();
  attack.oracle_calls = team.calls();
  return attack;
}

Attack attack_on_best_alone(const TeamOracle& oracle, const Choice& choice, int attacks_max) {
  Attack attack;
  for (int robot = 0; robot < oracle.robot_count(); ++robot) {
    if (has(choice, robot)) {
      attack.robots.push_back(robot);
    }
  }
  std::ranges::stable_sort(attack.robots, std::ranges::greater{}, [&](int robot) {
    return oracle.individual_value(choice[index(robot)]);
  });
  const auto count = static_cast<std::size_t>(std::max(attacks_max, 0));
  attack.robots.resize(std::min(count, attack.robots.size()));
  std::ranges::sort(attack.robots);
  TeamSet team(oracle);
  team.become(choice);
  for (const int robot : attack.robots) {
    team.drop(robot);
  }
  attack.value = team.value();
  attack.oracle_calls = static_cast<std::int64_t>(attack.robots.size());
  return attack;
}

Attack attack_on_best_together(const TeamOracle& oracle, const Choice& choice, int attacks_max) {
  Attack attack;
  TeamSet taken(oracle);
  TeamSet team(oracle);
  team.become(choice);
  for (int k = 0; k < attacks_max; ++k) {
    int best = -1;
    double most = 0.0;
    for (int robot = 0; robot < oracle.robot_count(); ++robot) {
      if (!has(team.choice(), robot)) {
        continue;
      }
      const double value = taken.value_with(choice[index(robot)]);
      if (best < 0 || value > most) {
        most = value;
        best = robot;
      }
    }
    if (best < 0) {
      break;
    }
    taken.add(choice[index(best)]);
    team.drop(best);
    attack.robots.push_back(best);
  }
  std::ranges::sort(attack.robots);
  attack.value = team.value();
  attack.oracle_calls = taken.calls();
  return attack;
}

Attack attack_by(Attacker attacker, const TeamOracle& oracle, const Choice& choice,
                 int attacks_max) {
  switch (attacker) {
    case Attacker::kGreedy:
      return greedy_attack(oracle, choice, attacks_max);
    case Attacker::kBestAlone:
      return attack_on_best_alone(oracle, choice, attacks_max);
    case Attacker::kBestTogether:
      break;
  }
  return attack_on_best_together(oracle, choice, attacks_max);
}

std::vector<int> random_attack(int robot_count, int attacks, std::mt19937_64& rng) {
  std::vector<int> robots(static_cast<std::size_t>(robot_count));
  std::iota(robots.begin(), robots.end(), 0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(attacks); ++i) {
    // Rejection sampling: draws from a multiple of the number of remaining robots, so that all sets
    // are equally likely.
    const std::uint64_t left = robots.size() - i;
    const std::uint64_t fair = std::mt19937_64::max() - std::mt19937_64::max() % left;
    std::uint64_t draw = rng();
    while (draw >= fair) {
      draw = rng();
    }
    std::swap(robots[i], robots[i + draw % left]);
  }
  robots.resize(static_cast<std::size_t>(attacks));
  std::sort(robots.begin(), robots.end());
  return robots;
}

}  // namespace vantage::planner
