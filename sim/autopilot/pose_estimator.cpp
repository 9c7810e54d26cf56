#include "sim/autopilot/pose_estimator.hpp"

#include <algorithm>

namespace vantage::sim {
namespace {

constexpr Duration kMemory = std::chrono::seconds(1);
constexpr double kGap_s = 0.2;  // s; a longer gap interrupts fusion
constexpr double kGain = 0.3;   // weight of a new pose

}  // namespace

void PoseEstimator::move(Time now, const Eigen::Vector3d& truth_m, double dt_s) {
  truth_m_ = truth_m;
  history_.push_back({now, truth_m});
  while (history_.front().time < now - kMemory) {
    history_.pop_front();
  }
  const double blind_s = newest_ ? to_seconds(now - *newest_) : 0.0;
  drift_mps_.x() = traits_.wander_mps3 * blind_s * blind_s;
  error_m_ += dt_s * drift_mps_;
}

void PoseEstimator::fuse(Time now, Time capture, const Eigen::Vector3d& position_m,
                         std::uint8_t resets) {
  if (history_.empty()) {
    return;
  }
  const auto later =
      std::lower_bound(history_.begin(), history_.end(), capture,
                       [](const Moment& moment, Time time) { return moment.time < time; });
  const Moment& then = later == history_.end() ? history_.back() : *later;
  const Eigen::Vector3d error_m = position_m - then.truth_m;
  const bool is_fresh_start = !is_fed(now, kGap_s);
  newest_ = now;
  ++poses_;
  const bool is_reset = resets != resets_;
  const bool is_far = was_ready_ && !is_reset && (error_m - error_m_).norm() > traits_.gate_m;
  refused_since_ = is_far ? std::optional(refused_since_.value_or(now)) : std::nullopt;
  const bool is_overruled =
      refused_since_ && to_seconds(now - *refused_since_) >= traits_.reset_after_s;
  if (is_far && !is_overruled) {
    return;
  }
  if (is_fresh_start && !was_ready_) {
    since_ = now;
  }
  if (is_fresh_start || is_reset || is_overruled) {
    error_m_ = error_m;
    refused_since_.reset();
  } else {
    error_m_ += kGain * (error_m - error_m_);
  }
  resets_ = resets;
  taken_ = now;
  was_ready_ = was_ready_ || to_seconds(now - *since_) >= traits_.converge_s;
}

bool PoseEstimator::is_current(Time now) const {
  const double limit_s = refused_since_ ? traits_.rejected_loss_s : loss_s_;
  return taken_ && to_seconds(now - *taken_) <= limit_s;
}

bool PoseEstimator::is_ready(Time now) const { return was_ready_ && is_current(now); }

}  // namespace vantage::sim
