#include "scenario/reader/scenario_yaml.hpp"

#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "core/check.hpp"
#include "models/motion/unicycle.hpp"
#include "models/world/world.hpp"

namespace vantage::scenario {
namespace {

std::string config(const std::string& name) {
  return std::string(VANTAGE_SOURCE_DIR) + "/config/" + name;
}

constexpr const char* kSmallest = R"(
name: smallest
world: {bounds: {min_m: [0, 0], max_m: [10, 10]}}
robots:
  - {name: A, start: {x_m: 2, y_m: 3}, primitives: standard,
     sensor: {kind: range}}
targets: {count: 1}
)";

std::string smallest_with(const std::string& more) { return kSmallest + more; }

TEST(LoadScenario, ReadsTheHardwareExperimentOfTheLab) {
  const Scenario lab = load_scenario(config("lab.yaml"));
  EXPECT_EQ(lab.name, "lab");
  EXPECT_EQ(lab.duration_s, 300.0);
  EXPECT_EQ(lab.seed, 1U);
  EXPECT_EQ(lab.world.bounds.max_m - lab.world.bounds.min_m, Eigen::Vector2d(8.0, 4.0));
  EXPECT_EQ(lab.world.ceiling_m, 3.0);
  EXPECT_EQ(lab.world.obstacles.size(), 2U);
  ASSERT_EQ(lab.robots.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const RobotSpec& robot = lab.robots[i];
    EXPECT_EQ(robot.name, "Q" + std::to_string(i + 1));
    EXPECT_EQ(robot.height_m, 1.0 + 0.5 * static_cast<double>(i));
    EXPECT_EQ(robot.primitives, models::lab_primitives());
    EXPECT_EQ(robot.limits.radius_m, 0.25);
    EXPECT_EQ(robot.limits.speed_max_mps, 1.0);
    EXPECT_EQ(robot.sensor.kind, models::SensorKind::kRangeBearing);
    EXPECT_EQ(robot.sensor.range_max_m, 1.0);
    EXPECT_DOUBLE_EQ(robot.sensor.fov_rad, 2.0 * kPi);
    EXPECT_EQ(robot.sensor.range_sigma_m, 0.3);
    EXPECT_DOUBLE_EQ(robot.sensor.bearing_sigma_rad, kPi / 36.0);
    EXPECT_DOUBLE_EQ(robot.sensor.camera_tilt_rad, kPi / 2.0);
    EXPECT_FALSE(robot.sensor.variance_grows_with_range);
    EXPECT_EQ(robot.device, DeviceSource::kDirect);
  }
  EXPECT_EQ(lab.robots[2].start, (Pose2{3.0, 0.0, kPi}));
  ASSERT_EQ(lab.targets.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(lab.targets[i].name, "R" + std::to_string(i + 1));
    EXPECT_EQ(lab.targets[i].id, static_cast<int>(i));
    EXPECT_EQ(lab.targets[i].radius_m, 0.2);
    EXPECT_FALSE(lab.targets[i].start.has_value());
  }
  EXPECT_EQ(lab.target_truth.motion, scenario::TargetMotion::kRandomWaypoint);
  EXPECT_EQ(lab.target_truth.speed_max_mps, 1.4);
  EXPECT_EQ(lab.estimator.target_model.kind, models::TargetKind::kDampedOscillator);
  EXPECT_EQ(lab.estimator.target_model.oscillator.damping_per_s, Eigen::Vector2d(0.24, 0.41));
  EXPECT_FALSE(lab.estimator.targets_stay_inside);
  EXPECT_EQ(lab.planner.algorithm, "arvi");
  EXPECT_EQ(lab.planner.horizon_steps, 12);
  EXPECT_EQ(lab.planner.step_s, 0.5);
  EXPECT_EQ(lab.planner.execute_steps, 2);
  EXPECT_EQ(lab.planner.team_budget_s, 0.5);
  EXPECT_EQ(lab.planner.separation_m, 0.6);
  EXPECT_EQ(lab.network.communication_range_m, 3.0);
  EXPECT_EQ(lab.network.url, "udpm://239.255.76.67:7667?ttl=0");
  EXPECT_EQ(lab.mocap.rate_hz, 50.0);
}

TEST(LoadScenario, ReadsTheSimulationOfTheField) {
  const Scenario field = load_scenario(config("field.yaml"));
  EXPECT_EQ(field.duration_s, 500.0);
  EXPECT_EQ(field.world.bounds.max_m - field.world.bounds.min_m, Eigen::Vector2d(64.0, 64.0));
  EXPECT_TRUE(field.world.obstacles.empty());
  ASSERT_EQ(field.robots.size(), 4U);
  for (const scenario::RobotSpec& robot : field.robots) {
    EXPECT_EQ(robot.primitives, models::standard_primitives());
    EXPECT_EQ(robot.sensor.range_max_m, 10.0);
    EXPECT_DOUBLE_EQ(robot.sensor.fov_rad, radians(94.0));
    EXPECT_EQ(robot.sensor.range_sigma_m, 0.15);
    EXPECT_DOUBLE_EQ(robot.sensor.bearing_sigma_rad, radians(5.0));
  }
  EXPECT_EQ(field.targets.size(), 9U);
  EXPECT_EQ(field.targets.back().name, "T9");
  EXPECT_EQ(field.target_truth.motion, scenario::TargetMotion::kDoubleIntegrator);
  EXPECT_EQ(field.target_truth.acceleration_q, 0.001);
  EXPECT_EQ(field.estimator.target_model.kind, models::TargetKind::kDoubleIntegrator);
  EXPECT_EQ(field.estimator.target_model.q, 0.001);
  EXPECT_EQ(field.estimator.grid_resolution_m, 1.0);
  EXPECT_EQ(field.planner.execute_steps, 6);
  EXPECT_EQ(field.planner.exploration.landmark_spacing_m, 6.0);
  EXPECT_EQ(field.planner.exploration.landmark_sigma_m, 2.0);
  EXPECT_EQ(field.network.communication_range_m, 30.0);
}

TEST(ParseScenario, ReadsADampedOscillator) {
  const auto model = [](const std::string& keys) {
    return parse_scenario(
               smallest_with("estimator: {target_model: {kind: damped_oscillator" + keys + "}}"),
               "oscillator")
        .estimator.target_model;
  };
  const models::TargetModel stated = model(
      ", center_m: [1, 2], position_sigma_m: [3, 4], velocity_sigma_mps: [0.5, 0.6], "
      "damping_per_s: [0.7, 0.8]");
  EXPECT_EQ(stated.kind, models::TargetKind::kDampedOscillator);
  EXPECT_EQ(stated.oscillator.center_m, Eigen::Vector2d(1.0, 2.0));
  EXPECT_EQ(stated.oscillator.position_sigma_m, Eigen::Vector2d(3.0, 4.0));
  EXPECT_EQ(stated.oscillator.velocity_sigma_mps, Eigen::Vector2d(0.5, 0.6));
  EXPECT_EQ(stated.oscillator.damping_per_s, Eigen::Vector2d(0.7, 0.8));
  const models::Rectangle bounds = parse_scenario(smallest_with(""), "bounds").world.bounds;
  const models::DampedOscillator uniform = model("").oscillator;
  EXPECT_EQ(uniform.center_m, 0.5 * (bounds.min_m + bounds.max_m));
  EXPECT_EQ(uniform.position_sigma_m, (bounds.max_m - bounds.min_m) / std::sqrt(12.0));
}

TEST(LoadScenario, KeepsTheSourceText) {
  std::ifstream file(config("lab.yaml"), std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  EXPECT_EQ(load_scenario(config("lab.yaml")).source_text, text);
}

TEST(ParseScenario, KeepsDefaultsOfAbsentKeys) {
  const Scenario smallest = parse_scenario(kSmallest, "smallest");
  const Scenario defaults;
  const scenario::RobotSpec robot;
  EXPECT_EQ(smallest.duration_s, defaults.duration_s);
  EXPECT_EQ(smallest.seed, defaults.seed);
  EXPECT_EQ(smallest.world.ceiling_m, defaults.world.ceiling_m);
  EXPECT_EQ(smallest.planner.execute_steps, defaults.planner.execute_steps);
  EXPECT_EQ(smallest.estimator.prior_position_sigma_m, defaults.estimator.prior_position_sigma_m);
  EXPECT_EQ(smallest.network.url, defaults.network.url);
  EXPECT_EQ(smallest.mocap.yaw_sigma_rad, defaults.mocap.yaw_sigma_rad);
  EXPECT_EQ(smallest.robots[0].height_m, robot.height_m);
  EXPECT_EQ(smallest.robots[0].sensor.range_max_m, robot.sensor.range_max_m);
  EXPECT_EQ(smallest.robots[0].limits.brake_mps2, robot.limits.brake_mps2);
  EXPECT_EQ(smallest.robots[0].start, (Pose2{2.0, 3.0, 0.0}));
}

TEST(ParseScenario, ReadsTheMocapServersAddress) {
  const std::string text = std::string(kSmallest) + R"(
mocap:
  device: real
  protocol: object_stream
  host: vicon.lab
  port: 51002
  mode: prefetch
  up_axis: y
  block_bytes: 1024
  stuck_frames: 0
  gate_speed_mps: 0
  gate_turn_radps: 7.5
)";
  const MocapSpec mocap = parse_scenario(text, "mocap").mocap;
  EXPECT_EQ(mocap.device, DeviceSource::kReal);
  EXPECT_EQ(mocap.protocol, MocapProtocol::kObjectStream);
  EXPECT_EQ(mocap.host, "vicon.lab");
  EXPECT_EQ(mocap.actual_port(), 51002);
  EXPECT_EQ(mocap.mode, StreamMode::kPreFetch);
  EXPECT_EQ(mocap.up_axis, UpAxis::kY);
  EXPECT_EQ(mocap.block_bytes, 1024);
  EXPECT_EQ(mocap.stuck_frames, 0);
  EXPECT_EQ(mocap.gate_speed_mps, 0.0);
  EXPECT_EQ(mocap.gate_turn_radps, 7.5);
  EXPECT_EQ(parse_scenario(std::string(kSmallest) + "\nmocap: {protocol: vrpn}\n", "vrpn")
                .mocap.actual_port(),
            3883)
      << "default port of the protocol";
}

TEST(ParseScenario, ReadsTheMocapServersUrl) {
  const auto mocap_of = [](const std::string& url) {
    return parse_scenario(std::string(kSmallest) + "\nmocap: " + url + "\n", "url").mocap;
  };
  const MocapSpec natnet = mocap_of("natnet://192.168.1.20");
  EXPECT_EQ(natnet.device, DeviceSource::kReal);
  EXPECT_EQ(natnet.protocol, MocapProtocol::kNatNet);
  EXPECT_EQ(natnet.host, "192.168.1.20");
  EXPECT_EQ(natnet.actual_port(), 1510);
  const MocapSpec qtm = mocap_of("qtm://qtm.lab:22300");
  EXPECT_EQ(qtm.protocol, MocapProtocol::kQtm);
  EXPECT_EQ(qtm.host, "qtm.lab");
  EXPECT_EQ(qtm.actual_port(), 22300);
}

TEST(ParseScenario, AppliesRobotDefaultsKeyByKey) {
  const Scenario scenario = parse_scenario(R"(
name: layers
world: {bounds: {min_m: [0, 0], max_m: [10, 10]}}
robot_defaults:
  primitives: lab
  height_m: 2
  device: wire
  limits: {radius_m: 0.3, brake_mps2: 1.5}
  sensor: {kind: range, range_max_m: 4, fov_deg: 90, calibration: {range_bias_m: 0.1}}
robots:
  - name: A
    start: {x_m: 2, y_m: 2}
    limits: {brake_mps2: 3}
    sensor: {fov_rad: 1, range_sigma_m: 0.7, calibration: {range_scale: 1.02}}
  - {name: B, start: {x_m: 8, y_m: 8}, height_m: 4, device: real,
     primitives: [{speed_mps: 0.5, yaw_rate_radps: -1}, {speed_mps: 0, yaw_rate_radps: 2}]}
targets: {count: 1}
)",
                                           "layers");
  const RobotSpec& a = scenario.robots[0];
  EXPECT_EQ(a.height_m, 2.0);
  EXPECT_EQ(a.device, DeviceSource::kWire);
  EXPECT_EQ(a.limits.radius_m, 0.3);
  EXPECT_EQ(a.limits.brake_mps2, 3.0);
  EXPECT_EQ(a.sensor.fov_rad, 1.0);  // its own value, in another unit than the default
  EXPECT_EQ(a.sensor.range_max_m, 4.0);
  EXPECT_EQ(a.sensor.range_sigma_m, 0.7);
  EXPECT_EQ(a.sensor.calibration.range_scale, 1.02);
  EXPECT_EQ(a.sensor.calibration.range_bias_m, 0.1);
  const RobotSpec& b = scenario.robots[1];
  EXPECT_EQ(b.height_m, 4.0);
  EXPECT_EQ(b.device, DeviceSource::kReal);
  EXPECT_EQ(b.limits.brake_mps2, 1.5);
  EXPECT_DOUBLE_EQ(b.sensor.fov_rad, kPi / 2.0);
  EXPECT_EQ(b.primitives, (std::vector<models::UnicycleControl>{{0.5, -1.0}, {0.0, 2.0}}));
}

