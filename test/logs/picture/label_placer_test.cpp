#include "logs/picture/label_placer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "core/angle.hpp"

namespace vantage::logs {
namespace {

// The label is placed 8 px from its point, up and to the right if possible, otherwise in another
// direction.
TEST(LabelPlacer, PutsALabelAtTheNearestFreePosition) {
  const Eigen::AlignedBox2d page(Eigen::Vector2d(0, 0), Eigen::Vector2d(400, 400));
  const Eigen::Vector2d anchor_px(200, 200);
  const Eigen::Vector2d size_px(40, 20);
  const auto offset_px = [&](const Eigen::AlignedBox2d& box) {
    return Eigen::Vector2d(box.center() - anchor_px);
  };
  const auto at = [&](double gap_px, double angle_rad) {
    const Eigen::Vector2d direction(std::cos(angle_rad), std::sin(angle_rad));
    return Eigen::Vector2d(gap_px * direction + 0.5 * size_px.cwiseProduct(direction));
  };
  const auto is_at = [&](const Eigen::Vector2d& found_px, double gap_px) {
    double least_px = 1e9;
    for (int k = 0; k < 16; ++k) {
      least_px = std::min(least_px, (found_px - at(gap_px, k * kPi / 8)).norm());
    }
    return least_px < 1e-9;
  };
  LabelPlacer placer(page);
  EXPECT_LT((offset_px(placer.place(anchor_px, size_px)) - at(8.0, -kPi / 4)).norm(), 1e-9);
  EXPECT_TRUE(is_at(offset_px(placer.place(anchor_px, size_px)), 8.0)) << "in another direction";
  // If all near positions are blocked, the label gets the nearest free one farther out.
  for (const auto& [reach_px, gap_px] : {std::pair{10.0, 16.0}, {19.0, 26.0}, {32.0, 40.0}}) {
    LabelPlacer crowded(page);
    const Eigen::Vector2d reach = Eigen::Vector2d::Constant(reach_px);
    const Eigen::AlignedBox2d taken(anchor_px - reach, anchor_px + reach);
    crowded.avoid(taken);
    const Eigen::AlignedBox2d found = crowded.place(anchor_px, size_px);
    EXPECT_TRUE(is_at(offset_px(found), gap_px)) << reach_px;
    EXPECT_TRUE(found.intersection(taken).isEmpty());
  }
}

// On a full page, a label covers something else but does not leave the page.
TEST(LabelPlacer, KeepsLabelsInsideACrowdedPage) {
  const Eigen::AlignedBox2d page(Eigen::Vector2d(0, 0), Eigen::Vector2d(100, 60));
  LabelPlacer placer(page);
  placer.avoid(page);
  for (const Eigen::Vector2d& anchor_px : {Eigen::Vector2d(2, 2), Eigen::Vector2d(98, 2),
                                           Eigen::Vector2d(98, 58), Eigen::Vector2d(2, 58)}) {
    LabelPlacer each = placer;
    EXPECT_TRUE(page.contains(each.place(anchor_px, {30, 14}))) << anchor_px.transpose();
  }
}

}  // namespace
}  // namespace vantage::logs
