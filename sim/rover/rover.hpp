#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "core/pose.hpp"

namespace vantage::sim {

/// What a small indoor rover can do.
struct RoverParameters {
  double speed_max_mps = 1.4;  ///< never exceeded
  double acceleration_mps2 = 1.0;
  double brake_mps2 = 2.0;
  double yaw_rate_max_radps = 2.0;
  double yaw_acceleration_radps2 = 8.0;
};

/// State of a differential drive; it never reverses.
struct RoverState {
  Pose2 world_from_body;
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
};

/// What its controller asks of it.
struct RoverCommand {
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
};

/// The state after `dt_s` of ramping towards `command` at the stated accelerations.
RoverState step_rover(const RoverState& state, const RoverCommand& command,
                      const RoverParameters& parameters, double dt_s);

/// Where a rover's centre goes when it follows a command for one decision period and then stops as
/// fast as it can: points along the way, the present first, the standstill last.
class StoppingPath {
 public:
  StoppingPath() = default;
  /// `period_s` of `command`, then full braking. Bounded work: at most kPointsMax steps.
  StoppingPath(const RoverState& state, const RoverCommand& command,
               const RoverParameters& parameters, double period_s);

  [[nodiscard]] std::span<const Eigen::Vector2d> points_m() const { return {points_m_.data(), n_}; }
  /// Every point of the path lies within this distance of its first.
  [[nodiscard]] double reach_m() const { return reach_m_; }

 private:
  static constexpr std::size_t kPointsMax = 48;
  void append(const Eigen::Vector2d& point_m);

  std::array<Eigen::Vector2d, kPointsMax> points_m_;
  std::size_t n_ = 0;
  double reach_m_ = 0.0;
};

/// The distance between two paths, whatever the times at which they are driven, points joined by
/// straight pieces: from every point of each to every piece of the other, which is exact unless
/// the paths cross (then it is at most half a piece). Far apart, a lower bound of it.
double distance_m(const StoppingPath& a, const StoppingPath& b);

}  // namespace vantage::sim
