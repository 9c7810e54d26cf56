#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "drivers/safety/limits.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers {

/// What became of one body in one mocap frame.
enum class [[nodiscard]] PoseVerdict{
    kAccepted,
    kAbsent,     ///< not in the frame, or occluded
    kDuplicate,  ///< the name is there twice
    kMalformed,  ///< not finite, or no rotation
    kOutside,    ///< where the room is not: wrong units, wrong frame; not reached from inside
    kJump,      kFlip,
    kStuck,    ///< the same bits for too long
    kForeign,  ///< of another body: a row that distrusts poses has acted in this flight
};
inline constexpr std::size_t kPoseVerdicts = 9;
const char* name_of(PoseVerdict verdict);

/// What the judge must know about the body.
struct BodyContext {
  bool in_air = false;         ///< then a jump or flip is never believed
  bool is_moving = false;      ///< commanded to; then repeated poses are found sooner
  bool may_rest = true;        ///< may stand still for ever (on the ground)
  double sunk_m = 0.0;         ///< so far it may have come down unseen, as it was told to
  bool is_distrusted = false;  ///< poses under its name are another body's
};

/// Judges the poses of one body, frame after frame, by arrival time; mocap clocks may jump.
///
/// A pose passes when it lies within pose_gate_m of the constant-velocity prediction, plus
/// ½ a t² of an unknown acceleration, at most pose_gate_max_m. A body on the ground may be carried:
/// there the track begins anew and counts from one. A body in the air may leave the room: a track
/// that goes on is believed wherever it goes, and only begins inside.
class PoseMonitor {
 public:
  PoseVerdict judge(const models::MocapBody* body, const BodyContext& context,
                    const SafetyLimits& limits, Time now);

  [[nodiscard]] bool has_pose() const { return has_pose_; }
  /// Since the last accepted pose arrived; kNever before any.
  [[nodiscard]] double age_s(Time now) const;
  [[nodiscard]] const Pose3& world_from_body() const { return pose_; }
  [[nodiscard]] const Eigen::Vector3d& velocity_world_mps() const { return velocity_mps_; }
  /// About the vertical, counter-clockwise.
  [[nodiscard]] double turn_radps() const { return turn_radps_; }
  /// Moved on from the last pose at its velocity, for at most `horizon_s`.
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
  Time identical_since_{};  ///< when pose_ was first accepted
  int rejected_ = 0;
  int accepted_ = 0;
};

}  // namespace vantage::drivers
