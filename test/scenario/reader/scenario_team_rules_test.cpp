#include <string>

#include <gtest/gtest.h>

#include "test/scenario/reader/answer_to.hpp"

// Tests rules that relate several keys. The complete error message is compared, with numbers, names
// and line.

namespace vantage::scenario {
namespace {

using test::answer_to;
using test::answer_to_robot;
using test::answer_to_two;
using test::kDefaults;
using test::kTargets;

// The world is not centred at the origin, so that an offset with the wrong sign is detected.
TEST(ScenarioRules, GridsAndRandomPositionsFollowWorldOffset) {
  const auto world = [](double x_m, double y_m, const std::string& more) {
    const auto text = [](double a, double b) {
      return "[" + std::to_string(a) + ", " + std::to_string(b) + "]";
    };
    return "name: x\nworld: {bounds: {min_m: " + text(x_m, y_m) +
           ", max_m: " + text(x_m + 100.0, y_m + 50.0) + "}}\n" + kDefaults +
           "robots: [{name: A, start: {x_m: " + std::to_string(x_m + 1.0) +
           ", y_m: " + std::to_string(y_m + 1.0) + "}}]\n" + kTargets + more;
  };
  for (const double x_m : {-300.0, -50.0, 0.0, 200.0}) {
    const double y_m = 0.5 * x_m;
    EXPECT_EQ(answer_to(world(x_m, y_m, "mapping: {resolution_m: 0.5}\n")), "taken");
    EXPECT_EQ(answer_to(world(x_m, y_m, "mapping: {resolution_m: 0.25}\n")),
              "f:6: mapping.resolution_m: must divide world.bounds into at most 50000 cells; "
              "0.25 gives 8e+04");
    EXPECT_EQ(answer_to(world(x_m, y_m, "estimator: {grid_resolution_m: 0.03125}\n")),
              "f:6: estimator.grid_resolution_m: must divide world.bounds into at most 4000000 "
              "cells; 0.03125 gives 5120000");
    const models::DampedOscillator drawn =
        parse_scenario(
            world(x_m, y_m, "estimator: {target_model: {kind: damped_oscillator, q: 0.1}}\n"), "f")
            .estimator.target_model.oscillator;
    EXPECT_EQ(drawn.center_m, Eigen::Vector2d(x_m + 50.0, y_m + 25.0));
    // The variance of a uniform draw of length l is l²/12.
    EXPECT_NEAR(drawn.position_sigma_m.x() * drawn.position_sigma_m.x(), 1e4 / 12.0, 1e-9);
    EXPECT_NEAR(drawn.position_sigma_m.y() * drawn.position_sigma_m.y(), 2.5e3 / 12.0, 1e-9);
  }
}

TEST(ScenarioRules, RoundsAreLongEnough) {
  const auto with = [](const std::string& planner) {
    return answer_to_robot("", "planner: {" + planner + "}\n");
  };
  EXPECT_EQ(with("horizon_steps: 7, execute_steps: 7"), "taken");
  EXPECT_EQ(with("horizon_steps: 7, execute_steps: 8"),
            "f:7: planner.execute_steps: must be at most horizon_steps (7), but is 8");
  const std::string round = "execute_steps: 3, step_s: 0.25, publish_margin_s: 0.125, ";
  EXPECT_EQ(with(round + "team_budget_s: 0.625"), "taken") << "exactly the duration of the round";
  EXPECT_EQ(with(round + "team_budget_s: 0.75"),
            "f:7: planner.team_budget_s: must be at most the round (execute_steps · step_s = 0.75 "
            "s) minus publish_margin_s (0.125), but is 0.75");
}

TEST(ScenarioRules, ToursNeedASearchForTargets) {
  const auto with = [](const std::string& planner) {
    return answer_to_two(", start: {x_m: 1, y_m: 1}", ", start: {x_m: 4, y_m: 1}",
                         "planner: {" + planner + "}\nmapping: {}\n");
  };
  const std::string tour = "tour: {horizon_s: 30}";
  EXPECT_EQ(with(tour), "taken");
  EXPECT_EQ(with(tour + ", attacks_max: 1"), "taken");
  EXPECT_EQ(with(tour + ", objective: mapping"),
            "f:8: planner.tour: horizon_s must be 0 (off) unless objective: tracking; is 30");
  EXPECT_EQ(
      with(tour + ", team_algorithm: local_search"),
      "f:8: planner.tour: horizon_s must be 0 (off) with team_algorithm: local_search; is 30");
  EXPECT_EQ(with("tour: {horizon_s: 0, weight: 2}, objective: mapping"), "taken");
}

TEST(ScenarioRules, TeamAlgorithmsExcludeEachOther) {
  const auto with = [](const std::string& planner) {
    return answer_to_two(", start: {x_m: 1, y_m: 1}", ", start: {x_m: 4, y_m: 1}",
                         "planner: {" + planner + "}\nmapping: {}\n");
  };
  const std::string local = "team_algorithm: local_search";
  for (const std::string search : {"arvi", "rvi"}) {
    EXPECT_EQ(with(local + ", algorithm: " + search), "taken");
  }
  EXPECT_EQ(with(local + ", algorithm: greedy"),
            "f:8: planner.algorithm: must be arvi or rvi with team_algorithm: local_search, which "
            "needs their candidates; is greedy");
  EXPECT_EQ(with(local + ", objective: mapping"),
            "f:8: planner.team_algorithm: local_search needs objective: tracking");
  EXPECT_EQ(with(local + ", attacks_max: 1"),
            "f:8: planner.attacks_max: must be 0 with team_algorithm: local_search, is 1");
  EXPECT_EQ(with("attacks_max: 1"), "taken");
  EXPECT_EQ(with("algorithm: greedy"), "taken");
  EXPECT_EQ(with("algorithm: external"), "taken");
  EXPECT_EQ(with("algorithm: external, attacks_max: 1"),
            "f:8: planner.attacks_max: must be 0 with algorithm: external, which sends no "
            "proposals; is 1");
  EXPECT_EQ(with("attacks_max: 2"),
            "f:8: planner: attacks_max must be below the number of robots (2), but is 2");
  EXPECT_EQ(with("attacks_max: 1001"),
            "f:8: planner.attacks_max: must be at least 0 and at most 1000, is '1001'");
  EXPECT_EQ(with("attacks_max: 5"),
            "f:8: planner: attacks_max must be below the number of robots (2), but is 5");
}

// A belief contains targets and, for each cell of the world or of the neighbourhood, the time of
// its last observation.
TEST(ScenarioRules, GridsFitIntoAMessage) {
  const auto with = [](const std::string& side_m, const std::string& resolution_m,
                       const std::string& neighbourhood_m, const std::string& targets = "1") {
    return answer_to("name: x\nworld: {bounds: {min_m: [0, 0], max_m: [" + side_m + ", " + side_m +
                     "]}}\ntargets: {count: " + targets + "}\n" + kDefaults +
                     "robots: [{name: A, start: {x_m: 2, y_m: 2}}]\nestimator: "
                     "{grid_resolution_m: " +
                     resolution_m + "}\nnetwork: {neighbourhood_m: " + neighbourhood_m + "}\n");
  };
  EXPECT_EQ(with("707", "1", "0"), "taken");
  EXPECT_EQ(
      with("708", "1", "0"),
      "f:6: estimator.grid_resolution_m: must divide world.bounds, which every belief covers, "
      "into at most 499975 cells; 1 gives 501264");
  EXPECT_EQ(with("707", "1", "0", "7"),
            "f:6: estimator.grid_resolution_m: must divide world.bounds, "
            "which every belief covers, into at most 499825 cells; 1 "
            "gives 499849");
  EXPECT_EQ(with("707", "1", "0", "6"), "taken") << "499850 cells";
  EXPECT_EQ(with("1000", "0.5", "80"), "taken")
      << "four million cells, of which 400 by 400 are published";
  EXPECT_EQ(with("1000", "0.4999", "80"),
            "f:6: estimator.grid_resolution_m: must divide world.bounds into at most 4000000 "
            "cells; 0.4999 gives 4004001");
  EXPECT_EQ(with("400", "0.283", "80"), "taken") << "707 by 707";
  EXPECT_EQ(with("400", "0.28", "80"),
            "f:6: estimator.grid_resolution_m: must divide the area of each belief (side 2.5 · "
            "network.neighbourhood_m) into at most 499975 cells; 0.28 gives 511225");
}

// 63 steps and a stop are 64 segments; a stop from 4 m/s at 2 m/s² takes 2 s.
TEST(ScenarioRules, PlansAreNotTooLongForDrivers) {
  const auto with = [](const std::string& device, const std::string& horizon_steps,
                       const std::string& step_s) {
    return answer_to_two(
        ", start: {x_m: 2, y_m: 2}, device: " + device,
        ", start: {x_m: -2, y_m: -2}, limits: {speed_max_mps: 4, brake_mps2: 2}",
        "planner: {horizon_steps: " + horizon_steps + ", step_s: " + step_s + "}\n");
  };
  for (const std::string device :
       {"wire", "real, autopilot: {dialect: px4, url: \"udp://:1\", key_file: k, system_id: 1}"}) {
    EXPECT_EQ(with(device, "63", "0.5"), "taken");
    EXPECT_EQ(with(device, "64", "0.5"),
              "f:8: planner: horizon_steps must be at most 63, the longest plan that a driver "
              "accepts, if a robot's device is wire or real; is 64");
  }
  EXPECT_EQ(with("direct", "64", "0.5"), "taken");
  EXPECT_EQ(with("wire", "39", "1.4871"), "taken") << "57.997 s, and 2 s";
  EXPECT_EQ(with("direct", "39", "1.4872"), "taken");
  EXPECT_EQ(with("wire", "39", "1.4872"),
            "f:8: planner: horizon_steps · step_s plus the longest stop of B (60 s) must be below "
            "60 s if a robot's device is wire or real");
}

// The limit for one robot with the defaults is 2 (3 (6 + 2 · 3) + 9/4) + 0.6 + 2 · 0.2 m.
TEST(ScenarioRules, NeighbourhoodsRequireTrackingTeamWithSlots) {
  const auto with = [](const std::string& neighbourhood_m, const std::string& planner) {
    return answer_to_robot("", "network: {neighbourhood_m: " + neighbourhood_m +
                                   "}\nmapping: {}\nplanner: {" + planner + "}\n");
  };
  EXPECT_EQ(with("77.5", "slots: 4"), "taken");
  EXPECT_EQ(with("77.25", "slots: 4"),
            "f:7: network.neighbourhood_m: must be 0 (off) or at least 77.5 here: otherwise two "
            "robots can come too close before they have exchanged plans; is 77.25");
  EXPECT_EQ(with("0", ""), "taken");
  EXPECT_EQ(with("0", "slots: 1"),
            "f:7: network.neighbourhood_m: must be above 0 with planner.slots above 0, so that "
            "robots near each other plan in different slots");
  for (const char* whole : {"objective: mapping", "team_algorithm: local_search"}) {
    EXPECT_EQ(with("77.5", whole),
              "f:7: network.neighbourhood_m: must be 0 with objective: mapping, team_algorithm: "
              "local_search or attacks_max above 0, which need the messages of the whole team");
    EXPECT_EQ(with("0", whole), "taken");
  }
}

TEST(ScenarioRules, NetworkAndSignatureValuesAreChecked) {
  const auto url = [](const std::string& word) {
    return answer_to_robot("", "network: {url: \"" + word + "\"}\n");
  };
  EXPECT_EQ(url("udpm://239.255.76.67:7667"), "taken");
  EXPECT_EQ(url("memq://"), "taken");
  for (const std::string none : {"udp://h:1", "xudpm://", "memq:/", "file://log"}) {
    EXPECT_EQ(url(none), "f:7: network.url: must begin with udpm:// or memq://, is '" + none + "'");
  }
  const auto security = [](const std::string& keys) {
    return answer_to_robot("", "security: {" + keys + "}\n");
  };
  EXPECT_EQ(security("mode: off"), "taken");
  EXPECT_EQ(security("mode: warn, keys: k"), "taken");
  for (const char* mode : {"warn", "require"}) {
    EXPECT_EQ(security(std::string("mode: ") + mode),
              "f:7: security: keys: must name the folder that `vantage keys new` created");
  }
  EXPECT_EQ(security("keys: k"), "f:7: security: missing required key mode");
}

TEST(ScenarioRules, AttacksHaveATimeSpanAndKnownRobots) {
  const auto attack = [](const std::string& keys) {
    return answer_to_robot("", "attacks:\n  - {" + keys + "}\n");
  };
  EXPECT_EQ(attack("from_s: 2.5, to_s: 2.75, robots: [A]"), "taken");
  EXPECT_EQ(attack("to_s: 2, robots: []"), "taken");
  EXPECT_EQ(attack("from_s: 2.5, to_s: 2.5, robots: [A]"),
            "f:8: attacks[0].to_s: must be above from_s (2.5), but is 2.5");
  EXPECT_EQ(attack("from_s: 2.5, to_s: 1, robots: [A]"),
            "f:8: attacks[0].to_s: must be above from_s (2.5), but is 1");
  EXPECT_EQ(attack("to_s: 2, robots: [A, B]"),
            "f:8: attacks[0].robots[1]: must be the name of a robot, is 'B'");
  EXPECT_EQ(attack("to_s: 2"), "f:8: attacks[0]: missing required key robots");
  EXPECT_EQ(attack("robots: [A], from_s: 1").find("f:8: attacks[0]"), 0U);
  const auto many = [](int count) {
    std::string text = "attacks:\n";
    for (int i = 0; i < count; ++i) {
      text += "  - {to_s: 2, robots: [A]}\n";
    }
    return answer_to_robot("", text);
  };
  EXPECT_EQ(many(1000), "taken");
  EXPECT_EQ(many(1001), "f:7: attacks: must contain at most 1000 attacks, contains 1001");
}

TEST(ScenarioRules, HostsAreLimitedAndRunEachPartOnce) {
  const auto many = [](int count) {
    std::string text = "hosts:\n";
    for (int i = 0; i < count; ++i) {
      text += "  - {name: H" + std::to_string(i) + ", runs: []}\n";
    }
    return answer_to_robot("", text);
  };
  EXPECT_EQ(many(1), "taken");
  EXPECT_EQ(many(32), "taken");
  EXPECT_EQ(many(33), "f:7: hosts: must contain at least 1 and at most 32 hosts, contains 33");
  EXPECT_EQ(answer_to_robot("",
                            "hosts:\n  - {name: L, runs: [sim, logger]}\n"
                            "  - {name: M, runs: [A]}\n  - {name: N, runs: [vicon, A]}\n"),
            "f:10: hosts[2].runs[1]: 'A' already runs on M");
  EXPECT_EQ(answer_to_robot("", "hosts:\n  - {runs: [A]}\n"),
            "f:8: hosts[0]: missing required key name");
}

TEST(ScenarioRules, CostRegionsLieInWorld) {
  const auto paying = [](const std::string& regions) {
    return answer_to(
        "name: x\nworld:\n  bounds: {min_m: [-9, -5], max_m: [9, 5]}\n  regions:\n"
        "    - {name: mud, footprint: {min_m: [1, 1], max_m: [2, 2]}}\n"
        "    - {name: ice, footprint: {min_m: [1, 1], max_m: [2, 2]}}\n" +
        kTargets + kDefaults +
        "robots:\n  - {name: A, start: {x_m: 0, y_m: 0}, "
        "energy: {regions: " +
        regions + "}}\n");
  };
  EXPECT_EQ(paying("[mud, ice]"), "taken");
  EXPECT_EQ(paying("[mud, sand]"),
            "f:10: robots[0].energy.regions[1]: must be the name of one of world.regions, is "
            "'sand'");
}

TEST(LineOfKey, IsTheLineOfTheInnermostGivenKey) {
  const std::string text = "a: 1\n\nb:\n  c:\n    d: [e: 1]\n  f: 2\ng: 3\n";
  EXPECT_EQ(line_of_key(text, "a"), 1);
  EXPECT_EQ(line_of_key(text, "b"), 3);
  EXPECT_EQ(line_of_key(text, "b.c"), 4);
  EXPECT_EQ(line_of_key(text, "b.c.d"), 5);
  EXPECT_EQ(line_of_key(text, "b.c.d.e"), 5) << "a list has no keys";
  EXPECT_EQ(line_of_key(text, "b.f"), 6);
  EXPECT_EQ(line_of_key(text, "b.x"), 3);
  EXPECT_EQ(line_of_key(text, "b.x.c"), 3);
  EXPECT_EQ(line_of_key(text, "g.a"), 7);
  EXPECT_EQ(line_of_key(text, "x"), 0);
}

}  // namespace
}  // namespace vantage::scenario
