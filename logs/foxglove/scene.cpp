#include "logs/foxglove/scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "logs/appearance/appearance.hpp"

namespace vantage::logs::foxglove {
namespace {

// The background of the viewer is unknown here, so colours are the mean of the two variants.
Colour of_paint(const Paint& paint, double alpha = 1.0) {
  const std::uint32_t rgb = paint.middle();
  return {(rgb >> 16U) / 255.0, (rgb >> 8U & 0xFFU) / 255.0, (rgb & 0xFFU) / 255.0, alpha};
}

Colour of_role(const char* role, double alpha = 1.0) {
  return of_paint(appearance().roles.at(role), alpha);
}

constexpr double kLabel_px = 13.0;
constexpr double kCrossLeast_m = 0.1;  // m; minimum half size of the cross at a mean
constexpr double kCrossShare = 0.25;   // half size divided by sigma
constexpr int kFanPieces = 32;
constexpr double kPlanPiece_s = 0.1;
constexpr double kDash_s = 0.2;
constexpr double kPiecesMax = 10'000.0;

Colour fade(Colour colour, double alpha) {
  colour.a = alpha;
  return colour;
}

Json metadata(const std::string& key, const std::string& value) {
  return {{"key", key}, {"value", value}};
}

std::vector<Eigen::Vector3d> corners(const models::Rectangle& r, double z_m) {
  return {{r.min_m.x(), r.min_m.y(), z_m},
          {r.max_m.x(), r.min_m.y(), z_m},
          {r.max_m.x(), r.max_m.y(), z_m},
          {r.min_m.x(), r.max_m.y(), z_m}};
}

Json box_on_ground(const models::Rectangle& footprint, double height_m, const Colour& colour) {
  const Eigen::Vector2d centre = 0.5 * (footprint.min_m + footprint.max_m);
  const Eigen::Vector2d size = footprint.max_m - footprint.min_m;
  return cube({{centre.x(), centre.y(), 0.5 * height_m}, Quaternion::Identity()},
              {size.x(), size.y(), height_m}, colour);
}

// Returns the ground footprint of the sensor's field of view, in the body's frame.
std::vector<Eigen::Vector3d> field_of_view(const models::SensorModel& sensor, double height_m) {
  const double half_rad = 0.5 * std::min(sensor.fov_rad, 2.0 * kPi);
  std::vector<Eigen::Vector3d> arc;
  for (int i = 0; i <= kFanPieces; ++i) {
    const double angle_rad = -half_rad + 2.0 * half_rad * i / kFanPieces;
    arc.emplace_back(sensor.range_max_m * std::cos(angle_rad),
                     sensor.range_max_m * std::sin(angle_rad), -height_m);
  }
  return arc;
}

// Returns points along a trajectory including its ends, at most `step_s` apart. kPiecesMax limits
// their number for implausibly long trajectories in foreign messages.
std::vector<Eigen::Vector3d> points_of(const models::Trajectory& trajectory, double step_s) {
  const double length_s = to_seconds(models::end_time(trajectory) - trajectory.start_time);
  const int pieces = static_cast<int>(std::clamp(std::ceil(length_s / step_s), 1.0, kPiecesMax));
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i <= pieces; ++i) {
    const Time at = trajectory.start_time + from_seconds(length_s * i / pieces);
    const Pose2 pose = models::at(trajectory, at).world_from_body;
    points.emplace_back(pose.x_m, pose.y_m, trajectory.height_m);
  }
  return points;
}

Json robot_entity(const scenario::RobotSpec& robot, const Colour& colour, bool is_jammed,
                  std::size_t index, Time time) {
  const double radius_m = robot.limits.radius_m;
  Json out = entity("robot/" + robot.name, robot.name, time, true);
  out["cylinders"].push_back(cylinder({}, {2.0 * radius_m, 2.0 * radius_m, 0.08}, colour));
  const RobotAppearance looks = robot_appearance(index);
  if (is_jammed || looks.core != looks.body) {
    // Keep the robot's colour in the core: red alone would not identify the robot.
    const Colour core = of_paint(is_jammed ? looks.body_paint() : looks.core_paint());
    out["cylinders"].push_back(
        cylinder({{0, 0, 0.03}, Eigen::Quaterniond::Identity()}, {radius_m, radius_m, 0.08}, core));
  }
  out["triangles"].push_back(triangles({{1.7 * radius_m, 0, 0.05},
                                        {0.8 * radius_m, 0.6 * radius_m, 0.05},
                                        {0.8 * radius_m, -0.6 * radius_m, 0.05}},
                                       colour));
  const Eigen::Vector3d foot(0, 0, -robot.height_m);
  out["lines"].push_back(
      line(LineType::kList, {Eigen::Vector3d::Zero(), foot}, 1.0, fade(colour, 0.5)));
  out["texts"].push_back(
      label(is_jammed ? robot.name + " jammed" : robot.name, {0, 0, 0.25}, kLabel_px, colour));
  out["metadata"].push_back(
      metadata("sensor_range_m", fmt::format("{:g}", robot.sensor.range_max_m)));
  out["metadata"].push_back(metadata("jammed", is_jammed ? "yes" : "no"));
  return out;
}

Json view_entity(const scenario::RobotSpec& robot, const Colour& colour, bool is_jammed,
                 Time time) {
  Json out = entity("view/" + robot.name, robot.name, time, true);
  const std::vector<Eigen::Vector3d> arc = field_of_view(robot.sensor, robot.height_m);
  const Eigen::Vector3d foot(0, 0, -robot.height_m);
  std::vector<Eigen::Vector3d> fan;
  for (std::size_t i = 0; i + 1 < arc.size(); ++i) {
    fan.insert(fan.end(), {foot, arc[i], arc[i + 1]});
  }
  out["triangles"].push_back(triangles(fan, fade(colour, is_jammed ? 0.25 : 0.12)));
  std::vector<Eigen::Vector3d> edge = arc;
  if (robot.sensor.fov_rad < 2.0 * kPi - 1e-6) {
    edge.insert(edge.begin(), foot);
    edge.push_back(foot);
  }
  out["lines"].push_back(line(LineType::kStrip, edge, is_jammed ? 2.5 : 1.5, fade(colour, 0.8)));
  return out;
}

std::size_t index_of(const scenario::Scenario& scenario, const std::string& robot) {
  const auto is_it = [&](const scenario::RobotSpec& each) { return each.name == robot; };
  return static_cast<std::size_t>(
      std::find_if(scenario.robots.begin(), scenario.robots.end(), is_it) -
      scenario.robots.begin());
}

// Returns a SceneUpdate with the entity make(robot, colour, is_jammed, index) of each robot.
Json robots_as(const scenario::Scenario& scenario, const std::set<std::string>& jammed,
               const auto& make) {
  std::vector<Json> entities;
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const bool is_jammed = jammed.contains(scenario.robots[i].name);
    entities.push_back(make(
        scenario.robots[i],
        is_jammed ? of_role("jammed") : of_paint(robot_appearance(i).body_paint()), is_jammed, i));
  }
  return scene_update(std::move(entities));
}

}  // namespace