TEST(ParseScenario, ReadsAutopilots) {
  const Scenario scenario = parse_scenario(R"(
name: flown
world: {bounds: {min_m: [0, 0], max_m: [10, 10]}}
robot_defaults:
  primitives: lab
  sensor: {kind: range}
robots:
  - {name: A, start: {x_m: 2, y_m: 2}, device: real,
     autopilot: {dialect: ardupilot, url: "serial:/dev/ttyACM0:921600", system_id: 7, key_file: k,
                 parameters: warn, battery: {cells: 4, empty_v: 3.4, full_v: 4.1}}}
  - {name: B, start: {x_m: 8, y_m: 8}, autopilot: {dialect: px4, url: "udp://:14540"}}
  - {name: C, start: {x_m: 8, y_m: 2}}
targets: {count: 1}
)",
                                           "flown");
  const auto& a = scenario.robots[0].autopilot;
  ASSERT_TRUE(a.has_value());
  EXPECT_EQ(a->dialect, models::AutopilotDialect::kArdupilot);
  EXPECT_EQ(a->url, "serial:/dev/ttyACM0:921600");
  EXPECT_EQ(a->system_id, 7);
  EXPECT_EQ(a->key_file, "k");
  EXPECT_EQ(a->parameters, ParameterPolicy::kWarn);
  ASSERT_TRUE(a->battery.has_value());
  EXPECT_EQ(a->battery->cells, 4);
  EXPECT_EQ(a->battery->empty_v, 3.4);
  EXPECT_EQ(a->battery->full_v, 4.1);
  const auto& b = scenario.robots[1].autopilot;
  ASSERT_TRUE(b.has_value());
  EXPECT_EQ(b->dialect, models::AutopilotDialect::kPx4);
  EXPECT_EQ(b->system_id, 0);
  EXPECT_EQ(b->key_file, "");
  EXPECT_EQ(b->parameters, ParameterPolicy::kVerify);
  EXPECT_FALSE(b->battery.has_value());
  EXPECT_FALSE(scenario.robots[2].autopilot.has_value());
}

