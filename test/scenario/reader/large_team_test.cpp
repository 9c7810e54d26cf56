#include <string>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::scenario {
namespace {

std::string smallest_with(const std::string& more) {
  return "name: smallest\nworld: {bounds: {min_m: [0, 0], max_m: [10, 10]}}\nrobots:\n"
         "  - {name: A, start: {x_m: 2, y_m: 3}, primitives: standard, sensor: {kind: range}}\n"
         "targets: {count: 1}\n" +
         more;
}

TEST(LargeTeam, AcceptsUpToTenThousandRobots) {
  for (const int robots : {64, 65, 200, 1000, 10'000, 10'001}) {
    std::string text =
        "name: crowd\nworld: {bounds: {min_m: [0, 0], max_m: [3000, 3000]}}\n"
        "robot_defaults: {primitives: standard, sensor: {kind: range}}\n"
        "estimator: {grid_resolution_m: 10}\ntargets: {count: " +
        std::to_string(robots) + "}\nrobots:\n";
    for (int i = 0; i < robots; ++i) {
      text += "  - {name: Q" + std::to_string(i) +
              ", start: {x_m: " + std::to_string(5 + 20 * (i % 140)) +
              ", y_m: " + std::to_string(5 + 20 * (i / 140)) + "}}\n";
    }
    if (robots > 10'000) {
      EXPECT_THROW((void)parse_scenario(text, "crowd.yaml"), StartupError);
      continue;
    }
    const Scenario crowd = parse_scenario(text, "crowd.yaml");
    EXPECT_EQ(crowd.robots.size(), static_cast<std::size_t>(robots));
    EXPECT_EQ(crowd.targets.size(), static_cast<std::size_t>(robots));
  }
}

std::string refusal_of_smallest_with(const std::string& more) {
  try {
    static_cast<void>(parse_scenario(smallest_with(more), "smallest.yaml"));
  } catch (const StartupError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(LargeTeam, RequiresALargeEnoughNeighbourhood) {
  const Scenario near =
      parse_scenario(smallest_with("network: {neighbourhood_m: 500, communication_range_m: 20}\n"
                                   "planner: {slots: 8}\n"),
                     "smallest.yaml");
  EXPECT_EQ(near.network.neighbourhood_m, 500.0);
  EXPECT_EQ(near.planner.slots, 8);
  EXPECT_EQ(parse_scenario(smallest_with(""), "smallest.yaml").network.neighbourhood_m, 0.0);
  for (const char* more : {"network: {neighbourhood_m: 500, communication_range_m: 501}\n",
                           "network: {neighbourhood_m: 0.1}\n"}) {
    EXPECT_NE(refusal_of_smallest_with(more).find("must be 0 (off) or at least"),
              std::string::npos);
  }
  for (const char* more :
       {"network: {communication_range_m: 3}\nplanner: {slots: 8}\n", "planner: {slots: 8}\n"}) {
    EXPECT_NE(refusal_of_smallest_with(more).find("with planner.slots above 0"), std::string::npos);
  }
  for (const char* more :
       {"planner: {attacks_max: 1}\n", "planner: {team_algorithm: local_search}\n"}) {
    EXPECT_NE(refusal_of_smallest_with(std::string("network: {neighbourhood_m: 500}\n") + more)
                  .find("need the messages of the whole team"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace vantage::scenario
