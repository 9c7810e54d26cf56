#include <string>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "scenario/energy_cost.hpp"
#include "scenario/neighbourhood.hpp"
#include "scenario/node_budget.hpp"
#include "scenario/scenario.hpp"

namespace vantage::scenario {
namespace {

/// Returns two robots, each with one limit larger than the other's; all numbers differ.
Scenario team() {
  Scenario scenario;
  scenario.planner.horizon_steps = 10;
  scenario.planner.step_s = 0.25;
  scenario.planner.execute_steps = 3;
  scenario.planner.separation_m = 0.75;
  scenario.planner.tracking_tolerance_m = 0.125;
  scenario.robots.resize(2);
  scenario.robots[0].limits.speed_max_mps = 2.0;
  scenario.robots[0].limits.brake_mps2 = 0.25;
  scenario.robots[0].sensor.range_max_m = 1.0;
  scenario.robots[1].limits.speed_max_mps = 4.0;
  scenario.robots[1].limits.brake_mps2 = 8.0;
  scenario.robots[1].sensor.range_max_m = 2.0;
  return scenario;
}

// A plan of 2.5 s and two rounds of 0.75 s last 4 s. The first robot travels 8 m and brakes within
// 8 m: its reach is 16 m. The second robot travels 16 m and brakes within 1 m: its reach is 17 m.
// The result is twice 17 m, plus the required clearance between them.
TEST(LeastNeighbourhood, IsTwiceFarthestPlanReachPlusClearance) {
  Scenario scenario = team();
  EXPECT_DOUBLE_EQ(least_neighbourhood_m(scenario), 2.0 * 17.0 + 0.75 + 2.0 * 0.125);
  scenario.robots[0].limits.brake_mps2 = 0.125;  // 8 m travelled, 16 m of braking
  EXPECT_DOUBLE_EQ(least_neighbourhood_m(scenario), 2.0 * 24.0 + 0.75 + 2.0 * 0.125);
  std::swap(scenario.robots[0], scenario.robots[1]);
  EXPECT_DOUBLE_EQ(least_neighbourhood_m(scenario), 2.0 * 24.0 + 0.75 + 2.0 * 0.125);
}

TEST(LeastNeighbourhood, CoversCommunicationAndSensorRange) {
  Scenario scenario = team();
  scenario.network.communication_range_m = 40.0;
  EXPECT_EQ(least_neighbourhood_m(scenario), 40.0);
  scenario.network.communication_range_m = 3.0;
  // In 3.25 s (a plan and a round) the first robot moves at 2 m/s, the second robot at 4 m/s.
  scenario.robots[0].sensor.range_max_m = 100.0;
  scenario.robots[1].sensor.range_max_m = 90.0;
  EXPECT_DOUBLE_EQ(least_neighbourhood_m(scenario), 2.0 * 3.25 + 100.0);
  scenario.robots[1].sensor.range_max_m = 95.0;
  EXPECT_DOUBLE_EQ(least_neighbourhood_m(scenario), 4.0 * 3.25 + 95.0);
}

TEST(StepCost, SumsControlAndRegionCosts) {
  const EnergySpec energy{.price_nats = 100.0,
                          .rest_cost = 1.0,
                          .turn_cost = 2.0,
                          .move_cost = 4.0,
                          .regions = {"mud", "ice"}};
  models::World world;
  world.regions = {{"mud", {{0.0, 0.0}, {2.0, 2.0}}, 8.0},
                   {"sand", {{0.0, 0.0}, {2.0, 2.0}}, 1000.0},
                   {"ice", {{1.0, 1.0}, {3.0, 3.0}}, 16.0}};
  const Eigen::Vector2d nowhere(-1.0, -1.0);
  for (const double speed_mps : {-1.0, 0.0, 1.0}) {
    for (const double turn_radps : {-1.0, 0.0, 1.0}) {
      const double control = speed_mps != 0.0 ? 4.0 : turn_radps != 0.0 ? 2.0 : 1.0;
      const models::UnicycleControl moves{speed_mps, turn_radps};
      EXPECT_EQ(step_cost(energy, &world, moves, nowhere), control);
      EXPECT_EQ(step_cost(energy, nullptr, moves, {1.5, 1.5}), control);
      EXPECT_EQ(step_cost(energy, &world, moves, {0.5, 0.5}), control + 8.0);
      EXPECT_EQ(step_cost(energy, &world, moves, {2.5, 2.5}), control + 16.0);
      EXPECT_EQ(step_cost(energy, &world, moves, {1.5, 1.5}), control + 8.0 + 16.0);
    }
  }
}

// Compares the defaults of a scenario without these keys: robots in the air and targets on the
// ground.
TEST(ScenarioDefaults, AreAppliedToRobotsAndTargets) {
  const RobotSpec robot;
  EXPECT_EQ(robot.height_m, 1.0);
  EXPECT_EQ(robot.limits.speed_max_mps, 3.0);
  EXPECT_EQ(robot.limits.yaw_rate_max_radps, 3.0);
  EXPECT_EQ(robot.limits.brake_mps2, 2.0);
  EXPECT_EQ(robot.limits.radius_m, 0.25);
  EXPECT_EQ(robot.sensor.range_max_m, 10.0);
  EXPECT_EQ(robot.sensor.range_min_m, 0.0);
  EXPECT_DOUBLE_EQ(robot.sensor.fov_rad, 2.0 * kPi);
  EXPECT_EQ(robot.sensor.range_sigma_m, 0.15);
  EXPECT_DOUBLE_EQ(robot.sensor.bearing_sigma_rad, radians(5.0));
  EXPECT_EQ(robot.sensor.position_sigma_m, 0.1);
  EXPECT_EQ(robot.sensor.pixel_sigma, 1.0);
  EXPECT_EQ(robot.sensor.focal_length_pixels, 500.0);
  EXPECT_DOUBLE_EQ(robot.sensor.camera_tilt_rad, 0.5 * kPi);
  EXPECT_EQ(robot.sensor.depth_min_m, 0.05);
  EXPECT_FALSE(robot.sensor.variance_grows_with_range);
  EXPECT_EQ(robot.sensor.variance_floor, 0.1);
  EXPECT_EQ(robot.sensor.calibration.range_scale, 1.0);
  EXPECT_EQ(robot.sensor.calibration.range_bias_m, 0.0);
  EXPECT_EQ(robot.detection.detection_probability, 1.0);
  EXPECT_EQ(robot.detection.clutter_per_look, 0.0);
  EXPECT_TRUE(robot.detection.detects_ids);
  EXPECT_EQ(robot.device, DeviceSource::kDirect);
  const BatterySpec battery;
  EXPECT_EQ(battery.cells, 3);
  EXPECT_EQ(battery.empty_v, 3.3);
  EXPECT_EQ(battery.full_v, 4.1);
  EXPECT_EQ(RoverSpec{}.number, 1);
  EXPECT_EQ(AutopilotSpec{}.system_id, 0);
  EXPECT_EQ(TargetSpec{}.radius_m, 0.2);
  const TargetTruthSpec truth;
  EXPECT_EQ(truth.speed_min_mps, 0.2);
  EXPECT_EQ(truth.speed_max_mps, 0.6);
  EXPECT_EQ(truth.pause_max_s, 2.0);
  EXPECT_EQ(truth.acceleration_q, 0.001);
}

TEST(ScenarioDefaults, AreAppliedToWorldAndNetwork) {
  const Scenario scenario;
  EXPECT_EQ(scenario.duration_s, 300.0);
  EXPECT_EQ(scenario.seed, 1U);
  EXPECT_EQ(scenario.world.ceiling_m, 10.0);
  EXPECT_EQ(models::Obstacle{}.height_m, 10.0);
  EXPECT_EQ(models::Region{}.cost_per_step, 0.0);
  EXPECT_EQ(WindSpec{}.gust_sigma_mps, 0.1);
  EXPECT_EQ(scenario.network.communication_range_m, 0.0);
  EXPECT_EQ(scenario.network.neighbourhood_m, 0.0);
  EXPECT_EQ(scenario.network.url, "udpm://239.255.76.67:7667?ttl=0");
  EXPECT_EQ(scenario.mocap.rate_hz, 50.0);
  EXPECT_EQ(scenario.mocap.position_sigma_m, 0.0005);
  EXPECT_EQ(scenario.mocap.yaw_sigma_rad, 0.001);
  EXPECT_EQ(scenario.mocap.latency_s, 0.005);
  EXPECT_EQ(scenario.mocap.host, "127.0.0.1");
  EXPECT_EQ(scenario.mocap.port, 0);
  EXPECT_EQ(scenario.mocap.block_bytes, 256);
  EXPECT_EQ(scenario.mocap.stuck_frames, 3);
  EXPECT_EQ(scenario.mocap.gate_speed_mps, 10.0);
  EXPECT_EQ(scenario.mocap.gate_turn_radps, 20.0);
}

TEST(ScenarioDefaults, AreAppliedToEstimatorAndPlanner) {
  const Scenario scenario;
  const EstimatorSpec& estimator = scenario.estimator;
  EXPECT_EQ(estimator.target_model.position_dim, 2);
  EXPECT_EQ(estimator.prior_position_sigma_m, 1.0);
  EXPECT_EQ(estimator.prior_velocity_sigma_mps, 0.5);
  EXPECT_EQ(estimator.undiscovered_position_sigma_m, 4.0);
  EXPECT_EQ(estimator.grid_resolution_m, 0.25);
  EXPECT_EQ(estimator.grid_memory_s, 30.0);
  EXPECT_EQ(estimator.gate_sigma, 4.0);
  EXPECT_EQ(estimator.detection_probability, 0.9);
  EXPECT_TRUE(estimator.targets_stay_inside);
  EXPECT_FALSE(estimator.samples);
  const PlannerSpec& planner = scenario.planner;
  EXPECT_EQ(planner.algorithm, "arvi");
  EXPECT_EQ(planner.horizon_steps, 12);
  EXPECT_EQ(planner.step_s, 0.5);
  EXPECT_EQ(planner.execute_steps, 6);
  EXPECT_EQ(planner.team_budget_s, 0.5);
  EXPECT_EQ(planner.publish_margin_s, 0.05);
  EXPECT_EQ(planner.slots, 0);
  EXPECT_EQ(planner.node_budget, 0);
  EXPECT_EQ(planner.epsilon_initial, 1.0);
  EXPECT_EQ(planner.delta_initial_m, 1.0);
  EXPECT_EQ(planner.yaw_weight_m_per_rad, 0.3);
  EXPECT_EQ(planner.candidates_max, 200);
  EXPECT_EQ(planner.attacks_max, 0);
  EXPECT_EQ(planner.separation_m, 0.6);
  EXPECT_FALSE(planner.separation_from_above);
  EXPECT_EQ(planner.obstacle_margin_m, 0.1);
  EXPECT_EQ(planner.tracking_tolerance_m, 0.2);
  EXPECT_EQ(planner.exploration.landmark_sigma_m, 1.0);
  EXPECT_EQ(planner.exploration.landmark_spacing_m, 1.0);
  EXPECT_EQ(planner.exploration.landmarks_max, 12);
  EXPECT_FALSE(planner.exploration.until_found);
  EXPECT_EQ(planner.tour.horizon_s, 0.0);
  EXPECT_EQ(planner.tour.weight, 1.0);
  EXPECT_EQ(planner.tour.visit_s, 1.0);
  EXPECT_EQ(planner.tour.region_m, 0.0);
  EXPECT_EQ(kDefaultNodeBudget, 20'000);
  const models::MappingSpec& mapping = scenario.mapping;
  EXPECT_EQ(mapping.scanner.beams, 96);
  EXPECT_DOUBLE_EQ(mapping.scanner.field_of_view_rad, 2.0 * kPi);
  EXPECT_EQ(mapping.scanner.range_min_m, 0.0);
  EXPECT_EQ(mapping.scanner.range_max_m, 1.5);
  EXPECT_EQ(mapping.scanner.sigma_m, 0.01);
  EXPECT_EQ(mapping.planned_beams, 48);
  EXPECT_EQ(mapping.resolution_m, 0.2);
  EXPECT_EQ(mapping.look_probability, 0.95);
  EXPECT_EQ(mapping.settled_probability, 0.99);
  EXPECT_EQ(mapping.frontier_nats_per_m, 0.5);
}

}  // namespace
}  // namespace vantage::scenario
