#include "sim/quadrotor/course.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::sim {
namespace {

// Time for which past legs are kept: the controller reads slightly earlier course points to smooth
// corners.
constexpr Duration kMemory{1'000'000};

}  // namespace

Course::Course(Time start, const Pose2& hover, double height_m)
    : legs_{Leg{models::Trajectory{start, hover, height_m, {}}, -1, {}}} {}

const Course::Leg& Course::leg(Time time) const {
  const auto later = std::upper_bound(
      legs_.begin() + 1, legs_.end(), time,
      [](Time t, const Leg& candidate) { return t < candidate.trajectory.start_time; });
  return *(later - 1);
}

CoursePoint Course::at(Time time) const {
  const Leg& current = leg(time);
  const models::TrajectoryPoint point = models::at(current.trajectory, time);
  CoursePoint out;
  out.world_from_body = point.world_from_body;
  const double yaw_rad = point.world_from_body.yaw_rad;
  out.velocity_world_mps =
      point.control.speed_mps * Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
  out.yaw_rate_radps = point.control.yaw_rate_radps;
  if (current.heading_rad) {
    out.world_from_body.yaw_rad = *current.heading_rad;
    out.yaw_rate_radps = 0.0;
  }
  return out;
}

double Course::height_m(Time time) const { return leg(time).trajectory.height_m; }

std::int64_t Course::round(Time time) const { return leg(time).round; }

Time Course::newest_start() const { return legs_.back().trajectory.start_time; }

void Course::follow(const models::Trajectory& trajectory, std::int64_t round) {
  while (legs_.size() > 1 && legs_.back().trajectory.start_time >= trajectory.start_time) {
    legs_.pop_back();
  }
  legs_.push_back(Leg{trajectory, round, {}});
}

void Course::stop(Time now, const Pose2& world_from_body, const Eigen::Vector2d& velocity_world_mps,
                  double height_m, double brake_mps2) {
  const double speed_mps = velocity_world_mps.norm();
  Pose2 start = world_from_body;
  if (speed_mps > 0.0) {
    start.yaw_rad = std::atan2(velocity_world_mps.y(), velocity_world_mps.x());
  }
  legs_.assign(
      1, Leg{models::Trajectory{now, start, height_m, models::brake(speed_mps, brake_mps2)}, -1,
             world_from_body.yaw_rad});
}

void Course::prune(Time now) {
  std::size_t stale = 0;
  while (stale + 1 < legs_.size() && legs_[stale + 1].trajectory.start_time < now - kMemory) {
    ++stale;
  }
  legs_.erase(legs_.begin(), legs_.begin() + static_cast<std::ptrdiff_t>(stale));
}

}  // namespace vantage::sim
