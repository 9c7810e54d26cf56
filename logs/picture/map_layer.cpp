#include "logs/picture/map_layer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "models/plan/plan.hpp"

namespace vantage::logs {
namespace {

using Points = std::vector<Eigen::Vector2d>;

// Draws a track: first the old part, faintly, then the recent part on top.
void draw_track(Svg& svg, const Layout& layout, const std::vector<TrackPoint>& track, Time now,
                std::string_view colour, double width_px, double opacity) {
  Points old_px;
  Points recent_px;
  for (const TrackPoint& point : track) {
    const bool recent = to_seconds(now - point.time) <= recent_s();
    const Eigen::Vector2d p_px = layout.page_from_world(point.position_m);
    if (!recent) {
      old_px.push_back(p_px);
    } else {
      if (recent_px.empty() && !old_px.empty()) {
        recent_px.push_back(old_px.back());
      }
      recent_px.push_back(p_px);
    }
  }
  constexpr std::string_view kStyle =
      R"(fill="none" stroke="{}" stroke-width="{}" stroke-opacity="{}" stroke-linejoin="round" )"
      R"(stroke-linecap="round")";
  svg.polyline(old_px, fmt::format(fmt::runtime(kStyle), colour, 0.5 * width_px, 0.16));
  svg.polyline(recent_px, fmt::format(fmt::runtime(kStyle), colour, width_px, opacity));
}

void draw_plan(Svg& svg, const Layout& layout, const models::RobotPlan& plan, Time now,
               std::string_view colour) {
  Points path_px;
  constexpr double kStep_s = 0.1;
  const Time end = models::end_time(plan.trajectory);
  for (Time t = std::max(now, plan.trajectory.start_time); t < end; t += from_seconds(kStep_s)) {
    path_px.push_back(
        layout.page_from_world(models::at(plan.trajectory, t).world_from_body.position_m()));
  }
  const Eigen::Vector2d hover_px =
      layout.page_from_world(models::at(plan.trajectory, end).world_from_body.position_m());
  path_px.push_back(hover_px);
  svg.polyline(path_px, fmt::format(R"(class="plan" fill="none" stroke="{}" stroke-width="2.2" )"
                                    R"(stroke-dasharray="2 5" stroke-linecap="round")",
                                    colour));
  svg.circle(hover_px, 4.5,
             fmt::format("fill=\"#ffffff\" stroke=\"{}\" stroke-width=\"1.8\"", colour));
}

Eigen::AlignedBox2d around(const Eigen::Vector2d& centre_px, double radius_px) {
  const Eigen::Vector2d r_px(radius_px, radius_px);
  return {centre_px - r_px, centre_px + r_px};
}

constexpr double kRobot_px = 8.0;  // minimum radius of a robot's body

bool is_jammed(const Scene& scene, const scenario::RobotSpec& robot) {
  return scene.jammed.contains(robot.name);
}

std::string_view shown_colour(const Scene& scene, const scenario::Scenario& scenario,
                              std::size_t i) {
  return is_jammed(scene, scenario.robots[i]) ? role_colour("jammed") : robot_colour(i);
}

}  // namespace

void draw_tracks(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                 const Scene& scene) {
  svg.open_group("class=\"target-tracks\"");
  for (const auto& [id, target] : scene.targets) {
    draw_track(svg, layout, target.track, scene.time, role_colour("truth"), 1.3, 0.45);
  }
  svg.close_group();
  svg.open_group("class=\"robot-tracks\"");
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const auto robot = scene.robots.find(scenario.robots[i].name);
    if (robot != scene.robots.end()) {
      draw_track(svg, layout, robot->second.track, scene.time, robot_colour(i), 2.2, 0.9);
    }
  }
  svg.close_group();
}

void draw_views_and_plans(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                          const Scene& scene) {
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const auto robot = scene.robots.find(scenario.robots[i].name);
    if (robot == scene.robots.end() || !robot->second.world_from_body) {
      continue;
    }
    draw_view(svg, layout, scenario.robots[i].sensor, *robot->second.world_from_body,
              shown_colour(scene, scenario, i));
    if (robot->second.plan) {
      draw_plan(svg, layout, *robot->second.plan, scene.time, robot_colour(i));
    }
  }
}

void draw_view(Svg& svg, const Layout& layout, const models::SensorModel& sensor,
               const Pose2& world_from_body, std::string_view colour, double fill_opacity) {
  const std::string style = fmt::format(
      R"(class="view" fill="{0}" fill-opacity="{1:.2g}" stroke="{0}" stroke-opacity="0.55" )"
      R"(stroke-dasharray="5 4")",
      colour, fill_opacity);
  const Eigen::Vector2d centre_px = layout.page_from_world(world_from_body.position_m());
  if (sensor.fov_rad >= 2.0 * kPi - 1e-9) {
    svg.circle(centre_px, sensor.range_max_m * layout.px_per_m, style);
    return;
  }
  Points sector_px{centre_px};
  constexpr int kPieces = 32;
  for (int i = 0; i <= kPieces; ++i) {
    const double angle_rad = world_from_body.yaw_rad + sensor.fov_rad * (1.0 * i / kPieces - 0.5);
    const Eigen::Vector2d direction(std::cos(angle_rad), std::sin(angle_rad));
    sector_px.push_back(
        layout.page_from_world(world_from_body.position_m() + sensor.range_max_m * direction));
  }
  svg.polygon(sector_px, style);
}