std::optional<Colour> robot_colour(const scenario::Scenario& scenario, const std::string& robot) {
  const std::size_t index = index_of(scenario, robot);
  return index < scenario.robots.size()
             ? std::optional(of_paint(robot_appearance(index).body_paint()))
             : std::nullopt;
}

Json world_scene(const models::World& world, Time time) {
  Json bounds = entity("world/bounds", kWorldFrame, time, false);
  bounds["lines"].push_back(
      line(LineType::kLoop, corners(world.bounds, 0.0), 2.0, of_role("wall")));
  bounds["lines"].push_back(
      line(LineType::kLoop, corners(world.bounds, world.ceiling_m), 1.0, of_role("wall", 0.35)));
  std::vector<Json> entities{std::move(bounds)};
  for (std::size_t i = 0; i < world.obstacles.size(); ++i) {
    const models::Obstacle& obstacle = world.obstacles[i];
    entities.push_back(entity(fmt::format("obstacle:{}", i), kWorldFrame, time, false));
    entities.back()["cubes"].push_back(
        box_on_ground(obstacle.footprint, obstacle.height_m, of_role("obstacle", 0.85)));
  }
  for (const models::Region& region : world.regions) {
    entities.push_back(entity("region/" + region.name, kWorldFrame, time, false));
    entities.back()["cubes"].push_back(
        box_on_ground(region.footprint, 0.01, of_role("region", 0.25)));
  }
  return scene_update(std::move(entities));
}

