#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/plan/plan.hpp"

namespace vantage::sim {

/// Commanded state of a vehicle at one instant.
struct CoursePoint {
  Pose2 world_from_body;
  Eigen::Vector2d velocity_world_mps = Eigen::Vector2d::Zero();
  double yaw_rate_radps = 0.0;
};

/// Sequence of the accepted plans of a vehicle. At each instant the plan with the latest start
/// among the started plans applies.
class Course {
 public:
  /// Creates a course that hovers at `hover`.
  Course(Time start, const Pose2& hover, double height_m);

  [[nodiscard]] CoursePoint at(Time time) const;
  [[nodiscard]] double height_m(Time time) const;
  /// Returns the round of the plan that applies at `time`; −1 for a hover.
  [[nodiscard]] std::int64_t round(Time time) const;
  /// Returns the start time of the newest plan, or of the hover if there is no plan.
  [[nodiscard]] Time newest_start() const;

  /// Follows `trajectory` from its start_time on; drops plans that start later.
  void follow(const models::Trajectory& trajectory, std::int64_t round);
  /// Brakes from `now` on along `velocity_world_mps` at `brake_mps2` with constant heading, and
  /// then hovers. Drops every plan.
  void stop(Time now, const Pose2& world_from_body, const Eigen::Vector2d& velocity_world_mps,
            double height_m, double brake_mps2);
  /// Removes legs that do not affect the course at or after `now`.
  void prune(Time now);

 private:
  struct Leg {
    models::Trajectory trajectory;
    std::int64_t round = -1;
    std::optional<double> heading_rad;  ///< replaces the trajectory's heading during a stop
  };
  [[nodiscard]] const Leg& leg(Time time) const;

  std::vector<Leg> legs_;  ///< in order of start time, never empty
};

}  // namespace vantage::sim
