#include "models/exchange/onboard_pose.hpp"

#include <algorithm>

namespace vantage::models {

OnboardPose::OnboardPose(const Pose2& start, Time time) : world_from_odom_(start) {
  samples_[0].time = time;
}

void OnboardPose::move(Time time, const Eigen::Vector3d& displacement) {
  const Pose2 odom_from_body =
      newest().odom_from_body * Pose2{displacement.x(), displacement.y(), displacement.z()};
  const double passed_s = to_seconds(time - newest().time);
  rate_per_s_ = passed_s > 0.0 ? Eigen::Vector3d(displacement / passed_s) : Eigen::Vector3d::Zero();
  newest_ = (newest_ + 1) % kSamples;
  samples_[newest_] = {time, odom_from_body};
}

Pose2 OnboardPose::at(Time time) const {
  const Duration ahead = std::clamp(time - newest().time, Duration{0}, kExtrapolationMax);
  const Eigen::Vector3d motion = rate_per_s_ * to_seconds(ahead);
  return world_from_body() * Pose2{motion.x(), motion.y(), motion.z()};
}

void OnboardPose::correct(const PoseEstimate& estimate) {
  if (estimate.source == PoseSource::kNone) {
    return;
  }
  // Find the newest sample that is not later than the estimate.
  for (std::size_t back = 0; back < kSamples; ++back) {
    const Sample& sample = samples_[(newest_ + kSamples - back) % kSamples];
    if (sample.time == Time::min()) {
      return;
    }
    if (sample.time <= estimate.stamp.time) {
      world_from_odom_ = estimate.world_from_body * inverse(sample.odom_from_body);
      return;
    }
  }
}

}  // namespace vantage::models
