#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include <Eigen/Core>

#include "core/time.hpp"

namespace vantage::sim {

/// How an estimator takes external poses.
struct PoseEstimatorTraits {
  double converge_s = 0.0;     ///< of poses, until it is ready
  double wander_mps3 = 0.0;    ///< its drift over the square of the time without poses
  double gate_m = 1.0;         ///< a pose farther than that from where it believes to be is refused
  double refuses_for_s = 0.0;  ///< and then taken whole
  double refused_loss_s = 0.0;  ///< it is lost when it has refused poses for so long
};

/// What an autopilot believes of its position, fed with external poses: the truth plus an error
/// that each pose pulls towards its own and that wanders when none comes.
class PoseEstimator {
 public:
  explicit PoseEstimator(const PoseEstimatorTraits& traits) : traits_(traits) {}

  /// Without poses for so long it is lost.
  void set_loss(double loss_s) { loss_s_ = loss_s; }

  /// Remembers where the vehicle is; inertial sensors carry the estimate along.
  void move(Time now, const Eigen::Vector3d& truth_m, double dt_s);
  /// An external pose of the instant `capture`, in the vehicle's own clock.
  void fuse(Time now, Time capture, const Eigen::Vector3d& position_m, std::uint8_t resets);

  [[nodiscard]] Eigen::Vector3d position_m() const { return truth_m_ + error_m_; }
  /// Poses have come for long enough, and not stopped for too long.
  [[nodiscard]] bool is_ready(Time now) const;
  /// It was ready and has had no pose for too long.
  [[nodiscard]] bool is_lost(Time now) const { return was_ready_ && !is_believed(now); }
  [[nodiscard]] std::int64_t poses() const { return poses_; }
  /// The newest, taken or refused, is no older than that.
  [[nodiscard]] bool is_fed(Time now, double age_max_s) const {
    return newest_ && to_seconds(now - *newest_) <= age_max_s;
  }
  /// How fast its position runs away from the truth, which it does not know.
  [[nodiscard]] const Eigen::Vector3d& drift_mps() const { return drift_mps_; }

 private:
  struct Moment {
    Time time{};
    Eigen::Vector3d truth_m;
  };

  /// A pose was taken recently enough.
  [[nodiscard]] bool is_believed(Time now) const;

  PoseEstimatorTraits traits_;
  double loss_s_ = 0.0;
  std::deque<Moment> history_;
  Eigen::Vector3d truth_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d error_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d drift_mps_ = Eigen::Vector3d::Zero();
  std::optional<Time> since_;   ///< poses come without a break
  std::optional<Time> newest_;  ///< arrival
  std::optional<Time> taken_;   ///< arrival of the newest that was not refused
  std::optional<Time> refused_since_;
  std::uint8_t resets_ = 0;
  bool was_ready_ = false;
  std::int64_t poses_ = 0;
};

}  // namespace vantage::sim
