#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "logs/foxglove/scene.hpp"
#include "test/logs/foxglove_json.hpp"
#include "test/logs/foxglove_notebook.hpp"

namespace vantage::logs::foxglove {
namespace {

constexpr Time kTime = from_utime(1'700'000'000'250'000);

models::World a_world() {
  models::World world;
  world.bounds = {{-4.0, -2.0}, {5.0, 3.5}};
  world.ceiling_m = 2.5;
  world.obstacles = {{{{-1.0, -1.5}, {0.5, 0.25}}, 0.75}, {{{2.0, 1.0}, {4.0, 2.0}}, 3.0}};
  world.regions = {{"wind", {{-3.0, 0.0}, {-1.0, 2.5}}, 1.0}};
  return world;
}

TEST(WorldScene, HasBoundsObstaclesAndRegions) {
  const models::World world = a_world();
  const Json entities = world_scene(world, kTime).at("entities");
  ASSERT_EQ(entities.size(), 4U);
  for (const Json& each : entities) {
    EXPECT_EQ(each.at("frame_id"), "world");
    EXPECT_EQ(each.at("timestamp"), to_json(kTime));
    EXPECT_EQ(each.at("frame_locked"), false);
  }
  const Json& bounds = entities[0];
  EXPECT_EQ(bounds.at("id"), "world/bounds");
  ASSERT_EQ(bounds.at("lines").size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const Json& loop = bounds.at("lines")[i];
    EXPECT_EQ(loop.at("type"), 1) << "closed line";
    EXPECT_EQ(rgb(loop.at("color")), role("wall"));
    const auto points = points_of(loop);
    ASSERT_EQ(points.size(), 4U);
    double round_m = 0.0;
    double area_m2 = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector3d& next = points[(k + 1) % 4];
      EXPECT_EQ(points[k].z(), i == 0 ? 0.0 : 2.5) << "on the ground, and below the ceiling";
      round_m += (next - points[k]).norm();
      area_m2 += 0.5 * (points[k].x() * next.y() - next.x() * points[k].y());
    }
    EXPECT_NEAR(round_m, 2.0 * (9.0 + 5.5), 1e-9);
    EXPECT_NEAR(area_m2, 9.0 * 5.5, 1e-9);
    expect_near(points[0], {-4.0, -2.0, points[0].z()});
    expect_near(points[2], {5.0, 3.5, points[0].z()});
  }
  EXPECT_EQ(bounds.at("lines")[0].at("color").at("a"), 1.0);
  EXPECT_LT(bounds.at("lines")[1].at("color").at("a"), 0.5) << "translucent from above";
  for (std::size_t i = 0; i < 2; ++i) {
    const models::Obstacle& obstacle = world.obstacles[i];
    EXPECT_EQ(entities[1 + i].at("id"), "obstacle:" + std::to_string(i))
        << "the id that COLLISION uses";
    const Json& cube = entities[1 + i].at("cubes").at(0);
    const auto& [low_m, high_m] = std::pair(obstacle.footprint.min_m, obstacle.footprint.max_m);
    expect_near(low_corner(cube), {low_m.x(), low_m.y(), 0.0});
    expect_near(high_corner(cube), {high_m.x(), high_m.y(), obstacle.height_m});
    EXPECT_EQ(rgb(cube.at("color")), role("obstacle"));
  }
  EXPECT_EQ(entities[3].at("id"), "region/wind");
  const Json& region = entities[3].at("cubes").at(0);
  expect_near(low_corner(region), {-3.0, 0.0, 0.0});
  EXPECT_LT((high_corner(region) - Eigen::Vector3d(-1.0, 2.5, 0.0)).norm(), 0.015) << "flat";
  EXPECT_EQ(rgb(region.at("color")), role("region"));
}

scenario::Scenario ten_robots() {
  scenario::Scenario out = lab();
  out.robots.resize(10, out.robots[0]);
  for (std::size_t i = 0; i < out.robots.size(); ++i) {
    out.robots[i].name = "Q" + std::to_string(i + 1);
    out.robots[i].limits.radius_m = 0.2 + 0.01 * static_cast<double>(i);
    out.robots[i].height_m = 1.0 + 0.1 * static_cast<double>(i);
    out.robots[i].sensor.range_max_m = 2.5 + static_cast<double>(i);
  }
  return out;
}

TEST(RobotsScene, DrawsDiscsWithAHeadingMark) {
  const scenario::Scenario scenario = ten_robots();
  const Json entities = robots_scene(scenario, {"Q3"}, kTime).at("entities");
  ASSERT_EQ(entities.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    const Json& robot = entities[i];
    const scenario::RobotSpec& spec = scenario.robots[i];
    const double radius_m = spec.limits.radius_m;
    const bool is_jammed = i == 2;
    SCOPED_TRACE(spec.name);
    EXPECT_EQ(robot.at("id"), "robot/" + spec.name);
    EXPECT_EQ(robot.at("frame_id"), spec.name);
    EXPECT_EQ(robot.at("frame_locked"), true) << "moves with the body";
    EXPECT_EQ(robot.at("timestamp"), to_json(kTime));
    const RobotAppearance looks = robot_appearance(i);
    const Json& body = robot.at("cylinders").at(0);
    const Eigen::Vector3d size_m = xyz(body.at("size"));
    EXPECT_EQ(size_m.x(), 2.0 * radius_m);
    EXPECT_EQ(size_m.y(), 2.0 * radius_m);
    EXPECT_LT(size_m.z(), radius_m);
    EXPECT_EQ(body.at("bottom_scale"), 1.0);
    EXPECT_EQ(body.at("top_scale"), 1.0);
    expect_near(xyz(body.at("pose").at("position")), {0.0, 0.0, 0.0});
    EXPECT_EQ(rgb(body.at("color")), is_jammed ? role("jammed") : looks.body_paint().middle());
    // A jammed robot's body has the jammed colour and its core has the robot's own colour. Other
    // robots that share a body colour also have a core.
    ASSERT_EQ(robot.at("cylinders").size(), is_jammed || i >= 8 ? 2U : 1U);
    if (is_jammed || i >= 8) {
      const Json& core = robot.at("cylinders").at(1);
      EXPECT_EQ(xyz(core.at("size")).x(), radius_m);
      EXPECT_EQ(xyz(core.at("size")).y(), radius_m);
      EXPECT_EQ(xyz(core.at("size")).z(), size_m.z());
      EXPECT_GT(high_corner(core).z(), high_corner(body).z())
          << "otherwise the core would be hidden";
      EXPECT_LT(low_corner(core).z(), high_corner(body).z()) << "otherwise the core would float";
      EXPECT_EQ(rgb(core.at("color")),
                (is_jammed ? looks.body_paint() : looks.core_paint()).middle());
    }
    const auto nose = points_of(robot.at("triangles").at(0));
    ASSERT_EQ(nose.size(), 3U);
    EXPECT_GT(nose[0].x(), 1.5 * radius_m);
    EXPECT_LT(nose[0].x(), 2.0 * radius_m);
    EXPECT_EQ(nose[0].y(), 0.0);
    EXPECT_EQ(nose[1].x(), nose[2].x());
    EXPECT_EQ(nose[1].y(), -nose[2].y()) << "symmetric";
    for (const std::size_t wing : {1U, 2U}) {
      EXPECT_NEAR(nose[wing].head<2>().norm(), radius_m, 1e-9) << "touches the disc";
    }
    EXPECT_NEAR(nose[1].y(), 0.6 * radius_m, 1e-9);
    for (const Eigen::Vector3d& corner : nose) {
      EXPECT_EQ(corner.z(), nose[0].z());
      EXPECT_GT(corner.z(), high_corner(body).z()) << "above the disc";
      EXPECT_LT(corner.z(), 2.0 * high_corner(body).z());
    }
    const auto foot = points_of(robot.at("lines").at(0));
    ASSERT_EQ(foot.size(), 2U);
    expect_near(foot[0], {0.0, 0.0, 0.0});
    expect_near(foot[1], {0.0, 0.0, -spec.height_m});
    EXPECT_EQ(robot.at("lines").at(0).at("type"), 2);
    EXPECT_LT(robot.at("lines").at(0).at("color").at("a"), 1.0);
    const Json& words = robot.at("texts").at(0);
    EXPECT_EQ(words.at("text"), is_jammed ? "Q3 jammed" : spec.name);
    EXPECT_GT(xyz(words.at("pose").at("position")).z(), 2.0 * high_corner(body).z());
    EXPECT_LT(xyz(words.at("pose").at("position")).z(), 0.3);
    EXPECT_EQ(words.at("font_size"), 13.0);
    EXPECT_EQ(told(robot, "sensor_range_m"), fmt::format("{:g}", spec.sensor.range_max_m));
    EXPECT_EQ(told(robot, "jammed"), is_jammed ? "yes" : "no");
  }
}

// The view is the part of a disc on the ground within the field of view, drawn as a fan from the
// point below the robot.
TEST(ViewsScene, DrawsTheGroundSectorOfTheSensor) {
  scenario::Scenario scenario = lab();
  const double fovs_rad[] = {1.2, 2.0 * kPi, 3.0 * kPi};
  for (std::size_t i = 0; i < 3; ++i) {
    scenario.robots[i].sensor.fov_rad = fovs_rad[i];
    scenario.robots[i].sensor.range_max_m = 2.0 + static_cast<double>(i);
    scenario.robots[i].height_m = 1.5;
  }
  const Json entities = views_scene(scenario, {"Q2"}, kTime).at("entities");
  ASSERT_EQ(entities.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    SCOPED_TRACE(i);
    const Json& view = entities[i];
    EXPECT_EQ(view.at("id"), "view/" + scenario.robots[i].name);
    EXPECT_EQ(view.at("frame_id"), scenario.robots[i].name);
    EXPECT_EQ(view.at("frame_locked"), true);
    const double range_m = scenario.robots[i].sensor.range_max_m;
    const double fov_rad = std::min(fovs_rad[i], 2.0 * kPi);
    const Eigen::Vector3d foot(0.0, 0.0, -1.5);
    const auto fan = points_of(view.at("triangles").at(0));
    ASSERT_EQ(fan.size() % 3, 0U);
    double area_m2 = 0.0;
    Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < fan.size(); k += 3) {
      expect_near(fan[k], foot);
      for (const std::size_t far : {k + 1, k + 2}) {
        EXPECT_NEAR((fan[far] - foot).norm(), range_m, 1e-9);
        EXPECT_NEAR(fan[far].z(), -1.5, 1e-12);
      }
      area_m2 += 0.5 * (fan[k + 1] - foot).cross(fan[k + 2] - foot).z();
      middle_m += fan[k + 1] + fan[k + 2] - 2.0 * foot;
    }
    EXPECT_NEAR(area_m2, 0.5 * fov_rad * range_m * range_m, 0.01 * area_m2);
    EXPECT_NEAR(middle_m.y(), 0.0, 1e-9) << "symmetric";
    if (i == 0) {
      EXPECT_GT(middle_m.x(), 0.0) << "ahead";
    }
    auto edge = points_of(view.at("lines").at(0));
    EXPECT_EQ(view.at("lines").at(0).at("type"), 0);
    expect_near(edge.front(), edge.back());
    if (i == 0) {
      expect_near(edge.front(), foot);
      edge = {edge.begin() + 1, edge.end() - 1};
    }
    ASSERT_EQ(edge.size(), fan.size() / 3 + 1);
    for (std::size_t k = 0; k < edge.size(); ++k) {
      const double angle_rad =
          fov_rad * (static_cast<double>(k) / static_cast<double>(edge.size() - 1) - 0.5);
      expect_near(edge[k],
                  foot + range_m * Eigen::Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0.0));
    }
  }
  // A jammed robot's view is red, with a thicker line and a more opaque fill.
  const auto line_of = [&](std::size_t i) { return entities[i].at("lines").at(0); };
  const auto fill_of = [&](std::size_t i) { return entities[i].at("triangles").at(0).at("color"); };
  EXPECT_EQ(rgb(line_of(1).at("color")), role("jammed"));
  EXPECT_EQ(rgb(fill_of(1)), role("jammed"));
  EXPECT_EQ(rgb(fill_of(0)), robot_appearance(0).body_paint().middle());
  EXPECT_EQ(rgb(line_of(2).at("color")), robot_appearance(2).body_paint().middle());
  EXPECT_GT(line_of(1).at("thickness"), line_of(0).at("thickness"));
  EXPECT_GT(fill_of(1).at("a"), fill_of(0).at("a"));
  EXPECT_LT(fill_of(1).at("a"), line_of(1).at("color").at("a"));
  EXPECT_LE(line_of(1).at("color").at("a"), 1.0);
}

