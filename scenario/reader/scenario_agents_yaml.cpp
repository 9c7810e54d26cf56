#include "scenario/reader/scenario_agents_yaml.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Core>
#include <fmt/format.h>

#include "models/plan/plan.hpp"
#include "models/sensor/law.hpp"
#include "scenario/reader/camera_yaml.hpp"
#include "scenario/reader/scenario_detection_yaml.hpp"
#include "scenario/reader/scenario_firmware_yaml.hpp"
#include "scenario/reader/sensor_parameters.hpp"
#include "scenario/vehicle_kinds.hpp"

namespace vantage::scenario {
namespace {
using models::SensorModel;

constexpr std::size_t kRobotsMax = 10'000;
constexpr int kTargetsMax = 10'000;
constexpr std::size_t kPrimitivesMax = 64;
constexpr double kSpeedMaxMps = 50.0;
constexpr double kYawRateMaxRadps = 20.0;

/// Refuses a name that another body has, because names are used as channel suffixes and mocap
/// subjects.
void check_name(Mapping& from, const std::string& name, const Scenario& scenario) {
  if (!is_channel_suffix(name)) {
    from.refuse("name", "must contain only A-Z and 0-9, is '" + name + "'");
  }
  const auto has_name = [&](const auto& body) { return body.name == name; };
  if (std::any_of(scenario.robots.begin(), scenario.robots.end(), has_name) ||
      std::any_of(scenario.targets.begin(), scenario.targets.end(), has_name)) {
    from.refuse("name", "must be unique; an earlier robot or target is called " + name);
  }
}

void read_pose(Mapping& from, Pose2& pose) {
  from.require("x_m");
  from.require("y_m");
  from.number("x_m", pose.x_m, from_to(-kLengthMaxM, kLengthMaxM));
  from.number("y_m", pose.y_m, from_to(-kLengthMaxM, kLengthMaxM));
  from.angle("yaw", pose.yaw_rad, from_to(-360.0, 360.0));
  pose.yaw_rad = wrap_to_pi(pose.yaw_rad);
}

/// Refuses a start if a disc of radius `clearance_needed_m` around the start touches a wall or an
/// obstacle.
void check_start(Mapping& from, const models::World& world, const Pose2& start,
                 double clearance_needed_m) {
  const Eigen::Vector2d position_m = start.position_m();
  const std::string at = fmt::format("({}, {}) m", start.x_m, start.y_m);
  if (!world.bounds.contains(position_m)) {
    from.refuse("start", at + " is outside world.bounds");
  }
  const double clearance_m = models::clearance_m(world, position_m);
  if (clearance_m < 0.0) {
    from.refuse("start", at + " is inside an obstacle");
  }
  if (clearance_m < clearance_needed_m) {
    from.refuse("start",
                fmt::format("must be at least {} m from obstacles and walls; at {} it is {:.3g}",
                            clearance_needed_m, at, clearance_m));
  }
}

void check_sensor(Mapping& from, const SensorModel& sensor) {
  if (sensor.range_min_m >= sensor.range_max_m) {
    from.refuse("range_min_m", fmt::format("must be below range_max_m ({}), but is {}",
                                           sensor.range_max_m, sensor.range_min_m));
  }
  if (sensor.kind.law().measures_bearing && sensor.range_min_m <= 0.0) {
    // The information of a bearing at range r is proportional to 1/r², so without a minimum range
    // the information has no finite bound.
    from.refuse("range_min_m", "must be above 0 for a sensor that measures bearings, is 0");
  }
  if (models::measures_velocity(sensor) && sensor.range_min_m <= 0.0) {
    // The direction to a passing target turns at a rate proportional to 1/r.
    from.refuse("range_min_m", "must be above 0 for a sensor that measures velocities, is 0");
  }
}

void read_sensor(Mapping& from, RobotSpec& robot) {
  SensorModel& sensor = robot.sensor;
  enum class SensorDevice { kVantage, kExternal, kCamera };
  SensorDevice device = SensorDevice::kVantage;
  from.choice("device", device,
              {{"vantage", SensorDevice::kVantage},
               {"external", SensorDevice::kExternal},
               {"camera", SensorDevice::kCamera}});
  if (device != SensorDevice::kVantage) {
    robot.sensor_publisher = Publisher::kExternal;
  }
  from.section("camera", [&](Mapping& camera) {
    CameraSpec checked;  // cameras_of() reads the section again
    read_camera(camera, checked);
  });
  from.choice("kind", sensor.kind, models::all_sensor_kinds());
  from.number("range_max_m", sensor.range_max_m, above_to(0.0, kLengthMaxM));
  from.number("range_min_m", sensor.range_min_m, at_least(0.0));
  from.angle("fov", sensor.fov_rad, above_to(0.0, 360.0));
  from.number("range_sigma_m", sensor.range_sigma_m, above(0.0));
  from.angle("bearing_sigma", sensor.bearing_sigma_rad, above_to(0.0, 180.0));
  from.number("position_sigma_m", sensor.position_sigma_m, above(0.0));
  from.number("pixel_sigma", sensor.pixel_sigma, above(0.0));
  from.number("focal_length_pixels", sensor.focal_length_pixels, above(0.0));
  from.angle("camera_tilt", sensor.camera_tilt_rad, from_to(0.0, 90.0));
  from.number("depth_min_m", sensor.depth_min_m, above(0.0));
  from.flag("variance_grows_with_range", sensor.variance_grows_with_range);
  from.number("variance_floor", sensor.variance_floor, above_to(0.0, 1.0));
  from.section("calibration", [&](Mapping& calibration) {
    calibration.number("range_scale", sensor.calibration.range_scale, above(0.0));
    calibration.number("range_bias_m", sensor.calibration.range_bias_m, any_number());
  });
  read_own_parameters(from, sensor);
  check_sensor(from, sensor);
  read_detection(from, sensor, robot.detection);
}

void read_limits(Mapping& from, models::VehicleLimits& limits) {
  from.number("speed_max_mps", limits.speed_max_mps, above_to(0.0, kSpeedMaxMps));
  from.number("yaw_rate_max_radps", limits.yaw_rate_max_radps, above_to(0.0, kYawRateMaxRadps));
  from.number("brake_mps2", limits.brake_mps2, above(0.0));
  from.number("radius_m", limits.radius_m, above(0.0));
}

void read_primitives(Mapping& from, const models::VehicleLimits& limits,
                     std::vector<models::UnicycleControl>& primitives) {
  const std::optional<Value> value = from.find_required("primitives");
  if (!value) {
    return;
  }
  const bool is_list = value->node->kind == Node::Kind::kList;
  if (!is_list) {
    enum class PrimitiveSet { kStandard, kLab };
    const PrimitiveSet name = value->choice<PrimitiveSet>(
        {{"standard", PrimitiveSet::kStandard}, {"lab", PrimitiveSet::kLab}});
    primitives =
        name == PrimitiveSet::kStandard ? models::standard_primitives() : models::lab_primitives();
  }
  for (const Value& item : is_list ? value->items() : std::vector<Value>()) {
    read_mapping({item}, [&](Mapping& primitive) {
      models::UnicycleControl control;
      primitive.require("speed_mps");
      primitive.require("yaw_rate_radps");
      primitive.number("speed_mps", control.speed_mps, at_least(0.0));
      primitive.number("yaw_rate_radps", control.yaw_rate_radps, any_number());
      primitives.push_back(control);
    });
  }
  if (primitives.empty() || primitives.size() > kPrimitivesMax) {
    value->refuse(fmt::format("must contain at least 1 and at most {} primitives, contains {}",
                              kPrimitivesMax, primitives.size()));
  }
  for (const models::UnicycleControl& control : primitives) {
    if (control.speed_mps > limits.speed_max_mps) {
      value->refuse(fmt::format("speed_mps must be at most limits.speed_max_mps ({}), but is {}",
                                limits.speed_max_mps, control.speed_mps));
    }
    if (std::abs(control.yaw_rate_radps) > limits.yaw_rate_max_radps) {
      value->refuse(
          fmt::format("yaw_rate_radps must be at most limits.yaw_rate_max_radps ({}) in either "
                      "direction, but is {}",
                      limits.yaw_rate_max_radps, control.yaw_rate_radps));
    }
  }
}

void read_energy(Mapping& from, const models::World& world, EnergySpec& energy) {
  from.number("price_nats", energy.price_nats, at_least(0.0));
  from.number("rest_cost", energy.rest_cost, at_least(0.0));
  from.number("turn_cost", energy.turn_cost, at_least(0.0));
  from.number("move_cost", energy.move_cost, at_least(0.0));
  if (const std::optional<Value> regions = from.find("regions")) {
    for (const Value& item : regions->items()) {
      const std::string name = item.text();
      const auto has_name = [&](const models::Region& region) { return region.name == name; };
      if (std::none_of(world.regions.begin(), world.regions.end(), has_name)) {
        item.refuse("must be the name of one of world.regions, is '" + name + "'");
      }
      energy.regions.push_back(name);
    }
  }
}

void read_battery(Mapping& from, BatterySpec& battery) {
  constexpr int kCellsMax = 14;
  constexpr double kCellMaxV = 5.0;
  from.require("cells");
  from.integer("cells", battery.cells, 1, kCellsMax);
  from.number("empty_v", battery.empty_v, above_to(0.0, kCellMaxV));
  from.number("full_v", battery.full_v, above_to(0.0, kCellMaxV));
  if (battery.full_v <= battery.empty_v) {
    from.refuse("full_v", fmt::format("must be above empty_v ({}), but is {} volts per cell",
                                      battery.empty_v, battery.full_v));
  }
}

void read_autopilot(Mapping& from, AutopilotSpec& autopilot) {
  constexpr int kSystemIdMax = 255;
  from.require("dialect");
  from.require("url");
  from.choice("dialect", autopilot.dialect,
              {{"px4", models::AutopilotDialect::kPx4},
               {"ardupilot", models::AutopilotDialect::kArdupilot}});
  from.text("url", autopilot.url);
  from.integer("system_id", autopilot.system_id, 0, kSystemIdMax);
  from.text("key_file", autopilot.key_file);
  from.choice("parameters", autopilot.parameters,
              {{"verify", ParameterPolicy::kVerify},
               {"warn", ParameterPolicy::kWarn},
               {"ignore", ParameterPolicy::kIgnore}});
  from.section("battery",
               [&](Mapping& battery) { read_battery(battery, autopilot.battery.emplace()); });
  const bool is_known = autopilot.url.empty() || autopilot.url.starts_with("udp://") ||
                        autopilot.url.starts_with("udpout://") ||
                        autopilot.url.starts_with("serial:");
  if (!is_known) {
    from.refuse("url", "must begin with udp://, udpout:// or serial:, is '" + autopilot.url + "'");
  }
}

void read_rover(Mapping& from, RoverSpec& rover) {
  constexpr int kNumberMax = 65535;
  from.require("url");
  from.text("url", rover.url);
  from.integer("number", rover.number, 1, kNumberMax);
  if (!rover.url.starts_with("udp://") && !rover.url.starts_with("udpout://")) {
    from.refuse("url", "must begin with udp:// or udpout://, is '" + rover.url + "'");
  }
}

void read_crazyflie(Mapping& from, CrazyflieSpec& crazyflie) {
  constexpr double kCellMaxV = 5.0;
  from.require("url");
  from.text("url", crazyflie.url);
  from.choice("battery", crazyflie.battery,
              {{"voltage", CrazyflieBattery::kVoltage}, {"none", CrazyflieBattery::kNone}});
  from.number("empty_v", crazyflie.empty_v, above_to(0.0, kCellMaxV));
  from.number("full_v", crazyflie.full_v, above_to(0.0, kCellMaxV));
  if (crazyflie.full_v <= crazyflie.empty_v) {
    from.refuse("full_v", fmt::format("must be above empty_v ({}), but is {}", crazyflie.empty_v,
                                      crazyflie.full_v));
  }
  if (!crazyflie.url.starts_with("udp://") && !crazyflie.url.starts_with("radio://")) {
    from.refuse("url", "must begin with radio:// or udp://, is '" + crazyflie.url + "'");
  }
}

/// Reader of the section of one kind of vehicle (scenario/vehicle_kinds).
struct VehicleReader {
  std::string_view section;
  void (*read)(Mapping& section, RobotSpec& robot);
};

constexpr VehicleReader kVehicleReaders[] = {
    {"autopilot", [](Mapping& section,
                     RobotSpec& robot) { read_autopilot(section, robot.autopilot.emplace()); }},
    {"rover",
     [](Mapping& section, RobotSpec& robot) { read_rover(section, robot.rover.emplace()); }},
    {"crazyflie", [](Mapping& section,
                     RobotSpec& robot) { read_crazyflie(section, robot.crazyflie.emplace()); }},
};

Eigen::Vector3d start_in_space_m(const RobotSpec& robot) {
  return {robot.start.x_m, robot.start.y_m, robot.height_m};
}

/// Checks that separation_m covers the radii and that the robots start at least separation_m apart,
/// because plans must keep separation_m from their first instant on.
void check_separation(Mapping& from, const RobotSpec& robot, const Scenario& scenario) {
  for (const RobotSpec& other : scenario.robots) {
    const double separation_m = scenario.planner.separation_m;
    const double radii_m = robot.limits.radius_m + other.limits.radius_m;
    if (separation_m < radii_m) {
      from.refuse("limits", fmt::format("planner.separation_m must be at least the sum of the "
                                        "radii of {} and {} ({} m), but is {}",
                                        other.name, robot.name, radii_m, separation_m));
    }
    const double distance_m = (start_in_space_m(robot) - start_in_space_m(other)).norm();
    if (distance_m < separation_m) {
      from.refuse(
          "start",
          fmt::format(
              "must be at least planner.separation_m ({} m) from the start of {}, but is {:.3g}",
              separation_m, other.name, distance_m));
    }
  }
}

/// If a robot has a driver, refuses plans that are too long for drivers. Drivers also receive the
/// plans of teammates, to avoid collisions.
void check_plans(Mapping& top, const Scenario& scenario) {
  constexpr int kStepsMax = static_cast<int>(models::kFlownSegmentsMax) - 1;
  constexpr double kRounding_s = 1e-6;
  const PlannerSpec& planner = scenario.planner;
  const bool has_driver =
      std::any_of(scenario.robots.begin(), scenario.robots.end(),
                  [](const RobotSpec& robot) { return robot.device != DeviceSource::kDirect; });
  if (!has_driver) {
    return;
  }
  if (planner.horizon_steps > kStepsMax) {
    top.refuse("planner", fmt::format("horizon_steps must be at most {}, the longest plan that a "
                                      "driver accepts, if a robot's device is wire or real; is {}",
                                      kStepsMax, planner.horizon_steps));
  }
  for (const RobotSpec& robot : scenario.robots) {
    const double plan_s = planner.horizon_steps * planner.step_s +
                          robot.limits.speed_max_mps / robot.limits.brake_mps2;
    if (plan_s > models::kFlownDurationMax_s - kRounding_s) {
      top.refuse("planner",
                 fmt::format("horizon_steps · step_s plus the longest stop of {} ({:.4g} s) must "
                             "be below {} s if a robot's device is wire or real",
                             robot.name, plan_s, models::kFlownDurationMax_s));
    }
  }
}

void read_robot(Mapping& from, const Scenario& scenario, RobotSpec& robot) {
  from.require("name");
  from.require("start");
  from.text("name", robot.name);
  check_name(from, robot.name, scenario);
  from.section("start", [&](Mapping& start) { read_pose(start, robot.start); });
  from.number("height_m", robot.height_m, above(0.0));
  from.section("limits", [&](Mapping& limits) { read_limits(limits, robot.limits); });
  read_primitives(from, robot.limits, robot.primitives);
  from.require("sensor");
  from.section("sensor", [&](Mapping& sensor) { read_sensor(sensor, robot); });
  from.section("energy",
               [&](Mapping& energy) { read_energy(energy, scenario.world, robot.energy); });
  read_device(from, robot.device);
  for (const VehicleReader& reader : kVehicleReaders) {
    from.section(reader.section, [&](Mapping& section) { reader.read(section, robot); });
  }
  read_firmware(from, robot);
  if (robot.device == DeviceSource::kReal && robot.autopilot && robot.autopilot->system_id == 0) {
    from.refuse("autopilot",
                "must contain the system_id, 1 to 255, of a real vehicle: 0 would connect to "
                "the first vehicle that sends a message");
  }
  if (robot.device == DeviceSource::kReal && robot.autopilot && robot.autopilot->key_file.empty()) {
    from.refuse("autopilot",
                "must contain the key_file of a real vehicle: without it anyone on its network "
                "can command it; docs/guide/quadrotors.md explains how to set the key");
  }
  for (const VehicleKind& kind : all_vehicle_kinds()) {
    if (kind.url(robot) != nullptr && &kind != vehicle_kind(robot)) {
      from.refuse(kind.section,
                  "a robot can have only one of " + vehicle_sections(", ") + ": remove the others");
    }
  }
  from.finish();

  if (robot.height_m >= scenario.world.ceiling_m) {
    from.refuse("height_m", fmt::format("must be below world.ceiling_m ({}), but is {}",
                                        scenario.world.ceiling_m, robot.height_m));
  }
  if (robot.height_m + robot.limits.radius_m > scenario.world.ceiling_m) {
    from.refuse("height_m",
                fmt::format("must be at most world.ceiling_m ({}) minus the robot's radius_m ({}), "
                            "otherwise it touches the ceiling; is {}",
                            scenario.world.ceiling_m, robot.limits.radius_m, robot.height_m));
  }
  check_start(from, scenario.world, robot.start,
              robot.limits.radius_m + scenario.planner.obstacle_margin_m);
  check_separation(from, robot, scenario);
}

void read_target(Mapping& from, const Scenario& scenario, TargetSpec& target) {
  from.text("name", target.name);
  check_name(from, target.name, scenario);
  from.integer("id", target.id, 0, kTargetsMax - 1);
  from.number("radius_m", target.radius_m, above_to(0.0, kLengthMaxM));
  from.section("start", [&](Mapping& start) { read_pose(start, target.start.emplace()); });
  from.finish();

  const auto has_id = [&](const TargetSpec& other) { return other.id == target.id; };
  if (std::any_of(scenario.targets.begin(), scenario.targets.end(), has_id)) {
    from.refuse("id", fmt::format("must be unique; an earlier target has the id {}", target.id));
  }
  if (target.start) {
    check_start(from, scenario.world, *target.start, target.radius_m);
  }
}

void read_target_count(Mapping& from, Scenario& scenario) {
  int count = 0;
  std::string prefix = "T";
  double radius_m = TargetSpec{}.radius_m;
  from.require("count");
  from.integer("count", count, 1, kTargetsMax);
  from.text("name_prefix", prefix);
  from.number("radius_m", radius_m, above_to(0.0, kLengthMaxM));
  for (int id = 0; id < count; ++id) {
    TargetSpec target{.name = prefix + std::to_string(id + 1),
                      .id = id,
                      .start = std::nullopt,
                      .radius_m = radius_m};
    if (!is_channel_suffix(target.name)) {
      from.refuse("name_prefix", "must contain only A-Z and 0-9, is '" + prefix + "'");
    }
    if (scenario.find_robot(target.name) != nullptr) {
      from.refuse("name_prefix",
                  "gives a target the name " + target.name + ", which a robot already has");
    }
    scenario.targets.push_back(std::move(target));
  }
}

}  // namespace

bool is_channel_suffix(const std::string& name) {
  return std::all_of(name.begin(), name.end(),
                     [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); });
}

