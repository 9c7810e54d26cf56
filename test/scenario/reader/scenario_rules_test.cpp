#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/sensor/law.hpp"
#include "test/scenario/reader/answer_to.hpp"

// Tests rules that relate several keys. The complete error message is compared, with numbers, names
// and line.

namespace vantage::scenario {
namespace {

using test::answer_to;
using test::answer_to_robot;
using test::answer_to_team;
using test::answer_to_two;
using test::kDefaults;
using test::kTargets;
using test::kWorld;

using Pairs = std::vector<std::array<std::string, 2>>;
using Triples = std::vector<std::array<std::string, 3>>;

TEST(ScenarioRules, NamesConsistOfChannelCharacters) {
  EXPECT_EQ(answer_to_two(", start: {x_m: 1, y_m: 1}", ", start: {x_m: 4, y_m: 1}"), "taken");
  for (const char letter : {'A', 'Z', '0', '9'}) {
    const std::string name(1, letter);
    EXPECT_EQ(answer_to_team("  - {name: '" + name + "', start: {x_m: 1, y_m: 1}}\n"), "taken");
  }
  for (const char other : {'@', '[', '/', ':', 'a', '_', '-'}) {
    const std::string name = std::string("A") + other;
    EXPECT_EQ(answer_to_team("  - {name: '" + name + "', start: {x_m: 1, y_m: 1}}\n"),
              "f:6: robots[0].name: must contain only A-Z and 0-9, is '" + name + "'");
  }
  const auto named = [](const std::string& name) {
    return answer_to("name: '" + name + "'\n" + kWorld.substr(8) + kTargets + kDefaults +
                     "robots: [{name: A, start: {x_m: 1, y_m: 1}}]\n");
  };
  EXPECT_EQ(named("azAZ09-_"), "taken");
  for (const char other : {'@', '[', '`', '{', '/', ':', ',', '.', '^'}) {
    const std::string name = std::string("a") + other;
    EXPECT_EQ(named(name),
              "f:1: name: must contain only letters, digits, - and _, is '" + name + "'");
  }
}

TEST(ScenarioRules, ParametersBelongToTheirSensorKind) {
  const std::string moving = "estimator: {target_model: {kind: double_integrator, q: 0.1}}\n";
  const auto with = [&](const std::string& sensor) {
    return answer_to_robot(", sensor: {" + sensor + "}", moving);
  };
  const std::string kind = "kind: range_rate, range_min_m: 0.1";
  EXPECT_EQ(with(kind), "taken");
  EXPECT_EQ(with(kind + ", range_rate_sigma_mps: 0.2"), "taken");
  EXPECT_EQ(with(kind + ", range_rate_sigma_mps: 0"),
            "f:6: robots[0].sensor.range_rate_sigma_mps: must be above 0, is 0");
  EXPECT_EQ(with("kind: range, range_rate_sigma_mps: 0.2"),
            "f:6: robots[0].sensor.range_rate_sigma_mps: is a parameter of sensor kind range_rate; "
            "kind range has its own parameters: none");
  EXPECT_EQ(with(kind + ", range_rate_sigma: 0.2"),
            "f:6: robots[0].sensor.range_rate_sigma: unknown key, wrong unit; did you mean "
            "range_rate_sigma_mps?");
  const Scenario read = parse_scenario(
      kWorld + kTargets + kDefaults + "robots:\n  - {name: A, start: {x_m: 2, y_m: 2}, sensor: {" +
          kind + ", range_rate_sigma_mps: 0.2}}\n" + moving,
      "f");
  EXPECT_EQ(models::own_parameter(read.robots[0].sensor, 0), 0.2);
}

TEST(ScenarioRules, VelocitySensorsNeedAMinimumRangeAndTargetsWithVelocity) {
  const std::string moving = "estimator: {target_model: {kind: double_integrator, q: 0.1}}\n";
  EXPECT_EQ(answer_to_robot(", sensor: {kind: range_rate}", moving),
            "f:6: robots[0].sensor: range_min_m: must be above 0 for a sensor that measures "
            "velocities, is 0");
  EXPECT_EQ(answer_to_robot(", sensor: {kind: range_rate, range_min_m: 0.1}",
                            "estimator: {target_model: {kind: random_walk, q: 0.1}}\n"),
            "f:7: estimator: target_model.kind must be one with a velocity, such as "
            "double_integrator, for the sensor of robot A, kind range_rate; is random_walk");
}

TEST(ScenarioRules, NamesOfBodiesAreUnique) {
  const std::string robots = "  - {name: A, start: {x_m: 2, y_m: 2}}\n";
  const std::string base = kWorld + kDefaults + "robots:\n" + robots + "targets:\n";
  EXPECT_EQ(answer_to(base + "  - {name: B}\n  - {name: C}\n"), "taken");
  EXPECT_EQ(answer_to(base + "  - {name: B}\n  - {name: B}\n"),
            "f:8: targets[1].name: must be unique; an earlier robot or target "
            "is called B");
  EXPECT_EQ(answer_to(base + "  - {name: a}\n"),
            "f:7: targets[0].name: must contain only A-Z and 0-9, is 'a'");
  EXPECT_EQ(answer_to(kWorld + kDefaults + "robots:\n" + robots +
                      "targets: {count: 2, name_prefix: t}\n"),
            "f:6: targets.name_prefix: must contain only A-Z and 0-9, is 't'");
  EXPECT_EQ(answer_to(kWorld + kDefaults + "robots: [{name: T2, start: {x_m: 1, y_m: 1}}]\n" +
                      "targets: {count: 3}\n"),
            "f:5: targets: name_prefix: gives a target the name T2, which a "
            "robot already has");
  EXPECT_EQ(answer_to(kWorld + kDefaults + "robots:\n" + robots + "targets: {radius_m: 1}\n"),
            "f:6: targets: missing required key count");
}

TEST(ScenarioRules, TheFirstMissingKeyIsReportedWithItsSection) {
  EXPECT_EQ(answer_to_robot(", limits: {}"), "taken");
  EXPECT_EQ(answer_to_team("  - {name: A, start: {}}\n"),
            "f:6: robots[0].start: missing required key x_m");
  EXPECT_EQ(answer_to_team("  - {start: {x_m: 1, y_m: 1}}\n"),
            "f:6: robots[0]: missing required key name")
      << "the key of the robot, not of a section below it";
  EXPECT_EQ(answer_to_team("  -\n"),
            "f:5: robots[0]: has no value; expected a mapping of keys to values");
  EXPECT_EQ(answer_to_robot("", "wind: {x_mps: 1,\n  y_mps: 2,\n  x_mps: 3}\n"),
            "f:9: wind.x_mps: duplicate key, first given on line 7");
  EXPECT_EQ(answer_to_robot(", sensor: {fov_rad: 1,\n    fov_deg: 60}"),
            "f:7: robots[0].sensor.fov_deg: given twice, as fov_rad and as fov_deg; keep one");
  EXPECT_EQ(answer_to_robot(", sensor: {fov_deg: 60,\n    fov_rad: 1}"),
            "f:7: robots[0].sensor.fov_rad: given twice, as fov_rad and as fov_deg; keep one");
  EXPECT_EQ(answer_to_robot(", sensor: {fov_rad: 1, fov_deg: 60}"),
            "f:6: robots[0].sensor.fov_deg: given twice, as fov_rad and as fov_deg; keep one");
  EXPECT_EQ(answer_to_robot(", primitives: [{speed_mps: 1}]"),
            "f:6: robots[0].primitives[0]: missing required key yaw_rate_radps");
  EXPECT_EQ(answer_to_robot(", primitives: [{yaw_rate_radps: 1}]"),
            "f:6: robots[0].primitives[0]: missing required key speed_mps");
}

TEST(ScenarioRules, PrimitivesAreLimitedInNumberAndSpeed) {
  const auto of = [](int count) {
    std::string list;
    for (int i = 0; i < count; ++i) {
      list += (i == 0 ? "" : ", ") + std::string("{speed_mps: 0, yaw_rate_radps: 0}");
    }
    return ", primitives: [" + list + "]";
  };
  EXPECT_EQ(answer_to_robot(of(1)), "taken");
  EXPECT_EQ(answer_to_robot(of(64)), "taken");
  EXPECT_EQ(answer_to_robot(of(65)),
            "f:6: robots[0].primitives: must contain at least 1 and at most 64 primitives, "
            "contains 65");
  const std::string limits = ", limits: {speed_max_mps: 2, yaw_rate_max_radps: 1.5}";
  const auto one = [&](const std::string& speed, const std::string& turn) {
    return answer_to_robot(limits + ", primitives: [{speed_mps: " + speed +
                           ", yaw_rate_radps: " + turn + "}]");
  };
  for (const char* turn : {"1.5", "-1.5"}) {
    EXPECT_EQ(one("2", turn), "taken");
  }
  EXPECT_EQ(
      one("2.25", "0"),
      "f:6: robots[0].primitives: speed_mps must be at most limits.speed_max_mps (2), but is 2.25");
  for (const std::string turn : {"1.75", "-1.75"}) {
    EXPECT_EQ(one("0", turn),
              "f:6: robots[0].primitives: yaw_rate_radps must be at most "
              "limits.yaw_rate_max_radps (1.5) in either direction, but is " +
                  turn);
  }
}

TEST(ScenarioRules, StartsKeepClearanceToWallsObstaclesAndRobots) {
  const auto at = [](const std::string& x, const std::string& y) {
    return answer_to_team("  - {name: A, start: {x_m: " + x + ", y_m: " + y + "}}\n");
  };
  // The horizontal limit is the radius, 0.25 m, plus 0.1 m, at each of the four walls.
  for (const auto& [x, y] : Pairs{{"8.6", "0"}, {"-8.6", "0"}, {"0", "4.6"}, {"0", "-4.6"}}) {
    EXPECT_EQ(at(x, y), "taken");
  }
  for (const auto& [x, y] : Pairs{{"8.75", "0"}, {"-8.75", "0"}, {"0", "4.75"}, {"0", "-4.75"}}) {
    EXPECT_EQ(at(x, y),
              "f:6: robots[0].start: must be at least 0.35 m from obstacles "
              "and walls; at (" +
                  x + ", " + y + ") m it is 0.25");
  }
  const std::string a = ", start: {x_m: 1, y_m: 1}, height_m: 3";
  const auto b = [](const std::string& x, const std::string& y, const std::string& z) {
    return ", start: {x_m: " + x + ", y_m: " + y + "}, height_m: " + z;
  };
  // In space, 0.6 m along any axis is enough, and so are 0.36 m and 0.48 m along two axes.
  for (const auto& [x, y, z] : Triples{{"1.625", "1", "3"},
                                       {"0.375", "1", "3"},
                                       {"1", "1.625", "3"},
                                       {"1", "0.375", "3"},
                                       {"1", "1", "3.625"},
                                       {"1", "1", "2.375"},
                                       {"1.375", "1.5", "3"}}) {
    EXPECT_EQ(answer_to_two(a, b(x, y, z)), "taken") << x << " " << y << " " << z;
  }
  for (const auto& [x, y, z] :
       Triples{{"1.5", "1", "3"}, {"1", "0.5", "3"}, {"1", "1", "2.5"}, {"1.3", "1.4", "3"}}) {
    EXPECT_EQ(answer_to_two(a, b(x, y, z)),
              "f:7: robots[1].start: must be at least planner.separation_m (0.6 m) from the start "
              "of A, but is 0.5");
  }
  // The message names the first of three robots that is too near, with the radii of that pair.
  EXPECT_EQ(answer_to_two(", start: {x_m: 1, y_m: 1}, limits: {radius_m: 0.125}",
                          ", start: {x_m: 4, y_m: 1}, limits: {radius_m: 0.375}",
                          "planner: {separation_m: 0.375}\n"),
            "f:7: robots[1].limits: planner.separation_m must be at least the sum of the radii of "
            "A and B (0.5 m), but is 0.375");
  EXPECT_EQ(answer_to_two(", start: {x_m: 1, y_m: 1}", ", start: {x_m: 4, y_m: 1}",
                          "planner: {separation_m: 0.375}\n"),
            "f:7: robots[1]: limits: planner.separation_m must be at least the sum of the radii of "
            "A and B (0.5 m), but is 0.375")
      << "default values of the robot";
}

TEST(ScenarioRules, WholeRobotsStayBelowTheCeiling) {
  const auto at = [](const std::string& height) {
    return answer_to_team("  - {name: A, start: {x_m: 1, y_m: 1}, height_m: " + height +
                          ", limits: {radius_m: 0.5}}\n");
  };
  EXPECT_EQ(at("9.5"), "taken");
  EXPECT_EQ(at("9.75"),
            "f:6: robots[0].height_m: must be at most world.ceiling_m (10) minus the robot's "
            "radius_m (0.5), otherwise it touches the ceiling; is 9.75");
  EXPECT_EQ(at("10.5"), "f:6: robots[0].height_m: must be below world.ceiling_m (10), but is 10.5");
}

TEST(ScenarioRules, ObstaclesOverlapTheWorld) {
  const auto box = [](const std::string& min, const std::string& max) {
    return answer_to(
        "name: x\nworld:\n  bounds: {min_m: [-9, -5], max_m: [9, 5]}\n  obstacles:\n"
        "    - {footprint: {min_m: " +
        min + ", max_m: " + max + "}}\n" + kTargets + kDefaults +
        "robots: [{name: A, start: {x_m: 0, y_m: 0}}]\n");
  };
  EXPECT_EQ(box("[-11, 4]", "[-8, 4.5]"), "taken");
  EXPECT_EQ(box("[8, 4]", "[11, 4.5]"), "taken");
  EXPECT_EQ(box("[2, 4]", "[3, 6]"), "taken");
  EXPECT_EQ(box("[2, -6]", "[3, -4]"), "taken");
  for (const auto& [min, max] : Pairs{{"[-11, 2]", "[-9, 3]"},
                                      {"[9, 2]", "[11, 3]"},
                                      {"[2, 5]", "[3, 7]"},
                                      {"[2, -7]", "[3, -5]"}}) {
    EXPECT_EQ(box(min, max),
              "f:5: world.obstacles[0].footprint: must overlap world.bounds; "
              "is entirely outside");
  }
  EXPECT_EQ(box("[2, 3]", "[4, 3]"),
            "f:5: world.obstacles[0].footprint.max_m: must be above min_m ([2, 3]) in x and in y, "
            "but is [4, 3]");
  EXPECT_EQ(box("[4, 2]", "[3, 5]"),
            "f:5: world.obstacles[0].footprint.max_m: must be above min_m ([4, 2]) in x and in y, "
            "but is [3, 5]");
}

TEST(ScenarioRules, AutopilotUrlsAreSupportedByTheDriver) {
  const auto with = [](const std::string& autopilot) {
    return answer_to_robot(", autopilot: {" + autopilot + "}");
  };
  for (const std::string url : {"udp://:14540", "udpout://h:1", "serial:/dev/ttyS0"}) {
    EXPECT_EQ(with("dialect: px4, url: \"" + url + "\""), "taken");
  }
  EXPECT_EQ(with("dialect: px4, url: \"tcp://h:1\""),
            "f:6: robots[0].autopilot.url: must begin with udp://, udpout:// or serial:, is "
            "'tcp://h:1'");
  EXPECT_EQ(with("dialect: px4"), "f:6: robots[0].autopilot: missing required key url");
  EXPECT_EQ(with("url: \"udp://:1\""), "f:6: robots[0].autopilot: missing required key dialect");
  EXPECT_EQ(with("dialect: px4, url: \"udp://:1\", battery: {empty_v: 3.5, full_v: 3.5, cells: 2}"),
            "f:6: robots[0].autopilot.battery.full_v: must be above empty_v (3.5), but is 3.5 "
            "volts per cell");
  EXPECT_EQ(with("dialect: px4, url: \"udp://:1\", battery: {full_v: 4}"),
            "f:6: robots[0].autopilot.battery: missing required key cells");
}

TEST(ScenarioRules, RealAutopilotsHaveAnIdAndAKey) {
  const std::string url = "dialect: px4, url: \"udp://:1\"";
  const auto real = [&](const std::string& more, const std::string& device = "real") {
    return answer_to_robot(", device: " + device + ", autopilot: {" + url + more + "}");
  };
  EXPECT_EQ(real(", system_id: 1, key_file: k"), "taken");
  EXPECT_EQ(
      real(", key_file: k").find("f:6: robots[0].autopilot: must contain the system_id, 1 to 255"),
      0U);
  EXPECT_EQ(real(", system_id: 1").find("f:6: robots[0].autopilot: must contain the key_file"), 0U);
  EXPECT_EQ(real("", "wire"), "taken") << "not required for a simulated robot";
  EXPECT_EQ(answer_to_robot(", device: real"), "taken") << "not required without an autopilot";
}

TEST(ScenarioRules, FirmwareMatchesTheKindOfVehicle) {
  const std::string px4 = ", device: wire, autopilot: {dialect: px4, url: \"udp://:1\"}";
  const std::string crazyflie = ", device: wire, crazyflie: {url: \"udp://127.0.0.1:1\"}";
  const std::string radio = ", device: wire, crazyflie: {url: \"radio://0/80/2M/E7E7E7E701\"}";
  const std::string at = "f:6: robots[0].firmware";
  struct Row {
    std::string robot;
    std::string answer;
  };
  for (const Row& row : {
           Row{px4 + ", firmware: {kind: px4, binary: b}", "taken"},
           Row{px4 + ", firmware: {kind: crazyflie, binary: b}",
               at + ".kind: must be 'px4', the kind of the robot's vehicle, is 'crazyflie'"},
           Row{crazyflie + ", firmware: {kind: crazyflie, binary: b}", "taken"},
           Row{crazyflie + ", firmware: {binary: b, instance: 3}", "taken"},
           Row{crazyflie + ", firmware: {kind: cf2}",
               at + ".kind: must be 'crazyflie', the kind of the robot's vehicle, is 'cf2'"},
           Row{crazyflie + ", firmware: {serial: /dev/ttyACM0}",
               at + ".serial: is for boards with PX4 only: remove it"},
           Row{crazyflie + ", firmware: {parameters: p}",
               at + ".parameters: is for PX4 and ArduPilot only: the driver sets a Crazyflie's "
                    "parameters"},
           Row{radio + ", firmware: {binary: b}",
               at + ": needs a crazyflie.url of the form udp://127.0.0.1:PORT, is "
                    "'radio://0/80/2M/E7E7E7E701'"},
       }) {
    EXPECT_EQ(answer_to_robot(row.robot), row.answer) << row.robot;
  }
}

TEST(ScenarioRules, FirmwareRequiresASimulatedVehicleWithAutopilot) {
  const std::string flown = ", device: wire, autopilot: {dialect: px4, url: \"udp://:1\"}";
  EXPECT_EQ(answer_to_robot(flown + ", firmware: {binary: px4, parameters: p}"), "taken");
  EXPECT_EQ(answer_to_robot(flown + ", firmware: {serial: /dev/ttyACM0}"), "taken");
  EXPECT_EQ(answer_to_robot(flown + ", firmware: {serial: /dev/ttyACM0, binary: px4}"),
            "f:6: robots[0].firmware.serial: selects a board, which runs its own firmware: remove "
            "`binary`");
  EXPECT_EQ(answer_to_robot(", device: wire, firmware: {binary: px4}"),
            "f:6: robots[0].firmware: needs an `autopilot` or `crazyflie` section, which selects "
            "the firmware");
  EXPECT_EQ(answer_to_robot(", autopilot: {dialect: px4, url: \"udp://:1\"}, firmware: {}"),
            "f:6: robots[0].firmware: is for simulated vehicles only: set device to 'wire'");
  const Scenario scenario = parse_scenario(
      kWorld + kTargets + kDefaults + "robots:\n  - {name: A, start: {x_m: 1, y_m: 1}" + flown +
          ", firmware: {binary: b, parameters: p, instance: 0}}\n  - {name: B, start: {x_m: 4, "
          "y_m: 1}" +
          flown + ", firmware: {serial: s}}\n  - {name: C, start: {x_m: 4, y_m: 3}" + flown +
          ", firmware: {instance: 9}}\n",
      "f");
  EXPECT_EQ(scenario.robots[0].firmware->binary, "b");
  EXPECT_EQ(scenario.robots[0].firmware->parameters, "p");
  EXPECT_EQ(scenario.robots[0].firmware->instance, 0);
  EXPECT_EQ(scenario.robots[1].firmware->serial, "s");
  EXPECT_FALSE(scenario.robots[1].firmware->instance);
  EXPECT_EQ(scenario.firmware_instance(scenario.robots[0]), 0);
  EXPECT_EQ(scenario.firmware_instance(scenario.robots[1]), 1) << "its index";
  EXPECT_EQ(scenario.firmware_instance(scenario.robots[2]), 9);
}

TEST(ScenarioRules, RoversHaveUdpUrlsAndNoAutopilot) {
  EXPECT_EQ(answer_to_robot(", rover: {url: \"udp://:1\"}"), "taken");
  EXPECT_EQ(answer_to_robot(", rover: {url: \"udpout://h:1\"}"), "taken");
  EXPECT_EQ(answer_to_robot(", rover: {url: \"tcp://h:1\"}"),
            "f:6: robots[0].rover.url: must begin with udp:// or udpout://, is 'tcp://h:1'");
  EXPECT_EQ(answer_to_robot(", rover: {url: \"udp://:1\"}, autopilot: {dialect: px4, url: "
                            "\"udp://:2\"}"),
            "f:6: robots[0].rover: a robot can have only one of `autopilot`, `rover`, "
            "`crazyflie`: remove the others");
}

TEST(ScenarioRules, CrazyfliesHaveRadioOrUdpUrls) {
  EXPECT_EQ(answer_to_robot(", crazyflie: {url: \"udp://h:1\"}"), "taken");
  EXPECT_EQ(answer_to_robot(", crazyflie: {url: \"radio://0/80/2M/E7E7E7E701\", battery: none}"),
            "taken");
  EXPECT_EQ(answer_to_robot(", crazyflie: {url: \"usb://0\"}"),
            "f:6: robots[0].crazyflie.url: must begin with radio:// or udp://, is 'usb://0'");
  EXPECT_EQ(answer_to_robot(", crazyflie: {url: \"udp://h:1\", empty_v: 4, full_v: 3.5}"),
            "f:6: robots[0].crazyflie.full_v: must be above empty_v (4), but is 3.5");
}

TEST(ScenarioRules, MaximumRangeExceedsMinimumRange) {
  const auto with = [](const std::string& sensor) {
    return answer_to_robot(", sensor: {" + sensor + "}");
  };
  EXPECT_EQ(with("range_min_m: 3, range_max_m: 3.5"), "taken");
  EXPECT_EQ(with("range_min_m: 3.5, range_max_m: 3.5"),
            "f:6: robots[0].sensor.range_min_m: must be below range_max_m (3.5), but is 3.5");
  EXPECT_EQ(with("range_min_m: 4, range_max_m: 3.5"),
            "f:6: robots[0].sensor.range_min_m: must be below range_max_m (3.5), but is 4");
  EXPECT_EQ(with("kind: position, detects_ids: false, clutter_per_look: 2"), "taken");
  EXPECT_EQ(with("clutter_per_look: 1.5"),
            "f:6: robots[0].sensor.clutter_per_look: must be 0 with detects_ids: true: a false "
            "alarm cannot have the id of a target; is 1.5");
}

TEST(ScenarioRules, TeamsWithoutTargetIdsHaveASizeLimit) {
  const auto team = [](int robots, int targets, const std::string& more = "") {
    std::string text = kWorld +
                       "robot_defaults: {primitives: lab, sensor: {kind: position, "
                       "detects_ids: false}}\ntargets: {count: " +
                       std::to_string(targets) + "}\n" + more + "robots:\n";
    for (int i = 0; i < robots; ++i) {
      text += "  - {name: Q" + std::to_string(i) + ", start: {x_m: " + std::to_string(i % 17 - 8) +
              ", y_m: " + std::to_string(i / 17 * 2 - 2) + "}}\n";
    }
    return answer_to(text);
  };
  EXPECT_EQ(team(32, 100), "taken");
  EXPECT_EQ(team(33, 100), "f:5: robots: must be at most 32 with detects_ids: false, are 33");
  EXPECT_EQ(team(1, 101), "f:4: targets: must be 1 to 100 with detects_ids: false, are 101");
}

TEST(ScenarioRules, TargetsHaveValidIdsPositionsAndSpeeds) {
  const std::string base =
      kWorld + kDefaults + "robots: [{name: A, start: {x_m: 2, y_m: 2}}]\ntargets:\n";
  EXPECT_EQ(answer_to(base + "  - {id: 1}\n  - {id: 0}\n"), "taken");
  EXPECT_EQ(answer_to(base + "  - {}\n  - {id: 3}\n  - {id: 1}\n"),
            "f:7: targets[1]: id must be at most 2, the number of targets minus 1; is 3");
  EXPECT_EQ(answer_to(base + "  - {id: 0}\n  - {id: 2}\n  - {id: 2}\n"),
            "f:8: targets[2].id: must be unique; an earlier target has the id 2");
  EXPECT_EQ(answer_to(base + "  - {start: {x_m: -8.875, y_m: 1}, radius_m: 0.125}\n"), "taken");
  EXPECT_EQ(answer_to(base + "  - {start: {x_m: -8.875, y_m: 1}, radius_m: 0.25}\n"),
            "f:6: targets[0].start: must be at least 0.25 m from obstacles and walls; at (-8.875, "
            "1) m it is 0.125");
  EXPECT_EQ(answer_to(base + "  - {start: {x_m: 9.5, y_m: 1}}\n"),
            "f:6: targets[0].start: (9.5, 1) m is outside world.bounds");
  EXPECT_EQ(answer_to(base + "  - {}\ntarget_truth: {speed_min_mps: 1.5, speed_max_mps: 1}\n"),
            "f:7: target_truth.speed_min_mps: must be at most speed_max_mps (1), but is 1.5");
  // If the list is not too long, its first wrong entry is reported.
  const auto many = [&](int count) {
    std::string list = "  - {id: -1}\n";
    for (int i = 1; i < count; ++i) {
      list += "  - {}\n";
    }
    return answer_to(base + list);
  };
  EXPECT_EQ(many(10'000), "f:6: targets[0].id: must be at least 0 and at most 9999, is '-1'");
  EXPECT_EQ(many(10'001),
            "f:5: targets: must contain at least 1 and at most 10000 targets, contains 10001");
  const Scenario named =
      parse_scenario(kWorld + kDefaults + "robots: [{name: A, start: {x_m: 2, y_m: 2}}]\n" +
                         "targets: {count: 3, name_prefix: CAT, radius_m: 0.5}\n",
                     "f");
  ASSERT_EQ(named.targets.size(), 3U);
  for (int id = 0; id < 3; ++id) {
    EXPECT_EQ(named.targets[static_cast<std::size_t>(id)].name, "CAT" + std::to_string(id + 1));
    EXPECT_EQ(named.targets[static_cast<std::size_t>(id)].id, id);
    EXPECT_EQ(named.targets[static_cast<std::size_t>(id)].radius_m, 0.5);
  }
  const Scenario plain = parse_scenario(
      kWorld + kDefaults + "robots: [{name: A, start: {x_m: 2, y_m: 2}}]\n" + kTargets, "f");
  EXPECT_EQ(plain.targets[0].name, "T1");
  EXPECT_EQ(plain.targets[0].radius_m, 0.2);
}

}  // namespace
}  // namespace vantage::scenario