// A field of view of more than half a turn, but less than a full turn, has two straight edges that
// meet at its origin.
TEST(ViewsScene, DrawsASectorOrAFullDisc) {
  scenario::Scenario scenario = lab();
  scenario.robots.resize(1);
  for (const double fov_rad : {0.5, 2.5, 3.3, 4.0, 6.0, 2.0 * kPi - 1e-4, 2.0 * kPi, 7.0}) {
    scenario.robots[0].sensor.fov_rad = fov_rad;
    const Json view = views_scene(scenario, {}, kTime).at("entities").at(0);
    const auto edge = points_of(view.at("lines").at(0));
    const Eigen::Vector3d foot(0.0, 0.0, -scenario.robots[0].height_m);
    const bool is_all_around = fov_rad >= 2.0 * kPi;
    EXPECT_EQ((edge.front() - foot).norm() < 1e-9, !is_all_around) << fov_rad;
    EXPECT_EQ((edge.back() - foot).norm() < 1e-9, !is_all_around) << fov_rad;
  }
}

// Lines are clearly visible, the ground is visible through fills, and obstacles are more opaque
// than regions.
TEST(Scenes, HaveVisibleColoursAndSizes) {
  const models::World world = a_world();
  const Json of_world = world_scene(world, kTime).at("entities");
  const auto alpha = [](const Json& drawn) { return drawn.at("color").at("a").get<double>(); };
  EXPECT_GT(alpha(of_world[1].at("cubes").at(0)), 0.7) << "an obstacle";
  EXPECT_LT(alpha(of_world[3].at("cubes").at(0)), 0.5) << "objects in a region stay visible";
  EXPECT_GT(alpha(of_world[3].at("cubes").at(0)), 0.15);
  const Json views = views_scene(lab(), {"Q1"}, kTime).at("entities");
  for (const Json& each : views) {
    EXPECT_GT(alpha(each.at("triangles").at(0)), 0.1);
    EXPECT_LT(alpha(each.at("triangles").at(0)), 0.4) << "the ground stays visible";
    EXPECT_GT(alpha(each.at("lines").at(0)), 0.6) << "the border is visible";
  }
  EstimateView estimate{4, "R5", {}, {}, Duration{0}};
  estimate.estimate.mean_m = Eigen::Vector3d(3.0, -1.0, 0.7);
  estimate.estimate.covariance_m2 = 0.04 * Eigen::Matrix3d::Identity();
  const Json known = estimates_scene("estimate", {estimate}, {}, kTime).at("entities");
  for (const Json& each : known[0].at("lines")) {
    EXPECT_EQ(each.at("thickness"), known[0].at("lines")[0].at("thickness")) << "ellipse and cross";
    for (const Eigen::Vector3d& point : points_of(each)) {
      EXPECT_NEAR(point.z(), 0.7, 0.03) << "at the estimated height";
    }
  }
  models::RobotPlan plan;
  plan.trajectory = {kTime, {1.0, -2.0, 0.0}, 1.25, {{{1.0, 0.0}, 1.0, 0.0}}};
  const Json planned = plan_scene(plan, std::nullopt).at("entities");
  const double end_m = xyz(planned[0].at("spheres").at(0).at("size")).x();
  EXPECT_GT(end_m, 0.1);
  EXPECT_LT(end_m, 0.2) << "smaller than a robot";
  const Json track =
      Json::array({track_entity("Q1", {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}}, std::nullopt, kTime)});
  const Json robots = robots_scene(lab(), {}, kTime).at("entities");
  for (const Json& entities : {of_world, views, known, planned, track, robots}) {
    for (const Json& entity : entities) {
      for (const Json& each : entity.at("lines")) {
        EXPECT_GE(each.at("thickness").get<double>(), 1.0) << entity.at("id");
        EXPECT_LT(each.at("thickness").get<double>(), 3.0) << entity.at("id");
        EXPECT_GT(alpha(each), 0.3) << entity.at("id");
        EXPECT_LE(alpha(each), 1.0) << entity.at("id");
      }
    }
  }
  EXPECT_EQ(of_world[0].at("lines")[0].at("thickness"),
            2.0 * of_world[0].at("lines")[1].at("thickness").get<double>())
      << "the ground's edge is thicker than the ceiling's";
}

