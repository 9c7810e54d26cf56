#include "logs/picture/layout.hpp"

#include <algorithm>

namespace vantage::logs {

Layout::Layout(const models::Rectangle& bounds, double panel_height_px)
    : world_min_m(bounds.min_m) {
  const Eigen::Vector2d extent_m = bounds.max_m - bounds.min_m;
  constexpr double kMapWidthMax_px = 1040.0;
  constexpr double kMapHeightMax_px = 820.0;
  px_per_m = std::min(kMapWidthMax_px / extent_m.x(), kMapHeightMax_px / extent_m.y());
  map_corner_px = {kMargin_px, kHeader_px};
  map_size_px = px_per_m * extent_m;
  panel_corner_px = {map_corner_px.x() + map_size_px.x() + 36.0, kHeader_px};
  page_size_px = {panel_corner_px.x() + kPanel_px,
                  kHeader_px + std::max(map_size_px.y(), panel_height_px) + kMargin_px};
}

}  // namespace vantage::logs