Json robots_scene(const scenario::Scenario& scenario, const std::set<std::string>& jammed,
                  Time time) {
  return robots_as(scenario, jammed,
                   [&](const auto& robot, const Colour& colour, bool is_jammed, std::size_t index) {
                     return robot_entity(robot, colour, is_jammed, index, time);
                   });
}

Json views_scene(const scenario::Scenario& scenario, const std::set<std::string>& jammed,
                 Time time) {
  return robots_as(
      scenario, jammed,
      [&](const auto& robot, const Colour& colour, bool is_jammed, std::size_t /*index*/) {
        return view_entity(robot, colour, is_jammed, time);
      });
}

Json targets_scene(const scenario::Scenario& scenario, Time time) {
  std::vector<Json> entities;
  for (const scenario::TargetSpec& target : scenario.targets) {
    Json out = entity("target/" + target.name, target.name, time, true);
    // A diamond from above, with its corners on the target's circle and one corner forward.
    const double side_m = std::sqrt(2.0) * target.radius_m;
    const Quaternion turned(Eigen::AngleAxisd(0.25 * kPi, Eigen::Vector3d::UnitZ()));
    out["cubes"].push_back(cube({{0, 0, 0.05}, turned}, {side_m, side_m, 0.1}, of_role("truth")));
    out["texts"].push_back(label(target.name, {0, 0, 0.3}, kLabel_px, of_role("truth")));
    out["metadata"].push_back(metadata("target_id", std::to_string(target.id)));
    entities.push_back(std::move(out));
  }
  return scene_update(std::move(entities));
}

Json plan_scene(const models::RobotPlan& plan, const std::optional<Colour>& of_robot) {
  const std::vector<Eigen::Vector3d> points = points_of(plan.trajectory, kPlanPiece_s);
  const bool is_searched = plan.source == models::PlanSource::kSearched;
  const Colour colour = plan.late ? of_role("late")
                        : !is_searched
                            ? of_role("fallback")
                            : of_robot.value_or(of_paint(robot_appearance(0).body_paint()));
  Json out = entity("plan/" + plan.robot, kWorldFrame, plan.stamp.time, false);
  out["lines"].push_back(line(LineType::kStrip, points, 2.5, colour));
  out["spheres"].push_back(
      cube({points.back(), Quaternion::Identity()}, Eigen::Vector3d::Constant(0.12), colour));
  out["metadata"].push_back(metadata("round", models::round_text(plan.round)));
  out["metadata"].push_back(metadata("source", name_of(plan.source)));
  out["metadata"].push_back(metadata("late", plan.late ? "yes" : "no"));
  return scene_update({std::move(out)});
}

Json proposal_scene(const models::TeamProposal& proposal, const scenario::Scenario& scenario,
                    Time received_at) {
  const std::size_t proposer = index_of(scenario, proposal.robot);
  Json out = entity("proposal/" + proposal.robot, kWorldFrame, received_at, false);
  out["lifetime"] = to_json(proposal.stamp.time - received_at);
  std::vector<std::string> moved;
  for (const models::TeamChoice& choice : proposal.choices) {
    const std::vector<Eigen::Vector3d> points = points_of(choice.trajectory, kDash_s);
    std::vector<Eigen::Vector3d> dashes;
    for (std::size_t i = proposer % 2; i + 1 < points.size(); i += 2) {
      dashes.insert(dashes.end(), {points[i], points[i + 1]});
    }
    if (!dashes.empty()) {
      out["lines"].push_back(line(LineType::kList, dashes, 1.5,
                                  of_paint(robot_appearance(proposer).body_paint(), 0.9)));
    }
    moved.push_back(choice.robot);
  }
  out["metadata"].push_back(metadata("round", models::round_text(proposal.round)));
  out["metadata"].push_back(metadata("value_nat", fmt::format("{:.2f}", proposal.value_nats)));
  out["metadata"].push_back(metadata("moves", fmt::format("{}", fmt::join(moved, ", "))));
  return scene_update({std::move(out)});
}

std::vector<Eigen::Vector3d> ellipse(const PositionEstimate& estimate, int count) {
  const Eigen::Matrix2d covariance = estimate.covariance_m2.topLeftCorner<2, 2>();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(covariance);
  const Eigen::Vector2d sigma = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const double z_m = estimate.mean_m.size() > 2 ? estimate.mean_m(2) : 0.0;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double angle_rad = 2.0 * kPi * i / count;
    const Eigen::Vector2d unit(std::cos(angle_rad), std::sin(angle_rad));
    const Eigen::Vector2d p =
        estimate.mean_m.head<2>() +
        appearance().ellipse_radius() * (axes.eigenvectors() * sigma.cwiseProduct(unit));
    points.emplace_back(p.x(), p.y(), z_m);
  }
  return points;
}

