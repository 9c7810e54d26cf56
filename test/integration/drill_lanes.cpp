#include "test/integration/drill_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace vantage::test {

DrillLanes::DrillLanes(const std::vector<std::string>& kinds, int times, std::uint64_t seed)
    : rng_(seed) {
  for (const std::string& kind : kinds) {
    left_[kind] = times;
  }
}

void DrillLanes::on_status(const models::VehicleStatus& status) {
  Lane& lane = lanes_[status.robot];
  if (lane.status) {
    const double lasted_s = to_seconds(status.stamp.time - lane.status->stamp.time);
    const double way_m = std::hypot(status.setpoint.x_m - lane.status->setpoint.x_m,
                                    status.setpoint.y_m - lane.status->setpoint.y_m);
    lane.asked_mps = lasted_s > 0.0 ? way_m / lasted_s : 0.0;
  }
  lane.status = status;
}

std::optional<DrillLanes::Event> DrillLanes::due(Time now) {
  for (auto& [robot, lane] : lanes_) {
    if (!lane.status || lane.status->state != models::FlightState::kFollow) {
      lane.ready.reset();
      continue;
    }
    if (!lane.ready) {
      lane.ready = now + from_seconds(std::uniform_real_distribution<double>(1.5, 4.0)(rng_));
    }
    const auto most =
        std::max_element(left_.begin(), left_.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    if (now >= *lane.ready && lane.asked_mps > kMovingMps && most != left_.end() &&
        most->second > 0) {
      lane.ready = now + from_seconds(std::uniform_real_distribution<double>(3.0, 5.0)(rng_));
      return Event{most->first, robot};
    }
  }
  return std::nullopt;
}

void DrillLanes::happened(const Event& event) { --left_[event.what]; }

int DrillLanes::left() const {
  return std::accumulate(left_.begin(), left_.end(), 0,
                         [](int sum, const auto& each) { return sum + each.second; });
}

}  // namespace vantage::test
