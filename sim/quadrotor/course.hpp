#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/plan/plan.hpp"

namespace vantage::sim {

/// What a vehicle is to do at one instant.
struct CoursePoint {
  Pose2 world_from_body;
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();
  double yaw_rate_radps = 0.0;
};

/// The plans that a vehicle has accepted, laid end to end in time: at each instant the one that
/// started last counts.
class Course {
 public:
  /// Hovers at `hover` for ever.
  Course(Time start, const Pose2& hover, double height_m);

  [[nodiscard]] CoursePoint at(Time time) const;
  [[nodiscard]] double height_m(Time time) const;
  /// Round of the plan that counts at `time`, −1 for a hover.
  [[nodiscard]] std::int64_t round(Time time) const;
  /// Start of the newest plan on the course; the start of the hover without one.
  [[nodiscard]] Time newest_start() const;

  /// From `trajectory.start_time` on follow `trajectory`; what was to start later is dropped.
  void follow(const models::Trajectory& trajectory, std::int64_t round);
  /// From `now` on stop straight at `brake_mps2` along `velocity_world_mps`, keep the heading, and
  /// hover where that ends. Drops every plan.
  void stop(Time now, const Pose2& world_from_body, const Eigen::Vector2d& velocity_world_mps,
            double height_m, double brake_mps2);
  /// Forgets what can no longer matter at `now` or after.
  void prune(Time now);

 private:
  struct Leg {
    models::Trajectory trajectory;
    std::int64_t round = -1;
    std::optional<double> heading_rad;  ///< kept instead of the trajectory's (a stop)
  };
  [[nodiscard]] const Leg& leg(Time time) const;

  std::vector<Leg> legs_;  ///< by start time, never empty
};

}  // namespace vantage::sim
