#include "sim/autopilot/pose_estimator.hpp"

#include <algorithm>

namespace vantage::sim {
namespace {

constexpr Duration kMemory = std::chrono::seconds(1);
constexpr double kGap_s = 0.2;     // a longer one interrupts fusion
constexpr double kGain = 0.3;      // of each pose
constexpr double kDriftMps = 0.1;  // of a vehicle that sees nothing
constexpr Duration kDriftAfter = std::chrono::milliseconds(300);

}  // namespace

void PoseEstimator::move(Time now, const Eigen::Vector3d& truth_m, double dt_s) {
  truth_m_ = truth_m;
  history_.push_back({now, truth_m});
  while (history_.front().time < now - kMemory) {
    history_.pop_front();
  }
  if (newest_ && now - *newest_ > kDriftAfter) {
    error_m_.x() += kDriftMps * dt_s;
  }
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
  if (is_fresh_start && !was_ready_) {
    since_ = now;
  }
  if (is_fresh_start || resets != resets_) {
    error_m_ = error_m;
  } else {
    error_m_ += kGain * (error_m - error_m_);
  }
  resets_ = resets;
  newest_ = now;
  ++poses_;
  was_ready_ = was_ready_ || to_seconds(now - *since_) >= converge_s_;
}

bool PoseEstimator::is_ready(Time now) const { return was_ready_ && is_fed(now, loss_s_); }

}  // namespace vantage::sim
