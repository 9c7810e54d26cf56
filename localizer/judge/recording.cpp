#include "localizer/judge/recording.hpp"

#include <algorithm>

#include "core/angle.hpp"

namespace vantage::localizer {

void TruePath::add(Time time, const Pose2& world_from_body) {
  if (times_.empty() || time > times_.back()) {
    times_.push_back(time);
    poses_.push_back(world_from_body);
  }
}

std::optional<Pose2> TruePath::at(Time time) const {
  constexpr Duration kGapMax = std::chrono::milliseconds(200);
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  if (after == times_.begin()) {
    return std::nullopt;
  }
  const auto index = static_cast<std::size_t>(after - times_.begin());
  const Pose2& from = poses_[index - 1];
  if (times_[index - 1] == time) {
    return from;
  }
  if (after == times_.end() || *after - times_[index - 1] >= kGapMax) {
    return std::nullopt;
  }
  const Pose2& to = poses_[index];
  const double share =
      to_seconds(time - times_[index - 1]) / to_seconds(*after - times_[index - 1]);
  return Pose2{from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m),
               wrap_to_pi(from.yaw_rad + share * wrap_to_pi(to.yaw_rad - from.yaw_rad))};
}

}  // namespace vantage::localizer
