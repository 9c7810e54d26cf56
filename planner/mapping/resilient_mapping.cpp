#include "planner/mapping/resilient_mapping.hpp"

#include <utility>

#include "core/index.hpp"
#include "planner/decision/resilient.hpp"

namespace vantage::planner {

std::vector<MapRoute> plan_mapping_resiliently(MappingSearch& search, std::span<const Pose2> starts,
                                               int attacks_max) {
  std::vector<MapRoute> routes(starts.size());
  const auto alone = [&](int robot) {
    routes[index(robot)] = search.plan(starts[index(robot)], {});
    return routes[index(robot)].gain_nats;
  };
  const auto together = [&](const std::vector<int>& robots) {
    std::vector<MapRoute> found = search.coordinate_descent(starts, robots);
    for (const int robot : robots) {
      found[index(robot)].nodes += routes[index(robot)].nodes;
      routes[index(robot)] = std::move(found[index(robot)]);
    }
  };
  plan_resiliently(static_cast<int>(starts.size()), attacks_max, alone, together);
  return routes;
}

}  // namespace vantage::planner