TEST(TargetsScene, DrawsADiamondPointingAhead) {
  scenario::Scenario scenario = lab();
  scenario.targets[1].radius_m = 0.35;
  scenario.targets[1].id = 7;
  const Json entities = targets_scene(scenario, kTime).at("entities");
  ASSERT_EQ(entities.size(), scenario.targets.size());
  for (std::size_t i = 0; i < entities.size(); ++i) {
    const scenario::TargetSpec& spec = scenario.targets[i];
    EXPECT_EQ(entities[i].at("id"), "target/" + spec.name);
    EXPECT_EQ(entities[i].at("frame_id"), spec.name);
    EXPECT_EQ(entities[i].at("frame_locked"), true);
    EXPECT_EQ(told(entities[i], "target_id"), std::to_string(spec.id));
    const Json& cube = entities[i].at("cubes").at(0);
    EXPECT_EQ(rgb(cube.at("color")), role("truth"));
    EXPECT_NEAR(low_corner(cube).z(), 0.0, 1e-12) << "stands on the ground";
    const Json& turn = cube.at("pose").at("orientation");
    const Quaternion turned(turn.at("w").get<double>(), turn.at("x").get<double>(),
                            turn.at("y").get<double>(), turn.at("z").get<double>());
    const Eigen::Vector3d half_m = 0.5 * xyz(cube.at("size"));
    const Eigen::Vector3d ahead_m = turned * Eigen::Vector3d(half_m.x(), -half_m.y(), 0.0);
    expect_near(ahead_m, {spec.radius_m, 0.0, 0.0});
    const Eigen::Vector3d left_m = turned * Eigen::Vector3d(half_m.x(), half_m.y(), 0.0);
    expect_near(left_m, {0.0, spec.radius_m, 0.0});
    const Json& words = entities[i].at("texts").at(0);
    EXPECT_EQ(words.at("text"), spec.name);
    EXPECT_EQ(rgb(words.at("color")), role("truth"));
    EXPECT_GT(xyz(words.at("pose").at("position")).z(), 1.5 * high_corner(cube).z());
  }
}

}  // namespace
}  // namespace vantage::logs::foxglove
