#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/autopilot/dialect.hpp"
#include "models/belief/exploration.hpp"
#include "models/mapping/mapping_spec.hpp"
#include "models/motion/unicycle.hpp"
#include "models/motion/vehicle_limits.hpp"
#include "models/sensor/clutter.hpp"
#include "models/sensor/sensor.hpp"
#include "models/target/target_model.hpp"
#include "models/world/world.hpp"
#include "scenario/device_source.hpp"
#include "scenario/energy_spec.hpp"
#include "scenario/host_spec.hpp"
#include "scenario/mocap_spec.hpp"
#include "scenario/security_spec.hpp"

// A trial as values: what one scenario file says. Read from YAML by scenario/reader/scenario_yaml.

namespace vantage::scenario {

/// What a parameter of the autopilot that is not as config/autopilot wants it does to arming.
enum class ParameterPolicy {
  kVerify,  ///< it forbids arming
  kWarn,    ///< it is told
  kIgnore,  ///< nobody asks
};

/// A battery whose charge is known by its voltage alone. Volts of one cell, under the load of a
/// hover.
struct BatterySpec {
  int cells = 3;
  double empty_v = 3.3;
  double full_v = 4.1;
};

/// How a robot's driver reaches its autopilot, and what it has to know of it.
struct AutopilotSpec {
  models::AutopilotDialect dialect = models::AutopilotDialect::kPx4;
  std::string url;       ///< udp://[HOST]:PORT, udpout://HOST:PORT or serial:DEVICE[:BAUD]
  int system_id = 0;     ///< MAVLink system of the vehicle; 0: the first autopilot heard
  std::string key_file;  ///< 32 bytes that sign every message; empty: unsigned
  ParameterPolicy parameters = ParameterPolicy::kVerify;
  /// When the autopilot tells no percentage, or one that counts from full at each power-up.
  std::optional<BatterySpec> battery = std::nullopt;
};

/// Real autopilot firmware that flies a simulated vehicle: what `device: wire` means for a robot
/// that has it. Which firmware it is, its autopilot's dialect says.
struct FirmwareSpec {
  std::string binary;           ///< started and supervised by `vantage up`; empty: started by hand
  std::string parameters;       ///< file that it starts with; empty: those of config/autopilot
  std::optional<int> instance;  ///< its ports; the robot's place in the scenario when absent
  std::string serial;           ///< DEVICE[:BAUD] of a board in hardware-in-the-loop mode (PX4)
};

/// How a ground robot's driver reaches its rover.
struct RoverSpec {
  std::string url;  ///< udpout://HOST:PORT, or udp://[HOST]:PORT for one that speaks first
  int number = 1;   ///< the rover's own, in every datagram
};

struct RobotSpec {
  std::string name;  ///< channel suffix, [A-Z0-9]+
  Pose2 start;       ///< world from body
  double height_m = 1.0;
  std::vector<models::UnicycleControl> primitives;
  models::VehicleLimits limits;
  models::SensorModel sensor;
  models::DetectionModel detection;  ///< of that sensor
  EnergySpec energy;
  DeviceSource device = DeviceSource::kDirect;
  std::optional<AutopilotSpec> autopilot;
  std::optional<FirmwareSpec> firmware;  ///< without one an emulated autopilot stands in
  std::optional<RoverSpec> rover;        ///< then it is a ground robot
};

enum class TargetMotion {
  kRandomWaypoint,    ///< a rover driving to random way points around obstacles and others
  kDoubleIntegrator,  ///< white acceleration, reflected at the border
  kStill,
};

struct TargetSpec {
  std::string name;
  int id = 0;                  ///< index used on every channel, 0 … n−1
  std::optional<Pose2> start;  ///< drawn from free space by the seed when absent
  double radius_m = 0.2;
};

/// How the targets really move; the estimator knows none of it.
struct TargetTruthSpec {
  TargetMotion motion = TargetMotion::kRandomWaypoint;
  double speed_min_mps = 0.2;
  double speed_max_mps = 0.6;  ///< of a leg, drawn anew at each way point
  double pause_max_s = 2.0;
  double acceleration_q = 0.001;  ///< m²/s³, of a double integrator
};

struct EstimatorSpec {
  models::TargetModel target_model;
  double prior_position_sigma_m = 1.0;  ///< of a target at its first detection, where z is silent
  double prior_velocity_sigma_mps = 0.5;
  /// Stated prior of a target nobody has seen: entropy counted until its discovery.
  double undiscovered_position_sigma_m = 4.0;
  double grid_resolution_m = 0.25;
  double grid_memory_s = 30.0;  ///< after it a cell counts as unexplored again; ≤ 0: never
  /// Innovations beyond it are counted, not used, and make the belief doubtful, where the sensor
  /// can tell where a target is; 0: no gate.
  double gate_sigma = 4.0;
  /// Share of in-view looks that detect a target that is there; a look that finds nothing where
  /// the belief expects a target moves the belief away. 0 switches that off.
  double detection_probability = 0.9;
  /// Targets are never beyond the world's bounds or in an obstacle; beliefs keep to the rest, and
  /// those with a velocity turn back at the bounds.
  bool targets_stay_inside = true;
  /// What a wall, an empty look or another target in the way has left of a belief is told by
  /// samples until the target is seen again, where targets have a velocity and sensors tell ids.
  bool samples = false;
};

/// What plans are to gain.
enum class PlanObjective {
  kTracking,  ///< of the targets' states
  kMapping,   ///< of which cells of the ground are occupied
};

/// The words of the searches that a robot may plan by: those of planner/search/catalogue, which a
/// test holds them to.
inline constexpr std::array<std::string_view, 10> kSearchWords = {
    "arvi",  "beam",   "rvi",   "fvi",         "greedy",
    "astar", "wastar", "aegis", "random_walk", "lawn_mower"};

/// How the robots of a team agree on their plans.
enum class TeamAlgorithm {
  kCoordinateDescent,  ///< one after another, each against the newest plans of the others
  kLocalSearch,        ///< by proposals to one solution (docs/decisions/0006)
};

struct PlannerSpec {
  PlanObjective objective = PlanObjective::kTracking;
  std::string algorithm = "arvi";  ///< one of kSearchWords
  int horizon_steps = 12;          ///< T
  double step_s = 0.5;             ///< τ
  int execute_steps = 6;           ///< n_exec: a round lasts execute_steps · step_s
  double team_budget_s = 0.5;      ///< T_ARVI, shared evenly by the robots
  double publish_margin_s = 0.05;  ///< m: between the last slot's end and the round's
  /// Into how many slots the budget is cut, shared by robots that are not near each other
  /// (planner/robot/slot_colour); 0: one for each robot.
  int slots = 0;
  std::int64_t node_budget = 0;  ///< > 0: nodes instead of time, in each slot
  double epsilon_initial = 1.0;  ///< of the first finite pass; halved each pass
  double delta_initial_m = 1.0;
  double yaw_weight_m_per_rad = 0.3;  ///< metric on SE(2): hypot(distance, weight · |Δyaw|)
  TeamAlgorithm team_algorithm = TeamAlgorithm::kCoordinateDescent;
  int candidates_max = 200;  ///< trajectories of each robot that a local search chooses from
  int attacks_max = 0;  ///< α: so many sensors may be jammed at once; > 0: the team plans by RAIN
  double separation_m = 0.6;  ///< least distance between two vehicles, always, in space
  /// Plans keep it seen from above: nobody flies over or under another, who may come down any time.
  bool separation_from_above = false;
  double obstacle_margin_m = 0.1;     ///< beyond the vehicle's radius
  double tracking_tolerance_m = 0.2;  ///< allowed distance between a vehicle and its plan
  models::ExplorationSpec exploration;
};

struct NetworkSpec {
  double communication_range_m = 0.0;  ///< beliefs from farther robots are discarded; ≤ 0: none
  /// Nobody listens to robots, nor believes in targets, that are farther from him than this on the
  /// ground; 0: everybody is near (scenario/neighbourhood).
  double neighbourhood_m = 0.0;
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
};

/// For a while the sensors of some robots see nothing: what the simulator does to the team.
struct AttackSpec {
  double from_s = 0.0;  ///< since the simulator's start
  double to_s = 0.0;
  std::vector<std::string> robots;
};

/// The air of a simulated lab, for all that flies in it. Without one each kind of simulated vehicle
/// has light gusts of its own.
struct WindSpec {
  double x_mps = 0.0;  ///< mean, along the world's axes
  double y_mps = 0.0;
  double gust_sigma_mps = 0.1;  ///< 1σ on each horizontal axis
};

struct Scenario {
  std::string name;
  std::string source_text;  ///< the file as read; goes into every log
  double duration_s = 300.0;
  std::uint64_t seed = 1;
  models::World world;
  std::optional<WindSpec> wind;
  std::vector<RobotSpec> robots;
  std::vector<TargetSpec> targets;
  TargetTruthSpec target_truth;
  EstimatorSpec estimator;
  PlannerSpec planner;
  NetworkSpec network;
  SecuritySpec security;
  MocapSpec mocap;
  models::MappingSpec mapping;  ///< of the objective kMapping
  std::vector<AttackSpec> attacks;
  std::vector<HostSpec> hosts;  ///< none: all runs on one

  /// Whether `host` runs `part` (a robot's name, kSimPart, …). What no host names runs on the
  /// first; without hosts everything runs everywhere.
  [[nodiscard]] bool runs_on(const std::string& host, const std::string& part) const;
  [[nodiscard]] const RobotSpec* find_robot(const std::string& robot) const;
  /// Which instance of its firmware flies `robot`, one of ours: it makes their ports differ.
  [[nodiscard]] int firmware_instance(const RobotSpec& robot) const;
};

/// What kind of trial the devices make of `scenario`: never kReplay.
TrialMode trial_mode(const Scenario& scenario);

}  // namespace vantage::scenario
