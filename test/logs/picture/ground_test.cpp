#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "logs/picture/layout.hpp"
#include "logs/picture/map_layer.hpp"
#include "logs/picture/svg.hpp"
#include "test/logs/picture/svg_text.hpp"

namespace vantage::logs {
namespace {

using test::elements;
using test::number;
using Attributes = std::map<std::string, std::string>;

constexpr Time kNow = from_utime(1'700'000'000'000'000);

bool covers(const Attributes& rectangle, const Eigen::Vector2d& p_px) {
  const double x = p_px.x() - number(rectangle, "x");
  const double y = p_px.y() - number(rectangle, "y");
  return x > 0.0 && x < number(rectangle, "width") && y > 0.0 && y < number(rectangle, "height");
}

scenario::Scenario a_scenario() {
  scenario::Scenario out;
  out.world.bounds = {{-4.0, -1.0}, {4.0, 5.0}};
  out.world.obstacles = {{{{-1.0, -0.5}, {0.5, 0.25}}, 2.0}, {{{2.0, 1.0}, {3.5, 4.0}}, 2.0}};
  out.world.regions = {{"wind", {{-3.0, 0.0}, {-2.0, 4.5}}, 1.0}};
  out.estimator.grid_memory_s = 30.0;
  return out;
}

/// Returns the rectangles that draw_ground() has drawn with this class; "": without a class.
std::vector<Attributes> rectangles(const std::string& svg, const std::string& of_class) {
  std::vector<Attributes> out;
  for (const Attributes& each : elements(svg, "rect")) {
    const auto found = each.find("class");
    if (each.contains("x") && (found == each.end() ? "" : found->second) == of_class) {
      out.push_back(each);
    }
  }
  return out;
}

std::string ground(const scenario::Scenario& scenario, const Scene& scene) {
  const Layout layout(scenario.world.bounds, 0.0);
  Svg svg(layout.page_size_px.x(), layout.page_size_px.y());
  draw_ground(svg, layout, scenario, scene);
  return svg.str();
}

// The colour of each cell shows when it was last observed. The grid is not square and has an offset
// origin.
TEST(DrawGround, ColoursCellsByAge) {
  scenario::Scenario scenario = a_scenario();
  const Layout layout(scenario.world.bounds, 0.0);
  Scene scene;
  scene.time = kNow;
  scene.grid = {{-3.0, 0.5}, 0.5, 5, 3};
  const auto ago = [](double s) { return to_utime(kNow - from_seconds(s)); };
  const std::int64_t never = models::VisibilityGrid::kNeverSeen;
  scene.last_seen_utime = {never,       ago(0.0),       ago(30.0), ago(31.0), never,
                           ago(3000.0), ago(30.000001), never,     ago(5.0),  ago(5.0),
                           ago(1.0),    ago(2.0),       ago(3.0),  ago(4.0),  ago(29.0)};
  for (const double memory_s : {30.0, 0.0}) {
    scenario.estimator.grid_memory_s = memory_s;
    const auto drawn = rectangles(ground(scenario, scene), "");
    double area_px2 = 0.0;
    int seen = 0;
    for (std::size_t i = 1; i < drawn.size(); ++i) {  // index 0 is the ground
      area_px2 += number(drawn[i], "width") * number(drawn[i], "height");
    }
    for (int cell = 0; cell < scene.grid.size(); ++cell) {
      std::string fill(role_colour("unseen"));
      const Eigen::Vector2d centre_px = layout.page_from_world(scene.grid.centre_m(cell));
      int over = 0;
      for (const Attributes& each : drawn) {
        if (covers(each, centre_px)) {
          fill = each.at("fill");
          ++over;
        }
      }
      const std::int64_t when = scene.last_seen_utime[static_cast<std::size_t>(cell)];
      const bool is_fresh = memory_s <= 0.0 || to_utime(kNow) - when <= 30'000'000;
      EXPECT_EQ(over, when == never ? 1 : 2) << cell;
      EXPECT_EQ(fill, role_colour(when == never ? "unseen" : is_fresh ? "seen" : "stale")) << cell;
      seen += when == never ? 0 : 1;
    }
    const double side_px = 0.5 * layout.px_per_m;
    EXPECT_NEAR(area_px2, seen * side_px * side_px, 1.0) << "exactly the area of the cells";
    // Adjacent cells with the same colour are one rectangle; the last row therefore has one or two.
    EXPECT_EQ(drawn.size() - 1, memory_s > 0.0 ? 5U : 4U);
  }
  scene.last_seen_utime.pop_back();
  EXPECT_EQ(rectangles(ground(scenario, scene), "").size(), 1U)
      << "data that does not match its grid is ignored";
}

int channel(std::string_view colour, std::size_t i) {
  return std::stoi(std::string(colour.substr(1 + 2 * i, 2)), nullptr, 16);
}

// Occupancy is drawn in eighths: white for free, grey for unknown, dark for occupied.
TEST(DrawGround, ShadesMapCellsByOccupancy) {
  scenario::Scenario scenario = a_scenario();
  scenario.mapping.look_probability = 0.6;
  const Layout layout(scenario.world.bounds, 0.0);
  Scene scene;
  scene.map.emplace();
  scene.map->grid = {{-3.0, 0.5}, 0.5, 7, 2};
  scene.map->team_looks = {0, 0, 1, 2, 9, 9, 100, -1, -2, -4, -30, 0, 0, 0};
  const auto drawn = rectangles(ground(scenario, scene), "");
  for (int cell = 0; cell < scene.map->grid.size(); ++cell) {
    // Each observation multiplies the odds by 3 : 2, up to 99 : 1.
    const int looks = scene.map->team_looks[static_cast<std::size_t>(cell)];
    const double odds = std::clamp(std::pow(1.5, looks), 1.0 / 99.0, 99.0);
    const double p = std::round(8.0 * odds / (1.0 + odds)) / 8.0;
    std::string wanted = "#";
    for (std::size_t i = 0; i < 3; ++i) {
      const int free = channel(role_colour("free"), i);
      const int unseen = channel(role_colour("unseen"), i);
      const int occupied = channel(role_colour("occupied"), i);
      const double mixed =
          p < 0.5 ? free + (unseen - free) * 2.0 * p : unseen + (occupied - unseen) * (2.0 * p - 1);
      wanted += fmt::format("{:02x}", std::lround(mixed));
    }
    const Eigen::Vector2d centre_px = layout.page_from_world(scene.map->grid.centre_m(cell));
    int over = 0;
    for (std::size_t i = 1; i < drawn.size(); ++i) {
      if (covers(drawn[i], centre_px)) {
        EXPECT_EQ(drawn[i].at("fill"), wanted) << looks;
        EXPECT_NEAR(number(drawn[i], "height"), 0.5 * layout.px_per_m, 0.02);
        ++over;
      }
    }
    EXPECT_EQ(over, 1) << cell;
  }
  EXPECT_EQ(drawn.size() - 1, 9U) << "equal neighbours in a row are merged";
}

// Rows of equal cells are as wide as the map: no rectangle continues into the next row.
TEST(DrawGround, EndsMapRowsAtTheMapsEdge) {
  scenario::Scenario scenario = a_scenario();
  const Layout layout(scenario.world.bounds, 0.0);
  Scene scene;
  EXPECT_EQ(ground(scenario, scene).find("explored"), std::string::npos) << "no cell is known";
  scene.map.emplace();
  scene.map->grid = {{-3.0, 0.5}, 0.5, 7, 3};
  scene.map->team_looks.assign(21, 0);
  const auto drawn = rectangles(ground(scenario, scene), "");
  ASSERT_EQ(drawn.size(), 1U + 3U);
  for (std::size_t row = 1; row <= 3; ++row) {
    EXPECT_NEAR(number(drawn[row], "width"), 7 * 0.5 * layout.px_per_m, 0.02);
    EXPECT_NEAR(number(drawn[row], "x"), layout.page_from_world({-3.0, 0.0}).x(), 0.01);
  }
}

TEST(DrawGround, DrawsObstaclesAndRegions) {
  const scenario::Scenario scenario = a_scenario();
  const Layout layout(scenario.world.bounds, 0.0);
  Scene scene;
  const auto expect_at = [&](const Attributes& drawn, const models::Rectangle& wanted) {
    const Eigen::Vector2d low_px = layout.page_from_world(wanted.min_m);
    const Eigen::Vector2d high_px = layout.page_from_world(wanted.max_m);
    EXPECT_NEAR(number(drawn, "x"), low_px.x(), 0.01);
    EXPECT_NEAR(number(drawn, "y"), high_px.y(), 0.01);
    EXPECT_NEAR(number(drawn, "x") + number(drawn, "width"), high_px.x(), 0.02);
    EXPECT_NEAR(number(drawn, "y") + number(drawn, "height"), low_px.y(), 0.02);
  };
  for (const bool is_mapped : {false, true}) {
    if (is_mapped) {
      scene.map.emplace();  // with a map, only the outline is drawn
    }
    const std::string svg = ground(scenario, scene);
    const auto obstacles = rectangles(svg, "obstacle");
    ASSERT_EQ(obstacles.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      expect_at(obstacles[i], scenario.world.obstacles[i].footprint);
      EXPECT_EQ(obstacles[i].contains("stroke-dasharray"), is_mapped);
      EXPECT_EQ(obstacles[i].contains("fill-opacity"), is_mapped);
      EXPECT_EQ(obstacles[i].at("stroke"), role_colour("wall"));
    }
    const auto regions = rectangles(svg, "region");
    ASSERT_EQ(regions.size(), 1U);
    expect_at(regions[0], scenario.world.regions[0].footprint);
    const Attributes whole = rectangles(svg, "").at(0);
    expect_at(whole, scenario.world.bounds);
    EXPECT_EQ(whole.at("fill"), role_colour("unseen"));
  }
}

struct Axes {
  std::vector<double> below;   ///< numbers below the map
  std::vector<double> beside;  ///< numbers next to the map
};

/// Expects that every number of the axes is at its correct position and has a line across the map.
Axes expect_true_axes(const models::World& world) {
  const Layout layout(world.bounds, 0.0);
  Svg svg(layout.page_size_px.x(), layout.page_size_px.y());
  draw_axes(svg, layout, world);
  const double left_px = layout.map_corner_px.x();
  const double top_px = layout.map_corner_px.y();
  const double right_px = left_px + layout.map_size_px.x();
  const double bottom_px = top_px + layout.map_size_px.y();
  const auto lines = elements(svg.str(), "line");
  const auto is_line = [&](double x1, double y1, double x2, double y2) {
    return std::any_of(lines.begin(), lines.end(), [&](const Attributes& each) {
      return std::abs(number(each, "x1") - x1) < 0.01 && std::abs(number(each, "y1") - y1) < 0.01 &&
             std::abs(number(each, "x2") - x2) < 0.01 && std::abs(number(each, "y2") - y2) < 0.01;
    });
  };
  Axes out;
  for (const Attributes& each : elements(svg.str(), "text")) {
    const double x_px = number(each, "x");
    const double y_px = number(each, "y");
    const std::string& words = each.at("words");
    if (words == "x (m)") {
      EXPECT_NEAR(x_px, 0.5 * (left_px + right_px), 0.01);
      EXPECT_GT(y_px, bottom_px + 19.0 + 13.0) << "below the numbers";
      EXPECT_LT(y_px, layout.page_size_px.y());
    } else if (words == "y (m)") {
      EXPECT_LT(x_px + 0.5 * 13.0 * 5.0, left_px) << "beside the map";
      EXPECT_GT(x_px, 12.0) << "not at the edge of the page";
      EXPECT_LT(y_px, top_px - 7.0);
      EXPECT_GT(y_px, top_px - 15.0);
    } else if (each.at("text-anchor") == "end") {
      const double line_px = layout.page_from_world({0.0, std::stod(words)}).y();
      EXPECT_GT(y_px, line_px + 3.0) << "the text is centred at the line";
      EXPECT_LT(y_px, line_px + 6.0);
      EXPECT_GT(x_px, left_px - 12.0);
      EXPECT_LT(x_px, left_px - 5.0);
      EXPECT_TRUE(is_line(left_px, line_px, right_px, line_px)) << words;
      out.beside.push_back(std::stod(words));
    } else {
      const double line_px = layout.page_from_world({std::stod(words), 0.0}).x();
      EXPECT_NEAR(x_px, line_px, 0.01) << words;
      EXPECT_GT(y_px, bottom_px + 13.0);
      EXPECT_LT(y_px, bottom_px + 25.0);
      EXPECT_TRUE(is_line(line_px, top_px, line_px, bottom_px)) << words;
      out.below.push_back(std::stod(words));
    }
  }
  EXPECT_EQ(lines.size(), out.below.size() + out.beside.size());
  return out;
}

// The tick spacing is the smallest of 0.5, 1, 2, 5, … m that divides the longer side into at most
// nine parts.
TEST(DrawAxes, PlacesTicksAtRoundNumbers) {
  const std::pair<double, double> spacings[] = {
      {2.0, 0.5},  {4.5, 0.5},   {4.6, 1.0},    {9.0, 1.0},   {9.1, 2.0},   {18.0, 2.0},
      {18.1, 5.0}, {45.0, 5.0},  {45.1, 10.0},  {90.0, 10.0}, {90.1, 20.0}, {180.0, 20.0},
      {181., 50.}, {450.0, 50.}, {451.0, 100.}, {900., 100.}};
  for (const auto& [extent_m, spacing_m] : spacings) {
    for (const bool is_tall : {false, true}) {
      SCOPED_TRACE(fmt::format("{} m, {}", extent_m, is_tall));
      models::World world;
      const Eigen::Vector2d size_m = is_tall ? Eigen::Vector2d(0.75 * extent_m, extent_m)
                                             : Eigen::Vector2d(extent_m, 0.75 * extent_m);
      world.bounds.min_m = {-0.25 * extent_m, 0.125 * extent_m};
      world.bounds.max_m = world.bounds.min_m + size_m;
      const Axes axes = expect_true_axes(world);
      for (const auto& [numbers, axis] : {std::pair(axes.below, 0), std::pair(axes.beside, 1)}) {
        ASSERT_FALSE(numbers.empty());
        EXPECT_LT(numbers.front() - spacing_m, world.bounds.min_m(axis))
            << "starts at the lower bound";
        EXPECT_GE(numbers.front(), world.bounds.min_m(axis));
        EXPECT_GT(numbers.back() + spacing_m, world.bounds.max_m(axis))
            << "ends at the upper bound";
        EXPECT_LE(numbers.back(), world.bounds.max_m(axis) + 1e-9) << "not beyond the bound";
        for (std::size_t i = 0; i < numbers.size(); ++i) {
          EXPECT_NEAR(numbers[i], numbers[0] + spacing_m * static_cast<double>(i), 1e-9);
          EXPECT_NEAR(std::remainder(numbers[i], spacing_m), 0.0, 1e-9)
              << "a multiple of the spacing";
        }
      }
    }
  }
}

}  // namespace
}  // namespace vantage::logs
