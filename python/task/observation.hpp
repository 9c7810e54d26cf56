#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "core/pose.hpp"
#include "models/world/world.hpp"

// Parts of an observation that both tasks share: the robot itself and its teammates.

namespace vantage::python {

/// Writer of an observation, entry by entry, each clamped to [−1, 1].
class ObservationWriter {
 public:
  explicit ObservationWriter(std::span<float> out) : out_(out) {}
  void add(double value) { out_[next_++] = static_cast<float>(std::clamp(value, -1.0, 1.0)); }

 private:
  std::span<float> out_;
  std::size_t next_ = 0;
};

inline constexpr int kSelfEntries = 5;
inline constexpr int kTeammateEntries = 4;

/// Appends the state of the robot: x, y relative to the world's centre in half side lengths, cos
/// and sin of the yaw, and 1 if jammed, otherwise 0. Then appends for each teammate: position in
/// the body frame in units of the world's diagonal, and cos and sin of the heading in the body
/// frame.
inline void add_team(ObservationWriter& out, const models::Rectangle& bounds,
                     const std::vector<Pose2>& poses, std::size_t robot, bool is_jammed) {
  const Eigen::Vector2d middle_m = 0.5 * (bounds.min_m + bounds.max_m);
  const Eigen::Vector2d half_m = 0.5 * (bounds.max_m - bounds.min_m);
  const Pose2& self = poses[robot];
  out.add((self.x_m - middle_m.x()) / half_m.x());
  out.add((self.y_m - middle_m.y()) / half_m.y());
  out.add(std::cos(self.yaw_rad));
  out.add(std::sin(self.yaw_rad));
  out.add(is_jammed ? 1.0 : 0.0);
  const double diagonal_m = 2.0 * half_m.norm();
  const Pose2 body_from_world = inverse(self);
  for (std::size_t other = 0; other < poses.size(); ++other) {
    if (other == robot) {
      continue;
    }
    const Pose2 body_from_other = body_from_world * poses[other];
    out.add(body_from_other.x_m / diagonal_m);
    out.add(body_from_other.y_m / diagonal_m);
    out.add(std::cos(body_from_other.yaw_rad));
    out.add(std::sin(body_from_other.yaw_rad));
  }
}

}  // namespace vantage::python
