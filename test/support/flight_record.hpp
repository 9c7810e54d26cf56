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

/// How one vehicle kept to what it was asked, from its first plan until it was told to land for
/// good or the log ends. Judged on the truth.
struct CourseKept {
  double airborne_s = 0.0;
  double follow_share = 0.0;          ///< of that time, in FOLLOW
  double setpoint_error_rms_m = 0.0;  ///< in space, while following
  double setpoint_error_max_m = 0.0;
  double hold_error_max_m = 0.0;  ///< while holding
  double speed_max_share = 0.0;   ///< of the limit, horizontally
  double outside_max_m = 0.0;     ///< of the centre beyond the bounds or in an obstacle
  double separation_least_m = 0.0;
  double turn_max_share = 0.0;  ///< of the limit, over a tenth of a second
  /// While following: of where it is asked to be, from one word of its driver to the next, beyond
  /// the way at its greatest speed.
  double setpoint_jump_max_m = 0.0;
  double said_gap_max_s = 0.0;   ///< between two words of its driver
  double truth_gap_max_s = 0.0;  ///< between two sights of its body
  int runs = 0;                  ///< of its driver that were believed, one after the other
  std::int64_t strangers = 0;    ///< words in its name of another run, while its own was alive
  std::map<std::string, double> reasons;  ///< seconds for which each was given, in the air
};

/// What became of one order or need to stop while it followed a plan.
struct Stop {
  Time begin{};
  double speed_mps = 0.0;      ///< horizontally, the greatest within 0.2 s from then
  double distance_m = 0.0;     ///< the farthest that it got from there within 2.5 s, horizontally
  double still_after_s = 0.0;  ///< until it was slower than 0.1 m/s for good
  std::string reason;
};

/// A state that a vehicle's driver said it had come to, and why.
struct Reaction {
  models::FlightState state = models::FlightState::kIdle;
  double after_s = 0.0;
  std::vector<std::string> reasons;  ///< told within a second, each once
};

/// What became of a vehicle to which something happened.
struct Aftermath {
  double speed_mps = 0.0;        ///< horizontally, the greatest within 0.2 s from then
  double distance_m = 0.0;       ///< the farthest that it got from there within 3 s, horizontally
  double outside_m = 0.0;        ///< of its centre beyond the bounds or in an obstacle, within 12 s
  double separation_m = 0.0;     ///< the least from another vehicle within 12 s, both in the air
  double off_course_m = 0.0;     ///< the farthest from where it was asked to be, within 8 s
  std::optional<double> down_s;  ///< until it was below 0.15 m, if within 30 s
  std::vector<Reaction> said;    ///< each change of state within 45 s
};

/// What a process had of the machine between two words of its health, which are a second apart.
struct MachineShare {
  std::string process;
  Time since{};
  Time until{};
  double used_s = 0.0;             ///< of processors, all its threads together
  std::optional<double> waited_s;  ///< ready to run and without one; not where it does not say so
};

/// Two bodies, or a body and an obstacle or a wall, that began to touch.
struct Collision {
  std::string text;  ///< for people: "Q2 with R2; Q2 was at 0.44 m, land: pose lost"
  /// A robot without a pose, which its autopilot was landing straight down, with what is no robot.
  bool is_of_blind_landing = false;
};

/// Reads a log of a flight, event by event: SCENARIO, TRUTH, COLLISION, VEHICLE_* and HEALTH_*.
class FlightRecord {
 public:
  void take(const lcm::LogEvent& event);
  [[nodiscard]] std::map<std::string, CourseKept> summaries() const;
  /// Nothing for a robot that TRUTH does not show then.
  [[nodiscard]] std::optional<Aftermath> after(const std::string& robot, Time event) const;
  [[nodiscard]] const std::optional<scenario::Scenario>& scenario() const { return scenario_; }
  /// Frames of another simulation's truth, while this one's came.
  [[nodiscard]] std::int64_t truth_strangers() const { return truth_strangers_; }
  [[nodiscard]] const std::vector<Collision>& collisions() const { return collisions_; }
  /// Of every process, since anybody followed a plan; nothing where nobody says it.
  [[nodiscard]] const std::vector<MachineShare>& machine_shares() const { return machine_shares_; }
  /// Each time that a vehicle left FOLLOW for HOLD and stayed there for a second.
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
  void take_contact(const models::ContactReport& contact);
  /// Where it was and what its driver said last, if it is a robot.
  [[nodiscard]] std::string state_of(const std::string& body) const;
  [[nodiscard]] bool is_landed_blind(const std::string& body) const;
  [[nodiscard]] static std::optional<Stop> stop_at(const Robot& robot, std::size_t said);
  /// A flying vehicle that lands or takes off.
  [[nodiscard]] static bool is_low(const At& at, const scenario::RobotSpec& spec);
  [[nodiscard]] std::optional<Eigen::Vector3d> place(const Robot& robot, Time time) const;
  [[nodiscard]] CourseKept summary(const std::string& name, const Robot& robot) const;
  /// What its driver said from `begin` to `end`, and how its body turned.
  static void judge_words(const Robot& robot, Time begin, Time end, double speed_max_mps,
                          CourseKept& out);
  static void judge_turns(const Robot& robot, Time begin, Time end, const scenario::RobotSpec& spec,
                          CourseKept& out);

  std::optional<scenario::Scenario> scenario_;
  std::map<std::string, Robot> robots_;
  std::int64_t truth_strangers_ = 0;
  std::vector<Collision> collisions_;
  std::map<std::string, models::Stamp> newest_;  ///< of each robot's states; "": of the truth
  bool has_anybody_followed_ = false;
  struct Usage {
    models::Stamp said;
    std::int64_t cpu_us = 0;
    std::int64_t waited_us = 0;
  };
  std::map<std::string, Usage> usage_;  ///< of each process, since anybody followed
  std::vector<MachineShare> machine_shares_;
};

/// One line for people.
std::string to_text(const std::string& robot, const CourseKept& kept);

}  // namespace vantage::test
