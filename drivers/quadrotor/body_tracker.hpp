#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "core/linear.hpp"
#include "core/pose.hpp"
#include "core/time.hpp"
#include "drivers/quadrotor/autopilot_link.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// What became of one mocap frame.
enum class BodyVerdict {
  kTaken,
  kUnseen,      ///< the body is absent or occluded
  kRepeated,    ///< the same bits for half a second: it is not seen, whatever is said
  kOutOfOrder,  ///< captured no later than the newest, by the same run of the mocap driver
  kImpossible,  ///< not finite, or no rotation
  kJumped       ///< farther from the newest pose than the body can have moved
};

/// Follows one rigid body through mocap frames: refuses poses that cannot be, estimates velocity.
///
/// Velocity: a Kalman filter per axis on (position, velocity) with white acceleration of 5 m/s²
/// between frames and 1 mm of noise. The pose itself is handed on as it was measured.
class BodyTracker {
 public:
  BodyTracker(std::string name, double speed_max_mps)
      : name_(std::move(name)), speed_max_mps_(speed_max_mps) {}

  /// @param captured  capture of the frame by our clock; its own stamp may be of a clock that is
  /// set
  /// @param is_resting  a body on the ground may lie perfectly still, and may be carried elsewhere:
  /// when the new place is
  ///                  confirmed by half a second of poses it is believed, and `resets` grows
  BodyVerdict see(const models::MocapFrame& frame, Time captured, Time now, bool is_resting);

  /// The newest; nullopt before the first.
  [[nodiscard]] const std::optional<BodyState>& state() const { return state_; }
  /// Since the newest pose was taken, by arrival; nullopt before the first.
  [[nodiscard]] std::optional<Duration> age(Time now) const;

 private:
  [[nodiscard]] bool is_jump(const Pose3& pose, Time capture) const;
  void start(const Pose3& pose, Time capture);
  void filter(const Pose3& pose, Time capture);

  std::string name_;
  double speed_max_mps_;
  std::optional<BodyState> state_;
  Time arrival_{};
  Time changed_{};  ///< capture of the newest pose that differed from the one before
  std::int64_t run_id_ = 0;
  Eigen::Vector3d filtered_position_m_ = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 2, 2, kUnaligned> covariance_ = Eigen::Matrix2d::Zero();
  struct Candidate {
    Pose3 pose;
    Time since{};
    Time newest{};
  };
  std::optional<Candidate> candidate_;  ///< where it seems to have been carried
};

}  // namespace vantage::drivers
