#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// Pose and motion of a body, measured by mocap.
struct BodyState {
  Time capture{};
  Pose3 world_from_body;
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  double position_sigma_m = 0.01;
  double attitude_sigma_rad = 0.01;
  double velocity_sigma_mps = 0.05;
  std::uint8_t resets = 0;  ///< number of jumps of the pose, sent as reset_counter
};

/// Result of processing one mocap frame.
enum class BodyVerdict {
  kTaken,
  kUnseen,      ///< the body is absent or occluded
  kRepeated,    ///< pose identical for half a second in the air: treated as unseen
  kOutOfOrder,  ///< captured no later than the newest frame of the same run of the mocap driver
  kImpossible,  ///< not finite, or not a rotation
  kJumped       ///< farther from the newest pose than the body can have moved
};

/// Tracker of one rigid body through mocap frames. It rejects impossible poses and estimates the
/// velocity.
///
/// Velocity: a Kalman filter per axis on (position, velocity) with white acceleration of 5 m/s²
/// between frames and 1 mm of noise. The pose itself is not filtered.
class BodyTracker {
 public:
  BodyTracker(std::string name, double speed_max_mps)
      : name_(std::move(name)), speed_max_mps_(speed_max_mps) {}

  /// @param captured    capture time of the frame by the local clock; the stamp's time is not used,
  /// since its clock may have been set
  /// @param is_resting  the body is on the ground: it may be stationary or be carried. A pose at
  ///                    another position is accepted after half a second of consistent poses, and
  ///                    counted in `resets`
  BodyVerdict update(const models::MocapFrame& frame, Time captured, Time now, bool is_resting);

  /// Returns the newest state; nullopt before the first accepted pose.
  [[nodiscard]] const std::optional<BodyState>& state() const { return state_; }
  /// Returns the time since the arrival of the newest accepted pose; nullopt before the first
  /// accepted pose.
  [[nodiscard]] std::optional<Duration> age(Time now) const;

 private:
  [[nodiscard]] bool is_jump(const Pose3& pose, Time capture) const;
  void start(const Pose3& pose, Time capture);
  void filter(const Pose3& pose, Time capture);

  std::string name_;
  double speed_max_mps_;
  std::optional<BodyState> state_;
  Time arrival_{};
  Time changed_{};  ///< capture time of the newest pose that differed from its predecessor
  std::int64_t run_id_ = 0;
  Eigen::Vector3d filtered_position_m_ = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 2, 2, kUnaligned> covariance_ = Eigen::Matrix2d::Zero();
  struct Candidate {
    Pose3 pose;
    Time since{};
    Time newest{};
  };
  std::optional<Candidate> candidate_;  ///< pose to which the body was apparently carried
};

}  // namespace vantage::drivers
