#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include <Eigen/Core>

#include "core/time.hpp"

namespace vantage::sim {

/// What an autopilot believes of its position, fed with external poses: the truth plus an error
/// that each pose pulls towards its own and that wanders when none comes.
class PoseEstimator {
 public:
  PoseEstimator(double converge_s, double loss_s) : converge_s_(converge_s), loss_s_(loss_s) {}

  /// Remembers where the vehicle is; inertial sensors carry the estimate along.
  void move(Time now, const Eigen::Vector3d& truth_m, double dt_s);
  /// An external pose of the instant `capture`, in the vehicle's own clock.
  void fuse(Time now, Time capture, const Eigen::Vector3d& position_m, std::uint8_t resets);

  [[nodiscard]] Eigen::Vector3d position_m() const { return truth_m_ + error_m_; }
  /// Poses have come for long enough, and not stopped for too long.
  [[nodiscard]] bool is_ready(Time now) const;
  /// It was ready and has had no pose for too long.
  [[nodiscard]] bool is_lost(Time now) const { return was_ready_ && !is_fed(now, loss_s_); }
  [[nodiscard]] std::int64_t poses() const { return poses_; }

 private:
  struct Moment {
    Time time{};
    Eigen::Vector3d truth_m;
  };
  [[nodiscard]] bool is_fed(Time now, double age_max_s) const {
    return newest_ && to_seconds(now - *newest_) <= age_max_s;
  }

  double converge_s_;
  double loss_s_;
  std::deque<Moment> history_;
  Eigen::Vector3d truth_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d error_m_ = Eigen::Vector3d::Zero();
  std::optional<Time> since_;   ///< poses come without a break
  std::optional<Time> newest_;  ///< arrival
  std::uint8_t resets_ = 0;
  bool was_ready_ = false;
  std::int64_t poses_ = 0;
};

}  // namespace vantage::sim
