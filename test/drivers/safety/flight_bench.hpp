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

// A small closed loop in virtual time: three point-mass vehicles with lag behind a stand-in for the
// autopilot, a planner each that shuttles along a lane, mocap at 100 Hz, an operator, and flight
// safety, ticked at 100 Hz. Faults set the knobs afresh at each tick.

namespace vantage::test {

/// How a plan is spoilt before the vehicle hears it.
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
  kHeadOn,  ///< the same, for who trusts plans
  kWrongVehicle,
  kEmpty,
  kHalfASecondOld,
  kReplayed,  ///< one of three seconds ago
};

/// How one body is spoilt in the mocap's frames.
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
  kForeign,  ///< a still body, 0.24 m from where this one was, bears its name
};

/// What is wrong with one vehicle and its world during one tick.
struct VehicleKnobs {
  std::vector<BodyFault> body;  ///< all of them
  double offset_m = 0.0;        ///< of its pose, along x
  std::string swapped_with;
  PlanFault plan = PlanFault::kNone;
  bool plan_late = false;  ///< it says itself that it missed its deadline, whatever else
  bool second_planner = false;
  bool planner_dead = false;
  Eigen::Vector3d push_mps2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d runaway_mps = Eigen::Vector3d::Zero();  ///< added to what it is asked to fly
  bool motor_failed = false;
  double tilt_rad = 0.05;
  double body_tilt_rad = 0.0;        ///< of the mocap's body, about its x axis
  double attitude_offset_rad = 0.0;  ///< of the autopilot's roll
  double yaw_offset_rad = 0.0;       ///< of the autopilot's yaw
  bool says_disarmed = false;        ///< a heartbeat that is not its own, or wrong
  bool estimator_bad = false;
  double estimate_offset_m = 0.0;
  double velocity_offset_mps = 0.0;  ///< of the velocity that the autopilot reports
  std::optional<double> battery_share;
  bool battery_frozen = false;
  bool battery_silent = false;
  bool motors_off = false;   ///< whatever it is told
  bool cannot_lift = false;  ///< its motors turn and that is all
  bool link_cut = false;
  bool telemetry_cut = false;
  bool mode_left = false;
  bool is_stalled = false;        ///< its driver does not run
  double processor_wait_s = 0.0;  ///< of its driver, within the last second
  bool is_ending = false;         ///< its driver was asked to end
  bool map_differs = false;
  bool mute_teammates = false;  ///< plans of others do not arrive
};

struct RoomKnobs {
  int mocap_every = 1;      ///< ticks a frame
  int heard_before_ms = 0;  ///< what a tick hears of mocap had come so long before it
  double mocap_latency_s = 0.005;
  double mocap_jitter_s = 0.0;
  Duration mocap_clock{};
  double frame_loss = 0.0;  ///< probability
  bool mocap_dead = false;
  bool ghost_body = false;
  std::vector<Eigen::Vector3d> walkers_m;     ///< where the scenario's first targets are seen
  std::optional<Eigen::Vector3d> stranger_m;  ///< where a body of an unknown name is seen
  bool operator_silent = false;
  std::string says_to;                               ///< whom `says` is meant for; empty: all
  bool second_station = false;                       ///< one that beats and says `follow`
  bool second_arms = false;                          ///< and `arm`
  std::optional<models::OperatorAction> says;        ///< the operator, at this tick
  std::optional<models::OperatorAction> other_says;  ///< another station
};

/// How the room was set up, wrongly perhaps. Not a fault of a moment: it is so from the beginning.
struct Wiring {
  Eigen::Matrix3d mocap_from_world = Eigen::Matrix3d::Identity();
  bool mirrors_attitude = true;  ///< a mirrored mocap mirrors rotations, too
  bool swaps_names = false;      ///< mocap shows Q1 under the name Q2, and the reverse
  bool swaps_addresses = false;  ///< the driver of Q1 speaks to the autopilot of Q2
  bool has_compass = false;      ///< autopilots know the true yaw and do not take the mocap's
};

struct Vehicle {
  std::string name;
  std::unique_ptr<drivers::FlightGuard> guard;
  VehicleKnobs knobs;
  double lane_y_m = 0.0;
  bool heads_east = true;

  // Truth.
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
  bool is_armed = false;
  bool has_flown = false;