TEST(ParseScenario, ReadsRoversAndRefusesAnAutopilot) {
  const std::string text = R"(
name: driven
world: {bounds: {min_m: [0, 0], max_m: [10, 10]}}
robots: [{name: A, start: {x_m: 2, y_m: 3}, primitives: lab, sensor: {kind: position},
          device: real, rover: {url: "udpout://10.0.0.7:7700", number: 7}}]
targets: {count: 1}
)";
  const Scenario scenario = parse_scenario(text, "driven");
  ASSERT_TRUE(scenario.robots[0].rover.has_value());
  EXPECT_EQ(scenario.robots[0].rover->url, "udpout://10.0.0.7:7700");
  EXPECT_EQ(scenario.robots[0].rover->number, 7);
  EXPECT_FALSE(scenario.robots[0].autopilot.has_value());
  std::string both = text;
  both.replace(both.find("device: real"), 12, "autopilot: {dialect: px4, url: \"udp://:1\"}");
  EXPECT_THROW(parse_scenario(both, "both"), StartupError);
}

constexpr const char* kTwoRobots = R"(
name: two
world: {bounds: {min_m: [0, 0], max_m: [10, 10]}}
robot_defaults: {primitives: lab, sensor: {kind: range}}
robots:
  - {name: A, start: {x_m: 2, y_m: 2}}
  - {name: B, start: {x_m: 8, y_m: 8}}
