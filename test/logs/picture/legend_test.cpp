#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "logs/picture/layout.hpp"
#include "logs/picture/map_layer.hpp"
#include "logs/picture/panel.hpp"
#include "logs/picture/svg.hpp"
#include "test/logs/picture/svg_text.hpp"

namespace vantage::logs {
namespace {

using test::elements;
using test::number;
using Attributes = std::map<std::string, std::string>;

constexpr double kRow_px = 24.0;  // height of a row

/// A drawn symbol: its SVG tag, bounding box and attributes.
struct Symbol {
  std::string tag;
  Eigen::AlignedBox2d box_px;
  Attributes attributes;
};

Eigen::AlignedBox2d box_of(const std::string& tag, const Attributes& it) {
  Eigen::AlignedBox2d out;
  if (tag == "circle") {
    const Eigen::Vector2d at_px(number(it, "cx"), number(it, "cy"));
    const Eigen::Vector2d r_px = Eigen::Vector2d::Constant(number(it, "r"));
    out = {at_px - r_px, at_px + r_px};
  } else if (tag == "line") {
    out.extend(Eigen::Vector2d(number(it, "x1"), number(it, "y1")));
    out.extend(Eigen::Vector2d(number(it, "x2"), number(it, "y2")));
  } else if (tag == "rect") {
    const Eigen::Vector2d low_px(number(it, "x"), number(it, "y"));
    out = {low_px, low_px + Eigen::Vector2d(number(it, "width"), number(it, "height"))};
  } else if (tag == "ellipse") {
    Eigen::Vector2d at_px;
    double turn_deg = 1.0;
    EXPECT_EQ(std::sscanf(it.at("transform").c_str(), "translate(%lf %lf) rotate(%lf)", &at_px.x(),
                          &at_px.y(), &turn_deg),
              3);
    EXPECT_EQ(turn_deg, 0.0);
    const Eigen::Vector2d half_px(number(it, "rx"), number(it, "ry"));
    out = {at_px - half_px, at_px + half_px};
  } else {
    std::istringstream in(it.at("points"));
    char comma = ' ';
    for (double x = 0.0, y = 0.0; in >> x >> comma >> y;) {
      out.extend(Eigen::Vector2d(x, y));
    }
  }
  return out;
}

scenario::Scenario a_scenario() {
  scenario::Scenario out;
  out.world.bounds = {{-4.0, -2.0}, {4.0, 2.0}};
  out.world.obstacles.resize(1);
  out.estimator.grid_memory_s = 17.5;
  for (const char* name : {"Q1", "Q2", "Q3", "Q4", "Q5"}) {
    out.robots.emplace_back().name = name;
  }
  out.targets.emplace_back().name = "R1";
  return out;
}

class Legend : public ::testing::Test {
 protected:
  void draw(bool maps) {
    scene_.jammed = {"Q2"};
    if (maps) {
      scenario_.planner.objective = scenario::PlanObjective::kMapping;
      scene_.map.emplace();
    }
    const Layout layout(scenario_.world.bounds, panel_height_px(scenario_));
    left_px_ = layout.panel_corner_px.x();
    Svg svg(2000.0, 1000.0);
    draw_panel(svg, layout, scenario_, scene_, {});
    const std::string all = svg.str();
    const std::string legend = all.substr(all.rfind("<text", all.find(">Legend<")));
    texts_ = elements(legend, "text");
    for (const char* tag : {"circle", "line", "rect", "ellipse", "polygon"}) {
      for (const Attributes& each : elements(legend, tag)) {
        symbols_.push_back({tag, box_of(tag, each), each});
      }
    }
  }
  /// Returns the symbols next to the text that starts with `words`, sorted by tag.
  [[nodiscard]] std::vector<Symbol> beside(const std::string& words) const {
    std::vector<Symbol> out;
    for (const Attributes& text : texts_) {
      if (text.at("words").starts_with(words)) {
        for (const Symbol& each : symbols_) {
          const double away_px = each.box_px.center().y() - (number(text, "y") - 4.5);
          if (std::abs(away_px) < 0.5 * kRow_px && each.box_px.center().x() < number(text, "x")) {
            out.push_back(each);
          }
        }
      }
    }
    return out;
  }
  /// Returns the centre of the symbol next to the text that starts with `words`.
  [[nodiscard]] Eigen::Vector2d middle_px(const std::string& words) const {
    for (const Attributes& text : texts_) {
      if (text.at("words").starts_with(words)) {
        return {left_px_ + 16.0, number(text, "y") - 4.5};
      }
    }
    ADD_FAILURE() << words;
    return {};
  }
  static void expect_near(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    EXPECT_LT((a - b).norm(), 0.02) << a.transpose() << " and " << b.transpose();
  }

