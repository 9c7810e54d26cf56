#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "drivers/safety/guard.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"
#include "test/support/random.hpp"

// A small closed loop in virtual time: three point-mass vehicles with lag and a simulated
// autopilot, one planner each that moves its vehicle back and forth along a lane, mocap at 100 Hz,
// an operator, and flight safety at 100 Hz. An active fault sets its knobs again at each tick.

namespace vantage::test {

/// Corruption of a plan before it reaches the vehicle.
enum class PlanFault {
  kNone,
  kDropped,
  kNotANumber,
  kTooFast,
  kTooTight,
  kNoStop,
  kJumps,
  kLeavesFence,
  kMeetsObstacle,
  kMeetsTeammate,
  kHeadOn,  ///< straight at a teammate; requires guards that do not check plans against teammates
  kWrongVehicle,
  kEmpty,
  kHalfASecondOld,
  kReplayed,  ///< repeats the fourth newest accepted plan
};

/// Corruption of one body in the mocap frames.
enum class BodyFault {
  kNone,
  kOccluded,
  kAbsent,
  kFrozen,
  kNotANumber,
  kZeroQuaternion,
  kLongQuaternion,
  kMillimetres,
  kMirrored,
  kUpsideDown,
  kDuplicated,
  kForeign,  ///< stationary body with this name, 0.24 m from the last position
};

/// Faults of one vehicle and its environment during one tick.
struct VehicleKnobs {
  std::vector<BodyFault> body;  ///< faults of the mocap body; all of them apply
  double offset_m = 0.0;        ///< m; added along x to the position shown by mocap
  std::string swapped_with;
  PlanFault plan = PlanFault::kNone;
  bool plan_late = false;  ///< the plan reports a missed deadline
  bool second_planner = false;
  bool planner_dead = false;
  Eigen::Vector3d push_mps2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d runaway_mps = Eigen::Vector3d::Zero();  ///< m/s; added to the commanded velocity
  bool motor_failed = false;
  double tilt_rad = 0.05;
  double body_tilt_rad = 0.0;        ///< rad; tilt of the mocap body about its x axis
  double attitude_offset_rad = 0.0;  ///< rad; error of the roll that the autopilot reports
  double yaw_offset_rad = 0.0;       ///< rad; error of the yaw that the autopilot reports
  bool reports_disarmed = false;     ///< the autopilot reports disarmed motors
  bool estimator_bad = false;
  double estimate_offset_m = 0.0;
  double velocity_offset_mps = 0.0;  ///< m/s; error of the x velocity that the autopilot reports
  std::optional<double> battery_share;
  bool battery_frozen = false;
  bool battery_silent = false;
  bool motors_off = false;   ///< motors stop regardless of the commands
  bool cannot_lift = false;  ///< motors run but produce no lift
  bool link_cut = false;
  bool telemetry_cut = false;
  bool mode_left = false;
  bool is_stalled = false;        ///< the driver does not run
  double processor_wait_s = 0.0;  ///< s; reported wait of the driver within the last second
  bool is_ending = false;         ///< the driver received a request to end
  bool map_differs = false;
  bool drops_teammate_plans = false;  ///< plans of teammates do not arrive
};

struct RoomKnobs {
  int mocap_every = 1;   ///< ticks per frame
  int mocap_age_ms = 0;  ///< ms; age of each mocap frame when a tick processes it
  double mocap_latency_s = 0.005;
  double mocap_jitter_s = 0.0;
  Duration mocap_clock{};
  double frame_loss = 0.0;  ///< probability that a mocap frame is lost
  bool mocap_dead = false;
  bool ghost_body = false;
  std::vector<Eigen::Vector3d> target_positions_m;  ///< m; first targets as shown by mocap
  std::optional<Eigen::Vector3d>
      unknown_body_m;  ///< m; position of a body with an unknown name, as shown by mocap
  bool operator_silent = false;
  std::string command_recipient;  ///< recipient of `command`; empty: all
  bool second_station = false;    ///< a second station sends heartbeats and `follow`
  bool second_arms = false;       ///< the second station also sends `arm`
  std::optional<models::OperatorAction> command;  ///< operator command at this tick
  std::optional<models::OperatorAction>
      second_command;  ///< command of the second station at this tick
};

/// Configuration of the room, possibly wrong; constant during a run.
struct Wiring {
  Eigen::Matrix3d mocap_from_world = Eigen::Matrix3d::Identity();
  bool mirrors_attitude = true;  ///< a mirrored mocap also mirrors rotations
  bool swaps_names = false;      ///< mocap shows Q1 under the name Q2 and vice versa
  bool swaps_addresses = false;  ///< Q1 and Q2 are each connected to the autopilot of the other
  bool has_compass = false;      ///< autopilots measure the true yaw and ignore the yaw of mocap
};

struct Vehicle {
  std::string name;
  std::unique_ptr<drivers::FlightGuard> guard;
  VehicleKnobs knobs;
  double lane_y_m = 0.0;
  bool heads_east = true;

  // True state.
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
  bool is_armed = false;
  bool has_flown = false;

  // State of the autopilot.
  Eigen::Vector3d drift_m = Eigen::Vector3d::Zero();  ///< m; error of the position estimate
  double without_pose_s = 0.0;
  Eigen::Vector3d estimated_mps = Eigen::Vector3d::Zero();  ///< m/s; velocity estimate
  double turn_radps = 0.0;  ///< rad/s; true yaw rate and gyroscope reading
  double spool_s = 0.0;
  double ground_s = 0.0;
  double without_setpoint_s = 0.0;
  double battery_share = 0.9;
  drivers::FlightSetpoint setpoint;