targets: {count: 1}
)";

TEST(ParseScenario, ReadsHosts) {
  const Scenario scenario = parse_scenario(std::string(kTwoRobots) + R"(
hosts:
  - {name: LAB, runs: [sim, logger, B]}
  - {name: AIR1, runs: [A]}
)",
                                           "two");
  ASSERT_EQ(scenario.hosts.size(), 2U);
  EXPECT_EQ(scenario.hosts[0].name, "LAB");
  EXPECT_EQ(scenario.hosts[0].runs, (std::vector<std::string>{"sim", "logger", "B"}));
  EXPECT_EQ(scenario.hosts[1].runs, std::vector<std::string>{"A"});
  EXPECT_TRUE(scenario.runs_on("LAB", kMocapPart)) << "not assigned: runs on the first host";
}

TEST(ParseScenario, ReadsAttacksAndTheirExpectedNumber) {
  const std::string text = std::string(kTwoRobots) + R"(
planner: {attacks_max: 1}
attacks:
  - {from_s: 10, to_s: 20.5, robots: [B]}
  - {to_s: 5, robots: [A, B]}
)";
  const Scenario scenario = parse_scenario(text, "jammed");
  EXPECT_EQ(scenario.planner.attacks_max, 1);
  ASSERT_EQ(scenario.attacks.size(), 2U);
  EXPECT_EQ(scenario.attacks[0].from_s, 10.0);
  EXPECT_EQ(scenario.attacks[0].to_s, 20.5);
  EXPECT_EQ(scenario.attacks[0].robots, std::vector<std::string>{"B"});
  EXPECT_EQ(scenario.attacks[1].from_s, 0.0);
  const auto refused = [&](const std::string& what, const std::string& by) {
    std::string changed = text;
    changed.replace(changed.find(what), what.size(), by);
    EXPECT_THROW(parse_scenario(changed, "jammed"), StartupError) << by;
  };
  refused("attacks_max: 1", "attacks_max: 2");                       // no robot would be left
  refused("attacks_max: 1", "attacks_max: 1, algorithm: external");  // sends no proposals
  refused("to_s: 20.5", "to_s: 10");                                 // empty time span
  refused("robots: [B]", "robots: [C]");                             // unknown robot
  refused("to_s: 5, robots", "robots");                              // end missing
}

