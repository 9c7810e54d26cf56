#include "logs/metrics/pose_means.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/angle.hpp"

namespace vantage::logs {
namespace {

constexpr Duration kMemory = std::chrono::seconds(2);

}  // namespace

void PoseSums::on_truth(const models::TruthFrame& frame) {
  if (!frames_.empty() && frame.stamp.time <= frames_.back().time) {
    return;
  }
  Frame& added = frames_.emplace_back();
  added.time = frame.stamp.time;
  for (const models::TruthBody& body : frame.bodies) {
    if (body.target_id < 0) {
      added.robots[body.name] = flatten(body.world_from_body);
    }
  }
  while (frames_.front().time + kMemory < added.time) {
    frames_.pop_front();
  }
}

std::optional<Pose2> PoseSums::truth_of(const std::string& robot, Time time) const {
  const auto after = std::find_if(frames_.begin(), frames_.end(),
                                  [time](const Frame& frame) { return frame.time >= time; });
  if (after == frames_.end() || (after == frames_.begin() && after->time != time)) {
    return std::nullopt;
  }
  const auto there = after->robots.find(robot);
  if (there == after->robots.end() || after->time == time) {
    return there == after->robots.end() ? std::nullopt : std::optional(there->second);
  }
  const Frame& before = *std::prev(after);
  const auto here = before.robots.find(robot);
  if (here == before.robots.end()) {
    return std::nullopt;
  }
  const double share = to_seconds(time - before.time) / to_seconds(after->time - before.time);
  const Pose2& a = here->second;
  const Pose2& b = there->second;
  return Pose2{a.x_m + share * (b.x_m - a.x_m), a.y_m + share * (b.y_m - a.y_m),
               wrap_to_pi(a.yaw_rad + share * wrap_to_pi(b.yaw_rad - a.yaw_rad))};
}

void PoseSums::on_pose(const models::PoseEstimate& estimate) {
  if (estimate.source == models::PoseSource::kNone) {
    ++unknown_;
  }
  if (estimate.source != models::PoseSource::kLocalizer) {
    return;
  }
  const auto truth = truth_of(estimate.robot, estimate.stamp.time);
  if (!truth) {
    return;
  }
  const Eigen::Vector2d error_m = estimate.world_from_body.position_m() - truth->position_m();
  const double turn_rad = wrap_to_pi(estimate.world_from_body.yaw_rad - truth->yaw_rad);
  const Eigen::Matrix2d covariance = estimate.covariance.topLeftCorner<2, 2>();
  ++samples_;
  squared_m2_ += error_m.squaredNorm();
  squared_rad2_ += turn_rad * turn_rad;
  max_m_ = std::max(max_m_, error_m.norm());
  nees_ += error_m.dot(covariance.inverse() * error_m);
}

PoseMeans PoseSums::means() const {
  PoseMeans out;
  out.samples = samples_;
  out.unknown = unknown_;
  if (samples_ > 0) {
    const auto n = static_cast<double>(samples_);
    out.rmse_m = std::sqrt(squared_m2_ / n);
    out.heading_rmse_rad = std::sqrt(squared_rad2_ / n);
    out.error_max_m = max_m_;
    out.position_nees = nees_ / n;
  }
  return out;
}

}  // namespace vantage::logs
