#include "planner/mapping/resilient_mapping.hpp"

#include <algorithm>
#include <utility>

#include "planner/decision/resilient.hpp"

namespace vantage::planner {

std::vector<MapRoute> plan_mapping_resiliently(MappingSearch& search, std::span<const Pose2> starts,
                                               int attacks_max) {
  std::vector<MapRoute> routes;
  std::vector<double> values_alone;
  if (attacks_max > 0) {
    for (const Pose2& start : starts) {
      routes.push_back(search.plan(start, {}));
      values_alone.push_back(routes.back().gain_nats);
    }
  } else {
    routes.resize(starts.size());
    values_alone.resize(starts.size());
  }
  const std::vector<int> bait = bait_robots(values_alone, attacks_max);
  std::vector<int> rest;
  for (int robot = 0; robot < static_cast<int>(starts.size()); ++robot) {
    if (!std::binary_search(bait.begin(), bait.end(), robot)) {
      rest.push_back(robot);
    }
  }
  std::vector<MapRoute> together = search.coordinate_descent(starts, rest);
  for (const int robot : rest) {
    MapRoute& route = routes[static_cast<std::size_t>(robot)];
    const std::int64_t alone = route.nodes;
    route = std::move(together[static_cast<std::size_t>(robot)]);
    route.nodes += alone;
  }
  return routes;
}

}  // namespace vantage::planner
