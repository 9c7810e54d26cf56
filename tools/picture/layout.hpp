#pragma once

#include <array>
#include <string_view>

#include <Eigen/Core>

#include "models/world/world.hpp"

namespace vantage::tools {

/// Where things are on the page, and the map from the world to it.
struct Layout {
  static constexpr double kMargin_px = 56.0;
  static constexpr double kHeader_px = 92.0;
  static constexpr double kPanel_px = 372.0;

  /// The page is as tall as the taller of the map and the panel beside it.
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

/// Colours that the colour-blind tell apart (Okabe, Ito 2008), one per robot, then again.
inline constexpr std::array<std::string_view, 6> kRobotColours = {"#0072B2", "#D55E00", "#009E73",
                                                                  "#B5478F", "#B8860B", "#3A9AD0"};
inline constexpr std::string_view kEstimateColour = "#5B3FA8";
inline constexpr std::string_view kTruthColour = "#3c4043";
inline constexpr std::string_view kTruthTrackColour = "#9aa0a6";
inline constexpr std::string_view kExploredColour = "#ffffff";
inline constexpr std::string_view kStaleColour = "#f1f3f5";
inline constexpr std::string_view kUnexploredColour = "#e3e6e9";
inline constexpr std::string_view kObstacleColour = "#8b939c";

inline std::string_view robot_colour(std::size_t index) {
  return kRobotColours[index % kRobotColours.size()];
}

}  // namespace vantage::tools
