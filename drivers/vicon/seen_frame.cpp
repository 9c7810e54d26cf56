#include "drivers/vicon/seen_frame.hpp"

#include <algorithm>

#include "wire/vicon/rotation.hpp"

namespace vantage::drivers::vicon {
namespace {

/// m; larger positions are invalid, or millimetres mistaken for metres.
constexpr double kRoomMax_m = 500.0;

}  // namespace

SeenBody& SeenFrame::add() {
  if (size_ == bodies_.size()) {
    bodies_.emplace_back();
  }
  return bodies_[size_++];
}

bool SeenFrame::has(std::string_view name) const {
  const auto all = bodies();
  return std::any_of(all.begin(), all.end(),
                     [&](const SeenBody& body) { return body.name == name; });
}

void set_pose(SeenBody& body, const Eigen::Vector3d& position_m,
              const std::optional<Quaternion>& rotation, bool is_zero, bool is_y_up) {
  if (is_zero) {
    body.pose_state = PoseState::kZero;
    return;
  }
  if (!rotation || !(position_m.cwiseAbs().maxCoeff() <= kRoomMax_m) || !position_m.allFinite()) {
    body.pose_state = PoseState::kNotAPose;
    return;
  }
  body.pose_state = PoseState::kSeen;
  body.world_from_body = {position_m, *rotation};
  if (is_y_up) {
    body.world_from_body = wire::vicon::z_up_from_y_up(body.world_from_body);
  }
}

}  // namespace vantage::drivers::vicon