TEST(ParseScenario, DistinguishesZeroWindFromNone) {
  const std::string text = R"(name: windy
world: {bounds: {min_m: [0, 0], max_m: [10, 10]}}
robots: [{name: A, start: {x_m: 2, y_m: 5}, primitives: lab, sensor: {kind: position}}]
targets: {count: 1}
)";
  EXPECT_FALSE(parse_scenario(text, "windy").wind.has_value());
  const auto wind = parse_scenario(text + "wind: {x_mps: 1.5, y_mps: -1}\n", "windy").wind;
  ASSERT_TRUE(wind.has_value());
  EXPECT_EQ(wind->x_mps, 1.5);
  EXPECT_EQ(wind->y_mps, -1.0);
  EXPECT_EQ(wind->gust_sigma_mps, 0.1);
  EXPECT_THROW((void)parse_scenario(text + "wind: {x_mps: 31}\n", "windy"), StartupError);
}

TEST(ParseScenario, ReadsEnergyCostAndTeamAlgorithm) {
  const std::string text = R"(name: energy
world:
  bounds: {min_m: [0, 0], max_m: [10, 10]}
  regions:
    - {name: mud, footprint: {min_m: [1, 1], max_m: [2, 2]}, cost_per_step: 3}
    - {name: wind, footprint: {min_m: [3, 1], max_m: [4, 2]}, cost_per_step: 1.5}
robot_defaults:
  primitives: lab
  sensor: {kind: position}
  energy: {price_nats: 0.5, turn_cost: 1, move_cost: 2, regions: [mud]}
robots:
  - {name: A, start: {x_m: 2, y_m: 5}}
  - {name: B, start: {x_m: 8, y_m: 8}, energy: {rest_cost: 2, move_cost: 4, regions: [wind, mud]}}
targets: {count: 1}
planner: {team_algorithm: local_search, candidates_max: 50, algorithm: rvi}
)";
  const Scenario scenario = parse_scenario(text, "energy");
  EXPECT_EQ(scenario.planner.team_algorithm, TeamAlgorithm::kLocalSearch);
  EXPECT_EQ(scenario.planner.candidates_max, 50);
  const EnergySpec& a = scenario.robots[0].energy;
  EXPECT_EQ(a.price_nats, 0.5);
  EXPECT_EQ(a.rest_cost, 0.0);
  EXPECT_EQ(a.turn_cost, 1.0);
  EXPECT_EQ(a.move_cost, 2.0);
  EXPECT_EQ(a.regions, std::vector<std::string>{"mud"});
  const EnergySpec& b = scenario.robots[1].energy;
  EXPECT_EQ(b.price_nats, 0.5);
  EXPECT_EQ(b.rest_cost, 2.0);
  EXPECT_EQ(b.turn_cost, 1.0);
  EXPECT_EQ(b.move_cost, 4.0);
  EXPECT_EQ(b.regions, (std::vector<std::string>{"wind", "mud"}));
  const auto refused = [&](const std::string& what, const std::string& by) {
    std::string changed = text;
    changed.replace(changed.find(what), what.size(), by);
    EXPECT_THROW(parse_scenario(changed, "energy"), StartupError) << by;
  };
  refused("regions: [mud]", "regions: [sand]");
  refused("price_nats: 0.5", "price_nats: -0.5");
  refused("move_cost: 2", "move_cost: -1");
  refused("candidates_max: 50", "candidates_max: 0");
  refused("algorithm: rvi", "algorithm: beam");
  refused("algorithm: rvi", "attacks_max: 1");
  refused("local_search", "global_search");
}