void read_device(Mapping& from, DeviceSource& device) {
  from.choice("device", device,
              {{"direct", DeviceSource::kDirect},
               {"wire", DeviceSource::kWire},
               {"real", DeviceSource::kReal}});
}

void read_publisher(Mapping& from, Publisher& publisher) {
  from.choice("device", publisher,
              {{"vantage", Publisher::kVantage}, {"external", Publisher::kExternal}});
}

void read_robots(Mapping& top, Scenario& scenario) {
  const std::optional<Value> defaults = top.find("robot_defaults");
  const std::optional<Value> list = top.find_required("robots");
  const std::vector<Value> items = list ? list->items() : std::vector<Value>();
  if (list && (items.empty() || items.size() > kRobotsMax)) {
    list->refuse(fmt::format("must contain at least 1 and at most {} robots, contains {}",
                             kRobotsMax, items.size()));
  }
  for (const Value& item : items) {
    std::vector<Value> layers{item};
    if (defaults) {
      layers.push_back(*defaults);
    }
    RobotSpec robot;
    read_mapping(layers, [&](Mapping& from) { read_robot(from, scenario, robot); });
    scenario.robots.push_back(std::move(robot));
  }
  check_plans(top, scenario);
}

void read_targets(Mapping& top, Scenario& scenario) {
  // A mapping scenario needs no targets.
  const std::optional<Value> targets = scenario.planner.objective == PlanObjective::kMapping
                                           ? top.find("targets")
                                           : top.find_required("targets");
  if (!targets) {
    return;
  }
  if (targets->node->kind == Node::Kind::kMapping) {
    read_mapping({*targets}, [&](Mapping& from) { read_target_count(from, scenario); });
    return;
  }
  const std::vector<Value> items = targets->items();
  if (items.empty() || items.size() > kTargetsMax) {
    targets->refuse(fmt::format("must contain at least 1 and at most {} targets, contains {}",
                                kTargetsMax, items.size()));
  }
  for (const Value& item : items) {
    TargetSpec target;
    target.id = static_cast<int>(scenario.targets.size());
    target.name = fmt::format("T{}", target.id + 1);
    read_mapping({item}, [&](Mapping& from) { read_target(from, scenario, target); });
    scenario.targets.push_back(std::move(target));
  }
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (scenario.targets[i].id >= static_cast<int>(items.size())) {
      items[i].refuse(fmt::format("id must be at most {}, the number of targets minus 1; is {}",
                                  items.size() - 1, scenario.targets[i].id));
    }
  }
}

}  // namespace vantage::scenario