void draw_robot(Svg& svg, const Eigen::Vector2d& at_px, double yaw_rad, double radius_px,
                std::string_view colour, std::string_view core_colour) {
  const Eigen::Vector2d ahead = radius_px * Eigen::Vector2d(std::cos(yaw_rad), -std::sin(yaw_rad));
  const Eigen::Vector2d aside(-ahead.y(), ahead.x());
  svg.open_group(R"(class="robot")");
  svg.polygon({at_px + 1.75 * ahead, at_px + 0.75 * ahead + 0.7 * aside,
               at_px + 0.75 * ahead - 0.7 * aside},
              fmt::format(R"(fill="{0}" stroke="#ffffff" stroke-width="1.2")", colour));
  svg.circle(at_px, radius_px,
             fmt::format("fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1.4\"", colour));
  if (core_colour != colour) {
    svg.circle(at_px, 0.5 * radius_px, fmt::format("fill=\"{}\"", core_colour));
  }
  svg.close_group();
}

void draw_estimates(Svg& svg, const Layout& layout, const Scene& scene) {
  for (const auto& [id, target] : scene.targets) {
    if (!target.estimate) {
      continue;
    }
    const Eigen::Vector2d mean_m = target.estimate->mean_m.head<2>();
    const Eigen::Vector2d mean_px = layout.page_from_world(mean_m);
    const Eigen::Matrix2d covariance_m2 = target.estimate->covariance_m2.topLeftCorner<2, 2>();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance_m2);
    const Eigen::Vector2d half_px = logs::appearance().ellipse_radius() * layout.px_per_m *
                                    axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    // The page's y axis points down, so a counter-clockwise angle becomes negative.
    const double angle_deg =
        -degrees(std::atan2(axes.eigenvectors()(1, 0), axes.eigenvectors()(0, 0)));
    svg.ellipse(mean_px, half_px, angle_deg,
                fmt::format(R"(class="ellipse" fill="{0}" fill-opacity="0.08" stroke="{0}" )"
                            R"(stroke-width="1.6")",
                            role_colour("estimate")));
    if (!target.track.empty()) {
      svg.line(mean_px, layout.page_from_world(target.track.back().position_m),
               fmt::format("stroke=\"{}\" stroke-width=\"1.2\"", role_colour("estimate")));
    }
    const std::string cross =
        fmt::format("stroke=\"{}\" stroke-width=\"2.2\"", role_colour("estimate"));
    svg.line(mean_px - Eigen::Vector2d(5, 5), mean_px + Eigen::Vector2d(5, 5), cross);
    svg.line(mean_px - Eigen::Vector2d(5, -5), mean_px + Eigen::Vector2d(5, -5), cross);
  }
}

void draw_bodies(Svg& svg, const Layout& layout, const scenario::Scenario& scenario,
                 const Scene& scene) {
  struct Label {
    Eigen::Vector2d anchor_px;
    std::string words;
    std::string_view colour;
    bool bold;
  };
  std::vector<Label> labels;
  LabelPlacer placer(
      {layout.map_corner_px, Eigen::Vector2d(layout.map_corner_px + layout.map_size_px)});
  for (const scenario::TargetSpec& spec : scenario.targets) {
    const auto target = scene.targets.find(spec.id);
    if (target == scene.targets.end()) {
      continue;
    }
    if (target->second.estimate) {
      const Eigen::Vector2d mean_m = target->second.estimate->mean_m.head<2>();
      placer.avoid(around(layout.page_from_world(mean_m), 6.0));
    }
    if (!target->second.track.empty()) {
      const Eigen::Vector2d p_px = layout.page_from_world(target->second.track.back().position_m);
      svg.polygon({p_px + Eigen::Vector2d(0, -6), p_px + Eigen::Vector2d(6, 0),
                   p_px + Eigen::Vector2d(0, 6), p_px + Eigen::Vector2d(-6, 0)},
                  fmt::format(R"(class="truth" fill="{}" stroke="#ffffff" stroke-width="1.2")",
                              role_colour("truth")));
      placer.avoid(around(p_px, 7.0));
      labels.push_back({p_px, spec.name, role_colour("truth"), false});
    }
  }
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const auto robot = scene.robots.find(scenario.robots[i].name);
    if (robot == scene.robots.end() || !robot->second.world_from_body) {
      continue;
    }
    const Pose2& pose = *robot->second.world_from_body;
    const double radius_px =
        std::max(kRobot_px, scenario.robots[i].limits.radius_m * layout.px_per_m);
    const bool jammed = is_jammed(scene, scenario.robots[i]);
    const std::string_view colour = shown_colour(scene, scenario, i);
    draw_robot(svg, layout.page_from_world(pose.position_m()), pose.yaw_rad, radius_px, colour,
               jammed ? robot_colour(i) : robot_core_colour(i));
    placer.avoid(around(layout.page_from_world(pose.position_m()), radius_px + 5.0));
    labels.push_back({layout.page_from_world(pose.position_m()),
                      scenario.robots[i].name + (jammed ? " jammed" : ""), colour, true});
  }
  for (const Label& label : labels) {
    const double size_px = label.bold ? 16.0 : 13.0;
    const Eigen::Vector2d text_px(0.68 * size_px * static_cast<double>(label.words.size()),
                                  1.05 * size_px);
    const Eigen::AlignedBox2d box = placer.place(label.anchor_px, text_px);
    svg.text({box.center().x(), box.max().y() - 0.22 * size_px}, label.words,
             fmt::format(R"(text-anchor="middle" font-size="{}" font-weight="{}" fill="{}" )"
                         R"(stroke="#ffffff" stroke-width="3.5" stroke-linejoin="round" )"
                         R"(paint-order="stroke")",
                         size_px, label.bold ? "bold" : "normal", label.colour));
  }
}

}  // namespace vantage::logs
