#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include <Eigen/Core>

#include "core/time.hpp"

namespace vantage::sim {

/// Parameters of an estimator that fuses external poses.
struct PoseEstimatorTraits {
  double converge_s = 0.0;       ///< s; time with poses until the estimator is ready
  double wander_mps3 = 0.0;      ///< m/s³; drift speed / (time without poses)²
  double gate_m = 1.0;           ///< m; a pose farther than this from the estimate is rejected
  double reset_after_s = 0.0;    ///< s; rejection time after which a pose resets the estimate
  double rejected_loss_s = 0.0;  ///< s; rejection time after which the position is lost
};

/// Position estimate of an autopilot that fuses external poses: the truth plus an error. Each pose
/// moves the estimate's error towards the pose's error; without poses, the error drifts.
class PoseEstimator {
 public:
  explicit PoseEstimator(const PoseEstimatorTraits& traits) : traits_(traits) {}

  /// Sets the time without poses after which the position is lost.
  void set_loss(double loss_s) { loss_s_ = loss_s; }

  /// Records the true position. The estimate moves by the same distance, as with inertial sensors.
  void move(Time now, const Eigen::Vector3d& truth_m, double dt_s);
  /// Fuses an external pose captured at `capture`, by the vehicle's clock.
  void fuse(Time now, Time capture, const Eigen::Vector3d& position_m, std::uint8_t resets);

  [[nodiscard]] Eigen::Vector3d position_m() const { return truth_m_ + error_m_; }
  /// True if poses were received for the required time, and the last accepted pose is recent.
  [[nodiscard]] bool is_ready(Time now) const;
  /// True if the estimator was ready, but the last accepted pose is too old.
  [[nodiscard]] bool is_lost(Time now) const { return was_ready_ && !is_current(now); }
  [[nodiscard]] std::int64_t poses() const { return poses_; }
  /// True if the newest pose, accepted or rejected, is at most `age_max_s` old.
  [[nodiscard]] bool is_fed(Time now, double age_max_s) const {
    return newest_ && to_seconds(now - *newest_) <= age_max_s;
  }
  /// Returns the drift velocity of the estimate, which is unknown to the autopilot.
  [[nodiscard]] const Eigen::Vector3d& drift_mps() const { return drift_mps_; }

 private:
  struct Moment {
    Time time{};
    Eigen::Vector3d truth_m;
  };

  /// True if a pose was accepted recently enough.
  [[nodiscard]] bool is_current(Time now) const;

  PoseEstimatorTraits traits_;
  double loss_s_ = 0.0;
  std::deque<Moment> history_;
  Eigen::Vector3d truth_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d error_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d drift_mps_ = Eigen::Vector3d::Zero();
  std::optional<Time> since_;   ///< start of the current uninterrupted stream of poses
  std::optional<Time> newest_;  ///< arrival of the newest pose
  std::optional<Time> taken_;   ///< arrival of the newest accepted pose
  std::optional<Time> refused_since_;
  std::uint8_t resets_ = 0;
  bool was_ready_ = false;
  std::int64_t poses_ = 0;
};

}  // namespace vantage::sim
