#pragma once

#include <cstddef>
#include <string_view>

#include <Eigen/Core>

#include "logs/appearance/appearance.hpp"
#include "models/world/world.hpp"

namespace vantage::logs {

/// Positions of the parts on the page, and the transform from world to page coordinates.
struct Layout {
  static constexpr double kMargin_px = 56.0;
  static constexpr double kHeader_px = 92.0;
  static constexpr double kPanel_px = 372.0;

  /// Makes the page as tall as the taller of the map and the panel next to it.
  Layout(const models::Rectangle& bounds, double panel_height_px);

  [[nodiscard]] Eigen::Vector2d page_from_world(const Eigen::Vector2d& p_m) const {
    return {map_corner_px.x() + (p_m.x() - world_min_m.x()) * px_per_m,
            map_corner_px.y() + map_size_px.y() - (p_m.y() - world_min_m.y()) * px_per_m};
  }

  Eigen::Vector2d world_min_m;
  double px_per_m = 1.0;
  Eigen::Vector2d map_corner_px;
  Eigen::Vector2d map_size_px;
  Eigen::Vector2d page_size_px;
  Eigen::Vector2d panel_corner_px;
};

/// Returns the colour of `role` for a light background, because pictures have a white background.
inline std::string_view role_colour(const char* role) {
  return logs::appearance().roles.at(role).light;
}
inline std::string_view robot_colour(std::size_t index) {
  return logs::robot_appearance(index).body_paint().light;
}
inline std::string_view robot_core_colour(std::size_t index) {
  return logs::robot_appearance(index).core_paint().light;
}

}  // namespace vantage::logs
