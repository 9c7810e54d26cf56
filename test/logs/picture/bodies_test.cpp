#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "logs/picture/label_placer.hpp"
#include "logs/picture/layout.hpp"
#include "logs/picture/map_layer.hpp"
#include "logs/picture/svg.hpp"
#include "test/logs/picture/svg_text.hpp"

namespace vantage::logs {
namespace {

using test::elements;
using test::number;
using Attributes = std::map<std::string, std::string>;
using Points = std::vector<Eigen::Vector2d>;

constexpr Time kNow = from_utime(1'700'000'000'000'000);

Points points_of(const Attributes& element) {
  Points out;
  std::istringstream in(element.at("points"));
  char comma = ' ';
  for (double x = 0.0, y = 0.0; in >> x >> comma >> y;) {
    out.emplace_back(x, y);
  }
  return out;
}

void expect_near(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  EXPECT_LT((a - b).norm(), 0.011) << a.transpose() << " and " << b.transpose();
}

struct Example {
  scenario::Scenario scenario;
  Scene scene;
  [[nodiscard]] Layout layout() const { return {scenario.world.bounds, 0.0}; }
  /// Returns the SVG that `draw` draws.
  template <class Draw>
  [[nodiscard]] std::string drawn(const Draw& draw) const {
    Svg svg(2000.0, 1000.0);
    draw(svg, layout());
    return svg.str();
  }
};

Example three_robots() {
  Example out;
  out.scenario.world.bounds = {{-4.0, -1.0}, {4.0, 5.0}};
  out.scenario.robots.resize(3);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string name = "Q" + std::to_string(i + 1);
    out.scenario.robots[i].name = name;
    out.scenario.robots[i].sensor.range_max_m = 1.0 + 0.5 * static_cast<double>(i);
    out.scenario.robots[i].sensor.fov_rad = 0.5 + static_cast<double>(i);
    const auto at = static_cast<double>(i);
    out.scene.robots[name].world_from_body = Pose2{-3.0 + 2.0 * at, 0.5 + at, 0.3 + 2.0 * at};
  }
  out.scene.time = kNow;
  return out;
}

// The heading mark is a triangle at the body's edge that is symmetric about the heading.
TEST(DrawRobot, ShowsHeadingAndCore) {
  const Eigen::Vector2d at_px(200.0, 100.0);
  for (const double yaw_rad : {0.0, kPi / 2, -2.5}) {
    Svg svg(400.0, 400.0);
    draw_robot(svg, at_px, yaw_rad, 20.0, "#111111", "#222222");
    const Eigen::Vector2d ahead(std::cos(yaw_rad), -std::sin(yaw_rad));  // y points down
    const Eigen::Vector2d aside(-ahead.y(), ahead.x());
    const auto noses = elements(svg.str(), "polygon");
    ASSERT_EQ(noses.size(), 1U);
    EXPECT_EQ(noses[0].at("fill"), "#111111");
    const Points nose = points_of(noses[0]);
    ASSERT_EQ(nose.size(), 3U);
    EXPECT_NEAR((nose[0] - at_px).dot(aside), 0.0, 0.02);
    EXPECT_GT((nose[0] - at_px).dot(ahead), 1.5 * 20.0);
    EXPECT_LT((nose[0] - at_px).dot(ahead), 2.0 * 20.0);
    EXPECT_NEAR((nose[1] - at_px).dot(aside), -(nose[2] - at_px).dot(aside), 0.02);
    for (const std::size_t wing : {1U, 2U}) {
      EXPECT_NEAR((nose[wing] - at_px).norm(), 20.0, 1.0) << "at the body's edge";
      EXPECT_NEAR((nose[wing] - at_px).dot(ahead), (nose[3 - wing] - at_px).dot(ahead), 0.02);
      EXPECT_NEAR(std::abs((nose[wing] - at_px).dot(aside)), 14.0, 0.02);
    }
    const auto circles = elements(svg.str(), "circle");
    ASSERT_EQ(circles.size(), 2U);
    for (const Attributes& each : circles) {
      expect_near({number(each, "cx"), number(each, "cy")}, at_px);
    }
    EXPECT_EQ(number(circles[0], "r"), 20.0);
    EXPECT_EQ(circles[0].at("fill"), "#111111");
    EXPECT_EQ(number(circles[1], "r"), 10.0);
    EXPECT_EQ(circles[1].at("fill"), "#222222");
  }
  Svg svg(400.0, 400.0);
  draw_robot(svg, at_px, 0.0, 20.0, "#111111", "#111111");
  EXPECT_EQ(elements(svg.str(), "circle").size(), 1U);
}

// A field of view of more than half a turn, but less than a full turn, is drawn as a sector.
TEST(DrawView, DrawsASectorOrAFullDisc) {
  const Example it = three_robots();
  models::SensorModel sensor;
  sensor.range_max_m = 1.5;
  for (const double fov_rad : {0.5, 3.0, 3.3, 4.0, 6.0, 2.0 * kPi - 1e-6, 2.0 * kPi, 7.0}) {
    sensor.fov_rad = fov_rad;
    const std::string svg = it.drawn([&](Svg& to, const Layout& on) {
      draw_view(to, on, sensor, {1.0, 2.0, 0.7}, "#111111");
    });
    const bool is_all_around = fov_rad >= 2.0 * kPi;
    EXPECT_EQ(elements(svg, "circle").size(), is_all_around ? 1U : 0U) << fov_rad;
    const auto sectors = elements(svg, "polygon");
    ASSERT_EQ(sectors.size(), is_all_around ? 0U : 1U) << fov_rad;
    if (!is_all_around) {
      const Points edge = points_of(sectors[0]);
      double area_px2 = 0.0;
      for (std::size_t k = 0; k < edge.size(); ++k) {
        const Eigen::Vector2d& next = edge[(k + 1) % edge.size()];
        area_px2 += 0.5 * (next.x() * edge[k].y() - edge[k].x() * next.y());  // y points down
      }
      const double range_px = 1.5 * it.layout().px_per_m;
      EXPECT_NEAR(area_px2 / (0.5 * fov_rad * range_px * range_px), 1.0, 0.01) << fov_rad;
    }
  }
}

TEST(DrawViewsAndPlans, ShowsEachSensorsView) {
  Example it = three_robots();
  it.scenario.robots[2].sensor.fov_rad = 2.0 * kPi;
  it.scene.jammed = {"Q2"};
  const Layout layout = it.layout();
  const std::string svg = it.drawn(
      [&](Svg& to, const Layout& on) { draw_views_and_plans(to, on, it.scenario, it.scene); });
  const auto sectors = elements(svg, "polygon");
  ASSERT_EQ(sectors.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const models::SensorModel& sensor = it.scenario.robots[i].sensor;
    const Pose2& pose = *it.scene.robots.at(it.scenario.robots[i].name).world_from_body;
    const Points edge = points_of(sectors[i]);
    ASSERT_EQ(edge.size(), 34U);
    expect_near(edge[0], layout.page_from_world(pose.position_m()));
    for (std::size_t k = 0; k <= 32; ++k) {
      const double angle_rad =
          pose.yaw_rad + sensor.fov_rad * (static_cast<double>(k) / 32.0 - 0.5);
      const Eigen::Vector2d direction(std::cos(angle_rad), std::sin(angle_rad));
      expect_near(edge[1 + k],
                  layout.page_from_world(pose.position_m() + sensor.range_max_m * direction));
    }
    EXPECT_EQ(sectors[i].at("fill"), i == 1 ? role_colour("jammed") : robot_colour(0));
  }
  const auto discs = elements(svg, "circle");
  ASSERT_EQ(discs.size(), 1U);
  EXPECT_NEAR(number(discs[0], "r"), 2.0 * layout.px_per_m, 0.01);
  EXPECT_EQ(discs[0].at("fill"), robot_colour(2));
  it.scene.robots.at("Q1").world_from_body.reset();
  it.scene.robots.erase("Q2");
  const std::string fewer = it.drawn(
      [&](Svg& to, const Layout& on) { draw_views_and_plans(to, on, it.scenario, it.scene); });
  EXPECT_TRUE(elements(fewer, "polygon").empty()) << "their positions are unknown";
}

// The plan is drawn from the present, or from its start if that is later, to its final hover.
TEST(DrawViewsAndPlans, ShowsTheRemainingPlan) {
  Example it = three_robots();
  const Layout layout = it.layout();
  for (const double start_s : {0.25, -0.55}) {
    models::RobotPlan plan;
    plan.trajectory = {kNow + from_seconds(start_s),
                       {1.0, 2.0, kPi / 2},
                       1.0,
                       {{{1.0, 0.0}, 1.0, 0.0}, {{1.0, -1.0}, 1.0, 0.0}}};
    it.scene.robots.at("Q2").plan = plan;
    const std::string svg = it.drawn(
        [&](Svg& to, const Layout& on) { draw_views_and_plans(to, on, it.scenario, it.scene); });
    const auto ways = elements(svg, "polyline");
    ASSERT_EQ(ways.size(), 1U);
    EXPECT_EQ(ways[0].at("stroke"), robot_colour(1));
    const Points way = points_of(ways[0]);
    const double from_s = std::max(0.0, start_s);
    const auto pieces = static_cast<std::size_t>(std::ceil((2.0 + start_s - from_s) / 0.1 - 1e-9));
    ASSERT_EQ(way.size(), pieces + 1);
    for (std::size_t k = 0; k <= pieces; ++k) {
      const double at_s = std::min(from_s + 0.1 * static_cast<double>(k), 2.0 + start_s);
      const Pose2 pose = models::at(plan.trajectory, kNow + from_seconds(at_s)).world_from_body;
      expect_near(way[k], layout.page_from_world(pose.position_m()));
    }
    const auto marks = elements(svg, "circle");
    ASSERT_EQ(marks.size(), 1U);
    expect_near({number(marks[0], "cx"), number(marks[0], "cy")}, way.back());
    EXPECT_GT(number(marks[0], "r"), 3.0) << "large enough to be visible";
    EXPECT_LT(number(marks[0], "r"), 8.0) << "smaller than a robot";
    EXPECT_EQ(marks[0].at("stroke"), robot_colour(1));
  }
}

// The last 20 s are drawn strongly and older parts faintly, without a gap.
TEST(DrawTracks, DrawsOldPartsFaintly) {
  Example it = three_robots();
  it.scenario.robots.resize(2);
  it.scene.targets[4];
  const Layout layout = it.layout();
  const auto way = [](double y_m) {
    std::vector<TrackPoint> out;
    for (const double ago_s : {60.0, 40.0, 20.000001, 20.0, 10.0, 0.0}) {
      out.push_back({kNow - from_seconds(ago_s), {0.05 * ago_s - 1.0, y_m}});
    }
    return out;
  };
  it.scene.robots.at("Q1").track = way(1.0);
  it.scene.robots.at("Q2").track = way(2.0);
  it.scene.targets.at(4).track = way(3.0);
  const auto lines = elements(
      it.drawn([&](Svg& to, const Layout& on) { draw_tracks(to, on, it.scenario, it.scene); }),
      "polyline");
  ASSERT_EQ(lines.size(), 6U);  // target, Q1, Q2; each: old part, recent part
  for (std::size_t i = 0; i < 3; ++i) {
    const double y_m = i == 0 ? 3.0 : static_cast<double>(i);
    const std::string_view colour = i == 0 ? role_colour("truth") : robot_colour(i - 1);
    const Attributes& old = lines[2 * i];
    const Attributes& recent = lines[2 * i + 1];
    EXPECT_EQ(old.at("stroke"), colour);
    EXPECT_EQ(recent.at("stroke"), colour);
    const auto all = way(y_m);
    const Points old_px = points_of(old);
    const Points recent_px = points_of(recent);
    ASSERT_EQ(old_px.size(), 3U);
    ASSERT_EQ(recent_px.size(), 4U);
    for (std::size_t k = 0; k < 3; ++k) {
      expect_near(old_px[k], layout.page_from_world(all[k].position_m));
    }
    for (std::size_t k = 0; k < 4; ++k) {
      expect_near(recent_px[k], layout.page_from_world(all[k + 2].position_m));
    }
    EXPECT_NEAR(number(old, "stroke-width"), 0.5 * number(recent, "stroke-width"), 1e-9);
    EXPECT_LT(number(old, "stroke-opacity"), 0.2);
    EXPECT_GT(number(recent, "stroke-opacity"), 0.4);
    EXPECT_LE(number(recent, "stroke-opacity"), 1.0);
    EXPECT_GE(number(recent, "stroke-width"), 1.0);
    EXPECT_LE(number(recent, "stroke-width"), 4.0);
  }
  EXPECT_GT(number(lines[3], "stroke-width"), number(lines[1], "stroke-width"));
  EXPECT_GT(number(lines[3], "stroke-opacity"), number(lines[1], "stroke-opacity"));
}

TEST(DrawEstimates, OrientsTheEllipseByTheCovariance) {
  for (const double turn_rad : {0.5, -0.5, 1.2}) {
    Example it = three_robots();
    const Layout layout = it.layout();
    PositionEstimate estimate;
    estimate.mean_m = Eigen::Vector2d(1.0, 3.0);
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(turn_rad).toRotationMatrix();
    estimate.covariance_m2 = turn * Eigen::Vector2d(0.09, 0.01).asDiagonal() * turn.transpose();
    it.scene.targets[0].estimate = estimate;
    it.scene.targets[0].track = {{kNow, {-1.0, 0.0}}, {kNow, {0.5, 4.0}}};
    it.scene.targets[1].track = {{kNow, {-1.0, 0.0}}};  // not tracked by any robot
    const std::string svg =
        it.drawn([&](Svg& to, const Layout& on) { draw_estimates(to, on, it.scene); });
    const auto ellipses = elements(svg, "ellipse");
    ASSERT_EQ(ellipses.size(), 1U);
    const double rx = number(ellipses[0], "rx");
    const double ry = number(ellipses[0], "ry");
    EXPECT_NEAR(std::max(rx, ry), 0.3 * appearance().ellipse_radius() * layout.px_per_m, 0.01);
    EXPECT_NEAR(std::min(rx, ry), 0.1 * appearance().ellipse_radius() * layout.px_per_m, 0.01);
    double x = 0.0;
    double y = 0.0;
    double angle_deg = 0.0;
    ASSERT_EQ(std::sscanf(ellipses[0].at("transform").c_str(), "translate(%lf %lf) rotate(%lf)", &x,
                          &y, &angle_deg),
              3);
    const Eigen::Vector2d mean_px = layout.page_from_world({1.0, 3.0});
    expect_near({x, y}, mean_px);
    // The angle of the long axis is clockwise on the page; an ellipse is unchanged by half a turn.
    const double long_deg = angle_deg + (rx > ry ? 0.0 : 90.0);
    EXPECT_NEAR(std::remainder(long_deg + degrees(turn_rad), 180.0), 0.0, 0.02);
    const auto lines = elements(svg, "line");
    ASSERT_EQ(lines.size(), 3U);
    const auto end = [&](std::size_t i, const char* which) -> Eigen::Vector2d {
      const std::string n = which;
      return {number(lines[i], ("x" + n).c_str()), number(lines[i], ("y" + n).c_str())};
    };
    expect_near(end(0, "1"), mean_px);
    expect_near(end(0, "2"), layout.page_from_world({0.5, 4.0}));
    for (const std::size_t i : {1U, 2U}) {  // the two lines of the cross
      expect_near(0.5 * (end(i, "1") + end(i, "2")), mean_px);
      const Eigen::Vector2d arm_px = 0.5 * (end(i, "2") - end(i, "1"));
      EXPECT_EQ(arm_px.x(), 5.0);
      EXPECT_EQ(arm_px.y(), i == 1 ? 5.0 : -5.0);
    }
  }
}

struct Shown {
  std::string words;
  Eigen::AlignedBox2d box_px;
};

/// Returns the labels with the boxes that their words fill.
std::vector<Shown> labels_of(const std::string& svg) {
  std::vector<Shown> out;
  for (const Attributes& each : elements(svg, "text")) {
    const double size_px = number(each, "font-size");
    const std::string& words = each.at("words");
    const Eigen::Vector2d half_px(0.34 * size_px * static_cast<double>(words.size()),
                                  0.525 * size_px);
    const Eigen::Vector2d middle_px(number(each, "x"), number(each, "y") - 0.305 * size_px);
    out.push_back({words, {middle_px - half_px, middle_px + half_px}});
  }
  return out;
}

TEST(DrawBodies, OrientsEachRobot) {
  const Example it = three_robots();
  const Layout layout = it.layout();
  const auto noses = elements(
      it.drawn([&](Svg& to, const Layout& on) { draw_bodies(to, on, it.scenario, it.scene); }),
      "polygon");
  ASSERT_EQ(noses.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Pose2& pose = *it.scene.robots.at(it.scenario.robots[i].name).world_from_body;
    const Eigen::Vector2d ahead_px =
        points_of(noses[i]).at(0) - layout.page_from_world(pose.position_m());
    const double yaw_rad = std::atan2(-ahead_px.y(), ahead_px.x());  // y points down
    EXPECT_NEAR(std::remainder(yaw_rad - pose.yaw_rad, 2.0 * kPi), 0.0, 0.01);
  }
}

// A single robot's name has 16 possible directions, clockwise from the upper right, at 8, 16, 26
// and 40 px. It gets the nearest position at least 5 px from the body.
TEST(DrawBodies, PutsANameNextToItsBody) {
  for (const double radius_px : {8.0, 10.0, 12.0, 14.0, 18.0}) {
    SCOPED_TRACE(radius_px);
    Example it = three_robots();
    it.scenario.robots.resize(1);
    const Layout layout = it.layout();
    it.scene.robots.at("Q1").world_from_body = Pose2{0.0, 2.0, 0.0};
    it.scenario.robots[0].limits.radius_m = radius_px / layout.px_per_m;
    const Eigen::Vector2d at_px = layout.page_from_world({0.0, 2.0});
    const auto texts = elements(
        it.drawn([&](Svg& to, const Layout& on) { draw_bodies(to, on, it.scenario, it.scene); }),
        "text");
    ASSERT_EQ(texts.size(), 1U);
    EXPECT_EQ(number(texts[0], "font-size"), 16.0);
    const Eigen::Vector2d size_px(0.68 * 16.0 * 2.0, 1.05 * 16.0);
    const Eigen::Vector2d middle_px(number(texts[0], "x"), number(texts[0], "y") - 4.88);
    const Eigen::Vector2d clear_px =
        (middle_px - at_px).cwiseAbs() - 0.5 * size_px - Eigen::Vector2d::Constant(radius_px + 5.0);
    EXPECT_GT(clear_px.maxCoeff(), -0.02);
    const double ring_px = radius_px + 5.0 <= 16.0 ? 16.0 : 26.0;
    EXPECT_LT(((middle_px - at_px).cwiseAbs() - 0.5 * size_px).maxCoeff(), ring_px + 0.02);
    EXPECT_GT(middle_px.x(), at_px.x());
    if (radius_px == 10.0) {
      // Only the position exactly to the right, at 16 px, is at least 15 px away. There the text is
      // vertically centred on the body.
      EXPECT_NEAR(number(texts[0], "y") - 0.35 * 16.0, at_px.y(), 1.0);
    }
    if (radius_px == 8.0) {
      const Eigen::Vector2d away(std::cos(kPi / 8), -std::sin(kPi / 8));
      expect_near(middle_px - at_px, 16.0 * away + 0.5 * size_px.cwiseProduct(away));
    }
  }
}

// The page shows a target and its estimated mean only; the target's name covers neither.
TEST(DrawBodies, PutsATargetsNameNextToItAndItsEstimate) {
  Example it = three_robots();
  it.scenario.robots.clear();
  it.scenario.targets = {{"R1", 0, {}, 0.2}};
  const Layout layout = it.layout();
  const Eigen::Vector2d at_px = layout.page_from_world({0.0, 2.0});
  const auto name = [&] {
    const std::string svg =
        it.drawn([&](Svg& to, const Layout& on) { draw_bodies(to, on, it.scenario, it.scene); });
    EXPECT_EQ(number(elements(svg, "text").at(0), "font-size"), 13.0);
    return labels_of(svg).at(0).box_px;
  };
  it.scene.targets[0].track = {{kNow, {0.0, 2.0}}};
  const Eigen::AlignedBox2d alone_px = name();
  EXPECT_GT(alone_px.exteriorDistance(at_px), 6.0);
  EXPECT_LT(alone_px.exteriorDistance(at_px), 8.02) << "at its nearest position";
  for (int i = 0; i < 200; ++i) {
    const double turn_rad = 0.7 * i;
    const Eigen::Vector2d mean_m =
        Eigen::Vector2d(0.0, 2.0) + (10.0 + 0.1 * i) / layout.px_per_m *
                                        Eigen::Vector2d(std::cos(turn_rad), std::sin(turn_rad));
    it.scene.targets[0].estimate.emplace().mean_m = mean_m;
    const Eigen::Vector2d half_px = Eigen::Vector2d::Constant(5.95);
    const Eigen::Vector2d mean_px = layout.page_from_world(mean_m);
    const Eigen::AlignedBox2d cross_px(mean_px - half_px, mean_px + half_px);
    EXPECT_TRUE(name().intersection(cross_px).isEmpty()) << i;
    const Eigen::Vector2d wide_px = Eigen::Vector2d::Constant(6.05);
    if (alone_px.intersection(Eigen::AlignedBox2d(mean_px - wide_px, mean_px + wide_px))
            .isEmpty()) {
      EXPECT_LT((name().center() - alone_px.center()).norm(), 0.01)
          << "no other object is in the way";
    }
  }
}

// Robots in a row are so close that a label could cover the next robot, a target or its estimate.
TEST(DrawBodies, LabelsBodiesWithoutCoveringThem) {
  Example it = three_robots();
  const Layout layout = it.layout();
  for (std::size_t i = 0; i < 3; ++i) {
    it.scene.robots.at(it.scenario.robots[i].name).world_from_body =
        Pose2{-0.5 + 0.4 * static_cast<double>(i), 2.0, 0.5};
    it.scenario.robots[i].limits.radius_m = i == 2 ? 0.15 : 0.01;
  }
  it.scene.jammed = {"Q2"};
  it.scenario.targets = {{"R1", 3, {}, 0.2}, {"R2", 5, {}, 0.2}, {"R3", 6, {}, 0.2}};
  it.scene.targets[3].track = {{kNow, {3.0, 3.0}}, {kNow, {-0.1, 2.3}}};
  it.scene.targets[3].estimate.emplace().mean_m = Eigen::Vector2d(0.2, 2.35);
  it.scene.targets[5];  // neither observed nor tracked
  const std::string svg =
      it.drawn([&](Svg& to, const Layout& on) { draw_bodies(to, on, it.scenario, it.scene); });
  std::vector<std::pair<Eigen::Vector2d, double>> bodies_px;
  std::vector<std::string> fills;
  for (const Attributes& each : elements(svg, "circle")) {
    bodies_px.emplace_back(Eigen::Vector2d(number(each, "cx"), number(each, "cy")),
                           number(each, "r"));
    fills.push_back(each.at("fill"));
  }
  ASSERT_EQ(bodies_px.size(), 4U) << "including a core for the jammed robot";
  EXPECT_EQ(fills, (std::vector<std::string>{
                       std::string(robot_colour(0)), std::string(role_colour("jammed")),
                       std::string(robot_colour(1)), std::string(robot_colour(2))}));
  EXPECT_EQ(bodies_px[0].second, 8.0) << "minimum size";
  EXPECT_EQ(bodies_px[1].second, 8.0);
  EXPECT_NEAR(bodies_px[3].second, 0.15 * layout.px_per_m, 0.01) << "true size";
  expect_near(bodies_px[3].first, layout.page_from_world({0.3, 2.0}));
  const auto diamonds = elements(svg, "polygon");
  ASSERT_EQ(diamonds.size(), 4U) << "three heading marks";
  const Eigen::Vector2d target_px = layout.page_from_world({-0.1, 2.3});
  const Points diamond = points_of(diamonds[0]);
  EXPECT_EQ(diamonds[0].at("class"), "truth");
  ASSERT_EQ(diamond.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR((diamond[k] - target_px).norm(), 6.0, 0.02);
    expect_near(diamond[k] + diamond[(k + 2) % 4], 2.0 * target_px);
  }
  EXPECT_NEAR(diamond[0].x(), target_px.x(), 0.02) << "corners in the order up, right, down, left";
  bodies_px.emplace_back(target_px, 6.0);
  bodies_px.emplace_back(layout.page_from_world({0.2, 2.35}), 5.0);

  const auto labels = labels_of(svg);
  std::vector<std::string> words;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    words.push_back(labels[i].words);
    for (const auto& [at_px, radius_px] : bodies_px) {
      EXPECT_GT(labels[i].box_px.exteriorDistance(at_px), radius_px - 0.02) << labels[i].words;
    }
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_TRUE(labels[i].box_px.intersection(labels[j].box_px).isEmpty());
    }
  }
  EXPECT_EQ(words, (std::vector<std::string>{"R1", "Q1", "Q2 jammed", "Q3"}));
  const auto texts = elements(svg, "text");
  EXPECT_EQ(texts[0].at("fill"), role_colour("truth"));
  EXPECT_EQ(texts[0].at("font-weight"), "normal");
  EXPECT_LT(number(texts[0], "font-size"), number(texts[1], "font-size"));
  EXPECT_EQ(texts[1].at("fill"), robot_colour(0));
  EXPECT_EQ(texts[2].at("fill"), role_colour("jammed"));
  EXPECT_EQ(texts[1].at("font-weight"), "bold");
}

}  // namespace
}  // namespace vantage::logs
