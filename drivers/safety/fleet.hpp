#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/safety/authority.hpp"
#include "drivers/safety/plan_check.hpp"
#include "drivers/safety/pose_monitor.hpp"
#include "drivers/safety/surroundings.hpp"
#include "models/exchange/messages.hpp"
#include "models/motion/vehicle_limits.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Every other body that mocap shows, as mocap and plans tell: the scenario's robots and targets,
/// and bodies of other names (persons, say), of which the nearest kStrangersMax are kept. A body of
/// another name within our own radius is carried by this vehicle: counted and nothing else.
class Fleet {
 public:
  static constexpr std::size_t kStrangersMax = 16;
  static constexpr double kSilentS = 0.5;  ///< drivers report ten times a second
  Fleet(const scenario::Scenario& scenario, const std::string& own_name);

  void on_mocap(const models::MocapFrame& frame, const SafetyLimits& limits, Time now);
  /// Takes a teammate's plan when it is one of now that its vehicle can fly, newer than the last,
  /// of the planner that holds that teammate's lease. False, and counted, otherwise: the teammate
  /// then is on the plan that was taken before or, when it does not keep to that, where it is seen.
  bool on_plan(const models::RobotPlan& plan, const SafetyLimits& limits, Time now);
  /// Notes that a teammate's driver has reported. After kSilentS without a report that driver is
  /// assumed to be dead, and its vehicle to come down where it is seen.
  void on_status(const std::string& robot, Time now);

  /// Those that were ever seen, moved on to `now`. Valid until the next call.
  std::span<const OtherBody> bodies(Time now, const SafetyLimits& limits);
  /// Returns the course of each other body. A teammate: its newest plan while it keeps to it, else
  /// where it is. Every other body: straight on at its velocity for other_goes_on_s.
  std::span<const OtherCourse> courses(Time now, const SafetyLimits& limits);
  [[nodiscard]] std::int64_t unknown_bodies() const { return unknown_bodies_; }
  /// Those of other names that were farther off than kStrangersMax others.
  [[nodiscard]] std::int64_t bodies_dropped() const { return bodies_dropped_; }
  [[nodiscard]] std::int64_t poses_refused() const { return poses_refused_; }
  [[nodiscard]] std::int64_t plans_refused() const { return plans_refused_; }

 private:
  struct Member {
    std::string name;
    bool is_robot = false;
    bool goes_first = true;
    int robot = -1;               ///< its place among the scenario's robots
    models::VehicleLimits can{};  ///< of a robot; of every other body its radius alone
    PoseMonitor pose;
    bool has_plan = false;
    HeldPlan plan;
    std::int64_t plan_run = 0;
    std::int64_t plan_sequence = -1;
    PlannerLease lease{};
    std::optional<Time> reported_at{};  ///< its driver, last
  };
  /// A body of a name that the scenario does not have; free without a name.
  struct Stranger {
    std::string name;  ///< of reserved capacity
    PoseMonitor pose;
  };
  bool take(const models::RobotPlan& plan, const SafetyLimits& limits, Time now);
  [[nodiscard]] static bool is_on_plan(const Member& member, Time now, const SafetyLimits& limits);
  void show_stranger(const models::MocapBody& body, const models::MocapBody* own,
                     const SafetyLimits& limits, Time now);
  /// Where a new stranger at `there_m` is kept; nullptr when all that are kept are nearer.
  Stranger* room_for(const Eigen::Vector3d& there_m, const Eigen::Vector3d& here_m, Time now);

  std::string own_name_;
  std::vector<Member> members_;
  std::vector<Stranger> strangers_;
  std::vector<OtherBody> bodies_;
  std::vector<OtherCourse> courses_;
  std::int64_t unknown_bodies_ = 0;
  std::int64_t bodies_dropped_ = 0;
  std::int64_t poses_refused_ = 0;
  std::int64_t plans_refused_ = 0;
};

/// The body of that name, and whether there is only one. nullptr when absent.
struct NamedBody {
  const models::MocapBody* body = nullptr;
  bool is_unique = true;
};
NamedBody find_unique(const models::MocapFrame& frame, const std::string& name);

}  // namespace vantage::drivers
