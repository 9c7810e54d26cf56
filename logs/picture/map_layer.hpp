#pragma once

#include "logs/picture/label_placer.hpp"
#include "logs/picture/layout.hpp"
#include "logs/picture/scene.hpp"
#include "logs/picture/svg.hpp"
#include "scenario/scenario.hpp"

// Layers of the map, back to front. Each function draws one kind of item into `svg`.

namespace vantage::logs {

/// Returns the duration, s, of the last part of a track, which is drawn strongly; earlier parts are
/// faint.
inline double recent_s() { return logs::appearance().trail_s; }

void draw_ground(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                 const Scene& scene);
void draw_axes(Svg& svg, const Layout& layout, const models::World& world);
void draw_tracks(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                 const Scene& scene);
void draw_views_and_plans(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                          const Scene& scene);
/// Draws a robot's body with its nose forward, and a core if the core has another colour.
void draw_robot(Svg& svg, const Eigen::Vector2d& at_px, double yaw_rad, double radius_px,
                std::string_view colour, std::string_view core_colour);
/// Draws the sensor's range from `world_from_body`: a disc, or the sector of its field of view.
void draw_view(Svg& svg, const Layout& layout, const models::SensorModel& sensor,
               const Pose2& world_from_body, std::string_view colour, double fill_opacity = 0.08);
void draw_estimates(Svg& svg, const Layout& layout, const Scene& scene);
/// Draws markers of robots and true targets, then all labels in free areas.
void draw_bodies(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                 const Scene& scene);

}  // namespace vantage::logs
