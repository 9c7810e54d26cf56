#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace vantage::logs {

/// Finds places for labels beside their points so that they cover neither each other nor what must
/// stay visible: greedy over a ring of candidates, least covered area first.
class LabelPlacer {
 public:
  explicit LabelPlacer(const Eigen::AlignedBox2d& page_px) : page_px_(page_px) {}
  /// Keeps labels off this area where possible.
  void avoid(const Eigen::AlignedBox2d& area_px) { taken_px_.push_back(area_px); }
  /// Where a label of `size_px` for `anchor_px` goes; the area is taken from then on.
  Eigen::AlignedBox2d place(const Eigen::Vector2d& anchor_px, const Eigen::Vector2d& size_px);

 private:
  Eigen::AlignedBox2d page_px_;
  std::vector<Eigen::AlignedBox2d> taken_px_;
};

}  // namespace vantage::logs
