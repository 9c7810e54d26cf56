#include "planner/app/pose_fill.hpp"

#include <algorithm>
#include <chrono>

#include "core/pose.hpp"

namespace vantage::planner {

bool show_robot(const scenario::Scenario& scenario, const models::PoseEstimate& estimate,
                models::MocapFrame& frame) {
  const scenario::RobotSpec* const robot = scenario.find_robot(estimate.robot);
  const Duration since = frame.stamp.time - estimate.stamp.time;
  if (robot == nullptr || estimate.source == models::PoseSource::kNone ||
      estimate.increments.empty() || std::chrono::abs(since) > kPoseAgeMax) {
    return false;
  }
  auto body = std::find_if(frame.bodies.begin(), frame.bodies.end(),
                           [&](const auto& each) { return each.name == estimate.robot; });
  if (body != frame.bodies.end() && !body->occluded) {
    return false;
  }
  const double share = to_seconds(since) / to_seconds(estimate.increment);
  const Eigen::Vector3d motion = share * estimate.increments.back();
  const Pose2 world_from_body =
      estimate.world_from_body * Pose2{motion.x(), motion.y(), motion.z()};
  if (body == frame.bodies.end()) {
    frame.bodies.emplace_back().name = estimate.robot;
    body = std::prev(frame.bodies.end());
  }
  body->world_from_body = lift(world_from_body, robot->height_m);
  body->occluded = false;
  return true;
}

}  // namespace vantage::planner
