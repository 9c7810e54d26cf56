#include "experiments/mapping/mapping_attack.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "planner/decision/attack.hpp"
#include "planner/decision/resilient.hpp"

namespace vantage::experiments {
namespace {

std::vector<int> worst_robots(int attacks, const std::vector<planner::MapRoute>& routes,
                              planner::MappingSearch& search) {
  std::vector<const planner::MapRoute*> left;
  for (const planner::MapRoute& route : routes) {
    left.push_back(&route);
  }
  std::vector<int> attacked;
  for (int k = 0; k < attacks; ++k) {
    double least_nats = std::numeric_limits<double>::infinity();
    std::size_t worst = 0;
    for (std::size_t robot = 0; robot < left.size(); ++robot) {
      if (left[robot] == nullptr) {
        continue;
      }
      const planner::MapRoute* const lost = std::exchange(left[robot], nullptr);
      const double nats = search.value(left);
      left[robot] = lost;
      if (nats < least_nats) {
        least_nats = nats;
        worst = robot;
      }
    }
    left[worst] = nullptr;
    attacked.push_back(static_cast<int>(worst));
  }
  return attacked;
}

std::vector<int> best_alone_robots(int attacks, const std::vector<planner::MapRoute>& routes,
                                   planner::MappingSearch& search) {
  std::vector<double> values_nats;
  for (const planner::MapRoute& route : routes) {
    const planner::MapRoute* const alone = &route;
    values_nats.push_back(search.value({&alone, 1}));
  }
  return planner::bait_robots(values_nats, attacks);
}

}  // namespace

std::vector<int> attacked_robots(AttackKind kind, int attacks,
                                 const std::vector<planner::MapRoute>& routes,
                                 planner::MappingSearch& search, std::mt19937_64& random) {
  const int robots = static_cast<int>(routes.size());
  const int count = std::clamp(attacks, 0, robots);
  std::vector<int> attacked;
  if (kind == AttackKind::kRandom) {
    attacked = planner::random_attack(robots, count, random);
  } else if (kind == AttackKind::kWorstCase || kind == AttackKind::kPreviousPlans) {
    attacked = worst_robots(count, routes, search);
  } else if (kind == AttackKind::kBestAlone) {
    attacked = best_alone_robots(count, routes, search);
  }
  std::sort(attacked.begin(), attacked.end());
  return attacked;
}

}  // namespace vantage::experiments
