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
#include "scenario/mocap_spec.hpp"
#include "scenario/security_spec.hpp"
#include "scenario/team_algorithm.hpp"
#include "scenario/tour_spec.hpp"

// Content of a scenario file as values. scenario/reader/scenario_yaml reads it from YAML.

namespace vantage::scenario {

/// Reaction to an autopilot parameter that differs from config/autopilot.
enum class ParameterPolicy {
  kVerify,  ///< forbid arming
  kWarn,    ///< report as a warning
  kIgnore,  ///< do not check
};

/// Battery with a state of charge that is computed from its voltage alone. Voltages are per cell,
/// V, under the load of a hover.
struct BatterySpec {
  int cells = 3;
  double empty_v = 3.3;
  double full_v = 4.1;
};

/// Connection of a robot's driver to its autopilot, and properties of the autopilot.
struct AutopilotSpec {
  models::AutopilotDialect dialect = models::AutopilotDialect::kPx4;
  std::string url;       ///< udp://[HOST]:PORT, udpout://HOST:PORT or serial:DEVICE[:BAUD]
  int system_id = 0;     ///< MAVLink system id of the vehicle; 0: the first autopilot that sends
  std::string key_file;  ///< file with the 32-byte MAVLink signing key; empty: no signatures
  ParameterPolicy parameters = ParameterPolicy::kVerify;
  /// Used if the autopilot reports no percentage, or a percentage that starts at 100 % after each
  /// power-up.
  std::optional<BatterySpec> battery = std::nullopt;
};

/// Real firmware that flies a simulated vehicle of `device: wire`. The kind of the vehicle and its
/// dialect select the firmware.
struct FirmwareSpec {
  std::string binary;           ///< program started by `vantage up`; empty: the user starts one
  std::string parameters;       ///< parameter file loaded at start; empty: file of config/autopilot
  std::optional<int> instance;  ///< determines the firmware's ports; absent: the robot's index
  std::string serial;           ///< DEVICE[:BAUD] of a board in hardware-in-the-loop mode (PX4)
};

/// Connection of a ground robot's driver to its rover.
struct RoverSpec {
  std::string url;  ///< udpout://HOST:PORT, or udp://[HOST]:PORT if the rover sends first
  int number = 1;   ///< id of the rover, contained in every datagram
};

/// Source of a Crazyflie's charge.
enum class CrazyflieBattery {
  kVoltage,  ///< estimated from the voltage that the vehicle reports
  kNone,     ///< the vehicle cannot measure its battery, which is assumed to be full
};

/// Connection of a robot's driver to its Crazyflie.
struct CrazyflieSpec {
  /// radio://DONGLE/CHANNEL/250K|1M|2M/ADDRESS (ADDRESS: 10 hexadecimal digits) or udp://HOST:PORT
  std::string url;
  CrazyflieBattery battery = CrazyflieBattery::kVoltage;
  double empty_v = 3.2;  ///< V, under the load of a hover
  double full_v = 4.0;   ///< V, under the load of a hover
};

struct RobotSpec {
  std::string name;  ///< channel suffix, [A-Z0-9]+
  Pose2 start;       ///< world from body
  double height_m = 1.0;
  std::vector<models::UnicycleControl> primitives;
  models::VehicleLimits limits;
  models::SensorModel sensor;
  models::DetectionModel detection;                  ///< detection statistics of `sensor`
  Publisher sensor_publisher = Publisher::kVantage;  ///< publisher of MEASUREMENT and SCAN
  EnergySpec energy;
  DeviceSource device = DeviceSource::kDirect;
  std::optional<AutopilotSpec> autopilot;
  std::optional<FirmwareSpec> firmware;  ///< absent: an emulated autopilot is used
  std::optional<RoverSpec> rover;        ///< present: the robot is a ground robot
  std::optional<CrazyflieSpec> crazyflie;
};

enum class TargetMotion {
  kRandomWaypoint,    ///< rover that drives to random way points and avoids obstacles and bodies
  kDoubleIntegrator,  ///< white-noise acceleration, reflected at the bounds
  kStill,
};

struct TargetSpec {
  std::string name;
  int id = 0;                  ///< target id on every channel, 0 … n−1
  std::optional<Pose2> start;  ///< absent: random position in free space, from the seed
  double radius_m = 0.2;
};

/// True motion of the targets, unknown to the estimator.
struct TargetTruthSpec {
  TargetMotion motion = TargetMotion::kRandomWaypoint;
  double speed_min_mps = 0.2;
  double speed_max_mps = 0.6;  ///< maximum speed; each leg has a random speed
  double pause_max_s = 2.0;
  double acceleration_q = 0.001;  ///< m²/s³; double integrator only
};

struct EstimatorSpec {
  Publisher publisher = Publisher::kVantage;  ///< publisher of BELIEF, MIXTURE and MAP
  models::TargetModel target_model;
  /// 1σ of a target's prior at its first detection, in directions that the sensor does not measure
  double prior_position_sigma_m = 1.0;
  double prior_velocity_sigma_mps = 0.5;
  /// Prior of an undetected target. The entropy of this prior is counted until the target is
  /// discovered.
  double undiscovered_position_sigma_m = 4.0;
  double grid_resolution_m = 0.25;
  double grid_memory_s = 30.0;  ///< s; time until a cell counts as unexplored again; ≤ 0: never
  /// Gate for innovations, σ; 0: no gate. A detection beyond the gate is counted and increases the
  /// covariance, but is not fused. Only for sensors with a measurement that determines a position.
  double gate_sigma = 4.0;
  /// Assumed probability that a scan detects a target in view. A scan without the expected
  /// detection makes it less probable that the target is in the scanned area. 0: such scans are not
  /// used.
  double detection_probability = 0.9;
  /// True: targets are assumed to stay within the world's bounds and outside obstacles. Beliefs are
  /// conditioned on this assumption; beliefs with a velocity are reflected at the bounds.
  bool targets_stay_inside = true;
  /// True: when a wall, a scan without a detection or another target has changed a belief, samples
  /// represent the belief until the next detection. Requires targets with a velocity and sensors
  /// that report ids.
  bool samples = false;
};

/// Quantity about which plans maximise information.
enum class PlanObjective {
  kTracking,  ///< states of the targets
  kMapping,   ///< occupancy of the ground cells
};

/// Names of the library's search algorithms; search_names() also returns algorithms that were
/// added. A test checks that this list agrees with planner/search/catalogue.
inline constexpr std::array<std::string_view, 11> kSearchNames = {
    "arvi",   "beam",  "rvi",           "fvi",         "greedy",    "astar",
    "wastar", "aegis", "sampling_tree", "random_walk", "lawn_mower"};

struct PlannerSpec {
  Publisher publisher = Publisher::kVantage;  ///< publisher of PLAN
  PlanObjective objective = PlanObjective::kTracking;
  std::string algorithm = "arvi";  ///< one of search_names(), or kExternalSearch
  int horizon_steps = 12;          ///< T: number of steps of a plan
  double step_s = 0.5;             ///< τ: duration of one control
  int execute_steps = 6;           ///< n_exec; a round lasts execute_steps · step_s
  double team_budget_s = 0.5;      ///< T_ARVI; planning time per round, divided among the slots
  double publish_margin_s = 0.05;  ///< s; from the end of the last slot to the end of the round
  /// Number of slots in a round, shared by robots that are not near each other
  /// (planner/robot/slot_colour). 0: one per robot.
  int slots = 0;
  std::int64_t node_budget = 0;  ///< > 0: search nodes per slot, instead of a time budget
  double epsilon_initial = 1.0;  ///< ε of the first finite pass; halved in each pass
  double delta_initial_m = 1.0;
  double yaw_weight_m_per_rad = 0.3;  ///< weight w of the metric hypot(distance, w · |Δyaw|)
  TeamAlgorithm team_algorithm = TeamAlgorithm::kCoordinateDescent;
  int candidates_max = 200;   ///< maximum number of trajectories per robot in local search
  int attacks_max = 0;        ///< α: largest number of sensors jammed at once; > 0: use RAIN
  double separation_m = 0.6;  ///< minimum distance between two vehicles in space, at all times
  /// True: plans keep separation_m horizontally. Then no vehicle is above another one, and an
  /// emergency landing cannot hit a vehicle below.
  bool separation_from_above = false;
  double obstacle_margin_m = 0.1;     ///< minimum distance of the vehicle's disc to obstacles
  double tracking_tolerance_m = 0.2;  ///< allowed distance between a vehicle and its plan
  models::ExplorationSpec exploration;
  TourSpec tour;
};

/// Simulated faults of the network between robots, in trials in virtual time only.
struct SimulatedNetworkSpec {
  double loss = 0.0;         ///< share of lost Ethernet frames, per receiver; in [0, 1)
  double rate_kbitps = 0.0;  ///< rate of each robot's link, kbit/s; 0: unlimited
};

struct NetworkSpec {
  double communication_range_m = 0.0;  ///< range of exchanged beliefs; ≤ 0: no exchange
  /// Horizontal distance beyond which a robot ignores robots and targets. 0: no limit. See
  /// scenario/neighbourhood.
  double neighbourhood_m = 0.0;
  /// Rate at which one robot may send to other hosts, kbit/s; 0: unlimited. With a budget, beliefs
  /// are sent in compact form (COMPACT_BELIEF_R), and messages to processes on the same host are
  /// not sent to other hosts.
  double budget_kbitps = 0.0;
  SimulatedNetworkSpec simulation;
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
};

/// Simulated attack that jams the sensors of some robots for a limited time.
struct AttackSpec {
  double from_s = 0.0;  ///< start, s after the simulator's start
  double to_s = 0.0;
  std::vector<std::string> robots;
};

/// Computer of a trial, with the parts of the trial that it runs.
struct HostSpec {
  std::string name;               ///< channel suffix, [A-Z0-9]+
  std::vector<std::string> runs;  ///< robot names, "sim", "vicon", "logger"
};

/// Names of the parts that a host can run in addition to robots.
inline constexpr const char* kSimPart = "sim";
inline constexpr const char* kMocapPart = "vicon";
inline constexpr const char* kLoggerPart = "logger";

/// Wind of a simulated lab, for all flying vehicles. If absent, each kind of simulated vehicle has
/// its default light gusts.
struct WindSpec {
  double x_mps = 0.0;           ///< mean wind along the world's x axis
  double y_mps = 0.0;           ///< mean wind along the world's y axis
  double gust_sigma_mps = 0.1;  ///< 1σ on each horizontal axis
};

struct Scenario {
  std::string name;
  std::string source_text;  ///< text of the file; part of every log
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
  models::MappingSpec mapping;  ///< only used by the objective kMapping
  std::vector<AttackSpec> attacks;
  std::vector<HostSpec> hosts;  ///< empty: one host runs all parts

  /// True if `host` runs `part` (a robot's name, kSimPart, …). The first host runs the parts that
  /// no host names. Without hosts, always true.
  [[nodiscard]] bool runs_on(const std::string& host, const std::string& part) const;
  [[nodiscard]] const RobotSpec* find_robot(const std::string& robot) const;
  /// Returns the firmware instance of `robot`, which determines its ports. Precondition: `robot` is
  /// an element of `robots`.
  [[nodiscard]] int firmware_instance(const RobotSpec& robot) const;
};

/// Returns the kind of trial that follows from the devices of `scenario`; never kReplay.
TrialMode trial_mode(const Scenario& scenario);

}  // namespace vantage::scenario
