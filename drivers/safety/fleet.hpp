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

/// All other bodies, from mocap and from their plans: the scenario's robots and targets, and bodies
/// with unknown names (persons, for example). Only the kUnknownBodiesMax nearest unknown bodies are
/// stored. An unknown body within this vehicle's radius is assumed to be part of the vehicle: it is
/// counted and otherwise ignored.
class Fleet {
 public:
  static constexpr std::size_t kUnknownBodiesMax = 16;
  /// s; longest gap between reports of a working driver, which reports at 10 Hz
  static constexpr double kSilentS = 0.5;
  Fleet(const scenario::Scenario& scenario, const std::string& own_name);

  void on_mocap(const models::MocapFrame& frame, const SafetyLimits& limits, Time now);
  /// Stores a teammate's plan if the plan is current, newer than the last one and feasible for its
  /// vehicle, and if its planner holds that teammate's lease. Otherwise counts the refusal and
  /// returns false. The teammate is then assumed to follow its last accepted plan or, if it is off
  /// that plan, to stay at its measured position.
  bool on_plan(const models::RobotPlan& plan, const SafetyLimits& limits, Time now);
  /// Records a report of a teammate's driver. After kSilentS without a report, that driver is
  /// assumed to have failed, and its vehicle to descend vertically from its measured position.
  void on_status(const std::string& robot, Time now);

  /// Returns the bodies, extrapolated to `now`: each robot and target seen at least once, and each
  /// unknown body seen within the last 10 s. Valid until the next call.
  std::span<const OtherBody> bodies(Time now, const SafetyLimits& limits);
  /// Returns the predicted course of each other body. A teammate's course is its newest plan while
  /// the teammate follows that plan, otherwise its position. Every other body moves straight at its
  /// velocity for other_prediction_s. Valid until the next call.
  std::span<const OtherCourse> courses(Time now, const SafetyLimits& limits);
  [[nodiscard]] std::int64_t unknown_bodies() const { return unknown_bodies_; }
  /// Returns the number of observations of unknown bodies that were dropped because
  /// kUnknownBodiesMax nearer bodies were stored.
  [[nodiscard]] std::int64_t bodies_dropped() const { return bodies_dropped_; }
  [[nodiscard]] std::int64_t poses_refused() const { return poses_refused_; }
  [[nodiscard]] std::int64_t plans_refused() const { return plans_refused_; }

 private:
  struct Member {
    std::string name;
    bool is_robot = false;
    bool has_priority = true;
    int robot = -1;               ///< index among the scenario's robots
    models::VehicleLimits can{};  ///< all limits for a robot; only the radius for other bodies
    PoseMonitor pose;
    bool has_plan = false;
    HeldPlan plan;
    std::int64_t plan_run = 0;
    std::int64_t plan_sequence = -1;
    PlannerLease lease{};
    std::optional<Time> reported_at{};  ///< time of the last report of its driver
  };
  /// Body with a name that is not in the scenario; an empty name marks a free entry.
  struct UnknownBody {
    std::string name;  ///< memory is reserved at construction
    PoseMonitor pose;
  };
  bool take(const models::RobotPlan& plan, const SafetyLimits& limits, Time now);
  [[nodiscard]] static bool is_on_plan(const Member& member, Time now, const SafetyLimits& limits);
  void on_unknown_body(const models::MocapBody& body, const models::MocapBody* own,
                       const SafetyLimits& limits, Time now);
  /// Returns an entry for a new unknown body at `there_m`; nullptr if all stored bodies are nearer.
  UnknownBody* entry_for(const Eigen::Vector3d& there_m, const Eigen::Vector3d& here_m, Time now);

  std::string own_name_;
  std::vector<Member> members_;
  std::vector<UnknownBody> nearest_unknown_;
  std::vector<OtherBody> bodies_;
  std::vector<OtherCourse> courses_;
  std::int64_t unknown_bodies_ = 0;
  std::int64_t bodies_dropped_ = 0;
  std::int64_t poses_refused_ = 0;
  std::int64_t plans_refused_ = 0;
};

/// Body with a given name in a mocap frame (nullptr if absent), and whether the name is unique
/// there.
struct NamedBody {
  const models::MocapBody* body = nullptr;
  bool is_unique = true;
};
NamedBody find_unique(const models::MocapFrame& frame, const std::string& name);

}  // namespace vantage::drivers