  // The autopilot.
  Eigen::Vector3d drift_m = Eigen::Vector3d::Zero();  ///< of its estimate
  double blind_s = 0.0;
  Eigen::Vector3d felt_mps = Eigen::Vector3d::Zero();  ///< its velocity by its own estimate
  double turn_radps = 0.0;                             ///< truth, and what its gyroscopes say
  double spool_s = 0.0;
  double ground_s = 0.0;
  double without_setpoint_s = 0.0;
  double battery_share = 0.9;
  drivers::FlightSetpoint asked;

  // The planner.
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
  static constexpr double kSeparationMinM = 0.5;  ///< two vehicles touch
  /// Before time 0: three vehicles lift one after the other.
  static constexpr double kLeadS = 15.0;

  /// `trusts_plans`: the plan check overlooks teammates, so that only what watches positions is
  /// between two vehicles. `stagger_m`: each flies so much higher than the one before it.
  explicit FlightBench(std::uint64_t seed, bool trusts_plans = false, double stagger_m = 0.0);
  virtual ~FlightBench() = default;
  FlightBench(const FlightBench&) = delete;
  FlightBench& operator=(const FlightBench&) = delete;
  FlightBench(FlightBench&&) = delete;
  FlightBench& operator=(FlightBench&&) = delete;

  /// Arms and takes off at the start; follows from 3.5 s on; until `until_s`.
  virtual void fly_up(double until_s);
  /// One tick with the knobs as they are; they are set back afterwards.
  void tick();
  /// So many seconds of ticks, each after `set_knobs`.
  void run(
      double seconds, const std::function<void()>& set_knobs = [] {});
  /// The operator says it at the next tick, to one vehicle or to all.
  void say(models::OperatorAction action, const std::string& whom = "");
  /// What the vehicle's status gives as reasons now.
  [[nodiscard]] static bool has_reason(const Vehicle& vehicle, const std::string& reason, Time now);

  /// Begins at minus the lead.
  [[nodiscard]] double time_s() const { return static_cast<double>(ticks_) * kTickS - lead_s_; }
  [[nodiscard]] Time now() const;
  [[nodiscard]] std::vector<Vehicle>& vehicles() { return vehicles_; }
  [[nodiscard]] Vehicle& vehicle(const std::string& name);
  [[nodiscard]] RoomKnobs& room() { return room_; }
  Wiring& wiring() { return wiring_; }
  /// The driver of a vehicle dies and begins anew.
  void restart_driver(Vehicle& vehicle);
  /// Everything that must never happen and did, in words.
  [[nodiscard]] const std::vector<std::string>& violations() const { return violations_; }
  [[nodiscard]] double closest_m() const { return closest_m_; }
  /// The newest value of a vehicle's counter, or -1 when it does not count that.
  [[nodiscard]] virtual std::int64_t count_of(const Vehicle& vehicle,
                                              const std::string& counter) const;
  static scenario::Scenario scenario(double stagger_m = 0.0);

 protected:
  /// For a bench that drives its vehicles by other means; it has no guards of its own.
  FlightBench(std::uint64_t seed, scenario::Scenario scenario, double lead_s);

  /// Hands a frame, a plan or an order to every driver that runs.
  virtual void deliver(const models::MocapFrame& frame);
  /// True if the vehicle follows the plan now.
  virtual bool deliver(Vehicle& vehicle, const models::RobotPlan& plan);
  virtual void deliver(const models::OperatorCommand& command);
  /// Drivers, autopilots and vehicles go on by one tick.
  virtual void move();
  [[nodiscard]] const scenario::Scenario& flown() const { return scenario_; }
  [[nodiscard]] std::int64_t ticks() const { return ticks_; }

 private:
  struct Flight {  ///< a frame on its way
    Time arrives;
    models::MocapFrame frame;
  };
  void mocap();
  void spoil(models::MocapFrame& frame);
  void plan();
  models::RobotPlan honest_plan(Vehicle& vehicle, Time start);
  void spoil(models::RobotPlan& plan, Vehicle& vehicle);
  void operate();
  void say(models::OperatorAction action, std::int64_t run_id, std::int64_t& sequence);
  void autopilot(Vehicle& vehicle);
  /// What mocap shows of a vehicle, without noise.
  [[nodiscard]] Pose3 shown(const Vehicle& vehicle) const;
  /// Whose driver speaks to this vehicle.
  [[nodiscard]] Vehicle& driver_of(const Vehicle& vehicle);
  /// The vehicle whose body carries that one's name.
  [[nodiscard]] Vehicle& carrier_of(const Vehicle& named);
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
