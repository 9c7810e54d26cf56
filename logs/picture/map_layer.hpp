#pragma once

#include "logs/picture/label_placer.hpp"
#include "logs/picture/layout.hpp"
#include "logs/picture/scene.hpp"
#include "logs/picture/svg.hpp"
#include "scenario/scenario.hpp"

// The parts of the map, back to front. Each draws one kind of thing into `svg`.

namespace vantage::logs {

/// How long before the end a track is drawn strongly; before that it is faint.
inline double recent_s() { return logs::look().trail_s; }

void draw_ground(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                 const Scene& scene);
void draw_axes(Svg& svg, const Layout& layout, const models::World& world);
void draw_tracks(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                 const Scene& scene);
void draw_views_and_plans(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                          const Scene& scene);
/// A robot's body, its nose ahead; a core where its colour is another.
void draw_robot(Svg& svg, const Eigen::Vector2d& at_px, double yaw_rad, double radius_px,
                std::string_view colour, std::string_view core_colour);
/// The sensor's reach from `world_from_body`: a disc, or the sector of its field of view.
void draw_view(Svg& svg, const Layout& layout, const models::SensorModel& sensor,
               const Pose2& world_from_body, std::string_view colour);
void draw_estimates(Svg& svg, const Layout& layout, const Scene& scene);
/// Markers of robots and true targets, then all labels where they cover nothing.
void draw_bodies(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                 const Scene& scene);

}  // namespace vantage::logs
