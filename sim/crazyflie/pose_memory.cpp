#include "sim/crazyflie/pose_memory.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace vantage::sim {
namespace {

/// Growth of the estimate's error after the last pose, as measured.
struct Growth {
  double gap_s;
  double sigma_m;
  double error_m;
};
constexpr std::array<Growth, 8> kGrowth{{{0.0, 0.0024, 0.0},
                                         {0.2, 0.004, 0.0},
                                         {0.5, 0.008, 0.004},
                                         {1.0, 0.018, 0.014},
                                         {2.0, 0.057, 0.06},
                                         {3.0, 0.134, 0.15},
                                         {5.0, 0.43, 0.49},
                                         {8.0, 1.33, 1.45}}};
constexpr double kUnknownSigmaM = 10.0;
const Eigen::Vector3d kDriftDirection(0.8, 0.6, 0.0);

Growth growth_after(double gap_s) {
  std::size_t next = 1;
  while (next + 1 < kGrowth.size() && kGrowth[next].gap_s < gap_s) {
    ++next;
  }
  const Growth& a = kGrowth[next - 1];
  const Growth& b = kGrowth[next];
  const double share = std::max(0.0, (gap_s - a.gap_s) / (b.gap_s - a.gap_s));
  return {gap_s, a.sigma_m + share * (b.sigma_m - a.sigma_m),
          a.error_m + share * (b.error_m - a.error_m)};
}

}  // namespace

void PoseMemory::take(const Eigen::Vector3d& position_world_m,
                      const std::optional<Quaternion>& rotation, const Pose3& truth, Time now) {
  error_m_ =
      error_m_.allFinite() ? Eigen::Vector3d(position_world_m - truth.translation_m) : error_m_;
  if (rotation) {
    turned_ = (*rotation * truth.rotation.conjugate()).normalized();
  }
  newest_ = now;
}

Pose3 PoseMemory::estimate(const Pose3& truth, Time now) const {
  if (!newest_) {
    return {Eigen::Vector3d::Zero(), truth.rotation};
  }
  const double drift_m = growth_after(to_seconds(now - *newest_)).error_m;
  return {truth.translation_m + error_m_ + drift_m * kDriftDirection,
          (turned_ * truth.rotation).normalized()};
}

double PoseMemory::sigma_m(Time now) const {
  return newest_ ? growth_after(to_seconds(now - *newest_)).sigma_m : kUnknownSigmaM;
}

}  // namespace vantage::sim
