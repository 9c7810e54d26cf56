#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "drivers/safety/limits.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// Result of the check of one body in one mocap frame.
enum class [[nodiscard]] PoseVerdict{
    kAccepted,
    kAbsent,     ///< not in the frame, or occluded
    kDuplicate,  ///< the name occurs twice
    kMalformed,  ///< not finite, or not a rotation
    kOutside,    ///< outside the room (wrong units or frame), without a track that leads there
    kJump,      kFlip,
    kStuck,    ///< pose identical for too long
    kForeign,  ///< pose of another body: a condition that distrusts poses has acted in this flight
};
inline constexpr std::size_t kPoseVerdicts = 9;
const char* name_of(PoseVerdict verdict);

/// State of the body that the check requires.
struct BodyContext {
  bool in_air = false;            ///< in the air: jumps and flips are rejected
  bool is_moving = false;         ///< commanded to move; identical poses are detected sooner
  bool may_be_stationary = true;  ///< may be stationary without limit (on the ground)
  double sunk_m = 0.0;            ///< m; commanded descent while the body was not seen
  bool is_distrusted = false;     ///< poses with this body's name belong to another body
};

/// Check of the poses of one body, frame by frame. It uses arrival times, since mocap clocks may
/// jump.
///
/// A pose is accepted if its distance to the constant-velocity prediction is at most pose_gate_m +
/// ½ a t² and at most pose_gate_max_m; a is the assumed unknown acceleration. A body on the ground
/// may be carried: its track restarts at the new pose, and the count of accepted poses at one. A
/// body in the air may leave the volume: a continuous track is accepted at any position, but must
/// begin inside.
class PoseMonitor {
 public:
  PoseVerdict judge(const models::MocapBody* body, const BodyContext& context,
                    const SafetyLimits& limits, Time now);

  [[nodiscard]] bool has_pose() const { return has_pose_; }
  /// Returns the time since the arrival of the last accepted pose, s; kNever before the first.
  [[nodiscard]] double age_s(Time now) const;
  [[nodiscard]] const Pose3& world_from_body() const { return pose_; }
  [[nodiscard]] const Eigen::Vector3d& velocity_world_mps() const { return velocity_mps_; }
  /// Returns the yaw rate, rad/s; counter-clockwise.
  [[nodiscard]] double turn_radps() const { return turn_radps_; }
  /// Returns the position extrapolated from the last pose at its velocity, by at most `horizon_s`.
  [[nodiscard]] Eigen::Vector3d predict_m(Time now, double horizon_s) const;
  [[nodiscard]] int rejected_in_row() const { return rejected_; }
  [[nodiscard]] int accepted_in_row() const { return accepted_; }

 private:
  void begin(const Pose3& pose, Time now);
  void update(const Pose3& pose, Time now);
  [[nodiscard]] bool is_stuck(const Pose3& pose, const BodyContext& context,
                              const SafetyLimits& limits, Time now);
  PoseVerdict reject(PoseVerdict verdict);

  bool has_pose_ = false;
  Pose3 pose_;
  Eigen::Vector3d velocity_mps_ = Eigen::Vector3d::Zero();
  double turn_radps_ = 0.0;
  Time accepted_at_{};
  Time identical_since_{};  ///< time at which pose_ was first accepted
  int rejected_ = 0;
  int accepted_ = 0;
};

}  // namespace vantage::drivers