Json estimates_scene(const std::string& prefix, const std::vector<EstimateView>& estimates,
                     const std::vector<std::string>& gone, Time time) {
  const Colour estimate_colour = of_role("estimate");
  std::vector<Json> entities;
  for (const EstimateView& view : estimates) {
    const PositionEstimate& estimate = view.estimate;
    Json out = entity(prefix + "/" + view.name, kWorldFrame, time, false);
    out["lifetime"] = to_json(view.lifetime);
    std::vector<Eigen::Vector3d> edge = ellipse(estimate, 32);
    const double z_m = edge.front().z() + 0.02;
    for (Eigen::Vector3d& point : edge) {
      point.z() = z_m;
    }
    const double x_m = estimate.mean_m(0);
    const double y_m = estimate.mean_m(1);
    out["lines"].push_back(line(LineType::kLoop, edge, 2.0, estimate_colour));
    // Scale the cross with the ellipse so that both are visible from the same distance.
    const double cross_m = std::max(kCrossLeast_m, kCrossShare * estimate.sigma_m());
    out["lines"].push_back(line(LineType::kList,
                                {{x_m - cross_m, y_m, z_m},
                                 {x_m + cross_m, y_m, z_m},
                                 {x_m, y_m - cross_m, z_m},
                                 {x_m, y_m + cross_m, z_m}},
                                2.0, estimate_colour));
    constexpr double kSmall_px = 11.0;
    out["texts"].push_back(label(view.name, {x_m, y_m, z_m}, kSmall_px, estimate_colour));
    out["metadata"].push_back(metadata("target_id", std::to_string(view.target_id)));
    out["metadata"].push_back(metadata("robot", estimate.robot));
    out["metadata"].push_back(metadata("sigma_m", fmt::format("{:.3f}", estimate.sigma_m())));
    if (view.error_m) {
      out["metadata"].push_back(metadata("error_m", fmt::format("{:.3f}", *view.error_m)));
    }
    entities.push_back(std::move(out));
  }
  Json update = scene_update(std::move(entities));
  for (const std::string& name : gone) {
    update["deletions"].push_back(
        {{"timestamp", to_json(time)}, {"type", 0}, {"id", prefix + "/" + name}});
  }
  return update;
}

Json track_entity(const std::string& body, const std::vector<Eigen::Vector3d>& points,
                  const std::optional<Colour>& of_robot, Time time) {
  Json out = entity("track/" + body, kWorldFrame, time, false);
  out["lines"].push_back(
      line(LineType::kStrip, points, 1.5, fade(of_robot.value_or(of_role("truth")), 0.55)));
  return out;
}

Json measurement_scene(const models::RobotMeasurement& detections,
                       const models::SensorModel& sensor, int position_dim) {
  const models::Viewpoint& from = detections.viewpoint;
  const Eigen::Vector3d eye(from.world_from_body.x_m, from.world_from_body.y_m, from.height_m);
  std::vector<Eigen::Vector3d> points;
  for (const models::Detection& detection : detections.detections) {
    // Skip measurements of another sensor kind than the scenario's.
    if (detection.measurement.z.size() != sensor.measurement_dim(position_dim)) {
      continue;
    }
    const auto seen = models::position_from(sensor, from, detection.measurement.z, position_dim);
    if (seen) {
      points.push_back(eye);
      points.emplace_back((*seen)(0), (*seen)(1), seen->size() > 2 ? (*seen)(2) : 0.0);
    }
  }
  Json out = entity("measurement/" + detections.robot, kWorldFrame, detections.stamp.time, false);
  out["lifetime"] = to_json(Duration{std::chrono::milliseconds(400)});
  if (!points.empty()) {
    out["lines"].push_back(line(LineType::kList, points, 1.5, of_role("late")));
  }
  out["metadata"].push_back(metadata("jammed", detections.jammed ? "yes" : "no"));
  out["metadata"].push_back(metadata("detections", std::to_string(detections.detections.size())));
  return scene_update({std::move(out)});
}

}  // namespace vantage::logs::foxglove
