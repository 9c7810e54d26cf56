#include "sim/localisation/mocap_outage.hpp"

#include <algorithm>
#include <utility>

namespace vantage::sim {
namespace {

constexpr double kHeightToleranceM = 0.2;  // m; a robot this far below its height has not taken off

bool contains(const models::Rectangle& area, const Eigen::Vector2d& p_m) {
  return (p_m.array() >= area.min_m.array()).all() && (p_m.array() <= area.max_m.array()).all();
}

}  // namespace

MocapOutage::MocapOutage(std::vector<scenario::MocapOutageSpec> outages,
                         const std::vector<scenario::RobotSpec>& robots, Time start)
    : outages_(std::move(outages)), robots_(robots), start_(start) {}

void MocapOutage::update(const models::TruthFrame& truth) {
  if (taken_off_) {
    return;
  }
  const bool all_high = std::all_of(robots_.begin(), robots_.end(), [&](const auto& robot) {
    const auto body = std::find_if(truth.bodies.begin(), truth.bodies.end(),
                                   [&](const auto& each) { return each.name == robot.name; });
    return robot.rover || (body != truth.bodies.end() && body->world_from_body.translation_m.z() >=
                                                             robot.height_m - kHeightToleranceM);
  });
  if (all_high) {
    taken_off_ = truth.stamp.time;
  }
}

bool MocapOutage::hides(const Eigen::Vector2d& position_m, Time time) const {
  return std::any_of(outages_.begin(), outages_.end(), [&](const auto& outage) {
    if (outage.after_take_off && !taken_off_) {
      return false;
    }
    const double since_s = to_seconds(time - (outage.after_take_off ? *taken_off_ : start_));
    return since_s >= outage.from_s && since_s < outage.to_s &&
           (!outage.area || contains(*outage.area, position_m));
  });
}

void MocapOutage::hide(models::MocapFrame& frame, const models::TruthFrame& truth) const {
  for (std::size_t i = 0; i < frame.bodies.size() && i < truth.bodies.size(); ++i) {
    if (hides(truth.bodies[i].world_from_body.translation_m.head<2>(), frame.stamp.time)) {
      frame.bodies[i].occluded = true;
    }
  }
}

}  // namespace vantage::sim
