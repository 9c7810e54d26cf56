#include "logs/picture/panel.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "test/logs/picture/svg_text.hpp"

namespace vantage::logs {
namespace {

using test::elements;
using test::number;
using Attributes = std::map<std::string, std::string>;

struct Example {
  scenario::Scenario scenario;
  Scene scene;
  TrialSummary summary;

  [[nodiscard]] Layout layout() const { return {scenario.world.bounds, panel_height_px(scenario)}; }
  [[nodiscard]] std::string panel() const {
    Svg svg(2000.0, 1000.0);
    draw_panel(svg, layout(), scenario, scene, summary);
    return svg.str();
  }
  [[nodiscard]] std::vector<std::string> header() const {
    Svg svg(2000.0, 1000.0);
    draw_header(svg, layout(), scenario, summary, KeyNumbers::kTrial);
    std::vector<std::string> out;
    for (const Attributes& each : elements(svg.str(), "text")) {
      EXPECT_EQ(number(each, "x"), layout().map_corner_px.x());
      EXPECT_LT(number(each, "y"), layout().map_corner_px.y());
      out.push_back(each.at("words"));
    }
    return out;
  }
};

/// Returns a trial for which the legend has every possible line.
Example a_trial(std::size_t robots, std::size_t targets) {
  Example out;
  out.scenario.world.bounds = {{-4.0, -2.0}, {4.0, 2.0}};
  out.scenario.world.obstacles.resize(1);
  out.scenario.estimator.grid_memory_s = 17.5;
  for (std::size_t i = 0; i < robots; ++i) {
    out.scenario.robots.emplace_back().name = fmt::format("Q{}", i + 1);
  }
  for (std::size_t i = 0; i < targets; ++i) {
    out.scenario.targets.emplace_back().name = fmt::format("R{}", i + 1);
    const auto x = static_cast<double>(i);
    out.summary.discovery_time_s.push_back(i % 3 == 2 ? std::nullopt : std::optional(10.04 + x));
    out.summary.rmse_per_target_m.push_back(i % 3 == 1 ? std::nullopt : std::optional(0.25 + x));
    out.summary.entropy_per_target_nats.push_back(-0.5 - x);
  }
  out.scene.jammed = {"Q2"};
  return out;
}

Example a_mapping_trial(std::size_t robots) {
  Example out = a_trial(robots, 0);
  out.scenario.planner.objective = scenario::PlanObjective::kMapping;
  out.scene.map.emplace();
  for (std::size_t i = 0; i < robots; i += 2) {
    out.scene.map_entropies_nats[out.scenario.robots[i].name] = 100.0 + static_cast<double>(i);
  }
  out.summary.map_entropy_nats = 123.4;
  return out;
}

/// Returns the words of each line, from left to right; lines from top to bottom.
std::vector<std::vector<std::string>> rows(const std::string& svg) {
  std::map<double, std::map<double, std::string>> by_place;
  for (const Attributes& each : elements(svg, "text")) {
    by_place[number(each, "y")][number(each, "x")] = each.at("words");
  }
  std::vector<std::vector<std::string>> out;
  for (const auto& [y_px, row] : by_place) {
    out.emplace_back();
    for (const auto& [x_px, words] : row) {
      out.back().push_back(words);
    }
  }
  return out;
}

using Rows = std::vector<std::vector<std::string>>;

void expect_first_rows(const Rows& found, const Rows& wanted) {
  ASSERT_GE(found.size(), wanted.size());
  EXPECT_EQ(Rows(found.begin(), found.begin() + std::ssize(wanted)), wanted);
}

TEST(DrawPanel, HasARowPerTargetAndCountsTheRest) {
  expect_first_rows(rows(a_trial(2, 3).panel()), {{"Targets"},
                                                  {"name", "found", "RMSE", "entropy"},
                                                  {"R1", "10.0 s", "0.25 m", "-0.50 nat"},
                                                  {"R2", "11.0 s", "–", "-1.50 nat"},
                                                  {"R3", "–", "2.25 m", "-2.50 nat"},
                                                  {"Legend"}});
  for (const std::size_t targets : {12U, 13U, 30U}) {
    const Rows all = rows(a_trial(2, targets).panel());
    EXPECT_EQ(all.at(2 + 11).at(0), "R12");
    EXPECT_EQ(all.at(2 + 12).at(0),
              targets == 12 ? "Legend" : fmt::format("and {} more", targets - 12));
  }
  Example unsaid = a_trial(2, 3);
  unsaid.summary = {};  // a summary of another scenario
  expect_first_rows(rows(unsaid.panel()),
                    {{"Targets"}, {"name", "found", "RMSE", "entropy"}, {"and 3 more"}});
}

TEST(DrawPanel, HasARowPerMappingRobotAndTheMean) {
  expect_first_rows(rows(a_mapping_trial(3).panel()), {{"Maps"},
                                                       {"as known by", "entropy"},
                                                       {"Q1", "100 nat", ""},
                                                       {"Q2", "–", "jammed"},
                                                       {"Q3", "102 nat", ""},
                                                       {"mean", "123 nat", ""},
                                                       {"Legend"}});
  for (const std::size_t robots : {11U, 12U, 20U}) {
    const Rows all = rows(a_mapping_trial(robots).panel());
    EXPECT_EQ(all.at(2 + 10).at(0), "Q11");
    EXPECT_EQ(all.at(2 + 11).at(0), "mean");
  }
}

TEST(DrawPanel, ExplainsOnlyDrawnItems) {
  const auto legend = [](const Example& it) {
    std::vector<std::string> out;
    bool is_legend = false;
    for (const auto& row : rows(it.panel())) {
      if (is_legend && row.at(0).front() != 'Q') {
        out.push_back(row.at(0));
      }
      is_legend |= row.at(0) == "Legend";
    }
    return out;
  };
  Example it = a_trial(5, 2);
  EXPECT_EQ(legend(it),
            (std::vector<std::string>{
                "robot with a jammed sensor", "way of the last 20 s", "committed plan and its end",
                "field of view", "target, true position", "estimate: mean and 95 % ellipse",
                "ground seen lately", "seen longer ago than 17.5 s", "never seen", "obstacle"}));
  it.scene.jammed.clear();
  it.scenario.targets.clear();
  it.scenario.estimator.grid_memory_s = 0.0;
  it.scenario.world.obstacles.clear();
  EXPECT_EQ(legend(it),
            (std::vector<std::string>{"way of the last 20 s", "committed plan and its end",
                                      "field of view", "ground seen lately", "never seen"}));
  EXPECT_EQ(
      legend(a_mapping_trial(2)),
      (std::vector<std::string>{"robot with a jammed sensor", "way of the last 20 s",
                                "committed plan and its end", "field of view", "mapped: occupied",
                                "mapped: free", "mapped: not settled", "obstacle"}));
}

// panel_height_px() is the height needed when the legend shows everything.
TEST(DrawPanel, HasTheStatedHeight) {
  for (const std::size_t robots : {1U, 4U, 5U, 12U, 30U}) {
    for (const std::size_t targets : {0U, 1U, 5U, 12U, 13U, 40U}) {
      for (const bool maps : {false, true}) {
        const Example it = maps ? a_mapping_trial(robots) : a_trial(robots, targets);
        SCOPED_TRACE(fmt::format("{} {} {}", robots, targets, maps));
        double last_px = 0.0;
        double right_px = 0.0;
        for (const Attributes& each : elements(it.panel(), "text")) {
          last_px = std::max(last_px, number(each, "y"));
          right_px = std::max(right_px, number(each, "x"));
          EXPECT_GT(number(each, "y"), it.layout().panel_corner_px.y());
          EXPECT_GE(number(each, "x"), it.layout().panel_corner_px.x());
        }
        const double room_px =
            it.layout().panel_corner_px.y() + panel_height_px(it.scenario) - last_px;
        // Two of ten lines of 24 px are unused in a mapping trial or without targets.
        const int unused = maps || targets == 0 ? 2 : 0;
        EXPECT_NEAR(room_px, 24.0 * unused + 24.0 - 4.5, 2.0);
        EXPECT_LT(right_px, it.layout().page_size_px.x() - 20.0);
      }
    }
  }
}

// The numbers of each column end at the right edge of its heading; rows have equal distances.
TEST(DrawPanel, AlignsItsColumns) {
  for (const Example& it : {a_trial(6, 4), a_mapping_trial(6)}) {
    std::map<std::string, std::vector<double>> ends_px;
    double head_px = 0.0;
    double row_px = 0.0;
    for (const Attributes& each : elements(it.panel(), "text")) {
      const double x_px = number(each, "x") - it.layout().panel_corner_px.x();
      if (each.at("words") == "Legend") {
        break;
      }
      if (each.contains("text-anchor") && !each.at("words").empty() &&
          each.at("words") != "jammed") {
        ends_px[fmt::format("{:.1f}", x_px)].push_back(number(each, "y"));
      } else if (x_px == 0.0 && head_px > 0.0 && each.at("words").front() != 'n' &&
                 each.at("words").front() != 'a') {
        EXPECT_TRUE(row_px == 0.0 || number(each, "y") - row_px == 20.0) << each.at("words");
        row_px = number(each, "y");
      }
      head_px = number(each, "y");
    }
    EXPECT_EQ(ends_px.size(), it.scene.map ? 1U : 3U);
    for (const auto& [x_px, ys_px] : ends_px) {
      EXPECT_EQ(ys_px.size(), it.scene.map ? 1U + 6U + 1U : 1U + 4U);
    }
    const auto rules = elements(it.panel(), "line");
    ASSERT_FALSE(rules.empty());
    EXPECT_EQ(number(rules[0], "x1"), it.layout().panel_corner_px.x());
    EXPECT_NEAR(number(rules[0], "x2"), it.layout().panel_corner_px.x() + 325.0, 1e-9);
    EXPECT_EQ(number(rules[0], "y1"), number(rules[0], "y2"));
  }
}

// The legend has four robots per row, each with its symbol before its name.
TEST(DrawPanel, ListsTheRobotsWithTheirColours) {
  const Example it = a_trial(10, 1);
  const std::string svg = it.panel();
  const std::size_t begin = svg.find(">Legend<");
  const auto names = elements(svg.substr(begin), "text");
  const auto bodies = elements(svg.substr(begin), "circle");
  std::size_t body = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    ASSERT_EQ(names[i].at("words"), fmt::format("Q{}", i + 1));
    EXPECT_EQ(bodies[body].at("fill"), robot_colour(i));
    const double gap_px = number(names[i], "x") - number(bodies[body], "cx");
    EXPECT_GT(gap_px, number(bodies[body], "r") * 1.75) << "beyond the heading mark";
    EXPECT_LT(gap_px, 20.0);
    EXPECT_NEAR(number(names[i], "y") - 4.5, number(bodies[body], "cy"), 0.01);
    if (i >= 8) {
      EXPECT_EQ(bodies[body + 1].at("fill"), robot_core_colour(i));
    }
    EXPECT_NEAR(number(names[i], "x") - number(names[0], "x"), 86.0 * static_cast<double>(i % 4),
                0.01);
    EXPECT_NEAR(number(names[i], "y") - number(names[0], "y"), 20.0 * static_cast<double>(i / 4),
                0.01);
    body += i >= 8 ? 2 : 1;
  }
}

TEST(DrawHeader, StatesTheTrialsResults) {
  Example it = a_trial(2, 5);
  it.summary.scenario = "lab";
  it.summary.algorithm = "arvi";
  it.summary.seed = 7;
  it.summary.discovered = 3;
  it.summary.targets = 5;
  it.summary.duration_s = 299.6;
  it.summary.rmse_m = 0.256;
  it.summary.entropy_nats = 1.234;
  it.summary.collisions = 1;
  it.summary.separation_violations = 2;
  it.summary.min_separation_m = 0.612;
  it.summary.rounds_late = 4;
  it.summary.rounds = 100;
  EXPECT_EQ(it.header(),
            (std::vector<std::string>{
                "lab: 3 of 5 targets found in 300 s",
                "arvi, seed 7 · RMSE 0.26 m · entropy 1.23 nat · 1 collisions · 2 near misses · "
                "least separation 0.61 m · 4 of 100 rounds late"}));
  it.scenario.planner.objective = scenario::PlanObjective::kMapping;
  it.summary.min_separation_m.reset();
  it.summary.map_entropy_nats = 45.6;
  EXPECT_EQ(it.header(), (std::vector<std::string>{
                             "lab: map after 300 s",
                             "arvi, seed 7 · map entropy 46 nat · 1 collisions · 2 near misses · "
                             "least separation – · 4 of 100 rounds late"}));
}

}  // namespace
}  // namespace vantage::logs
