#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "scenario/reader/overrides.hpp"
#include "scenario/reader/scenario_yaml.hpp"

// Tests every number of a scenario at both ends of its allowed range.

namespace vantage::scenario {
namespace {

constexpr const char* kBase = R"(
name: x
world: {bounds: {min_m: [-20, -20], max_m: [20, 20]}}
robot_defaults: {primitives: lab, sensor: {kind: position, range_min_m: 0.001}}
robots: [{name: A, start: {x_m: 2, y_m: 2}}]
targets: {count: 1}
)";

using Keys = std::map<std::string, std::string>;

/// Values at the ends of a key's range, which are accepted, and values beyond them, which are
/// refused; "": not tested.
struct Limit {
  std::string key;
  const char* below;
  const char* least;
  const char* most;
  const char* above;
  Keys with = {};             ///< other keys that the scenario needs
  std::string written = "@";  ///< text of the key's value, with the number for '@'
  std::string said_as = key;  ///< name of the key in the error
};

std::string answer_to(const Limit& limit, const std::string& value) {
  Overrides overrides;
  overrides.keys = limit.with;
  std::string written = limit.written;
  overrides.keys[limit.key] = written.replace(written.find('@'), 1, value);
  try {
    static_cast<void>(parse_scenario(apply_overrides(kBase, overrides), "x.yaml"));
  } catch (const StartupError& error) {
    return error.what();
  }
  return "taken";
}

void expect_limits(const std::vector<Limit>& limits) {
  for (const Limit& limit : limits) {
    for (const std::string within : {limit.least, limit.most}) {
      EXPECT_TRUE(within.empty() || answer_to(limit, within) == "taken")
          << limit.key << " " << within << ": " << answer_to(limit, within);
    }
    for (const std::string beyond : {limit.below, limit.above}) {
      const std::string answer = beyond.empty() ? "" : answer_to(limit, beyond);
      EXPECT_TRUE(beyond.empty() || answer.find(limit.said_as + ": must ") != std::string::npos)
          << limit.key << " " << beyond << ": " << answer;
    }
  }
}

TEST(ScenarioLimits, AreEnforcedForWorldAndTrial) {
  const Keys coarse{{"estimator.grid_resolution_m", "100"}};
  const std::string box = "[{footprint: {min_m: [9, 9], max_m: [10, 10]}, height_m: @}]";
  const std::string mud =
      "[{name: a, footprint: {min_m: [9, 9], max_m: [10, 10]}, cost_per_step: @}]";
  expect_limits({
      {"duration_s", "0", "1e-6", "86400", "86400.5"},
      {"world.ceiling_m", "0", "", "10000", "10001"},
      {"world.bounds.max_m", "", "", "[10000, 10000]", "[10000, 10000.5]", coarse, "@",
       "world.bounds.max_m[1]"},
      {"world.bounds.min_m", "[-10001, 0]", "[-10000, 0]", "", "", coarse, "@",
       "world.bounds.min_m[0]"},
      {"world.obstacles", "0", "0.1", "10000", "10001", {}, box, "world.obstacles[0].height_m"},
      {"world.regions", "-0.1", "0", "", "", {}, mud, "world.regions[0].cost_per_step"},
      {"wind.x_mps", "-30.1", "-30", "30", "30.1"},
      {"wind.y_mps", "-30.1", "-30", "30", "30.1"},
      {"wind.gust_sigma_mps", "-0.1", "0", "30", "30.1"},
      {"attacks",
       "-0.1",
       "0",
       "999999",
       "1000001",
       {},
       "[{from_s: @, to_s: 1e6, robots: [A]}]",
       "attacks[0].from_s"},
      {"attacks", "0", "1e-6", "1e6", "1000001", {}, "[{to_s: @, robots: [A]}]", "attacks[0].to_s"},
      {"network.communication_range_m", "-1.1", "-1", "10000", "10001"},
      {"network.neighbourhood_m", "-1", "0", "10000", "10001"},
  });
}

TEST(ScenarioLimits, AreEnforcedForRobots) {
  const std::string pose = "[{name: A, start: {x_m: 2, y_m: 2, yaw_deg: @}}]";
  const std::string turned = "[{name: A, start: {x_m: 2, y_m: 2, yaw_rad: @}}]";
  const std::string pilot = "{dialect: px4, url: \"udp://:1\", system_id: @}";
  const std::string cells = "{dialect: px4, url: \"udp://:1\", battery: {cells: @}}";
  const std::string full = "{dialect: px4, url: \"udp://:1\", battery: {cells: 3, full_v: @}}";
  const std::string empty =
      "{dialect: px4, url: \"udp://:1\", battery: {cells: 3, full_v: 5, empty_v: @}}";
  const Keys flown{{"robot_defaults.autopilot", "{dialect: px4, url: \"udp://:1\"}"},
                   {"robot_defaults.device", "wire"}};
  const std::string any = "robot_defaults.";
  expect_limits({
      {any + "height_m", "0", "0.1", "", ""},
      {any + "limits.speed_max_mps", "0", "1", "50", "50.5"},
      {any + "limits.yaw_rate_max_radps", "0", "3", "20", "20.1"},
      {any + "limits.brake_mps2", "0", "1e-6", "", ""},
      {any + "limits.radius_m", "0", "0.01", "", ""},
      {any + "energy.price_nats", "-0.1", "0", "", ""},
      {any + "energy.rest_cost", "-0.1", "0", "", ""},
      {any + "energy.turn_cost", "-0.1", "0", "", ""},
      {any + "energy.move_cost", "-0.1", "0", "", ""},
      {"robots", "-360.5", "-360", "360", "360.5", {}, pose, "robots[0].start.yaw_deg"},
      {"robots", "-6.284", "-6.283", "6.283", "6.284", {}, turned, "robots[0].start.yaw_rad"},
      {any + "autopilot", "-1", "0", "255", "256", {}, pilot, any + "autopilot.system_id"},
      {any + "autopilot", "0", "1", "14", "15", {}, cells, any + "autopilot.battery.cells"},
      {any + "autopilot", "0", "3.31", "5", "5.01", {}, full, any + "autopilot.battery.full_v"},
      {any + "autopilot",
       "0",
       "0.01",
       "4.99",
       "5.01",
       {},
       empty,
       any + "autopilot.battery.empty_v"},
      {any + "firmware.instance", "-1", "0", "99", "100", flown},
      {any + "rover",
       "0",
       "1",
       "65535",
       "65536",
       {},
       "{url: \"udp://:1\", number: @}",
       any + "rover.number"},
      {any + "primitives",
       "-0.1",
       "0",
       "3",
       "",
       {},
       "[{speed_mps: @, yaw_rate_radps: 0}]",
       any + "primitives[0].speed_mps"},
  });
}

TEST(ScenarioLimits, AreEnforcedForSensors) {
  const std::string sensor = "robot_defaults.sensor.";
  expect_limits({
      {sensor + "range_max_m", "0", "0.002", "10000", "10001"},
      {sensor + "range_min_m", "-0.1", "0", "9.9", "10"},
      {sensor + "fov_deg", "0", "1e-6", "360", "360.1"},
      {sensor + "fov_rad", "0", "1e-6", "6.2831", "6.2832"},
      {sensor + "range_sigma_m", "0", "1e-6", "", ""},
      {sensor + "bearing_sigma_deg", "0", "1e-6", "180", "180.1"},
      {sensor + "bearing_sigma_rad", "0", "1e-6", "3.1415", "3.1416"},
      {sensor + "position_sigma_m", "0", "1e-6", "", ""},
      {sensor + "pixel_sigma", "0", "1e-6", "", ""},
      {sensor + "focal_length_pixels", "0", "1e-6", "", ""},
      {sensor + "camera_tilt_deg", "-0.1", "0", "90", "90.1"},
      {sensor + "camera_tilt_rad", "-0.1", "0", "1.5707", "1.5708"},
      {sensor + "depth_min_m", "0", "1e-6", "", ""},
      {sensor + "variance_floor", "0", "1e-6", "1", "1.01"},
      {sensor + "calibration.range_scale", "0", "1e-6", "", ""},
      {sensor + "calibration.range_bias_m", "", "-1e6", "1e6", ""},
      {sensor + "detection_probability", "0", "1e-6", "1", "1.01"},
      {sensor + "clutter_per_look", "-0.1", "0", "20", "20.5", {{sensor + "detects_ids", "false"}}},
  });
}

TEST(ScenarioLimits, AreEnforcedForTargetsAndPriors) {
  const std::string estimator = "estimator.";
  expect_limits({
      {"targets.count", "0", "1", "10000", "10001"},
      {"targets.radius_m", "0", "1e-6", "10000", "10001"},
      {"targets", "0", "1e-6", "10000", "10001", {}, "[{radius_m: @}]", "targets[0].radius_m"},
      {"targets", "-1", "0", "", "10000", {}, "[{id: @}]", "targets[0].id"},
      {"target_truth.speed_min_mps", "0", "1e-6", "0.6", "0.7"},
      {"target_truth.speed_max_mps", "0", "0.2", "", ""},
      {"target_truth.pause_max_s", "-0.1", "0", "86400", "86401"},
      {"target_truth.acceleration_q", "-0.1", "0", "", ""},
      {estimator + "target_model.position_dim", "1", "2", "3", "4"},
      {estimator + "target_model.q", "-0.1", "0", "", ""},
      {estimator + "target_model.position_sigma_m",
       "",
       "",
       "[10000, 1]",
       "[10001, 1]",
       {},
       "@",
       estimator + "target_model.position_sigma_m[0]"},
      {estimator + "target_model.center_m",
       "[1, -10001]",
       "[1, -10000]",
       "[1, 10000]",
       "[1, 10001]",
       {},
       "@",
       estimator + "target_model.center_m[1]"},
      {estimator + "prior_position_sigma_m", "0", "1e-6", "", ""},
      {estimator + "prior_velocity_sigma_mps", "0", "1e-6", "", ""},
      {estimator + "undiscovered_position_sigma_m", "0", "1e-6", "", ""},
      {estimator + "grid_resolution_m", "0", "", "", ""},
      {estimator + "grid_memory_s", "-1.1", "-1", "86400", "86401"},
      {estimator + "gate_sigma", "-0.1", "0", "", ""},
      {estimator + "detection_probability", "-0.1", "0", "0.999", "1"},
  });
}

TEST(ScenarioLimits, AreEnforcedForPlans) {
  const Keys quick{{"planner.team_budget_s", "0.001"},
                   {"planner.publish_margin_s", "0"},
                   {"planner.execute_steps", "1"}};
  const Keys far{{"planner.team_budget_s", "0.001"},
                 {"planner.publish_margin_s", "0"},
                 {"planner.horizon_steps", "100"}};
  const std::string explored = "planner.exploration.";
  expect_limits({
      {"planner.horizon_steps", "0", "1", "100", "101", quick},
      {"planner.step_s", "0.009", "0.01", "60", "60.1", quick},
      {"planner.execute_steps", "0", "1", "100", "101", far},
      {"planner.team_budget_s", "0", "1e-6", "2.95", "2.951"},
      {"planner.publish_margin_s", "-0.01", "0", "2.5", ""},
      {"planner.slots", "-1", "0", "10000", "10001", {{"network.neighbourhood_m", "1000"}}},
      {"planner.node_budget", "-1", "0", "9223372036854775807", "9223372036854775808"},
      {"planner.epsilon_initial", "-0.1", "0", "", ""},
      {"planner.delta_initial_m", "-0.1", "0", "", ""},
      {"planner.yaw_weight_m_per_rad", "-0.1", "0", "", ""},
      {"planner.candidates_max", "0", "1", "10000", "10001"},
      {"planner.attacks_max", "-1", "0", "", "1001"},
      {"planner.separation_m", "0", "1e-6", "10000", "10001"},
      {"planner.obstacle_margin_m", "-0.1", "0", "17.7", "10001"},
      {"planner.tracking_tolerance_m", "0", "1e-6", "10000", "10001"},
      {explored + "landmark_sigma_m", "0", "1e-6", "", ""},
      {explored + "landmark_spacing_m", "0", "1e-6", "", ""},
      {explored + "landmarks_max", "-1", "0", "1000", "1001"},
      {"planner.tour.horizon_s", "-0.1", "0", "86400", "86401"},
      {"planner.tour.weight", "-0.1", "0", "", ""},
      {"planner.tour.visit_s", "-0.1", "0", "", ""},
      {"planner.tour.region_m", "-0.1", "0", "", ""},
  });
}

// A map of 40 m by 40 m has 223 by 223 = 49 729 cells of 0.1794 m, and 224 by 224 = 50 176 cells of
// 0.1788 m.
TEST(ScenarioLimits, AreEnforcedForMaps) {
  expect_limits({
      {"mapping.scanner.beams", "0", "1", "10000", "10001"},
      {"mapping.scanner.fov_deg", "0", "1e-6", "360", "360.1"},
      {"mapping.scanner.range_min_m", "-0.1", "0", "1.49", "1.5"},
      {"mapping.scanner.range_max_m", "0", "1e-6", "10000", "10001"},
      {"mapping.scanner.range_sigma_m", "0", "1e-6", "", ""},
      {"mapping.planned_beams", "0", "1", "10000", "10001"},
      {"mapping.look_probability", "0.5", "0.51", "0.999", "1"},
      {"mapping.settled_probability", "0.5", "0.51", "0.999", "1"},
      {"mapping.frontier_nats_per_m", "-0.1", "0", "", ""},
      {"mapping.resolution_m", "0", "0.1794", "100", ""},
  });
  for (const char* key : {"mapping.resolution_m", "estimator.grid_resolution_m"}) {
    const bool is_map = std::string(key) == "mapping.resolution_m";
    const Limit cells{key, "", "", "", ""};
    // 707 by 707 cells of an estimator's grid fit into a belief: fewer than half a million.
    EXPECT_EQ(answer_to(cells, is_map ? "0.1794" : "0.0566"), "taken");
    EXPECT_NE(answer_to(cells, is_map ? "0.1788" : "0.0565").find("must divide world.bounds"),
              std::string::npos)
        << key;
  }
}

TEST(ScenarioLimits, AreEnforcedForMotionCapture) {
  expect_limits({
      {"mocap.rate_hz", "0", "1e-6", "1000", "1000.5"},
      {"mocap.position_sigma_m", "-0.1", "0", "", ""},
      {"mocap.yaw_sigma_deg", "-0.1", "0", "180", "180.1"},
      {"mocap.latency_s", "-0.1", "0", "1", "1.01"},
      {"mocap.port", "0", "1", "65535", "65536"},
      {"mocap.block_bytes", "255", "256", "1024", "1025"},
      {"mocap.block_bytes", "257", "512", "", "1023"},
      {"mocap.stuck_frames", "-1", "0", "1000", "1001"},
      {"mocap.gate_speed_mps", "-0.1", "0", "", ""},
      {"mocap.gate_turn_radps", "-0.1", "0", "", ""},
  });
}

}  // namespace
}  // namespace vantage::scenario
