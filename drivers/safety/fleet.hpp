#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/safety/authority.hpp"
#include "drivers/safety/plan_check.hpp"
#include "drivers/safety/pose_monitor.hpp"
#include "drivers/safety/surroundings.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Everybody else of the scenario, robots and targets, as mocap and their plans tell. Bodies that
/// the scenario does not know are counted and nothing else.
class Fleet {
 public:
  Fleet(const scenario::Scenario& scenario, const std::string& own_name);

  void on_mocap(const models::MocapFrame& frame, const SafetyLimits& limits, Time now);
  /// Takes a teammate's plan when it is one of now that can be, newer than the last, of the planner
  /// that holds that teammate's lease. False, and counted, otherwise.
  bool on_plan(const models::RobotPlan& plan, const SafetyLimits& limits, Time now);

  /// Those that were ever seen, moved on to `now`. Valid until the next call.
  std::span<const OtherBody> bodies(Time now, const SafetyLimits& limits);
  /// What each teammate is on: its newest plan while it keeps to it, else where it is.
  std::span<const OtherCourse> courses(Time now, const SafetyLimits& limits);
  [[nodiscard]] std::int64_t unknown_bodies() const { return unknown_bodies_; }
  [[nodiscard]] std::int64_t poses_refused() const { return poses_refused_; }
  [[nodiscard]] std::int64_t plans_refused() const { return plans_refused_; }

 private:
  struct Member {
    std::string name;
    bool is_robot = false;
    bool goes_first = true;
    int robot = -1;  ///< its place among the scenario's robots
    double radius_m = 0.0;
    PoseMonitor pose;
    bool has_plan = false;
    HeldPlan plan;
    std::int64_t plan_run = 0;
    std::int64_t plan_sequence = -1;
    PlannerLease lease{};
  };
  bool take(const models::RobotPlan& plan, const SafetyLimits& limits, Time now);
  [[nodiscard]] static bool is_on_plan(const Member& member, Time now, const SafetyLimits& limits);

  std::string own_name_;
  std::vector<Member> members_;
  std::vector<OtherBody> bodies_;
  std::vector<OtherCourse> courses_;
  std::int64_t unknown_bodies_ = 0;
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