  // State of the planner.
  std::int64_t round = 0;
  std::int64_t sequence = 0;
  std::vector<models::RobotPlan> sent;

  drivers::GuardOutput out;
  Pose3 frozen;
  bool is_frozen = false;
};

class FlightBench {
 public:
  static constexpr double kTickS = 0.01;
  static constexpr double kSeparationMinM = 0.5;  ///< m; closer vehicles count as a collision
  /// s; time before t = 0 in which the three vehicles lift one after the other.
  static constexpr double kLeadS = 15.0;

  /// With `trusts_plans` the plan check ignores teammates, so that only the position checks
  /// separate vehicles. `stagger_m` is the height difference between consecutive vehicles.
  explicit FlightBench(std::uint64_t seed, bool trusts_plans = false, double stagger_m = 0.0);
  virtual ~FlightBench() = default;
  FlightBench(const FlightBench&) = delete;
  FlightBench& operator=(const FlightBench&) = delete;
  FlightBench(FlightBench&&) = delete;
  FlightBench& operator=(FlightBench&&) = delete;

  /// Runs until `until_s`: vehicles arm and take off at the start and follow plans from 3.5 s on.
  virtual void fly_up(double until_s);
  /// Runs one tick with the current knobs, then resets them.
  void tick();
  /// Runs ticks for `seconds`; calls `set_knobs` before each.
  void run(
      double seconds, const std::function<void()>& set_knobs = [] {});
  /// Sends an operator command at the next tick to one vehicle, or to all if `whom` is empty.
  void send_command(models::OperatorAction action, const std::string& whom = "");
  /// True if the vehicle's status at `now` contains `reason`.
  [[nodiscard]] static bool has_reason(const Vehicle& vehicle, const std::string& reason, Time now);

  /// Returns the bench time, s; it starts at the negative lead time.
  [[nodiscard]] double time_s() const { return static_cast<double>(ticks_) * kTickS - lead_s_; }
  [[nodiscard]] Time now() const;
  [[nodiscard]] std::vector<Vehicle>& vehicles() { return vehicles_; }
  [[nodiscard]] Vehicle& vehicle(const std::string& name);
  [[nodiscard]] RoomKnobs& room() { return room_; }
  Wiring& wiring() { return wiring_; }
  /// Replaces the guard of the vehicle by a new one.
  void restart_driver(Vehicle& vehicle);
  /// Returns descriptions of all collisions, breaches of the fence and other forbidden events so
  /// far.
  [[nodiscard]] const std::vector<std::string>& violations() const { return violations_; }
  [[nodiscard]] double closest_m() const { return closest_m_; }
  /// Returns the newest value of a counter of the vehicle, −1 if it has no such counter.
  [[nodiscard]] virtual std::int64_t count_of(const Vehicle& vehicle,
                                              const std::string& counter) const;
  static scenario::Scenario scenario(double stagger_m = 0.0);

 protected:
  /// Constructs a bench without guards, for a subclass that drives its vehicles by other means.
  FlightBench(std::uint64_t seed, scenario::Scenario scenario, double lead_s);

  /// Delivers a message to every running driver.
  virtual void deliver(const models::MocapFrame& frame);
  /// Delivers a plan; returns true if the vehicle accepts it.
  virtual bool deliver(Vehicle& vehicle, const models::RobotPlan& plan);
  virtual void deliver(const models::OperatorCommand& command);
  /// Advances drivers, autopilots and vehicles by one tick.
  virtual void move();
  [[nodiscard]] const scenario::Scenario& bench_scenario() const { return scenario_; }
  [[nodiscard]] std::int64_t ticks() const { return ticks_; }

 private:
  struct Flight {  ///< a mocap frame in transit
    Time arrives;
    models::MocapFrame frame;
  };
  void mocap();
  void corrupt(models::MocapFrame& frame);
  void plan();
  models::RobotPlan nominal_plan(Vehicle& vehicle, Time start);
  void corrupt(models::RobotPlan& plan, Vehicle& vehicle);
  void operate();
  void send_command(models::OperatorAction action, std::int64_t run_id, std::int64_t& sequence);
  void autopilot(Vehicle& vehicle);
  /// Returns the vehicle's pose as shown by mocap, without noise.
  [[nodiscard]] Pose3 shown_pose(const Vehicle& vehicle) const;
  /// Returns the vehicle that has its driver connected to the autopilot of `vehicle`.
  [[nodiscard]] Vehicle& connected_driver(const Vehicle& vehicle);
  /// Returns the vehicle with the body that mocap shows under the name of vehicle `named`.
  [[nodiscard]] Vehicle& shown_vehicle(const Vehicle& named);
  void fly(Vehicle& vehicle);
  void check();

  scenario::Scenario scenario_;
  bool trusts_plans_ = false;
  double lead_s_ = kLeadS;
  Random random_;
  std::vector<Vehicle> vehicles_;
  RoomKnobs room_;
  Wiring wiring_;
  std::vector<Flight> frames_;
  Time newest_arrival_{};
  std::int64_t frame_number_ = 0;
  std::int64_t ticks_ = 0;
  std::int64_t command_sequence_ = 0;
  std::int64_t other_sequence_ = 0;
  double closest_m_ = 1e9;
  std::vector<std::string> violations_;
};

}  // namespace vantage::test
