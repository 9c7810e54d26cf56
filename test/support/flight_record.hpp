#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <lcm/lcm-cpp.hpp>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::test {

/// The motion of one vehicle compared with its commands, from its first plan to its final landing
/// or the end of the log. Computed from the true positions.
struct CourseMetrics {
  double airborne_s = 0.0;
  double follow_share = 0.0;          ///< share of airborne_s in FOLLOW
  double setpoint_error_rms_m = 0.0;  ///< m; distance from the set-point in FOLLOW
  double setpoint_error_max_m = 0.0;
  double hold_error_max_m = 0.0;  ///< m; distance from the set-point in HOLD
  double speed_max_share = 0.0;   ///< greatest horizontal speed divided by its limit
  double outside_max_m = 0.0;     ///< m; centre beyond the bounds or inside an obstacle
  double separation_least_m = 0.0;
  double turn_max_share = 0.0;  ///< greatest yaw rate, averaged over 0.1 s, divided by its limit
  /// m; jump of the set-point between two status messages while following, beyond the distance at
  /// the greatest speed.
  double setpoint_jump_max_m = 0.0;
  double status_gap_max_s = 0.0;          ///< s; between two status messages
  double truth_gap_max_s = 0.0;           ///< s; between two TRUTH frames with the vehicle
  int runs = 0;                           ///< accepted runs of the vehicle's driver
  std::int64_t strangers = 0;             ///< status messages of another run while the driver ran
  std::map<std::string, double> reasons;  ///< s; airborne time with each reason
};

/// Response to one order or condition to stop, by a vehicle that was following a plan.
struct Stop {
  Time begin{};
  double speed_mps = 0.0;      ///< m/s; greatest horizontal speed within 0.2 s
  double distance_m = 0.0;     ///< m; greatest horizontal distance from the start within 2.5 s
  double still_after_s = 0.0;  ///< s; until permanently slower than 0.1 m/s
  std::string reason;
};

/// A state that a vehicle's driver reported after the event, with its reasons.
struct Reaction {
  models::FlightState state = models::FlightState::kIdle;
  double after_s = 0.0;
  std::vector<std::string> reasons;  ///< reported within a second, without repetitions
};

/// The response of a vehicle to an event.
struct EventResponse {
  double speed_mps = 0.0;        ///< m/s; greatest horizontal speed within 0.2 s
  double distance_m = 0.0;       ///< m; greatest horizontal distance from the start within 3 s
  double outside_m = 0.0;        ///< m; centre beyond the bounds or in an obstacle, within 12 s
  double separation_m = 0.0;     ///< m; least distance from another vehicle in the air, within 12 s
  double off_course_m = 0.0;     ///< m; greatest distance from the set-point within 8 s
  std::optional<double> down_s;  ///< s; until below 0.15 m; nullopt if not within 30 s
  std::vector<Reaction> said;    ///< each change of state within 45 s
};

/// Processor use of a process between two of its health messages, which are one second apart.
struct MachineShare {
  std::string process;
  Time since{};
  Time until{};
  double used_s = 0.0;             ///< s of processor time of all its threads
  std::optional<double> waited_s;  ///< s ready to run without a processor; nullopt if not reported
};

/// A contact between two bodies, or between a body and an obstacle or a wall.
struct Collision {
  std::string text;  ///< e.g. "Q2 with R2; Q2 was at 0.44 m, land: pose lost"
  /// True if the autopilot was landing the robot straight down without a pose, and the other body
  /// is not a robot.
  bool is_of_blind_landing = false;
};

/// A reader of a flight's log, event by event: SCENARIO, TRUTH, COLLISION, VEHICLE_* and HEALTH_*.
class FlightRecord {
 public:
  void take(const lcm::LogEvent& event);
  [[nodiscard]] std::map<std::string, CourseMetrics> summaries() const;
  /// Returns a robot's response to an event; nullopt if TRUTH does not show the robot then.
  [[nodiscard]] std::optional<EventResponse> after(const std::string& robot, Time event) const;
  [[nodiscard]] const std::optional<scenario::Scenario>& scenario() const { return scenario_; }
  /// Returns the number of TRUTH frames of another simulation that were received during the flight.
  [[nodiscard]] std::int64_t truth_strangers() const { return truth_strangers_; }
  [[nodiscard]] const std::vector<Collision>& collisions() const { return collisions_; }
  /// Returns the processor use since the first followed plan; empty if the log lacks it.
  [[nodiscard]] const std::vector<MachineShare>& machine_shares() const { return machine_shares_; }
  /// Returns, for each vehicle, every change from FOLLOW to HOLD that lasted at least a second.
  [[nodiscard]] std::map<std::string, std::vector<Stop>> stops() const;

 private:
  struct At {
    Time time{};
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
    double yaw_rad = 0.0;
  };
  struct Robot {
    std::vector<At> truth;
    std::vector<models::VehicleStatus> said;
    int runs = 0;
    std::int64_t strangers = 0;
  };
  bool is_of_flight(const models::Stamp& stamp, const std::string& robot);
  void take_health(const models::ProcessHealth& health);
  void take_contact(const models::CollisionReport& contact);
  /// Returns the position and the last reported state of `body` if it is a robot.
  [[nodiscard]] std::string state_of(const std::string& body) const;
  [[nodiscard]] bool is_landed_blind(const std::string& body) const;
  [[nodiscard]] static std::optional<Stop> stop_at(const Robot& robot, std::size_t said);
  /// True if a flying vehicle is so low that it lands or takes off.
  [[nodiscard]] static bool is_low(const At& at, const scenario::RobotSpec& spec);
  [[nodiscard]] std::optional<Eigen::Vector3d> place(const Robot& robot, Time time) const;
  [[nodiscard]] CourseMetrics summary(const std::string& name, const Robot& robot) const;
  /// Evaluates the status messages from `begin` to `end`.
  static void judge_words(const Robot& robot, Time begin, Time end, double speed_max_mps,
                          CourseMetrics& out);
  static void judge_turns(const Robot& robot, Time begin, Time end, const scenario::RobotSpec& spec,
                          CourseMetrics& out);

  std::optional<scenario::Scenario> scenario_;
  std::map<std::string, Robot> robots_;
  std::int64_t truth_strangers_ = 0;
  std::vector<Collision> collisions_;
  std::map<std::string, models::Stamp> newest_;  ///< newest stamp by robot; "" for TRUTH
  bool has_anybody_followed_ = false;
  struct Usage {
    models::Stamp said;
    std::int64_t cpu_us = 0;
    std::int64_t waited_us = 0;
  };
  std::map<std::string, Usage> usage_;  ///< by process, since the first followed plan
  std::vector<MachineShare> machine_shares_;
};

/// Formats `kept` as one line of text for people.
std::string to_text(const std::string& robot, const CourseMetrics& kept);

}  // namespace vantage::test
