#include "planner/problem/information_at.hpp"

namespace vantage::planner {

models::PositionMatrix information_at(const models::World* world,
                                      std::span<const models::SensorModel> sensors,
                                      const models::Viewpoint& from,
                                      const models::PositionVector& target_m) {
  const auto p = target_m.size();
  models::PositionMatrix M = models::PositionMatrix::Zero(p, p);
  bool is_line_of_sight_checked = false;  // true: line of sight was checked (once for all sensors)
  for (const models::SensorModel& sensor : sensors) {
    if (!models::in_view(sensor, from, target_m)) {
      continue;
    }
    if (!is_line_of_sight_checked && world != nullptr &&
        !models::line_of_sight(*world, from.world_from_body.position_m(), target_m.head<2>())) {
      return M;
    }
    is_line_of_sight_checked = true;
    M += models::information(sensor, from, target_m);
  }
  return M;
}

}  // namespace vantage::planner
