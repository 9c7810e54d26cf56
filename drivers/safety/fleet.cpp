#include "drivers/safety/fleet.hpp"

#include <algorithm>

namespace vantage::drivers {
namespace {

constexpr double kPredictOthersS = 0.5;
// A body that is not where it was believed to be is believed again after so many poses in a row.
constexpr int kMovedAfter = 50;

}  // namespace

NamedBody find_unique(const models::MocapFrame& frame, const std::string& name) {
  NamedBody out;
  for (const models::MocapBody& body : frame.bodies) {
    if (body.name == name) {
      out.is_unique = out.body == nullptr;
      out.body = &body;
    }
  }
  return out;
}

Fleet::Fleet(const scenario::Scenario& scenario, const std::string& own_name)
    : own_name_(own_name) {
  int index = 0;
  for (const scenario::RobotSpec& robot : scenario.robots) {
    if (robot.name != own_name) {
      members_.push_back({robot.name,
                          true,
                          robot.name < own_name,
                          index,
                          robot.limits.radius_m,
                          {},
                          false,
                          {},
                          0,
                          -1,
                          {}});
    }
    ++index;
  }
  for (const scenario::TargetSpec& target : scenario.targets) {
    members_.push_back({target.name, false, true, -1, target.radius_m, {}, false, {}, 0, -1, {}});
  }
  bodies_.reserve(members_.size());
  courses_.reserve(members_.size());
}

void Fleet::on_mocap(const models::MocapFrame& frame, const SafetyLimits& limits, Time now) {
  for (Member& member : members_) {
    const NamedBody found = find_unique(frame, member.name);
    const bool is_lost = member.pose.rejected_in_row() >= kMovedAfter;
    const PoseVerdict verdict = member.pose.judge(found.is_unique ? found.body : nullptr,
                                                  {!is_lost, false, true, 0.0}, limits, now);
    poses_refused_ += verdict == PoseVerdict::kAccepted || verdict == PoseVerdict::kAbsent ? 0 : 1;
  }
  for (const models::MocapBody& body : frame.bodies) {
    const bool is_known = body.name == own_name_ ||
                          std::any_of(members_.begin(), members_.end(), [&](const Member& member) {
                            return member.name == body.name;
                          });
    unknown_bodies_ += is_known ? 0 : 1;
  }
}

bool Fleet::on_plan(const models::RobotPlan& plan, const SafetyLimits& limits, Time now) {
  const bool is_taken = take(plan, limits, now);
  plans_refused_ += is_taken ? 0 : 1;
  return is_taken;
}

bool Fleet::take(const models::RobotPlan& plan, const SafetyLimits& limits, Time now) {
  const auto member = std::find_if(members_.begin(), members_.end(), [&](const Member& each) {
    return each.is_robot && each.name == plan.robot;
  });
  const Time start = plan.trajectory.start_time;
  const bool is_of_now = start >= now - from_seconds(limits.plan_past_max_s) &&
                         start <= now + from_seconds(limits.plan_future_max_s);
  if (member == members_.end() || !is_of_now) {
    return false;
  }
  const bool is_repeated =
      plan.stamp.run_id == member->plan_run && plan.stamp.sequence <= member->plan_sequence;
  HeldPlan held;
  if (is_repeated || (member->has_plan && start < member->plan.start_time) ||
      !hold_plan(plan.trajectory, held) || check_shape(held, limits) == PlanVerdict::kNotFinite ||
      !member->lease.admit(plan.stamp.run_id, now, limits.planner_lease_s)) {
    return false;
  }
  member->plan = held;
  member->has_plan = true;
  member->plan_run = plan.stamp.run_id;
  member->plan_sequence = plan.stamp.sequence;
  return true;
}

bool Fleet::is_on_plan(const Member& member, Time now, const SafetyLimits& limits) {
  if (!member.pose.has_pose()) {
    return true;
  }
  const PlanPoint planned = point_at(member.plan, to_seconds(now - member.plan.start_time));
  return (planned.position_world_m - member.pose.predict_m(now, kPredictOthersS)).norm() <=
         2.0 * limits.tracking_hold_m;
}

std::span<const OtherBody> Fleet::bodies(Time now, const SafetyLimits& limits) {
  bodies_.clear();
  for (const Member& member : members_) {
    if (member.pose.has_pose()) {
      const double age_s = member.pose.age_s(now);
      // A robot that has not been seen for long has stopped by now, as it must without a pose.
      const bool is_fresh = age_s <= limits.pose_age_hold_s;
      OtherBody body;
      body.position_world_m = member.pose.predict_m(now, limits.pose_age_hold_s);
      body.age_s = age_s;
      body.goes_first = member.goes_first;
      body.robot = member.robot;
      body.larger_m = std::max(0.0, member.radius_m - limits.vehicle.radius_m);
      body.went_mps = member.is_robot ? 0.0 : member.pose.velocity_world_mps().norm();
      if (is_fresh) {
        body.velocity_world_mps = member.pose.velocity_world_mps();
        body.planned_world_mps = body.velocity_world_mps;
        // One that sets off is measured late; its plan says it at once.
        const double ahead_s = to_seconds(now - member.plan.start_time) + limits.reaction_s;
        const Eigen::Vector3d planned_mps = point_at(member.plan, ahead_s).velocity_world_mps;
        if (member.has_plan && is_on_plan(member, now, limits) &&
            planned_mps.norm() > body.velocity_world_mps.norm()) {
          body.planned_world_mps = planned_mps;
        }
      }
      bodies_.push_back(body);
    }
  }
  return bodies_;
}

std::span<const OtherCourse> Fleet::courses(Time now, const SafetyLimits& limits) {
  courses_.clear();
  for (const Member& member : members_) {
    if (!member.is_robot || (!member.has_plan && !member.pose.has_pose())) {
      continue;
    }
    const Eigen::Vector3d seen_m = member.pose.predict_m(now, kPredictOthersS);
    const bool keeps_to_plan = member.has_plan && is_on_plan(member, now, limits);
    courses_.push_back({keeps_to_plan ? &member.plan : nullptr, seen_m});
  }
  return courses_;
}

}  // namespace vantage::drivers
