#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace vantage::logs {

/// Placement of labels next to their points so that they cover neither each other nor areas that
/// must stay visible. Greedy: each label takes the candidate position around its point that covers
/// the least area.
class LabelPlacer {
 public:
  explicit LabelPlacer(const Eigen::AlignedBox2d& page_px) : page_px_(page_px) {}
  /// Keeps labels away from this area where possible.
  void avoid(const Eigen::AlignedBox2d& area_px) { taken_px_.push_back(area_px); }
  /// Returns the area of a label of `size_px` for `anchor_px`, and marks it as occupied.
  Eigen::AlignedBox2d place(const Eigen::Vector2d& anchor_px, const Eigen::Vector2d& size_px);

 private:
  Eigen::AlignedBox2d page_px_;
  std::vector<Eigen::AlignedBox2d> taken_px_;
};

}  // namespace vantage::logs