  scenario::Scenario scenario_ = a_scenario();
  Scene scene_;
  double left_px_ = 0.0;
  std::vector<Attributes> texts_;
  std::vector<Symbol> symbols_;
};

TEST_F(Legend, HasATitleAndRowsOfSymbolAndText) {
  draw(false);
  ASSERT_GT(texts_.size(), 6U);
  EXPECT_EQ(texts_[0].at("words"), "Legend");
  EXPECT_EQ(texts_[1].at("words"), "Q1");
  const double below_px = number(texts_[1], "y") - number(texts_[0], "y");
  EXPECT_GT(below_px, 20.0) << "the title has a separate row";
  EXPECT_LT(below_px, 30.0);
  double right_px = 0.0;
  for (const Symbol& each : symbols_) {
    EXPECT_GE(each.box_px.min().x(), left_px_ - 0.01) << each.tag;
    EXPECT_LE(each.box_px.sizes().y(), 20.0) << each.tag << ", but it reaches into the next row";
    if (each.box_px.center().x() < left_px_ + 40.0) {
      right_px = std::max(right_px, each.box_px.max().x());
    }
  }
  for (std::size_t i = 6; i < texts_.size(); ++i) {
    const double gap_px = number(texts_[i], "x") - right_px;
    EXPECT_GT(gap_px, 4.0) << texts_[i].at("words");
    EXPECT_LT(gap_px, 20.0) << texts_[i].at("words");
  }
}

TEST_F(Legend, ShowsRobotsLikeTheMap) {
  draw(false);
  std::vector<Symbol> bodies;
  std::vector<Symbol> noses;
  for (const Symbol& each : symbols_) {
    if (each.tag == "circle" && each.attributes.contains("stroke-width") &&
        each.attributes.at("stroke-width") == "1.4") {
      bodies.push_back(each);
    } else if (each.tag == "polygon" && each.attributes.contains("stroke-width")) {
      noses.push_back(each);
    }
  }
  ASSERT_EQ(bodies.size(), 6U) << "including a jammed one";
  ASSERT_EQ(noses.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    const double radius_px = number(bodies[i].attributes, "r");
    EXPECT_GE(radius_px, 5.0);
    EXPECT_LE(radius_px, 9.0);
    EXPECT_NEAR(noses[i].box_px.max().x() - bodies[i].box_px.center().x(), 1.75 * radius_px, 0.02)
        << "the heading mark points to the right";
    EXPECT_NEAR(noses[i].box_px.center().y(), bodies[i].box_px.center().y(), 0.02);
  }
  EXPECT_LT(bodies[0].box_px.min().x(), left_px_ + 6.0) << "starts at the left edge of the panel";
  const auto jammed = beside(appearance().glyphs.at("jammed"));
  ASSERT_EQ(jammed.size(), 3U) << "body, core and heading mark";
  EXPECT_EQ(jammed[0].attributes.at("fill"), role_colour("jammed"));
  EXPECT_EQ(jammed[1].attributes.at("fill"), robot_colour(0));
  expect_near(jammed[0].box_px.center(), middle_px(appearance().glyphs.at("jammed")));
}

// The lines of a track and of a plan go from left to right; a mark is at the end of the plan.
TEST_F(Legend, ShowsTracksPlansAndViewsLikeTheMap) {
  draw(false);
  const auto expect_way = [&](const Symbol& it, const std::string& words) {
    ASSERT_EQ(it.tag, "line");
    expect_near(it.box_px.center(), middle_px(words));
    EXPECT_NEAR(number(it.attributes, "x2") - number(it.attributes, "x1"), 28.0, 0.02);
    EXPECT_EQ(it.attributes.at("stroke"), robot_colour(0));
  };
  const auto trail = beside(appearance().glyphs.at("trail"));
  ASSERT_EQ(trail.size(), 1U);
  expect_way(trail[0], appearance().glyphs.at("trail"));
  const auto plan = beside(appearance().glyphs.at("plan"));
  ASSERT_EQ(plan.size(), 2U);
  expect_way(plan[1], appearance().glyphs.at("plan"));
  EXPECT_NEAR(plan[0].box_px.center().x(), plan[1].box_px.max().x(), 0.02)
      << "at the end of the plan";
  EXPECT_NEAR(plan[0].box_px.center().y(), plan[1].box_px.max().y(), 0.02);
  EXPECT_GT(number(plan[0].attributes, "r"), 3.0);
  EXPECT_LT(number(plan[0].attributes, "r"), 6.0);
  const auto view = beside(appearance().glyphs.at("view"));
  ASSERT_EQ(view.size(), 1U);
  expect_near(view[0].box_px.center(), middle_px(appearance().glyphs.at("view")));
  EXPECT_GT(number(view[0].attributes, "r"), 6.0);
  EXPECT_LE(number(view[0].attributes, "r"), 0.5 * kRow_px);
}

TEST_F(Legend, ShowsTargetsAndEstimatesLikeTheMap) {
  draw(false);
  const auto truth = beside(appearance().glyphs.at("truth"));
  ASSERT_EQ(truth.size(), 1U);
  // The symbol equals that of the map, apart from its position.
  Scene scene;
  scene.targets[0].track = {{Time{}, {1.0, 1.0}}};
  const Layout layout(scenario_.world.bounds, 0.0);
  Svg svg(2000.0, 1000.0);
  draw_bodies(svg, layout, scenario_, scene);
  const Attributes drawn = elements(svg.str(), "polygon").at(0);
  const auto corners = [](const Attributes& of, const Eigen::Vector2d& from_px) {
    std::vector<Eigen::Vector2d> out;
    std::istringstream in(of.at("points"));
    char comma = ' ';
    for (double x = 0.0, y = 0.0; in >> x >> comma >> y;) {
      out.push_back(Eigen::Vector2d(x, y) - from_px);
    }
    return out;
  };
  const auto wanted = corners(drawn, layout.page_from_world({1.0, 1.0}));
  const auto found = corners(truth[0].attributes, middle_px(appearance().glyphs.at("truth")));
  ASSERT_EQ(wanted.size(), 4U);
  ASSERT_EQ(found.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    expect_near(found[i], wanted[i]);
  }
  EXPECT_EQ(truth[0].attributes.at("fill"), role_colour("truth"));

  const auto estimate = beside(appearance().glyphs.at("estimate"));
  ASSERT_EQ(estimate.size(), 3U) << "a cross in an ellipse";
  const Eigen::Vector2d at_px = middle_px(appearance().glyphs.at("estimate"));
  const Symbol& ellipse = estimate[2];
  ASSERT_EQ(ellipse.tag, "ellipse");
  const Eigen::Vector2d half_px = 0.5 * ellipse.box_px.sizes();
  EXPECT_GT(half_px.x(), 1.5 * half_px.y()) << "clearly an ellipse";
  EXPECT_LT(half_px.x(), 2.0 * half_px.y());
  EXPECT_GT(half_px.y(), 6.0);
  expect_near(ellipse.box_px.center(), at_px);
  double turn = 1.0;
  for (const std::size_t i : {0U, 1U}) {
    expect_near(estimate[i].box_px.center(), at_px);
    const Attributes& of = estimate[i].attributes;
    const Eigen::Vector2d arm_px(0.5 * (number(of, "x2") - number(of, "x1")),
                                 0.5 * (number(of, "y2") - number(of, "y1")));
    EXPECT_NEAR(std::abs(arm_px.x()), std::abs(arm_px.y()), 0.02);
    EXPECT_LT((arm_px.array() / half_px.array()).matrix().norm(), 0.8) << "within the ellipse";
    EXPECT_GT(arm_px.norm(), 4.0);
    turn *= arm_px.x() * arm_px.y();
  }
  EXPECT_LT(turn, 0.0) << "in both directions";
}

// Swatches have 28 px by 16 px and are in the middle of their rows.
TEST_F(Legend, ShowsGroundColoursAsSwatches) {
  for (const bool maps : {false, true}) {
    symbols_.clear();
    draw(maps);
    for (const std::string glyph :
         {"occupied", "free", "unknown", "seen", "stale", "unseen", "obstacle"}) {
      const bool is_of_map = glyph == "occupied" || glyph == "free" || glyph == "unknown";
      const auto found = beside(appearance().glyphs.at(glyph));
      ASSERT_EQ(found.size(), glyph == "obstacle" || is_of_map == maps ? 1U : 0U) << glyph;
      if (!found.empty()) {
        EXPECT_EQ(found[0].tag, "rect");
        expect_near(found[0].box_px.center(), middle_px(appearance().glyphs.at(glyph)));
        expect_near(found[0].box_px.sizes(), {28.0, 16.0});
      }
    }
  }
}

// The header has two lines of text that do not overlap and are above the map.
TEST_F(Legend, IsBelowTheHeader) {
  const Layout layout(scenario_.world.bounds, panel_height_px(scenario_));
  Svg svg(2000.0, 1000.0);
  draw_header(svg, layout, scenario_, {}, KeyNumbers::kTrial);
  const auto lines = elements(svg.str(), "text");
  ASSERT_EQ(lines.size(), 2U);
  double above_px = 0.0;
  for (const Attributes& each : lines) {
    EXPECT_GE(number(each, "y") - number(each, "font-size"), above_px);
    EXPECT_LT(number(each, "y") - number(each, "font-size"), above_px + 16.0);
    above_px = number(each, "y");
  }
  EXPECT_LT(above_px, layout.map_corner_px.y() - 15.0);
}

}  // namespace
}  // namespace vantage::logs
