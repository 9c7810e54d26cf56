#pragma once

#include <Eigen/Core>

#include "core/time.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::localizer {

/// Motion of a robot that follows commanded velocities with a delay and a first-order lag.
///
/// Commands are added in the order of their times. advance_to() returns the displacement since the
/// previous call; it needs only commands older than the delay. Keeps at most kCommandsMax commands
/// that have not taken effect; no function allocates memory.
class CommandedMotion {
 public:
  static constexpr int kCommandsMax = 256;

  explicit CommandedMotion(const scenario::DriveSpec& drive) : drive_(drive) {}

  /// Adds a command that was given at `time`. Returns false if it is older than the newest command;
  /// it is then ignored. If the buffer is full, the oldest pending command is lost.
  bool command(Time time, double speed_mps, double turn_radps);

  /// Moves the robot to `time` and returns the displacement (forward m, left m, turn rad) in the
  /// body frame at the previous time. The first call starts the motion and returns zero.
  Eigen::Vector3d advance_to(Time time);

 private:
  struct Command {
    Time acts_at{};
    double speed_mps = 0.0;
    double turn_radps = 0.0;
  };
  void drive_for(double duration_s, Eigen::Vector3d& motion);

  scenario::DriveSpec drive_;
  Command waiting_[kCommandsMax];
  int first_ = 0;
  int count_ = 0;
  bool is_started_ = false;
  Time now_{};
  Time newest_ = Time::min();
  double wanted_mps_ = 0.0;  ///< command that is in effect at present
  double wanted_radps_ = 0.0;
  double speed_mps_ = 0.0;  ///< response to the commands, before scale and bias
  double turn_radps_ = 0.0;
};

}  // namespace vantage::localizer
