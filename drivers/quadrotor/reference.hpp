#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "drivers/quadrotor/autopilot_link.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// Where a vehicle is to be at one instant.
struct ReferencePoint {
  Eigen::Vector3d position_world_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
  bool is_still = true;  ///< stands here, and will until something new is said
};

/// The motion that a vehicle is following: a hover, a stop, or the plans it has accepted.
class Reference {
 public:
  /// Hover there.
  void hold(Time now, const Pose2& world_from_body, double height_m);
  /// Brake straight along `velocity_world_mps` from here, keep the heading, hover where that ends.
  void stop(Time now, const Pose2& world_from_body, const Eigen::Vector2d& velocity_world_mps,
            double height_m, double brake_mps2);
  /// Follow a plan from its start on, which may be in the past.
  void follow(const models::RobotPlan& plan, Time now);

  [[nodiscard]] ReferencePoint at(Time time) const;
  /// Round of the plan that counts at `time`, −1 without one.
  [[nodiscard]] std::int64_t round(Time time) const { return leg(time).round; }
  /// When the newest plan starts, or the stop or hover began.
  [[nodiscard]] Time newest_start() const {
    return (next_ ? *next_ : current_).trajectory.start_time;
  }

 private:
  struct Leg {
    models::Trajectory trajectory;
    std::int64_t round = -1;
    std::optional<double> heading_rad;  ///< kept instead of the trajectory's
  };
  [[nodiscard]] const Leg& leg(Time time) const {
    return next_ && time >= next_->trajectory.start_time ? *next_ : current_;
  }

  Leg current_;
  std::optional<Leg> next_;
};

/// How hard a vehicle is kept to its reference.
struct TrackingGains {
  double position_per_s = 1.0;
  double yaw_per_s = 1.5;
  double lead_s = 0.25;          ///< the autopilot answers a velocity this much later
  double corner_window_s = 0.1;  ///< velocities are means over ± this time
  double speed_reserve = 1.3;    ///< speeds are cut at this multiple of the vehicle's limits
  double climb_max_mps = 0.5;
};

/// The velocity that leads `body` along `reference`:
/// v = mean reference velocity around (now + lead) + k (p_ref(now) − p), cut; yaw rate likewise.
/// Without a fresh body the feedback is left out.
Setpoint track(const Reference& reference, const std::optional<BodyState>& body, Time now,
               const models::VehicleLimits& limits, const TrackingGains& gains);

}  // namespace vantage::drivers
