#include "planner/problem/information_at.hpp"

namespace vantage::planner {

namespace {

// Calls add(sensor) for the sensors that see a target at `target_m`.
template <class Add>
void for_each_seeing(const models::World* world, std::span<const models::SensorModel> sensors,
                     const models::Viewpoint& from, const models::PositionVector& target_m,
                     const Add& add) {
  bool is_line_of_sight_checked = false;  // true: line of sight was checked (once for all sensors)
  for (const models::SensorModel& sensor : sensors) {
    if (!models::in_view(sensor, from, target_m)) {
      continue;
    }
    if (!is_line_of_sight_checked && world != nullptr &&
        !models::line_of_sight(*world, from.world_from_body.position_m(), target_m.head<2>())) {
      return;
    }
    is_line_of_sight_checked = true;
    add(sensor);
  }
}

}  // namespace

models::PositionMatrix information_at(const models::World* world,
                                      std::span<const models::SensorModel> sensors,
                                      const models::Viewpoint& from,
                                      const models::PositionVector& target_m) {
  const auto p = target_m.size();
  models::PositionMatrix M = models::PositionMatrix::Zero(p, p);
  for_each_seeing(world, sensors, from, target_m, [&](const models::SensorModel& sensor) {
    M += models::information(sensor, from, target_m);
  });
  return M;
}

models::StateMatrix state_information_at(const models::World* world,
                                         std::span<const models::SensorModel> sensors,
                                         const models::Viewpoint& from,
                                         const models::StateVector& target) {
  const auto n = target.size();
  models::StateMatrix M = models::StateMatrix::Zero(n, n);
  const models::PositionVector target_m = target.head(n == 3 ? 3 : 2);
  for_each_seeing(world, sensors, from, target_m, [&](const models::SensorModel& sensor) {
    M += models::state_information(sensor, from, target);
  });
  return M;
}

}  // namespace vantage::planner
