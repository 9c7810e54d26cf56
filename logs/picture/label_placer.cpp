#include "logs/picture/label_placer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/angle.hpp"

namespace vantage::logs {
namespace {

double overlap_px2(const Eigen::AlignedBox2d& a, const Eigen::AlignedBox2d& b) {
  const Eigen::AlignedBox2d both = a.intersection(b);
  return both.isEmpty() ? 0.0 : both.volume();
}

}  // namespace

Eigen::AlignedBox2d LabelPlacer::place(const Eigen::Vector2d& anchor_px,
                                       const Eigen::Vector2d& size_px) {
  constexpr int kDirections = 16;
  Eigen::AlignedBox2d best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const double gap_px : {8.0, 16.0, 26.0, 40.0}) {
    for (int i = 0; i < kDirections; ++i) {
      const double angle_rad = -kPi / 4 + 2.0 * kPi * i / kDirections;
      const Eigen::Vector2d direction(std::cos(angle_rad), std::sin(angle_rad));
      const Eigen::Vector2d centre_px =
          anchor_px + gap_px * direction + 0.5 * size_px.cwiseProduct(direction);
      const Eigen::AlignedBox2d box(centre_px - 0.5 * size_px, centre_px + 0.5 * size_px);
      double cost = gap_px;
      cost += 10.0 * (size_px.prod() - overlap_px2(box, page_px_));
      for (const Eigen::AlignedBox2d& taken : taken_px_) {
        cost += 5.0 * overlap_px2(box, taken);
      }
      if (cost < best_cost) {
        best_cost = cost;
        best = box;
      }
    }
  }
  taken_px_.push_back(best);
  return best;
}

}  // namespace vantage::logs
