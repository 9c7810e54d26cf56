#include "logs/picture/picture.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string_view>
#include <tuple>

#include <gtest/gtest.h>

#include "core/write_file.hpp"
#include "logs/picture/label_placer.hpp"
#include "logs/picture/layout.hpp"
#include "logs/picture/panel.hpp"
#include "logs/picture/svg.hpp"
#include "test/logs/picture/svg_text.hpp"
#include "test/support/temporary_folder.hpp"

namespace vantage::logs {
namespace {

using test::count;
using test::elements;
using test::number;
using test::xml_fault;

struct Example {
  scenario::Scenario scenario;
  Scene scene;
  logs::TrialSummary summary;
};

Example example() {
  Example out;
  out.scenario.name = "a<b & c";
  out.scenario.world.bounds = {{-4.0, -2.0}, {4.0, 2.0}};
  out.scenario.world.obstacles.push_back({{{-1.0, -1.0}, {0.0, 0.0}}, 2.0});
  out.scenario.robots.resize(2);
  out.scenario.robots[0].name = "Q1";
  out.scenario.robots[0].sensor.range_max_m = 1.0;
  out.scenario.robots[1].name = "Q2";
  out.scenario.robots[1].sensor.fov_rad = 1.5;
  out.scenario.robots[1].sensor.range_max_m = 1.0;
  out.scenario.targets = {{"R1", 0, {}, 0.2}, {"R2", 1, {}, 0.2}};
  out.summary.scenario = out.scenario.name;
  out.summary.targets = 2;
  out.summary.discovered = 1;
  out.summary.discovery_time_s = {12.5, std::nullopt};
  out.summary.rmse_per_target_m = {0.25, std::nullopt};
  out.summary.entropy_per_target_nats = {0.5, 3.0};

  SceneRecorder recorder(out.scenario);
  for (int i = 0; i <= 600; ++i) {
    models::TruthFrame truth;
    truth.stamp.time = from_utime(1'000'000 + i * 100'000);
    for (const auto& [name, id, y_m] :
         {std::tuple{"Q1", -1, 0.5}, {"Q2", -1, -0.5}, {"R1", 0, 1.0}, {"R2", 1, -1.0}}) {
      models::TruthBody body;
      body.name = name;
      body.target_id = id;
      body.world_from_body = lift({-3.0 + 0.01 * i, y_m, 0.0}, 1.0);
      truth.bodies.push_back(body);
    }
    recorder.on_truth(truth);
  }
  models::RobotBelief belief;
  belief.robot = "Q1";
  belief.stamp.time = from_utime(1'000'000);
  belief.grid = models::GridGeometry::covering(out.scenario.world.bounds, 0.5);
  belief.last_seen_utime.assign(static_cast<std::size_t>(belief.grid.size()), 0);
  belief.last_seen_utime[3] = 900'000;
  recorder.on_belief(belief);
  models::RobotPlan plan;
  plan.robot = "Q1";
  plan.trajectory.start_time = from_utime(61'000'000);
  plan.trajectory.start = {3.0, 0.5, 0.0};
  plan.trajectory.segments = {{{1.0, 1.0}, 0.5, 0.0}};
  recorder.on_plan(plan);
  out.scene = recorder.scene();
  logs::PositionEstimate estimate;
  estimate.mean_m = Eigen::Vector2d(2.5, 1.0);
  estimate.covariance_m2 = Eigen::Vector2d(0.04, 0.01).asDiagonal();
  out.scene.targets[0].estimate = estimate;
  return out;
}

TEST(PanelHeight, FitsFourRobotsPerRow) {
  scenario::Scenario scenario;
  std::vector<double> heights_px;
  for (int robots = 1; robots <= 12; ++robots) {
    scenario.robots.emplace_back();
    heights_px.push_back(panel_height_px(scenario));
  }
  for (std::size_t i = 1; i < heights_px.size(); ++i) {
    EXPECT_NEAR(heights_px[i] - heights_px[i - 1], i % 4 == 0 ? 20.0 : 0.0, 1e-9) << i + 1;
  }
}

TEST(DrawPicture, IsWellFormedXml) {
  const Example it = example();
  EXPECT_EQ(xml_fault(draw_picture(it.scenario, it.scene, it.summary)), "");
  EXPECT_EQ(xml_fault(draw_picture(it.scenario, Scene{}, it.summary)), "");
}

TEST(XmlFault, FindsMalformedXml) {
  EXPECT_NE(xml_fault("<a><b></a></b>"), "");
  EXPECT_NE(xml_fault("<a>1 & 2</a>"), "");
  EXPECT_NE(xml_fault("<a x=1/>"), "");
  EXPECT_NE(xml_fault("<a>"), "");
  EXPECT_NE(xml_fault("<a x=\"1\" x=\"2\"/>"), "");
  EXPECT_NE(xml_fault("<a x=\"1\"y=\"2\"/>"), "");
  EXPECT_EQ(xml_fault("<a x=\"1 / 2\" y=\"2\">&amp;<b/></a>"), "");
}

TEST(DrawPicture, ShowsEverythingOnce) {
  const Example it = example();
  const std::string svg = draw_picture(it.scenario, it.scene, it.summary);
  EXPECT_EQ(count(svg, "class=\"obstacle\""), 1);
  EXPECT_EQ(count(svg, "class=\"bounds\""), 1);
  EXPECT_EQ(count(svg, "class=\"robot\""), 4) << "two in the map and two in the legend";
  EXPECT_EQ(count(svg, "class=\"view\""), 2);
  EXPECT_EQ(count(svg, "class=\"plan\""), 1);
  EXPECT_EQ(count(svg, "class=\"truth\""), 2);
  EXPECT_EQ(count(svg, "class=\"ellipse\""), 1);  // the untracked target has no ellipse
  EXPECT_NE(svg.find("a&lt;b &amp; c: 1 of 2 targets found"), std::string::npos);
  EXPECT_NE(svg.find("12.5 s"), std::string::npos);
}

TEST(DrawPicture, ClipsTheGroundToTheMap) {
  const Example it = example();
  const std::string svg = draw_picture(it.scenario, it.scene, it.summary);
  ASSERT_EQ(count(svg, "<clipPath "), 1);
  const std::string clip = svg.substr(svg.find("<clipPath "));
  const auto window = elements(clip.substr(0, clip.find("</clipPath>")), "rect").at(0);
  const Layout layout(it.scenario.world.bounds, panel_height_px(it.scenario));
  EXPECT_NEAR(number(window, "x"), layout.map_corner_px.x(), 0.01);
  EXPECT_NEAR(number(window, "y"), layout.map_corner_px.y(), 0.01);
  EXPECT_NEAR(number(window, "width"), layout.map_size_px.x(), 0.01);
  EXPECT_NEAR(number(window, "height"), layout.map_size_px.y(), 0.01);
}

TEST(DrawPicture, EllipseHasTheLegendsProbability) {
  const Example it = example();
  const std::string svg = draw_picture(it.scenario, it.scene, it.summary);
  // 8 m are 1040 px. σ is 0.1 m and 0.2 m (the smaller axis first); multiplied by √(−2 ln 0.05) it
  // contains 95 % in two dimensions.
  EXPECT_NE(svg.find("<ellipse rx=\"31.82\" ry=\"63.64\""), std::string::npos);
  EXPECT_NE(svg.find("estimate: mean and 95 % ellipse"), std::string::npos);
}

Example in_a_square() {
  Example out = example();
  out.scenario.world.bounds = {{-3.0, -3.0}, {3.0, 3.0}};
  return out;
}

TEST(DrawPicture, MarksBothAxesCompletely) {
  const Example it = in_a_square();
  const std::string svg = draw_picture(it.scenario, it.scene, it.summary);
  std::map<std::string, std::string> bounds;
  for (const auto& each : elements(svg, "rect")) {
    bounds = each.contains("class") && each.at("class") == "bounds" ? each : bounds;
  }
  const double left_px = number(bounds, "x");
  const double top_px = number(bounds, "y");
  const double right_px = left_px + number(bounds, "width");
  const double bottom_px = top_px + number(bounds, "height");
  std::multiset<std::string> below;
  std::multiset<std::string> beside;
  for (const auto& each : elements(svg, "text")) {
    const bool is_beside = number(each, "x") < left_px;
    if (is_beside && each.at("words") != "y (m)") {
      beside.insert(each.at("words"));
    } else if (!is_beside && number(each, "y") > bottom_px && each.at("words") != "x (m)") {
      below.insert(each.at("words"));
    }
  }
  EXPECT_EQ(below, beside);
  EXPECT_TRUE(below.contains("-3") && below.contains("0") && below.contains("3"));
  std::size_t upright = 0;
  std::size_t level = 0;
  for (const auto& each : elements(svg, "line")) {
    if (each.contains("stroke-opacity") && each.at("stroke-opacity") == "0.06") {
      const bool is_level = each.at("y1") == each.at("y2");
      (is_level ? level : upright) += 1;
      EXPECT_NEAR(number(each, is_level ? "x1" : "y1"), is_level ? left_px : top_px, 0.02);
      EXPECT_NEAR(number(each, is_level ? "x2" : "y2"), is_level ? right_px : bottom_px, 0.02);
    }
  }
  EXPECT_EQ(level, beside.size());
  EXPECT_EQ(upright, below.size());
}

TEST(DrawPicture, DrawsAFullFieldOfViewAsACircle) {
  const Example it = example();
  const std::string svg = draw_picture(it.scenario, it.scene, it.summary);
  int circles = 0;
  for (const auto& each : elements(svg, "circle")) {
    if (each.contains("class") && each.at("class") == "view") {
      ++circles;
      EXPECT_EQ(each.at("r"), "130.00") << "8 m are 1040 px";
    }
  }
  EXPECT_EQ(circles, 1);
}

Example with_many_robots() {
  Example out = example();
  out.scenario.robots.resize(40, out.scenario.robots[1]);
  for (std::size_t i = 2; i < out.scenario.robots.size(); ++i) {
    out.scenario.robots[i].name = "Q" + std::to_string(i + 1);
  }
  out.scene.jammed = {"Q2"};
  out.scenario.estimator.grid_memory_s = 30.0;
  return out;
}

TEST(DrawPicture, KeepsTextOnThePage) {
  for (const Example& it : {example(), in_a_square(), with_many_robots()}) {
    const std::string svg = draw_picture(it.scenario, it.scene, it.summary);
    const auto page = elements(svg, "svg").at(0);
    for (const auto& each : elements(svg, "text")) {
      EXPECT_GT(number(each, "x"), 0.0) << each.at("words");
      EXPECT_LT(number(each, "x"), number(page, "width")) << each.at("words");
      EXPECT_GT(number(each, "y"), 0.0) << each.at("words");
      EXPECT_LT(number(each, "y"), number(page, "height")) << each.at("words");
    }
  }
}

TEST(DrawPicture, AlignsLegendSymbolsAndText) {
  const Example it = with_many_robots();
  const std::string svg = draw_picture(it.scenario, it.scene, it.summary);
  std::map<std::string, std::string> head;
  for (const auto& each : elements(svg, "text")) {
    head = each.at("words") == "Legend" ? each : head;
  }
  std::vector<double> rows_px;  // centre of each row of text
  double words_px = 0.0;
  for (const auto& each : elements(svg, "text")) {
    if (number(each, "x") >= number(head, "x") && number(each, "y") > number(head, "y")) {
      rows_px.push_back(number(each, "y") - 4.5);
      words_px = number(each, "x");  // in the last row, which has one symbol
    }
  }
  int symbols = 0;
  const auto expect_beside = [&](double left_px, double right_px, double top_px, double bottom_px) {
    if (left_px < number(head, "x") || top_px < number(head, "y")) {
      return;
    }
    ++symbols;
    EXPECT_LT(right_px, words_px);
    EXPECT_LE(bottom_px - top_px, 20.0) << "otherwise it reaches into the next row";
    const double middle_px = 0.5 * (top_px + bottom_px);
    EXPECT_TRUE(std::any_of(rows_px.begin(), rows_px.end(), [&](double row_px) {
      return std::abs(row_px - middle_px) < 0.1;
    })) << middle_px;
  };
  for (const auto& each : elements(svg, "rect")) {
    if (each.contains("x")) {
      expect_beside(number(each, "x"), number(each, "x") + number(each, "width"), number(each, "y"),
                    number(each, "y") + number(each, "height"));
    }
  }
  for (const auto& each : elements(svg, "line")) {
    expect_beside(number(each, "x1"), number(each, "x2"),
                  std::min(number(each, "y1"), number(each, "y2")),
                  std::max(number(each, "y1"), number(each, "y2")));
  }
  EXPECT_EQ(symbols, 8);
}

TEST(DrawPicture, WritesARobotsNameNextToIt) {
  Example it = example();
  it.scenario.robots.resize(1);
  it.scenario.targets.clear();
  it.scene.targets.clear();
  const std::string svg = draw_picture(it.scenario, it.scene, it.summary);
  const Layout layout(it.scenario.world.bounds, 0.0);
  const Eigen::Vector2d robot_px =
      layout.page_from_world(it.scene.robots.at("Q1").world_from_body->position_m());
  int names = 0;
  for (const auto& each : elements(svg, "text")) {
    if (each.at("words") == "Q1" && number(each, "x") < layout.panel_corner_px.x()) {
      ++names;
      const double size_px = number(each, "font-size");
      const Eigen::Vector2d middle_px(number(each, "x"), number(each, "y") - 0.3 * size_px);
      const Eigen::Vector2d away_px =
          (middle_px - robot_px).cwiseAbs() - 0.5 * Eigen::Vector2d(1.36, 1.05) * size_px;
      EXPECT_GT(away_px.maxCoeff(), 8.0) << "the label does not cover the robot";
      EXPECT_LT(away_px.cwiseMax(0.0).norm(), 42.0) << "within the range of the search";
    }
  }
  EXPECT_EQ(names, 1);
}

TEST(DrawPicture, OutlinesAJammedRobotInRed) {
  Example it = example();
  const auto red = std::string(role_colour("jammed"));
  const std::string calm = draw_picture(it.scenario, it.scene, it.summary);
  EXPECT_EQ(calm.find(red), std::string::npos);
  it.scene.jammed = {"Q2"};
  const std::string svg = draw_picture(it.scenario, it.scene, it.summary);
  EXPECT_NE(svg.find("Q2 jammed"), std::string::npos);
  EXPECT_EQ(svg.find("Q1 jammed"), std::string::npos);
  EXPECT_NE(svg.find("class=\"view\" fill=\"" + red), std::string::npos);
  EXPECT_GT(count(svg, robot_colour(1).data()), 1) << "the robot's own colour is still visible";
}

TEST(DrawPicture, ShowsTheMapOfATeamThatMaps) {
  Example it = example();
  it.scenario.targets.clear();
  it.scene.targets.clear();
  it.scenario.planner.objective = scenario::PlanObjective::kMapping;
  it.summary.targets = it.summary.discovered = 0;
  it.summary.map_entropy_nats = 123.4;
  SceneRecorder recorder(it.scenario);
  models::RobotMap map;
  map.robot = "Q1";
  map.grid = models::GridGeometry::covering(it.scenario.world.bounds, 1.0);
  map.team_looks.assign(static_cast<std::size_t>(map.grid.size()), 0);
  map.team_looks[3] = 100;
  map.team_looks[4] = -100;
  map.entropy_nats = 77.0;
  recorder.on_map(map);
  const std::string svg = draw_picture(it.scenario, recorder.scene(), it.summary);
  EXPECT_EQ(xml_fault(svg), "");
  EXPECT_EQ(svg.find("targets found"), std::string::npos);
  for (const char* words : {"map entropy 123 nat", "77 nat", "class=\"map\"", "mapped: occupied"}) {
    EXPECT_NE(svg.find(words), std::string::npos) << words;
  }
  EXPECT_NE(svg.find(role_colour("occupied")), std::string::npos);
}

// With neighbourhoods, robots publish only their surroundings, but the picture shows the whole
// ground.
TEST(SceneRecorder, StartsWithTheWholeGround) {
  scenario::Scenario scenario = example().scenario;
  scenario.network.neighbourhood_m = 2.0;
  scenario.estimator.grid_resolution_m = 0.5;
  const Scene scene = SceneRecorder(scenario).scene();
  EXPECT_EQ(scene.grid.columns, 16);
  EXPECT_EQ(scene.grid.rows, 8);
  EXPECT_EQ(scene.last_seen_utime.size(), 128U);
}

TEST(SceneRecorder, KeepsLongTracksInBoundedMemory) {
  SceneRecorder recorder(example().scenario);
  constexpr int kFrames = 100'000;
  for (int i = 0; i < kFrames; ++i) {
    models::TruthFrame truth;
    truth.stamp.time = from_utime(std::int64_t{i} * 100'000);
    truth.bodies.resize(1);
    truth.bodies[0].name = "Q1";
    truth.bodies[0].target_id = -1;
    truth.bodies[0].world_from_body = lift({0.1 * i, 0.0, 0.0}, 1.0);
    recorder.on_truth(truth);
  }
  const auto& track = recorder.scene().robots.at("Q1").track;
  EXPECT_LE(track.size(), 4096U);
  EXPECT_GT(track.size(), 2000U);
  EXPECT_EQ(track.front().position_m.x(), 0.0);
  double widest_m = 0.0;
  double narrowest_m = 1e9;
  for (std::size_t i = 1; i + 1 < track.size(); ++i) {
    const double gap_m = track[i].position_m.x() - track[i - 1].position_m.x();
    widest_m = std::max(widest_m, gap_m);
    narrowest_m = std::min(narrowest_m, gap_m);
  }
  // All parts of the track have the same resolution, which is at most twice as coarse as necessary.
  EXPECT_LT(widest_m, 0.1 * kFrames / 2048);
  EXPECT_NEAR(narrowest_m, widest_m, 1e-9);
  EXPECT_LT(0.1 * (kFrames - 1) - track.back().position_m.x(), widest_m);
}

TEST(DrawPicture, ListsEveryRobotInTheLegend) {
  Example it = example();
  it.scenario.robots.resize(50);
  for (std::size_t i = 0; i < 50; ++i) {
    it.scenario.robots[i].name = "Q" + std::to_string(i + 1);
  }
  const std::string svg = draw_picture(it.scenario, it.scene, it.summary);
  for (std::size_t i = 2; i < 50; ++i) {
    EXPECT_NE(svg.find(">Q" + std::to_string(i + 1) + "<"), std::string::npos);
  }
}

TEST(DrawPicture, IsDeterministic) {
  const Example a = example();
  const Example b = example();
  EXPECT_EQ(draw_picture(a.scenario, a.scene, a.summary),
            draw_picture(b.scenario, b.scene, b.summary));
}

TEST(LabelPlacer, AvoidsOverlapWhilePossible) {
  LabelPlacer placer({Eigen::Vector2d(0, 0), Eigen::Vector2d(400, 400)});
  std::vector<Eigen::AlignedBox2d> boxes;
  for (int i = 0; i < 6; ++i) {
    boxes.push_back(placer.place({200.0 + i, 200.0}, {30.0, 14.0}));
    for (std::size_t j = 0; j + 1 < boxes.size(); ++j) {
      const auto both = boxes.back().intersection(boxes[j]);
      EXPECT_TRUE(both.isEmpty() || both.volume() < 1e-9) << i << " " << j;
    }
  }
}

TEST(LabelPlacer, KeepsLabelsInsideThePage) {
  const Eigen::AlignedBox2d page(Eigen::Vector2d(0, 0), Eigen::Vector2d(400, 300));
  LabelPlacer placer(page);
  EXPECT_TRUE(page.contains(placer.place({399.0, 1.0}, {30.0, 14.0})));
  EXPECT_TRUE(page.contains(placer.place({1.0, 299.0}, {30.0, 14.0})));
}

TEST(RenderPng, WritesAPngOrNamesTheMissingProgram) {
  const test::TemporaryFolder own;
  const std::string svg_path = own.file("picture.svg");
  const std::string png_path = own.file("picture.png");
  const Example it = example();
  write_file(svg_path, draw_picture(it.scenario, it.scene, it.summary));
  const Result<std::string> png = render_png(svg_path, png_path);
  if (!png.ok()) {
    EXPECT_NE(png.error().message.find("rsvg-convert"), std::string::npos);
    return;
  }
  std::ifstream file(png_path, std::ios::binary);
  std::string magic(4, ' ');
  file.read(magic.data(), 4);
  EXPECT_EQ(magic, "\x89PNG");
}

TEST(RenderPng, ReportsErrorsAndRemovesThePartialFile) {
  const test::TemporaryFolder own;
  const std::string& folder = own.path();
  write_file(folder + "/no.svg", "this is no picture");
  const auto render = [&]() -> std::string {
    try {
      const Result<std::string> png = render_png(folder + "/no.svg", folder + "/no.png");
      return png.ok() ? "drawn" : png.error().message;
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  };
  const std::string outcome = render();
  EXPECT_TRUE(outcome.find("not installed") != std::string::npos ||
              outcome == folder + "/no.png: cannot be written: rsvg-convert failed on " + folder +
                             "/no.svg")
      << outcome;
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

}  // namespace
}  // namespace vantage::logs