TEST(ParseScenario, ReadsTargetsFromAList) {
  const std::string text = R"(
name: listed
world: {bounds: {min_m: [0, 0], max_m: [10, 10]}}
robots: [{name: A, start: {x_m: 2, y_m: 3}, primitives: lab, sensor: {kind: position}}]
targets:
  - {name: CAT, id: 1, start: {x_m: 5, y_m: 6, yaw_deg: 270}, radius_m: 0.1}
  - {id: 0}
)";
  const Scenario scenario = parse_scenario(text, "listed");
  ASSERT_EQ(scenario.targets.size(), 2U);
  EXPECT_EQ(scenario.targets[0].name, "CAT");
  EXPECT_EQ(scenario.targets[0].id, 1);
  EXPECT_EQ(scenario.targets[0].radius_m, 0.1);
  ASSERT_TRUE(scenario.targets[0].start.has_value());
  EXPECT_DOUBLE_EQ(scenario.targets[0].start->yaw_rad, -kPi / 2.0);
  EXPECT_EQ(scenario.targets[1].name, "T2");
  EXPECT_FALSE(scenario.targets[1].start.has_value());
}

TEST(ParseScenario, ReadsEveryEnumerator) {
  const auto algorithm = [](const std::string& word) {
    return parse_scenario(smallest_with("planner: {algorithm: " + word + "}"), "words")
        .planner.algorithm;
  };
  EXPECT_EQ(algorithm("arvi"), "arvi");
  EXPECT_EQ(algorithm("beam"), "beam");
  EXPECT_EQ(algorithm("rvi"), "rvi");
  EXPECT_EQ(algorithm("greedy"), "greedy");
  EXPECT_EQ(algorithm("random_walk"), "random_walk");
  EXPECT_EQ(algorithm("lawn_mower"), "lawn_mower");
  const auto model = [](const std::string& word) {
    return parse_scenario(smallest_with("estimator: {target_model: {kind: " + word + "}}"), "words")
        .estimator.target_model.kind;
  };
  EXPECT_EQ(model("static"), models::TargetKind::kStatic);
  EXPECT_EQ(model("random_walk"), models::TargetKind::kRandomWalk);
  EXPECT_EQ(model("double_integrator"), models::TargetKind::kDoubleIntegrator);
  EXPECT_EQ(model("growing_uncertainty"), models::TargetKind::kGrowingUncertainty);
  EXPECT_EQ(model("damped_oscillator"), models::TargetKind::kDampedOscillator);
  const auto motion = [](const std::string& word) {
    return parse_scenario(smallest_with("target_truth: {motion: " + word + "}"), "words")
        .target_truth.motion;
  };
  EXPECT_EQ(motion("random_waypoint"), TargetMotion::kRandomWaypoint);
  EXPECT_EQ(motion("double_integrator"), TargetMotion::kDoubleIntegrator);
  EXPECT_EQ(motion("still"), TargetMotion::kStill);
}

