#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "core/pose.hpp"

namespace vantage::sim {

/// Limits of a small indoor rover.
struct RoverParameters {
  double speed_max_mps = 1.4;  ///< m/s; maximum speed, never exceeded
  double acceleration_mps2 = 1.0;
  double brake_mps2 = 2.0;
  double yaw_rate_max_radps = 2.0;
  double yaw_acceleration_radps2 = 8.0;
};

/// State of a differential-drive rover, which never reverses.
struct RoverState {
  Pose2 world_from_body;
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
};

/// Command of a rover's controller.
struct RoverCommand {
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
};

/// Returns the state after `dt_s`, during which speed and yaw rate change towards `command` with
/// the accelerations of `parameters`.
RoverState step_rover(const RoverState& state, const RoverCommand& command,
                      const RoverParameters& parameters, double dt_s);

/// Path of a rover's centre while the rover follows a command for one decision period and then
/// stops at its maximum deceleration. It consists of points from the present position to the stop.
class StoppingPath {
 public:
  StoppingPath() = default;
  /// Predicts `period_s` of `command`, then full braking; at most kPointsMax points.
  StoppingPath(const RoverState& state, const RoverCommand& command,
               const RoverParameters& parameters, double period_s);

  [[nodiscard]] std::span<const Eigen::Vector2d> points_m() const { return {points_m_.data(), n_}; }
  /// Returns the largest distance between the path's first point and any point of the path, m.
  [[nodiscard]] double reach_m() const { return reach_m_; }

 private:
  static constexpr std::size_t kPointsMax = 48;
  void append(const Eigen::Vector2d& point_m);

  std::array<Eigen::Vector2d, kPointsMax> points_m_;
  std::size_t n_ = 0;
  double reach_m_ = 0.0;
};

/// Returns the distance between two paths of straight segments, regardless of time, m. It is the
/// minimum distance from a point of one path to a segment of the other. The result is exact unless
/// the paths cross (then it is at most half a segment) or are far apart (then it is a lower bound).
double distance_m(const StoppingPath& a, const StoppingPath& b);

}  // namespace vantage::sim