TEST(ParseScenario, ReadsUsualNumberFormats) {
  const Scenario scenario =
      parse_scenario(smallest_with("duration_s: +1.5e2\nseed: 18446744073709551615\n"
                                   "planner: {node_budget: 9000000000}\n"
                                   "target_truth: {acceleration_q: .5}\n"),
                     "numbers");
  EXPECT_EQ(scenario.duration_s, 150.0);
  EXPECT_EQ(scenario.seed, 18446744073709551615ULL);
  EXPECT_EQ(scenario.planner.node_budget, 9'000'000'000);
  EXPECT_EQ(scenario.target_truth.acceleration_q, 0.5);
}

TEST(ScenarioSecurity, IsOffByDefaultAndTrialModeFollowsTheDevices) {
  const Scenario plain = parse_scenario(kSmallest, "smallest");
  EXPECT_EQ(plain.security.mode, SecurityMode::kOff);
  EXPECT_EQ(trial_mode(plain), TrialMode::kSimulation);
  const std::string signed_yaml =
      std::string(kSmallest) + "\nsecurity: {mode: require, keys: lab-keys}\n";
  Scenario scenario = parse_scenario(signed_yaml, "signed");
  EXPECT_EQ(scenario.security.mode, SecurityMode::kRequire);
  EXPECT_EQ(scenario.security.keys, "lab-keys");
  scenario.robots[0].device = DeviceSource::kWire;
  EXPECT_EQ(trial_mode(scenario), TrialMode::kWire);
  scenario.mocap.device = DeviceSource::kReal;
  EXPECT_EQ(trial_mode(scenario), TrialMode::kLive);
}

}  // namespace
}  // namespace vantage::scenario
